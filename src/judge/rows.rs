//! Whether a pair is rectified: matching points lie in the same row, all over the picture.
//!
//! The offset of the right row is a smooth function of the place. A vertical shift makes it
//! constant, a roll of one camera gives it a slope along the rows, and another focal length a slope
//! along the columns. Other rotations and lens distortion curve it.

use nalgebra::{DMatrix, DVector, Matrix3};
use serde::Serialize;

use super::contest::Contest;
use super::{Doubt, FEWEST_MATCHES};
use crate::geometry::{Frame, Point, PointPair, median};

/// Terms of the offset: 1, u, v, u², u v, v², with u and v from −1 to 1 over the picture.
const TERMS: usize = 6;
/// Rounds of reweighting.
const ROUNDS: usize = 20;
/// Smallest scale of the loss, px: about the noise of the best matches.
const LEAST_SCALE: f64 = 0.03;
/// Usual limit of the typical offset, px: half a pixel already spoils dense matching.
pub const ROW_LIMIT: f64 = 0.5;

/// How far a pair is from common rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RowJudgement {
    /// True if the typical offset is within the limit.
    pub is_aligned: bool,
    /// Why nothing is found; `None` if the pair is found rectified or not rectified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<Doubt>,
    /// Right row less left row in the middle of the picture, px.
    pub constant: f64,
    /// Change of the offset from the left edge to the right one, px.
    pub across: f64,
    /// Change of the offset from the top to the bottom, px.
    pub down: f64,
    /// Largest curved part of the offset where there are matches, px.
    pub curved: f64,
    /// Largest smooth offset where there are matches, px.
    pub largest: f64,
    /// Typical offset, px: the root mean square of the smooth offset where there are matches.
    pub typical: f64,
    /// Largest typical offset of a rectified pair, px.
    pub limit: f64,
    /// Number of matches.
    pub matches: usize,
    /// Median distance of the matches from the smooth offset, px.
    pub residual: f64,
    /// Rotation of the right image about its middle that removes `across`, degrees clockwise.
    pub roll_degrees: f64,
    /// Homography of the right image that aligns its rows with the rows of the left image, px. The
    /// curved part of the offset remains.
    pub correction2: [[f64; 3]; 3],
}

/// Typical offset of a pair that was never rectified, in multiples of the limit. No rig drifts so far.
const FAR_FROM_ROWS: f64 = 20.0;

impl RowJudgement {
    /// Returns whether the rows differ by more than the drift of a rig explains. The pair was then
    /// never rectified, or it was rectified for other cameras.
    pub fn is_far_off(&self) -> bool {
        self.typical > FAR_FROM_ROWS * self.limit
    }
}

/// Matches by which rows are judged.
#[derive(Debug, Clone, Copy)]
pub struct RowMatches<'a> {
    /// All matches of the images, px.
    pub matches: &'a [PointPair],
    /// Matches found without any geometry, as in [`Reference::witnesses`](super::Reference::witnesses).
    pub witnesses: &'a [PointPair],
    /// False if the matches are too few or too doubtful to confirm that a pair is rectified.
    pub is_trusted: bool,
}

/// Measures how far a pair is from common rows. The offset is a function of the position in image 2,
/// which has the size `frame`.
///
/// The witnesses decide, since no search and no seed has selected them. If they are too few, the other
/// matches may confirm that the pair is rectified, but they do not contradict it.
///
/// `None` for fewer than [`FEWEST_MATCHES`] matches.
pub fn judge_rows(by: &RowMatches, frame: Frame, limit: f64) -> Option<RowJudgement> {
    let witnessed = measured(by.witnesses, frame, limit);
    if let Some(found) = witnessed.filter(|found| found.is_aligned || found.doubt.is_none()) {
        return Some(RowJudgement { doubt: None, ..found });
    }
    let found = measured(by.matches, frame, limit)?;
    let doubt = match (found.is_aligned, by.is_trusted) {
        (true, true) => None,
        (_, false) => Some(Doubt::Reference),
        (false, true) => {
            let places = Contest::default();
            Some(witnessed.and_then(|found| found.doubt).unwrap_or(Doubt::FewWitnesses { places }))
        }
    };
    Some(RowJudgement { is_aligned: found.is_aligned && doubt.is_none(), doubt, ..found })
}

