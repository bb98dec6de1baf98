//! Use cases: the questions of a program about two pictures, and the rules for their answers.
//!
//! A [`Study`] holds two pictures, drawn without the distortion of their lenses if the cameras are known. It
//! answers a [`Question`] with an [`Estimate`](crate::estimate::Estimate), and gives advice on clicks. The
//! command line and the window ask the same study, so each rule exists once:
//!
//! | rule | place |
//! |---|---|
//! | Cameras take part in a search if both focal lengths are known, not guessed. | [`Study::solve`] |
//! | A click beyond the range of a lens is refused, and a match beyond it is left out. | [`clicks_in`], [`matches_in`] |
//! | Two clicks propose geometries of two sequences. With fewer, all lines do. | [`barcode_parameters`] |
//! | Where only a plane is certain, the pose has no uncertainty. | [`PoseOutcome`] |
//! | The pose of a calibration gives the length of the baseline to the pose of `F`. | [`stereo_pose`] |
//! | A finding against a geometry is confirmed by a second search. | [`ShownGeometry::judged`] |
//! | A pair counts as misplaced from 1 % of the longer side along its line. | [`Study::places`] |
//!
//! Points of questions and answers are pixels of the views without distortion. Without cameras, the views are
//! the pictures themselves. A [`PointStudy`] fits a geometry to matches without pictures. This module knows no files, no options of a command line and no widgets.

mod advice;
mod cameras;
#[cfg(feature = "inspector")]
mod disparities;
mod error;
mod judge;
mod points;
mod pose;
mod sequences;
mod solve;
#[cfg(test)]
mod tests;

pub use advice::PlaceFound;
pub use cameras::{assumed_camera, clicks_in, matches_in, plan_views, undistorted};
#[cfg(feature = "inspector")]
#[doc(hidden)]
pub use disparities::DisparityMap;
pub use error::StudyError;
pub use judge::{ComparedPose, ShownGeometry};
pub use points::PointStudy;
pub use pose::{PoseOutcome, stereo_pose};
pub use sequences::barcode_parameters;
pub use solve::{Question, Study};
