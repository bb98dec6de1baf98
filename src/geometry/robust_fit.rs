//! Robust fit of all seven degrees of freedom of `F` to point matches: Levenberg–Marquardt on a Cauchy cost of
//! the Sampson distance (Hartley & Zisserman, §11.4.3 and A6.8).

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::orthonormal::{Orthonormal, Vector7};
use super::{FundamentalMatrix, PointPair};

/// A match and its standard deviation in px, each coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Where the scene point is seen.
    pub pair: PointPair,
    /// Standard deviation of each coordinate, px.
    pub sigma: f64,
}

type Matrix7 = SMatrix<f64, 7, 7>;

/// Result of a robust fit.
#[derive(Debug, Clone)]
pub struct FundamentalFit {
    /// The fitted matrix.
    pub fundamental: FundamentalMatrix,
    /// Covariance of the nine entries of the matrix, row by row, from the curvature of the robust cost scaled
    /// by the residuals that were left. `None` when the observations do not determine all seven numbers.
    pub covariance: Option<Matrix9>,
}

/// Covariance of the nine entries of a matrix, row by row.
pub type Matrix9 = SMatrix<f64, 9, 9>;

/// Fits `F` to the observations, starting from `start`. `scale` is the Sampson distance, in units of each
/// observation's σ, beyond which a match loses influence. `None` when there are too few observations or the
/// numbers degenerate.
pub fn fit_fundamental(
    start: &FundamentalMatrix,
    observations: &[Observation],
    scale: f64,
) -> Option<FundamentalFit> {
    if observations.len() < 7 {
        return None;
    }
    let conditioning = Conditioning::new(observations);
    let mut representation = Orthonormal::new(&conditioning.conditioned(start.matrix()))?;
    let (mut cost, mut gradient, mut hessian) = conditioning.normal_equations(&representation, scale)?;
    let mut damping = 1e-4;
    for _ in 0..ITERATIONS {
        let damped = hessian + Matrix7::from_diagonal(&hessian.diagonal().add_scalar(1e-12)) * damping;
        let Some(step) = damped.cholesky().map(|c| c.solve(&-gradient)) else {
            damping *= 10.0;
            continue;
        };
        let candidate = representation.moved(&step);
        match conditioning.normal_equations(&candidate, scale) {
            Some((new_cost, g, h)) if new_cost < cost => {
                let small = cost - new_cost < 1e-7 * cost;
                (representation, cost, gradient, hessian) = (candidate, new_cost, g, h);
                damping = (damping * 0.2).max(1e-12);
                if small {
                    break;
                }
            }
            _ if damping > 1e6 => break,
            _ => damping *= 10.0,
        }
    }
    let in_pixels = conditioning.in_pixels(&representation.matrix());
    let fundamental = FundamentalMatrix::from_rank_two(in_pixels)?;
    // The entries of F follow the seven numbers linearly to first order; its norm is brought to 1 on the way.
    let scale_to_unit = 1.0 / in_pixels.norm();
    let derivatives = representation.derivatives(&representation.matrix()).map(|d| {
        let moved = conditioning.in_pixels(&d) * scale_to_unit;
        let unit = in_pixels * scale_to_unit;
        moved - unit * unit.dot(&moved)
    });
    let jacobian = SMatrix::<f64, 9, 7>::from_fn(|row, k| derivatives[k][(row / 3, row % 3)]);
    let freedom = (observations.len() as f64 - 7.0).max(1.0);
    // The robust cost of Gaussian residuals is about their sum of squares.
    let variance = cost / freedom;
    let covariance = hessian.cholesky().map(|c| jacobian * c.inverse() * jacobian.transpose() * variance);
    Some(FundamentalFit { fundamental, covariance })
}

/// Steps tried at most: a fit that starts within some pixels settles in fewer than ten.
const ITERATIONS: usize = 25;

/// Coordinates moved and scaled to order one, the same for both images.
struct Conditioning {
    to: [Matrix3<f64>; 2],
    points: Vec<[Vector3<f64>; 2]>,
    /// Conditioned units per σ, each observation.
    sigmas: Vec<f64>,
}

