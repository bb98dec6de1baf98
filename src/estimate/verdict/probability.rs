//! Probability that the lines of a result are right.

use crate::estimate::{Assessment, LineEvidence, Reason};

impl Assessment {
    /// Returns the probability that the lines of the result are within 1 % of the longer side of the
    /// scene points, strictly between 0 and 1 ([`LineEvidence::probability`]).
    ///
    /// If the epipoles are open ([`Trust::says_one_plane`](crate::estimate::Trust::says_one_plane)), it concerns the
    /// lines near the matches alone. `None` without a verdict, and for what was not measured: motion barcodes,
    /// geometries of clicks or given matches alone, results that contradict given matches, and searches without
    /// patches or refinement.
    pub fn probability_within_one_percent(&self) -> Option<f64> {
        let trust = self.trust.as_ref()?;
        let contradicts_given = |reason: &Reason| matches!(reason, Reason::GivenContradict { .. });
        let is_measured = !trust.reasons.iter().any(contradicts_given);
        self.line_evidence.as_ref().filter(|_| is_measured).map(LineEvidence::probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Trust, Verdict};

    #[test]
    fn what_was_not_measured_has_no_probability() {
        let lines = LineEvidence { likelihood: 300.0, rival: 0.0, log_false_alarms: -200.0 };
        let of = |reasons: &[Reason], line_evidence| {
            let trust = Some(Trust { verdict: Verdict::Doubtful, reasons: reasons.to_vec() });
            Assessment { line_evidence, trust, ..Assessment::default() }.probability_within_one_percent()
        };
        assert_eq!(of(&[Reason::Fisheye], Some(lines)), Some(lines.probability()));
        assert_eq!(of(&[Reason::ClicksAlone], None), None);
        let contradict = Reason::GivenContradict { contradicting: 50, matches: 54, distance: 30.0 };
        assert_eq!(of(&[Reason::Fisheye, contradict], Some(lines)), None);
        assert_eq!(
            Assessment { line_evidence: Some(lines), ..Assessment::default() }
                .probability_within_one_percent(),
            None
        );
    }
}
