//! Lens distortion fitted to matches together with the fundamental matrix: the division model
//! (Fitzgibbon 2001).
//!
//! With `d` the offset of a point from the middle of its image and `r` the length of `d` in half
//! diagonals, the undistorted point is
//!
//! ```text
//!     x = middle + d / (1 + λ r²)
//! ```
//!
//! and `x2ᵀ F x1 = 0` holds for undistorted points. For a given λ, `F` and the noise are fitted as without a
//! lens. Residuals are measured in pixels of the pictures. The fit takes the likeliest λ.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::matches::estimate_fundamental;
use super::noise::{Noise, Residual};
use super::{Match, climbed};
use crate::geometry::{
    Frame, FundamentalMatrix, Observation, Point, PointPair, REGIONS, Vector, fit_fundamental, median, region,
};

/// Lens distortion fitted to matches together with the fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DivisionFit {
    /// Coefficient λ of each image; negative for barrel distortion.
    pub lambdas: [f64; 2],
    /// Standard deviation of each coefficient.
    pub deviations: [f64; 2],
    /// Whether both images have one lens. They have one each if the coefficients differ clearly.
    pub is_same: bool,
    /// Fundamental matrix of the undistorted points.
    pub fundamental: FundamentalMatrix,
    /// Gain in log-likelihood by the lens.
    pub gain: f64,
}

/// Fewest matches: twice as many as for a fit without a lens.
const LEAST_MATCHES: usize = 28;
/// Largest number of matches in a fit, evenly chosen. It bounds the time.
const MOST_MATCHES: usize = 1000;
/// Limits of λ. At −0.6, the corners of a picture lie at 2.5 times their distance from the middle.
const LIMITS: [f64; 2] = [-0.6, 0.3];
/// First and last step of the search for λ. The last one moves corners by a third of a pixel in 1,000.
const STEPS: [f64; 2] = [0.08, 0.0005];
/// First step of a search that begins at the best λ of slightly fewer matches.
const NEAR: f64 = 0.01;
/// Gain in log-likelihood below which the rounds end.
const LEAST_GAIN: f64 = 0.05;
/// Width of the band around the lines of the start in which matches count, as a share of the longer
/// side. A strong lens moves points by a tenth of the side, but mostly along with their neighbours.
const BAND: f64 = 0.03;
/// Number of standard deviations from zero at which a coefficient is clear. By chance, one
/// coefficient in a thousand is as far from zero: nine regions have 8 degrees of freedom in
/// Student's distribution.
const CLEAR: f64 = 5.0;
/// Gain in log-likelihood at which a lens is clear: the matches are ten thousand times as likely.
const CLEAR_GAIN: f64 = 9.0;
/// Coefficients beyond [`LIMITS`], as of fisheye lenses. At −2, what lies 90° aside is at 0.7 half diagonals.
const STRONG: [f64; 4] = [-0.8, -1.2, -1.6, -2.0];
/// Smallest `1 + λ r²` of a point that such a lens shows.
const LEAST_FACTOR: f64 = 0.05;
/// Largest share of the matches outside the picture of such a lens: one in this many may be wrong.
const MAY_BE_OUTSIDE: usize = 20;
/// Directions in which the coefficients change: together, and each by itself.
const TOGETHER: &[[f64; 2]] = &[[1.0, 1.0]];
const EACH: &[[f64; 2]] = &[[1.0, 0.0], [0.0, 1.0]];

fn undistorted(point: Point, lambda: f64, frame: Frame) -> Point {
    let from: Vector = point - frame.centre();
    frame.centre() + from / (1.0 + lambda * share(from, frame))
}

/// Returns the squared length of an offset in half diagonals.
fn share(from: Vector, frame: Frame) -> f64 {
    (2.0 * from.norm() / frame.diagonal()).powi(2)
}

/// Returns the gradient by the point in the picture, given the line of the undistorted point.
fn gradient(line: &Vector3<f64>, point: Point, lambda: f64, frame: Frame) -> Vector {
    let from: Vector = point - frame.centre();
    let factor = 1.0 + lambda * share(from, frame);
    let slope = 8.0 * lambda / frame.diagonal().powi(2);
    line.xy() / factor - from * (slope * from.dot(&line.xy()) / (factor * factor))
}

