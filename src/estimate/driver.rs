//! The estimator: propose → rank → refine → judge (paper, section 5.1).
//!
//! Lines through the clicks are compared, and their candidates propose epipoles. What ranks the proposals is one of two
//! searches; the best ones are refined, and the result is judged.

use std::sync::Arc;
use std::time::Instant;

use super::assess::{check_images, check_points};
use super::covariant::{FeatureEvidence, FeatureSearchParameters, hypotheses_from_features};
use super::patches::{self, Proposal};
use super::record::SearchRecord;
use super::search::{Found, Input, Judged, by_lines, by_patches};
use super::views::{is_same, view_of};
use super::{Clicks, Estimate, EstimateError, Monitor, Parameters, PreparedPair, Search, Stage};
use crate::geometry::{
    FundamentalMatrix, Observation, PointPair, eight_point, fit_fundamental, sampson_distance,
};
use crate::image::{GrayPlane, RelativeView};

/// Estimates the fundamental matrix of two images from two or more clicked point pairs, full-size pixels.
///
/// The published search takes as many pairs as its method needs and ignores further ones; the search with patches uses
/// all of them. The same images, pairs, parameters and seed give the same result on any number of
/// threads. To estimate again on the same images, prepare them once and call [`estimate_prepared`].
pub fn estimate(
    image1: &GrayPlane,
    image2: &GrayPlane,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    let begun = Instant::now();
    run(&PreparedPair::new(image1, image2), pairs, parameters, monitor, begun)
}

/// [`estimate`] on images that were prepared before.
pub fn estimate_prepared(
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    run(prepared, pairs, parameters, monitor, Instant::now())
}

fn run(
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
    begun: Instant,
) -> Result<Estimate, EstimateError> {
    let clicks = Clicks::for_search(pairs, parameters.method, parameters.search);
    parameters.check()?;
    check_points(prepared.frames(), pairs, parameters.method)?;
    check_images(prepared)?;
    let source = prepared.similarity_source(RelativeView::UPRIGHT, parameters);
    let patches = prepared.upright_patches();
    let cancel = monitor.cancel();
    let input = Input { prepared, source: &*source, patches: &patches, clicks: &clicks, parameters, cancel };
    let mut record = SearchRecord::new(begun, monitor);
    let best = match parameters.search {
        Search::Lines => {
            let found = by_lines(&input, &mut record)?;
            input.judged(&record, found)
        }
        Search::Patches => wider(&input, &mut record)?,
    };
    record.finish()?;
    let trace = record.trace(&clicks, &best.patches, best.hypotheses, parameters);
    Ok(Estimate {
        geometry: best.fundamental.into(),
        assessment: best.assessment,
        trace: Some(Arc::new(trace)),
    })
}

/// Views that are looked at beside the upright one.
const VIEWS: usize = 2;

/// The search with patches, upright; and where that leaves doubts, with covariant features too, under the views that
/// they suggest. Of all, the one whose refined matches weigh most is the result, and the others are its rivals.
fn wider(input: &Input, record: &mut SearchRecord) -> Result<Judged, EstimateError> {
    let upright = match by_patches(input, record) {
        Ok(found) => Ok(input.judged(record, found)),
        Err(error @ (EstimateError::NoCandidates { .. } | EstimateError::NoGeometry)) => Err(error),
        Err(error) => return Err(error),
    };
    if upright.as_ref().is_ok_and(Judged::is_clear) {
        return upright;
    }
    let Input { prepared, clicks, parameters, cancel, .. } = *input;
    record.enter(Stage::Features)?;
    let features = prepared.features();
    let observed = clicks.observed();
    let evidence = FeatureEvidence {
        sets: features.sets.each_ref(),
        matches: &features.matches,
        frames: prepared.frames(),
        clicks: &observed,
        click_sigma: parameters.click_sigma,
    };
    let search = FeatureSearchParameters { seed: parameters.seed, ..FeatureSearchParameters::default() };
    let proposed: Vec<FundamentalMatrix> =
        hypotheses_from_features(&evidence, &search).into_iter().map(|h| h.fundamental).collect();
    cancel.check()?;
    let mut views: Vec<RelativeView> = Vec::new();
    for view in proposed.iter().filter_map(|f| view_of(f, features, prepared.frames())) {
        if views.len() < VIEWS && !views.iter().any(|known| is_same(known, &view)) {
            views.push(view);
        }
    }
    let mut all: Vec<Judged> = Vec::new();
    let mut failure = None;
    match upright {
        Ok(found) => all.push(found),
        Err(error) => failure = Some(error),
    }
    for view in views {
        let source = prepared.similarity_source(view, parameters);
        let patches = prepared.patches_with_features(view);
        let seen = Input { source: &*source, patches: &patches, ..*input };
        let rivals = all.first().map_or(&[][..], |upright| &upright.hypotheses);
        if let Some(found) = by_features(&seen, &proposed, rivals)? {
            all.push(seen.judged(record, found));
        }
    }
    let best = (0..all.len()).max_by(|a, b| all[*a].weight.total_cmp(&all[*b].weight).then(b.cmp(a)));
    let best = match best {
        Some(best) => all.swap_remove(best),
        None => return Err(failure.unwrap_or(EstimateError::NoGeometry)),
    };
    let Some(f) = of_clicks_alone(&observed, &best.fundamental, parameters.click_sigma) else {
        return Ok(best);
    };
    let mut hypotheses = vec![Estimate::from(f)];
    hypotheses.extend(best.hypotheses);
    let found = Found { fundamental: f, hypotheses, supporting: observed, refined: None };
    Ok(input.judged(record, found))
}

