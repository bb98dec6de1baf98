//! Origin of a geometry: the data from which it was proposed.

use serde::Serialize;

use crate::geometry::FundamentalMatrix;

/// Origin of a geometry. Fits and refinement keep the origin of their start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Data of the first proposal.
    #[serde(flatten)]
    pub source: ProposedBy,
    /// Sampling of matches that led from the first proposal to this geometry. `None` if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub then: Option<Resampling>,
}

/// Data from which a geometry was proposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "by", rename_all = "kebab-case")]
pub enum ProposedBy {
    /// Two candidate line pairs, one through each anchor.
    LinePairs {
        /// Ranks among the candidates of each anchor, from 1, best first.
        ranks: [usize; 2],
    },
    /// Matches of covariant features.
    Features,
    /// Matches of covariant features, with known cameras.
    KnownCameras,
    /// Matches of another program.
    GivenMatches,
    /// All lines of both images.
    AllLines,
    /// The clicks alone.
    Clicks,
}

/// Sampling of matches that support a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Resampling {
    /// Small samples of the matches.
    SupportingMatches,
    /// The largest plane, and samples of the matches beside it.
    Parallax,
}

impl From<ProposedBy> for Origin {
    fn from(source: ProposedBy) -> Self {
        Self { source, then: None }
    }
}

impl Origin {
    /// Returns the origin of a sample of the matches of this geometry.
    pub(super) fn then(self, resampling: Resampling) -> Self {
        Self { then: Some(resampling), ..self }
    }
}

/// A geometry in full-size pixels, with its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Proposed {
    pub fundamental: FundamentalMatrix,
    pub origin: Origin,
}

impl Proposed {
    pub fn by(source: ProposedBy, fundamental: FundamentalMatrix) -> Self {
        Self { fundamental, origin: source.into() }
    }
}
