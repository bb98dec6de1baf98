//! Relation of a hypothesis to the margin: the rival, too near to the result, or behind the rival.

use crate::estimate::Estimate;

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

    /// Describes the standing with the measured distance from the result, and the margin of the result.
    pub fn in_words(self, result: &Estimate, number: usize) -> String {
        let far = away(result, number);
        match self {
            Self::Near => format!("Too near to the result to be a rival: {far}. Its epipole may differ."),
            Self::Rival => {
                let assessment = &result.assessment;
                let lead = assessment.refined_margin.or(assessment.margin).unwrap_or(f64::NAN) * 100.0;
                format!("The best clearly different geometry: {far}. The result leads by {lead:.0} %.")
            }
            Self::Behind => format!("Behind the rival: {far}."),
        }
    }
}

/// Describes the measured distance of a hypothesis from the result.
fn away(result: &Estimate, number: usize) -> String {
    let apart = result.assessment.apart.as_ref();
    let distance = apart.and_then(|apart| apart.distances.get(number)).copied().unwrap_or(f64::NAN);
    match apart.map_or(0, |apart| apart.matches) {
        0 => format!("its lines are {distance:.1} px from the lines of the result on average"),
        _ => format!("half of the matches lie within {distance:.1} px of its lines"),
    }
}
