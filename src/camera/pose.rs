//! Relative pose of two calibrated cameras: from `F`, refined on matches, with its uncertainty.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Matrix5, Matrix6, Rotation3, SMatrix, SVector, Vector3};
use serde::Serialize;

use crate::geometry::{Frame, FundamentalMatrix, PointPair, REGIONS, deviation, median, region};

/// Pose of camera 2 in the coordinates of camera 1: `x2 = R x1 + t`. The length of `t` is 1, because
/// two images do not tell it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RelativePose {
    /// Rotation `R`.
    pub rotation: Rotation3<f64>,
    /// Unit vector `t`.
    pub translation: Vector3<f64>,
}

/// A relative pose fitted to matches.
#[derive(Debug, Clone)]
pub struct PoseFit {
    /// The pose.
    pub pose: RelativePose,
    /// Fundamental matrix of the pose and the calibration matrices.
    pub fundamental: FundamentalMatrix,
    /// Half of the matches have a smaller Sampson distance, px.
    pub noise: f64,
    /// Number of matches.
    pub matches: usize,
    /// Number of matches whose scene point lies in front of both cameras.
    pub in_front: usize,
    /// Median angle between the rays of a match, radians.
    pub parallax: f64,
    /// Standard deviations; `None` if the matches do not determine the pose.
    pub uncertainty: Option<PoseUncertainty>,
}

/// Standard deviations of a relative pose, radians. The matches of each of nine regions of image 1
/// are assumed to share their error, so the deviations are too large where the errors are
/// independent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PoseUncertainty {
    /// Standard deviation of the largest component of the rotation.
    pub rotation: f64,
    /// Standard deviation of the largest component of the direction of the translation.
    pub translation: f64,
    /// Covariance of the rotation vector of a small turn after `R`, and of the translation across
    /// its direction, along two unit vectors.
    #[serde(skip)]
    pub covariance: Matrix5<f64>,
}

/// Difference between a given pose and a fitted one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PoseDifference {
    /// Angle between the rotations, radians.
    pub rotation: f64,
    /// Angle between the directions of the translations, radians.
    pub translation: f64,
    /// Standard deviations of the fitted pose.
    pub uncertainty: PoseUncertainty,
    /// Whether the difference is more than chance: outside the 95 % region of the fitted pose.
    pub is_significant: bool,
}

/// 95 % quantile of χ² with the five degrees of freedom of a pose.
const CHI_SQUARE: f64 = 11.07;

/// Fewest matches of a pose: twice its five numbers.
const FEWEST: usize = 10;
/// Steps of the refinement.
const STEPS: usize = 30;
/// Smallest scale of the noise, px: quantisation of matched positions.
const LEAST_NOISE: f64 = 0.01;
/// Change of a parameter for numerical derivatives, radians.
const DIFFERENCE: f64 = 1e-6;

/// Returns the angle of a rotation, radians. Rounding may take the trace of the identity beyond 3.
fn angle(rotation: &Rotation3<f64>) -> f64 {
    (0.5 * (rotation.matrix().trace() - 1.0)).clamp(-1.0, 1.0).acos()
}

impl RelativePose {
    /// Returns the angle of the rotation, radians.
    pub fn angle(&self) -> f64 {
        angle(&self.rotation)
    }

    /// Returns the essential matrix `[t]× R`.
    pub fn essential(&self) -> Matrix3<f64> {
        self.translation.cross_matrix() * self.rotation.matrix()
    }

    /// Returns the fundamental matrix of the pose for two calibration matrices.
    pub fn fundamental(&self, calibrations: &[Matrix3<f64>; 2]) -> Option<FundamentalMatrix> {
        let [inverse1, inverse2] = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
        FundamentalMatrix::from_rank_two(inverse2.transpose() * self.essential() * inverse1)
    }

