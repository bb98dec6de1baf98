//! Geometries proposed by covariant features and constrained by the clicks.
//!
//! Each match of features (mutual nearest neighbours) gets a probability of being right. Minimal
//! samples are drawn by these probabilities, with clicks in each sample. Every `F` is scored by the
//! likelihood of all matches. The best are refitted to the matches that they explain, matched again
//! along their epipolar lines, and refitted once more.
//!
//! Any number of clicks is allowed. Without clicks, seven matches are drawn. Seven or more clicks
//! determine `F` alone.

mod matched;
mod reliability;
mod rematching;
mod views;

pub(in crate::estimate) use matched::MatchedFeatures;
pub(in crate::estimate) use views::{is_same_view, view_of, view_of_pairs};

use std::f64::consts::TAU;

use nalgebra::Matrix3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::estimate::FeatureParameters;
use crate::estimate::fit::{BAND, Consensus, Match, Units, Witness, residual};
use crate::estimate::sampling::{Draws, Purpose, Weighted, best, refitted};
use crate::features::{Feature, FeatureMatch, FeatureSet, SIGMA_PER_SCALE};
use crate::geometry::{
    Equation, Frame, FundamentalMatrix, Observation, PointPair, eight_point, fit_fundamental, frame_equation,
    point_equation, solve_seven,
};

/// Features of both images, their matches, and the clicks.
#[derive(Debug, Clone, Copy)]
pub struct FeatureEvidence<'a> {
    /// Features of each image.
    pub sets: [&'a FeatureSet; 2],
    /// Mutual nearest neighbours.
    pub matches: &'a [FeatureMatch],
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// Clicked pairs, any number.
    pub clicks: &'a [PointPair],
    /// Standard deviation of a clicked coordinate, px.
    pub click_sigma: f64,
}

/// A geometry that features support.
#[derive(Debug, Clone)]
pub struct FeatureHypothesis {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Log-likelihood ratio of the matches, against matches by chance.
    pub score: f64,
    /// Matches found along the epipolar lines. The last fit used these and the clicks.
    pub matches: Vec<PointPair>,
}

