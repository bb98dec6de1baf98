//! Verdict on a geometry, and names and origins of its pairs.

use serde::{Deserialize, Serialize};

use crate::estimate::{Estimate, Trust};
use crate::geometry::Frame;
use crate::presentation::{NEAR_MATCHES, is_partly_reliable, reason_in_words};

named! {
    fn name;
    /// Origin of the points of a pair.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum PairOrigin {
        /// A person clicked both points.
        #[default]
        Clicked = "clicked",
        /// A person clicked one point and accepted the suggested match.
        Suggested = "suggested",
        /// A person clicked both points, and one was refined to subpixel accuracy.
        Refined = "refined",
        /// One point was moved to the best match on its epipolar line.
        MovedToMatch = "moved-to-match",
        /// Both points were read from a file.
        Imported = "imported",
        /// Both points were pasted from a table.
        Pasted = "pasted",
        /// A true match supplied with the images.
        TrueMatch = "true-match",
        /// The program found both points.
        Automatic = "automatic",
    }
}

/// Name and origin of a pair.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PairLabel {
    /// Name of the pair; may be empty.
    pub name: String,
    /// Origin of the points.
    pub origin: PairOrigin,
}

/// Verdict on a geometry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TrustNote {
    /// What the geometry is: [`TrustNote::RESULT`], or for example a hypothesis or an import.
    pub geometry: String,
    /// Verdict: `reliable`, `partly reliable`, `doubtful`, `unreliable`, `not judged` or `unfinished`.
    pub verdict: String,
    /// Reasons, one sentence each.
    pub reasons: Vec<String>,
}

impl TrustNote {
    /// Name of the result of an estimate.
    pub const RESULT: &'static str = "result";

    /// Returns the note of a result for images of these sizes; `None` without a verdict.
    pub fn of(found: &Estimate, frames: [Frame; 2]) -> Option<Self> {
        let note = Self::from(found.assessment.trust.as_ref()?);
        Some(if is_partly_reliable(found, frames) { note.partly() } else { note })
    }

    /// Returns the note of a result without a verdict.
    pub fn not_judged() -> Self {
        Self { geometry: Self::RESULT.to_owned(), verdict: "not judged".to_owned(), reasons: Vec::new() }
    }

    /// Returns the note of a reliable geometry whose lines are right near the matches, and uncertain elsewhere.
    #[must_use]
    pub fn partly(self) -> Self {
        Self { verdict: "partly reliable".into(), reasons: vec![format!("{NEAR_MATCHES}.")], ..self }
    }

    /// Tells what the geometry is, with its verdict.
    pub fn sentence(&self) -> String {
        if self.geometry == Self::RESULT {
            return format!("The geometry is {}.", self.verdict);
        }
        format!("The geometry is {}. It is {}.", self.geometry, self.verdict)
    }

    /// Returns the verdict and its reasons in one line.
    pub fn in_words(&self) -> String {
        let verdict = std::iter::once(self.sentence());
        verdict.chain(self.reasons.iter().cloned()).collect::<Vec<_>>().join(" ")
    }
}

impl From<&Trust> for TrustNote {
    fn from(trust: &Trust) -> Self {
        let reasons = trust.reasons.iter().map(reason_in_words).collect();
        let (geometry, verdict) = (Self::RESULT.to_owned(), trust.verdict.label().to_owned());
        Self { geometry, verdict, reasons }
    }
}

/// Describes runs of pairs with the same origin: `clicked: p, q`.
pub(super) fn runs(labels: &[PairLabel]) -> impl Iterator<Item = (usize, String)> {
    labels.chunk_by(|a, b| a.origin == b.origin).map(|run| {
        let names: Vec<_> =
            run.iter().map(|label| label.name.as_str()).filter(|name| !name.is_empty()).collect();
        let names = if names.is_empty() { run.len().to_string() } else { names.join(", ") };
        let origin = run.first().map_or("", |label| label.origin.name());
        (run.len(), format!("{origin}: {names}"))
    })
}
