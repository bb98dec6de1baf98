//! The estimator from two (or three) point pairs: the stages in their order.

use std::sync::Arc;
use std::time::Instant;

use super::candidates::{PencilComparison, compare_pencils};
use super::degeneracy::{check_images, check_points, click_warnings};
use super::examination::{examine, patch_support};
use super::level::Level;
use super::line_refinement::stereo;
use super::plane::share_on_one_plane;
use super::prepared::PreparedPair;
use super::refinement::Refined;
use super::trust::{Evidence, Trust};
use super::{
    ComparedPencils, Counts, Estimate, EstimateError, Hypothesis, Method, Monitor, Parameters, PatchSupport,
    Progress, Stage, StageTiming, Warning,
};
use crate::geometry::{
    FundamentalMatrix, PointPair, epipolar_difference, sampson_distance, symmetric_epipolar_distance,
};
use crate::similarity::StereoSimilarity;

/// Hypotheses reported with all their figures.
pub(super) const REPORTED: usize = 60;
/// How near a match must be to a homography to be explained by it, px in an image of 800 px.
const PLANE_TOLERANCE: f64 = 1.0;
/// Geometries farther apart than this fraction of the longer side are clearly different.
const DIFFERENT: f64 = 0.01;

/// One run of the estimator.
pub(super) struct Run<'a> {
    pub(super) prepared: &'a PreparedPair,
    pub(super) parameters: &'a Parameters,
    pub(super) monitor: &'a Monitor<'a>,
    pub(super) clicks: [PointPair; 2],
    pub(super) third: Option<PointPair>,
    pub(super) begun: Instant,
    pub(super) stage_begun: Instant,
    pub(super) stage: Stage,
    pub(super) timings: Vec<StageTiming>,
    pub(super) first_seconds: Option<f64>,
    pub(super) counts: Counts,
    pub(super) warnings: Vec<Warning>,
    /// What the pencils looked like, once they are compared.
    pub(super) compared: Option<Arc<[ComparedPencils; 2]>>,
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
        compared: None,
    };
    run.all()
}

impl Run<'_> {
    pub(super) fn enter(&mut self, stage: Stage) -> Result<(), EstimateError> {
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
            Some(witness) => self.steered(&similarity, &level, &pencils, witness),
            None => self.published(&similarity, &level, &clicks, &pencils),
        }
    }

    fn pencils(
        &mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
    ) -> Result<[Arc<PencilComparison>; 2], EstimateError> {
        let compare = |k: usize| {
            self.prepared.pencils(&self.clicks[k], self.parameters, || {
                compare_pencils(similarity, &clicks[k], level.frames(), self.parameters, self.monitor)
            })
        };
        let (p, q) = rayon::join(|| compare(0), || compare(1));
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
        let compared = [0, 1].map(|k| ComparedPencils::new(self.clicks[k], pencils[k].clone()));
        let compared = Arc::new(compared);
        self.monitor.report(Progress::Pencils(Arc::clone(&compared)));
        self.compared = Some(compared);
        Ok(pencils)
    }

    /// The best of a few geometries after refinement at full resolution, by what its matches weigh; `None` when
    /// none has enough matches.
    pub(super) fn refined(&self, starts: impl Iterator<Item = FundamentalMatrix>) -> Option<Refined> {
        let mut observed = self.clicks.to_vec();
        observed.extend(self.third);
        starts
            .take_while(|_| !self.monitor.is_cancelled())
            .filter_map(|f| self.prepared.refine(&f, &observed, self.parameters.click_sigma, self.monitor))
            .max_by(|a, b| a.weight.total_cmp(&b.weight))
    }

    pub(super) fn preliminary(
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

    pub(super) fn finish(
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
        // The figures of the result itself, not of the hypothesis it was refined from.
        let turn = estimate.hypotheses.first().map_or(0.0, |h| h.construction.turn());
        estimate.examined = examine(self.prepared, self.clicks, &estimate.fundamental, turn, self.parameters);
        if let Some(own) = &estimate.examined {
            (estimate.score, estimate.round_trip_area) = (own.score, own.round_trip_area);
        }
        if self.parameters.patch_support {
            estimate.support = patch_support(self.prepared, &estimate.fundamental);
        }
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
        let side = self.prepared.frames()[0].longer_side();
        let matches: Vec<PointPair> = estimate.matches.iter().map(|m| m.pair).collect();
        Trust::judge(&Evidence {
            patches: self.parameters.patch_support,
            matches: estimate.refined.then_some(estimate.matches.len()),
            clicks: &clicks,
            click_sigma: self.parameters.click_sigma,
            margin: estimate.margin,
            deviation,
            on_one_plane: share_on_one_plane(
                &matches,
                PLANE_TOLERANCE * side.max(800.0) / 800.0,
                self.parameters.seed,
            ),
            side,
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
            pencils: self.compared.clone(),
            examined: None,
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