/// Least standard deviation of a feature position, px. It holds for scales up to 1.6 px, whose own
/// share [`SIGMA_PER_SCALE`] is smaller.
const LEAST_SIGMA: f64 = 0.4;
/// Deviation from a pinhole camera, px per px of the longer side: 0.5 px in 1,000. In images of
/// more than 800 px it exceeds [`LEAST_SIGMA`].
const CAMERA_SIGMA: f64 = 0.5e-3;
/// Log-likelihood ratio of a click on its epipolar line, against one by accident. A person saw the
/// point, so it is about the ratio of two likely matches. With twice the number a mistaken click
/// would outweigh four.
const CLICK_GAIN: f64 = 15.0;
/// Share of the samples that use the local frames of features in place of further points.
const FRAMED: f64 = 0.7;
/// Number of samples of one task. The streams of random numbers depend on it.
const TASK: usize = 32;
/// Largest number of clicks in one sample. One of many clicks may be wrong, so no sample needs all.
/// At least three of its seven equations come from matches.
const CLICKS_A_SAMPLE: usize = 4;
/// Bands in which a hypothesis is refitted, in multiples of the final band. Far from its points, a
/// minimal sample is off by several deviations, so the first band is wide.
const BANDS: [f64; 4] = [4.0, 2.0, 1.3, 1.0];
/// Drawn matrices examined for each one that is refitted. Many are copies of one geometry, so fewer
/// matrices may leave places empty. More matter only if places are empty.
const LEADERS: usize = 20;
/// Largest number of rounds of local optimisation. Rounds end earlier when nothing improves. The
/// streams of random numbers depend on it.
const LOCAL_ROUNDS: usize = 4;
/// Number of samples in one round of local optimisation. If 80 % of the drawn matches are right,
/// about 40 samples contain right matches only.
const LOCAL_DRAWS: usize = 200;
/// Number of samples in one round of local optimisation that are refitted, best first. Each takes
/// four fits.
const LOCAL_REFITTED: usize = 3;
/// Largest number of matches in a refit, evenly chosen. It bounds the time. The error falls with
/// its square root.
const FITTED: usize = 300;
/// Largest number of matches in the last fit, evenly chosen. It bounds the time. Five times as many
/// as in a refit halve the error.
const FITTED_LAST: usize = 1500;
/// Distance from its line beyond which a witness loses influence on a fit, in standard deviations
/// and bands. At the edge of the band, twice as far, a fifth of the weight is left.
const ROBUST: f64 = 1.5;
/// Share of commonly explained matches beyond which two drawn matrices are one geometry. A larger
/// share keeps more copies, a smaller one merges neighbours.
const SAME_DRAWN: f64 = 0.8;
/// Share of commonly explained matches beyond which two refitted matrices are one geometry. Refits
/// of one geometry differ less than its samples, so the share is larger than [`SAME_DRAWN`].
const SAME_REFITTED: f64 = 0.9;
/// Largest number of matches drawn for one sample: several times the seven needed, since matches
/// near others are rejected.
const DRAWN_A_SAMPLE: usize = 40;
/// Distance, as a share of the longer side, below which two matches of a sample are redundant. At
/// the far side of the image their errors are a hundred times as large.
const TOO_CLOSE: f64 = 0.01;
/// Band of likely matches in local optimisation, in multiples of the final band. The geometry still
/// moves, so right matches may lie beyond its final band.
const LOCAL_BAND: f64 = 2.0;
/// Number of rounds of guided matching. The second uses the geometry of the first.
const REMATCHED: usize = 2;
/// Probability of being right below which a match is left out of a fit. Its weight would be below a
/// twentieth of the weight of a sure match.
const LEAST_RIGHT: f64 = 0.05;

/// Returns the standard deviation of a coordinate of a feature of this scale, px.
fn sigma(scale: f64, frame: Frame) -> f64 {
    let camera = CAMERA_SIGMA * frame.longer_side();
    (LEAST_SIGMA.powi(2) + (SIGMA_PER_SCALE * scale).powi(2) + camera * camera).sqrt()
}

/// Returns the matches as witnesses, each with its gain.
fn witnesses(evidence: &FeatureEvidence, matches: &[FeatureMatch], log_odds: &[f64]) -> Vec<Witness> {
    let range = evidence.frames.iter().map(Frame::longer_side).fold(0.0, f64::max);
    matches
        .iter()
        .zip(log_odds)
        .map(|(m, log_odds)| {
            let [a, b] = [m.feature1, m.feature2];
            let [a, b] = [&evidence.sets[0].features()[a], &evidence.sets[1].features()[b]];
            let sigmas = [sigma(a.scale, evidence.frames[0]), sigma(b.scale, evidence.frames[1])];
            let density = TAU.sqrt() * sigmas[0].hypot(sigmas[1]) / range;
            Witness { pair: m.pair, sigmas, gain: (log_odds.exp() / density).ln_1p(), clicked: false }
        })
        .collect()
}

/// Returns matches as observations for a fit, with the probability that each is right before any geometry
/// is known.
pub(in crate::estimate) fn putative(
    sets: [&FeatureSet; 2],
    matches: &[FeatureMatch],
    frames: [Frame; 2],
) -> Vec<Match> {
    let log_odds = reliability::log_odds(sets, matches, frames, &[]);
    let putative = |(m, log_odds): (&FeatureMatch, f64)| {
        let scales = [sets[0].features()[m.feature1].scale, sets[1].features()[m.feature2].scale];
        let [a, b] = [sigma(scales[0], frames[0]), sigma(scales[1], frames[1])];
        Match { pair: m.pair, sigma: (0.5 * (a * a + b * b)).sqrt(), prior: 1.0 / (1.0 + (-log_odds).exp()) }
    };
    matches.iter().zip(log_odds).map(putative).collect()
}

