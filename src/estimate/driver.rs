//! The estimator: propose → rank → refine → judge (paper, section 5.1).
//!
//! Lines through the clicks are compared, and their candidates propose epipoles. What ranks the proposals is one of two
//! searches; the best ones are refined, and the result is judged.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::assess::{Judge, Verdict, check_images, check_points};
use super::covariant::{FeatureEvidence, FeatureSearchParameters, hypotheses_from_features};
use super::lines::{ComparedPencils, LineExaminer, draw_pairs, published};
use super::patches::{self, PatchLevels, Proposal, Refined};
use super::record::SearchRecord;
use super::result::{Assessment, REPORTED};
use super::views::{is_same, view_of};
use super::{
    Clicks, Estimate, EstimateError, Monitor, Parameters, PatchSupport, PreparedPair, Search, Stage,
};
use crate::geometry::{
    FundamentalMatrix, Observation, PointPair, eight_point, fit_fundamental, sampson_distance,
};
use crate::image::{GrayPlane, RelativeView};
use crate::similarity::SimilaritySource;

/// Combinations tried for the first picture.
const QUICK: usize = 1500;

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
    let input = Input { prepared, source: &*source, patches: &patches, clicks: &clicks, parameters, monitor };
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
    if upright.as_ref().is_ok_and(Judged::is_reliable) {
        return upright;
    }
    let Input { prepared, clicks, parameters, monitor, .. } = *input;
    monitor.check()?;
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
    monitor.check()?;
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

/// What was found under one view, with everything about it.
struct Judged {
    fundamental: FundamentalMatrix,
    hypotheses: Vec<Estimate>,
    assessment: Assessment,
    /// How much its refined matches weigh.
    weight: f64,
    patches: Arc<PatchLevels>,
}

impl Judged {
    fn is_reliable(&self) -> bool {
        self.assessment.trust.as_ref().is_some_and(|trust| trust.verdict == Verdict::Reliable)
    }
}

/// What covariant features propose, ranked by patches and features under a view, and refined; `None` when none of it
/// passes through the clicks.
fn by_features(
    input: &Input,
    proposed: &[FundamentalMatrix],
    rivals: &[Estimate],
) -> Result<Option<Found>, EstimateError> {
    let Input { prepared, patches: levels, clicks, parameters, monitor, .. } = *input;
    let anchors = clicks.anchors();
    let Some(anchors) = anchors.first_chunk::<2>() else { return Ok(None) };
    let fine = levels.fine(prepared.pyramids());
    let turn = levels.view().rotation;
    let starts: Vec<Proposal> =
        proposed.iter().filter_map(|f| Proposal::of(f, *anchors, turn, fine)).collect();
    // What was found upright competes under the same support.
    let rivals = rivals.iter().filter_map(|h| Proposal::of(h.fundamental(), *anchors, h.turn(), fine));
    let ranked = patches::rank_fine(fine, starts, rivals.collect(), &clicks.observed(), parameters, monitor)?;
    if ranked.is_empty() {
        return Ok(None);
    }
    let (hypotheses, _) = input.hypotheses(*anchors, &ranked)?;
    input.refine_ranked(&ranked, hypotheses).map(Some)
}

/// What a search is given.
struct Input<'a> {
    prepared: &'a PreparedPair,
    /// Lines are compared in it, under the same view as the patches.
    source: &'a dyn SimilaritySource,
    patches: &'a Arc<PatchLevels>,
    clicks: &'a Clicks,
    parameters: &'a Parameters,
    monitor: &'a Monitor<'a>,
}

/// What a search found.
struct Found {
    /// The best geometry before refinement.
    fundamental: FundamentalMatrix,
    /// Best first, as they were before refinement.
    hypotheses: Vec<Estimate>,
    /// Matches on which rivals are compared with the result.
    supporting: Vec<PointPair>,
    /// The best refinement, if there is one.
    refined: Option<Refined>,
}