/// Clicks that determine F by themselves, with one to tell that they agree.
const CLICKS_ALONE: usize = 8;
/// A geometry that contradicts the clicks has them this many times as far off their lines as the one they determine.
const CONTRADICTED: f64 = 3.0;

/// The geometry that the clicks determine by themselves, where they agree with each other and contradict `found`.
fn of_clicks_alone(
    clicks: &[PointPair],
    found: &FundamentalMatrix,
    click_sigma: f64,
) -> Option<FundamentalMatrix> {
    if clicks.len() < CLICKS_ALONE {
        return None;
    }
    let observations: Vec<Observation> =
        clicks.iter().map(|pair| Observation { pair: *pair, sigma: click_sigma }).collect();
    let fitted = fit_fundamental(&eight_point(clicks).ok()?, &observations, ROBUST_CLICKS)?.fundamental;
    let middle = |f: &FundamentalMatrix| {
        let mut distances: Vec<f64> = clicks.iter().map(|pair| sampson_distance(f, pair)).collect();
        distances.sort_by(f64::total_cmp);
        distances[distances.len() / 2]
    };
    (middle(found) > CONTRADICTED * middle(&fitted).max(click_sigma)).then_some(fitted)
}

/// Standard deviations from which on a click loses influence on a fit to clicks.
const ROBUST_CLICKS: f64 = 3.0;

/// What covariant features propose, ranked by patches and features under a view, and refined; `None` when none of it
/// passes through the clicks.
fn by_features(
    input: &Input,
    proposed: &[FundamentalMatrix],
    rivals: &[Estimate],
) -> Result<Option<Found>, EstimateError> {
    let Input { prepared, patches: levels, clicks, parameters, cancel, .. } = *input;
    let anchors = clicks.anchors();
    let Some(anchors) = anchors.first_chunk::<2>() else { return Ok(None) };
    let fine = levels.fine(prepared.pyramids());
    let turn = levels.view().rotation;
    let starts: Vec<Proposal> =
        proposed.iter().filter_map(|f| Proposal::of(f, *anchors, turn, fine)).collect();
    // What was found upright competes under the same support.
    let rivals = rivals.iter().filter_map(|h| Proposal::of(h.fundamental(), *anchors, h.turn(), fine));
    let ranked = patches::rank_fine(fine, starts, rivals.collect(), &clicks.observed(), parameters, cancel)?;
    if ranked.is_empty() {
        return Ok(None);
    }
    let (hypotheses, _) = input.hypotheses(*anchors, &ranked)?;
    input.refine_ranked(&ranked, hypotheses).map(Some)
}

#[cfg(test)]
mod tests {
    use super::super::exact::ExactScene;
    use super::super::{ClickRole, Method, Preset};
    use super::*;
    use crate::geometry::symmetric_epipolar_distance;

    #[test]
    fn a_third_pair_takes_part_whatever_searches() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let prepared = PreparedPair::new(&plane1, &plane2);
        let [p, q] = scene.clicks();
        // A fourth pair that is wrong is only measured, or outvoted.
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
                // Not refined on the third, but every hypothesis passes through all three.
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
}