/// Returns the probability that a witness is right, given its residual. The geometry is itself
/// uncertain by `band` bands.
fn likely_right(witness: &Witness, residual: f64, band: f64) -> f64 {
    let odds = witness.gain.exp_m1() * (-0.5 * (residual / band).powi(2)).exp() / band;
    odds / (1.0 + odds)
}

/// Fits robustly to the witnesses within `band` bands of the matrix: to all clicks and at most
/// `most` matches. Each match is weighted by its probability of being right. A false match may lie
/// anywhere.
fn fitted(f: &FundamentalMatrix, witnesses: &[Witness], band: f64, most: usize) -> Option<FundamentalMatrix> {
    let near: Vec<(bool, Observation)> = witnesses
        .iter()
        .filter_map(|w| {
            let r = residual(f.matrix(), w);
            let right = likely_right(w, r, band);
            let sigma = (0.5 * (w.sigmas[0].powi(2) + w.sigmas[1].powi(2)) / right).sqrt();
            let counts = r < band * BAND && right > LEAST_RIGHT;
            counts.then_some((w.clicked, Observation { pair: w.pair, sigma }))
        })
        .collect();
    // Chosen evenly: the likeliest matches crowd in the most textured part.
    let share = (most as f64 / near.len() as f64).min(1.0);
    let step = |k: usize| (k as f64 * share) as usize;
    let observations: Vec<Observation> = near
        .iter()
        .enumerate()
        .filter(|(k, (clicked, _))| *clicked || step(*k) != step(k + 1))
        .map(|(_, (_, observation))| *observation)
        .collect();
    fit_fundamental(f, &observations, band.max(1.0) * ROBUST).map(|fit| fit.fundamental)
}

/// A matrix for pixels with its score.
type Scored = (f64, FundamentalMatrix);

struct FeatureSearch<'a> {
    evidence: &'a FeatureEvidence<'a>,
    parameters: &'a FeatureParameters,
    seed: u64,
    units: Units,
    /// Witnesses: first the matches, then the clicks.
    witnesses: Vec<Witness>,
    consensus: Consensus,
    /// Equations of the point and of the frame of each match.
    equations: Vec<[Equation; 2]>,
    click_equations: Vec<Equation>,
    /// Draws a match by the probability that it is right.
    sampler: Weighted,
}

/// Returns the best geometries for this evidence, best first. The result does not depend on the
/// number of threads.
pub fn hypotheses_from_features(
    evidence: &FeatureEvidence,
    parameters: &FeatureParameters,
    seed: u64,
) -> Vec<FeatureHypothesis> {
    let search = FeatureSearch::new(evidence, parameters, seed);
    let drawn = search.drawn();
    let refitted: Vec<Scored> = drawn.par_iter().filter_map(|f| search.refitted(f)).collect();
    let refitted = best(refitted, usize::MAX);
    let distinct = search.distinct(refitted, FundamentalMatrix::matrix, SAME_REFITTED, parameters.rematched);
    let improved: Vec<Scored> =
        distinct.into_par_iter().enumerate().map(|(k, start)| search.locally_optimised(start, k)).collect();
    let improved = best(improved, usize::MAX);
    let distinct = search.distinct(improved, FundamentalMatrix::matrix, SAME_REFITTED, parameters.rematched);
    let mut found: Vec<FeatureHypothesis> =
        distinct.into_par_iter().map(|(score, f)| search.rematched(f, score)).collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found
}