impl Conditioning {
    fn new(observations: &[Observation]) -> Self {
        let n = observations.len() as f64;
        let centre1 =
            observations.iter().fold(Vector3::zeros(), |s, o| s + o.pair.point1.to_homogeneous()) / n;
        let centre2 =
            observations.iter().fold(Vector3::zeros(), |s, o| s + o.pair.point2.to_homogeneous()) / n;
        let spread = observations
            .iter()
            .map(|o| {
                (o.pair.point1.to_homogeneous() - centre1).norm_squared()
                    + (o.pair.point2.to_homogeneous() - centre2).norm_squared()
            })
            .sum::<f64>()
            / (2.0 * n);
        // One scale for both images keeps the Sampson distance a distance.
        let s = 1.0 / spread.sqrt().max(1e-9);
        let to = [centre1, centre2].map(|c| Matrix3::new(s, 0.0, -s * c.x, 0.0, s, -s * c.y, 0.0, 0.0, 1.0));
        let points = observations
            .iter()
            .map(|o| [to[0] * o.pair.point1.to_homogeneous(), to[1] * o.pair.point2.to_homogeneous()])
            .collect();
        Self { to, points, sigmas: observations.iter().map(|o| s * o.sigma).collect() }
    }

    fn conditioned(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        let inverse = |m: &Matrix3<f64>| {
            let s = m[(0, 0)];
            Matrix3::new(1.0 / s, 0.0, -m[(0, 2)] / s, 0.0, 1.0 / s, -m[(1, 2)] / s, 0.0, 0.0, 1.0)
        };
        inverse(&self.to[1]).transpose() * f * inverse(&self.to[0])
    }

    fn in_pixels(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        self.to[1].transpose() * f * self.to[0]
    }

    /// Robust cost, its gradient and Gauss–Newton Hessian in the seven increments.
    fn normal_equations(&self, representation: &Orthonormal, scale: f64) -> Option<(f64, Vector7, Matrix7)> {
        let f = representation.matrix();
        let derivatives = representation.derivatives(&f);
        let (mut cost, mut gradient, mut hessian) = (0.0, Vector7::zeros(), Matrix7::zeros());
        for ([x1, x2], sigma) in self.points.iter().zip(&self.sigmas) {
            let (l2, l1) = (f * x1, f.tr_mul(x2));
            let numerator = x2.dot(&l2);
            let denominator = (l2.xy().norm_squared() + l1.xy().norm_squared()).sqrt();
            if denominator < 1e-14 {
                continue;
            }
            let residual = numerator / denominator / sigma;
            let mut jacobian = Vector7::zeros();
            for (k, d) in derivatives.iter().enumerate() {
                let (d2, d1) = (d * x1, d.tr_mul(x2));
                let change = (l2.xy().dot(&d2.xy()) + l1.xy().dot(&d1.xy())) / denominator;
                jacobian[k] = (x2.dot(&d2) - numerator * change / denominator) / (denominator * sigma);
            }
            // Cauchy: ρ = s² ln(1 + r²/s²), weight 1/(1 + r²/s²).
            let ratio = (residual / scale).powi(2);
            let weight = 1.0 / (1.0 + ratio);
            cost += scale * scale * ratio.ln_1p();
            gradient += jacobian * (weight * residual);
            hessian += jacobian * jacobian.transpose() * weight;
        }
        (cost.is_finite() && hessian.iter().all(|v| v.is_finite())).then_some((cost, gradient, hessian))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Camera, symmetric_epipolar_distance};
    use nalgebra::SVector;
    use rand::{RngExt, SeedableRng};

    fn scene(count: usize) -> (FundamentalMatrix, Vec<PointPair>) {
        let (camera1, camera2) = Camera::example_pair();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let pairs = (0..count)
            .map(|_| {
                let x = nalgebra::Point3::new(
                    rng.random_range(-2.0..2.0),
                    rng.random_range(-1.5..1.5),
                    rng.random_range(4.0..8.0),
                );
                PointPair { point1: camera1.project(&x).unwrap(), point2: camera2.project(&x).unwrap() }
            })
            .collect();
        (Camera::fundamental(&camera1, &camera2).unwrap(), pairs)
    }