/// Measures matches. The doubt is the one about a pair that is not rectified: too few places need the offset.
fn measured(matches: &[PointPair], frame: Frame, limit: f64) -> Option<RowJudgement> {
    if matches.len() < FEWEST_MATCHES {
        return None;
    }
    let middle = frame.centre();
    let half = [0.5 * frame.right().max(1.0), 0.5 * frame.bottom().max(1.0)];
    let terms = |x: f64, y: f64| {
        let (u, v) = ((x - middle.x) / half[0], (y - middle.y) / half[1]);
        [1.0, u, v, u * u, u * v, v * v]
    };
    let rows: Vec<f64> = matches.iter().flat_map(|pair| terms(pair.point2.x, pair.point2.y)).collect();
    let design = DMatrix::from_row_slice(matches.len(), TERMS, &rows);
    let offsets = DVector::from_iterator(matches.len(), matches.iter().map(|m| m.point2.y - m.point1.y));
    let mut fit = DVector::zeros(TERMS);
    fit[0] = median(offsets.iter().copied());
    let mut residual = 0.0;
    for _ in 0..ROUNDS {
        let off = &offsets - &design * &fit;
        residual = median(off.iter().map(|off| off.abs()));
        // Weights of a Cauchy loss whose scale is the median distance.
        let scale = residual.max(LEAST_SCALE);
        let weights = off.map(|off| 1.0 / (1.0 + (off / scale).powi(2)));
        let weighted = DMatrix::from_fn(matches.len(), TERMS, |k, term| weights[k] * design[(k, term)]);
        // A little damping: matches in a part of the picture do not determine all terms.
        let normal = design.transpose() * &weighted + DMatrix::identity(TERMS, TERMS) * 1e-6;
        fit = normal.cholesky()?.solve(&(weighted.transpose() * &offsets));
    }
    // The mean of the quadratic terms over the picture belongs to the constant.
    let quadratic =
        |u: f64, v: f64| fit[3] * (u * u - 1.0 / 3.0) + fit[4] * u * v + fit[5] * (v * v - 1.0 / 3.0);
    let constant = fit[0] + (fit[3] + fit[5]) / 3.0;
    // Beyond the matches, the curved terms are not determined.
    let places = |term: usize| {
        let mut sorted: Vec<f64> = design.column(term).iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let edge = sorted.len() / 50;
        let (low, high) = (sorted[edge], sorted[sorted.len() - 1 - edge]);
        (0..=8).map(move |k| low + (high - low) * f64::from(k) / 8.0)
    };
    let grid = places(1).flat_map(|u| places(2).map(move |v| (u, v)));
    let (mut curved, mut largest, mut squares) = (0.0_f64, 0.0_f64, Vec::new());
    for (u, v) in grid {
        let offset = constant + fit[1] * u + fit[2] * v + quadratic(u, v);
        curved = curved.max(quadratic(u, v).abs());
        largest = largest.max(offset.abs());
        squares.push(offset * offset);
    }
    let typical = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // y − (a x + b y + c), with the offset as a function of pixels.
    let (a, b) = (fit[1] / half[0], fit[2] / half[1]);
    let c = constant - a * middle.x - b * middle.y;
    let correction2 = Matrix3::new(1.0, 0.0, 0.0, -a, 1.0 - b, -c, 0.0, 0.0, 1.0);
    let vote = |k: usize, at: Point| {
        let off = [offsets[k] - design.row(k).transpose().dot(&fit), offsets[k]];
        let by = off.map(|off| i32::from(off.abs() <= limit));
        (at, by[0] - by[1])
    };
    let votes = matches.iter().enumerate().map(|(k, pair)| vote(k, pair.point2));
    let places = Contest::of(votes, frame);
    Some(RowJudgement {
        is_aligned: typical <= limit,
        doubt: (!places.first_wins(TERMS)).then_some(Doubt::FewWitnesses { places }),
        constant,
        across: 2.0 * fit[1],
        down: 2.0 * fit[2],
        curved,
        largest,
        typical,
        limit,
        matches: matches.len(),
        residual,
        roll_degrees: -a.atan().to_degrees(),
        correction2: correction2.transpose().data.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    const FRAME: Frame = Frame { width: 640, height: 480 };

    /// Returns matches in common rows, every tenth a wrong one, with the right rows moved.
    fn matches(moved: impl Fn(f64, f64) -> f64) -> Vec<PointPair> {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        (0..400)
            .map(|k| {
                let (x, y) = (random.random_range(0.0..639.0), random.random_range(0.0..479.0));
                let disparity = random.random_range(5.0..60.0);
                let noise = random.random_range(-0.2..0.2)
                    + if k % 10 == 0 { random.random_range(-20.0..20.0) } else { 0.0 };
                PointPair::new(x + disparity, y, x, y + moved(x, y) + noise)
            })
            .collect()
    }

    fn judged(all: &[PointPair]) -> Option<RowJudgement> {
        let by = RowMatches { matches: all, witnesses: all, is_trusted: true };
        let found = judge_rows(&by, FRAME, ROW_LIMIT)?;
        assert!(found.doubt.is_none(), "{found:?}");
        Some(found)
    }

    #[test]
    fn a_rectified_pair_is_aligned() {
        let found = judged(&matches(|_, _| 0.0)).unwrap();
        assert!(found.is_aligned && found.largest < 0.2, "{found:?}");
        assert!(judged(&matches(|_, _| 0.0)[..13]).is_none());
        // All matches in one place determine nothing but the offset there.
        let one = vec![PointPair::new(100.0, 100.0, 80.0, 100.0); 20];
        assert!(judged(&one).unwrap().constant.abs() < 1.0);
    }

    #[test]
    fn only_witnesses_in_many_places_contradict() {
        let off = matches(|_, _| 3.0);
        let at = |by: &RowMatches| judge_rows(by, FRAME, ROW_LIMIT).unwrap();
        // A board: its matches were found along wrong lines, and nothing else is to be seen.
        let board = at(&RowMatches { matches: &off, witnesses: &[], is_trusted: true });
        assert_eq!(
            (board.is_aligned, board.doubt),
            (false, Some(Doubt::FewWitnesses { places: Contest::default() }))
        );
        let few: Vec<PointPair> =
            off.iter().filter(|m| m.point2.x < 200.0 && m.point2.y < 200.0).copied().collect();
        let found = at(&RowMatches { matches: &off, witnesses: &few, is_trusted: true });
        assert!(
            !found.is_aligned
                && matches!(found.doubt, Some(Doubt::FewWitnesses { places }) if places.first > 0)
        );
        // Witnesses outvote the matches.
        let right = matches(|_, _| 0.0);
        let found = at(&RowMatches { matches: &off, witnesses: &right, is_trusted: true });
        assert!(found.is_aligned && found.doubt.is_none());
        // A doubtful geometry of the images confirms nothing.
        let found = at(&RowMatches { matches: &right, witnesses: &[], is_trusted: false });
        assert_eq!((found.is_aligned, found.doubt), (false, Some(Doubt::Reference)));
    }

    #[test]
    fn shift_turn_and_curvature_are_told_with_their_size() {
        let shifted = judged(&matches(|_, _| 1.0)).unwrap();
        assert!(!shifted.is_aligned && (shifted.constant - 1.0).abs() < 0.05, "{shifted:?}");
        let slope = 0.2_f64.to_radians();
        let turned = judged(&matches(|x, _| slope * (x - 319.5))).unwrap();
        assert!(!turned.is_aligned && (turned.roll_degrees + 0.2).abs() < 0.01, "{turned:?}");
        let bent = |x: f64, y: f64| 2.0 * ((x - 319.5) / 319.5) * ((y - 239.5) / 239.5);
        let curved = judged(&matches(bent)).unwrap();
        assert!(!curved.is_aligned && (curved.curved - 2.0).abs() < 0.2, "{curved:?}");
        assert!(curved.across.abs() < 0.1 && curved.down.abs() < 0.1, "{curved:?}");
    }

    #[test]
    fn the_correction_aligns_the_rows() {
        let mut all = matches(|x, y| 1.5 + 0.004 * (x - 300.0) - 0.006 * (y - 200.0));
        let correction2 = judged(&all).unwrap().correction2;
        for pair in &mut all {
            let [_, [a, b, c], _] = correction2;
            pair.point2.y = a * pair.point2.x + b * pair.point2.y + c;
        }
        let after = judged(&all).unwrap();
        assert!(after.largest < 0.1, "{after:?}");
    }
}
