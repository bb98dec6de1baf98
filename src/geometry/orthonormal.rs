//! The orthonormal representation of `F` by seven numbers.
//!
//! `F = U diag(cos φ, sin φ, 0) Vᵀ` with rotations `U`, `V` (Bartoli & Sturm 2004). Every parameter
//! vector gives rank 2, and epipoles at infinity are no special case. Increments are small
//! rotations on either side, so the derivatives are products of `F` with the generators of
//! rotations.

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};

use super::representation::Representation;
use super::{Frame, FundamentalMatrix, pixels_from_half_diagonals};

/// Increments of the seven numbers: a small rotation on each side, then φ.
pub type Vector7 = SVector<f64, 7>;

/// The orthonormal representation of a matrix of rank 2.
#[derive(Debug, Clone)]
pub(super) struct Orthonormal {
    u: Matrix3<f64>,
    v: Matrix3<f64>,
    phi: f64,
}

impl Orthonormal {
    pub(super) fn new(f: &Matrix3<f64>) -> Option<Self> {
        let svd = f.try_svd(true, true, f64::EPSILON, 200)?;
        let (u, v_t) = (svd.u?, svd.v_t?);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let mut u = Matrix3::from_columns(&order.map(|k| u.column(k).into_owned()));
        let mut v = Matrix3::from_columns(&order.map(|k| v_t.row(k).transpose()));
        // The third column has zero weight, so its sign is free to make both rotations proper.
        if u.determinant() < 0.0 {
            u.column_mut(2).neg_mut();
        }
        if v.determinant() < 0.0 {
            v.column_mut(2).neg_mut();
        }
        let phi = svd.singular_values[order[1]].atan2(svd.singular_values[order[0]]);
        Some(Self { u, v, phi })
    }
}

impl Representation<7> for Orthonormal {
    fn matrix(&self) -> Matrix3<f64> {
        let (sin, cos) = self.phi.sin_cos();
        self.u * Matrix3::from_diagonal(&Vector3::new(cos, sin, 0.0)) * self.v.transpose()
    }

    fn derivatives(&self) -> [Matrix3<f64>; 7] {
        let f = self.matrix();
        let generator = |k: usize| Vector3::from_fn(|i, _| f64::from(u8::from(i == k))).cross_matrix();
        let (sin, cos) = self.phi.sin_cos();
        let by_phi = self.u * Matrix3::from_diagonal(&Vector3::new(-sin, cos, 0.0)) * self.v.transpose();
        std::array::from_fn(|k| match k {
            0..3 => generator(k) * f,
            3..6 => f * generator(k - 3),
            _ => by_phi,
        })
    }

    fn moved(&self, step: &Vector7) -> Self {
        let left = Rotation3::new(Vector3::new(step[0], step[1], step[2]));
        let right = Rotation3::new(Vector3::new(step[3], step[4], step[5]));
        Self {
            u: left.matrix() * self.u,
            // F·exp(b) = U S (exp(−b) V)ᵀ
            v: right.matrix().transpose() * self.v,
            phi: self.phi + step[6],
        }
    }
}

impl FundamentalMatrix {
    /// Returns the matrix after a small step of its seven numbers. The unit of length is half the
    /// diagonal of each image. A step of 0.01 moves epipolar lines by about 1 % of this unit.
    /// Returns `None` when the representation degenerates.
    #[must_use]
    pub fn moved(&self, step: &Vector7, frames: [Frame; 2]) -> Option<Self> {
        let [from1, from2] = frames.map(pixels_from_half_diagonals);
        let conditioned = from2.transpose() * self.matrix() * from1;
        let moved = Orthonormal::new(&(conditioned / conditioned.norm()))?.moved(step).matrix();
        Self::from_rank_two(from2.try_inverse()?.transpose() * moved * from1.try_inverse()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::geometry::random_scene::example_fundamental;

    #[test]
    fn a_step_of_nothing_stays_and_each_of_the_seven_moves_the_lines_by_its_size() {
        let f = example_fundamental();
        let frames = [Frame::new(768, 576); 2];
        let stays = f.moved(&Vector7::zeros(), frames).unwrap();
        assert!((stays.matrix() - f.matrix()).norm() < 1e-12);
        for k in 0..7 {
            let mut step = Vector7::zeros();
            step[k] = 0.01;
            let moved = f.moved(&step, frames).unwrap();
            let line = |f: &FundamentalMatrix| f.line2_from_point1(Point::new(300.0, 200.0)).unwrap();
            let apart = line(&f).distance(line(&moved).foot(frames[1].centre()));
            // A hundredth of the half diagonal, 480 px, is 4.8 px. The step that turns the lines moves
            // them by a little more.
            assert!(apart < 5.5, "{k}: {apart} px");
            assert!((moved.matrix() - f.matrix()).norm() > 1e-6, "{k}");
        }
    }
}