/// A geometry with its lens, fitted at one λ.
#[derive(Clone)]
struct Bent {
    lambdas: [f64; 2],
    fundamental: FundamentalMatrix,
    noise: Noise,
    log_likelihood: f64,
}

struct Fitter<'a> {
    matches: &'a [Match],
    frames: [Frame; 2],
    /// Width over which the residuals of wrong matches spread, px.
    spread: f64,
}

impl Fitter<'_> {
    fn undistorted(&self, pair: &PointPair, lambdas: [f64; 2]) -> PointPair {
        PointPair {
            point1: undistorted(pair.point1, lambdas[0], self.frames[0]),
            point2: undistorted(pair.point2, lambdas[1], self.frames[1]),
        }
    }

    /// Returns the first-order distance of a match from its curves in pixels of the pictures, and the factor
    /// from these to undistorted pixels.
    fn distance(&self, f: &FundamentalMatrix, pair: &PointPair, lambdas: [f64; 2]) -> (f64, f64) {
        let straight = self.undistorted(pair, lambdas);
        let (x1, x2) = (straight.point1.to_homogeneous(), straight.point2.to_homogeneous());
        let (l2, l1) = (f.matrix() * x1, f.matrix().tr_mul(&x2));
        let of_points = gradient(&l1, pair.point1, lambdas[0], self.frames[0]).norm_squared()
            + gradient(&l2, pair.point2, lambdas[1], self.frames[1]).norm_squared();
        let of_straight = l1.xy().norm_squared() + l2.xy().norm_squared();
        let distance = x2.dot(&l2).abs() / of_points.sqrt().max(f64::MIN_POSITIVE);
        (distance, (of_straight / of_points.max(f64::MIN_POSITIVE)).sqrt().recip())
    }

    /// Returns a geometry with the noise of the matches.
    fn explained(&self, f: &FundamentalMatrix, lambdas: [f64; 2]) -> Bent {
        let of = |m: &Match| Residual {
            distance: self.distance(f, &m.pair, lambdas).0,
            sigma: m.sigma,
            prior: m.prior,
        };
        let residuals: Vec<Residual> = self.matches.iter().map(of).collect();
        let noise = Noise::of(&residuals, self.spread);
        Bent { lambdas, fundamental: *f, noise, log_likelihood: noise.log_likelihood(&residuals) }
    }

    /// Fits the geometry with one pair of coefficients.
    fn fitted(&self, start: &FundamentalMatrix, lambdas: [f64; 2]) -> Option<Bent> {
        let refitted = |last: &Bent| {
            let of = |m: &Match| {
                let scale = self.distance(&last.fundamental, &m.pair, lambdas).1;
                let sigma = m.sigma * last.noise.scale * scale;
                Observation { pair: self.undistorted(&m.pair, lambdas), sigma }
            };
            let observations: Vec<Observation> = self.matches.iter().map(of).collect();
            let fit = fit_fundamental(&last.fundamental, &observations, 1.0)?;
            Some(self.explained(&fit.fundamental, lambdas))
        };
        climbed(self.explained(start, lambdas), LEAST_GAIN, |bent| bent.log_likelihood, refitted)
    }

    /// Returns the likeliest geometry with a lens, in steps from `start`.
    fn likeliest(&self, start: Bent, mut step: f64, directions: &[[f64; 2]]) -> Bent {
        let mut best = start;
        while step >= STEPS[1] {
            let beside = directions.iter().flat_map(|[a, b]| {
                [-step, step].map(|by| [best.lambdas[0] + by * a, best.lambdas[1] + by * b])
            });
            let within = |lambda: &f64| (LIMITS[0]..=LIMITS[1]).contains(lambda);
            let tried = beside
                .filter(|lambdas| lambdas.iter().all(within))
                .filter_map(|lambdas| self.fitted(&best.fundamental, lambdas));
            match tried.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood)) {
                Some(next) if next.log_likelihood > best.log_likelihood => best = next,
                _ => step *= 0.5,
            }
        }
        best
    }

    /// Returns the standard deviations of both coefficients and of their difference. The jackknife (Efron &
    /// Stein 1981) leaves out the matches of one region of image 1 at a time, because matches of one region
    /// share their error.
    fn deviations(&self, best: &Bent, directions: &[[f64; 2]]) -> Option<[f64; 3]> {
        let without = |left_out: usize| {
            let is_kept = |m: &&Match| region(m.pair.point1, self.frames[0]) != left_out;
            let kept: Vec<Match> = self.matches.iter().filter(is_kept).copied().collect();
            if kept.len() == self.matches.len() {
                return None;
            }
            let fitter = Fitter { matches: &kept, ..*self };
            let start = fitter.fitted(&best.fundamental, best.lambdas)?;
            let [a, b] = fitter.likeliest(start, NEAR, directions).lambdas;
            Some([a, b, a - b])
        };
        let all: Vec<[f64; 3]> = (0..REGIONS).into_par_iter().filter_map(without).collect();
        let count = all.len() as f64;
        let deviation = |k: usize| {
            let mean = all.iter().map(|values| values[k]).sum::<f64>() / count;
            let squares: f64 = all.iter().map(|values| (values[k] - mean).powi(2)).sum();
            ((count - 1.0) / count * squares).sqrt()
        };
        (all.len() > 2).then(|| [deviation(0), deviation(1), deviation(2)])
    }
}

