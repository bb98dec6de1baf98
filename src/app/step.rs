//! Where each step of the algorithm stands and what it found, in words.

use super::computation::{Computation, Freshness};
use super::document::{Document, pair_name};
use crate::estimate::{Estimate, Stage};

/// Where a step stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// Not begun.
    Waiting,
    /// Under way.
    Running,
    /// Done, in so many seconds, if that is known.
    Done(Option<f64>),
    /// The user stopped the computation here.
    Stopped,
    /// It ended here without a result.
    Failed,
}

/// Where a step stands.
pub fn progress(stage: Stage, computation: &Computation) -> Progress {
    if let Some((estimate, Freshness::Final)) = computation.result() {
        let timing = estimate.timings.iter().find(|timing| timing.stage == stage);
        return Progress::Done(timing.map(|timing| timing.seconds));
    }
    // The first step is not announced: it runs from the start until the next one begins.
    let begun: Vec<_> = computation.stages().collect();
    let position = begun.iter().position(|(other, _)| *other == stage);
    let took = position.and_then(|k| begun[k].1);
    match (position, took) {
        (_, Some(took)) => Progress::Done(Some(took.as_secs_f64())),
        (None, None) if stage == Stage::Pyramid && !begun.is_empty() => Progress::Done(None),
        (None, None) if stage != Stage::Pyramid || !computation.has_begun() => Progress::Waiting,
        _ if computation.is_running() => Progress::Running,
        _ if computation.failure().is_some() => Progress::Failed,
        _ => Progress::Stopped,
    }
}

/// What a step found, in a line; `None` while it has found nothing.
pub fn result_text(stage: Stage, document: &Document, computation: &Computation) -> Option<String> {
    let result = computation.result().filter(|(_, freshness)| *freshness != Freshness::Stale);
    let estimate = result.map(|(estimate, _)| estimate);
    match stage {
        Stage::Pyramid => {
            let [left, right] = document.pictures.as_ref()?.each_ref().map(|picture| picture.frame);
            computation.has_begun().then(|| {
                format!("{} × {} and {} × {} px", left.width, left.height, right.width, right.height)
            })
        }
        Stage::Pencils => {
            let pencils = computation.pencils()?;
            let of = |k: usize| {
                let own = &pencils[k];
                format!(
                    "{}: {} × {} lines, {} candidates",
                    document.used().nth(k).map_or(String::new(), pair_name),
                    own.angles1().len(),
                    own.angles2().len(),
                    own.candidates().len()
                )
            };
            Some(format!("{}; {}", of(0), of(1)))
        }
        Stage::Hypotheses => {
            estimate.filter(|e| e.counts.hypotheses > 0).map(|e| format!("{} tried", e.counts.hypotheses))
        }
        Stage::Validation => estimate.filter(|e| e.score.is_finite()).map(validation),
        Stage::Refinement => {
            estimate.filter(|_| matches!(result, Some((_, Freshness::Final)))).map(|estimate| {
                if estimate.refined {
                    format!("fitted to {} matches", estimate.matches.len())
                } else {
                    "not refined on patches".to_owned()
                }
            })
        }
    }
}

fn validation(estimate: &Estimate) -> String {
    let counts = &estimate.counts;
    format!("{} compared, best line score {:.3}", counts.validated, estimate.score)
}
