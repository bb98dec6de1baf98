//! Robust fit of `F` to point matches: of its seven degrees of freedom, or of the five that known cameras leave.
//! Levenberg–Marquardt minimises a Cauchy cost of the Sampson distance (Hartley & Zisserman, §11.4.3 and A6.8).

use multiversion::multiversion;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::orthonormal::Orthonormal;
use super::posed::Posed;
use super::representation::{Matrix9, Representation};
use super::{FundamentalMatrix, PointPair, scaling};

/// A match with the standard deviation of its coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The matched points.
    pub pair: PointPair,
    /// Standard deviation of each coordinate, px.
    pub sigma: f64,
}

/// The result of a robust fit.
#[derive(Debug, Clone)]
pub struct FundamentalFit {
    /// Fitted fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Covariance of the nine entries of the matrix, row by row: the inverse curvature of the
    /// robust cost times the residual variance. `None` when the observations do not determine all its
    /// numbers.
    pub covariance: Option<Matrix9>,
}

/// Fits `F` to the observations, starting from `start`.
///
/// `scale` is the Sampson distance beyond which a match loses influence, in units of the
/// observation's σ. Returns `None` when fewer than seven observations are given or the
/// representation degenerates.
pub fn fit_fundamental(
    start: &FundamentalMatrix,
    observations: &[Observation],
    scale: f64,
) -> Option<FundamentalFit> {
    let conditioning = Conditioning::new(observations);
    let representation = Orthonormal::new(&conditioning.conditioned(start.matrix()))?;
    fitted(representation, &conditioning, observations.len(), scale)
}

/// Fits `F` as [`fit_fundamental`] does, for cameras with these calibration matrices: an essential matrix with five
/// degrees of freedom. Starts at the essential matrix nearest to `start`.
///
/// Returns `None` when fewer than five observations are given, or for a calibration matrix without inverse.
pub fn fit_posed(
    start: &FundamentalMatrix,
    calibrations: &[Matrix3<f64>; 2],
    observations: &[Observation],
    scale: f64,
) -> Option<FundamentalFit> {
    let conditioning = Conditioning::new(observations);
    let representation = conditioning.posed(start, calibrations)?;
    fitted(representation, &conditioning, observations.len(), scale)
}

fn fitted<const N: usize, R: Representation<N>>(
    start: R,
    conditioning: &Conditioning,
    observations: usize,
    scale: f64,
) -> Option<FundamentalFit> {
    if observations < N {
        return None;
    }
    let mut representation = start;
    let (mut cost, mut gradient, mut hessian) = conditioning.normal_equations(&representation, scale)?;
    let mut damping = 1e-4;
    for _ in 0..ITERATIONS {
        let damped =
            hessian + SMatrix::<f64, N, N>::from_diagonal(&hessian.diagonal().add_scalar(1e-12)) * damping;
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
    let jacobian = unit_entries(conditioning, &representation);
    let freedom = (observations as f64 - N as f64).max(1.0);
    // For Gaussian residuals the robust cost is about their sum of squares.
    let variance = cost / freedom;
    let covariance = hessian.cholesky().map(|c| jacobian * c.inverse() * jacobian.transpose() * variance);
    Some(FundamentalFit { fundamental, covariance })
}

/// Returns the derivatives of the entries of `F` (pixels, norm 1) by its numbers, row by row.
fn unit_entries<const N: usize>(
    conditioning: &Conditioning,
    representation: &impl Representation<N>,
) -> SMatrix<f64, 9, N> {
    let in_pixels = conditioning.in_pixels(&representation.matrix());
    let norm = in_pixels.norm();
    let unit = in_pixels / norm;
    by_entries(&representation.derivatives().map(|d| {
        let moved = conditioning.in_pixels(&d) / norm;
        moved - unit * unit.dot(&moved)
    }))
}

/// Returns the entries of derivatives, row by row, a column each.
fn by_entries<const N: usize>(derivatives: &[Matrix3<f64>; N]) -> SMatrix<f64, 9, N> {
    SMatrix::from_fn(|row, k| derivatives[k][(row / 3, row % 3)])
}

/// A measured pair of points, for the covariance of a fitted `F`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupedObservation {
    /// The pair, with the scale of its robust loss, px.
    pub observation: Observation,
    /// Standard deviation of the pair, px. It includes errors that the loss does not know.
    pub deviation: f64,
    /// Number of the group of pairs that share their error. All pairs of a group count as one.
    pub group: usize,
}

