//! Driver of the estimator: propose, rank, refine, judge (paper, section 5.1).
//!
//! Lines through the clicks are compared, and their candidates propose epipoles. The [`SearchPlan`]
//! decides what else proposes and what ranks. The best hypotheses are refined, and the result is
//! judged.

use std::sync::Arc;
use std::time::Instant;

use super::checks::{check_images, check_points};
use super::evidence::viewed::SearchInput;
use super::searches::record::SearchRecord;
use super::searches::{barcodes, given, lines, passes, published};
use super::{Clicks, Estimate, EstimateError, EventKind, Monitor, Parameters, PreparedPair, SearchPlan};
use crate::geometry::PointPair;
use crate::image::GrayPlane;

/// Estimates the fundamental matrix of two images from clicked point pairs, full-size pixels, or
/// without any.
///
/// The published search takes as many pairs as its method needs and ignores further ones. The
/// search with patches uses all pairs, and starts from features if there are fewer than two. The
/// result does not depend on the number of threads. For repeated estimates on the same images,
/// prepare them once and call [`estimate_prepared`].
pub fn estimate(
    image1: &GrayPlane,
    image2: &GrayPlane,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    let begun = Instant::now();
    estimate_since(begun, &PreparedPair::new(image1, image2), pairs, parameters, monitor)
}

/// Runs [`estimate`] on prepared images.
pub fn estimate_prepared(
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    estimate_since(Instant::now(), prepared, pairs, parameters, monitor)
}

/// Runs [`estimate_prepared`] with times that count from an earlier moment.
pub(crate) fn estimate_since(
    begun: Instant,
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    parameters.check()?;
    let plan = SearchPlan::of(parameters, pairs.len());
    let clicks = Clicks::for_plan(pairs, plan);
    check_points(prepared.frames(), &clicks, plan)?;
    check_images(prepared)?;
    let mut record = SearchRecord::new(begun, monitor);
    if matches!(plan, SearchPlan::Patches { .. } | SearchPlan::Unclicked) {
        record.counts.left_out = prepared.pyramids().left_out();
    }
    let input = SearchInput { prepared, clicks: &clicks, parameters };
    let found = match (plan, prepared.given_alone(parameters)?) {
        (SearchPlan::Barcodes, _) => barcodes::search(input, &mut record),
        (_, Some(given)) => given::search(input, given, &mut record),
        (SearchPlan::Published { .. }, _) => published::search(input, &mut record),
        (SearchPlan::Patches { .. } | SearchPlan::Unclicked, _) => {
            let found = passes::search(input, plan, &mut record);
            given::compared(input, found, &mut record)
        }
        (SearchPlan::LinesAlone { ranked_by }, _) => lines::search(input, ranked_by, &mut record),
    };
    let best = found?;
    record.finish()?;
    record.note(EventKind::Selected(best.proposed().into()));
    let trace = record.trace(&best.clicks, &best.pencils, &best.patches, best.hypotheses, parameters);
    let (fundamental, origin) = (best.fundamental, Some(best.origin));
    Ok(Estimate { fundamental, origin, assessment: best.assessment, trace: Some(Arc::new(trace)) })
}

#[cfg(test)]
mod tests {
    use super::super::exact::ExactScene;
    use super::super::{CHECKPOINTS, ClickRole, Method, Preset};
    use super::*;
    use crate::geometry::{Frame, symmetric_epipolar_distance};

    #[test]
    fn images_without_pixels_or_with_pixels_that_are_no_numbers_give_no_panic() {
        let empty = GrayPlane::new(Frame::new(0, 0), Vec::new());
        let row = GrayPlane::from_fn(Frame::new(300, 1), |x, _| (x % 7) as f32);
        let texture = |x: usize, y: usize| (x * x + 7 * y * (x % 5)) as f32 % 251.0;
        let image = GrayPlane::from_fn(Frame::new(120, 90), texture);
        let holes = GrayPlane::from_fn(Frame::new(120, 90), |x, y| {
            if (x + y) % 11 == 0 { f32::NAN } else { texture(x + 3, y) }
        });
        let clicks = [PointPair::new(30.0, 30.0, 27.0, 30.0), PointPair::new(90.0, 60.0, 87.0, 60.0)];
        for (image1, image2) in [(&empty, &empty), (&empty, &image), (&row, &image), (&row, &row)] {
            for pairs in [&clicks[..], &[]] {
                let found = estimate(image1, image2, pairs, &Parameters::default(), &Monitor::silent());
                assert!(found.is_err());
            }
        }
        for preset in Preset::ALL {
            for pairs in [&clicks[..], &[]] {
                let _ = estimate(&image, &holes, pairs, &Parameters::from(preset), &Monitor::silent());
            }
        }
    }

