//! The final fit at full size: guided matching and consensus in turns.
//!
//! Matches found along the lines of a geometry favour that geometry. Where windows or tiles repeat,
//! they slide along the lines until they fit. A wrong geometry can so have more matches than the right
//! one, but less precise ones. Three things tell them apart:
//!
//! - **Noise** is estimated with each geometry ([`Noise`](crate::estimate::fit::Noise)), so precise
//!   matches outvote imprecise ones.
//! - **Ambiguous matches** count less: a match with an equal elsewhere on its line is right half of the
//!   time.
//! - **Likelihood against chance** compares the geometries, each on its own matches. Matches of a wrong
//!   geometry lie anywhere within the searched band. So the log-likelihood is taken relative to a
//!   uniform distribution over the band. It is 0 for chance, and grows with the number and the precision
//!   of the matches.

use std::collections::HashSet;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::dense::densified;
use super::matches::{LEAST_MATCHES, LevelMatch, MATCH_SIGMA, at_level};
use super::near_lines::is_within;
use super::refinement::{LevelMatcher, Refined, RefinementStep};
use crate::cancel::CancelFlag;
use crate::estimate::fit::{Contradiction, Evidence, Explanation, Fitted, LEAST_SCALE, Match, Model, Noise};
use crate::geometry::{FundamentalMatrix, Observation, rescaling, sampson_distance};
use crate::image::GrayPlane;

/// Widest band in which matches are sought, px of the level: the band of the first refinement.
const WIDEST: f64 = 4.0;
/// Largest number of rounds of consensus. Each begins with the best geometry of the round before.
const ROUNDS: u64 = 3;
/// Least gain in log-likelihood for another round: a likelihood 2.7 times as large.
const LEAST_GAIN: f64 = 1.0;

/// Input of the final fit besides its matches.
pub(in crate::estimate) struct Settling<'a> {
    /// Clicked pairs with their standard deviation, full-size pixels.
    pub clicks: &'a [Observation],
    /// Matches from another program, full-size pixels.
    pub given: &'a [Match],
    /// Calibration matrices of known cameras, full-size pixels.
    pub calibrations: Option<[Matrix3<f64>; 2]>,
    /// Whether the clicks allow another geometry (full size).
    pub allows: &'a (dyn Fn(&FundamentalMatrix) -> bool + Sync),
    pub seed: u64,
}

/// Observations and cameras that do not depend on the geometry, in pixels of the level.
struct Fixed {
    clicks: Vec<Observation>,
    /// Matches from another program, near the lines of the start.
    given: Vec<Match>,
    model: Model,
}

/// A geometry fitted to the matches along its own lines.
struct Followed {
    matches: Vec<LevelMatch>,
    fitted: Fitted,
}

impl Followed {
    fn explanation(&self) -> Explanation {
        let Fitted { fundamental, noise, log_likelihood, .. } = self.fitted;
        let right = self.matches.iter().filter(|m| is_right(m, &fundamental, noise));
        Explanation { fundamental, log_likelihood, right: right.map(|m| m.found.pair).collect() }
    }
}

