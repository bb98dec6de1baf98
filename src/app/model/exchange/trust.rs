//! Verdicts on exported geometries, in the words of the window.

use crate::app::model::Model;
use crate::app::model::comparison::Contestant;
use crate::app::model::computation::Freshness;
use crate::app::model::verdict::{Tone, VerdictInWords, import_warning, verdict};
use crate::io::TrustNote;

/// Returns the verdict on the shown geometry, in the words of the window.
pub fn trust_note(model: &Model) -> Option<TrustNote> {
    let shown = model.shown()?;
    let unjudged = |reason: String| TrustNote { verdict: "not judged".into(), reasons: vec![reason] };
    if let Some((number, _)) = shown.hypothesis {
        return Some(unjudged(format!("This is hypothesis {} of the search, not its result.", number + 1)));
    }
    if let Some(contestant) = shown.contestant {
        let imported = model.document.imported.as_ref().filter(|_| contestant == Contestant::Imported);
        let warning =
            imported.and_then(import_warning).map_or(String::new(), |warning| format!(" {warning}"));
        return Some(unjudged(format!(
            "This is the geometry called {}, not the result.{warning}",
            contestant.name()
        )));
    }
    result_note(model)
}

pub fn result_note(model: &Model) -> Option<TrustNote> {
    let (estimate, freshness) = model.open.computation.result()?;
    let judged = estimate.assessment.trust.is_some();
    let VerdictInWords { tone, warnings, .. } = verdict(&model.document, &model.open.computation);
    let verdict = match tone {
        Tone::Good if judged => "reliable",
        Tone::Good | Tone::Idle => "not judged",
        Tone::Caution if freshness == Freshness::Final => "doubtful",
        Tone::Caution | Tone::Busy => "unfinished",
        Tone::Bad => "unreliable",
    };
    Some(TrustNote { verdict: verdict.into(), reasons: warnings })
}
