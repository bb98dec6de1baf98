//! What it means that rows of matches lie apart: that depends on whose geometry is shown, and on what is known of it.

use super::MatchesAtHand;
use crate::app::model::Model;
use crate::app::model::comparison::Contestant;
use crate::app::model::computation::Freshness;
use crate::app::model::shown::ShownGeometry;
use crate::estimate::{Estimate, Verdict};

impl Model {
    /// What to make of rows that differ by so many pixels on average, and what to do; `None` without a geometry.
    pub fn misfit_in_words(&self, rows: f64) -> Option<String> {
        let shown = self.shown()?;
        let matches = self.matches_beside();
        let (name, why) = (matches.name(), self.why_misfit(&shown, &matches));
        Some(format!("Rows of {name} differ by {rows:.1} px on average: {why}"))
    }

    fn why_misfit(&self, shown: &ShownGeometry, matches: &MatchesAtHand) -> String {
        let verdict = verdict(shown.estimate);
        // The matches of a result that is in doubt itself say nothing of another geometry.
        let tells = matches!(matches, MatchesAtHand::True(_)) || verdict == Some(Verdict::Reliable);
        let other = match (shown.hypothesis, shown.contestant) {
            (Some((number, _)), _) => format!("hypothesis {}", number + 1),
            (None, Some(Contestant::Imported)) if !self.has_result() => {
                return "the imported geometry does not fit them. Check that it belongs to these images, and the pairs."
                    .to_owned();
            }
            (None, Some(Contestant::Imported)) => "the imported geometry".to_owned(),
            (None, Some(Contestant::Truth)) => {
                return "the true geometry is shown, so look at the pairs that are far from its lines."
                    .to_owned();
            }
            (None, Some(contestant)) => format!("the {} geometry", contestant.name()),
            (None, None) => return why_result_misfits(shown, verdict),
        };
        if tells {
            format!("{other} is shown, and they speak against it. Press R for the result.")
        } else {
            format!(
                "{other} is shown, and the result is another geometry. Neither is certain: the panel on the right says \
                 what would tell."
            )
        }
    }
}

fn why_result_misfits(shown: &ShownGeometry, verdict: Option<Verdict>) -> String {
    match verdict {
        _ if shown.freshness != Freshness::Final => "this geometry is not final.".to_owned(),
        Some(Verdict::Reliable) => {
            "the result is right roughly, but not exact there. Point pairs where rows differ make it firmer."
                .to_owned()
        }
        Some(Verdict::Doubtful | Verdict::Unreliable) => {
            "the result is in doubt. The panel on the right says why, and what to do.".to_owned()
        }
        None => "the geometry does not fit them, so add point pairs or correct them.".to_owned(),
    }
}

fn verdict(estimate: &Estimate) -> Option<Verdict> {
    estimate.assessment.trust.as_ref().map(|trust| trust.verdict)
}
