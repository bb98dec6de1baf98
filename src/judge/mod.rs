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

mod calibration;
mod cameras;
mod change;
mod contest;
mod depth;
mod rows;
mod search;
mod significance;

pub use calibration::{CalibrationChange, GivenCalibration};
pub use change::{Affected, CameraChange, Change, Mirror};
pub use contest::Contest;
pub use rows::{ROW_LIMIT, RowJudgement, RowMatches, judge_rows};
pub use significance::Significance;

use serde::Serialize;

use crate::geometry::{
    Camera, Frame, FundamentalMatrix, Line, Matrix9, Point, PointPair, median, symmetric_epipolar_distance,
};

/// Geometry to be judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenGeometry {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Cameras, if the source has any. With them, mistakes with poses and calibrations are tried, too.
    pub cameras: Option<[Camera; 2]>,
    /// Calibration, if the matrix belongs to views without distortion. With it, mistakes with lenses and
    /// picture sizes are tried, too.
    pub calibration: Option<GivenCalibration>,
}

/// Gives a matrix without cameras.
impl From<FundamentalMatrix> for GivenGeometry {
    fn from(fundamental: FundamentalMatrix) -> Self {
        Self { fundamental, cameras: None, calibration: None }
    }
}

/// Geometry that the images show, with its matches.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Matches of the images, px.
    pub matches: &'a [PointPair],
    /// Matches found without any geometry, by appearance in the whole of both images, that no other place
    /// resembles. They alone refute: the other matches agree with the matrix by construction, or lie on a
    /// repeated pattern.
    pub witnesses: &'a [PointPair],
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// False if the matches are too few or too doubtful to contradict a geometry.
    pub is_trusted: bool,
    /// False if the matches leave the epipoles open. Then many changes of a geometry explain them, and no change
    /// that moves the epipoles is named.
    pub has_epipoles: bool,
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
    /// The images do not show enough to say whether the geometry is right.
    Undecided,
}

/// Why a geometry is neither found right nor wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Doubt {
    /// The geometry of the images is itself in doubt.
    Reference,
    /// Too few distinctive matches contradict the geometry, or as many contradict the reference. They lie in
    /// few places, or the images show a repeated pattern.
    FewWitnesses {
        /// Places whose distinctive matches only the reference explains (first), and only the geometry
        /// (second).
        places: Contest,
    },
    /// The distinctive matches agree with the geometry, and contradict the reference.
    WitnessesAgree {
        /// Places as for [`Doubt::FewWitnesses`].
        places: Contest,
    },
    /// Most scene points lie behind both cameras, by matches that are not distinctive.
    Depth,
    /// Another search for the geometry of the images gives another finding.
    OtherSearch,
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
    /// Why nothing is found; `None` for the other findings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<Doubt>,
    /// Whether the matrix has two equal singular values, as an essential matrix does. Matrices of rectified
    /// pictures have them, too, so it says little about a geometry that fits.
    pub looks_essential: bool,
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
    /// The change after which the geometry fits; `None` if no change helps, or if several help alike. For a
    /// geometry that fits, a shift by half a pixel that explains a significant difference.
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
/// Relative difference between equal singular values of a matrix that is printed with four digits.
const EQUAL: f64 = 1e-3;
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
    let (verdict, change) = if fits {
        let verdict = reference.depth(given, limit);
        let change = match (verdict, covariance) {
            (Ok(Finding::DoesNotFit), _) => Some(FittingChange {
                change: Change::TranslationReversed,
                median: lines_apart.median,
                fundamental: Some(given.fundamental),
            }),
            (Ok(_), Some(covariance)) if is_significant => {
                search::half_pixel(&given.fundamental, &reference, &covariance)
            }
            _ => None,
        };
        (verdict, change)
    } else {
        let verdict = reference.refuted(given, limit);
        let is_tried = matches!(verdict, Ok(_) | Err(Doubt::FewWitnesses { .. }));
        let change = if is_tried { search::clearest(given, &reference, limit) } else { None };
        match (verdict, change) {
            (Ok(finding), change) => (Ok(finding), change),
            (Err(_), Some(found)) if search::refutes(&found, given, &reference, limit) == Some(true) => {
                (Ok(Finding::DoesNotFit), Some(found))
            }
            (Err(doubt), _) => (Err(doubt), None),
        }
    };
    Some(Judgement {
        finding: verdict.unwrap_or(Finding::Undecided),
        doubt: verdict.err(),
        looks_essential: looks_essential(&given.fundamental),
        lines_apart,
        residuals: residuals(&given.fundamental, &matches),
        reference_residuals: residuals(&reference.fundamental, &matches),
        limit,
        matches: matches.len(),
        change,
        significance,
    })
}

