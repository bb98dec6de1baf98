//! Words for the probability of a result.

use crate::estimate::{Assessment, Trust};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Reason, Verdict};

    fn words(verdict: Verdict, reasons: Vec<Reason>) -> Option<String> {
        let trust = Some(Trust { verdict, reasons });
        probability_in_words(&Assessment { trust, ..Assessment::default() }, 768.0)
    }

    #[test]
    fn the_sentence_says_which_lines_are_meant() {
        let reliable = words(Verdict::Reliable, Vec::new()).unwrap();
        assert!(reliable.starts_with("Lines: about 9"), "{reliable}");
        assert!(reliable.ends_with("% likely to be within 8 px, 1 % of the longer side"), "{reliable}");
        let plane = Reason::OnePlane { percent: 98, groups: 9, agreeing: 2, is_still: false };
        assert!(words(Verdict::Doubtful, vec![plane]).unwrap().starts_with("Lines near the matches: about "));
        assert_eq!(words(Verdict::Doubtful, vec![Reason::NotChecked]), None);
    }
}