    fn mean(f: &FundamentalMatrix, pairs: &[PointPair]) -> f64 {
        pairs.iter().map(|p| symmetric_epipolar_distance(f, p)).sum::<f64>() / pairs.len() as f64
    }

    /// A start some pixels off.
    fn disturbed(f: &FundamentalMatrix) -> FundamentalMatrix {
        let moved = |s: f64| Matrix3::new(1.0, s * 0.004, 4.0 * s, -s * 0.004, 1.0, -3.0 * s, 0.0, 0.0, 1.0);
        FundamentalMatrix::from_rank_two(moved(1.0).transpose() * f.matrix() * moved(-1.0)).unwrap()
    }

    #[test]
    fn exact_matches_give_the_exact_matrix() {
        let (f, pairs) = scene(30);
        let observations: Vec<_> = pairs.iter().map(|p| Observation { pair: *p, sigma: 1.0 }).collect();
        let start = disturbed(&f);
        assert!(mean(&start, &pairs) > 2.0);
        let result = fit_fundamental(&start, &observations, 2.0).unwrap().fundamental;
        assert!(mean(&result, &pairs) < 1e-6, "{}", mean(&result, &pairs));
    }

    #[test]
    fn a_third_of_wrong_matches_does_not_matter() {
        let (f, pairs) = scene(90);
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(6);
        let observations: Vec<_> = pairs
            .iter()
            .enumerate()
            .map(|(k, p)| {
                let mut pair = *p;
                if k % 3 == 0 {
                    pair.point2.x += rng.random_range(-80.0..80.0);
                    pair.point2.y += rng.random_range(-80.0..80.0);
                }
                Observation { pair, sigma: 1.0 }
            })
            .collect();
        let result = fit_fundamental(&disturbed(&f), &observations, 1.5).unwrap().fundamental;
        assert!(mean(&result, &pairs) < 0.1, "{}", mean(&result, &pairs));
    }

    #[test]
    fn the_covariance_predicts_the_scatter_of_the_epipolar_lines() {
        let (f, pairs) = scene(60);
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(9);
        let mut gauss = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
        let probe = PointPair::new(150.0, 420.0, 160.0, 415.0);
        let on_line = f.line2_from_point1(probe.point1).unwrap().foot(probe.point2);
        let (mut squares, mut predicted, runs) = (0.0, 0.0, 200);
        for _ in 0..runs {
            let sigma = 0.5;
            let mut noisy = |p: nalgebra::Point2<f64>| {
                nalgebra::Point2::new(p.x + sigma * gauss(), p.y + sigma * gauss())
            };
            let observations: Vec<_> = pairs
                .iter()
                .map(|p| {
                    let pair = PointPair { point1: noisy(p.point1), point2: noisy(p.point2) };
                    Observation { pair, sigma }
                })
                .collect();
            let result = fit_fundamental(&f, &observations, 4.0).unwrap();
            let line = result.fundamental.line2_from_point1(probe.point1).unwrap();
            squares += line.signed_distance(on_line).powi(2);
            let l = result.fundamental.matrix() * probe.point1.to_homogeneous();
            let (x1, x2) = (probe.point1.to_homogeneous(), on_line.to_homogeneous());
            let row = SVector::<f64, 9>::from_fn(|k, _| x2[k / 3] * x1[k % 3]) / l.xy().norm();
            predicted += row.dot(&(result.covariance.unwrap() * row));
        }
        let ratio = (squares / predicted).sqrt();
        assert!((0.8..1.25).contains(&ratio), "measured over predicted deviation {ratio}");
    }

    #[test]
    fn too_few_matches_are_refused() {
        let (f, pairs) = scene(6);
        let observations: Vec<_> = pairs.iter().map(|p| Observation { pair: *p, sigma: 1.0 }).collect();
        assert!(fit_fundamental(&f, &observations, 1.0).is_none());
    }
}
