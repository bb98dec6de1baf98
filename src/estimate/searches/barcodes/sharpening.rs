//! Refinement of candidate line pairs, until their barcodes agree best.
//!
//! Compared lines are some pixels apart, and a line that misses the epipole has no corresponding
//! line. So both lines of a candidate move. Pairs whose barcodes agree form a pencil, and the
//! candidate reaches one of them.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::estimate::evidence::lines::LineCandidate;
use crate::estimate::sampling::{Purpose, stream};
use crate::geometry::{AnchoredLine, Frame, Point, Vector};
use crate::similarity::ScaledSimilarity;

/// Number of best candidates that are moved: enough for a consensus. The time is in proportion.
const MOVED: usize = 400;
/// Number of rounds of moves. The last moves are a thirteenth of the first.
const ROUNDS: usize = 6;
/// Number of moves of a candidate tried in a round. The best one counts.
const TRIALS: usize = 16;
/// Factor of the length of moves from round to round. With 0.5 and 0.7, the last moves would be a
/// thirtieth and a sixth of the first.
const SHRINKING: f64 = 0.6;
/// Number of preceding candidates with which a candidate is compared to find equal pairs.
/// Candidates are sorted by cost, so equal pairs are near each other.
const RECENT: usize = 8;

/// Returns the best candidates with both lines moved, best first. The first moves are up to
/// `step` px at either end.
pub(super) fn sharpen(
    level: &ScaledSimilarity,
    candidates: &[LineCandidate],
    step: f64,
    seed: u64,
    cancel: &CancelFlag,
) -> Result<Vec<LineCandidate>, EstimateError> {
    let mut random = stream(seed, Purpose::BarcodeLines, 0);
    let mut best: Vec<LineCandidate> = Vec::with_capacity(MOVED);
    for candidate in candidates {
        // A barcode does not depend on the direction of its line, so each pair occurs twice.
        let is_new = |kept: &LineCandidate| {
            kept.line1 != candidate.line1 || kept.line2.anchor != candidate.line2.anchor
        };
        if best.len() < MOVED && best.iter().rev().take(RECENT).all(is_new) {
            best.push(*candidate);
        }
    }
    // The costs of candidates may be normalised. The costs of moved lines are not.
    let pairs: Vec<_> = best.iter().map(|candidate| (candidate.line1, candidate.line2)).collect();
    for (candidate, cost) in best.iter_mut().zip(level.lines.pair_costs(&pairs)) {
        candidate.cost = cost;
    }
    let mut step = step;
    for _ in 0..ROUNDS {
        cancel.check()?;
        let mut tried = Vec::with_capacity(best.len() * TRIALS);
        for candidate in &best {
            tried.extend((0..TRIALS).map(|_| {
                let [frame1, frame2] = level.frames;
                (
                    moved(&candidate.line1, frame1, step, &mut random),
                    moved(&candidate.line2, frame2, step, &mut random),
                )
            }));
        }
        let costs = level.lines.pair_costs(&tried);
        for (k, candidate) in best.iter_mut().enumerate() {
            for trial in k * TRIALS..(k + 1) * TRIALS {
                if costs[trial] < candidate.cost {
                    let (line1, line2) = tried[trial];
                    *candidate = LineCandidate { line1, line2, cost: costs[trial] };
                }
            }
        }
        step *= SHRINKING;
    }
    best.retain(|candidate| candidate.cost.is_finite());
    best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(best)
}

/// Returns the line after a random move of both its ends, across the line.
fn moved(line: &AnchoredLine, frame: Frame, step: f64, random: &mut Pcg64Mcg) -> AnchoredLine {
    let Some(seen) = frame.clip(&line.line()) else { return *line };
    let across = Vector::new(-line.direction.y, line.direction.x);
    let mut end = |at: Point| at + across * (step * (random.random::<f64>() + random.random::<f64>() - 1.0));
    let (start, end) = (end(seen.start), end(seen.end));
    let Some(direction) = (end - start).try_normalize(1e-9) else { return *line };
    let direction = if direction.dot(&line.direction) < 0.0 { -direction } else { direction };
    AnchoredLine { anchor: nalgebra::center(&start, &end), direction }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::estimate::exact::{FRAME, exact_lines, rows};

    fn row(y: f64) -> AnchoredLine {
        AnchoredLine { anchor: Point::new(100.0, y), direction: Vector::x() }
    }

    fn level() -> ScaledSimilarity<'static> {
        ScaledSimilarity {
            lines: Box::new(exact_lines(rows(0.0), [FRAME; 2])),
            frames: [FRAME; 2],
            scales: [1.0; 2],
        }
    }

    fn sharpened(candidates: &[LineCandidate], seed: u64) -> Vec<LineCandidate> {
        sharpen(&level(), candidates, 4.0, seed, &CancelFlag::default()).unwrap()
    }

    #[test]
    fn both_lines_move_until_they_agree_and_equal_pairs_are_kept_once() {
        let mut candidates: Vec<LineCandidate> = (0..20)
            .map(|k| 10.0 + 11.0 * f64::from(k))
            .map(|y| LineCandidate { line1: row(y), line2: row(y + 3.0), cost: 9.0 })
            .collect();
        // The same pair read from the other end.
        let back = AnchoredLine { direction: -Vector::x(), ..candidates[0].line2 };
        candidates.insert(1, LineCandidate { line2: back, ..candidates[0] });
        let found = sharpened(&candidates, 3);
        assert_eq!(found.len(), 20);
        assert!(found.is_sorted_by(|a, b| a.cost <= b.cost));
        // Pairs are 3 px apart at the start. Their given costs are replaced by measured ones.
        assert!(found.iter().all(|one| one.cost < 1.0), "{found:?}");
        let pairs: Vec<_> = found.iter().map(|one| (one.line1, one.line2)).collect();
        let costs: Vec<f32> = found.iter().map(|one| one.cost).collect();
        assert_eq!(level().lines.pair_costs(&pairs), costs, "each has the cost of its own lines");
        let lines = |seed| sharpened(&candidates, seed).iter().map(|one| one.line1).collect::<Vec<_>>();
        assert!(lines(3) == lines(3) && lines(3) != lines(4), "the seed decides");
    }

    #[test]
    fn lines_that_miss_their_image_are_dropped_and_cancelling_stops() {
        let outside = LineCandidate { line1: row(-50.0), line2: row(20.0), cost: 0.0 };
        assert!(sharpened(&[outside], 1).is_empty());
        let cancel = CancelFlag::default();
        cancel.cancel();
        assert_eq!(sharpen(&level(), &[], 4.0, 1, &cancel).unwrap_err(), EstimateError::Cancelled);
    }

    #[test]
    fn a_line_keeps_its_direction_and_moves_no_farther_than_a_step() {
        let mut random = Pcg64Mcg::seed_from_u64(2);
        let back = AnchoredLine { direction: -Vector::x(), ..row(60.0) };
        let still = moved(&back, FRAME, 0.0, &mut random);
        assert!((still.direction - back.direction).norm() < 1e-12 && (still.anchor.y - 60.0).abs() < 1e-9);
        let mut farthest = 0.0f64;
        for _ in 0..200 {
            let tried = moved(&back, FRAME, 5.0, &mut random);
            assert!(tried.direction.x < -0.9);
            for x in [0.0, FRAME.right()] {
                let y = tried.anchor.y + (x - tried.anchor.x) * tried.direction.y / tried.direction.x;
                farthest = farthest.max((y - 60.0).abs());
            }
        }
        assert!((4.0..=5.0).contains(&farthest), "{farthest} px");
    }
}
