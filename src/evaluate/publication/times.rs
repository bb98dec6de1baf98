//! Table of the times of a trial.

use super::{ReportSubject, counted};
use crate::evaluate::table::seconds;
use crate::evaluate::{median, quantile};
use crate::publish::{Publication, TextTable};

pub(super) fn write(subject: &ReportSubject, document: &mut Publication) {
    let plan = &subject.report.parameters.plan;
    let rows = (0..subject.contenders.len()).map(|c| {
        let trials = || (0..subject.scenes.len()).flat_map(move |s| &subject.record(s, c).trials);
        let all: Vec<f64> = trials().map(|t| t.seconds).collect();
        let first: Vec<f64> = trials().filter_map(|t| t.first_seconds).collect();
        vec![
            subject.contenders[c].label(),
            all.len().to_string(),
            seconds(median(&all)),
            seconds(quantile(&all, 0.9)),
            seconds(quantile(&all, 1.0)),
            seconds(median(&first)),
        ]
    });
    document.section("Time");
    document.table(TextTable {
        caption: format!(
            "Seconds per trial on {}, {} at a time, preparation of the images included.",
            counted(plan.threads_per_trial, "thread"),
            counted(plan.trials_at_once, "trial"),
        ),
        headings: ["method", "trials", "median", "90 %", "longest", "first geometry, median"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
        words: 1,
        ruled: Vec::new(),
    });
}