    /// Takes a fundamental matrix apart (Hartley & Zisserman, §9.6.2). Four poses fit; returns the pose
    /// with most matches in front of both cameras.
    pub fn from_fundamental(
        fundamental: &FundamentalMatrix,
        calibrations: &[Matrix3<f64>; 2],
        matches: &[PointPair],
    ) -> Option<Self> {
        let essential = calibrations[1].transpose() * fundamental.matrix() * calibrations[0];
        let svd = essential.svd(true, true);
        let (mut u, mut v) = (svd.u?, svd.v_t?.transpose());
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let sorted = |m: &Matrix3<f64>| Matrix3::from_columns(&order.map(|k| m.column(k)));
        (u, v) = (sorted(&u), sorted(&v));
        u *= u.determinant().signum();
        v *= v.determinant().signum();
        let turn = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let translation: Vector3<f64> = u.column(2).into();
        let rays = rays(calibrations, matches)?;
        let poses = [turn, turn.transpose()].into_iter().flat_map(|turn| {
            let rotation = Rotation3::from_matrix_unchecked(u * turn * v.transpose());
            [translation, -translation].map(|translation| Self { rotation, translation })
        });
        poses.max_by_key(|pose| pose.in_front(&rays))
    }

    /// Returns the depths of a match along its rays in units of the baseline, from the two closest
    /// points of the rays. `None` for parallel rays.
    pub fn depths(&self, rays: &[Vector3<f64>; 2]) -> Option<[f64; 2]> {
        // λ1 R r1 + t = λ2 r2 in the least-squares sense.
        let [a, b] = [self.rotation * rays[0], rays[1]];
        let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
        let determinant = aa * bb - ab * ab;
        let (at, bt) = (a.dot(&self.translation), b.dot(&self.translation));
        (determinant > 1e-14 * aa * bb)
            .then(|| [(ab * bt - bb * at) / determinant, (aa * bt - ab * at) / determinant])
    }

    /// Returns the scene point of a match in the coordinates of camera 1, in units of the baseline:
    /// the middle of the two closest points of its rays.
    pub fn triangulated(&self, rays: &[Vector3<f64>; 2]) -> Option<Vector3<f64>> {
        let [first, second] = self.depths(rays)?;
        let from2 = self.rotation.inverse() * (rays[1] * second - self.translation);
        Some(0.5 * (rays[0] * first + from2))
    }

    /// Returns the scene point of each match as by [`Self::triangulated`]; `None` for points that are not
    /// in front of both cameras.
    pub fn scene_points(
        &self,
        calibrations: &[Matrix3<f64>; 2],
        matches: &[PointPair],
    ) -> Vec<Option<Vector3<f64>>> {
        let Some(rays) = rays(calibrations, matches) else { return vec![None; matches.len()] };
        rays.iter().map(|rays| self.triangulated(rays).filter(|_| self.sees(rays))).collect()
    }

    /// Returns the place of camera 2 in the coordinates of camera 1.
    pub fn position2(&self) -> Vector3<f64> {
        self.rotation.inverse() * -self.translation
    }

    /// Returns the small change that turns this pose into another, like the numbers of
    /// [`PoseUncertainty::covariance`].
    fn change_to(&self, other: &Self) -> SVector<f64, 5> {
        let turn = (other.rotation * self.rotation.inverse()).scaled_axis();
        let along = other.translation.dot(&self.translation).max(f64::MIN_POSITIVE);
        let across = across(&self.translation).map(|axis| other.translation.dot(&axis) / along);
        SVector::from([turn.x, turn.y, turn.z, across[0], across[1]])
    }

    /// Returns whether the scene point of two rays lies in front of both cameras.
    fn sees(&self, rays: &[Vector3<f64>; 2]) -> bool {
        self.depths(rays).is_some_and(|depths| depths.iter().all(|depth| *depth > 0.0))
    }

    fn in_front(&self, rays: &[[Vector3<f64>; 2]]) -> usize {
        rays.iter().filter(|rays| self.sees(rays)).count()
    }

    /// Returns the pose after a small change: a turn after `R`, and a step of `t` across its
    /// direction.
    fn moved(&self, change: &SVector<f64, 5>) -> Self {
        let turn = Rotation3::from_scaled_axis(change.fixed_rows::<3>(0).into_owned());
        let [first, second] = across(&self.translation);
        let translation = (self.translation + first * change[3] + second * change[4]).normalize();
        Self { rotation: turn * self.rotation, translation }
    }
}

