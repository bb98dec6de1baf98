//! The search with patches, and what goes on where that leaves doubts: covariant features, and the views they suggest.

use crate::estimate::evidence::features::{
    FeatureEvidence, FeatureHypothesis, FeatureSearchParameters, hypotheses_from_features,
};
use crate::estimate::evidence::features::{is_same, view_of};
use crate::estimate::evidence::patches::{self, Proposal};
use crate::estimate::searches::patches::by_patches;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::searches::search::{Found, Judged, SearchInput};
use crate::estimate::verdict::selection::{ClickedPairs, chosen};
use crate::estimate::{Estimate, EstimateError, Stage};
use crate::features::FeatureViews;
use crate::geometry::{
    FundamentalMatrix, Observation, PointPair, eight_point, fit_fundamental, sampson_distance, seven_point,
};
use crate::image::RelativeView;

/// Views that are looked at beside the upright one.
const VIEWS: usize = 2;

/// What covariant features propose, best first.
pub(in crate::estimate) struct FeatureProposals {
    pub hypotheses: Vec<FeatureHypothesis>,
    /// How the images are turned and scaled against each other by what these explain.
    pub views: Vec<RelativeView>,
}

impl FeatureProposals {
    /// What features propose, held together by the clicks, however many.
    pub fn new(input: &SearchInput, of: FeatureViews) -> Result<Self, EstimateError> {
        let SearchInput { prepared, clicks, parameters, cancel, .. } = *input;
        let features = prepared.features(of);
        let observed = clicks.observed();
        let evidence = FeatureEvidence {
            sets: features.sets.each_ref(),
            matches: &features.matches,
            frames: prepared.frames(),
            clicks: &observed,
            click_sigma: parameters.click_sigma,
        };
        let search = FeatureSearchParameters { seed: parameters.seed, ..FeatureSearchParameters::default() };
        let hypotheses = hypotheses_from_features(&evidence, &search);
        cancel.check()?;
        let mut views: Vec<RelativeView> = Vec::new();
        for view in hypotheses.iter().filter_map(|h| view_of(&h.fundamental, features, prepared.frames())) {
            if views.len() < VIEWS && !views.iter().any(|known| is_same(known, &view)) {
                views.push(view);
            }
        }
        Ok(Self { hypotheses, views })
    }
}

/// The search with patches, upright; and where that leaves doubts, with covariant features too, under the views that
/// they suggest. The others are rivals of the one that is chosen.
pub(in crate::estimate) fn wider(
    input: &SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let upright = match by_patches(input, record) {
        Ok(found) => Ok(input.judged(record, found)),
        Err(error @ (EstimateError::NoCandidates { .. } | EstimateError::NoGeometry)) => Err(error),
        Err(error) => return Err(error),
    };
    if upright.as_ref().is_ok_and(Judged::is_clear) {
        return upright;
    }
    record.enter(Stage::Features)?;
    let mut all: Vec<Judged> = Vec::new();
    let mut failure = None;
    match upright {
        Ok(found) => all.push(found),
        Err(error) => failure = Some(error),
    }
    for of in [FeatureViews::Frontal, FeatureViews::Slanted] {
        if under_views(input, of, record, &mut all)? {
            break;
        }
    }
    let observed = input.clicks.observed();
    let clicked = ClickedPairs { pairs: &observed, sigma: input.parameters.click_sigma };
    let best = chosen(&all, &clicked).map(|k| all.swap_remove(k));
    let best = best.ok_or(failure.unwrap_or(EstimateError::NoGeometry))?;
    let Some(f) = of_clicks_alone(&observed, &best.fundamental, input.parameters.click_sigma) else {
        return Ok(best);
    };
    // Judged as what it replaces was: under the same view, by what was found under it.
    let source = input.prepared.similarity_source(best.patches.view(), input.parameters);
    let seen = SearchInput { source: &*source, patches: &best.patches, clicks: &best.clicks, ..*input };
    let support = best.patches.measure(input.prepared.pyramids(), &f);
    let mut hypotheses = vec![Estimate::proposed(f, None, support)];
    hypotheses.extend(best.hypotheses);
    let found = Found { fundamental: f, hypotheses, supporting: observed, refined: None, clicks_alone: true };
    Ok(seen.judged(record, found))
}