/// Returns the covariance of the nine entries of a fitted `F` with Frobenius norm 1, row by row. The
/// errors of one group are taken as equal and those of different groups as independent, so more pairs
/// of one group do not make `F` more precise.
///
/// The loss is the Cauchy cost of [`fit_fundamental`] with a scale of 1. `None` when the pairs do not
/// determine all numbers: seven, or five for known `calibrations` of the cameras.
pub fn grouped_covariance(
    f: &FundamentalMatrix,
    grouped: &[GroupedObservation],
    calibrations: Option<&[Matrix3<f64>; 2]>,
) -> Option<Matrix9> {
    let observations: Vec<Observation> = grouped.iter().map(|t| t.observation).collect();
    let conditioning = Conditioning::new(&observations);
    match calibrations {
        Some(known) => covariance(&conditioning.posed(f, known)?, &conditioning, grouped),
        None => covariance(&Orthonormal::new(&conditioning.conditioned(f.matrix()))?, &conditioning, grouped),
    }
}

fn covariance<const N: usize>(
    representation: &impl Representation<N>,
    conditioning: &Conditioning,
    grouped: &[GroupedObservation],
) -> Option<Matrix9> {
    let matrix = representation.matrix();
    let by_entries = by_entries(&representation.derivatives());
    let groups = grouped.iter().map(|t| t.group).max()? + 1;
    let mut sizes = vec![0.0; groups];
    for t in grouped {
        sizes[t.group] += 1.0;
    }
    let mut information = SMatrix::<f64, N, N>::zeros();
    for GroupedObservation { observation, deviation, group } in grouped {
        let x1 = conditioning.to[0] * observation.pair.point1.to_homogeneous();
        let x2 = conditioning.to[1] * observation.pair.point2.to_homogeneous();
        let (l2, l1) = (matrix * x1, matrix.tr_mul(&x2));
        let square = l2.xy().norm_squared() + l1.xy().norm_squared();
        if square < 1e-28 {
            continue;
        }
        let to_pixels = 1.0 / (conditioning.to[0][(0, 0)] * square.sqrt());
        let n = x2.dot(&l2);
        let residual = n * to_pixels / observation.sigma;
        let c = n / square;
        let by = SVector::<f64, 9>::from_fn(|k, _| {
            let (i, j) = (k / 3, k % 3);
            let first = if i < 2 { l2[i] * x1[j] } else { 0.0 };
            let second = if j < 2 { l1[j] * x2[i] } else { 0.0 };
            to_pixels / deviation * (x2[i] * x1[j] - c * (first + second))
        });
        let by = by_entries.tr_mul(&by);
        information += by * by.transpose() / ((1.0 + residual * residual) * sizes[*group]);
    }
    let covariance = information.cholesky()?.inverse();
    let jacobian = unit_entries(conditioning, representation);
    Some(jacobian * covariance * jacobian.transpose())
}

/// Maximum number of steps. A fit that starts within some pixels converges in fewer than ten.
const ITERATIONS: usize = 25;

/// Number of observations processed together.
const LANES: usize = 8;

/// The observations in coordinates near 1: moved to the centroid of each image, with one scale for
/// both images.
struct Conditioning {
    to: [Matrix3<f64>; 2],
    blocks: Vec<ObservationBlock>,
}

/// A group of observations, laid out for vector instructions.
#[derive(Clone)]
struct ObservationBlock {
    point1: [[f64; LANES]; 2],
    point2: [[f64; LANES]; 2],
    /// Inverse of σ in conditioned units; 0 in lanes without an observation.
    weight: [f64; LANES],
}