impl<'a> FeatureSearch<'a> {
    fn new(evidence: &'a FeatureEvidence<'a>, parameters: &'a FeatureParameters, seed: u64) -> Self {
        let FeatureEvidence { sets, matches, frames, clicks, click_sigma } = *evidence;
        let log_odds = reliability::log_odds(sets, matches, frames, clicks);
        let units = Units::new(frames);
        let mut witnesses = witnesses(evidence, matches, &log_odds);
        let equations = matches
            .iter()
            .map(|m| {
                let (a, b) = (&sets[0].features()[m.feature1], &sets[1].features()[m.feature2]);
                let pair = units.pair(&m.pair);
                let along = |image: usize, f: &Feature| {
                    let axis = f.axis();
                    [axis.x, axis.y].map(|v| units.length(image, v))
                };
                [point_equation(pair), frame_equation(pair, along(0, a), along(1, b))]
            })
            .collect();
        let sampler = Weighted::new(log_odds.iter().map(|l| 1.0 / (1.0 + (-l).exp())));
        witnesses.extend(clicks.iter().map(|pair| Witness {
            pair: *pair,
            sigmas: [click_sigma; 2],
            gain: CLICK_GAIN,
            clicked: true,
        }));
        let consensus = Consensus::new(units, &witnesses);
        let click_equations = clicks.iter().map(|c| point_equation(units.pair(c))).collect();
        Self { evidence, parameters, seed, units, witnesses, consensus, equations, click_equations, sampler }
    }

    /// Returns the best of many matrices from minimal samples, for pixels.
    fn drawn(&self) -> Vec<Matrix3<f64>> {
        let clicks = self.evidence.clicks;
        let FeatureParameters { draws, refitted, .. } = *self.parameters;
        let draws =
            Draws { seed: self.seed, purpose: Purpose::FeatureSamples, first: 0, count: draws, task: TASK };
        let leaders =
            best(draws.collect(|random| self.scored_sample(&self.sampler, random)), LEADERS * refitted);
        let leaders = leaders.into_iter().map(|(score, f)| (score, self.units.in_pixels(&f))).collect();
        let distinct = self.distinct(leaders, |f| f, SAME_DRAWN, refitted);
        let of_clicks = eight_point(clicks).ok().map(|f| *f.matrix());
        distinct.into_iter().map(|(_, f)| f).chain(of_clicks).collect()
    }

    /// Returns the matrices of one sample with their scores, for conditioned coordinates.
    fn scored_sample(&self, sampler: &Weighted, random: &mut Pcg64Mcg) -> Vec<(f64, Matrix3<f64>)> {
        let Some(equations) = self.sample(sampler, random) else { return Vec::new() };
        solve_seven(&equations).into_iter().map(|f| (self.consensus.score_conditioned(&f), f)).collect()
    }

    /// Returns seven equations, of clicks and of matches drawn by their probability of being right.
    fn sample(&self, sampler: &Weighted, random: &mut Pcg64Mcg) -> Option<[Equation; 7]> {
        let mut rows: Vec<Equation> = Vec::with_capacity(7);
        let clicks = self.click_equations.len();
        let mut order: Vec<usize> = (0..clicks).collect();
        // Some samples use fewer clicks than given, since one of three or more may be wrong.
        let most = clicks.min(CLICKS_A_SAMPLE);
        let taken = if most > 2 { random.random_range(2..=most) } else { most };
        for k in 0..taken {
            let other = random.random_range(k..clicks);
            order.swap(k, other);
            rows.push(self.click_equations[order[k]]);
        }
        let framed = random.random_bool(FRAMED);
        // The first two matches of a framed sample give two equations each, if both fit in.
        let mut drawn: Vec<usize> = Vec::new();
        for _ in 0..DRAWN_A_SAMPLE {
            let at = sampler.draw(random)?;
            if drawn.iter().any(|d| self.too_close(*d, at)) {
                continue;
            }
            drawn.push(at);
            rows.push(self.equations[at][0]);
            if rows.len() < 7 && framed && drawn.len() <= 2 {
                rows.push(self.equations[at][1]);
            }
            if rows.len() == 7 {
                return rows.try_into().ok();
            }
        }
        None
    }

