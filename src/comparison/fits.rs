//! Seven-point and eight-point fits, and distances of points from a geometry.
//!
//! Seven pairs have up to three solutions and cannot decide between them. [`fit_seven`] selects the
//! solution that fits further points best. With true matches as these points, the selection uses
//! the ground truth, as in the published experiment.

use thiserror::Error;

use super::statistics::{mean, median, share_below};
use crate::geometry::{
    EightPointError, FundamentalMatrix, PointPair, SevenPointError, eight_point, sampson_distance,
    seven_point, symmetric_epipolar_distance,
};

/// Fundamental matrix fitted to point pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointFit {
    /// Fitted F.
    pub fundamental: FundamentalMatrix,
    /// Number of fitted pairs.
    pub pairs: usize,
    /// Number of solutions.
    pub solutions: usize,
}

/// Reason why there is no fit. Each message is a clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FitError {
    /// Too few pairs, with the number of missing ones.
    #[error("needs {} more pair{}", .0, if *.0 == 1 { "" } else { "s" })]
    TooFew(usize),
    /// The seven-point algorithm failed.
    #[error(transparent)]
    Seven(#[from] SevenPointError),
    /// The eight-point algorithm failed.
    #[error(transparent)]
    Eight(#[from] EightPointError),
    /// No sample of a robust fit determines a geometry.
    #[error("no seven of these pairs determine a geometry")]
    NoSample,
}

/// Runs the seven-point algorithm on the first seven pairs. Among the real solutions it selects the
/// one with the smallest mean symmetric epipolar distance of the points in `judged`.
pub fn fit_seven(pairs: &[PointPair], judged: &[PointPair]) -> Result<PointFit, FitError> {
    let Some(seven) = pairs.first_chunk::<7>() else {
        return Err(FitError::TooFew(7 - pairs.len()));
    };
    let solutions = seven_point(seven)?;
    let error = |f: &FundamentalMatrix| mean(&Distances::of(f, judged).symmetric);
    let count = solutions.len();
    let best = solutions.into_iter().map(|f| (error(&f), f)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, fundamental) = best.ok_or(SevenPointError::Degenerate)?;
    Ok(PointFit { fundamental, pairs: 7, solutions: count })
}

/// Runs the normalised eight-point algorithm on all pairs, at least eight.
pub fn fit_eight(pairs: &[PointPair]) -> Result<PointFit, FitError> {
    if pairs.len() < 8 {
        return Err(FitError::TooFew(8 - pairs.len()));
    }
    Ok(PointFit { fundamental: eight_point(pairs)?, pairs: pairs.len(), solutions: 1 })
}

/// Distances of points from a geometry, in their order, px. Undefined distances are infinite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Distances {
    /// Symmetric epipolar distances: means over both images.
    pub symmetric: Vec<f64>,
    /// Sampson distances: first-order geometric errors.
    pub sampson: Vec<f64>,
}

impl Distances {
    /// Returns the distances of all points.
    pub fn of(f: &FundamentalMatrix, points: &[PointPair]) -> Self {
        // At both epipoles the distance is 0/0. Means and maxima would ignore NaN.
        let defined = |distance: f64| if distance.is_nan() { f64::INFINITY } else { distance };
        Self {
            symmetric: points.iter().map(|pair| defined(symmetric_epipolar_distance(f, pair))).collect(),
            sampson: points.iter().map(|pair| defined(sampson_distance(f, pair))).collect(),
        }
    }
}

/// Summary of distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Number of distances.
    pub count: usize,
    /// Median distance, px.
    pub median: f64,
    /// Mean distance, px.
    pub mean: f64,
    /// Largest distance, px.
    pub max: f64,
    /// Fraction below 1 px, 0 to 1.
    pub below_one: f64,
}

impl Spread {
    /// Summarises distances; `None` when there are none.
    pub fn of(distances: &[f64]) -> Option<Self> {
        let max = distances.iter().copied().max_by(f64::total_cmp)?;
        Some(Self {
            count: distances.len(),
            median: median(distances),
            mean: mean(distances),
            max,
            below_one: share_below(distances, 1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;

    #[test]
    fn exact_points_give_the_true_geometry_by_both_methods() {
        let matches = RandomScene::new(1).pairs(30);
        let seven = fit_seven(&matches[..9], &matches).unwrap();
        let eight = fit_eight(&matches).unwrap();
        assert_eq!((seven.pairs, eight.pairs, eight.solutions), (7, 30, 1));
        assert!([1, 3].contains(&seven.solutions));
        for fit in [seven, eight] {
            let spread = Spread::of(&Distances::of(&fit.fundamental, &matches).symmetric).unwrap();
            assert!(spread.max < 1e-3 && spread.count == 30, "{spread:?}");
        }
    }

    #[test]
    fn of_three_solutions_the_one_that_fits_the_other_points_counts() {
        // Different sets of seven points; some have three solutions.
        let matches = RandomScene::new(1).pairs(60);
        let several = (0..50).filter(|k| {
            let fit = fit_seven(&matches[*k..], &matches);
            fit.is_ok_and(|fit| {
                let error = mean(&Distances::of(&fit.fundamental, &matches).symmetric);
                assert!(error < 0.1, "{error}");
                fit.solutions > 1
            })
        });
        assert!(several.count() > 5);
    }

    #[test]
    fn says_how_many_pairs_are_missing() {
        let matches = RandomScene::new(1).pairs(7);
        let words = |result: Result<PointFit, FitError>| result.unwrap_err().to_string();
        assert_eq!(words(fit_seven(&matches[..2], &[])), "needs 5 more pairs");
        assert_eq!(words(fit_eight(&matches)), "needs 1 more pair");
        assert!(words(fit_seven(&[matches[0]; 7], &[])).contains("infinitely many"));
    }

    #[test]
    fn a_distance_that_is_not_defined_is_infinite_and_stays_in_the_figures() {
        // Both epipoles are at (64, 32). Powers of two stay exact when the matrix is scaled.
        let epipole = nalgebra::Vector3::new(64.0, 32.0, 1.0);
        let f = FundamentalMatrix::from_rank_two(epipole.cross_matrix()).unwrap();
        let distances = Distances::of(&f, &[PointPair::new(64.0, 32.0, 64.0, 32.0)]);
        assert_eq!((distances.symmetric, distances.sampson), (vec![f64::INFINITY], vec![f64::INFINITY]));
        assert_eq!(Spread::of(&[]), None);
        let spread = Spread::of(&[0.5, f64::INFINITY]).unwrap();
        assert!(spread.max.is_infinite() && (spread.below_one - 0.5).abs() < 1e-12);
    }
}