impl Conditioning {
    fn new(observations: &[Observation]) -> Self {
        let n = observations.len() as f64;
        let points: [fn(&Observation) -> Vector3<f64>; 2] =
            [|o| o.pair.point1.to_homogeneous(), |o| o.pair.point2.to_homogeneous()];
        let [centre1, centre2] =
            points.map(|of| observations.iter().fold(Vector3::zeros(), |sum, o| sum + of(o)) / n);
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
        let to = [centre1, centre2].map(|c| scaling(s, -s * c.x, -s * c.y));
        let conditioned = |chunk: &[Observation]| {
            // Lanes beyond the last observation repeat it with weight 0.
            let of = |lane: usize| &chunk[lane.min(chunk.len() - 1)];
            let coordinate = |image: usize, axis: usize| {
                std::array::from_fn(|lane| {
                    let point = if image == 0 { of(lane).pair.point1 } else { of(lane).pair.point2 };
                    s * point[axis] + to[image][(axis, 2)]
                })
            };
            ObservationBlock {
                point1: [coordinate(0, 0), coordinate(0, 1)],
                point2: [coordinate(1, 0), coordinate(1, 1)],
                weight: std::array::from_fn(|lane| chunk.get(lane).map_or(0.0, |o| 1.0 / (s * o.sigma))),
            }
        };
        Self { to, blocks: observations.chunks(LANES).map(conditioned).collect() }
    }

    fn conditioned(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        let inverse = |m: &Matrix3<f64>| {
            let s = m[(0, 0)];
            scaling(1.0 / s, -m[(0, 2)] / s, -m[(1, 2)] / s)
        };
        inverse(&self.to[1]).transpose() * f * inverse(&self.to[0])
    }

    fn in_pixels(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        self.to[1].transpose() * f * self.to[0]
    }

    /// Returns the essential matrix nearest to `f` for these coordinates.
    fn posed(&self, f: &FundamentalMatrix, calibrations: &[Matrix3<f64>; 2]) -> Option<Posed> {
        Posed::new(&self.conditioned(f.matrix()), &[0, 1].map(|k| self.to[k] * calibrations[k]))
    }

    /// Returns the robust cost, its gradient and its Gauss–Newton Hessian in the steps of the numbers.
    fn normal_equations<const N: usize>(
        &self,
        representation: &impl Representation<N>,
        scale: f64,
    ) -> Option<(f64, SVector<f64, N>, SMatrix<f64, N, N>)> {
        let f = representation.matrix();
        let by_entries = by_entries(&representation.derivatives());
        let sums = sums(&self.blocks, &std::array::from_fn(|k| f[(k / 3, k % 3)]), scale);
        let gradient = by_entries.tr_mul(&SVector::<f64, 9>::from(sums.gradient));
        let entry = |row: usize, column: usize| sums.hessian[row.max(column)][row.min(column)];
        let hessian = by_entries.tr_mul(&(Matrix9::from_fn(entry) * by_entries));
        let cost = scale * scale * sums.cost;
        (cost.is_finite() && hessian.iter().all(|v| v.is_finite())).then_some((cost, gradient, hessian))
    }
}

/// Sums over all observations, by the nine entries of the matrix, row by row.
struct Sums {
    /// `Σ ln(1 + r²/s²)`.
    cost: f64,
    gradient: [f64; 9],
    /// Lower triangle with the diagonal, row by row.
    hessian: [[f64; 9]; 9],
}

/// Blocks whose `1 + r²/s²` are multiplied before one logarithm is taken. The product of so few
/// stays finite.
const MULTIPLIED: usize = 4;