/// Fits the division model to matches that were found without a geometry, many of which may be wrong.
/// `start` is the geometry without a lens, `aligned` its own, more precise matches. Both images get one
/// coefficient, or one each if these differ clearly.
///
/// Returns `None` if no lens explains the matches clearly better, and for fewer than 28 matches
/// near the lines of `start`. A lens is clear if its coefficient is 5 standard deviations from
/// zero. A lens explains chance if the aligned matches are farther from the curves, by the median,
/// than the other matches.
pub(in crate::estimate) fn fit_division(
    matches: &[Match],
    start: &FundamentalMatrix,
    aligned: &[PointPair],
    frames: [Frame; 2],
) -> Option<DivisionFit> {
    let band = BAND * frames[0].longer_side().max(frames[1].longer_side());
    let all = Fitter { matches: &[], frames, spread: 2.0 * band };
    let is_near = |m: &&Match| all.distance(start, &m.pair, [0.0; 2]).0 < band;
    let near: Vec<Match> = matches.iter().filter(is_near).copied().collect();
    let few: Vec<Match> = near.iter().step_by(near.len().div_ceil(MOST_MATCHES).max(1)).copied().collect();
    if few.len() < LEAST_MATCHES {
        return None;
    }
    let fitter = Fitter { matches: &few, ..all };
    let straight = fitter.fitted(start, [0.0; 2])?;
    let same = fitter.likeliest(straight.clone(), STEPS[0], TOGETHER);
    let each = fitter.likeliest(same.clone(), NEAR, EACH);
    let of_each = fitter.deviations(&each, EACH)?;
    let differ = (each.lambdas[0] - each.lambdas[1]).abs() > CLEAR * of_each[2]
        && each.log_likelihood - same.log_likelihood > CLEAR_GAIN;
    let (bent, [first, second, _]) =
        if differ { (each, of_each) } else { (same.clone(), fitter.deviations(&same, TOGETHER)?) };
    let gain = bent.log_likelihood - straight.log_likelihood;
    let is_clear =
        bent.lambdas.iter().zip([first, second]).any(|(lambda, deviation)| lambda.abs() > CLEAR * deviation);
    // Half of the right ones of `matches` are nearer than the scale of their noise.
    let distance = |pair: &PointPair| fitter.distance(&bent.fundamental, pair, bent.lambdas).0;
    let is_confirmed = !aligned.is_empty() && median(aligned.iter().map(distance)) < bent.noise.scale;
    (is_clear && is_confirmed && gain > CLEAR_GAIN).then_some(DivisionFit {
        lambdas: bent.lambdas,
        deviations: [first, second],
        is_same: !differ,
        fundamental: bent.fundamental,
        gain,
    })
}

