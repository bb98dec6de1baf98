//! What a hypothesis has to do with the margin: whether it is the rival, or so near to the result that it is none.

use super::gauge::{line_score_text, rival};
use crate::estimate::{Estimate, LineScore};
use crate::evaluate::median;
use crate::geometry::symmetric_epipolar_distance;

/// How a hypothesis stands to the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Before the rival, and not clearly different from the result.
    Near,
    /// The one that makes the margin.
    Rival,
    /// Behind the rival.
    Behind,
}

impl Standing {
    /// That of a hypothesis, by its place in the list; `None` where no rival is known.
    pub fn of(result: &Estimate, number: usize) -> Option<Self> {
        Some(match number.cmp(&rival(result)?) {
            std::cmp::Ordering::Less => Self::Near,
            std::cmp::Ordering::Equal => Self::Rival,
            std::cmp::Ordering::Greater => Self::Behind,
        })
    }

    /// The same with the figures that it rests on; `kind` is what line scores measure.
    pub fn in_words(self, result: &Estimate, number: usize, kind: LineScore) -> String {
        let far = away(result, number);
        match self {
            Self::Near => {
                let within = far.map_or(String::new(), |(count, far)| {
                    format!(": half of its {count} matches lie within {far:.1} px of these lines, too")
                });
                format!(
                    "Not clearly different from the result{within}. So it is no rival, and the margin passes over it."
                )
            }
            Self::Rival => {
                let beyond = far.map_or(String::new(), |(count, far)| {
                    format!(": half of the result's {count} matches lie {far:.1} px or more from its lines")
                });
                let figures = figures(result, number, kind);
                format!("The best clearly different geometry{beyond}. {figures}")
            }
            Self::Behind => {
                let away = far.map_or(String::new(), |(count, far)| {
                    format!(" Half of the result's {count} matches lie within {far:.1} px of its lines.")
                });
                format!("Ranks behind the rival, to which the margin is measured.{away}")
            }
        }
    }
}

/// How many matches the result has, and the median of their distances from the lines of a hypothesis, px.
fn away(result: &Estimate, number: usize) -> Option<(usize, f64)> {
    let own = result.hypotheses().get(number)?.fundamental();
    let distances: Vec<f64> =
        result.matches().iter().map(|found| symmetric_epipolar_distance(own, &found.pair)).collect();
    let far = median(&distances);
    far.is_finite().then_some((distances.len(), far))
}

/// The figures of the first hypothesis and of the rival, from which the margin comes.
fn figures(result: &Estimate, number: usize, kind: LineScore) -> String {
    let margin = result.assessment.margin.unwrap_or(f64::NAN) * 100.0;
    let [Some(best), Some(own)] = [0, number].map(|place| result.hypotheses().get(place)) else {
        return String::new();
    };
    let beside =
        match (best.support_score().zip(own.support_score()), best.line_score().zip(own.line_score())) {
            (Some((best, own)), _) => format!("support {own:.1} beside {best:.1}"),
            (None, Some((best, own))) => {
                format!("line score {} beside {}", line_score_text(kind, own), line_score_text(kind, best))
            }
            (None, None) => return String::new(),
        };
    let refined = result.assessment.refined_margin.map_or(String::new(), |refined| {
        format!(" With the rivals refined, too, it is {:.0} %, which decides.", refined * 100.0)
    });
    format!("Its {beside} of hypothesis 1 makes the margin of {margin:.0} %.{refined}")
}
