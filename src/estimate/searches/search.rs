//! The two searches, lines and patches, from clicks to a judged geometry: propose → rank → refine.

use std::sync::Arc;

use rayon::prelude::*;

use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{ComparedPencils, LineExaminer};
use crate::estimate::evidence::patches::{self, PatchLevels, Proposal, Refined, Settling};
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::verdict::assessment::Judge;
use crate::estimate::verdict::result::{Assessment, REPORTED};
use crate::estimate::verdict::selection::{ClickedPairs, Weighed, chosen};
use crate::estimate::verdict::trust::{FAR_TOO_FEW, Reason, Verdict};
use crate::estimate::{Clicks, Estimate, EstimateError, Parameters, PatchSupport, PreparedPair, Stage};
use crate::geometry::{FundamentalMatrix, Observation, PointPair};
use crate::similarity::SimilaritySource;

/// What a search is given.
pub(in crate::estimate) struct SearchInput<'a> {
    pub prepared: &'a PreparedPair,
    /// Lines are compared in it, under the same view as the patches.
    pub source: &'a dyn SimilaritySource,
    pub patches: &'a Arc<PatchLevels>,
    pub clicks: &'a Clicks,
    pub parameters: &'a Parameters,
    pub cancel: &'a CancelFlag,
}

/// What a search found.
pub(in crate::estimate) struct Found {
    /// The best geometry before refinement.
    pub fundamental: FundamentalMatrix,
    /// Best first, as they were before refinement.
    pub hypotheses: Vec<Estimate>,
    /// Matches on which rivals are compared with the result.
    pub supporting: Vec<PointPair>,
    /// The best refinement, if there is one.
    pub refined: Option<Refined>,
    /// Whether it is what the clicks determine by themselves.
    pub clicks_alone: bool,
}

/// What was found under one view, with everything about it.
pub(in crate::estimate) struct Judged {
    /// What it was found with.
    pub clicks: Clicks,
    pub fundamental: FundamentalMatrix,
    pub hypotheses: Vec<Estimate>,
    pub assessment: Assessment,
    /// How much its refined matches weigh, and the standard deviation of that.
    pub weight: f64,
    pub weight_deviation: f64,
    pub patches: Arc<PatchLevels>,
    /// Through the anchors of `clicks`.
    pub pencils: Vec<Arc<ComparedPencils>>,
}

impl Weighed for Judged {
    fn fundamental(&self) -> &FundamentalMatrix {
        &self.fundamental
    }

    fn weight(&self) -> f64 {
        self.weight
    }

    fn weight_deviation(&self) -> f64 {
        self.weight_deviation
    }
}

impl Weighed for Refined {
    fn fundamental(&self) -> &FundamentalMatrix {
        &self.fundamental
    }

    fn weight(&self) -> f64 {
        self.weight
    }

    fn weight_deviation(&self) -> f64 {
        self.weight_deviation
    }
}

impl Judged {
    /// Whether another search might change it: what it rests on is thin, or rivals come near. Doubts about the scene stay
    /// whatever is searched.
    pub fn is_open(&self) -> bool {
        let thin = |reason: &Reason| {
            !matches!(reason, Reason::OnePlane { .. } | Reason::Bent { .. } | Reason::Contradicted { .. })
        };
        self.assessment.refined_margin.is_some()
            || self.assessment.trust.as_ref().is_none_or(|trust| trust.reasons.iter().any(thin))
    }

    /// Whether nothing speaks against it, and no rival had to be refined to tell.
    pub fn is_clear(&self) -> bool {
        let assessment = &self.assessment;
        assessment.refined_margin.is_none()
            && assessment.trust.as_ref().is_some_and(|trust| trust.verdict == Verdict::Reliable)
    }
}

/// The first two anchors and the pencils through them.
pub(in crate::estimate) fn compared(
    input: &SearchInput,
    record: &mut SearchRecord,
) -> Result<([PointPair; 2], [Arc<ComparedPencils>; 2]), EstimateError> {
    let SearchInput { prepared, source, patches, clicks, parameters, cancel } = *input;
    record.enter(Stage::Pencils)?;
    let compare = |click: &PointPair| {
        let compare = || ComparedPencils::new(source, click, &parameters.pencils, cancel);
        prepared.pencils(click, patches.view(), parameters, compare)
    };
    let anchors = clicks.anchors();
    let all: Vec<Arc<ComparedPencils>> =
        anchors.par_iter().map(compare).collect::<Vec<_>>().into_iter().collect::<Result<_, _>>()?;
    record.pencils(clicks, all)?;
    match (anchors.as_slice(), record.present_pencils()) {
        ([p, q, ..], [pencils_p, pencils_q, ..]) => {
            Ok(([*p, *q], [Arc::clone(pencils_p), Arc::clone(pencils_q)]))
        }
        // The points were checked before.
        _ => Err(EstimateError::TooFewPairs { found: anchors.len(), needed: 2 }),
    }
}

