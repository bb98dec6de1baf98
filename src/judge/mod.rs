//! Judges a geometry from elsewhere by the matches of the images.
//!
//! The reference is the geometry that the images show: an estimate without clicks and its matches, or
//! matches from elsewhere with their fit. The judgement asks how far the lines of the given
//! geometry are from the lines of the reference, at the matches. If they are too far, the judgement
//! looks for the simplest [`Change`] that brings them together. Most wrong geometries are right in
//! another convention, for resized images, or for a camera without its distortion.
//!
//! # Limits
//! - The lines are compared where there are matches. A geometry may be wrong elsewhere.
//! - Different mistakes may change `F` in the same way. Each [`Change`] names the mistakes it
//!   stands for.

mod cameras;
mod change;
mod rows;
mod search;
mod significance;

pub use change::{Affected, CameraChange, Change, Mirror};
pub use rows::{ROW_LIMIT, RowJudgement, judge_rows};
pub use significance::Significance;

use serde::Serialize;

use crate::geometry::{Camera, Frame, FundamentalMatrix, Line, Matrix9, Point, PointPair, median};

/// Geometry to be judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenGeometry {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Cameras, if the source has any. With them, mistakes with poses and calibrations are tried, too.
    pub cameras: Option<[Camera; 2]>,
}

/// Geometry that the images show, with its matches.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Matches of the images, px.
    pub matches: &'a [PointPair],
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// False if the matches are too few or too doubtful to contradict a geometry.
    pub is_trusted: bool,
    /// Covariance of the nine entries of the matrix with norm 1, row by row, if it is known. A
    /// covariance of the judged geometry is added to it.
    pub covariance: Option<Matrix9>,
}

/// Result of a judgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Finding {
    /// The lines agree with the lines of the images.
    Fits,
    /// The lines are too far from the lines of the images.
    DoesNotFit,
    /// The lines disagree, but the images do not show enough to say which are wrong.
    Undecided,
}

/// Distances over all matches, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distances {
    /// Median.
    pub median: f64,
    /// 90 % of the distances are below this value.
    pub ninety_percent: f64,
}

/// A change of the given geometry after which it fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittingChange {
    /// The change.
    #[serde(flatten)]
    pub change: Change,
    /// Distance from the reference after the change, px, measured as for the judgement.
    pub median: f64,
    /// Fundamental matrix after the change. `None` if no matrix fits the images as they are, because
    /// their lines are curves.
    pub fundamental: Option<FundamentalMatrix>,
}

/// Result of comparing a geometry with the images.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    /// Whether the geometry fits.
    pub finding: Finding,
    /// Distances between the lines of the given geometry and those of the reference, at the matches.
    pub lines_apart: Distances,
    /// Distances of the matches from the lines of the given geometry.
    pub residuals: Distances,
    /// Distances of the matches from the lines of the reference.
    pub reference_residuals: Distances,
    /// Largest median distance between the lines of geometries that agree, px.
    pub limit: f64,
    /// Number of matches.
    pub matches: usize,
    /// The simplest change after which the geometry fits; `None` if no change helps. For a geometry
    /// that fits, a shift by half a pixel that explains a significant difference.
    pub change: Option<FittingChange>,
    /// Whether the geometry differs from the reference by more than the errors of the matches explain.
    /// `None` without a covariance, and if the reference is in doubt.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significance: Option<Significance>,
}

/// Fewest matches for a judgement: twice the seven degrees of freedom of a fundamental matrix.
pub const FEWEST_MATCHES: usize = 14;
/// Usual limit of [`judge`], px. Sound calibrations of four sets of pairs are up to 0.8 px off; lines
/// that are a pixel off already spoil dense matching.
pub const LIMIT: f64 = 1.0;
/// Largest number of matches used. More add no certainty.
const MOST_MATCHES: usize = 2000;

/// Judges a geometry. It fits if half of its lines are within `limit` px of the lines of the
/// reference, and the matches are at most `limit` px farther from them.
///
/// `None` for fewer than [`FEWEST_MATCHES`] matches.
pub fn judge(given: &GivenGeometry, reference: &Reference, limit: f64) -> Option<Judgement> {
    if reference.matches.len() < FEWEST_MATCHES {
        return None;
    }
    let step = reference.matches.len().div_ceil(MOST_MATCHES);
    let matches: Vec<PointPair> = reference.matches.iter().step_by(step).copied().collect();
    let reference = Reference { matches: &matches, ..*reference };
    let lines_apart = reference.lines_apart(&given.fundamental);
    let fits = reference.distance(&given.fundamental) <= limit;
    let covariance = reference.covariance.filter(|_| reference.is_trusted);
    let significance = covariance.as_ref().and_then(|covariance| {
        let (f, own) = (&given.fundamental, &reference.fundamental);
        significance::significance(f, own, covariance, reference.frames)
    });
    let is_significant = significance.is_some_and(|found| found.is_significant);
    let change = match covariance {
        _ if !fits => search::simplest(given, &reference, limit),
        Some(covariance) if is_significant => search::half_pixel(&given.fundamental, &reference, &covariance),
        _ => None,
    };
    let finding = match (fits, reference.is_trusted) {
        (true, _) => Finding::Fits,
        (false, true) => Finding::DoesNotFit,
        (false, false) => Finding::Undecided,
    };
    Some(Judgement {
        finding,
        lines_apart,
        residuals: residuals(&given.fundamental, &matches),
        reference_residuals: residuals(&reference.fundamental, &matches),
        limit,
        matches: matches.len(),
        change,
        significance,
    })
}

impl Reference<'_> {
    /// Returns the distance of a geometry from the reference, px: of its lines at the matches, or of
    /// the matches from its lines if that is larger. It is larger where a lens bends the lines of the
    /// images.
    fn distance(&self, f: &FundamentalMatrix) -> f64 {
        let farther = residuals(f, self.matches).median - residuals(&self.fundamental, self.matches).median;
        self.lines_apart(f).median.max(farther)
    }

    /// Returns the distances between the lines of `f` and those of the reference, each at the place
    /// of the match: the mean of both images.
    fn lines_apart(&self, f: &FundamentalMatrix) -> Distances {
        let own = &self.fundamental;
        let apart = |at: Point, own: Option<Line>, other: Option<Line>| match (own, other) {
            (Some(own), Some(other)) => other.distance(own.foot(at)),
            _ => f64::INFINITY,
        };
        let of = |pair: &PointPair| {
            let PointPair { point1, point2 } = *pair;
            let in2 = apart(point2, own.line2_from_point1(point1), f.line2_from_point1(point1));
            let in1 = apart(point1, own.line1_from_point2(point2), f.line1_from_point2(point2));
            0.5 * (in1 + in2)
        };
        Distances::of(self.matches.iter().map(of))
    }
}

impl Distances {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        let nine_tenths = sorted.len() * 9 / 10;
        let ninety_percent = sorted.get(nine_tenths).copied().unwrap_or(f64::INFINITY);
        Self { median: median(sorted), ninety_percent }
    }
}

/// Returns the symmetric epipolar distances of the matches.
fn residuals(f: &FundamentalMatrix, matches: &[PointPair]) -> Distances {
    Distances::of(matches.iter().map(|pair| crate::geometry::symmetric_epipolar_distance(f, pair)))
}

#[cfg(test)]
mod tests;
