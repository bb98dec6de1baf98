//! Changes of a geometry that stand for common mistakes.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::calibration::CalibrationChange;
use super::cameras::DecomposedCamera;
use crate::convention::Reading;
use crate::geometry::{Camera, Frame, FundamentalMatrix, Point, PointPair, Vector, rescaling, scaling};

/// Images that a change affects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Affected {
    /// Both images alike.
    Both,
    /// Image 1 alone.
    Image1,
    /// Image 2 alone.
    Image2,
}

impl Affected {
    /// All choices, the most common first.
    pub(super) const ALL: [Self; 3] = [Self::Both, Self::Image1, Self::Image2];

    fn has(self, image: usize) -> bool {
        match self {
            Self::Both => true,
            Self::Image1 => image == 0,
            Self::Image2 => image == 1,
        }
    }
}

/// Mirror image or turn of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mirror {
    /// Left and right exchanged. Camera axes of OpenGL have the same effect, and so has a mirrored
    /// pose.
    LeftRight,
    /// Top and bottom exchanged: y counted from the bottom.
    TopBottom,
    /// Turned by 180°.
    HalfTurn,
}

impl Mirror {
    pub(super) const ALL: [Self; 3] = [Self::LeftRight, Self::TopBottom, Self::HalfTurn];

    /// Returns the map of pixels of an image.
    fn map(self, frame: Frame) -> Matrix3<f64> {
        let along = |flipped: bool, end: f64| if flipped { (-1.0, end) } else { (1.0, 0.0) };
        let (sx, ox) = along(self != Self::TopBottom, frame.right());
        let (sy, oy) = along(self != Self::LeftRight, frame.bottom());
        Matrix3::new(sx, 0.0, ox, 0.0, sy, oy, 0.0, 0.0, 1.0)
    }
}

named! {
    /// Mistake with the cameras of a geometry.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum CameraChange {
        /// Poses map the camera to the world, not the world to the camera.
        CameraToWorld,
        /// Camera axes of OpenGL (y up, z backwards), not of computer vision (y down, z forwards). A
        /// mirrored pose has the same effect.
        OpenGlAxes,
        /// y of the camera points up.
        YUp,
        /// The translation is the position of the camera, not `−R` times it.
        PositionForTranslation,
        /// The rotation is inverted, and the translation is not.
        RotationInverted,
        /// The real part of the quaternion is last, not first.
        QuaternionOrder,
        /// Focal lengths in x and y exchanged.
        FocalLengthsExchanged,
        /// Coordinates of the principal point exchanged.
        PrincipalPointExchanged,
        /// Calibrations of the two cameras exchanged.
        CalibrationsExchanged,
        /// Calibration matrices transposed.
        CalibrationTransposed,
    }
}

impl CameraChange {
    /// Returns the cameras after the change.
    pub(super) fn apply(self, cameras: &[Camera; 2]) -> Option<[DecomposedCamera; 2]> {
        let [a, b] = cameras;
        if self == Self::CalibrationTransposed {
            return Some([DecomposedCamera::of_transposed(a)?, DecomposedCamera::of_transposed(b)?]);
        }
        let [a, b] = [DecomposedCamera::new(a)?, DecomposedCamera::new(b)?];
        if self == Self::CalibrationsExchanged {
            return Some([
                DecomposedCamera { calibration: b.calibration, ..a },
                DecomposedCamera { calibration: a.calibration, ..b },
            ]);
        }
        Some([a, b].map(|camera| {
            let DecomposedCamera { calibration: mut k, rotation: r, translation: t } = camera;
            let axes = |signs: [f64; 3]| {
                let signs = Matrix3::from_diagonal(&Vector3::from(signs));
                (signs * r, signs * t)
            };
            let (r, t) = match self {
                Self::CameraToWorld => (r.transpose(), -(r.transpose() * t)),
                Self::OpenGlAxes => axes([1.0, -1.0, -1.0]),
                Self::YUp => axes([1.0, -1.0, 1.0]),
                Self::PositionForTranslation => (r, -(r * t)),
                Self::RotationInverted => (r.transpose(), t),
                Self::QuaternionOrder => (super::cameras::with_real_part_last(&r), t),
                Self::FocalLengthsExchanged => {
                    (k[(0, 0)], k[(1, 1)]) = (k[(1, 1)], k[(0, 0)]);
                    (r, t)
                }
                Self::PrincipalPointExchanged => {
                    (k[(0, 2)], k[(1, 2)]) = (k[(1, 2)], k[(0, 2)]);
                    (r, t)
                }
                Self::CalibrationsExchanged | Self::CalibrationTransposed => (r, t),
            };
            DecomposedCamera { calibration: k, rotation: r, translation: t }
        }))
    }
}

