//! Probability that the lines of a result are right near its matches.

use serde::Serialize;

use crate::estimate::verdict::constants::LOG_ODDS;

/// Evidence of the matches found without a geometry for the lines of one, in natural logarithms.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub struct LineEvidence {
    /// Logarithm of how much likelier the matches are with these lines than by chance, neighbours counted as one.
    pub likelihood: f64,
    /// The same for the likeliest clearly different geometry of the search. 0 without one.
    pub rival: f64,
    /// Logarithm of the number of geometries that would agree as well with matches that lie anywhere.
    pub log_false_alarms: f64,
}

impl LineEvidence {
    /// Returns the lead of the lines: over the likeliest rival, or over chance with all geometries counted that
    /// might have been fitted, whichever is less.
    pub fn lead(&self) -> f64 {
        (self.likelihood - self.rival).min((-self.log_false_alarms).max(0.0))
    }

    /// Returns the probability that the lines are within 1 % of the longer side of the scene points, strictly
    /// between 0 and 1. The log-odds grow with the logarithm of the lead, as what misleads is not chance alone:
    /// repeated structure, and scenes that change. A likelier rival says the same however much likelier it is.
    pub fn probability(&self) -> f64 {
        let lead = self.lead();
        let grown = if lead > 0.0 { lead.ln_1p() } else { lead / (1.0 - lead) };
        let [at_chance, growth] = LOG_ODDS;
        1.0 / (1.0 + (-(at_chance + growth * grown)).exp())
    }

    /// Returns the probability if there were no rival.
    pub(super) fn probability_without_rival(&self) -> f64 {
        Self { rival: 0.0, ..*self }.probability()
    }

    /// Returns the advantage over the rival, relative to the likelier of the two: −1 to 1.
    pub(super) fn margin(&self) -> f64 {
        (self.likelihood - self.rival) / self.likelihood.max(self.rival).max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::verdict::constants::{EVEN, SURE_LINES};

    #[test]
    fn the_lead_is_limited_by_the_number_of_geometries() {
        let found = LineEvidence { likelihood: 30.0, rival: 4.0, log_false_alarms: -9.0 };
        assert!((found.lead() - 9.0).abs() < 1e-12);
        let rare = LineEvidence { log_false_alarms: -90.0, ..found };
        assert!((rare.lead() - 26.0).abs() < 1e-12);
        let chance = LineEvidence { log_false_alarms: 5.0, ..found };
        assert!(chance.lead().abs() < 1e-12);
    }

    #[test]
    fn more_evidence_is_never_less_probable() {
        let of =
            |lead: f64| LineEvidence { likelihood: lead, rival: 0.0, log_false_alarms: -1e9 }.probability();
        let leads = [-1e6, -50.0, -1.0, -0.01, 0.0, 0.01, 1.0, 10.0, 100.0, 1e4];
        let probabilities = leads.map(of);
        assert!(probabilities.is_sorted(), "{probabilities:?}");
        assert!(probabilities.iter().all(|p| (0.05..0.9999).contains(p)), "{probabilities:?}");
        assert!(of(0.0) < EVEN && of(1000.0) > SURE_LINES);
    }
}
