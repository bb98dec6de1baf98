//! Candidate line pairs, moved to where their barcodes agree best.
//!
//! The lines that were compared are some pixels apart, and a line that misses the epipole has no corresponding line at
//! all. Both lines of a candidate move until their barcodes agree: there is a pencil of pairs that do, and the candidate
//! ends on one of them.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::estimate::lines::LineCandidate;
use crate::geometry::{AnchoredLine, Frame, Point, Vector};
use crate::similarity::ScaledSimilarity;

/// Candidates that are moved, the best ones: enough for a consensus.
const MOVED: usize = 400;
/// Rounds, and moves tried a round.
const ROUNDS: usize = 6;
const TRIALS: usize = 16;
/// Each round moves less far than the one before.
const SHRINKING: f64 = 0.6;
/// Candidates kept last with which one is compared to tell whether it is the same pair: sorted by cost, equal pairs are
/// near each other.
const RECENT: usize = 8;

/// The best candidates with both lines moved by up to about `step` px at either end, best first.
pub(super) fn sharpen(
    level: &ScaledSimilarity,
    candidates: &[LineCandidate],
    step: f64,
    seed: u64,
    cancel: &CancelFlag,
) -> Result<Vec<LineCandidate>, EstimateError> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut best: Vec<LineCandidate> = Vec::with_capacity(MOVED);
    for candidate in candidates {
        // A barcode is the same from either end, so each pair is there twice.
        let is_new = |kept: &LineCandidate| {
            kept.line1 != candidate.line1 || kept.line2.anchor != candidate.line2.anchor
        };
        if best.len() < MOVED && best.iter().rev().take(RECENT).all(is_new) {
            best.push(*candidate);
        }
    }
    // Costs that were normalised are in another unit.
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

/// The line with both ends in the image moved across it.
fn moved(line: &AnchoredLine, frame: Frame, step: f64, random: &mut Pcg64Mcg) -> AnchoredLine {
    let Some(seen) = frame.clip(&line.line()) else { return *line };
    let across = Vector::new(-line.direction.y, line.direction.x);
    let mut end = |at: Point| at + across * (step * (random.random::<f64>() + random.random::<f64>() - 1.0));
    let (start, end) = (end(seen.start), end(seen.end));
    let Some(direction) = (end - start).try_normalize(1e-9) else { return *line };
    let direction = if direction.dot(&line.direction) < 0.0 { -direction } else { direction };
    AnchoredLine { anchor: nalgebra::center(&start, &end), direction }
}
