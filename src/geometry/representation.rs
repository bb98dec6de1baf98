//! Matrices of rank 2 by a number of small steps, for fits and covariances.

use nalgebra::{Matrix3, SMatrix, SVector};

/// A 9×9 covariance of the entries of a 3×3 matrix, row by row.
pub type Matrix9 = SMatrix<f64, 9, 9>;

/// A matrix of rank 2 by `N` numbers.
pub(super) trait Representation<const N: usize>: Sized {
    fn matrix(&self) -> Matrix3<f64>;
    /// Returns the derivatives of the matrix by small steps of the numbers.
    fn derivatives(&self) -> [Matrix3<f64>; N];
    #[must_use]
    fn moved(&self, step: &SVector<f64, N>) -> Self;
}