/// The search as published: bisectors and round trips propose, lines over both images rank, and the five numbers of the
/// best one are refined on lines.
fn by_lines(input: &Input, record: &mut SearchRecord) -> Result<Found, EstimateError> {
    let Input { source, clicks, parameters, monitor, .. } = *input;
    let similarity = source.at(parameters.pencils.coarse_side);
    let (anchors, pencils) = compared(input, record)?;

    record.enter(Stage::Hypotheses)?;
    let third = clicks.third();
    let pencils = pencils.each_ref().map(AsRef::as_ref);
    let mut drafts = published::propose(&similarity, pencils, third.as_ref(), parameters, monitor)?;
    record.counts.hypotheses = drafts.len();
    drafts.truncate(published::validated(&drafts, third.is_some(), parameters));
    record.counts.validated = drafts.len();

    record.enter(Stage::Validation)?;
    let ranked = published::rank(&similarity, drafts, anchors, parameters, monitor)?;
    let best = *ranked.hypotheses[0].fundamental();
    input.report(record, best, &ranked.hypotheses, None);

    record.enter(Stage::Refinement)?;
    let fundamental = published::refine(source, &ranked, anchors, parameters, monitor)?;
    let starts = std::iter::once(fundamental).chain(ranked.hypotheses.iter().map(|h| *h.fundamental()));
    let refined = input.refined(starts)?;
    let matches = refined.iter().flat_map(|refined| &refined.refinement.matches);
    let supporting = matches.map(|m| m.pair).collect();
    Ok(Found { fundamental, hypotheses: ranked.hypotheses, supporting, refined })
}

/// The search with patches: they vote for the κ of combinations of candidate lines, their support ranks, and matches
/// along the epipolar lines refine.
fn by_patches(input: &Input, record: &mut SearchRecord) -> Result<Found, EstimateError> {
    let Input { prepared, patches: levels, clicks, parameters, monitor, .. } = *input;
    let pyramids = prepared.pyramids();
    let (coarse, voting) = (levels.coarse(pyramids), levels.voting(pyramids));
    let (anchors, pencils) = compared(input, record)?;

    record.enter(Stage::Hypotheses)?;
    let candidates = pencils.each_ref().map(|compared| compared.candidates.as_slice());
    let propose = |count: usize| {
        let drawn = draw_pairs(candidates, count, parameters.seed);
        patches::propose(coarse, voting, &drawn, &anchors, monitor)
    };
    // A few of them first, so that there is something to draw at once.
    let quick = propose(parameters.hypotheses.min(QUICK))?;
    if let Some(first) = quick.first()
        && let Some(fundamental) = first.full_size(coarse.scales)
    {
        let hypotheses = patches::unvalidated(&quick, coarse.scales, anchors);
        input.report(record, fundamental, &hypotheses, Some(first.support));
    }
    let proposals = propose(parameters.hypotheses)?;
    record.counts.hypotheses = parameters.hypotheses;
    record.counts.validated = proposals.len();

    record.enter(Stage::Validation)?;
    let fine = levels.fine(pyramids);
    let ranked = patches::rank(coarse, fine, &proposals, &clicks.observed(), parameters, monitor)?;
    let (hypotheses, leader) = input.hypotheses(anchors, &ranked)?;
    input.report(record, *hypotheses[0].fundamental(), &hypotheses, Some(leader.support));

    record.enter(Stage::Refinement)?;
    input.refine_ranked(&ranked, hypotheses)
}

/// The first two anchors and the pencils through them.
fn compared(
    input: &Input,
    record: &mut SearchRecord,
) -> Result<([PointPair; 2], [Arc<ComparedPencils>; 2]), EstimateError> {
    let Input { prepared, source, patches, clicks, parameters, monitor } = *input;
    record.enter(Stage::Pencils)?;
    let compare = |click: &PointPair| {
        let compare = || ComparedPencils::new(source, click, &parameters.pencils, monitor);
        prepared.pencils(click, patches.view(), parameters, compare)
    };
    let anchors = clicks.anchors();
    let all: Vec<Arc<ComparedPencils>> =
        anchors.par_iter().map(compare).collect::<Vec<_>>().into_iter().collect::<Result<_, _>>()?;
    record.pencils(&all)?;
    match (anchors.as_slice(), all.as_slice()) {
        ([p, q, ..], [pencils_p, pencils_q, ..]) => {
            Ok(([*p, *q], [Arc::clone(pencils_p), Arc::clone(pencils_q)]))
        }
        // The points were checked before.
        _ => Err(EstimateError::TooFewPairs { found: anchors.len(), needed: 2 }),
    }
}

