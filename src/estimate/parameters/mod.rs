//! Every number the estimator can be given, in groups that belong to its stages, and its default in each preset. Unit,
//! range and a sentence about each stand in the [table](PARAMETERS).

mod entry;
mod plan;
mod table;

use serde::{Deserialize, Serialize};

use crate::similarity::{LineMeasure, SimilarityParameters, StereoParameters};

pub use entry::{ParameterEntry, ParameterValue};
pub use plan::SearchPlan;
pub use table::PARAMETERS;

/// The choices of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The published choices, with the corrections of `docs/estimator.md`.
    Paper,
    /// What measured best on real images.
    #[default]
    Robust,
}

impl Preset {
    /// Both presets.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Robust];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Robust => "robust",
        }
    }
}

/// How the geometry is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Two point pairs; the third line pair is searched.
    #[default]
    TwoPoint,
    /// Three point pairs; the third gives the third line pair.
    ThreePoint,
    /// No point pair: all lines of both images are compared (section 4).
    #[serde(rename = "lines")]
    LinesAlone,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::TwoPoint, Self::ThreePoint, Self::LinesAlone];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point",
            Self::ThreePoint => "three-point",
            Self::LinesAlone => "lines",
        }
    }

    /// Point pairs it takes.
    pub fn pairs_needed(self) -> usize {
        match self {
            Self::TwoPoint => 2,
            Self::ThreePoint => 3,
            Self::LinesAlone => 0,
        }
    }
}

/// What chooses among the combinations of candidate line pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// Lines alone, as published: bisectors, round trip, validation over both images.
    Lines,
    /// Small image patches: they vote for κ, and their support ranks.
    Patches,
}

impl Search {
    /// Both searches.
    pub const ALL: [Self; 2] = [Self::Lines, Self::Patches];
}

/// How a hypothesis is scored by the lines of its two pencils.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineScore {
    /// Summed stereo cost per sample, as published.
    Cost,
    /// Stereo cost divided by that of deliberately mismatched lines of the same pencils.
    AgainstMismatched,
}

/// What the pencils through a click depend on, besides the line similarity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PencilParameters {
    /// Longer side of the images the pencils are compared at, px: the pyramid level nearest to it is taken.
    pub coarse_side: f64,
    /// Neighbouring lines of a pencil are at most this far apart at the farthest corner, px of that level.
    pub line_spacing: f64,
    /// Largest in-plane rotation between the images, radians.
    pub rotation: f64,
    /// Lines with less texture than this fraction of the pencil's median are dropped.
    pub texture: f64,
    /// Divide the costs of the pencil × pencil matrix by the medians of their row and column.
    pub normalise: bool,
    /// Candidates are line pairs that are among each other's `mutual` best.
    pub mutual: usize,
}

/// How lines alone give a geometry (paper, section 4).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LinesAloneParameters {
    /// About how many lines of each image are compared.
    #[serde(rename = "all_lines")]
    pub lines: usize,
    /// Longer side of the images they are compared at, px.
    #[serde(rename = "all_lines_side")]
    pub side: f64,
    /// How often two candidates and a third are drawn.
    #[serde(rename = "all_lines_draws")]
    pub draws: usize,
    /// A candidate agrees with a geometry when the area between its line and the one it is mapped to is below this many px
    /// times the width of the images that were compared.
    pub agreement: f64,
}

impl Default for LinesAloneParameters {
    fn default() -> Self {
        Self { lines: 2000, side: 192.0, draws: 12_000, agreement: 3.0 }
    }
}

/// How the lines of a hypothesis are validated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValidationParameters {
    /// Fraction of the hypotheses, by round-trip area, that goes through full validation.
    pub validated: f64,
    /// Lines per direction in full validation.
    #[serde(rename = "validation_lines")]
    pub lines: usize,
    /// How full validation scores a hypothesis.
    pub line_score: LineScore,
}

/// How the search with patches goes on from its proposals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PatchParameters {
    /// Most rounds in which new hypotheses are drawn from the matches of the best ones; fewer when they stop
    /// bringing more support.
    pub resampling: usize,
    /// Also draw, in these rounds, epipoles from what lies off the largest planes.
    pub parallax: bool,
    /// Combinations of candidates whose exact support is computed. Not measured.
    pub supported: usize,
    /// Hypotheses whose matches are pooled for resampling. Not measured.
    pub pooled: usize,
    /// Samples of each kind in a round of resampling. Not measured.
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
    /// Minimal samples. Not measured.
    #[serde(rename = "feature_draws")]
    pub draws: usize,
    /// Hypotheses that are refitted. Not measured.
    #[serde(rename = "features_refitted")]
    pub refitted: usize,
    /// Refitted hypotheses that are matched again along their lines. Not measured.
    #[serde(rename = "features_rematched")]
    pub rematched: usize,
    /// Largest number of relative views that features suggest. Not measured.
    #[serde(rename = "feature_views")]
    pub views: usize,
    /// Without clicks, largest number of searches through two drawn matches. If half of the matches
    /// are right, one of four pairs is right with a probability of 68 %.
    #[serde(rename = "stand_in_searches")]
    pub stand_ins: usize,
}

