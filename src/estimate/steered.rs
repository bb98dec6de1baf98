//! The search that patch support steers: line similarity proposes, patch support disposes, local optimisation
//! polishes (see [`super::search`] for the steps).

use std::sync::Arc;

use rayon::prelude::*;

use super::bundle::Angles;
use super::candidates::PencilComparison;
use super::examination::Examiner;
use super::hypotheses::draw_pairs;
use super::level::{Level, resized_pair};
use super::prepared::{FineWitness, Witness};
use super::resampling::{Drawing, resample};
use super::search::{self, Steered};
use super::two_point::{REPORTED, Run};
use super::{Construction, Estimate, EstimateError, Hypothesis, PatchSupport, Stage};
use crate::geometry::PointPair;
use crate::similarity::StereoSimilarity;

/// Combinations tried for the first picture.
const QUICK: usize = 1500;
/// Growth of the best support in a round of resampling below which it is the last one.
const SETTLED: f64 = 1.01;

impl Run<'_> {
    /// Line similarity proposes, patch support disposes (see [`search`]).
    pub(super) fn steered(
        mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        pencils: &[Arc<PencilComparison>; 2],
        witness: &Witness,
    ) -> Result<Estimate, EstimateError> {
        let parameters = self.parameters;
        let draw =
            |count| draw_pairs([&pencils[0].candidates, &pencils[1].candidates], count, parameters.seed);
        let at_witness = |pair: &PointPair| resized_pair(pair, witness.scales);
        let own = self.clicks.map(|c| at_witness(&c));
        let third = self.third.map(|c| at_witness(&c));
        let propose = |count| search::propose(witness, &draw(count), &own, third.as_ref(), self.monitor);
        // A few of them first, so that there is something to draw at once.
        let quick = propose(parameters.hypotheses.min(QUICK))?;
        if let Some(first) = quick.first()
            && let Some(full) = first.fundamental.rescaled(1.0 / witness.scales[0], 1.0 / witness.scales[1])
        {
            let support = PatchSupport {
                matches: witness.support.matches(&first.fundamental, search::BAND).len(),
                score: first.support,
            };
            let hypotheses = self.unvalidated(&quick, witness.scales);
            self.preliminary(&full, &hypotheses, Some(support));
        }
        let proposals = propose(parameters.hypotheses)?;
        self.counts.hypotheses = parameters.hypotheses;
        self.counts.validated = proposals.len();

        self.enter(Stage::Validation)?;
        let fine = self.prepared.fine_witness();
        let ranked = self.ranked(&proposals, &own, third, witness, fine)?;
        let different = search::different(&fine.support, &ranked, REPORTED);
        self.monitor.check()?;
        let hypotheses = self.figures(similarity, level, &different, fine);
        let leader = ranked.first().ok_or(EstimateError::NoGeometry)?;
        let best = hypotheses.first().ok_or(EstimateError::NoGeometry)?.fundamental;
        let supporting: Vec<PointPair> = fine
            .support
            .matches(&leader.fundamental, search::BAND)
            .iter()
            .map(|m| resized_pair(&m.pair, fine.scales.map(f64::recip)))
            .collect();
        let support = PatchSupport { matches: supporting.len(), score: leader.support };
        self.preliminary(&best, &hypotheses, Some(support.clone()));

        self.enter(Stage::Refinement)?;
        // Near-copies of the leader, too: refined, one of them may come out better.
        let [s1, s2] = fine.scales;
        let leading = ranked.iter().filter_map(|r| r.fundamental.rescaled(1.0 / s1, 1.0 / s2));
        let refined = if parameters.refine { self.refined(leading.take(parameters.refined)) } else { None };
        self.monitor.check()?;
        if let Some(refined) = refined {
            return self.finish(refined.fundamental, hypotheses, Some(support), &supporting, Some(refined));
        }
        self.finish(best, hypotheses, Some(support), &supporting, None)
    }

    /// Proposals in full-size pixels before lines are compared: without a score and without G.
    fn unvalidated(&self, proposals: &[Steered], scales: [f64; 2]) -> Vec<Hypothesis> {
        let full_size = |steered: &Steered| {
            Some(Hypothesis {
                fundamental: steered.fundamental.rescaled(1.0 / scales[0], 1.0 / scales[1])?,
                score: f64::NAN,
                support: steered.support,
                round_trip_area: f64::NAN,
                kappa_line2_from_line1: steered.angles.kappa,
                kappa_line1_from_line2: f64::NAN,
                construction: Construction::new(&steered.angles, self.clicks, None)?,
            })
        };
        proposals.iter().take(REPORTED).filter_map(full_size).collect()
    }

    /// The proposals polished at the coarse and the fine witness level, with what resampling their matches
    /// adds; best first, in pixels of the fine level.
    fn ranked(
        &self,
        proposals: &[Steered],
        own: &[PointPair; 2],
        third: Option<PointPair>,
        witness: &Witness,
        fine: &FineWitness,
    ) -> Result<Vec<Steered>, EstimateError> {
        // Clicks more precise than a level can show would pin what its corners cannot.
        let parameters = self.parameters;
        let sigma = |scales: [f64; 2]| (parameters.click_sigma * scales[0]).max(0.5);
        let observed: Vec<PointPair> = own.iter().copied().chain(third).collect();
        let coarse = search::polish(
            &witness.support,
            proposals,
            &search::COARSE,
            &observed,
            sigma(witness.scales),
            self.monitor,
        )?;
        let ratios = [fine.scales[0] / witness.scales[0], fine.scales[1] / witness.scales[1]];
        let at_fine = |c: &Steered| {
            let fundamental = c.fundamental.rescaled(ratios[0], ratios[1])?;
            Some(Steered {
                fundamental,
                support: fine.support.score(&fundamental, search::BAND),
                ..c.clone()
            })
        };
        let mut starts: Vec<Steered> = coarse.par_iter().filter_map(at_fine).collect();
        starts.sort_by(|a, b| b.support.total_cmp(&a.support));
        let observed: Vec<PointPair> =
            self.clicks.iter().chain(self.third.as_ref()).map(|c| resized_pair(c, fine.scales)).collect();
        let polish = |starts: &[Steered]| {
            search::polish(&fine.support, starts, &search::FINE, &observed, sigma(fine.scales), self.monitor)
        };
        let mut ranked = polish(&starts)?;
        // The rest stay in the list as they are, and so does what was proposed: among them are the runners-up.
        ranked.extend(starts.drain(starts.len().min(search::FINE.count)..));
        let proposed: Vec<Steered> = proposals.par_iter().filter_map(at_fine).collect();
        ranked.extend(proposed);
        for round in 0..parameters.resampling as u64 {
            ranked.sort_by(|a, b| b.support.total_cmp(&a.support));
            let before = ranked.first().map_or(0.0, |leader| leader.support);
            let drawing = Drawing {
                clicks: &observed,
                parallax: parameters.parallax,
                // Rounds must not repeat each other, with any seed.
                seed: parameters.seed.wrapping_mul(64).wrapping_add(round),
            };
            let resampled = resample(&fine.support, &ranked, &drawing, self.monitor)?;
            let polished = polish(&resampled)?;
            let after = polished.first().map_or(0.0, |best| best.support);
            ranked.extend(polished);
            if after < SETTLED * before {
                break;
            }
        }
        ranked.sort_by(|a, b| b.support.total_cmp(&a.support));
        Ok(ranked)
    }

    /// Line score, round trip and both κ of hypotheses, full-size pixels; their order stays.
    fn figures(
        &self,
        similarity: &StereoSimilarity,
        level: &Level,
        hypotheses: &[Steered],
        fine: &FineWitness,
    ) -> Vec<Hypothesis> {
        let own = self.clicks.map(|c| resized_pair(&c, fine.scales));
        let examiner = Examiner { similarity, level, parameters: self.parameters, clicks: self.clicks };
        let [s1, s2] = fine.scales;
        hypotheses
            .par_iter()
            .filter_map(|steered| {
                let matches = fine.support.matches(&steered.fundamental, search::BAND);
                let angles = Angles::nearest(
                    &steered.fundamental,
                    &own,
                    &steered.angles,
                    matches.iter().map(|m| m.pair),
                )
                .unwrap_or(steered.angles);
                let fundamental = steered.fundamental.rescaled(1.0 / s1, 1.0 / s2)?;
                examiner.hypothesis(fundamental, &angles, steered.support)
            })
            .collect()
    }
}