impl PoseFit {
    /// Returns the covariance of six numbers: the rotation vector of a small turn after `R`, radians,
    /// and the three entries of `t`. The turn `ω` gives `exp([ω]×) R`. The rank is 5, because the
    /// length of `t` is 1. `None` without uncertainty.
    pub fn covariance(&self) -> Option<Matrix6<f64>> {
        let mut entries = SMatrix::<f64, 6, 5>::identity();
        let [first, second] = across(&self.pose.translation);
        entries.fixed_view_mut::<3, 2>(3, 3).copy_from(&SMatrix::from_columns(&[first, second]));
        Some(entries * self.uncertainty?.covariance * entries.transpose())
    }

    /// Adds a change of the calibration by one standard deviation to the uncertainty.
    pub(super) fn widened(&mut self, changed: &RelativePose) {
        let change = self.pose.change_to(changed);
        self.uncertainty =
            self.uncertainty.map(|known| PoseUncertainty::of(known.covariance + change * change.transpose()));
    }

    /// Compares the fitted pose with another. `None` without uncertainty.
    pub fn difference(&self, other: &RelativePose) -> Option<PoseDifference> {
        let uncertainty = self.uncertainty?;
        let change = self.pose.change_to(other);
        let translation = self.pose.translation.angle(&other.translation);
        let square = change.dot(&uncertainty.covariance.cholesky()?.solve(&change));
        Some(PoseDifference {
            rotation: angle(&self.pose.rotation.rotation_to(&other.rotation)),
            translation,
            uncertainty,
            is_significant: square > CHI_SQUARE || translation > 0.5 * PI,
        })
    }
}

impl PoseUncertainty {
    fn of(covariance: Matrix5<f64>) -> Self {
        let rotation: Matrix3<f64> = covariance.fixed_view::<3, 3>(0, 0).into();
        let translation: SMatrix<f64, 2, 2> = covariance.fixed_view::<2, 2>(3, 3).into();
        let largest = |eigenvalue: f64| eigenvalue.max(0.0).sqrt();
        Self {
            rotation: largest(rotation.symmetric_eigenvalues().max()),
            translation: largest(translation.symmetric_eigenvalues().max()),
            covariance,
        }
    }
}