/// A change of a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Change {
    /// Another reading of the matrix: transposed, x and y exchanged, another origin of pixels.
    Convention {
        /// The reading.
        reading: Reading,
    },
    /// Mistake with the cameras.
    Cameras {
        /// The mistake.
        mistake: CameraChange,
    },
    /// Mistake with a stereo calibration.
    Calibration(CalibrationChange),
    /// The matrix is an essential matrix: it is `F` with calibration matrices of this focal length.
    Essential {
        /// Focal length of both images, px. The principal points are in the middle.
        focal: f64,
    },
    /// The translation between the cameras has the opposite sign. `F` is the same.
    TranslationReversed,
    /// Mirrored or turned images.
    Mirrored {
        /// The images.
        images: Affected,
        /// The mirror or turn.
        mirror: Mirror,
    },
    /// Images of another size than the images of the geometry.
    Resized {
        /// The images.
        images: Affected,
        /// Size of the images of the geometry over the size of the judged images.
        factor: f64,
    },
    /// Scale about the middle of the image: a wrong focal length.
    FocalLength {
        /// The images.
        images: Affected,
        /// Factor by which the focal length of the geometry is too large.
        factor: f64,
    },
    /// Coordinates shifted by half a pixel, because the centre of the top-left pixel is (0, 0) for one
    /// program and (0.5, 0.5) for another.
    HalfPixel {
        /// The images.
        images: Affected,
        /// Coordinates of the geometry less coordinates of the images, px: 0.5 or −0.5.
        offset: f64,
    },
    /// Moved coordinates: cropped images, or a wrong principal point.
    Moved {
        /// The images.
        images: Affected,
        /// x coordinates of the geometry less x coordinates of the images, px.
        x: f64,
        /// y coordinates of the geometry less y coordinates of the images, px.
        y: f64,
    },
    /// Lens distortion that the geometry leaves out or takes with the wrong sign. A point at `d`
    /// from the middle belongs at `d (1 + k r²)`, with `r` the length of `d` in half diagonals.
    Distortion {
        /// Coefficient `k`; positive for barrel distortion.
        k: f64,
    },
}

impl Change {
    /// Returns the number of fitted numbers.
    pub(super) fn parameters(&self) -> usize {
        match self {
            Self::Convention { .. }
            | Self::Cameras { .. }
            | Self::Mirrored { .. }
            | Self::TranslationReversed
            | Self::HalfPixel { .. } => 0,
            Self::Calibration(change) => usize::from(matches!(change, CalibrationChange::OtherSize { .. })),
            Self::Essential { .. }
            | Self::Resized { .. }
            | Self::FocalLength { .. }
            | Self::Distortion { .. } => 1,
            Self::Moved { .. } => 2,
        }
    }

    /// Returns whether the change leaves the directions of the epipoles. Others fit easily where the images leave
    /// the epipoles open.
    pub(super) fn keeps_epipoles(&self) -> bool {
        matches!(self, Self::Calibration(CalibrationChange::EquidistantLens | CalibrationChange::RadialLens))
    }

    /// Returns whether two changes are the same mistake: of one kind, in the same images, in the same
    /// direction. Other pixel origins in addition make no other mistake of a convention.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let grows = |factor: f64| factor > 1.0;
        match (self, other) {
            (Self::Resized { images: a, factor: f }, Self::Resized { images: b, factor: g })
            | (Self::FocalLength { images: a, factor: f }, Self::FocalLength { images: b, factor: g }) => {
                a == b && grows(*f) == grows(*g)
            }
            (Self::Moved { images: a, x, y }, Self::Moved { images: b, x: u, y: v }) => {
                a == b && x * u + y * v > 0.0
            }
            (Self::Convention { reading: a }, Self::Convention { reading: b }) => {
                (a.transposed, a.axes_exchanged) == (b.transposed, b.axes_exchanged)
            }
            (Self::Distortion { k }, Self::Distortion { k: other }) => k * other > 0.0,
            (Self::Essential { .. }, Self::Essential { .. }) => true,
            (
                Self::Calibration(CalibrationChange::OtherSize { factor: f }),
                Self::Calibration(CalibrationChange::OtherSize { factor: g }),
            ) => grows(*f) == grows(*g),
            _ => self == other,
        }
    }

    /// Returns `F` after the change, for changes of pixel coordinates. `None` for others, and on
    /// overflow.
    pub(super) fn apply(&self, given: &FundamentalMatrix, frames: [Frame; 2]) -> Option<FundamentalMatrix> {
        match self {
            Self::Convention { reading } => return reading.apply(given),
            Self::TranslationReversed => return Some(*given),
            Self::Essential { focal } => {
                let [k1, k2] = frames.map(|frame| {
                    let middle = frame.centre();
                    scaling(focal.recip(), -middle.x / focal, -middle.y / focal)
                });
                return FundamentalMatrix::from_rank_two(k2.transpose() * given.matrix() * k1);
            }
            _ => {}
        }
        // The map takes pixels of the images to those of the geometry.
        let of = |image: usize| {
            let (images, map) = self.map(frames[image])?;
            Some(if images.has(image) { map } else { Matrix3::identity() })
        };
        FundamentalMatrix::from_rank_two(of(1)?.transpose() * given.matrix() * of(0)?)
    }

    /// Returns the changed images and the map of their pixels, for images of a size.
    fn map(&self, frame: Frame) -> Option<(Affected, Matrix3<f64>)> {
        Some(match *self {
            Self::Convention { .. }
            | Self::Cameras { .. }
            | Self::Calibration(_)
            | Self::Essential { .. }
            | Self::TranslationReversed
            | Self::Distortion { .. } => return None,
            Self::Mirrored { images, mirror } => (images, mirror.map(frame)),
            Self::Resized { images, factor } => (images, rescaling(factor)),
            Self::FocalLength { images, factor } => {
                let offset = frame.centre() * (1.0 - factor);
                (images, scaling(factor, offset.x, offset.y))
            }
            Self::Moved { images, x, y } => (images, scaling(1.0, x, y)),
            Self::HalfPixel { images, offset } => (images, scaling(1.0, offset, offset)),
        })
    }
}

/// Returns a pair without lens distortion.
pub(super) fn undistorted(pair: &PointPair, k: f64, frames: [Frame; 2]) -> PointPair {
    let of = |point: Point, frame: Frame| {
        let from: Vector = point - frame.centre();
        let share = (2.0 * from.norm() / frame.diagonal()).powi(2);
        frame.centre() + from * (1.0 + k * share)
    };
    PointPair { point1: of(pair.point1, frames[0]), point2: of(pair.point2, frames[1]) }
}
