//! Consensus among matches at the scale of their own noise: sample, score, optimise, compare.
//!
//! Minimal samples propose geometries: of seven matches, or of five if the cameras are known. At each of several
//! scales, the samples with the best truncated score are optimised locally (LO-RANSAC: Chum, Matas & Kittler
//! 2003). Each scale has its own candidate, because a few precise matches may be right against many loose ones.

use std::f64::consts::SQRT_2;

use nalgebra::Matrix3;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::model::{Model, Samples};
use super::neighbours::confirmed;
use super::noise::{LEAST_SCALE, Noise, residuals};
use super::scoring::{BAND, Consensus, Units, Witness};
use super::{Match, climbed};
use crate::cancel::CancelFlag;
use crate::estimate::sampling::{Draws, Purpose, best};
use crate::geometry::{
    Frame, FundamentalMatrix, GroupedObservation, Matrix9, Observation, PointPair, REGIONS, deviation,
    grouped_covariance, region, sampson_distance,
};

/// Number of minimal samples of a round. Some 80 % of the less ambiguous matches are right, so one sample of five
/// has seven right ones. Twice as many samples change no figure beyond chance.
const SAMPLES: usize = 1000;
/// Largest probability that no sample was all right.
const MISSED: f64 = 1e-4;
/// Number of samples of one task. The streams of random numbers depend on it.
const TASK: usize = 50;
/// Number of samples that are optimised at each scale. Each takes four fits.
const OPTIMISED: usize = 4;
/// Bands of local optimisation, in units of the scale. The first are wide, because a sample is off by
/// more than the noise far from its matches.
const LOCAL_BANDS: [f64; 4] = [6.0, 4.0, BAND, BAND];
/// Gain in log-likelihood below which the rounds end: the likelihood grows by less than a tenth.
const LEAST_GAIN: f64 = 0.1;
/// Fewest matches from which samples are drawn: otherwise from the likelier half.
const LEAST_DRAWN_FROM: usize = 40;
/// Two geometries are the same if at most one match in this many moves against its lines by more
/// than the noise. About as many matches are wrong.
const SAME_SHARE: usize = 10;
/// Scales of the search for rivals of a geometry, in units of its noise.
const RIVAL_SCALES: [f64; 3] = [0.5, 1.0, 2.0];

/// Matches to be explained, with the clicks and the images.
pub(in crate::estimate) struct Evidence<'a> {
    pub matches: &'a [Match],
    /// Matches from another program. Their noise is estimated apart from the noise of `matches`.
    /// They weigh in every fit, but propose no geometry.
    pub given: &'a [Match],
    /// Clicked pairs with their standard deviation, px.
    pub clicks: &'a [Observation],
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// Kind of geometry.
    pub model: Model,
    /// Width of the band around epipolar lines in which outliers lie, px.
    pub spread: f64,
    /// Smallest scale of the noise of `matches`, px.
    pub least_scale: f64,
}

/// A geometry fitted to matches, with their noise.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Fitted {
    pub fundamental: FundamentalMatrix,
    pub noise: Noise,
    /// Noise of the matches from another program.
    given_noise: Noise,
    /// Log-likelihood of all matches and clicks, less the value if all were outliers.
    pub log_likelihood: f64,
}

impl Fitted {
    /// Scales of the search for rivals of this geometry, px.
    pub fn rival_scales(&self) -> [f64; 3] {
        RIVAL_SCALES.map(|factor| (factor * self.noise.scale).max(LEAST_SCALE))
    }
}

/// Geometry on which most matches agree at one scale.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Agreed {
    pub fundamental: FundamentalMatrix,
    /// Scale of the noise, px.
    pub scale: f64,
    /// Truncated score at that scale.
    pub score: f64,
}

