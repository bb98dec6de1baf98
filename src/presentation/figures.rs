//! Figures by which hypotheses are compared.

use crate::estimate::{Estimate, LineScore};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HypothesisFigure {
    /// Support by matching corners.
    Support,
    /// Matching cost of its lines.
    LineScore,
    /// Distance between a line and its image after a round trip.
    RoundTrip,
}

impl HypothesisFigure {
    /// Returns the figure of a hypothesis; NaN if it has none.
    pub fn of(self, hypothesis: &Estimate) -> f64 {
        let figure = match self {
            Self::Support => hypothesis.support_score(),
            Self::LineScore => hypothesis.line_score(),
            Self::RoundTrip => hypothesis.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area),
        };
        figure.unwrap_or(f64::NAN)
    }
}

/// Formats a line score in its unit, which depends on the kind of score.
pub fn line_score_text(kind: LineScore, score: f64) -> String {
    match kind {
        LineScore::AgainstMismatched => format!("{:.1} %", score * 100.0),
        LineScore::Cost => format!("{score:.1}"),
    }
}
