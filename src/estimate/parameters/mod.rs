//! Parameters of the estimator, in groups by stage, with their defaults in each preset. The
//! [table](PARAMETERS) has their units and ranges.

mod entry;
mod plan;
mod table;

use serde::{Deserialize, Serialize};

use crate::similarity::{LineMeasure, SimilarityParameters, StereoParameters};

pub use entry::{ParameterEntry, ParameterValue};
pub use plan::SearchPlan;
pub use table::PARAMETERS;

named! {
    fn name;
    /// Preset of all parameters.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Preset {
        /// The published method, with the corrections of `docs/estimator.md`.
        Paper = "paper",
        /// The values that measured best on real images.
        #[default]
        Robust = "robust",
    }
}

named! {
    fn name;
    /// Input from which the geometry is found.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Method {
        /// Two point pairs; the third line pair is searched.
        #[default]
        TwoPoint = "two-point",
        /// Three point pairs; the third gives the third line pair.
        ThreePoint = "three-point",
        /// No point pair; all lines of both images are compared (paper, section 4).
        #[serde(rename = "lines")]
        LinesAlone = "lines",
    }
}

impl Method {
    /// Returns the method of a search with this number of clicked pairs, where none is asked for.
    pub fn usual(pairs: usize, search: Search) -> Self {
        match (pairs, search) {
            (0, Search::Lines) => Self::LinesAlone,
            (0..3, _) => Self::TwoPoint,
            _ => Self::ThreePoint,
        }
    }

    /// Returns the number of point pairs that the method needs.
    pub fn pairs_needed(self) -> usize {
        match self {
            Self::TwoPoint => 2,
            Self::ThreePoint => 3,
            Self::LinesAlone => 0,
        }
    }
}

named! {
    /// Evidence that ranks the combinations of candidate line pairs.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Search {
        /// Lines alone, as published: bisectors, round trips, and validation over both images.
        Lines,
        /// Small image patches: they vote for κ, and their support ranks the combinations.
        Patches,
    }
}

/// Score of a hypothesis by the lines of its two pencils.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineScore {
    /// Summed stereo cost per sample, as published.
    Cost,
    /// Stereo cost divided by the cost of deliberately mismatched lines of the same pencils.
    AgainstMismatched,
}

/// Parameters of the pencils through a click, besides the line similarity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PencilParameters {
    /// Longer side of the images in which pencils are compared, px. The nearest pyramid level is
    /// used.
    pub coarse_side: f64,
    /// Distance between neighbouring lines of a pencil at the farthest corner, px of that level.
    pub line_spacing: f64,
    /// Largest in-plane rotation between the images, radians.
    pub rotation: f64,
    /// Fraction of the pencil's median texture below which a line is dropped.
    pub texture: f64,
    /// Whether each cost is divided by the geometric mean of the medians of its row and its column.
    pub normalise: bool,
    /// Number of best partners: two lines are a candidate if each is among this many best of the
    /// other.
    pub mutual: usize,
}

/// Search with lines alone (paper, section 4).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LinesAloneParameters {
    /// Approximate number of lines of each image that are compared.
    #[serde(rename = "all_lines")]
    pub lines: usize,
    /// Longer side of the images in which the lines are compared, px.
    #[serde(rename = "all_lines_side")]
    pub side: f64,
    /// Number of draws of two candidates and a third.
    #[serde(rename = "all_lines_draws")]
    pub draws: usize,
    /// Largest area between a line and its mapped partner for a candidate to agree with a geometry,
    /// in px times the width of the compared images.
    pub agreement: f64,
}

impl Default for LinesAloneParameters {
    fn default() -> Self {
        Self { lines: 2000, side: 192.0, draws: 12_000, agreement: 3.0 }
    }
}

/// Validation of hypotheses on lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValidationParameters {
    /// Fraction of the hypotheses that is fully validated, by smallest round-trip area.
    pub validated: f64,
    /// Number of lines per image in full validation.
    #[serde(rename = "validation_lines")]
    pub lines: usize,
    /// Score of full validation.
    pub line_score: LineScore,
}

/// Search with patches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PatchParameters {
    /// Largest number of rounds in which new hypotheses are drawn from the matches of the best.
    /// Rounds end earlier when support no longer grows.
    pub resampling: usize,
    /// Whether these rounds also draw epipoles from matches off the largest planes.
    pub parallax: bool,
    /// Number of combinations of candidates whose exact support is computed, most votes first. The
    /// time is in proportion.
    pub supported: usize,
    /// Number of hypotheses whose matches are pooled for resampling. More add matches of wrong
    /// hypotheses.
    pub pooled: usize,
    /// Number of samples of each kind in a round of resampling.
    #[serde(rename = "resampling_draws")]
    pub samples: usize,
}

