//! Plane projective geometry in `f64`: points, lines, pencils, fundamental matrices, cameras.
//!
//! The module is pure mathematics on [`nalgebra`] types: no images, no threads, no input or output.
//!
//! # Conventions
//! - Pixel coordinates are `(x, y)`, x right, y down; the centre of the top-left pixel is `(0, 0)`.
//! - A fundamental matrix maps image 1 to image 2: `x2ᵀ F x1 = 0`, `line2 = F x1`, `line1 = Fᵀ x2`,
//!   `F e1 = 0`, `Fᵀ e2 = 0`.
//! - Function names give the direction of a map: `line2_from_line1`.
//! - Angles are in radians. No function divides by the third coordinate of an epipole.

mod anchored;
mod angle;
mod area;
mod camera;
mod conditioning;
mod difference;
mod eight_point;
mod elimination;
mod essential;
#[doc(hidden)]
pub mod fan;
mod five_point;
mod frame;
mod fundamental;
mod homography;
mod line;
mod line_grid;
mod minimal;
mod minimum;
mod orthonormal;
mod pencil;
mod point;
mod posed;
#[cfg(test)]
pub(crate) mod random_scene;
mod representation;
mod residual;
mod robust_fit;
mod seven_point;
mod shared_errors;

pub use anchored::AnchoredLine;
pub(crate) use angle::{angle_between, wrapped};
pub(crate) use area::polygon_area;
pub use area::{area_between_lines, regions_between_lines};
pub use camera::Camera;
pub(crate) use conditioning::pixels_from_half_diagonals;
pub use difference::epipolar_difference;
pub use eight_point::{EightPointError, eight_point};
pub(crate) use elimination::Eliminated;
pub use essential::looks_essential;
pub(crate) use five_point::solve_five;
#[doc(hidden)]
pub use frame::image_in_words;
pub use frame::{Frame, Segment};
pub use fundamental::{FundamentalMatrix, NotFundamental};
pub use homography::{homography, transfer_error};
pub use line::Line;
pub use line_grid::{line_grid, line_spacing};
pub(crate) use minimal::{Equation, frame_equation, point_equation, solve_seven};
pub(crate) use minimum::{golden_section, grid_minimum};
pub use orthonormal::Vector7;
pub use pencil::{LinePair, PencilMap, pencil_angles};
pub(crate) use point::scaling;
pub use point::{HomogeneousPoint, PointPair, finite_point, rescaled, rescaling};
pub(crate) use posed::calibration_chi_square;
pub use representation::Matrix9;
pub(crate) use residual::median;
pub use residual::{algebraic_residual, apart_across_lines, sampson_distance, symmetric_epipolar_distance};
pub use robust_fit::{
    FundamentalFit, GroupedObservation, Observation, fit_fundamental, fit_posed, grouped_covariance,
};
pub(crate) use seven_point::determinant_on_pencil;
pub use seven_point::{SevenPointError, seven_point};
pub(crate) use shared_errors::{REGIONS, deviation, region};

/// A point in pixel coordinates.
pub type Point = nalgebra::Point2<f64>;
/// A direction or displacement in pixels.
pub type Vector = nalgebra::Vector2<f64>;