impl SearchInput<'_> {
    /// The ranked proposals that differ, with what their lines say where there are two anchors, and the first of all.
    pub fn hypotheses<'p>(
        &self,
        anchors: Option<&[PointPair; 2]>,
        ranked: &'p [Proposal],
    ) -> Result<(Vec<Estimate>, &'p Proposal), EstimateError> {
        let SearchInput { prepared, source, patches: levels, parameters, cancel, .. } = *self;
        let fine = levels.fine(prepared.pyramids());
        let different = patches::different(&fine.support, ranked, REPORTED);
        cancel.check()?;
        let examiner = anchors.map(|anchors| LineExaminer::new(source, *anchors, parameters, cancel));
        let hypotheses = patches::hypotheses(examiner.as_ref(), &different, fine);
        let hypotheses: Vec<Estimate> = hypotheses.into_iter().map(Estimate::from).collect();
        cancel.check()?;
        let leader = ranked.first().filter(|_| !hypotheses.is_empty());
        Ok((hypotheses, leader.ok_or(EstimateError::NoGeometry)?))
    }

    /// The best of the ranked proposals after refinement, with the hypotheses made of them.
    pub fn refine_ranked(
        &self,
        ranked: &[Proposal],
        hypotheses: Vec<Estimate>,
    ) -> Result<Found, EstimateError> {
        let fine = self.patches.fine(self.prepared.pyramids());
        let full_size = fine.scales.map(f64::recip);
        let matches = ranked.first().map(|leader| fine.support.matches(&leader.fundamental, patches::BAND));
        let supporting = matches.iter().flatten().map(|m| m.pair.rescaled(full_size)).collect();
        // Where nothing is refined, the best one that most of the clicks do not refuse.
        let observed = self.clicks.observed();
        let clicked = ClickedPairs { pairs: &observed, sigma: self.parameters.click_sigma };
        let first = hypotheses.iter().find(|h| !clicked.refuse(h.fundamental())).or(hypotheses.first());
        let fundamental = *first.ok_or(EstimateError::NoGeometry)?.fundamental();
        // Near-copies of the leader, too: refined, one of them may come out better.
        let refined = self.refined(ranked.iter().filter_map(|proposal| proposal.full_size(fine.scales)))?;
        Ok(Found { fundamental, hypotheses, supporting, refined, clicks_alone: false })
    }

    /// Everything about what was found.
    pub fn judged(&self, record: &SearchRecord, found: Found) -> Judged {
        let Found { fundamental, hypotheses, supporting, refined, clicks_alone } = found;
        let (weight, weight_deviation) =
            refined.as_ref().map_or((0.0, 0.0), |refined| (refined.weight, refined.weight_deviation));
        let fundamental = refined.as_ref().map_or(fundamental, |refined| refined.fundamental);
        let judge = Judge { clicks_alone, ..self.judge(record, &hypotheses) };
        let assessment = judge.result(&fundamental, &supporting, refined);
        Judged {
            clicks: self.clicks.clone(),
            fundamental,
            hypotheses,
            assessment,
            weight,
            weight_deviation,
            patches: Arc::clone(self.patches),
            pencils: record.present_pencils().to_vec(),
        }
    }

    fn judge<'b>(&'b self, record: &'b SearchRecord, hypotheses: &'b [Estimate]) -> Judge<'b> {
        let SearchInput { prepared, source, patches, clicks, parameters, cancel } = *self;
        Judge {
            prepared,
            source,
            patches,
            clicks,
            parameters,
            hypotheses,
            pencils: record.present_pencils(),
            clicks_alone: false,
            cancel,
        }
    }

    /// Reports a geometry that is good enough to draw.
    pub fn report(
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

    /// The best of a few geometries after refinement at full resolution; `None` when none has enough matches, or when
    /// nothing is to be refined.
    pub fn refined(
        &self,
        starts: impl Iterator<Item = FundamentalMatrix>,
    ) -> Result<Option<Refined>, EstimateError> {
        let SearchInput { prepared, patches, clicks, parameters, cancel, .. } = *self;
        let (observed, refinement) = (clicks.observed(), &parameters.refinement);
        let clicked = ClickedPairs { pairs: &observed, sigma: parameters.click_sigma };
        let refine = |f: &FundamentalMatrix| {
            if cancel.is_cancelled() {
                return None;
            }
            patches.refine(prepared.pyramids(), f, &observed, parameters.click_sigma, cancel)
        };
        // A handful of matches does not overrule the clicks.
        let is_of_this_scene = |refined: &Refined| {
            refined.refinement.matches.len() >= FAR_TOO_FEW || !clicked.refuse(&refined.fundamental)
        };
        let count = if refinement.refine { refinement.refined } else { 0 };
        let starts: Vec<FundamentalMatrix> = if count == 0 { Vec::new() } else { starts.collect() };
        let (leaders, rest) = starts.split_at(count.min(starts.len()));
        let Some((first, others)) = leaders.split_first() else { return Ok(None) };
        // What the first compares and aligns most others need too: at the same time it would be done twice.
        let first = refine(first);
        cancel.check()?;
        // Where the first failed early, corners of the later sizes may be missing. A thread that makes them inside the others'
        // loop may take up one of these while it waits, which would wait for the same corners, for ever.
        patches.prepare_refinement(prepared.pyramids());
        let others: Vec<Option<Refined>> = others.par_iter().map(refine).collect();
        cancel.check()?;
        let mut all: Vec<Refined> =
            std::iter::once(first).chain(others).flatten().filter(is_of_this_scene).collect();
        let best = chosen(&all, &clicked).map(|k| all[k].fundamental);
        // Where clicks speak against what came out, what they prefer gets its chance, however little supports it.
        if !observed.is_empty() && best.is_none_or(|best| clicked.speak_against(&best)) {
            let mut preferred = clicked.preferred(rest, best.as_ref());
            preferred.truncate(count);
            let more: Vec<Option<Refined>> = preferred.par_iter().map(refine).collect();
            cancel.check()?;
            all.extend(more.into_iter().flatten().filter(is_of_this_scene));
        }
        let Some(best) = chosen(&all, &clicked).map(|k| all.swap_remove(k)) else { return Ok(None) };
        let settling = Settling {
            clicks: &observed
                .iter()
                .map(|pair| Observation { pair: *pair, sigma: parameters.click_sigma })
                .collect::<Vec<_>>(),
            allows: &|f| !clicked.prefer(&best.fundamental, f),
            seed: parameters.seed,
        };
        let settled = patches.settle(prepared.pyramids(), &best.fundamental, &settling, cancel);
        cancel.check()?;
        Ok(Some(settled.unwrap_or(best)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{CancelFlag, PreparedPair, SearchPlan};
    use crate::features::FeatureViews;
    use crate::geometry::PointPair;
    use crate::image::RelativeView;

    /// The best of these starts after refinement, with these clicks, on so many threads.
    fn refined(
        prepared: &PreparedPair,
        starts: &[FundamentalMatrix],
        pairs: &[PointPair],
        threads: usize,
    ) -> Option<FundamentalMatrix> {
        let parameters = Parameters::default();
        let source = prepared.similarity_source(RelativeView::UPRIGHT, &parameters);
        let patches = prepared.patches_with_features(RelativeView::UPRIGHT, FeatureViews::Frontal);
        let clicks = Clicks::for_plan(pairs, SearchPlan::Patches { clicks: 2 });
        let input = SearchInput {
            prepared,
            source: &*source,
            patches: &patches,
            clicks: &clicks,
            parameters: &parameters,
            cancel: &CancelFlag::default(),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| input.refined(starts.iter().copied())).unwrap();
        found.map(|refined| refined.fundamental)
    }

    #[test]
    fn a_first_start_that_leads_nowhere_keeps_no_thread_and_no_other_start_waiting() {
        let scene = ExactScene::aside();
        let mut starts = vec![scene.disturbed(150.0)];
        starts.extend((1..8).map(|k| scene.disturbed(0.4 * f64::from(k))));
        // Fresh each time, so that whoever comes first finds the corners.
        let found = [1, 2, 4].map(|threads| refined(&scene.prepared(), &starts, &scene.clicks(), threads));
        assert!(scene.error(&found[0].unwrap()) < 0.2);
        assert!(found.iter().all(|f| *f == found[0]), "the same on any number of threads");
    }

    #[test]
    fn what_several_clicks_prefer_is_refined_though_it_ranks_far_behind() {
        let scene = ExactScene::aside();
        let mut starts: Vec<FundamentalMatrix> =
            (0..20).map(|k| scene.disturbed(60.0 + f64::from(k))).collect();
        starts.push(scene.disturbed(2.0));
        let prepared = scene.prepared();
        let error = |clicks: &[PointPair]| refined(&prepared, &starts, clicks, 2).map(|f| scene.error(&f));
        assert!(error(&scene.pairs(5)).unwrap() < 0.3);
        assert!(error(&[]).is_none_or(|error| error > 10.0), "nothing tells it from the others");
    }
}