impl Evidence<'_> {
    /// Fits a geometry and the noise to the matches in turns, from a start. `None` if the matches do not
    /// determine it.
    pub fn fitted(&self, start: &FundamentalMatrix) -> Option<Fitted> {
        let refitted =
            |last: &Fitted| {
                Some(self.explained(
                    &self.model.fitted(&last.fundamental, &self.observations(last), 1.0)?.fundamental,
                ))
            };
        let mut first = self.explained(start);
        if self.model.is_posed() {
            // A start that is no essential matrix may be likelier than any.
            first = refitted(&first)?;
        }
        climbed(first, LEAST_GAIN, |fitted| fitted.log_likelihood, refitted)
    }

    /// Returns a geometry as it is, with the noise of the matches.
    pub fn explained(&self, f: &FundamentalMatrix) -> Fitted {
        let of = |matches, least| {
            let residuals = residuals(f, matches);
            let noise = Noise::at_least(least, &residuals, self.spread);
            (noise, noise.log_likelihood(&residuals))
        };
        let (noise, of_matches) = of(self.matches, self.least_scale);
        let (given_noise, of_given) = of(self.given, LEAST_SCALE);
        let cost = |c: &Observation| (0.5 * (sampson_distance(f, &c.pair) / c.sigma).powi(2)).ln_1p();
        let of_clicks: f64 = self.clicks.iter().map(cost).sum();
        Fitted { fundamental: *f, noise, given_noise, log_likelihood: of_matches + of_given - of_clicks }
    }

    /// Returns matches and clicks with their scales, for a Cauchy loss of scale 1. Near its centre, the
    /// Cauchy distribution of a click equals a Gaussian one of its σ.
    fn observations(&self, fitted: &Fitted) -> Vec<Observation> {
        let of = |matches: &[Match], noise: Noise| -> Vec<Observation> {
            matches.iter().map(|m| Observation { pair: m.pair, sigma: m.sigma * noise.scale }).collect()
        };
        let mut all = of(self.matches, fitted.noise);
        all.extend(of(self.given, fitted.given_noise));
        all.extend(self.clicks.iter().map(|c| Observation { sigma: SQRT_2 * c.sigma, ..*c }));
        all
    }

    /// Returns the covariance of the nine entries of a fitted geometry, row by row. Matches of one
    /// region of image 1 share their error ([`region`]); clicks are independent. Matches that their
    /// neighbours do not confirm are left out: accidental matches far off a plane would determine
    /// the epipole. `None` if the matches do not determine all degrees of freedom.
    pub fn covariance(&self, fitted: &Fitted) -> Option<Matrix9> {
        let observations = self.observations(fitted);
        let (matches, clicks) = observations.split_at(self.matches.len() + self.given.len());
        let of_match = |o: &Observation| GroupedObservation {
            observation: *o,
            deviation: deviation(o.sigma, self.frames[0]),
            group: region(o.pair.point1, self.frames[0]),
        };
        let of_click = |(k, o): (usize, &Observation)| GroupedObservation {
            observation: *o,
            deviation: o.sigma / SQRT_2,
            group: REGIONS + k,
        };
        let pairs: Vec<PointPair> = matches.iter().map(|o| o.pair).collect();
        let are_confirmed = confirmed(&pairs, self.frames[1], fitted.noise.inliers);
        let matches = matches.iter().zip(are_confirmed).filter(|(_, is_confirmed)| *is_confirmed);
        let grouped: Vec<GroupedObservation> =
            matches.map(|(o, _)| of_match(o)).chain(clicks.iter().enumerate().map(of_click)).collect();
        grouped_covariance(&fitted.fundamental, &grouped, self.model.calibrations())
    }

    /// Finds geometries on which many matches agree, at most one for each scale (px), from minimal samples
    /// and from starts. Each round of one seed draws other samples.
    pub fn consensus(
        &self,
        starts: &[FundamentalMatrix],
        scales: &[f64],
        seed: u64,
        round: u64,
        cancel: &CancelFlag,
    ) -> Vec<Agreed> {
        if self.matches.len() < 2 * 7 || cancel.is_cancelled() {
            return Vec::new();
        }
        let units = Units::new(self.frames);
        let scorers: Vec<(f64, Consensus)> =
            scales.iter().map(|scale| (*scale, self.scorer(units, *scale))).collect();
        let samples = self.sampled(units, &scorers, seed, round);
        let best_at = |((scale, scorer), samples): (&(f64, Consensus), &Vec<FundamentalMatrix>)| {
            let all: Vec<&FundamentalMatrix> = samples.iter().chain(starts).collect();
            let optimised: Vec<FundamentalMatrix> =
                all.par_iter().filter_map(|f| self.optimised(f, *scale)).collect();
            let scored = optimised.into_iter().map(|f| (scorer.score(f.matrix()), f));
            let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
            best.map(|(score, fundamental)| Agreed { fundamental, scale: *scale, score })
        };
        scorers.iter().zip(&samples).filter_map(best_at).collect()
    }

    /// Returns whether another geometry moves more than a tenth of the matches against their lines by
    /// more than the noise. Otherwise it leads to the same fit.
    pub fn tells_apart(&self, f: &FundamentalMatrix, from: &Fitted) -> bool {
        let is_moved = |m: &&Match| {
            let distance = |f: &FundamentalMatrix| sampson_distance(f, &m.pair);
            (distance(f) - distance(&from.fundamental)).abs() > from.noise.scale * m.sigma
        };
        SAME_SHARE * self.matches.iter().filter(is_moved).count() > self.matches.len()
    }

    /// Returns the likelier half of the matches, from which samples are drawn. Where matches are equally likely, their
    /// order says nothing, and all of them are in it.
    fn drawn_from(&self) -> Vec<&Match> {
        let mut order: Vec<&Match> = self.matches.iter().collect();
        order.sort_by(|a, b| b.prior.total_cmp(&a.prior));
        if let Some(last) = order.get((order.len() / 2).max(LEAST_DRAWN_FROM) - 1).map(|m| m.prior) {
            order.retain(|m| m.prior >= last);
        }
        order
    }

    /// Returns whether so many rounds have drawn a sample of right matches alone, but for a probability of [`MISSED`]
    /// (Fischler & Bolles 1981). The matches near `agreed` count as right.
    pub fn are_enough(&self, rounds: u64, agreed: &Agreed) -> bool {
        let drawn_from = self.drawn_from();
        let is_right =
            |m: &&&Match| sampson_distance(&agreed.fundamental, &m.pair) < BAND * agreed.scale * m.sigma;
        let right = drawn_from.iter().filter(is_right).count() as f64 / drawn_from.len() as f64;
        let missed = -right.powi(self.model.unknowns() as i32);
        (rounds * SAMPLES as u64) as f64 * missed.ln_1p() <= MISSED.ln()
    }

    fn scorer(&self, units: Units, scale: f64) -> Consensus {
        let witness =
            |m: &Match| Witness { pair: m.pair, sigmas: [scale * m.sigma; 2], gain: m.prior, clicked: false };
        let witnesses: Vec<Witness> = self.matches.iter().map(witness).collect();
        Consensus::new(units, &witnesses)
    }

    /// Fits to the matches within reach of a scale, then to the matches within reach of that fit.
    fn optimised(&self, f: &FundamentalMatrix, scale: f64) -> Option<FundamentalMatrix> {
        let mut current = *f;
        for band in LOCAL_BANDS {
            let near = |m: &&Match| sampson_distance(&current, &m.pair) < band * scale * m.sigma;
            let observations: Vec<Observation> = self
                .matches
                .iter()
                .filter(near)
                .map(|m| Observation { pair: m.pair, sigma: m.sigma * scale })
                .collect();
            current = self.model.fitted(&current, &observations, BAND)?.fundamental;
        }
        Some(current)
    }

    /// Returns the best minimal samples at each scale.
    fn sampled(
        &self,
        units: Units,
        scorers: &[(f64, Consensus)],
        seed: u64,
        round: u64,
    ) -> Vec<Vec<FundamentalMatrix>> {
        let samples = Samples::new(&self.model, units, self.drawn_from().iter().map(|m| &m.pair));
        let scored = |f: Matrix3<f64>| {
            let fundamental = FundamentalMatrix::nearest_rank_two(units.in_pixels(&f))?;
            let scores: Vec<f64> = scorers.iter().map(|(_, scorer)| scorer.score_conditioned(&f)).collect();
            Some((scores, fundamental))
        };
        let solved =
            |random: &mut Pcg64Mcg| samples.drawn(random).into_iter().filter_map(scored).collect::<Vec<_>>();
        let draws =
            Draws { seed, purpose: Purpose::MatchSamples, first: round << 32, count: SAMPLES, task: TASK };
        let drawn = draws.collect(solved);
        let of_scale = |k: usize| {
            let all = drawn.iter().map(|(scores, f)| (scores[k], *f)).collect();
            best(all, OPTIMISED).into_iter().map(|(_, f)| f).collect()
        };
        (0..scorers.len()).map(of_scale).collect()
    }
}