impl Default for FeatureParameters {
    fn default() -> Self {
        Self { draws: 6000, refitted: 30, rematched: 8, views: 2, stand_ins: 4 }
    }
}

/// Refinement of the five numbers of a geometry on lines (paper, section 5.1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LineRefinementParameters {
    /// Rounds at each image size. Not measured.
    #[serde(rename = "line_refinement_rounds")]
    pub rounds: usize,
    /// First step: the turn that moves a line by this many pixels at the far side of the image,
    /// somewhat less than the line spacing.
    #[serde(rename = "line_refinement_step")]
    pub first_step: f64,
    /// Lines in each direction: fewer than in validation, since only neighbours are compared. Not
    /// measured.
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
    /// stereo, so it is larger. Not measured.
    #[serde(rename = "barcode_side")]
    pub side: f64,
    /// Proposals refined of each kind: of the clicks, and of all lines. Not measured.
    #[serde(rename = "barcodes_refined")]
    pub refined: usize,
}

impl Default for BarcodeParameters {
    fn default() -> Self {
        Self { side: 384.0, refined: 3 }
    }
}

/// How all seven degrees of freedom are refined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RefinementParameters {
    /// Refine at full resolution on patches matched along the epipolar lines.
    pub refine: bool,
    /// Best hypotheses that are refined; the one that comes out best is the result.
    pub refined: usize,
    /// Rivals refined if the margin before refinement is too small to decide. Each takes as long as
    /// the result. Not measured.
    #[serde(default = "three")]
    pub rivals: usize,
}

fn three() -> usize {
    3
}

/// All parameters of an estimate. [`Parameters::from`] a [`Preset`] gives its defaults;
/// `docs/parameters.md` lists them, `docs/estimator.md` explains where the presets differ and why.
///
/// In files the groups lie flat: `line_spacing`, not `pencils.line_spacing`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// The preset these started from.
    pub preset: Preset,
    /// How the geometry is found.
    pub method: Method,
    /// Seed of every random choice.
    pub seed: u64,
    /// How two lines are compared.
    #[serde(flatten)]
    pub similarity: SimilarityParameters,
    /// Which lines are compared.
    #[serde(flatten)]
    pub pencils: PencilParameters,
    /// Epipole hypotheses drawn from the candidates.
    pub hypotheses: usize,
    /// How lines alone give a geometry.
    #[serde(flatten)]
    pub lines_alone: LinesAloneParameters,
    /// How hypotheses are validated on lines.
    #[serde(flatten)]
    pub validation: ValidationParameters,
    /// What chooses among the combinations of candidates.
    pub search: Search,
    /// How the search with patches goes on.
    #[serde(flatten)]
    pub patches: PatchParameters,
    /// How features propose.
    #[serde(flatten)]
    pub features: FeatureParameters,
    /// How geometries are refined on lines.
    #[serde(flatten)]
    pub line_refinement: LineRefinementParameters,
    /// How motion barcodes are searched.
    #[serde(flatten)]
    pub barcodes: BarcodeParameters,
    /// How the best hypotheses are refined.
    #[serde(flatten)]
    pub refinement: RefinementParameters,
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
}

impl Parameters {
    /// The parameters of a preset with what no preset chooses: the method, the seed, and what lines are compared by.
    #[must_use]
    pub fn with_preset(&self, preset: Preset) -> Self {
        let Self { method, seed, similarity: SimilarityParameters { measure, .. }, .. } = *self;
        let mut parameters = Self { method, seed, ..Self::from(preset) };
        parameters.similarity.measure = measure;
        parameters
    }

    /// Point pairs without which there is no estimate.
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

    #[test]
    fn parameters_lie_flat_in_files() {
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
    fn numbers_out_of_range_are_named_with_what_is_allowed() {
        let mut parameters = Parameters::default();
        assert_eq!(parameters.check(), Ok(()));
        parameters.pencils.line_spacing = 100.0;
        let told = parameters.check().unwrap_err().to_string();
        assert_eq!(told, "parameter line spacing is 100: it must be between 0.5 and 16 px");
        parameters = Parameters::default();
        parameters.pencils.rotation = f64::NAN;
        assert!(parameters.check().unwrap_err().to_string().ends_with("it must be between 0 and π"));
    }
}