/// Sums cost, gradient and Gauss–Newton Hessian over all observations. For lines `l2 = F x1`,
/// `l1 = Fᵀ x2`, the residual is `r = n / d` with `n = x2ᵀ F x1` and `d² = |l2|² + |l1|²` (first
/// two coordinates). Its derivative with respect to an entry is
///
/// ```text
///     d · ∂r/∂F(i,j) = x2(i) x1(j) − n/d² · (l2(i) x1(j) [i < 2] + x2(i) l1(j) [j < 2]).
/// ```
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn sums(blocks: &[ObservationBlock], f: &[f64; 9], scale: f64) -> Sums {
    type Lanes = [f64; LANES];
    let inverse_square = 1.0 / (scale * scale);
    let mut cost = 0.0;
    let (mut gradient, mut hessian) = ([[0.0; LANES]; 9], [[[0.0; LANES]; 9]; 9]);
    for blocks in blocks.chunks(MULTIPLIED) {
        // The product minus 1 keeps the contribution of small residuals.
        let mut product = [0.0; LANES];
        for ObservationBlock { point1: [x1, y1], point2: [x2, y2], weight } in blocks {
            // Derivatives by the entries, the residual, and the weight after the robust loss.
            let mut by: [Lanes; 9] = [[0.0; LANES]; 9];
            let (mut residual, mut left) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let (a2, b2) = (f[0] * x1[k] + f[1] * y1[k] + f[2], f[3] * x1[k] + f[4] * y1[k] + f[5]);
                let (a1, b1) = (f[0] * x2[k] + f[3] * y2[k] + f[6], f[1] * x2[k] + f[4] * y2[k] + f[7]);
                let n = a2 * x2[k] + b2 * y2[k] + f[6] * x1[k] + f[7] * y1[k] + f[8];
                let square = a2 * a2 + b2 * b2 + a1 * a1 + b1 * b1;
                // With both points at the epipoles the residual is undefined.
                let inverse = if square < 1e-28 { 0.0 } else { 1.0 / square };
                let (c, s) = (n * inverse, inverse.sqrt() * weight[k]);
                residual[k] = n * s;
                let ratio = residual[k] * residual[k] * inverse_square;
                // Cauchy: ρ = s² ln(1 + r²/s²), weight 1/(1 + r²/s²).
                product[k] += ratio * (1.0 + product[k]);
                left[k] = 1.0 / (1.0 + ratio);
                let (u, v) = (s * (x2[k] - c * a2), s * (y2[k] - c * b2));
                let (a, b) = (s * c * a1, s * c * b1);
                by[0][k] = u * x1[k] - a * x2[k];
                by[1][k] = u * y1[k] - b * x2[k];
                by[2][k] = u;
                by[3][k] = v * x1[k] - a * y2[k];
                by[4][k] = v * y1[k] - b * y2[k];
                by[5][k] = v;
                by[6][k] = s * x1[k] - a;
                by[7][k] = s * y1[k] - b;
                by[8][k] = s;
            }
            for i in 0..9 {
                let mut weighted = [0.0; LANES];
                for k in 0..LANES {
                    weighted[k] = by[i][k] * left[k];
                    gradient[i][k] += weighted[k] * residual[k];
                }
                for j in 0..=i {
                    for k in 0..LANES {
                        hessian[i][j][k] += weighted[k] * by[j][k];
                    }
                }
            }
        }
        for product in product {
            cost += product.ln_1p();
        }
    }
    // Loops, because closures passed to the library are not compiled for the instruction set.
    let mut sums = Sums { cost, gradient: [0.0; 9], hessian: [[0.0; 9]; 9] };
    for i in 0..9 {
        sums.gradient[i] = total(&gradient[i]);
        for (sum, lanes) in sums.hessian[i].iter_mut().zip(&hessian[i]).take(i + 1) {
            *sum = total(lanes);
        }
    }
    sums
}

