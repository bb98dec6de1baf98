//! The camera motion between the two pictures of a synthetic pair.

use nalgebra::{Point3, Vector3};

use crate::geometry::{Camera, Frame};

named! {
    /// The motion from camera 1 to camera 2.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Motion {
        /// To the right; epipoles at infinity.
        Sideways,
        /// Forward and slightly sideways; epipoles inside the image.
        Forward,
        /// To the right, both cameras turned about the vertical towards one point; epipoles outside the
        /// image.
        Converging,
        /// To the right and rolled by 20°.
        Roll,
        /// To the right, with 1.5 times the focal length.
        Scale,
    }
}

impl Motion {
    /// Returns the two cameras for a picture size, or `None` for a picture without width.
    pub fn cameras(self, frame: Frame) -> Option<[Camera; 2]> {
        let focal = 0.85 * frame.width as f64;
        let camera = |position: [f64; 3], target: [f64; 3], roll: f64, focal: f64| {
            let up = Vector3::new(roll.sin(), 0.0, roll.cos());
            Camera::looking_at(Point3::from(position), Point3::from(target), up, focal, frame.centre())
        };
        let straight = camera([0.0, 0.0, 1.5], [0.0, 8.0, 1.5], 0.0, focal)?;
        let aim = [0.1, 6.0, 1.4];
        Some(match self {
            Self::Sideways => [straight, camera([0.4, 0.0, 1.5], [0.4, 8.0, 1.5], 0.0, focal)?],
            Self::Forward => [straight, camera([0.09, 0.7, 1.55], [0.05, 8.0, 1.5], 0.0, focal)?],
            Self::Converging => {
                [camera([-0.5, 0.0, 1.5], aim, 0.0, focal)?, camera([0.8, 0.1, 1.5], aim, 0.0, focal)?]
            }
            Self::Roll => {
                let roll = 20f64.to_radians();
                [straight, camera([0.4, 0.0, 1.5], [0.3, 8.0, 1.5], roll, focal)?]
            }
            Self::Scale => [straight, camera([0.35, 0.0, 1.55], [0.1, 8.0, 1.5], 0.0, 1.5 * focal)?],
        })
    }
}
