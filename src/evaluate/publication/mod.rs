//! Report as a document with plots and pictures, suitable as a paper's supplement.
//!
//! The numbers come from the [`Report`]. For trials shown as pictures the estimator runs again with
//! the same images, clicks, parameters and seed, which gives the same result. Apart from the times,
//! the document does not depend on when or where it was made.

mod circumstances;
mod failures;
mod overview;
mod pairs;
mod parameters;
mod sight;
mod style;
mod times;
mod worst;

use super::table::{counted, verdict_sentences};
use super::{Contender, KnownScene, Protocol, Record, Report};
use crate::publish::Publication;

/// Content of a document.
pub struct ReportSubject<'a> {
    /// Report of the run.
    pub report: &'a Report,
    /// Scenes of the run.
    pub scenes: &'a [KnownScene],
    /// Contenders of the run.
    pub contenders: &'a [Box<dyn Contender>],
    /// Name of the data set, for the title.
    pub name: &'a str,
    /// Command that repeats the run.
    pub command: &'a str,
}

impl ReportSubject<'_> {
    /// Returns the record of a scene and a contender.
    fn record(&self, scene: usize, contender: usize) -> &Record {
        &self.report.records[scene * self.contenders.len() + contender]
    }

    /// Returns the labels of the contenders.
    fn labels(&self) -> Vec<String> {
        self.contenders.iter().map(|c| c.label()).collect()
    }

    /// Returns the contenders of a method.
    fn of_method<'s>(&'s self, method: &'s str) -> impl Iterator<Item = usize> + 's {
        (0..self.contenders.len()).filter(move |c| self.contenders[*c].method() == method)
    }

    /// Returns the contender whose trials are shown as pictures: the first two-point contender,
    /// otherwise the first.
    fn shown(&self) -> Option<usize> {
        self.of_method(TWO_POINT).next().or_else(|| (!self.contenders.is_empty()).then_some(0))
    }
}

/// Method of main interest: its trials are shown as pictures.
const TWO_POINT: &str = "two-point";

/// Creates the document. `progress` receives the number of drawn scenes and their total.
pub fn publication(subject: &ReportSubject, progress: &dyn Fn(usize, usize)) -> Publication {
    let plan = &subject.report.parameters.plan;
    let (made, planned) = (subject.report.trials_made, subject.report.trials_planned);
    let stopped =
        if made < planned { format!(" · stopped after {made} of {planned} trials") } else { String::new() };
    let mut document = Publication::new(
        format!("Epipolar geometry from clicked points: {}", subject.name),
        format!(
            "Epiline {} · {}, {} each{stopped} · protocol {} · click noise {} px · seed {}",
            env!("CARGO_PKG_VERSION"),
            counted(subject.scenes.len(), "pair"),
            counted(plan.trials, "trial"),
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

/// Writes the section on the run and its measurements.
fn introduction(subject: &ReportSubject, document: &mut Publication) {
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
            "matches as in the protocol well-posed, with the second click of image 2 moved to another match: no \
             geometry fits such clicks"
        }
    };
    let noise = if plan.noise > 0.0 {
        format!("Gaussian noise of {} px is added to each clicked coordinate.", plan.noise)
    } else {
        "Clicks are exact.".to_owned()
    };
    document.paragraph(format!(
        "In every trial, true matches take the place of a person's clicks: {clicks}. {noise} All methods get the same \
         clicks, and further ones if they need more. The error of a trial is the mean symmetric epipolar distance of \
         all true matches of the pair to the estimated fundamental matrix, px. A trial without a result counts as an \
         infinite error and is never left out."
    ));
    document.list(subject.report.notes.clone());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{CancelFlag, Parameters};
    use crate::evaluate::scene::tests::example_scene;
    use crate::evaluate::{Outcome, Plan, contenders, run};
    use crate::geometry::PointPair;
    use crate::publish::{html, markdown};

    /// Contender that always fails.
    struct Hopeless;

    impl Contender for Hopeless {
        fn method(&self) -> &'static str {
            TWO_POINT
        }

        fn clicks_needed(&self) -> usize {
            2
        }

        fn estimate(&self, _: &KnownScene, _: &[PointPair]) -> Result<Outcome, String> {
            Err("the clicks say <nothing>".to_owned())
        }
    }

    fn document(scenes: &[KnownScene], contenders: &[Box<dyn Contender>], stop: &CancelFlag) -> Publication {
        let plan = Plan {
            protocol: Protocol::Paper,
            trials: 3,
            noise: 0.5,
            seed: 2,
            trials_at_once: 1,
            threads_per_trial: 1,
        };
        let report = run(scenes, contenders, &plan, &|_| (), stop).unwrap();
        let subject =
            ReportSubject { report: &report, scenes, contenders, name: "set", command: "epiline evaluate" };
        publication(&subject, &|_, _| ())
    }

    #[test]
    fn failures_are_shown_with_their_reason_and_the_pairs_without_pictures() {
        let scenes = [example_scene("one", 30), example_scene("two", 30)];
        let mut all: Vec<Box<dyn Contender>> = vec![Box::new(Hopeless)];
        all.extend(contenders(&["eight-point".to_owned()], &[Parameters::default()]).unwrap());
        let page = html(&document(&scenes, &all, &CancelFlag::default()));
        assert!(page.contains("the clicks say &lt;nothing&gt;"));
        assert!(page.contains("one trial 1, one trial 2, one trial 3, two trial 1"));
        assert!(page.contains("No trial gave a fundamental matrix") && !page.contains("NaN"));
        assert!(page.contains("\u{d7} 3"), "failures are counted in the plot");
    }

    #[test]
    fn baselines_alone_are_shown_with_lines_and_without_profiles() {
        let scenes = [example_scene("one", 40)];
        let all = contenders(&["eight-point".to_owned()], &[Parameters::default()]).unwrap();
        let files = markdown(&document(&scenes, &all, &CancelFlag::default()), "figures");
        let names: Vec<_> = files.figures.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["errors-cumulative.svg", "errors-by-pair.svg", "pair-01-lines.svg"]);
        // Eight true and eight estimated lines in each image, each with an outline.
        assert_eq!(files.figures[2].1.matches("stroke-opacity=\"0.45\"").count(), 32);
        assert!(!files.text.contains("Worst trials"), "worst trials are of two-point only");
    }

    #[test]
    fn a_run_stopped_before_its_first_trial_is_still_a_document() {
        let stop = CancelFlag::default();
        stop.cancel();
        let all: Vec<Box<dyn Contender>> = vec![Box::new(Hopeless)];
        let page = html(&document(&[example_scene("one", 30)], &all, &stop));
        assert!(page.contains("3 trials each · stopped after 0 of 3 trials · protocol"), "{page}");
        assert!(page.contains("Stopped: 0 of 3 trials were made.") && page.contains("No trial was made."));
        assert!(!page.contains("NaN") && !page.contains("inf<"), "{page}");
    }
}