#[inline]
fn total(lanes: &[f64; LANES]) -> f64 {
    let mut sum = 0.0;
    for lane in lanes {
        sum += lane;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{RandomScene, example_fundamental, example_seen};
    use crate::geometry::symmetric_epipolar_distance;
    use rand::{RngExt, SeedableRng};

    fn scene(count: usize) -> (FundamentalMatrix, Vec<PointPair>) {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let mut near = |low: f64, high: f64| rng.random_range(low..high);
        let mut seen = || example_seen(near(-2.0, 2.0), near(-1.5, 1.5), near(4.0, 8.0));
        (example_fundamental(), (0..count).map(|_| seen()).collect())
    }

    fn observed(pairs: &[PointPair], sigma: f64) -> Vec<Observation> {
        pairs.iter().map(|pair| Observation { pair: *pair, sigma }).collect()
    }

    fn mean(f: &FundamentalMatrix, pairs: &[PointPair]) -> f64 {
        pairs.iter().map(|p| symmetric_epipolar_distance(f, p)).sum::<f64>() / pairs.len() as f64
    }

    /// Returns a start that is some pixels off.
    fn disturbed(f: &FundamentalMatrix) -> FundamentalMatrix {
        let moved = |s: f64| Matrix3::new(1.0, s * 0.004, 4.0 * s, -s * 0.004, 1.0, -3.0 * s, 0.0, 0.0, 1.0);
        FundamentalMatrix::from_rank_two(moved(1.0).transpose() * f.matrix() * moved(-1.0)).unwrap()
    }

    #[test]
    fn exact_matches_give_the_exact_matrix() {
        let (f, pairs) = scene(30);
        let start = disturbed(&f);
        assert!(mean(&start, &pairs) > 2.0);
        let result = fit_fundamental(&start, &observed(&pairs, 1.0), 2.0).unwrap().fundamental;
        assert!(mean(&result, &pairs) < 1e-6, "{}", mean(&result, &pairs));
    }

    #[test]
    fn a_third_of_wrong_matches_does_not_matter() {
        let (f, pairs) = scene(90);
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(6);
        let mut observations = observed(&pairs, 1.0);
        for wrong in observations.iter_mut().step_by(3) {
            wrong.pair.point2.x += rng.random_range(-80.0..80.0);
            wrong.pair.point2.y += rng.random_range(-80.0..80.0);
        }
        let result = fit_fundamental(&disturbed(&f), &observations, 1.5).unwrap().fundamental;
        assert!(mean(&result, &pairs) < 0.1, "{}", mean(&result, &pairs));
    }

    #[test]
    fn the_covariance_predicts_the_scatter_of_the_epipolar_lines() {
        let (f, pairs) = scene(60);
        let mut noise = RandomScene::new(9);
        let probe = PointPair::new(150.0, 420.0, 160.0, 415.0);
        let on_line = f.line2_from_point1(probe.point1).unwrap().foot(probe.point2);
        let (mut squares, mut predicted, mut of_groups, runs) = (0.0, 0.0, 0.0, 200);
        for _ in 0..runs {
            let sigma = 0.5;
            let observations = observed(&noise.disturbed(&pairs, sigma), sigma);
            let result = fit_fundamental(&f, &observations, 4.0).unwrap();
            let line = result.fundamental.line2_from_point1(probe.point1).unwrap();
            squares += line.signed_distance(on_line).powi(2);
            let l = result.fundamental.matrix() * probe.point1.to_homogeneous();
            let (x1, x2) = (probe.point1.to_homogeneous(), on_line.to_homogeneous());
            let row = SVector::<f64, 9>::from_fn(|k, _| x2[k / 3] * x1[k % 3]) / l.xy().norm();
            predicted += row.dot(&(result.covariance.unwrap() * row));
            // With a loss that hardly weighs, and each pair a group of its own.
            let each = |(group, o): (usize, &Observation)| GroupedObservation {
                observation: Observation { sigma: 10.0 * sigma, ..*o },
                deviation: sigma,
                group,
            };
            let grouped: Vec<GroupedObservation> = observations.iter().enumerate().map(each).collect();
            of_groups += row.dot(&(grouped_covariance(&result.fundamental, &grouped, None).unwrap() * row));
        }
        for predicted in [predicted, of_groups] {
            let ratio = (squares / predicted).sqrt();
            assert!((0.8..1.25).contains(&ratio), "measured over predicted deviation {ratio}");
        }
    }

    #[test]
    fn pairs_of_one_group_tell_as_much_as_one() {
        let (f, pairs) = scene(60);
        let of = |copies: usize, deviation: f64| {
            let grouped: Vec<GroupedObservation> = (0..60 * copies)
                .map(|k| GroupedObservation {
                    observation: Observation { pair: pairs[k % 60], sigma: 1.0 },
                    deviation,
                    group: k % 60,
                })
                .collect();
            grouped_covariance(&f, &grouped, None).unwrap()
        };
        let once = of(1, 0.5);
        assert!((of(5, 0.5) - once).norm() < 1e-9 * once.norm());
        assert!((of(1, 1.0) - once * 4.0).norm() < 1e-9 * once.norm());
        assert!(grouped_covariance(&f, &[], None).is_none());
    }

    #[test]
    fn too_few_matches_are_refused() {
        let (f, pairs) = scene(6);
        assert!(fit_fundamental(&f, &observed(&pairs, 1.0), 1.0).is_none());
    }
}
