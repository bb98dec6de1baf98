//! Section of trials without a result, with their reasons.

use super::ReportSubject;
use crate::publish::{Publication, TextTable};

pub(super) fn write(subject: &ReportSubject, document: &mut Publication) {
    document.section("Trials without a result");
    // Method and reason with their trials, in the order of first occurrence.
    let mut groups: Vec<(String, &str, Vec<String>)> = Vec::new();
    for (c, label) in subject.labels().into_iter().enumerate() {
        for (s, scene) in subject.scenes.iter().enumerate() {
            for trial in &subject.record(s, c).trials {
                let Some(reason) = trial.failure.as_deref() else { continue };
                let place = format!("{} trial {}", scene.name, trial.trial + 1);
                match groups.iter_mut().find(|(l, r, _)| *l == label && *r == reason) {
                    Some(group) => group.2.push(place),
                    None => groups.push((label.clone(), reason, vec![place])),
                }
            }
        }
    }
    if groups.is_empty() {
        let made = subject.report.trials_made;
        document.paragraph(match made {
            0 => "No trial was made.".to_owned(),
            1 => "None: the one trial gave a fundamental matrix.".to_owned(),
            _ => format!("None: all {made} trials gave a fundamental matrix."),
        });
        return;
    }
    document.table(TextTable {
        caption: "Every trial without a fundamental matrix, with the reason.".to_owned(),
        headings: ["method", "reason", "where", "trials"].map(str::to_owned).to_vec(),
        rows: groups
            .into_iter()
            .map(|(label, reason, places)| {
                vec![label, reason.to_owned(), places.join(", "), places.len().to_string()]
            })
            .collect(),
        words: 3,
        ruled: Vec::new(),
    });
}
