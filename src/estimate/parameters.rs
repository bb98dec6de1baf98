//! Every number the estimator can be given, with its unit and default.

use serde::{Deserialize, Serialize};

use super::EstimateError;
use crate::similarity::StereoParameters;

/// Whose choices to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// As published, with the corrections of the documentation.
    Paper,
    /// What measured best on real images.
    #[default]
    Robust,
}

impl Preset {
    /// Both presets.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Robust];

    /// Its name on the command line and in files.
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
}

impl Method {
    /// Both methods.
    pub const ALL: [Self; 2] = [Self::TwoPoint, Self::ThreePoint];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point",
            Self::ThreePoint => "three-point",
        }
    }

    /// Point pairs it takes.
    pub fn pairs_needed(self) -> usize {
        match self {
            Self::TwoPoint => 2,
            Self::ThreePoint => 3,
        }
    }
}

/// How a hypothesis is scored by the lines of its two pencils.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineScore {
    /// Summed stereo cost per sample, as published.
    Cost,
    /// The same divided by the cost of deliberately mismatched lines of the same pencils.
    AgainstMismatched,
}

/// All parameters of an estimate. [`Parameters::from`] a [`Preset`] gives its defaults; the table in the
/// documentation of [`crate::estimate`] explains where the presets differ and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Parameters {
    /// The preset these started from.
    pub preset: Preset,
    /// How the geometry is found.
    pub method: Method,
    /// Seed of every random choice.
    pub seed: u64,
    /// The numbers of the stereo cost.
    pub stereo: StereoParameters,
    /// Largest disparity tried, as a fraction of the longer image side, either way.
    pub disparity_reach: f64,
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
    /// Epipole hypotheses drawn from the candidates.
    pub hypotheses: usize,
    /// Fraction of the hypotheses, by round-trip area, that goes through full validation.
    pub validated: f64,
    /// Lines per direction in full validation.
    pub validation_lines: usize,
    /// How full validation scores a hypothesis.
    pub line_score: LineScore,
    /// Let patch support choose among combinations of candidates, instead of the round trip and the lines
    /// alone.
    pub patch_support: bool,
    /// Most rounds in which new hypotheses are drawn from the matches of the best ones; fewer when they stop
    /// bringing more support. Needs patch support, like the next two.
    pub resampling: usize,
    /// In these rounds, also draw epipoles from what lies off the largest planes.
    pub parallax: bool,
    /// Refine all seven degrees of freedom at full resolution on patches matched along the epipolar lines.
    pub refine: bool,
    /// Best hypotheses that are refined; the one that comes out best is the result.
    pub refined: usize,
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
}

impl From<Preset> for Parameters {
    fn from(preset: Preset) -> Self {
        let paper = Self {
            preset,
            method: Method::default(),
            seed: 0,
            stereo: StereoParameters::PAPER,
            disparity_reach: 0.125,
            coarse_side: 192.0,
            line_spacing: 2.0,
            rotation: std::f64::consts::FRAC_PI_4,
            texture: 0.25,
            normalise: false,
            mutual: 1,
            hypotheses: 2000,
            validated: 0.05,
            validation_lines: 24,
            line_score: LineScore::Cost,
            patch_support: false,
            resampling: 5,
            parallax: true,
            refine: false,
            refined: 8,
            click_sigma: 1.0,
        };
        match preset {
            Preset::Paper => paper,
            Preset::Robust => Self {
                stereo: StereoParameters {
                    lambda: 400,
                    alpha: 2000,
                    outside: 1500,
                    ..StereoParameters::PAPER
                },
                normalise: true,
                disparity_reach: 0.16,
                mutual: 5,
                hypotheses: 12_000,
                validated: 1.0,
                line_score: LineScore::AgainstMismatched,
                patch_support: true,
                refine: true,
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

impl Parameters {
    /// Checks every number against its range.
    pub fn check(&self) -> Result<(), EstimateError> {
        let in_range = |name, value: f64, low: f64, high: f64, allowed| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(EstimateError::Parameter { name, value: value.to_string(), allowed })
            }
        };
        in_range("disparity reach", self.disparity_reach, 0.005, 0.5, "between 0.005 and 0.5")?;
        in_range("coarse side", self.coarse_side, 32.0, 1024.0, "between 32 and 1024 px")?;
        in_range("line spacing", self.line_spacing, 0.5, 16.0, "between 0.5 and 16 px")?;
        in_range("rotation", self.rotation, 0.0, std::f64::consts::PI, "between 0 and π")?;
        in_range("texture", self.texture, 0.0, 1.0, "between 0 and 1")?;
        in_range("mutual", self.mutual as f64, 1.0, 20.0, "between 1 and 20")?;
        in_range("hypotheses", self.hypotheses as f64, 1.0, 1e6, "between 1 and 1,000,000")?;
        in_range("validated", self.validated, 0.0, 1.0, "between 0 and 1")?;
        in_range("validation lines", self.validation_lines as f64, 4.0, 1000.0, "between 4 and 1,000")?;
        in_range("resampling", self.resampling as f64, 0.0, 20.0, "between 0 and 20")?;
        in_range("refined", self.refined as f64, 1.0, 60.0, "between 1 and 60")?;
        in_range("click standard deviation", self.click_sigma, 0.01, 20.0, "between 0.01 and 20 px")
    }
}
