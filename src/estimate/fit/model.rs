//! Kinds of geometry that are fitted to matches: a fundamental matrix or, for known cameras, an essential one.

use nalgebra::Matrix3;
use rand_pcg::Pcg64Mcg;

use super::Match;
use super::false_alarms::{Agreement, OF_A_POSE, OF_LINES, Sample, near_lines_by_chance};
use super::noise::LEAST_SCALE;
use super::scoring::Units;
use crate::estimate::sampling::different;
use crate::geometry::{
    Equation, Frame, FundamentalFit, FundamentalMatrix, Observation, PointPair, fit_fundamental, fit_posed,
    point_equation, solve_five, solve_seven,
};

/// Kind of geometry that is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) enum Model {
    /// A fundamental matrix with seven degrees of freedom.
    Free,
    /// The fundamental matrix of a relative pose, with five degrees of freedom.
    Posed {
        /// Calibration matrices of images without distortion.
        calibrations: [Matrix3<f64>; 2],
    },
}

impl Model {
    /// Returns the model for these calibration matrices. Matrices without inverse describe no cameras.
    pub fn of(calibrations: Option<[Matrix3<f64>; 2]>) -> Self {
        match calibrations.filter(|calibrations| inverses(calibrations).is_some()) {
            Some(calibrations) => Self::Posed { calibrations },
            None => Self::Free,
        }
    }

    /// Returns the calibration matrices of known cameras.
    pub fn calibrations(&self) -> Option<&[Matrix3<f64>; 2]> {
        match self {
            Self::Free => None,
            Self::Posed { calibrations } => Some(calibrations),
        }
    }

    pub fn is_posed(&self) -> bool {
        matches!(self, Self::Posed { .. })
    }

    /// Returns the numbers that determine a geometry.
    pub fn sample(&self) -> Sample {
        if self.is_posed() { OF_A_POSE } else { OF_LINES }
    }

    /// Returns the degrees of freedom: as many matches determine a geometry.
    pub fn unknowns(&self) -> usize {
        self.sample().matches
    }

    /// Returns the agreement of matches that need no picture.
    pub fn agreement(&self, f: &FundamentalMatrix, matches: &[Match], frames: [Frame; 2]) -> Agreement {
        Agreement::of(matches.iter().map(|m| by_chance(f, &m.pair, frames)), self.sample())
    }

    /// Fits a geometry of this kind, from a start ([`fit_fundamental`], [`fit_posed`]).
    pub fn fitted(
        &self,
        start: &FundamentalMatrix,
        observations: &[Observation],
        scale: f64,
    ) -> Option<FundamentalFit> {
        match self {
            Self::Free => fit_fundamental(start, observations, scale),
            Self::Posed { calibrations } => fit_posed(start, calibrations, observations, scale),
        }
    }
}

/// Returns the probability that a match that lies anywhere is as near to its epipolar lines. Matches that need no
/// picture are as precise as they are.
pub(super) fn by_chance(f: &FundamentalMatrix, pair: &PointPair, frames: [Frame; 2]) -> f64 {
    near_lines_by_chance(f, pair, frames, LEAST_SCALE)
}

fn inverses([k1, k2]: &[Matrix3<f64>; 2]) -> Option<[Matrix3<f64>; 2]> {
    Some([k1.try_inverse()?, k2.try_inverse()?])
}

/// Matches from which minimal samples are drawn.
pub(in crate::estimate) struct Samples {
    units: Units,
    /// Inverse calibration matrices of known cameras.
    inverses: Option<[Matrix3<f64>; 2]>,
    equations: Vec<Equation>,
}

impl Samples {
    pub fn new<'m>(model: &Model, units: Units, pairs: impl IntoIterator<Item = &'m PointPair>) -> Self {
        let inverses = model.calibrations().and_then(inverses);
        let place = |pair: &PointPair| match &inverses {
            None => units.pair(pair),
            Some([to1, to2]) => {
                let [a, b] = [to1 * pair.point1.to_homogeneous(), to2 * pair.point2.to_homogeneous()];
                [a.x / a.z, a.y / a.z, b.x / b.z, b.y / b.z]
            }
        };
        let equations = pairs.into_iter().map(|pair| point_equation(place(pair))).collect();
        Self { units, inverses, equations }
    }

    /// Returns the geometries of a random sample, in conditioned coordinates ([`Units`]).
    pub fn drawn(&self, random: &mut Pcg64Mcg) -> Vec<Matrix3<f64>> {
        match self.inverses {
            None => self.solved(&different::<7>(self.equations.len(), random)),
            Some(_) => self.solved(&different::<5>(self.equations.len(), random)),
        }
    }

    /// Returns the geometries of the matches of these numbers: seven, or five for known cameras.
    pub fn solved(&self, sample: &[usize]) -> Vec<Matrix3<f64>> {
        match &self.inverses {
            None => solve_seven(&std::array::from_fn(|k| self.equations[sample[k]])),
            Some([to1, to2]) => {
                let solutions = solve_five(&std::array::from_fn(|k| self.equations[sample[k]]));
                let in_pixels = |e: Matrix3<f64>| to2.transpose() * e * to1;
                solutions.into_iter().map(|e| self.units.conditioned(&in_pixels(e))).collect()
            }
        }
    }
}
