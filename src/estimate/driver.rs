//! The estimator: propose → rank → refine → judge (paper, section 5.1).
//!
//! Lines through the clicks are compared, and their candidates propose epipoles. What ranks the proposals is one of two
//! searches; the best ones are refined, and the result is judged.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::assess::{Judge, check_images, check_points};
use super::lines::{ComparedPencils, LineExaminer, draw_pairs, published};
use super::patches::{self, Refined};
use super::record::SearchRecord;
use super::result::REPORTED;
use super::{
    Clicks, Estimate, EstimateError, Monitor, Parameters, PatchSupport, PreparedPair, Search, Stage,
};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::image::GrayPlane;
use crate::similarity::SimilaritySource;

/// Combinations tried for the first picture.
const QUICK: usize = 1500;

/// Estimates the fundamental matrix of two images from two or three clicked point pairs, full-size pixels.
///
/// Further pairs are ignored. The same images, pairs, parameters and seed give the same result on any number of
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
    let clicks = Clicks::for_method(pairs, parameters.method);
    parameters.check()?;
    check_points(prepared.frames(), pairs, parameters.method)?;
    check_images(prepared)?;
    let source = prepared.similarity_source(parameters);
    let input = Input { prepared, source: &*source, clicks: &clicks, parameters, monitor };
    let mut record = SearchRecord::new(begun, monitor);
    let found = match parameters.search {
        Search::Lines => by_lines(&input, &mut record)?,
        Search::Patches => by_patches(&input, &mut record)?,
    };
    let (f, refinement) = match found.refined {
        Some(refined) => (refined.fundamental, Some(refined.refinement)),
        None => (found.fundamental, None),
    };
    let judge = input.judge(&record, &found.hypotheses);
    let assessment = judge.result(&f, &found.supporting, refinement);
    record.finish()?;
    let trace = record.trace(&clicks, found.hypotheses, parameters);
    Ok(Estimate { geometry: f.into(), assessment, trace: Some(Arc::new(trace)) })
}

/// What a search is given.
struct Input<'a> {
    prepared: &'a PreparedPair,
    source: &'a dyn SimilaritySource,
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
    let Input { prepared, source, clicks, parameters, monitor } = *input;
    let pyramids = prepared.pyramids();
    let (coarse, voting) = (prepared.patches().coarse(pyramids), prepared.patches().voting(pyramids));
    let (anchors, pencils) = compared(input, record)?;

    record.enter(Stage::Hypotheses)?;
    let third = clicks.third();
    let candidates = pencils.each_ref().map(|compared| compared.candidates.as_slice());
    let propose = |count: usize| {
        let drawn = draw_pairs(candidates, count, parameters.seed);
        patches::propose(coarse, voting, &drawn, &anchors, third.as_ref(), monitor)
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
    let fine = prepared.fine_support();
    let ranked = patches::rank(coarse, fine, &proposals, &clicks.observed(), parameters, monitor)?;
    let different = patches::different(&fine.support, &ranked, REPORTED);
    monitor.check()?;
    let similarity = source.at(parameters.pencils.coarse_side);
    let validation = &parameters.validation;
    let examiner = LineExaminer { similarity: &similarity, clicks: anchors, parameters: validation, monitor };
    let hypotheses = patches::hypotheses(&examiner, &different, fine);
    monitor.check()?;
    let leader = ranked.first().ok_or(EstimateError::NoGeometry)?;
    let fundamental = *hypotheses.first().ok_or(EstimateError::NoGeometry)?.fundamental();
    let full_size = fine.scales.map(f64::recip);
    let matches = fine.support.matches(&leader.fundamental, patches::BAND);
    let supporting: Vec<PointPair> = matches.iter().map(|m| m.pair.rescaled(full_size)).collect();
    input.report(record, fundamental, &hypotheses, Some(leader.support));

    record.enter(Stage::Refinement)?;
    // Near-copies of the leader, too: refined, one of them may come out better.
    let refined = input.refined(ranked.iter().filter_map(|proposal| proposal.full_size(fine.scales)))?;
    Ok(Found { fundamental, hypotheses, supporting, refined })
}

/// The first two anchors and the pencils through them.
fn compared(
    input: &Input,
    record: &mut SearchRecord,
) -> Result<([PointPair; 2], [Arc<ComparedPencils>; 2]), EstimateError> {
    let Input { prepared, source, clicks, parameters, monitor } = *input;
    record.enter(Stage::Pencils)?;
    let compare = |click: &PointPair| {
        let compare = || ComparedPencils::new(source, click, &parameters.pencils, monitor);
        prepared.pencils(click, parameters, compare)
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
    fn judge<'b>(&'b self, record: &'b SearchRecord, hypotheses: &'b [Estimate]) -> Judge<'b> {
        let Input { prepared, clicks, parameters, .. } = *self;
        Judge { prepared, clicks, parameters, hypotheses, warnings: &record.warnings }
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
        record.preliminary(found, hypotheses, self.clicks, self.parameters);
    }

    /// The best of a few geometries after refinement at full resolution, by what its matches weigh; `None` when
    /// none has enough matches, or when nothing is to be refined.
    fn refined(
        &self,
        starts: impl Iterator<Item = FundamentalMatrix>,
    ) -> Result<Option<Refined>, EstimateError> {
        let Input { prepared, clicks, parameters, monitor, .. } = *self;
        let (observed, refinement) = (clicks.observed(), &parameters.refinement);
        let refine = |f: FundamentalMatrix| {
            let sigma = parameters.click_sigma;
            prepared.patches().refine(prepared.pyramids(), &f, &observed, sigma, monitor)
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
