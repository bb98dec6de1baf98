//! Section of each pair, with a representative trial.

use super::ReportSubject;
use super::sight::Sight;
use crate::evaluate::report::TrialRecord;
use crate::publish::Publication;

pub(super) fn write(subject: &ReportSubject, document: &mut Publication, progress: &dyn Fn(usize, usize)) {
    let Some(contender) = subject.shown() else { return };
    let label = subject.contenders[contender].label();
    document.section("Pairs");
    document.paragraph(format!(
        "For each pair, the trial of {label} with the median error. Lines belong to true matches that were not clicked \
         and have the same number in both images; crosses are the clicks."
    ));
    for (s, scene) in subject.scenes.iter().enumerate() {
        document.subsection(format!("Pair {}", scene.name));
        let record = subject.record(s, contender);
        match median_trial(&record.trials) {
            None if record.trials.is_empty() => document.paragraph("No trial was made."),
            None => document.paragraph("No trial gave a fundamental matrix; the reasons are listed below."),
            Some(trial) => {
                if let Some(sight) = Sight::new(subject, s, contender, trial) {
                    show(&sight, s, &label, document);
                }
            }
        }
        progress(s + 1, subject.scenes.len());
    }
}

fn show(sight: &Sight, number: usize, label: &str, document: &mut Publication) {
    let (name, trial) = (&sight.scene.name, sight.trial.trial + 1);
    document.figure(
        format!("pair-{:02}-lines", number + 1),
        sight.picture(),
        format!(
            "Pair {name}, trial {trial} of {label}: estimated epipolar lines (green) on the true ones (blue), error \
             {:.2} px.",
            sight.trial.mean
        ),
    );
    document.facts(sight.facts());
    if let Some((drawing, caption)) = sight.profiles() {
        let caption = format!("Pair {name}, trial {trial}. {caption}");
        document.figure(format!("pair-{:02}-profiles", number + 1), drawing, caption);
    }
}

/// Returns the trial with the median error (the lower one of an even number). If that trial has no
/// F, returns the worst one with an F.
fn median_trial(trials: &[TrialRecord]) -> Option<&TrialRecord> {
    let mut sorted: Vec<_> = trials.iter().collect();
    sorted.sort_by(|a, b| a.mean.total_cmp(&b.mean).then(a.trial.cmp(&b.trial)));
    let middle = sorted.len().saturating_sub(1) / 2;
    sorted.iter().take(middle + 1).rev().find(|t| t.fundamental.is_some()).copied()
}
