//! What an estimate holds.

use std::sync::Arc;

use serde::Serialize;

use super::{
    ComparedPencils, Construction, Method, Parameters, Preset, RefinedMatch, Stage, Trust, Uncertainty,
    Warning,
};
use crate::geometry::{FundamentalMatrix, HomogeneousPoint};

/// One hypothesis of the geometry: two line pairs through the clicks and κ, in full-size pixels.
#[derive(Debug, Clone, Serialize)]
pub struct Hypothesis {
    /// Its fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Full-validation score, lower is better; see the module docs of `validation` for its unit. NaN before
    /// validation, like the two figures that need G.
    pub score: f64,
    /// Patch support: summed correlation excess of the patches that agree with it, higher is better. 0 when
    /// the preset does not use it.
    pub support: f64,
    /// Mean epipolar area between `l` and `GH l`, divided by the image width: px.
    pub round_trip_area: f64,
    /// κ of the paper's H: bisector chosen in image 1, matching line found in image 2.
    pub kappa_line2_from_line1: f64,
    /// κ of the paper's G: bisector chosen in image 2, matching line found in image 1.
    pub kappa_line1_from_line2: f64,
    /// The lines it is built from.
    #[serde(skip)]
    pub construction: Construction,
}

impl Hypothesis {
    /// The epipole in image 1.
    pub fn epipole1(&self) -> HomogeneousPoint {
        self.fundamental.epipole1()
    }

    /// The epipole in image 2.
    pub fn epipole2(&self) -> HomogeneousPoint {
        self.fundamental.epipole2()
    }
}

/// How much was examined.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Textured lines in image 1 through each click.
    pub lines1: Vec<usize>,
    /// Textured lines in image 2 through each click.
    pub lines2: Vec<usize>,
    /// Candidate line pairs through each click.
    pub candidates: Vec<usize>,
    /// Hypotheses examined.
    pub hypotheses: usize,
    /// Hypotheses that went through full validation.
    pub validated: usize,
}

/// Time spent in one stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTiming {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Patches that agree with a geometry.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PatchSupport {
    /// Mutual best matches along the epipolar lines.
    pub matches: usize,
    /// Sum over them of the correlation in excess of 0.6.
    pub score: f64,
}

/// A fundamental matrix and how it came about. All coordinates are full-size pixels.
#[derive(Debug, Clone, Serialize)]
pub struct Estimate {
    /// `x2ᵀ F x1 = 0`.
    pub fundamental: FundamentalMatrix,
    /// Epipole in image 1, homogeneous, unit norm.
    pub epipole1: HomogeneousPoint,
    /// Epipole in image 2, homogeneous, unit norm.
    pub epipole2: HomogeneousPoint,
    /// Full-validation score of the result, lower is better.
    pub score: f64,
    /// Mean epipolar area between `l` and `GH l` over the width of image 1, px.
    pub round_trip_area: f64,
    /// Patches that agree with the result, if the preset looks at patches.
    pub support: Option<PatchSupport>,
    /// Advantage over the best clearly different hypothesis, relative to the better of the two: of patch
    /// support when the preset uses it, else of the score. `None` when there is no other hypothesis.
    pub margin: Option<f64>,
    /// How it was computed.
    pub method: Method,
    /// Whose choices it was computed with.
    pub preset: Preset,
    /// The seed of every random choice.
    pub seed: u64,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// How much was examined.
    pub counts: Counts,
    /// Time per stage, in their order.
    pub timings: Vec<StageTiming>,
    /// Seconds until the first fundamental matrix.
    pub first_seconds: f64,
    /// Seconds in all.
    pub seconds: f64,
    /// How far to trust it; `None` while it is preliminary.
    pub trust: Option<Trust>,
    /// How well it is determined, when it was refined.
    #[serde(skip)]
    pub uncertainty: Option<Uncertainty>,
    /// Whether all seven degrees of freedom were refined at full resolution.
    pub refined: bool,
    /// The pencils through the first and the second click, as they were compared.
    #[serde(skip)]
    pub pencils: Option<Arc<[ComparedPencils; 2]>>,
    /// The result with the figures and the lines of a hypothesis; `None` while it is preliminary.
    #[serde(skip)]
    pub examined: Option<Hypothesis>,
    /// The best hypotheses that differ from each other, best first, as they were before refinement.
    #[serde(skip)]
    pub hypotheses: Vec<Hypothesis>,
    /// The matches the refinement rests on.
    #[serde(skip)]
    pub matches: Vec<RefinedMatch>,
}

impl Estimate {
    /// An estimate that holds a matrix and nothing about how it came about: for a matrix from elsewhere.
    pub fn of(fundamental: FundamentalMatrix, parameters: &Parameters) -> Self {
        Self {
            fundamental,
            epipole1: fundamental.epipole1(),
            epipole2: fundamental.epipole2(),
            score: f64::NAN,
            round_trip_area: f64::NAN,
            support: None,
            margin: None,
            method: parameters.method,
            preset: parameters.preset,
            seed: parameters.seed,
            warnings: Vec::new(),
            counts: Counts::default(),
            timings: Vec::new(),
            first_seconds: 0.0,
            seconds: 0.0,
            trust: None,
            uncertainty: None,
            refined: false,
            pencils: None,
            examined: None,
            hypotheses: Vec::new(),
            matches: Vec::new(),
        }
    }
}
