//! Covariances of a result as an archive for NumPy.

use nalgebra::Matrix3;

use super::geometry_file::GeometryFile;
use super::npy::arrays_as_npz;
use crate::camera::UndistortedView;
use crate::geometry::Frame;

/// Names of the arrays of each view.
const VIEW_NAMES: [[&str; 6]; 2] = [
    [
        "view1_model",
        "view1_coefficients",
        "view1_original_matrix",
        "view1_original_size",
        "view1_matrix",
        "view1_size",
    ],
    [
        "view2_model",
        "view2_coefficients",
        "view2_original_matrix",
        "view2_original_size",
        "view2_matrix",
        "view2_size",
    ],
];

/// Arrays of a view, in C order.
struct ViewArrays {
    model: &'static str,
    coefficients: Vec<f64>,
    original_matrix: Matrix3<f64>,
    original_size: [f64; 2],
    matrix: Matrix3<f64>,
    size: [f64; 2],
}

impl ViewArrays {
    fn new(view: &UndistortedView) -> Self {
        let (model, coefficients) = view.camera().lens().named();
        let size = |frame: Frame| [frame.width as f64, frame.height as f64];
        Self {
            model: model.name(),
            coefficients,
            original_matrix: view.camera().calibration().transpose(),
            original_size: size(view.original()),
            matrix: view.calibration().transpose(),
            size: size(view.frame()),
        }
    }
}

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
    /// | `pictures` | text | `original`, or `undistorted` with both views |
    /// | `view1_model`, `view1_coefficients` | text, N | lens of picture 1 |
    /// | `view1_original_matrix`, `view1_original_size` | 3×3, 2 | K, width and height of picture 1 |
    /// | `view1_matrix`, `view1_size` | 3×3, 2 | K, width and height of the view of picture 1 |
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
        let mut texts: Vec<(&str, &str)> =
            self.pictures.name().map(|name| ("pictures", name)).into_iter().collect();
        let views = self.pictures.views().map(|views| views.views.each_ref().map(ViewArrays::new));
        let shapes = views.as_ref().map(|views| views.each_ref().map(|view| [view.coefficients.len()]));
        for (view, (names, shape)) in
            views.iter().flatten().zip(VIEW_NAMES.iter().zip(shapes.iter().flatten()))
        {
            texts.push((names[0], view.model));
            arrays.push((names[1], shape, &view.coefficients));
            arrays.push((names[2], &[3, 3], view.original_matrix.as_slice()));
            arrays.push((names[3], &[2], &view.original_size));
            arrays.push((names[4], &[3, 3], view.matrix.as_slice()));
            arrays.push((names[5], &[2], &view.size));
        }
        Ok(arrays_as_npz(&texts, &arrays))
    }
}
