//! What a hypothesis has to do with the margin: whether it is the rival, or so near to the result that it is none.

use super::gauge::line_score_text;
use crate::estimate::{Estimate, LineScore};

/// How a hypothesis stands to the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Before the rival, or without one, and not clearly different from the result.
    Near,
    /// The one that makes the margin.
    Rival,
    /// Behind the rival.
    Behind,
}

impl Standing {
    /// That of a hypothesis, by its place in the list; `None` where distances were not measured.
    pub fn of(result: &Estimate, number: usize) -> Option<Self> {
        let rival = result.assessment.apart.as_ref()?.rival().unwrap_or(usize::MAX);
        Some(match number.cmp(&rival) {
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
                let passes = result.assessment.margin.map_or("", |_| ", and the margin passes over it");
                format!("Not clearly different from the result{far}. So it is no rival{passes}.")
            }
            Self::Rival => {
                format!("The best clearly different geometry{far}. {}", figures(result, number, kind))
            }
            Self::Behind => format!("Ranks behind the rival, to which the margin is measured{far}."),
        }
    }
}

/// How far a hypothesis is from the result, as it was measured to tell whether it is clearly different.
fn away(result: &Estimate, number: usize) -> String {
    let Some(apart) = &result.assessment.apart else { return String::new() };
    let Some(distance) = apart.distances.get(number) else { return String::new() };
    let limit = apart.limit;
    match apart.matches {
        0 => format!(
            ": its epipolar lines are {distance:.1} px from those of the result on average, and up to {limit:.1} px count as near"
        ),
        count => format!(
            ": of the {count} matches before refinement, half lie up to {distance:.1} px from its lines (symmetric distance), and \
             up to {limit:.1} px count as near"
        ),
    }
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
