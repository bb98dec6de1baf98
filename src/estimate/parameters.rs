//! Every number the estimator can be given, with its unit and default.

use serde::{Deserialize, Serialize};

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
    /// Point pairs it takes.
    pub fn pairs_needed(self) -> usize {
        match self {
            Self::TwoPoint => 2,
            Self::ThreePoint => 3,
        }
    }
}

/// All parameters of an estimate. [`Parameters::from`] a [`Preset`] gives its defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// The preset these started from.
    pub preset: Preset,
    /// How the geometry is found.
    pub method: Method,
    /// Seed of every random choice.
    pub seed: u64,
}

impl From<Preset> for Parameters {
    fn from(preset: Preset) -> Self {
        Self { preset, method: Method::default(), seed: 0 }
    }
}

impl Default for Parameters {
    fn default() -> Self {
        Self::from(Preset::default())
    }
}
