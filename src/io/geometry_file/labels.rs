//! What is known of a geometry and its pairs besides their numbers: the verdict, and where each pair comes from.

use serde::{Deserialize, Serialize};

use crate::estimate::Trust;

/// Where the points of a pair come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairOrigin {
    /// A person placed both points.
    #[default]
    Clicked,
    /// A person placed one, and took the suggested match for the other.
    Suggested,
    /// A person placed both, and one was aligned to a fraction of a pixel.
    Refined,
    /// One point was moved to the best match on its line.
    MovedToMatch,
    /// Both points were read from a file.
    Imported,
    /// Both points were pasted from a table.
    Pasted,
    /// True matches that come with the images.
    TrueMatch,
    /// The program found them.
    Automatic,
}

impl PairOrigin {
    /// What stands in files, and what the user reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clicked => "clicked",
            Self::Suggested => "suggested",
            Self::Refined => "refined",
            Self::MovedToMatch => "moved-to-match",
            Self::Imported => "imported",
            Self::Pasted => "pasted",
            Self::TrueMatch => "true-match",
            Self::Automatic => "automatic",
        }
    }
}

/// What is known of a pair.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PairLabel {
    /// What it is called; empty where nobody has named it.
    pub name: String,
    /// Where its points come from.
    pub origin: PairOrigin,
}

/// How far a geometry is to be trusted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TrustNote {
    /// The verdict in a word or two: `reliable`, `doubtful`, `unreliable`, `not judged`, `unfinished`.
    pub verdict: String,
    /// Why, a sentence each.
    pub reasons: Vec<String>,
}

impl TrustNote {
    /// All of it in one line.
    pub fn in_words(&self) -> String {
        let verdict = std::iter::once(format!("The geometry is {}.", self.verdict));
        verdict.chain(self.reasons.iter().cloned()).collect::<Vec<_>>().join(" ")
    }
}

impl From<&Trust> for TrustNote {
    fn from(trust: &Trust) -> Self {
        let reasons = trust.reasons.iter().map(ToString::to_string).collect();
        Self { verdict: trust.verdict.label().to_owned(), reasons }
    }
}

/// Pairs of the same origin that follow each other, in words: `clicked: p, q`.
pub(super) fn runs(labels: &[PairLabel]) -> impl Iterator<Item = (usize, String)> {
    labels.chunk_by(|a, b| a.origin == b.origin).map(|run| {
        let names: Vec<_> =
            run.iter().map(|label| label.name.as_str()).filter(|name| !name.is_empty()).collect();
        let names = if names.is_empty() { run.len().to_string() } else { names.join(", ") };
        let origin = run.first().map_or("", |label| label.origin.name());
        (run.len(), format!("{origin}: {names}"))
    })
}