/// Refines the pose of a fundamental matrix on matches: five numbers, Sampson distances in pixels
/// with a Cauchy loss whose scale is the median distance.
///
/// `calibrations` belong to images without distortion and count as exact; `frame1` is the size of
/// image 1. `None` for fewer than 10 matches, or without a pose.
pub(super) fn fit_pose(
    fundamental: &FundamentalMatrix,
    calibrations: &[Matrix3<f64>; 2],
    matches: &[PointPair],
    frame1: Frame,
) -> Option<PoseFit> {
    if matches.len() < FEWEST {
        return None;
    }
    let inverses = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
    let matrix = |pose: &RelativePose| inverses[1].transpose() * pose.essential() * inverses[0];
    let residuals = |pose: &RelativePose| -> Vec<f64> {
        let matrix = matrix(pose);
        matches.iter().map(|pair| signed_distance(&matrix, pair)).collect()
    };
    let mut pose = RelativePose::from_fundamental(fundamental, calibrations, matches)?;
    let mut found = residuals(&pose);
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let scale = scale(&found);
        let cost = |found: &[f64]| found.iter().map(|r| (1.0 + (r / scale).powi(2)).ln()).sum::<f64>();
        let (information, gradient) = normal_equations(&pose, &found, scale, &residuals);
        let mut damped = information;
        for k in 0..5 {
            damped[(k, k)] *= 1.0 + damping;
        }
        let Some(step) = damped.cholesky().map(|cholesky| -cholesky.solve(&gradient)) else { break };
        let next = pose.moved(&step);
        let after = residuals(&next);
        if cost(&after) < cost(&found) {
            (pose, found) = (next, after);
            damping = (damping * 0.1f64).max(1e-12);
            if step.norm() < 1e-12 {
                break;
            }
        } else {
            damping *= 100.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let rays = rays(calibrations, matches)?;
    let angle = |rays: &[Vector3<f64>; 2]| (pose.rotation * rays[0]).angle(&rays[1]);
    Some(PoseFit {
        fundamental: FundamentalMatrix::from_rank_two(matrix(&pose))?,
        noise: median(found.iter().map(|r| r.abs())),
        matches: matches.len(),
        in_front: pose.in_front(&rays),
        parallax: median(rays.iter().map(angle)),
        uncertainty: uncertainty(&pose, &found, matches, frame1, &residuals),
        pose,
    })
}

/// Returns the uncertainty of a fitted pose. All matches of a region count as one, as in the
/// covariance of `F`.
fn uncertainty(
    pose: &RelativePose,
    found: &[f64],
    matches: &[PointPair],
    frame1: Frame,
    residuals: &impl Fn(&RelativePose) -> Vec<f64>,
) -> Option<PoseUncertainty> {
    let scale = scale(found);
    let deviation = deviation(scale, frame1);
    let derivatives = derivatives(pose, residuals);
    let regions: Vec<usize> = matches.iter().map(|pair| region(pair.point1, frame1)).collect();
    let mut sizes = [0.0; REGIONS];
    for region in &regions {
        sizes[*region] += 1.0;
    }
    let mut information = Matrix5::zeros();
    for (k, r) in found.iter().enumerate() {
        let by = SVector::<f64, 5>::from_fn(|n, _| derivatives[n][k] / deviation);
        information += by * by.transpose() / ((1.0 + (r / scale).powi(2)) * sizes[regions[k]]);
    }
    Some(PoseUncertainty::of(information.cholesky()?.inverse()))
}

/// Returns the weighted normal equations of a step.
fn normal_equations(
    pose: &RelativePose,
    found: &[f64],
    scale: f64,
    residuals: &impl Fn(&RelativePose) -> Vec<f64>,
) -> (Matrix5<f64>, SVector<f64, 5>) {
    let derivatives = derivatives(pose, residuals);
    let (mut information, mut gradient) = (Matrix5::zeros(), SVector::<f64, 5>::zeros());
    for (k, r) in found.iter().enumerate() {
        let by = SVector::<f64, 5>::from_fn(|n, _| derivatives[n][k]);
        let weight = 1.0 / (1.0 + (r / scale).powi(2));
        information += by * by.transpose() * weight;
        gradient += by * (weight * r);
    }
    (information, gradient)
}

/// Returns the derivatives of all residuals by each of the five numbers.
fn derivatives(pose: &RelativePose, residuals: &impl Fn(&RelativePose) -> Vec<f64>) -> [Vec<f64>; 5] {
    std::array::from_fn(|n| {
        let at = |by: f64| residuals(&pose.moved(&SVector::from_fn(|k, _| if k == n { by } else { 0.0 })));
        at(DIFFERENCE).iter().zip(at(-DIFFERENCE)).map(|(a, b)| (a - b) / (2.0 * DIFFERENCE)).collect()
    })
}

/// Returns the scale of Cauchy noise: its median.
fn scale(residuals: &[f64]) -> f64 {
    median(residuals.iter().map(|r| r.abs())).max(LEAST_NOISE)
}

/// Returns the Sampson distance with its sign, px.
fn signed_distance(matrix: &Matrix3<f64>, pair: &PointPair) -> f64 {
    let [x1, x2] = [pair.point1.to_homogeneous(), pair.point2.to_homogeneous()];
    let (l2, l1) = (matrix * x1, matrix.tr_mul(&x2));
    x2.dot(&l2) / (l2.xy().norm_squared() + l1.xy().norm_squared()).sqrt().max(f64::MIN_POSITIVE)
}

/// Returns two unit vectors across a direction.
fn across(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let axis = Vector3::ith(direction.iamin(), 1.0);
    let first = direction.cross(&axis).normalize();
    [first, direction.cross(&first).normalize()]
}

fn rays(calibrations: &[Matrix3<f64>; 2], matches: &[PointPair]) -> Option<Vec<[Vector3<f64>; 2]>> {
    let [first, second] = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
    let of = |pair: &PointPair| {
        [
            (first * pair.point1.to_homogeneous()).normalize(),
            (second * pair.point2.to_homogeneous()).normalize(),
        ]
    };
    Some(matches.iter().map(of).collect())
}
