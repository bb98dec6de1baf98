//! The estimator from two (or three) point pairs: the stages in their order.

use std::time::Instant;

use rayon::prelude::*;

use super::bundle::{Angles, Bundle};
use super::candidates::{PencilComparison, compare_pencils};
use super::degeneracy::{check_images, check_points, click_warnings};
use super::hypotheses::{Draft, bisector_kappas, draft, draw_pairs, round_trip_area};
use super::line_refinement::{refine_on_lines, stereo};
use super::prepared::{FineWitness, Level, PreparedPair, Witness};
use super::refinement::Refined;
use super::search::{self, Steered};
use super::trust::{Evidence, Trust};
use super::validation::line_score;
use super::{
    Counts, Estimate, EstimateError, Hypothesis, Method, Monitor, Parameters, PatchSupport, Progress, Stage,
    StageTiming, Warning,
};
use crate::geometry::{
    FundamentalMatrix, PointPair, epipolar_difference, sampson_distance, symmetric_epipolar_distance,
};
use crate::similarity::StereoSimilarity;

/// Hypotheses reported with all their figures.
const REPORTED: usize = 60;
/// Combinations tried for the first picture.
const QUICK: usize = 1500;
/// Hypotheses refined at full resolution.
const REFINED: usize = 3;
/// Longer side of the largest images refined on lines, px: beyond it the lines are smoother than the step.
const FINEST_LINES: f64 = 800.0;
/// Geometries farther apart than this fraction of the longer side are clearly different.
const DIFFERENT: f64 = 0.01;

/// One run of the estimator.
struct Run<'a> {
    prepared: &'a PreparedPair,
    parameters: &'a Parameters,
    monitor: &'a Monitor<'a>,
    clicks: [PointPair; 2],
    third: Option<PointPair>,
    begun: Instant,
    stage_begun: Instant,
    stage: Stage,
    timings: Vec<StageTiming>,
    first_seconds: Option<f64>,
    counts: Counts,
    warnings: Vec<Warning>,
}

pub(super) fn run(
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
    begun: Instant,
) -> Result<Estimate, EstimateError> {
    parameters.check()?;
    check_points(prepared.frames(), pairs, parameters)?;
    check_images(prepared)?;
    let run = Run {
        prepared,
        parameters,
        monitor,
        clicks: [pairs[0], pairs[1]],
        third: (parameters.method == Method::ThreePoint).then(|| pairs[2]),
        begun,
        stage_begun: begun,
        stage: Stage::Pyramid,
        timings: Vec::new(),
        first_seconds: None,
        counts: Counts::default(),
        warnings: Vec::new(),
    };
    run.all()
}

