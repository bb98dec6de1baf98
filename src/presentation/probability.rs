//! Words for the probability of a result.

use crate::estimate::{Determined, Estimate, Verdict};
use crate::geometry::Frame;

/// What a result says whose matches do not determine the lines all over the images.
pub const NEAR_MATCHES: &str = "Epipolar lines are right near the matches, and uncertain elsewhere";

/// Word for a reliable result with such lines.
pub const PARTLY_RELIABLE: &str = "Partly reliable";

/// Returns whether the lines of a result are open away from its matches, in images of these sizes.
pub fn is_open_elsewhere(estimate: &Estimate, frames: [Frame; 2]) -> bool {
    estimate.determined(frames) == Some(Determined::NearMatches)
}

/// Returns whether a result is reliable near its matches alone, in images of these sizes: partly reliable, in words.
pub fn is_partly_reliable(estimate: &Estimate, frames: [Frame; 2]) -> bool {
    let trust = estimate.assessment.trust.as_ref();
    trust.is_some_and(|trust| trust.verdict == Verdict::Reliable) && is_open_elsewhere(estimate, frames)
}

/// Describes how likely the lines of a result are right in images of these sizes. `None` without a probability.
pub fn probability_in_words(estimate: &Estimate, frames: [Frame; 2]) -> Option<String> {
    let percent = (100.0 * estimate.assessment.probability_within_one_percent()?).round().clamp(1.0, 99.0);
    let side = frames[0].longer_side().max(frames[1].longer_side());
    Some(format!(
        "Lines near the matches: about {percent:.0} % likely to be within {:.0} px, 1 % of the longer side",
        (0.01 * side).max(1.0)
    ))
}

/// Returns how likely the lines of a result are right, in a few words and in a sentence. `None` where they are right
/// near the matches only: the figure would read like a recommendation.
pub fn likely_in_words(estimate: &Estimate, frames: [Frame; 2]) -> Option<[String; 2]> {
    if estimate.says_one_plane() || is_open_elsewhere(estimate, frames) {
        return None;
    }
    let side = frames[0].longer_side().max(frames[1].longer_side());
    let percent = (100.0 * estimate.assessment.probability_within_one_percent()?).round();
    let words = probability_in_words(estimate, frames)?;
    Some([format!("{percent:.0} % likely within {:.0} px near the matches", (0.01 * side).max(1.0)), words])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Assessment, LineEvidence, Reason, Trust};
    use crate::geometry::FundamentalMatrix;
    use nalgebra::Matrix3;

    fn words(reasons: Vec<Reason>, is_measured: bool) -> Option<String> {
        let trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        let lines = LineEvidence { likelihood: 300.0, rival: 0.0, log_false_alarms: -200.0 };
        let line_evidence = is_measured.then_some(lines);
        let rows = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
        let fundamental = FundamentalMatrix::from_rank_two(rows).unwrap();
        let assessment = Assessment { line_evidence, trust, ..Assessment::default() };
        let found = Estimate { fundamental, origin: None, assessment, trace: None };
        probability_in_words(&found, [Frame { width: 768, height: 576 }; 2])
    }

    #[test]
    fn the_sentence_says_which_lines_are_meant() {
        let lines = words(vec![Reason::Fisheye], true).unwrap();
        assert!(lines.starts_with("Lines near the matches: about 9"), "{lines}");
        assert!(lines.ends_with("% likely to be within 8 px, 1 % of the longer side"), "{lines}");
        assert_eq!(words(vec![Reason::NotChecked], false), None);
    }
}
