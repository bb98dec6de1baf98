//! The search as published (paper, section 5.1): bisectors, round trip, full validation; then the five numbers
//! are refined on lines.

use std::sync::Arc;

use rayon::prelude::*;

use super::bundle::Bundle;
use super::candidates::PencilComparison;
use super::hypotheses::{Draft, draft, draw_pairs};
use super::level::Level;
use super::line_refinement::refine_on_lines;
use super::two_point::{REPORTED, Run};
use super::validation::line_score;
use super::{Construction, Estimate, EstimateError, Hypothesis, Stage};
use crate::geometry::PointPair;
use crate::similarity::StereoSimilarity;

/// Longer side of the largest images refined on lines, px: beyond it the lines are smoother than the step.
const FINEST_LINES: f64 = 800.0;

impl Run<'_> {
    /// From the compared pencils to the result.
    pub(super) fn published(
        mut self,
        similarity: &StereoSimilarity,
        level: &Level,
        clicks: &[PointPair; 2],
        pencils: &[Arc<PencilComparison>; 2],
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
                let construction = Construction::new(&d.angles, self.clicks, Some(d.kappa_backward))?;
                Some(Hypothesis {
                    fundamental: construction.fundamental()?,
                    score: *score,
                    support: 0.0,
                    round_trip_area: d.round_trip * scale,
                    kappa_line2_from_line1: d.angles.kappa,
                    kappa_line1_from_line2: d.kappa_backward,
                    construction,
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
        if !parameters.refine {
            return self.finish(fundamental, hypotheses, None, &[], None);
        }
        let starts = std::iter::once(fundamental)
            .chain(hypotheses.iter().map(|h| h.fundamental))
            .take(parameters.refined);
        let refined = self.refined(starts);
        self.monitor.check()?;
        let result = refined.as_ref().map_or(fundamental, |r| r.fundamental);
        let matches: Vec<PointPair> = refined.iter().flat_map(|r| r.matches.iter().map(|m| m.pair)).collect();
        self.finish(result, hypotheses, None, &matches, refined)
    }
}