impl Judgement {
    /// Returns this judgement as far as another search for the geometry of the same images confirms it: without
    /// a change that the other judgement does not name, and undecided if the other one finds something else.
    #[must_use]
    pub fn confirmed_by(self, other: &Self, reference: &Reference) -> Self {
        if self.finding != other.finding {
            let (finding, doubt) = (Finding::Undecided, Some(Doubt::OtherSearch));
            return Self { finding, doubt, change: None, ..self };
        }
        let is_same = |a: &FittingChange, b: &FittingChange| {
            a.change.is_like(&b.change)
                && match (a.fundamental, b.fundamental) {
                    (Some(a), Some(b)) => {
                        Reference { fundamental: a, ..*reference }.lines_apart(&b).median <= self.limit
                    }
                    _ => true,
                }
        };
        let change = self.change.filter(|own| other.change.is_some_and(|its| is_same(own, &its)));
        Self { change, ..self }
    }
}

/// Returns whether two singular values of a matrix are equal, to the four digits that are often printed.
fn looks_essential(f: &FundamentalMatrix) -> bool {
    let mut values = f.matrix().singular_values();
    values.as_mut_slice().sort_by(f64::total_cmp);
    values[1] > (1.0 - EQUAL) * values[2]
}

impl Reference<'_> {
    /// Returns whether the witnesses refute a geometry whose lines are far from those of the reference.
    fn refuted(&self, given: &GivenGeometry, limit: f64) -> Result<Finding, Doubt> {
        if !self.is_trusted {
            return Err(Doubt::Reference);
        }
        let explained =
            |f: &FundamentalMatrix, pair: &PointPair| symmetric_epipolar_distance(f, pair) <= limit;
        let vote = |pair: &PointPair| {
            let by = [&self.fundamental, &given.fundamental].map(|f| i32::from(explained(f, pair)));
            (pair.point1, by[0] - by[1])
        };
        let places = Contest::of(self.witnesses.iter().map(vote), self.frames[0]);
        // No place is deducted for the numbers of the reference: a reference is trusted only if its support
        // exceeds what fitting them gives by chance.
        if places.first_wins(0) {
            return Ok(Finding::DoesNotFit);
        }
        let other = Contest { first: places.second, second: places.first };
        Err(if other.first_wins(0) {
            Doubt::WitnessesAgree { places }
        } else {
            Doubt::FewWitnesses { places }
        })
    }

    /// Returns whether a geometry whose lines agree has the scene in front of its cameras.
    fn depth(&self, given: &GivenGeometry, limit: f64) -> Result<Finding, Doubt> {
        let behind = |matches: &[PointPair]| {
            let places = depth::behind(given.cameras.as_ref()?, matches, self.frames[0], limit)?;
            Some(places.first_wins(0))
        };
        if behind(self.witnesses) == Some(true) {
            return Ok(Finding::DoesNotFit);
        }
        if behind(self.matches) == Some(true) { Err(Doubt::Depth) } else { Ok(Finding::Fits) }
    }

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
    Distances::of(matches.iter().map(|pair| symmetric_epipolar_distance(f, pair)))
}

#[cfg(test)]
mod tests;