impl Input<'_> {
    /// The ranked proposals that differ, with what their lines say, and the first of all.
    fn hypotheses<'p>(
        &self,
        anchors: [PointPair; 2],
        ranked: &'p [Proposal],
    ) -> Result<(Vec<Estimate>, &'p Proposal), EstimateError> {
        let Input { prepared, source, patches: levels, parameters, monitor, .. } = *self;
        let fine = levels.fine(prepared.pyramids());
        let different = patches::different(&fine.support, ranked, REPORTED);
        monitor.check()?;
        let similarity = source.at(parameters.pencils.coarse_side);
        let validation = &parameters.validation;
        let examiner =
            LineExaminer { similarity: &similarity, clicks: anchors, parameters: validation, monitor };
        let hypotheses = patches::hypotheses(&examiner, &different, fine);
        monitor.check()?;
        let leader = ranked.first().filter(|_| !hypotheses.is_empty());
        Ok((hypotheses, leader.ok_or(EstimateError::NoGeometry)?))
    }

    /// The best of the ranked proposals after refinement, with the hypotheses made of them.
    fn refine_ranked(&self, ranked: &[Proposal], hypotheses: Vec<Estimate>) -> Result<Found, EstimateError> {
        let fine = self.patches.fine(self.prepared.pyramids());
        let full_size = fine.scales.map(f64::recip);
        let matches = ranked.first().map(|leader| fine.support.matches(&leader.fundamental, patches::BAND));
        let supporting = matches.iter().flatten().map(|m| m.pair.rescaled(full_size)).collect();
        let fundamental = *hypotheses.first().ok_or(EstimateError::NoGeometry)?.fundamental();
        // Near-copies of the leader, too: refined, one of them may come out better.
        let refined = self.refined(ranked.iter().filter_map(|proposal| proposal.full_size(fine.scales)))?;
        Ok(Found { fundamental, hypotheses, supporting, refined })
    }

    /// Everything about what was found.
    fn judged(&self, record: &SearchRecord, found: Found) -> Judged {
        let Found { fundamental, hypotheses, supporting, refined } = found;
        let weight = refined.as_ref().map_or(0.0, |refined| refined.weight);
        let (fundamental, refinement) = match refined {
            Some(refined) => (refined.fundamental, Some(refined.refinement)),
            None => (fundamental, None),
        };
        let assessment = self.judge(record, &hypotheses).result(&fundamental, &supporting, refinement);
        Judged { fundamental, hypotheses, assessment, weight, patches: Arc::clone(self.patches) }
    }

    fn judge<'b>(&'b self, record: &'b SearchRecord, hypotheses: &'b [Estimate]) -> Judge<'b> {
        let Input { prepared, source, patches, clicks, parameters, .. } = *self;
        Judge { prepared, source, patches, clicks, parameters, hypotheses, warnings: &record.warnings }
    }

    /// Reports a geometry that is good enough to draw.
    fn report(
        &self,
        record: &mut SearchRecord,
        f: FundamentalMatrix,
        hypotheses: &[Estimate],
        support: Option<PatchSupport>,
    ) {
        let assessment = self.judge(record, hypotheses).preliminary(&f, support);
        let found = Estimate { geometry: f.into(), assessment, trace: None };
        record.preliminary(found, self.patches, hypotheses, self.clicks, self.parameters);
    }

    /// The best of a few geometries after refinement at full resolution, by what its matches weigh; `None` when
    /// none has enough matches, or when nothing is to be refined.
    fn refined(
        &self,
        starts: impl Iterator<Item = FundamentalMatrix>,
    ) -> Result<Option<Refined>, EstimateError> {
        let Input { prepared, patches, clicks, parameters, monitor, .. } = *self;
        let (observed, refinement) = (clicks.observed(), &parameters.refinement);
        let refine = |f: FundamentalMatrix| {
            let sigma = parameters.click_sigma;
            patches.refine(prepared.pyramids(), &f, &observed, sigma, monitor)
        };
        let best = starts
            .take(if refinement.refine { refinement.refined } else { 0 })
            .take_while(|_| !monitor.is_cancelled())
            .filter_map(refine)
            .max_by(|a, b| a.weight.total_cmp(&b.weight));
        monitor.check()?;
        Ok(best)
    }
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