/// Returns whether a lens stronger than [`fit_division`] looks for makes the matches clearly likelier than the
/// geometry `start` and any other one without a lens. Between them, `F` may follow the lens where there are
/// matches, so no step from `start` leads to the lens: geometries are sought anew behind each lens.
pub(in crate::estimate) fn strong_lens_is_likelier(
    matches: &[Match],
    start: &FundamentalMatrix,
    frames: [Frame; 2],
    seed: u64,
) -> bool {
    let few: Vec<Match> =
        matches.iter().step_by(matches.len().div_ceil(MOST_MATCHES).max(1)).copied().collect();
    let spread = frames[0].longer_side().max(frames[1].longer_side());
    let gain = |lambda: f64| {
        let shows =
            |point: Point, frame: Frame| 1.0 + lambda * share(point - frame.centre(), frame) > LEAST_FACTOR;
        let is_inside = |m: &&Match| shows(m.pair.point1, frames[0]) && shows(m.pair.point2, frames[1]);
        let inside: Vec<Match> = few.iter().filter(is_inside).copied().collect();
        if MAY_BE_OUTSIDE * (few.len() - inside.len()) > few.len() {
            return None;
        }
        let fitter = Fitter { matches: &inside, frames, spread };
        let behind = |lambdas: [f64; 2]| {
            let straight = |m: &Match| Match { pair: fitter.undistorted(&m.pair, lambdas), ..*m };
            let straight: Vec<Match> = inside.iter().map(straight).collect();
            let found = estimate_fundamental(&straight, frames, seed).ok()?.fundamental;
            Some(fitter.fitted(&found, lambdas)?.log_likelihood)
        };
        let bent = behind([lambda; 2])?;
        let near_start = fitter.fitted(start, [0.0; 2]).map(|straight| straight.log_likelihood);
        // Most pairs end here: no other search without a lens is needed if `start` is as likely.
        if near_start.is_some_and(|straight| bent - straight <= CLEAR_GAIN) {
            return None;
        }
        let without = near_start.into_iter().chain(behind([0.0; 2])).max_by(f64::total_cmp)?;
        Some(bent - without)
    };
    STRONG.iter().filter_map(|lambda| gain(*lambda)).any(|gain| gain > CLEAR_GAIN)
}