impl LevelMatcher<'_> {
    /// Fits `start` (full size) and its rivals. Returns the likeliest. For known cameras, it is an essential
    /// matrix unless the matches contradict the calibration ([`Self::contradict`]).
    pub fn settled(
        &self,
        start: &FundamentalMatrix,
        settling: &Settling,
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        let clicks = settling.clicks.iter().map(|click| at_level(click, &self.level)).collect();
        let start = start.rescaled(self.level.scales)?;
        let given = settling.given.iter().map(|m| Match { pair: self.level.resized(&m.pair), ..*m });
        // Matches of another geometry lie anywhere, so few of them are near these lines.
        let given = given.filter(|m| is_within(&start, &m.pair, WIDEST)).collect();
        let fixed = Fixed { clicks, given, model: Model::Free };
        // One band for all, as likelihoods are compared.
        let first = self.fitted_along(&start, &fixed, WIDEST)?;
        let band = first.fitted.noise.reach().min(WIDEST);
        let free = self.likeliest(first, &fixed, band, settling, cancel)?;
        let scaled = |known: &[Matrix3<f64>; 2]| [0, 1].map(|k| rescaling(self.level.scales[k]) * known[k]);
        let Some(calibrations) = settling.calibrations.as_ref().map(scaled) else {
            return self.refined(free, &fixed, band);
        };
        let model = Model::of(Some(calibrations));
        let known = Fixed { model, ..fixed };
        let first = self.fitted_along(&free.fitted.fundamental, &known, WIDEST);
        let posed = first.and_then(|first| self.likeliest(first, &known, band, settling, cancel));
        let unknown = Fixed { model: Model::Free, ..known };
        let evidence = (&unknown, band, settling.seed);
        match posed.filter(|posed| !self.contradict(&calibrations, posed, &free, evidence)) {
            Some(posed) => self.refined(posed, &Fixed { model, ..unknown }, band),
            None => self.refined(free, &unknown, band),
        }
    }

    /// Returns whether the matches contradict the calibrations.
    fn contradict(
        &self,
        calibrations: &[Matrix3<f64>; 2],
        posed: &Followed,
        free: &Followed,
        (unknown, band, seed): (&Fixed, f64, u64),
    ) -> bool {
        let many = observed(&free.matches);
        let contradiction = Contradiction {
            calibrations,
            posed: posed.explanation(),
            free: free.explanation(),
            matches: many.len(),
            reach: free.fitted.noise.reach(),
            seed,
        };
        contradiction.is_clear(|| self.evidence(&many, unknown, band).covariance(&free.fitted))
    }

    /// Returns the likeliest geometry among a start and its rivals, with the matches along its lines. The start
    /// is fitted in the widest band.
    fn likeliest(
        &self,
        start: Followed,
        fixed: &Fixed,
        band: f64,
        settling: &Settling,
        cancel: &CancelFlag,
    ) -> Option<Followed> {
        let full_size = self.level.scales.map(f64::recip);
        let mut pool = Pool::default();
        let mut best = self.followed_on(&start, fixed, band)?;
        pool.add(start.matches);
        let is_allowed = |f: &FundamentalMatrix| f.rescaled(full_size).is_some_and(|f| (settling.allows)(&f));
        for round in 0..ROUNDS {
            if cancel.is_cancelled() {
                return None;
            }
            pool.add(self.matches(&best.fitted.fundamental, WIDEST));
            let matches = pool.observed();
            let evidence = self.evidence(&matches, fixed, WIDEST);
            let (start, scales) = ([best.fitted.fundamental], best.fitted.rival_scales());
            let agreed = evidence.consensus(&start, &scales, settling.seed, round, cancel);
            let rivals: Vec<Followed> = agreed
                .par_iter()
                .map(|agreed| &agreed.fundamental)
                .filter(|f| evidence.tells_apart(f, &best.fitted))
                .filter(|f| is_allowed(f))
                .filter_map(|f| self.followed(f, fixed, band))
                .collect();
            let likelier =
                |a: &Followed, b: &Followed| a.fitted.log_likelihood.total_cmp(&b.fitted.log_likelihood);
            let Some(rival) = rivals.into_iter().max_by(likelier) else { break };
            let gain = rival.fitted.log_likelihood - best.fitted.log_likelihood;
            if gain > 0.0 {
                best = rival;
            }
            if gain < LEAST_GAIN {
                break;
            }
        }
        let f = best.fitted.fundamental;
        let matches = densified(&self.level, self.dense_corners(), best.matches, &f, band);
        let many = observed(&matches);
        let evidence = self.evidence(&many, fixed, band);
        let fitted = evidence.fitted(&f)?;
        // The further matches may favour a neighbouring geometry.
        let agreed =
            evidence.consensus(&[fitted.fundamental], &fitted.rival_scales(), settling.seed, ROUNDS, cancel);
        let fitted = agreed
            .iter()
            .filter(|agreed| is_allowed(&agreed.fundamental))
            .filter_map(|agreed| evidence.fitted(&agreed.fundamental))
            .fold(
                fitted,
                |best, rival| if rival.log_likelihood > best.log_likelihood { rival } else { best },
            );
        Some(Followed { matches, fitted })
    }

    /// Returns a geometry (full size) as it is, with the matches along its lines. There may be few
    /// matches, and the uncertainty stays unknown.
    pub(super) fn unchanged(&self, f: &FundamentalMatrix) -> Option<Refined> {
        let f = f.rescaled(self.level.scales)?;
        let mut matches = self.matches(&f, WIDEST);
        let fixed = Fixed { clicks: Vec::new(), given: Vec::new(), model: Model::Free };
        let noise = self.evidence(&observed(&matches), &fixed, WIDEST).explained(&f).noise;
        keep_right(&mut matches, &f, noise);
        Refined::new(&self.level, &f, &matches, Some(noise.scale), None)
    }

    fn matches(&self, f: &FundamentalMatrix, band: f64) -> Vec<LevelMatch> {
        let mut found = self.matches_along_lines(f, band);
        found.retain(|m| is_within(f, &m.found.pair, band));
        found
    }

    fn evidence<'e>(&self, matches: &'e [Match], fixed: &'e Fixed, band: f64) -> Evidence<'e> {
        let frames = self.level.planes.map(GrayPlane::frame);
        let (given, clicks) = (&fixed.given, &fixed.clicks);
        let (spread, model) = (2.0 * band, fixed.model);
        Evidence { matches, given, clicks, frames, model, spread, least_scale: LEAST_SCALE }
    }

    /// Fits a geometry to the matches along its lines, with bands that narrow to `band`.
    fn followed(&self, f: &FundamentalMatrix, fixed: &Fixed, band: f64) -> Option<Followed> {
        self.followed_on(&self.fitted_along(f, fixed, WIDEST)?, fixed, band)
    }

    /// Continues a fit in the widest band.
    fn followed_on(&self, widest: &Followed, fixed: &Fixed, band: f64) -> Option<Followed> {
        let narrower = self.fitted_along(&widest.fitted.fundamental, fixed, band)?;
        self.fitted_along(&narrower.fitted.fundamental, fixed, band)
    }

    fn fitted_along(&self, f: &FundamentalMatrix, fixed: &Fixed, band: f64) -> Option<Followed> {
        let matches = self.matches(f, band);
        if matches.len() < LEAST_MATCHES {
            return None;
        }
        let fitted = self.evidence(&observed(&matches), fixed, band).fitted(f)?;
        Some(Followed { matches, fitted })
    }

    /// Returns the geometry with the matches that count as right, and its covariance.
    fn refined(&self, followed: Followed, fixed: &Fixed, band: f64) -> Option<Refined> {
        let Followed { mut matches, fitted } = followed;
        let evidence_matches = observed(&matches);
        let covariance = self.evidence(&evidence_matches, fixed, band).covariance(&fitted);
        let (f, noise) = (fitted.fundamental, fitted.noise);
        keep_right(&mut matches, &f, noise);
        if matches.len() < LEAST_MATCHES {
            return None;
        }
        let mut refined = Refined::new(&self.level, &f, &matches, Some(noise.scale), covariance.as_ref())?;
        refined.refinement.is_posed = fixed.model.is_posed();
        let step = RefinementStep { fundamental: refined.fundamental, matches: evidence_matches.len() };
        Some(refined.after([step]))
    }
}

