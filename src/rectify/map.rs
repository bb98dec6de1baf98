//! Map between an image and its rectified picture, planar or polar.

use nalgebra::Matrix3;
use serde::Serialize;

use super::planar::PlanarMap;
use super::polar::PolarMap;
use super::row::RowTrace;
use crate::camera::UndistortedView;
use crate::geometry::{Frame, Point};

/// Map between the pixels of an image and of its rectified picture, both ways. The map may lead
/// through a view without distortion, if a lens distorts the image.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageMap {
    kind: MapKind,
    view: Option<UndistortedView>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MapKind {
    Planar(PlanarMap),
    Polar(PolarMap),
}

/// Polar map as written to files. Pixel `(column, row)` is at
/// `epipole + (radius + column · radius_step) · (cos angles[row], sin angles[row])` of the
/// original.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PolarTable<'a> {
    /// Epipole, px of the original. An epipole at infinity is placed at 10⁹ px.
    pub epipole: Point,
    /// Distance of column 0 from the epipole, px.
    pub radius: f64,
    /// Increase of the distance per column, px.
    pub radius_step: f64,
    /// Direction of each row away from the epipole, radians from x towards y.
    pub angles: &'a [f64],
}

impl ImageMap {
    pub(super) fn new(kind: MapKind) -> Self {
        Self { kind, view: None }
    }

    /// Leads the map on through a view without distortion to the picture of the camera.
    pub(super) fn through(self, view: &UndistortedView) -> Self {
        Self { view: Some(*view), ..self }
    }

    /// Traces row `y` of the picture in the image without distortion. `y` may lie between two rows.
    pub fn row(&self, y: f64) -> RowTrace {
        match &self.kind {
            MapKind::Planar(map) => map.row(y),
            MapKind::Polar(map) => map.row(y),
        }
    }

    /// Returns the original position of a rectified point, px. It may lie outside the image.
    pub fn original_from_rectified(&self, p: Point) -> Option<Point> {
        self.in_picture(self.row(p.y).at(p.x)?)
    }

    /// Returns the place in the picture of the camera of a point without distortion.
    #[inline]
    pub(super) fn in_picture(&self, point: Point) -> Option<Point> {
        match &self.view {
            Some(view) => view.original_from_undistorted(point),
            None => Some(point),
        }
    }

    /// Returns the rectified position of an original point, px; `None` outside the map.
    pub fn rectified_from_original(&self, p: Point) -> Option<Point> {
        let p = match &self.view {
            Some(view) => view.undistorted_from_original(p)?,
            None => p,
        };
        match &self.kind {
            MapKind::Planar(map) => map.rectified_from_original(p),
            MapKind::Polar(map) => map.rectified_from_original(p),
        }
    }

    /// Returns the number of rows after which a polar map begins again, if it shows a whole turn.
    pub(super) fn rows_of_a_turn(&self) -> Option<f64> {
        match &self.kind {
            MapKind::Planar(_) => None,
            MapKind::Polar(map) => map.rows_of_a_turn(),
        }
    }

    /// Returns the homography of a planar map: rectified from original pixels
    /// (without distortion), last entry 1.
    pub fn homography(&self) -> Option<&Matrix3<f64>> {
        match &self.kind {
            MapKind::Planar(map) => Some(&map.rectified_from_original),
            MapKind::Polar(_) => None,
        }
    }

    /// Returns the table of a polar map.
    pub fn polar_table(&self) -> Option<PolarTable<'_>> {
        match &self.kind {
            MapKind::Planar(_) => None,
            MapKind::Polar(map) => Some(PolarTable {
                epipole: map.epipole,
                radius: map.radius,
                radius_step: map.radius_step,
                angles: &map.angles,
            }),
        }
    }

    /// Returns whether this is a polar map whose epipole lies inside the image.
    pub(super) fn has_epipole_in(&self, frame: Frame) -> bool {
        match &self.kind {
            MapKind::Planar(_) => false,
            MapKind::Polar(map) => frame.contains(map.epipole),
        }
    }
}
