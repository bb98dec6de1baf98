//! What a reader of a geometry must know about it.

use std::fmt::{self, Display, Formatter};

/// Fact about a geometry that was read. [`Display`] says it in a clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GeometryNote {
    /// F follows from calibration matrices and a pose, with or without lenses.
    OfCalibration { lens: bool },
    /// The file has other cameras beside the calibration, such as rectified ones. They are left out.
    OtherCameras,
    /// The F of the file contradicts its calibration.
    Contradicted,
    /// The lines are rows: the geometry of rectified pictures.
    Rectified,
    /// The matrix is probably an essential one.
    Essential,
}

impl Display for GeometryNote {
    fn fmt(&self, text: &mut Formatter) -> fmt::Result {
        text.write_str(match self {
            Self::OfCalibration { lens: false } => "F follows from the calibration matrices and the pose (R, T)",
            Self::OfCalibration { lens: true } => {
                "F follows from the calibration matrices and the pose (R, T). The lenses distort, so F belongs to \
                 undistorted pictures with the same calibration matrices, not to the pictures as they are"
            }
            Self::OtherCameras => {
                "P1 and P2 beside the calibration are cameras of other pictures, probably rectified ones. They are \
                 left out"
            }
            Self::Contradicted => {
                "F of the file contradicts its calibration matrices and pose (R, T). F is used. Check which of them \
                 belongs to the pictures"
            }
            Self::Rectified => {
                "the epipolar lines are rows: this is the geometry of rectified pictures. It does not fit the \
                 pictures before rectification"
            }
            Self::Essential => {
                "the matrix looks like an essential matrix: two equal singular values, and entries of like size. \
                 It is not for pixels. F = K2^-T E K1^-1 with the calibration matrices of both cameras"
            }
        })
    }
}