impl DivisionFit {
    /// Returns how far the lens moves the corners of the two images, px of the pictures: the larger distance.
    pub fn corner_shift(&self, frames: [Frame; 2]) -> f64 {
        let shift = |k: usize| {
            let corner = Point::new(frames[k].right(), frames[k].bottom());
            (undistorted(corner, self.lambdas[k], frames[k]) - corner).norm()
        };
        shift(0).max(shift(1))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::{algebraic_residual, eight_point, sampson_distance};

    const FRAMES: [Frame; 2] = [Frame { width: 768, height: 576 }; 2];

    /// Returns the place in the picture of an undistorted point.
    fn distorted(point: Point, lambda: f64, frame: Frame) -> Point {
        let from: Vector = point - frame.centre();
        frame.centre() + from * (2.0 / (1.0 + (1.0 - 4.0 * lambda * share(from, frame)).sqrt()))
    }

    /// Returns 400 matches with Cauchy noise of 0.1 px through lenses, of which one in five is wrong, the fit
    /// of eight points without a lens, and the exact matches.
    fn matches(lambdas: [f64; 2], seed: u64) -> (Vec<Match>, FundamentalMatrix, Vec<PointPair>) {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let seen = |pair: &PointPair| PointPair {
            point1: distorted(pair.point1, lambdas[0], FRAMES[0]),
            point2: distorted(pair.point2, lambdas[1], FRAMES[1]),
        };
        let exact: Vec<PointPair> = RandomScene::new(seed).pairs(400).iter().map(seen).collect();
        let matches: Vec<Match> = exact
            .iter()
            .enumerate()
            .map(|(k, pair)| {
                let PointPair { point1, mut point2 } = *pair;
                let mut cauchy = || 0.1 * (PI * (random.random::<f64>() - 0.5)).tan();
                point2 += Vector::new(cauchy(), cauchy());
                if k % 5 == 0 {
                    let [x, y] = [random.random::<f64>() * 768.0, random.random::<f64>() * 576.0];
                    point2 = Point::new(x, y);
                }
                PointPair { point1, point2 }.into()
            })
            .collect();
        let right: Vec<PointPair> =
            matches.iter().enumerate().filter(|(k, _)| k % 5 > 0).map(|(_, m)| m.pair).collect();
        let start = eight_point(&right).unwrap();
        (matches, start, exact)
    }

    #[test]
    fn a_lens_of_both_images_is_found_with_its_deviation() {
        let mut off = Vec::new();
        for lambda in [-0.25, -0.1, -0.04, 0.08] {
            for seed in 1..4 {
                let (matches, start, exact) = matches([lambda; 2], seed);
                let lens =
                    fit_division(&matches, &start, &exact, FRAMES).unwrap_or_else(|| panic!("{lambda}"));
                assert!(lens.is_same, "{lambda}: {:?}", lens.lambdas);
                off.push((lens.lambdas[0] - lambda).abs() / lens.deviations[0]);
                // Exact matches are on the lines of the undistorted points.
                let pairs = RandomScene::new(seed).pairs(200);
                let distances = pairs.iter().map(|pair| sampson_distance(&lens.fundamental, pair));
                let error = median(distances);
                assert!(error < 0.5, "{lambda}: {error} px, {:?}", lens.lambdas);
            }
        }
        // Student's distribution of 8 degrees of freedom: half of all within 0.7 deviations.
        assert!(median(off.clone()) < 1.5 && off.iter().all(|off| *off < 5.0), "{off:?}");
    }

    #[test]
    fn images_of_different_lenses_get_one_each() {
        let (matches, start, exact) = matches([-0.2, 0.0], 5);
        let lens = fit_division(&matches, &start, &exact, FRAMES).unwrap();
        assert!(!lens.is_same, "{lens:?}");
        for (found, lambda) in lens.lambdas.iter().zip([-0.2, 0.0]) {
            assert!((found - lambda).abs() < 0.03, "{lens:?}");
        }
    }

    #[test]
    fn without_distortion_no_lens_is_found() {
        for seed in 10..30 {
            let (matches, start, exact) = matches([0.0; 2], seed);
            let lens = fit_division(&matches, &start, &exact, FRAMES);
            assert!(lens.is_none(), "{seed}: {lens:?}");
        }
        let (few, start, exact) = matches([-0.2; 2], 1);
        assert!(fit_division(&few[..20], &start, &exact, FRAMES).is_none());
        assert!(fit_division(&[], &start, &exact, FRAMES).is_none());
    }

    #[test]
    fn a_lens_that_the_aligned_matches_do_not_confirm_is_chance() {
        let (bent, start, exact) = matches([-0.2; 2], 3);
        let (_, _, straight) = matches([0.0; 2], 3);
        let is_found = |aligned: &[PointPair]| fit_division(&bent, &start, aligned, FRAMES).is_some();
        assert_eq!([&exact[..], &straight, &[]].map(is_found), [true, false, false]);
    }

    #[test]
    fn distances_are_those_of_the_pictures() {
        let (matches, start, _) = matches([-0.2; 2], 2);
        let fitter = Fitter { matches: &matches, frames: FRAMES, spread: 20.0 };
        let lambdas = [-0.15, -0.1];
        for m in matches.iter().filter(|m| m.pair.point2.x > 0.0).take(50) {
            let residual = |pair: &PointPair| algebraic_residual(&start, &fitter.undistorted(pair, lambdas));
            let mut square = 0.0;
            for axis in 0..4 {
                let moved = |by: f64| {
                    let mut pair = m.pair;
                    let point = if axis < 2 { &mut pair.point1 } else { &mut pair.point2 };
                    point[axis % 2] += by;
                    residual(&pair)
                };
                square += ((moved(1e-3) - moved(-1e-3)) / 2e-3).powi(2);
            }
            let expected = residual(&m.pair).abs() / square.sqrt();
            let (found, _) = fitter.distance(&start, &m.pair, lambdas);
            assert!((found - expected).abs() < 1e-5 * (1.0 + expected), "{found} {expected}");
        }
    }
}
