//! Relation of a hypothesis to the margin: the rival, too near to the result, or behind the rival.

use super::gauge::line_score_text;
use crate::estimate::{Estimate, LineScore};

/// Relation of a hypothesis to the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Ranked before the rival, or without a rival, but not clearly different from the result.
    Near,
    /// The hypothesis that sets the margin.
    Rival,
    /// Ranked behind the rival.
    Behind,
}

impl Standing {
    /// Returns the standing of a hypothesis, by its place in the list; `None` without measured
    /// distances.
    pub fn of(result: &Estimate, number: usize) -> Option<Self> {
        let rival = result.assessment.apart.as_ref()?.rival().unwrap_or(usize::MAX);
        Some(match number.cmp(&rival) {
            std::cmp::Ordering::Less => Self::Near,
            std::cmp::Ordering::Equal => Self::Rival,
            std::cmp::Ordering::Greater => Self::Behind,
        })
    }

    /// Describes the standing with the figures behind it. `kind` is the kind of line score.
    pub fn in_words(self, result: &Estimate, number: usize, kind: LineScore) -> String {
        let far = away(result, number);
        match self {
            Self::Near => {
                let passes = result.assessment.margin.map_or("", |_| ", and the margin ignores it");
                format!("Not clearly different from the result{far}. So it is not a rival{passes}.")
            }
            Self::Rival => {
                format!("The best clearly different geometry{far}. {}", figures(result, number, kind))
            }
            Self::Behind => format!("Ranked behind the rival, which sets the margin{far}."),
        }
    }
}

/// Describes the measured distance of a hypothesis from the result.
fn away(result: &Estimate, number: usize) -> String {
    let Some(apart) = &result.assessment.apart else { return String::new() };
    let Some(distance) = apart.distances.get(number) else { return String::new() };
    let limit = apart.limit;
    match apart.matches {
        0 => format!(
            ": its epipolar lines are {distance:.1} px from the lines of the result on average (up \
             to {limit:.1} px count as near)"
        ),
        count => format!(
            ": half of the {count} matches before refinement lie within {distance:.1} px of its \
             lines (symmetric distance; up to {limit:.1} px count as near)"
        ),
    }
}

/// Describes the figures of the first hypothesis and of the rival, from which the margin follows.
fn figures(result: &Estimate, number: usize, kind: LineScore) -> String {
    let margin = result.assessment.margin.unwrap_or(f64::NAN) * 100.0;
    let [Some(best), Some(own)] = [0, number].map(|place| result.hypotheses().get(place)) else {
        return String::new();
    };
    let beside =
        match (best.support_score().zip(own.support_score()), best.line_score().zip(own.line_score())) {
            (Some((best, own)), _) => format!("support {own:.1} against {best:.1}"),
            (None, Some((best, own))) => {
                format!("line score {} against {}", line_score_text(kind, own), line_score_text(kind, best))
            }
            (None, None) => return String::new(),
        };
    let refined = result.assessment.refined_margin.map_or(String::new(), |refined| {
        format!(" After refinement of the rivals, the margin is {:.0} %, which decides.", refined * 100.0)
    });
    format!("Its {beside} for hypothesis 1 gives a margin of {margin:.0} %.{refined}")
}