impl Run<'_> {
    fn enter(&mut self, stage: Stage) -> Result<(), EstimateError> {
        let now = Instant::now();
        let seconds = (now - self.stage_begun).as_secs_f64();
        self.timings.push(StageTiming { stage: self.stage, seconds });
        (self.stage, self.stage_begun) = (stage, now);
        self.monitor.report(Progress::Started(stage));
        self.monitor.check()
    }

    fn all(mut self) -> Result<Estimate, EstimateError> {
        let level = self.prepared.level(self.parameters.coarse_side);
        let clicks = [level.resized(&self.clicks[0]), level.resized(&self.clicks[1])];
        let similarity = stereo(&level, self.parameters);
        let witness = self.parameters.patch_support.then(|| self.prepared.witness());
        self.enter(Stage::Pencils)?;
        let pencils = self.pencils(&similarity, &level, &clicks)?;
        self.enter(Stage::Hypotheses)?;
        match witness {
            Some(witness) => self.steered(&similarity, &level, &clicks, &pencils, witness),
            None => self.published(&similarity, &level, &clicks, &pencils),
        }
    }

    fn pencils(
        &mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
    ) -> Result<[PencilComparison; 2], EstimateError> {
        let compare =
            |click| compare_pencils(similarity, click, level.frames(), self.parameters, self.monitor);
        let (p, q) = rayon::join(|| compare(&clicks[0]), || compare(&clicks[1]));
        let pencils = [p?, q?];
        for (k, pencil) in pencils.iter().enumerate() {
            let (lines1, lines2) = (pencil.angles1.len(), pencil.angles2.len() / 2);
            self.counts.lines1.push(lines1);
            self.counts.lines2.push(lines2);
            self.counts.candidates.push(pencil.candidates.len());
            if pencil.candidates.is_empty() {
                return Err(EstimateError::NoCandidates { pair: k + 1 });
            }
            for (textured, lines) in [(lines1, pencil.lines[0]), (lines2, pencil.lines[1])] {
                if 3 * textured < lines {
                    self.warnings.push(Warning::LittleTexture { pair: k + 1, textured, lines });
                    break;
                }
            }
        }
        Ok(pencils)
    }

    /// As published: bisectors, round trip, full validation; then the five numbers are refined on lines.
    fn published(
        mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
        pencils: &[PencilComparison; 2],
    ) -> Result<Estimate, EstimateError> {
        let parameters = self.parameters;
        let drawn = draw_pairs(
            [&pencils[0].candidates, &pencils[1].candidates],
            parameters.hypotheses,
            parameters.seed,
        );
        let third = self.third.map(|pair| level.resized(&pair));
        let frames = level.frames();
        let mut drafts: Vec<Draft> = drawn
            .par_iter()
            .filter_map(|pair| {
                if self.monitor.is_cancelled() {
                    return None;
                }
                draft(similarity, pair, *clicks, frames, third.as_ref())
            })
            .collect();
        self.monitor.check()?;
        self.counts.hypotheses = drafts.len();
        drafts.sort_by(|a, b| a.round_trip.total_cmp(&b.round_trip));
        let kept = ((drafts.len() as f64 * parameters.validated).ceil() as usize).max(10);
        // With a third pair both maps agree by construction: the round trip does not select.
        let kept = if third.is_some() { drafts.len() } else { kept };
        drafts.truncate(kept);
        self.counts.validated = drafts.len();
        self.enter(Stage::Validation)?;
        let mut scored: Vec<(f64, Draft)> = drafts
            .into_par_iter()
            .filter_map(|d| {
                let bundle = Bundle::new(&d.angles, *clicks)?;
                let lines = parameters.validation_lines;
                let score = line_score(similarity, &bundle, frames, lines, parameters.line_score);
                score.is_finite().then_some((score, d))
            })
            .collect();
        self.monitor.check()?;
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        let scale = 1.0 / level.scales[0];
        let hypotheses: Vec<Hypothesis> = scored
            .iter()
            .take(REPORTED)
            .filter_map(|(score, d)| {
                Some(Hypothesis {
                    fundamental: Bundle::new(&d.angles, self.clicks)?.fundamental()?,
                    score: *score,
                    support: 0.0,
                    round_trip_area: d.round_trip * scale,
                    kappa_line2_from_line1: d.angles.kappa,
                    kappa_line1_from_line2: d.kappa_backward,
                })
            })
            .collect();
        let best = hypotheses.first().ok_or(EstimateError::NoGeometry)?;
        let first = best.fundamental;
        self.preliminary(&first, &hypotheses, None);
        self.enter(Stage::Refinement)?;
        let angles = refine_on_lines(
            self.prepared,
            &scored[0].1.angles,
            &self.clicks,
            parameters,
            FINEST_LINES,
            self.monitor,
        )?;
        let fundamental = Bundle::new(&angles, self.clicks).and_then(|b| b.fundamental()).unwrap_or(first);
        self.finish(fundamental, hypotheses, None, &[], None)
    }

    /// Line similarity proposes, patch support disposes (see [`search`]).
    fn steered(
        mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
        pencils: &[PencilComparison; 2],
        witness: &Witness,
    ) -> Result<Estimate, EstimateError> {
        let parameters = self.parameters;
        let draw =
            |count| draw_pairs([&pencils[0].candidates, &pencils[1].candidates], count, parameters.seed);
        let at_witness = |pair: &PointPair| super::prepared::resized_pair(pair, witness.scales);
        let own = self.clicks.map(|c| at_witness(&c));
        let third = self.third.map(|c| at_witness(&c));
        let propose = |count| search::propose(witness, &draw(count), &own, third.as_ref(), self.monitor);
        // A few of them first, so that there is something to draw at once.
        if let Some(first) = propose(parameters.hypotheses.min(QUICK))?.first()
            && let Some(full) = first.fundamental.rescaled(1.0 / witness.scales[0], 1.0 / witness.scales[1])
        {
            let support = PatchSupport {
                matches: witness.support.matches(&first.fundamental, search::BAND).len(),
                score: first.support,
            };
            self.preliminary(&full, &[], Some(support));
        }
        let proposals = propose(parameters.hypotheses)?;
        self.counts.hypotheses = parameters.hypotheses;
        self.counts.validated = proposals.len();

        self.enter(Stage::Validation)?;
        let fine = self.prepared.fine_witness();
        let ranked = self.ranked(&proposals, &own, third, witness, fine)?;
        let hypotheses = self.figures(similarity, level, clicks, &ranked, fine);
        let leader = ranked.first().ok_or(EstimateError::NoGeometry)?;
        let best = hypotheses.first().ok_or(EstimateError::NoGeometry)?.fundamental;
        let supporting: Vec<PointPair> = fine
            .support
            .matches(&leader.fundamental, search::BAND)
            .iter()
            .map(|m| super::prepared::resized_pair(&m.pair, fine.scales.map(f64::recip)))
            .collect();
        let support = PatchSupport { matches: supporting.len(), score: leader.support };
        self.preliminary(&best, &hypotheses, Some(support.clone()));

        self.enter(Stage::Refinement)?;
        let refined = if parameters.refine { self.refined(&hypotheses) } else { None };
        self.monitor.check()?;
        if let Some(refined) = refined {
            return self.finish(refined.fundamental, hypotheses, Some(support), &supporting, Some(refined));
        }
        self.finish(best, hypotheses, Some(support), &supporting, None)
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
        let sigma = |scales: [f64; 2]| (self.parameters.click_sigma * scales[0]).max(0.5);
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
        let mut starts: Vec<Steered> = coarse
            .into_par_iter()
            .filter_map(|c| {
                let fundamental = c.fundamental.rescaled(ratios[0], ratios[1])?;
                let support = fine.support.score(&fundamental, search::BAND);
                Some(Steered { fundamental, support, ..c })
            })
            .collect();
        starts.sort_by(|a, b| b.support.total_cmp(&a.support));
        let observed: Vec<PointPair> = self
            .clicks
            .iter()
            .chain(self.third.as_ref())
            .map(|c| super::prepared::resized_pair(c, fine.scales))
            .collect();
        let polish = |starts: &[Steered]| {
            search::polish(&fine.support, starts, &search::FINE, &observed, sigma(fine.scales), self.monitor)
        };
        let mut ranked = polish(&starts)?;
        // The rest stay in the list as they are: they may be the runners-up.
        ranked.extend(starts.drain(starts.len().min(search::FINE.count)..));
        let seed = self.parameters.seed;
        let resampled = search::resample(&fine.support, &ranked, &observed, seed, self.monitor)?;
        ranked.extend(polish(&resampled)?);
        ranked.sort_by(|a, b| b.support.total_cmp(&a.support));
        Ok(ranked)
    }

    /// The best of the few leading hypotheses after refinement at full resolution, by what its matches weigh.
    fn refined(&self, hypotheses: &[Hypothesis]) -> Option<Refined> {
        let mut observed = self.clicks.to_vec();
        observed.extend(self.third);
        hypotheses
            .iter()
            .take(REFINED)
            .filter_map(|h| self.prepared.refine(&h.fundamental, &observed, self.parameters.click_sigma))
            .max_by(|a, b| a.weight().total_cmp(&b.weight()))
    }

    /// Line score, round trip and both κ of the best polished hypotheses, full-size pixels; their order stays.
    fn figures(
        &self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
        ranked: &[Steered],
        fine: &FineWitness,
    ) -> Vec<Hypothesis> {
        let own = self.clicks.map(|c| super::prepared::resized_pair(&c, fine.scales));
        let frames = level.frames();
        let parameters = self.parameters;
        ranked
            .par_iter()
            .take(REPORTED)
            .filter_map(|steered| {
                let matches = fine.support.matches(&steered.fundamental, search::BAND);
                let angles = Angles::nearest(
                    &steered.fundamental,
                    &own,
                    &steered.angles,
                    matches.iter().map(|m| m.pair),
                )
                .unwrap_or(steered.angles);
                let bundle = Bundle::new(&angles, *clicks)?;
                let score = line_score(
                    similarity,
                    &bundle,
                    frames,
                    parameters.validation_lines,
                    parameters.line_score,
                );
                let (forward, backward) =
                    bisector_kappas(similarity, &bundle, clicks).unwrap_or((angles.kappa, angles.kappa));
                let area = round_trip_area(&bundle, forward / backward, frames[0]);
                let [s1, s2] = fine.scales;
                Some(Hypothesis {
                    fundamental: steered.fundamental.rescaled(1.0 / s1, 1.0 / s2)?,
                    score,
                    support: steered.support,
                    round_trip_area: area / level.scales[0],
                    kappa_line2_from_line1: forward,
                    kappa_line1_from_line2: backward,
                })
            })
            .collect()
    }

    fn preliminary(
        &mut self,
        f: &FundamentalMatrix,
        hypotheses: &[Hypothesis],
        support: Option<PatchSupport>,
    ) {
        let now = self.begun.elapsed().as_secs_f64();
        self.first_seconds.get_or_insert(now);
        let estimate = self.assemble(*f, hypotheses.to_vec(), support, &[], None);
        self.monitor.report(Progress::Preliminary(Box::new(estimate)));
    }

    fn finish(
        mut self,
        fundamental: FundamentalMatrix,
        hypotheses: Vec<Hypothesis>,
        support: Option<PatchSupport>,
        supporting: &[PointPair],
        refined: Option<Refined>,
    ) -> Result<Estimate, EstimateError> {
        let seconds = self.stage_begun.elapsed().as_secs_f64();
        self.timings.push(StageTiming { stage: self.stage, seconds });
        self.monitor.check()?;
        let mut estimate = self.assemble(fundamental, hypotheses, support, supporting, refined);
        estimate.trust = Some(self.trust(&estimate));
        Ok(estimate)
    }

    fn trust(&self, estimate: &Estimate) -> Trust {
        let clicks: Vec<f64> = self
            .clicks
            .iter()
            .chain(self.third.as_ref())
            .map(|pair| sampson_distance(&estimate.fundamental, pair))
            .collect();
        let deviation = estimate.uncertainty.as_ref().and_then(|uncertainty| {
            let mut deviations: Vec<f64> = estimate
                .matches
                .iter()
                .filter_map(|m| uncertainty.line2_deviation(m.pair.point1, m.pair.point2))
                .collect();
            deviations.sort_by(f64::total_cmp);
            deviations.get(deviations.len() / 2).copied()
        });
        Trust::judge(&Evidence {
            patches: self.parameters.patch_support,
            matches: estimate.refined.then_some(estimate.matches.len()),
            clicks: &clicks,
            click_sigma: self.parameters.click_sigma,
            margin: estimate.margin,
            deviation,
            side: self.prepared.frames()[0].longer_side(),
        })
    }

    fn assemble(
        &self,
        fundamental: FundamentalMatrix,
        hypotheses: Vec<Hypothesis>,
        support: Option<PatchSupport>,
        supporting: &[PointPair],
        refined: Option<Refined>,
    ) -> Estimate {
        let frames = self.prepared.frames();
        let margin = self.margin(&fundamental, &hypotheses, supporting);
        let mut warnings = self.warnings.clone();
        warnings.extend(click_warnings(&fundamental, frames, &self.clicks));
        let seconds = self.begun.elapsed().as_secs_f64();
        Estimate {
            fundamental,
            epipole1: fundamental.epipole1(),
            epipole2: fundamental.epipole2(),
            score: hypotheses.first().map_or(f64::NAN, |h| h.score),
            round_trip_area: hypotheses.first().map_or(f64::NAN, |h| h.round_trip_area),
            support,
            margin,
            trust: None,
            method: self.parameters.method,
            preset: self.parameters.preset,
            seed: self.parameters.seed,
            warnings,
            counts: self.counts.clone(),
            timings: self.timings.clone(),
            first_seconds: self.first_seconds.unwrap_or(seconds),
            seconds,
            refined: refined.is_some(),
            hypotheses,
            uncertainty: refined.as_ref().and_then(|r| r.uncertainty.clone()),
            matches: refined.map(|r| r.matches).unwrap_or_default(),
        }
    }

    /// Advantage of the best hypothesis over the best one that is clearly different: where there are supporting
    /// matches, one that half of them contradict (two geometries that agree wherever the scene is do not
    /// compete); else one whose epipolar lines are elsewhere.
    fn margin(
        &self,
        fundamental: &FundamentalMatrix,
        hypotheses: &[Hypothesis],
        matches: &[PointPair],
    ) -> Option<f64> {
        let frames = self.prepared.frames();
        let far = DIFFERENT * frames[0].longer_side();
        let best = hypotheses.first()?;
        let differs = |h: &&Hypothesis| {
            if matches.is_empty() {
                return epipolar_difference(fundamental, &h.fundamental, frames, 10.0 * far) > far;
            }
            let contradicting =
                matches.iter().filter(|m| symmetric_epipolar_distance(&h.fundamental, m) > 0.5 * far).count();
            2 * contradicting > matches.len()
        };
        let other = hypotheses.iter().find(differs)?;
        Some(if self.parameters.patch_support {
            (best.support - other.support) / best.support.max(1e-9)
        } else {
            (other.score - best.score) / other.score.max(1e-9)
        })
    }
}