/// Adds what features propose under each of the views that they suggest, up to one whose result is clear: whether there is
/// one.
fn under_views(
    input: &SearchInput,
    of: FeatureViews,
    record: &mut SearchRecord,
    all: &mut Vec<Judged>,
) -> Result<bool, EstimateError> {
    let FeatureProposals { hypotheses, views } = FeatureProposals::new(input, of)?;
    let proposed: Vec<FundamentalMatrix> = hypotheses.iter().map(|h| h.fundamental).collect();
    for view in views {
        let source = input.prepared.similarity_source(view, input.parameters);
        let patches = input.prepared.patches_with_features(view, of);
        let seen = SearchInput { source: &*source, patches: &patches, ..*input };
        let rivals = all.first().map_or(&[][..], |upright| &upright.hypotheses);
        if let Some(found) = by_features(&seen, &proposed, rivals)? {
            all.push(seen.judged(record, found));
            if all.last().is_some_and(Judged::is_clear) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// Clicks that determine F by themselves, with one to tell that they agree.
const CLICKS_ALONE: usize = 8;
/// A geometry that contradicts the clicks has them this many times as far off their lines as one that the others determine.
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
    let off_found = clicks.iter().map(|pair| sampson_distance(found, pair)).collect();
    // A fit passes eight clicks that determine it badly, too: how far it can be trusted shows in a click it was not fitted to.
    let off_others = (0..clicks.len()).map(|k| off_the_others(clicks, k)).collect();
    (middle(off_found) > CONTRADICTED * middle(off_others).max(click_sigma)).then_some(fitted)
}

/// How far a click is off the geometry that the others determine by themselves, px; infinitely where they determine none.
fn off_the_others(clicks: &[PointPair], k: usize) -> f64 {
    let mut others = clicks.to_vec();
    let left_out = others.remove(k);
    let solutions = if others.len() < 8 {
        seven_point(&others).unwrap_or_default()
    } else {
        eight_point(&others).into_iter().collect()
    };
    let distance = |f: &FundamentalMatrix| sampson_distance(f, &left_out);
    solutions.iter().map(distance).fold(f64::INFINITY, f64::min)
}

fn middle(mut distances: Vec<f64>) -> f64 {
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}

/// Standard deviations from which on a click loses influence on a fit to clicks.
const ROBUST_CLICKS: f64 = 3.0;

/// What covariant features propose, ranked by patches and features under a view, and refined; `None` when none of it
/// passes through the clicks, of which there may be any number.
pub(in crate::estimate) fn by_features(
    input: &SearchInput,
    proposed: &[FundamentalMatrix],
    rivals: &[Estimate],
) -> Result<Option<Found>, EstimateError> {
    let SearchInput { prepared, patches: levels, clicks, parameters, cancel, .. } = *input;
    let anchors = clicks.anchors();
    let anchors = anchors.first_chunk::<2>();
    let fine = levels.fine(prepared.pyramids());
    let turn = levels.view().rotation;
    let starts: Vec<Proposal> =
        proposed.iter().filter_map(|f| Proposal::of(f, anchors, turn, fine)).collect();
    // What was found upright competes under the same support.
    let rivals = rivals.iter().filter_map(|h| Proposal::of(h.fundamental(), anchors, h.turn(), fine));
    let ranked = patches::rank_fine(fine, starts, rivals.collect(), &clicks.observed(), parameters, cancel)?;
    if ranked.is_empty() {
        return Ok(None);
    }
    let (hypotheses, _) = input.hypotheses(anchors, &ranked)?;
    input.refine_ranked(&ranked, hypotheses).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{
        Assessment, CancelFlag, Clicks, Monitor, Parameters, Reason, SearchPlan, estimate_prepared,
    };

    #[test]
    fn clicks_that_agree_overrule_a_geometry_that_contradicts_them() {
        let scene = ExactScene::aside();
        let (truth, wrong) = (scene.fundamental(), scene.disturbed(30.0));
        let mut clicks = scene.pairs(12);
        let error = |f: &FundamentalMatrix| scene.error(f);
        let alone = |clicks: &[PointPair], found: &FundamentalMatrix| of_clicks_alone(clicks, found, 1.0);
        assert!(error(&alone(&clicks, &wrong).unwrap()) < 1e-3);
        assert!(alone(&clicks, &truth).is_none(), "nothing contradicts them");
        assert!(alone(&clicks, &scene.disturbed(0.5)).is_none(), "within what clicks are off");
        assert!(alone(&clicks[..CLICKS_ALONE], &wrong).is_some());
        assert!(alone(&clicks[..CLICKS_ALONE - 1], &wrong).is_none(), "nothing tells that seven agree");
        // A single slip of a click is outvoted.
        clicks[4].point2.y += 6.0;
        assert!(error(&alone(&clicks, &wrong).unwrap()) < 2.0);
    }

    #[test]
    fn eight_clicks_that_do_not_agree_overrule_nothing() {
        let scene = ExactScene::aside();
        let mut clicks = scene.pairs(CLICKS_ALONE);
        for (k, pair) in (1..).zip(&mut clicks) {
            pair.point2.y += 8.0 * (12.9898 * f64::from(k) + 1.0).sin();
        }
        let off = |f: &FundamentalMatrix| clicks.iter().map(|pair| sampson_distance(f, pair)).collect();
        // A fit to eight passes all of them, whatever they are.
        assert!(middle(off(&eight_point(&clicks).unwrap())) < 1.5);
        assert!(middle(off(&scene.fundamental())) > CONTRADICTED);
        assert!(of_clicks_alone(&clicks, &scene.fundamental(), 1.0).is_none());
    }

    #[test]
    fn a_geometry_of_clicks_alone_is_called_that_and_compared_with_what_was_found() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        // All of them are off what the images show, by the same.
        let mut clicks = scene.pairs(60);
        for pair in &mut clicks {
            pair.point2.y += 40.0;
        }
        clicks.retain(|pair| prepared.frames()[1].contains(pair.point2));
        let found =
            estimate_prepared(&prepared, &clicks, &Parameters::default(), &Monitor::silent()).unwrap();
        let off: Vec<f64> = clicks.iter().map(|pair| sampson_distance(found.fundamental(), pair)).collect();
        assert!(middle(off) < 0.1);
        let Assessment { trust, margin, support, refinement, .. } = &found.assessment;
        let reasons = &trust.as_ref().unwrap().reasons;
        assert!(reasons.contains(&Reason::ClicksAlone) && refinement.is_none(), "{reasons:?}");
        let [own, rival] = [&found.hypotheses()[0], &found.hypotheses()[1]].map(|h| h.assessment.support);
        assert_eq!(own, *support, "measured, like that of the others");
        assert!(own.unwrap().score < rival.unwrap().score && margin.is_some_and(|m| m < 0.0 && m > -1.0));
    }

    #[test]
    fn features_need_no_click_to_be_ranked_and_lines_only_where_there_are_two() {
        let scene = ExactScene::aside();
        let (prepared, parameters) = (scene.prepared(), Parameters::default());
        let (source, patches) = (
            prepared.similarity_source(RelativeView::UPRIGHT, &parameters),
            prepared.patches_with_features(RelativeView::UPRIGHT, FeatureViews::Frontal),
        );
        let proposed = [scene.disturbed(2.0), scene.disturbed(-3.0)];
        for pairs in [&[][..], &scene.clicks()] {
            let clicks = Clicks::for_plan(pairs, SearchPlan::Patches { clicks: 2 });
            let cancel = &CancelFlag::default();
            let input = SearchInput {
                prepared: &prepared,
                source: &*source,
                patches: &patches,
                clicks: &clicks,
                parameters: &parameters,
                cancel,
            };
            let found = by_features(&input, &proposed, &[]).unwrap().unwrap();
            let error = scene.error(&found.refined.unwrap().fundamental);
            assert!(error < 0.3, "{error} px with {} clicks", pairs.len());
            let best = &found.hypotheses[0].assessment;
            assert_eq!(best.lines.is_some(), pairs.len() == 2);
            assert!(best.support.is_some_and(|support| support.matches > 50));
        }
    }
}
