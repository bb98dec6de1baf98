//! The essential matrix of two known cameras by five numbers: a turn and a direction.
//!
//! `F = A2ᵀ [t]× R A1` with the inverses `A` of the calibration matrices. A step is a small turn after `R`, and
//! a step of `t` along two directions across it.

use nalgebra::{Matrix2, Matrix3, Rotation3, SVector, Vector2, Vector3};

use super::FundamentalMatrix;
use super::representation::{Matrix9, Representation};

/// A fundamental matrix of two known cameras.
#[derive(Debug, Clone)]
pub(super) struct Posed {
    rotation: Rotation3<f64>,
    translation: Vector3<f64>,
    inverses: [Matrix3<f64>; 2],
}

impl Posed {
    /// Returns the matrix nearest to `f`, for these calibration matrices. Of the four poses of a matrix (Hartley &
    /// Zisserman, §9.6.2) any is taken: their matrices are the same.
    pub(super) fn new(f: &Matrix3<f64>, calibrations: &[Matrix3<f64>; 2]) -> Option<Self> {
        let inverses = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
        let essential = calibrations[1].transpose() * f * calibrations[0];
        let svd = (essential / essential.norm()).try_svd(true, true, f64::EPSILON, 200)?;
        let (u, v) = (svd.u?, svd.v_t?.transpose());
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let [u, v] = [u, v].map(|m| Matrix3::from_columns(&order.map(|k| m.column(k).into_owned())));
        let turn = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let rotation = u * turn * v.transpose();
        let rotation = Rotation3::from_matrix_unchecked(rotation * rotation.determinant().signum());
        Some(Self { rotation, translation: u.column(2).into_owned(), inverses })
    }

    fn in_coordinates(&self, essential: &Matrix3<f64>) -> Matrix3<f64> {
        self.inverses[1].transpose() * essential * self.inverses[0]
    }
}

/// Returns how much a fundamental matrix with this covariance (of norm 1, row by row) contradicts two calibrations:
/// χ² with two degrees of freedom. `posed` is the essential matrix that is compared.
///
/// Between the planes across both epipoles of `posed`, an essential matrix turns and scales, `m11 = m22` and
/// `m12 = −m21`, or does so after a reflection. Both conditions are linear in the entries. `None` for a covariance
/// that does not determine them.
pub(crate) fn calibration_chi_square(
    f: &FundamentalMatrix,
    covariance: &Matrix9,
    posed: &FundamentalMatrix,
    calibrations: &[Matrix3<f64>; 2],
) -> Option<f64> {
    let posed = Posed::new(posed.matrix(), calibrations)?;
    let (side2, side1) =
        (across(&posed.translation), across(&(posed.rotation.inverse() * posed.translation)));
    let f = f.matrix() / f.matrix().norm();
    // Entry (i, j) of the map is the sum over the entries of F times these.
    let by_entries =
        |i: usize, j: usize| (calibrations[1] * side2[i]) * (calibrations[0] * side1[j]).transpose();
    let of = |m: Matrix3<f64>| SVector::<f64, 9>::from_fn(|k, _| m[(k / 3, k % 3)]);
    let entries = of(f);
    let [m11, m12, m21, m22] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| of(by_entries(i, j)));
    let value = |by: &SVector<f64, 9>| by.dot(&entries);
    let is_turned = (value(&m11) * value(&m22) - value(&m12) * value(&m21)) > 0.0;
    let conditions = if is_turned { [m11 - m22, m12 + m21] } else { [m11 + m22, m12 - m21] };
    let off = Vector2::new(value(&conditions[0]), value(&conditions[1]));
    let spread = Matrix2::from_fn(|i, j| conditions[i].dot(&(covariance * conditions[j])));
    Some(off.dot(&spread.cholesky()?.solve(&off)))
}

/// Returns two unit vectors across a unit vector.
fn across(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let first = direction.cross(&Vector3::ith(direction.iamin(), 1.0)).normalize();
    [first, direction.cross(&first)]
}

impl Representation<5> for Posed {
    fn matrix(&self) -> Matrix3<f64> {
        self.in_coordinates(&(self.translation.cross_matrix() * self.rotation.matrix()))
    }

    fn derivatives(&self) -> [Matrix3<f64>; 5] {
        let (rotation, across) = (self.rotation.matrix(), across(&self.translation));
        std::array::from_fn(|k| {
            let essential = match k {
                0..3 => self.translation.cross_matrix() * Vector3::ith(k, 1.0).cross_matrix() * rotation,
                _ => across[k - 3].cross_matrix() * rotation,
            };
            self.in_coordinates(&essential)
        })
    }

    fn moved(&self, step: &SVector<f64, 5>) -> Self {
        let turn = Rotation3::new(Vector3::new(step[0], step[1], step[2]));
        let [first, second] = across(&self.translation);
        let translation = (self.translation + first * step[3] + second * step[4]).normalize();
        Self { rotation: turn * self.rotation, translation, inverses: self.inverses }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calibration(focal: f64) -> Matrix3<f64> {
        Matrix3::new(focal, 0.0, 320.0, 0.0, 1.02 * focal, 240.0, 0.0, 0.0, 1.0)
    }

    fn posed() -> Posed {
        let calibrations = [calibration(500.0), calibration(700.0)];
        let rotation = Rotation3::new(Vector3::new(0.1, -0.3, 0.05));
        let translation = Vector3::new(0.8, -0.2, 0.4).normalize();
        let inverses = calibrations.map(|k| k.try_inverse().unwrap());
        let f = inverses[1].transpose() * translation.cross_matrix() * rotation.matrix() * inverses[0];
        let found = Posed::new(&f, &calibrations).unwrap();
        let off = |sign: f64| (found.matrix() / found.matrix().norm() - f * sign / f.norm()).norm();
        assert!(off(1.0).min(off(-1.0)) < 1e-12);
        found
    }

    #[test]
    fn a_calibration_is_contradicted_by_as_much_as_the_matrix_is_off() {
        let posed = posed();
        let calibrations = [calibration(500.0), calibration(700.0)];
        let f = FundamentalMatrix::from_rank_two(posed.matrix()).unwrap();
        // Errors of the entries in proportion to what they move.
        let covariance = Matrix9::from_fn(|i, j| {
            let size = |k: usize| 1e-3 * f.matrix()[(k / 3, k % 3)].abs() / f.matrix().norm() + 1e-9;
            if i == j { size(i).powi(2) } else { 0.0 }
        });
        let chi = |calibrations: &[Matrix3<f64>; 2]| {
            let nearest = Posed::new(f.matrix(), calibrations).unwrap().matrix();
            let nearest = FundamentalMatrix::from_rank_two(nearest).unwrap();
            calibration_chi_square(&f, &covariance, &nearest, calibrations).unwrap()
        };
        assert!(chi(&calibrations) < 1e-6, "{}", chi(&calibrations));
        let small = chi(&[calibration(505.0), calibration(700.0)]);
        let large = chi(&[calibration(550.0), calibration(700.0)]);
        assert!(small > 0.0 && large > 20.0 * small, "{small} {large}");
    }

    #[test]
    fn derivatives_are_those_of_small_steps() {
        let posed = posed();
        for (k, derivative) in posed.derivatives().iter().enumerate() {
            let mut step = SVector::<f64, 5>::zeros();
            step[k] = 1e-6;
            let measured = (posed.moved(&step).matrix() - posed.moved(&-step).matrix()) / 2e-6;
            assert!(
                (measured - derivative).norm() < 1e-7 * posed.matrix().norm().max(derivative.norm()),
                "{k}"
            );
        }
    }
}
