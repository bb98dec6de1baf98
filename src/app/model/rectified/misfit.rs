//! Explains row errors of matches, from the origin of the shown geometry and its verdict.

use super::MatchesAtHand;
use crate::app::model::Model;
use crate::app::model::comparison::Contestant;
use crate::app::model::computation::Freshness;
use crate::app::model::shown::ShownGeometry;
use crate::estimate::{Estimate, Verdict};

impl Model {
    /// Explains an average row error of `rows` px and suggests an action; `None` without a
    /// geometry.
    pub fn misfit_in_words(&self, rows: f64) -> Option<String> {
        let shown = self.shown()?;
        let matches = self.matches_beside();
        let (name, why) = (matches.name(), self.why_misfit(&shown, &matches));
        Some(format!("Rows of {name} differ by {rows:.1} px on average: {why}"))
    }

    fn why_misfit(&self, shown: &ShownGeometry, matches: &MatchesAtHand) -> String {
        let verdict = verdict(shown.estimate);
        // Matches of a doubtful result are no evidence about another geometry.
        let tells = matches!(matches, MatchesAtHand::True(_)) || verdict == Some(Verdict::Reliable);
        let other = match (shown.hypothesis, shown.contestant) {
            (Some((number, _)), _) => format!("hypothesis {}", number + 1),
            (None, Some(Contestant::Imported)) if self.result().is_none() => {
                return "the imported geometry does not fit. Check that it belongs to these images, and check the pairs."
                    .to_owned();
            }
            (None, Some(Contestant::Imported)) => "the imported geometry".to_owned(),
            (None, Some(Contestant::Truth)) => {
                return "the true geometry is shown. Check the pairs that are far from its lines.".to_owned();
            }
            (None, Some(contestant)) => format!("the {} geometry", contestant.name()),
            (None, None) => return why_result_misfits(shown, verdict),
        };
        if tells {
            format!("{other} is shown, and these points contradict it. Press R for the result.")
        } else {
            format!(
                "{other} is shown, which differs from the result. Neither is certain: the panel on \
                 the right says what would help."
            )
        }
    }
}

fn why_result_misfits(shown: &ShownGeometry, verdict: Option<Verdict>) -> String {
    match verdict {
        _ if shown.freshness != Freshness::Final => "this geometry is not final.".to_owned(),
        Some(Verdict::Reliable) => {
            "the result is roughly right, but not exact there. Add point pairs where rows differ.".to_owned()
        }
        Some(_) => "the result is in doubt. The panel on the right says why and what to do.".to_owned(),
        None => "the geometry does not fit. Add point pairs or correct them.".to_owned(),
    }
}

fn verdict(estimate: &Estimate) -> Option<Verdict> {
    estimate.assessment.trust.as_ref().map(|trust| trust.verdict)
}
