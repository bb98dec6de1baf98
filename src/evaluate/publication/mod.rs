//! A report as a document with plots and pictures, fit for a paper's supplement.
//!
//! The figures come from the [`Report`]; for the few trials that are shown as pictures the estimator runs once
//! more, which gives the same result (same images, clicks, parameters and seed). Nothing in the document depends on
//! when or where it was made but the times.

mod circumstances;
mod failures;
mod overview;
mod pairs;
mod parameters;
mod sight;
mod style;
mod times;
mod worst;

use super::table::verdict_sentences;
use super::{Contender, Protocol, Record, Report, Scene};
use crate::publish::Document;

/// What a document is made from.
pub struct Subject<'a> {
    /// What came out.
    pub report: &'a Report,
    /// The scenes of the run.
    pub scenes: &'a [Scene],
    /// The contenders of the run.
    pub contenders: &'a [Box<dyn Contender>],
    /// What was measured on, for the title.
    pub name: &'a str,
    /// The command that makes the same run.
    pub command: &'a str,
}

impl Subject<'_> {
    /// The record of a scene and a contender.
    fn record(&self, scene: usize, contender: usize) -> &Record {
        &self.report.records[scene * self.contenders.len() + contender]
    }

    /// Names of the contenders.
    fn labels(&self) -> Vec<String> {
        self.contenders.iter().map(|c| c.label()).collect()
    }

    /// The contenders of a method.
    fn of_method<'s>(&'s self, method: &'s str) -> impl Iterator<Item = usize> + 's {
        (0..self.contenders.len()).filter(move |c| self.contenders[*c].method() == method)
    }

    /// Whose trials are shown as pictures: the first two-point contender, or else the first.
    fn shown(&self) -> Option<usize> {
        self.of_method(TWO_POINT).next().or_else(|| (!self.contenders.is_empty()).then_some(0))
    }
}

/// The method that this is about.
const TWO_POINT: &str = "two-point";

/// The document. `progress` hears how many of how many scenes have been drawn.
pub fn publication(subject: &Subject, progress: &dyn Fn(usize, usize)) -> Document {
    let plan = &subject.report.parameters.plan;
    let mut document = Document::new(
        format!("Epipolar geometry from clicked points: {}", subject.name),
        format!(
            "Epiline {} · {} pair{}, {} trials each · protocol {} · click noise {} px · seed {}",
            env!("CARGO_PKG_VERSION"),
            subject.scenes.len(),
            if subject.scenes.len() == 1 { "" } else { "s" },
            plan.trials,
            plan.protocol.name(),
            plan.noise,
            plan.seed
        ),
    );
    introduction(subject, &mut document);
    overview::write(subject, &mut document);
    let verdicts = verdict_sentences(subject.report);
    if !verdicts.is_empty() {
        document.subsection("How often the verdicts were true");
        document.list(verdicts);
    }
    times::write(subject, &mut document);
    pairs::write(subject, &mut document, progress);
    worst::write(subject, &mut document);
    failures::write(subject, &mut document);
    parameters::write(subject, &mut document);
    document
}

/// What was run and what is measured.
fn introduction(subject: &Subject, document: &mut Document) {
    let plan = &subject.report.parameters.plan;
    document.section("What was run");
    document.command(subject.command);
    let clicks = match plan.protocol {
        Protocol::Paper => "matches at least 30 px apart in both images",
        Protocol::WellPosed => {
            "matches at least 30 px apart in both images, and each at least 12 % of the longer side away from the \
             other's true epipolar line"
        }
        Protocol::WrongClick => {
            "matches as in the protocol well-posed, where the second click of image 2 is moved to another match: no \
             geometry fits such clicks"
        }
    };
    let noise = if plan.noise > 0.0 {
        format!("Gaussian noise of {} px is added to each clicked coordinate.", plan.noise)
    } else {
        "Clicks are exact.".to_owned()
    };
    document.paragraph(format!(
        "In every trial, true matches play the part of a person's clicks: {clicks}. {noise} All methods get the same \
         clicks, those that need more get further ones. The error of a trial is the mean symmetric epipolar distance of \
         all true matches of the pair to the estimated fundamental matrix, px. A trial without a result counts as an \
         infinite error and is never left out."
    ));
    document.list(subject.report.notes.clone());
}