    #[test]
    fn a_third_pair_takes_part_in_every_search() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let [p, q] = scene.clicks();
        // The fourth pair is wrong. It is only measured, or outvoted.
        let pairs = [p, q, scene.seen(0.3, -0.5, 6.59), PointPair::new(30.0, 30.0, 200.0, 200.0)];
        for (preset, largest) in [(Preset::Paper, 6.0), (Preset::Robust, 0.3)] {
            let parameters =
                Parameters { method: Method::ThreePoint, hypotheses: 1000, ..Parameters::from(preset) };
            let found = estimate_prepared(&prepared, &pairs, &parameters, &Monitor::silent()).unwrap();
            let error = scene.error(found.fundamental());
            assert!(error < largest, "{preset:?}: {error} px");
            let trace = found.trace.as_ref().unwrap();
            let roles: Vec<ClickRole> = trace.clicks.iter().map(|click| click.role).collect();
            let fourth = if preset == Preset::Paper { ClickRole::Check } else { ClickRole::Observed };
            assert_eq!(roles, [ClickRole::Anchor, ClickRole::Anchor, ClickRole::Observed, fourth]);
            assert_eq!(trace.pencils.len(), 2);
            if preset == Preset::Paper {
                // The third pair is not used in the refinement, but every hypothesis passes through
                // all three.
                for hypothesis in found.hypotheses() {
                    let off =
                        pairs[..3].iter().map(|m| symmetric_epipolar_distance(hypothesis.fundamental(), m));
                    assert!(off.fold(0.0, f64::max) < 1e-6);
                }
            }
        }
        let two = Parameters { method: Method::ThreePoint, ..Parameters::default() };
        let missing = estimate_prepared(&prepared, &pairs[..2], &two, &Monitor::silent());
        assert_eq!(missing.unwrap_err(), EstimateError::TooFewPairs { found: 2, needed: 3 });
    }

    #[test]
    fn the_course_of_a_search_is_recorded_in_order_and_on_any_number_of_threads() {
        let scene = ExactScene::aside();
        let run = |pairs: &[PointPair], threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let prepared = scene.prepared();
            let parameters = Parameters::default();
            pool.install(|| estimate_prepared(&prepared, pairs, &parameters, &Monitor::silent())).unwrap()
        };
        for pairs in [&[][..], &scene.clicks()] {
            let [one, two] = [1, 2].map(|threads| run(pairs, threads));
            let kinds = |found: &Estimate| -> Vec<EventKind> {
                found.trace.as_ref().unwrap().events.iter().map(|event| event.kind.clone()).collect()
            };
            assert_eq!(kinds(&one), kinds(&two));
            let events = &one.trace.as_ref().unwrap().events;
            assert!(events.is_sorted_by(|a, b| a.seconds <= b.seconds));
            assert!(matches!(events[0].kind, EventKind::Began(_)));
            let EventKind::Selected(selected) = events.last().unwrap().kind else { panic!("{events:?}") };
            assert_eq!((Some(selected.origin), selected.fundamental), (one.origin, one.fundamental));
            let origins = events.iter().filter_map(|event| match &event.kind {
                EventKind::Proposed { hypotheses, .. } => {
                    Some(hypotheses.iter().map(|one| one.origin.source))
                }
                _ => None,
            });
            assert!(origins.flatten().any(|source| source == selected.origin.source), "{events:?}");
            let steps = events.iter().rev().find_map(|event| match &event.kind {
                EventKind::Refined { steps, .. } => Some(steps),
                _ => None,
            });
            let [first, .., last] = steps.unwrap().as_slice() else { panic!("{steps:?}") };
            assert_eq!(last.fundamental, one.fundamental);
            let [before, after] = [first, last].map(|step| scene.error(&step.fundamental));
            assert!(after < before && steps.unwrap().iter().all(|step| step.matches > 0), "{before} {after}");
            let ranked = events.iter().find_map(|event| match &event.kind {
                EventKind::Ranked(ranked) => ranked.first(),
                _ => None,
            });
            let ranked = ranked.unwrap();
            assert_eq!(ranked.course.len(), CHECKPOINTS);
            let off = ranked.course[CHECKPOINTS - 1] - ranked.hypothesis.support.unwrap();
            assert!(off.abs() < 1e-6, "the race ends at the support: {off}");
            let features = events.iter().any(|event| matches!(event.kind, EventKind::Matched { .. }));
            assert_eq!(features, pairs.is_empty());
        }
    }
}