impl Default for PatchParameters {
    fn default() -> Self {
        Self { resampling: 5, parallax: true, supported: 240, pooled: 6, samples: 1500 }
    }
}

/// Search with covariant features. In files the names begin with `feature`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FeatureParameters {
    /// Number of minimal samples. The time is in proportion.
    #[serde(rename = "feature_draws")]
    pub draws: usize,
    /// Number of hypotheses that are refitted.
    #[serde(rename = "features_refitted")]
    pub refitted: usize,
    /// Number of refitted hypotheses that are matched again along their lines.
    #[serde(rename = "features_rematched")]
    pub rematched: usize,
    /// Largest number of relative views that features suggest. Each takes a search of its own.
    #[serde(rename = "feature_views")]
    pub views: usize,
    /// Largest number of searches through two drawn matches, without clicks. If half of the matches
    /// are right, at least one of four pairs is right with a probability of 68 %.
    #[serde(rename = "stand_in_searches")]
    pub stand_ins: usize,
    /// Whether the geometry is fitted to the matches of another program alone, if there are any
    /// ([`add_matches`](super::PreparedPair::add_matches)). The images then only judge it.
    pub given_alone: bool,
}

impl Default for FeatureParameters {
    fn default() -> Self {
        Self { draws: 6000, refitted: 30, rematched: 8, views: 2, stand_ins: 4, given_alone: false }
    }
}

/// Refinement of the five numbers of a geometry on lines (paper, section 5.1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LineRefinementParameters {
    /// Number of rounds at each image size.
    #[serde(rename = "line_refinement_rounds")]
    pub rounds: usize,
    /// First step: the rotation that moves a line by this many pixels at the far side of the image.
    /// Somewhat less than the line spacing.
    #[serde(rename = "line_refinement_step")]
    pub first_step: f64,
    /// Number of lines per image. Fewer than in validation, since only similar geometries are
    /// compared.
    #[serde(rename = "line_refinement_lines")]
    pub lines: usize,
}

impl Default for LineRefinementParameters {
    fn default() -> Self {
        Self { rounds: 8, first_step: 1.5, lines: 12 }
    }
}

/// Search by motion barcodes (paper, section 2.3).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BarcodeParameters {
    /// Least longer side of the images in which lines are compared, px. Barcodes cost less than
    /// stereo, so it is larger.
    #[serde(rename = "barcode_side")]
    pub side: f64,
    /// Number of refined proposals of each kind: from the clicks, and from all lines.
    #[serde(rename = "barcodes_refined")]
    pub refined: usize,
}

impl Default for BarcodeParameters {
    fn default() -> Self {
        Self { side: 384.0, refined: 3 }
    }
}

/// Refinement of all seven degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RefinementParameters {
    /// Whether `F` is refined at full resolution, on patches matched along the epipolar lines.
    pub refine: bool,
    /// Number of best hypotheses that are refined. The best refined one is the result.
    pub refined: usize,
    /// Number of rivals that are refined if the margin of a geometry of clicks or given matches is too small to decide.
    /// Each takes as long as the result.
    #[serde(default = "three")]
    pub rivals: usize,
}

fn three() -> usize {
    3
}

/// All parameters of an estimate. [`Parameters::from`] a [`Preset`] gives its defaults.
/// `docs/parameters.md` lists the parameters; `docs/estimator.md` explains the presets.
///
/// In files the groups are flat: `line_spacing`, not `pencils.line_spacing`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Preset from which these parameters started.
    pub preset: Preset,
    /// Input from which the geometry is found.
    pub method: Method,
    /// Seed of every random choice.
    pub seed: u64,
    /// Comparison of two lines.
    #[serde(flatten)]
    pub similarity: SimilarityParameters,
    /// Pencils of lines.
    #[serde(flatten)]
    pub pencils: PencilParameters,
    /// Number of epipole hypotheses drawn from the candidates.
    pub hypotheses: usize,
    /// Search with lines alone.
    #[serde(flatten)]
    pub lines_alone: LinesAloneParameters,
    /// Validation of hypotheses on lines.
    #[serde(flatten)]
    pub validation: ValidationParameters,
    /// Evidence that ranks the combinations of candidates.
    pub search: Search,
    /// Search with patches.
    #[serde(flatten)]
    pub patches: PatchParameters,
    /// Search with features.
    #[serde(flatten)]
    pub features: FeatureParameters,
    /// Refinement on lines.
    #[serde(flatten)]
    pub line_refinement: LineRefinementParameters,
    /// Search by motion barcodes.
    #[serde(flatten)]
    pub barcodes: BarcodeParameters,
    /// Refinement of the best hypotheses.
    #[serde(flatten)]
    pub refinement: RefinementParameters,
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
}

