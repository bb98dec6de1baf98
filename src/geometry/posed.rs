//! The essential matrix of two known cameras by five numbers: a turn and a direction.
//!
//! `F = A2ᵀ [t]× R A1` with the inverses `A` of the calibration matrices. A step is a small turn after `R`, and
//! a step of `t` along two directions across it.

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};

use super::robust_fit::Representation;

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
