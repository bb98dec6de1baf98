//! Verdicts on exported geometries, in the words of the window.

use crate::app::model::Model;
use crate::app::model::comparison::Contestant;
use crate::app::model::computation::Freshness;
use crate::app::model::document::AS_READ;
use crate::app::model::shown::ShownGeometry;
use crate::app::model::verdict::{BENT, Tone, VerdictInWords, import_warning};
use crate::io::TrustNote;
use crate::presentation::PARTLY_RELIABLE;

/// Returns what the shown geometry is, with the verdict on it in the words of the window.
pub fn trust_note(model: &Model) -> Option<TrustNote> {
    let shown = model.shown()?;
    let Some(geometry) = shown_in_words(model, &shown) else { return result_note(model) };
    let imported = model.document.imported.as_ref().filter(|_| is_import(&shown));
    let reasons = imported.and_then(import_warning).map(str::to_owned).into_iter().collect();
    Some(TrustNote { geometry, verdict: "not judged".into(), reasons })
}

/// Says what the shown geometry is; `None` for the result.
pub fn shown_in_words(model: &Model, shown: &ShownGeometry) -> Option<String> {
    if let Some((number, _)) = shown.hypothesis {
        let all = shown.estimate.hypotheses().len();
        return Some(format!("hypothesis {} of {all}, not the result", number + 1));
    }
    if let Some(imported) = model.document.imported.as_ref().filter(|_| is_import(shown)) {
        let reading = if imported.reading == AS_READ { "as read" } else { &imported.reading };
        return Some(format!("imported from {}, {reading}, not the result", imported.file));
    }
    shown.contestant.map(|contestant| format!("the geometry called {}, not the result", contestant.name()))
}

fn is_import(shown: &ShownGeometry) -> bool {
    shown.hypothesis.is_none() && shown.contestant == Some(Contestant::Imported)
}

pub fn result_note(model: &Model) -> Option<TrustNote> {
    let (estimate, freshness) = model.open.computation.result()?;
    let judged = estimate.assessment.trust.is_some();
    let VerdictInWords { tone, warnings, word, sentence, .. } = model.verdict_in_words();
    let verdict = match tone {
        Tone::Good if judged => "reliable",
        Tone::Good | Tone::Idle => "not judged",
        Tone::Caution if freshness == Freshness::Final => "doubtful",
        Tone::Caution | Tone::Busy => "unfinished",
        Tone::Bad => "unreliable",
        Tone::Apart => "different scenes",
    };
    let note = TrustNote { geometry: TrustNote::RESULT.into(), verdict: verdict.into(), reasons: warnings };
    let mut note = if word == PARTLY_RELIABLE { note.partly() } else { note };
    if sentence == BENT {
        note.reasons = vec![sentence];
    }
    Some(note)
}
