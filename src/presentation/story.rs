//! Course of a search in words.

use crate::estimate::{Event, EventKind, HypothesisNote, Verdict};

use super::origin_in_words;

/// Describes what happened in a search, one line an event, with the seconds since its begin.
pub fn story_in_words(events: &[Event]) -> Vec<String> {
    events
        .iter()
        .filter_map(|event| Some(format!("{:.2} s  {}", event.seconds, in_words(&event.kind)?)))
        .collect()
}

/// Returns the sentence of an event. The beginning of a stage has none: what it found is told.
fn in_words(kind: &EventKind) -> Option<String> {
    let by = |hypothesis: &HypothesisNote| origin_in_words(&hypothesis.origin);
    Some(match kind {
        EventKind::Began(_) => return None,
        EventKind::Pencils { candidates, .. } => {
            let counts: Vec<String> = candidates.iter().map(usize::to_string).collect();
            format!(
                "Lines through {} pairs compared: {} candidate line pairs",
                counts.len(),
                counts.join(" and ")
            )
        }
        EventKind::Lines { compared: [left, right], candidates, .. } => {
            format!("{left} and {right} lines compared: the best {} line pairs kept", candidates.len())
        }
        EventKind::Matched { all, .. } => format!("{all} features matched"),
        EventKind::Proposed { examined, hypotheses } => match hypotheses.first() {
            Some(best) => format!("{examined} combinations examined, the best proposed by {}", by(best)),
            None => format!("{examined} combinations examined, none of use"),
        },
        EventKind::Ranked(hypotheses) => {
            let best = hypotheses.first()?;
            format!("Hypotheses ranked, the first proposed by {}", by(&best.hypothesis))
        }
        EventKind::Refined { selected, matches: 0, .. } => {
            format!("Refined on motion barcodes, proposed by {}", by(selected))
        }
        EventKind::Refined { selected, matches, .. } => {
            format!("Refined on {matches} matches, proposed by {}", by(selected))
        }
        EventKind::Judged { verdict, is_open } => {
            let word = match verdict {
                Some(Verdict::Reliable) => ": all tests passed",
                Some(verdict) => &format!(" {}", verdict.label()),
                None => " without a verdict",
            };
            let open = if *is_open { "; another search may find a better geometry" } else { "" };
            format!("Judged{word}{open}")
        }
        EventKind::Selected(selected) => format!("Result, proposed by {}", by(selected)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Stage;

    #[test]
    fn the_story_tells_what_happened_and_not_what_began() {
        let event = |seconds, kind| Event { seconds, kind };
        let events = [
            event(0.0, EventKind::Began(Stage::Pencils)),
            event(0.1, EventKind::Pencils { anchors: Vec::new(), candidates: vec![201, 270] }),
            event(0.2, EventKind::Proposed { examined: 2000, hypotheses: Vec::new() }),
            event(0.5, EventKind::Judged { verdict: Some(Verdict::Doubtful), is_open: true }),
        ];
        let story = [
            "0.10 s  Lines through 2 pairs compared: 201 and 270 candidate line pairs",
            "0.20 s  2000 combinations examined, none of use",
            "0.50 s  Judged doubtful; another search may find a better geometry",
        ];
        assert_eq!(story_in_words(&events), story);
    }
}