impl Parameters {
    /// Returns the parameters of another preset. Keeps the method, the seed and the line measure,
    /// which no preset chooses.
    #[must_use]
    pub fn with_preset(&self, preset: Preset) -> Self {
        let Self { method, seed, similarity: SimilarityParameters { measure, .. }, .. } = *self;
        let mut parameters = Self { method, seed, ..Self::from(preset) };
        parameters.similarity.measure = measure;
        parameters
    }

    /// Returns the number of point pairs without which no estimate is possible.
    pub fn pairs_needed(&self) -> usize {
        SearchPlan::of(self, 0).least_clicks()
    }
}

impl From<Preset> for Parameters {
    fn from(preset: Preset) -> Self {
        let paper = Self {
            preset,
            method: Method::default(),
            seed: 0,
            similarity: SimilarityParameters {
                measure: LineMeasure::Stereo,
                stereo: StereoParameters::PAPER,
                disparity_reach: 0.125,
            },
            pencils: PencilParameters {
                coarse_side: 192.0,
                line_spacing: 2.0,
                rotation: std::f64::consts::FRAC_PI_4,
                texture: 0.25,
                normalise: false,
                mutual: 1,
            },
            hypotheses: 2000,
            lines_alone: LinesAloneParameters { draws: 2000, ..LinesAloneParameters::default() },
            validation: ValidationParameters { validated: 0.05, lines: 24, line_score: LineScore::Cost },
            search: Search::Lines,
            patches: PatchParameters::default(),
            features: FeatureParameters::default(),
            line_refinement: LineRefinementParameters::default(),
            barcodes: BarcodeParameters::default(),
            refinement: RefinementParameters { refine: false, refined: 8, rivals: three() },
            click_sigma: 1.0,
        };
        match preset {
            Preset::Paper => paper,
            Preset::Robust => Self {
                similarity: SimilarityParameters {
                    measure: LineMeasure::Stereo,
                    stereo: StereoParameters {
                        lambda: 400,
                        alpha: 2000,
                        outside: 1500,
                        ..StereoParameters::PAPER
                    },
                    disparity_reach: 0.16,
                },
                pencils: PencilParameters { coarse_side: 96.0, normalise: true, mutual: 5, ..paper.pencils },
                lines_alone: LinesAloneParameters::default(),
                validation: ValidationParameters {
                    validated: 1.0,
                    line_score: LineScore::AgainstMismatched,
                    ..paper.validation
                },
                search: Search::Patches,
                refinement: RefinementParameters { refine: true, ..paper.refinement },
                ..paper
            },
        }
    }
}

impl Default for Parameters {
    fn default() -> Self {
        Self::from(Preset::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::EstimateError;

    #[test]
    fn parameters_are_flat_in_files() {
        let parameters = Parameters { seed: u64::MAX - 5, ..Parameters::default() };
        let mut data = serde_json::to_value(&parameters).unwrap();
        assert_eq!(data["stereo"]["lambda"], 400);
        assert_eq!((&data["line_spacing"], &data["validation_lines"]), (&2.0.into(), &24.into()));
        assert_eq!(data["search"], "patches");
        assert_eq!(serde_json::from_value::<Parameters>(data.clone()).unwrap(), parameters);
        data["search"] = "maybe".into();
        assert!(serde_json::from_value::<Parameters>(data).is_err());
    }

    #[test]
    fn a_value_out_of_range_is_refused_with_its_range() {
        let mut parameters = Parameters::default();
        assert_eq!(parameters.check(), Ok(()));
        parameters.pencils.line_spacing = 100.0;
        let (key, value, range, unit) = ("line_spacing", 100.0, [0.5, 16.0], " px");
        assert_eq!(parameters.check(), Err(EstimateError::Parameter { key, value, range, unit }));
        parameters = Parameters::default();
        parameters.pencils.rotation = f64::NAN;
        assert!(matches!(parameters.check(), Err(EstimateError::Parameter { key: "rotation", .. })));
    }
}
