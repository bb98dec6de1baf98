//! Calibrated cameras: lenses with distortion, views without it, relative poses.
//!
//! A [`CameraModel`] maps rays to pixels and back. Where a lens folds back or has no inverse, the
//! answer is `None`. With a lens, an epipolar line is a curve in the picture; in an
//! [`UndistortedView`] it is straight, so `F` belongs to two such views. [`ViewPair::fit_pose`] makes a
//! pose from `F` and the calibration matrices of the views.
//!
//! # Conventions
//! - Camera axes: x right, y down, z forwards. `x2 = R x1 + t`.
//! - Pixels as everywhere: the centre of the top-left pixel is (0, 0).

mod cloud;
mod doubt;
mod lens;
mod lens_model;
mod model;
mod names;
#[cfg(feature = "inspector")]
mod orbit;
mod pictures_of;
mod pose;
#[cfg(test)]
mod tests;
mod undistorted_view;
mod view_pair;

pub use cloud::{Baseline, CloudPoint, LengthUnit, PointCloud};
pub use doubt::CameraDoubt;
pub use lens::{Lens, Projection, Radial};
pub use lens_model::LensModel;
pub use model::{CameraModel, FocalLength};
#[cfg(feature = "files")]
pub(crate) use names::IMPOSSIBLE;
pub use names::calibration;
#[cfg(feature = "inspector")]
#[doc(hidden)]
pub use orbit::Orbit;
pub use pictures_of::PicturesOf;
pub use pose::{PoseDifference, PoseFit, PoseUncertainty, RelativePose};
pub use undistorted_view::UndistortedView;
pub use view_pair::ViewPair;