    /// Returns whether two matches are redundant.
    fn too_close(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.witnesses[i].pair, &self.witnesses[j].pair);
        let near = |k: usize| TOO_CLOSE * self.evidence.frames[k].longer_side();
        (a.point1 - b.point1).norm() < near(0) || (a.point2 - b.point2).norm() < near(1)
    }

    /// Fits a matrix to the matches that it explains, in ever narrower bands.
    fn refitted(&self, start: &Matrix3<f64>) -> Option<Scored> {
        let scored = |f: FundamentalMatrix| (self.consensus.score(f.matrix()), f);
        let start = scored(FundamentalMatrix::nearest_rank_two(*start)?);
        let refit = |last: &Scored, k: usize| fitted(&last.1, &self.witnesses, BANDS[k], FITTED).map(scored);
        Some(refitted(start, BANDS.len(), refit))
    }

    /// Improves a matrix by samples of the matches that it explains, each refitted.
    fn locally_optimised(&self, start: Scored, number: usize) -> Scored {
        let matches = &self.witnesses[..self.equations.len()];
        let improved = |last: &Scored, round: usize| {
            let right = |w: &Witness| likely_right(w, residual(last.1.matrix(), w), LOCAL_BAND);
            let sampler = Weighted::new(matches.iter().map(right));
            let draws = Draws {
                seed: self.seed,
                purpose: Purpose::FeatureOptimisation,
                first: (number * LOCAL_ROUNDS + round) as u64,
                count: LOCAL_DRAWS,
                task: LOCAL_DRAWS,
            };
            let drawn = best(draws.collect(|random| self.scored_sample(&sampler, random)), LOCAL_REFITTED);
            drawn
                .iter()
                .filter_map(|(_, f)| self.refitted(&self.units.in_pixels(f)))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|better| better.0 > last.0)
        };
        refitted(start, LOCAL_ROUNDS, improved)
    }

    /// Returns the first `most` matrices that differ. Two matrices are alike when they share more
    /// than a fraction `alike` of all matches that either explains.
    fn distinct<T>(
        &self,
        sorted: Vec<(f64, T)>,
        matrix: impl Fn(&T) -> &Matrix3<f64>,
        alike: f64,
        most: usize,
    ) -> Vec<(f64, T)> {
        let mut kept: Vec<((f64, T), Vec<bool>)> = Vec::new();
        for one in sorted {
            let mine: Vec<bool> = self.witnesses.iter().map(|w| residual(matrix(&one.1), w) < BAND).collect();
            let same = |other: &[bool]| {
                let count = |both: fn(bool, bool) -> bool| {
                    mine.iter().zip(other).filter(|(a, b)| both(**a, **b)).count() as f64
                };
                count(|a, b| a && b) > alike * count(|a, b| a || b)
            };
            if !kept.iter().any(|(_, other)| same(other)) {
                kept.push((one, mine));
                if kept.len() == most {
                    break;
                }
            }
        }
        kept.into_iter().map(|(one, _)| one).collect()
    }

    /// Matches again along the epipolar lines and fits to these matches.
    fn rematched(&self, f: FundamentalMatrix, score: f64) -> FeatureHypothesis {
        let mut best = (f, score);
        let mut matches = Vec::new();
        for _ in 0..REMATCHED {
            let guided = rematching::guided_matches(self.evidence, &best.0);
            let FeatureEvidence { sets, frames, clicks, .. } = *self.evidence;
            let log_odds = reliability::log_odds(sets, &guided, frames, clicks);
            let mut witnesses = witnesses(self.evidence, &guided, &log_odds);
            witnesses.extend(&self.witnesses[self.evidence.matches.len()..]);
            matches = guided.iter().map(|m| m.pair).collect();
            let Some(next) = fitted(&best.0, &witnesses, 1.0, FITTED_LAST) else { break };
            let reached = self.consensus.score(next.matrix());
            best = (next, reached);
        }
        FeatureHypothesis { fundamental: best.0, score: best.1, matches }
    }
}

#[cfg(test)]
mod tests;
