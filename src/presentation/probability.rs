//! Words for the probability of a result.

use crate::estimate::{Assessment, Estimate, Trust};
use crate::geometry::Frame;

/// Describes how likely the lines of a result are right. `side` is the longer side of the larger
/// image, px. `None` without a probability.
pub fn probability_in_words(assessment: &Assessment, side: f64) -> Option<String> {
    let percent = (100.0 * assessment.probability_within_one_percent()?).round().clamp(1.0, 99.0);
    let is_open = assessment.trust.as_ref().is_some_and(Trust::says_one_plane);
    let lines = if is_open { "Lines near the matches" } else { "Lines" };
    Some(format!(
        "{lines}: about {percent:.0} % likely to be within {:.0} px, 1 % of the longer side",
        (0.01 * side).max(1.0)
    ))
}

/// Returns how likely the lines of a result are right, in a few words and in a sentence. `None` where they are right
/// near the matches only: the figure would read like a recommendation.
pub fn likely_in_words(estimate: &Estimate, frames: [Frame; 2]) -> Option<[String; 2]> {
    if estimate.says_one_plane() {
        return None;
    }
    let side = frames[0].longer_side().max(frames[1].longer_side());
    let percent = (100.0 * estimate.assessment.probability_within_one_percent()?).round();
    let words = probability_in_words(&estimate.assessment, side)?;
    Some([format!("{percent:.0} % likely within {:.0} px", (0.01 * side).max(1.0)), words])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{LineEvidence, Reason, Verdict};

    fn words(reasons: Vec<Reason>, is_measured: bool) -> Option<String> {
        let trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        let lines = LineEvidence { likelihood: 300.0, rival: 0.0, log_false_alarms: -200.0 };
        let line_evidence = is_measured.then_some(lines);
        probability_in_words(&Assessment { line_evidence, trust, ..Assessment::default() }, 768.0)
    }

    #[test]
    fn the_sentence_says_which_lines_are_meant() {
        let lines = words(vec![Reason::Fisheye], true).unwrap();
        assert!(lines.starts_with("Lines: about 9"), "{lines}");
        assert!(lines.ends_with("% likely to be within 8 px, 1 % of the longer side"), "{lines}");
        let plane = Reason::OnePlane { percent: 98, groups: 9, agreeing: 2, is_still: false };
        assert!(words(vec![plane], true).unwrap().starts_with("Lines near the matches: about "));
        assert_eq!(words(vec![Reason::NotChecked], false), None);
    }
}
