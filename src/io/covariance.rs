//! Covariances of a result as an archive for NumPy.

use super::geometry_file::GeometryFile;
use super::npy::arrays_as_npz;

impl GeometryFile {
    /// Returns `F`, its covariance and, if the result has a pose, `R`, `t` and their covariance as a
    /// NumPy archive (`.npz`).
    ///
    /// | array | shape | content |
    /// |---|---|---|
    /// | `fundamental` | 3×3 | `F` with norm 1 |
    /// | `covariance` | 9×9 | of the entries of `fundamental`, row by row |
    /// | `rotation`, `translation` | 3×3, 3 | `x2 = R x1 + t`, the length of `t` is 1 |
    /// | `pose_covariance` | 6×6 | of a rotation vector after `R`, radians, and of the entries of `t` |
    ///
    /// # Errors
    /// A clause for the user if there is no covariance.
    pub fn covariances_as_npz(&self) -> Result<Vec<u8>, String> {
        let (Some(fundamental), Some(covariance)) = (&self.fundamental, &self.covariance) else {
            return Err("there is no covariance. Only refined results of epiline estimate have one".into());
        };
        // Symmetric matrices have the same rows and columns.
        let mut arrays: Vec<(&str, &[usize], &[f64])> = Vec::new();
        let rows = fundamental.matrix().transpose();
        arrays.push(("fundamental", &[3, 3], rows.as_slice()));
        arrays.push(("covariance", &[9, 9], covariance.as_slice()));
        let calibrated = self.calibrated.as_ref();
        let rotation = calibrated.and_then(|c| c.pose).map(|pose| pose.rotation.matrix().transpose());
        if let (Some(rotation), Some(pose)) = (&rotation, calibrated.and_then(|c| c.pose.as_ref())) {
            arrays.push(("rotation", &[3, 3], rotation.as_slice()));
            arrays.push(("translation", &[3], pose.translation.as_slice()));
        }
        if let Some(covariance) = calibrated.and_then(|c| c.pose_covariance.as_ref()) {
            arrays.push(("pose_covariance", &[6, 6], covariance.as_slice()));
        }
        Ok(arrays_as_npz(&arrays))
    }
}