/// Keeps the matches within reach of the noise.
fn keep_right(matches: &mut Vec<LevelMatch>, f: &FundamentalMatrix, noise: Noise) {
    matches.retain(|m| is_right(m, f, noise));
}

fn is_right(m: &LevelMatch, f: &FundamentalMatrix, noise: Noise) -> bool {
    sampson_distance(f, &m.found.pair) < noise.reach() * m.sigma / MATCH_SIGMA
}

/// Returns the matches, with deviations relative to an aligned match.
fn observed(matches: &[LevelMatch]) -> Vec<Match> {
    let of = |m: &LevelMatch| Match {
        pair: m.found.pair,
        sigma: m.sigma / MATCH_SIGMA,
        prior: f64::from(m.prior),
    };
    matches.iter().map(of).collect()
}

/// Returns the matches along the lines of several geometries, each once.
#[derive(Default)]
struct Pool {
    matches: Vec<LevelMatch>,
    known: HashSet<[u64; 4]>,
}

impl Pool {
    fn add(&mut self, found: Vec<LevelMatch>) {
        for m in found {
            if self.known.insert(m.found.pair.numbers().map(f64::to_bits)) {
                self.matches.push(m);
            }
        }
    }

    fn observed(&self) -> Vec<Match> {
        observed(&self.matches)
    }
}
