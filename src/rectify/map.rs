//! The map between an image and its rectified picture, whichever method made it.

use nalgebra::Matrix3;
use serde::Serialize;

use super::planar::PlanarMap;
use super::polar::PolarMap;
use super::row::RowTrace;
use crate::geometry::{Frame, Point};

/// Where the pixels of an image are in its rectified picture, and the other way round.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageMap(pub(super) MapKind);

/// The two kinds of maps.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum MapKind {
    Planar(PlanarMap),
    Polar(PolarMap),
}

/// A polar map as it is written to files: pixel `(column, row)` is at
/// `epipole + (radius + column · radius_step) · (cos angles[row], sin angles[row])` of the original.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PolarTable<'a> {
    /// The epipole, px of the original; one at infinity stands at 10⁹ px.
    pub epipole: Point,
    /// Distance from the epipole in column 0, px.
    pub radius: f64,
    /// What a column adds to it, px.
    pub radius_step: f64,
    /// Direction of each row away from the epipole, radians from x towards y.
    pub angles: &'a [f64],
}

impl ImageMap {
    /// Where the pixels of a rectified row are in the original. `y` counts rows and may lie between them.
    pub fn row(&self, y: f64) -> RowTrace {
        match &self.0 {
            MapKind::Planar(map) => map.row(y),
            MapKind::Polar(map) => map.row(y),
        }
    }

    /// The original position of a rectified one, px; it may lie outside the image.
    pub fn original_from_rectified(&self, p: Point) -> Option<Point> {
        self.row(p.y).at(p.x)
    }

    /// The rectified position of an original one, px; `None` where the picture does not go.
    pub fn rectified_from_original(&self, p: Point) -> Option<Point> {
        match &self.0 {
            MapKind::Planar(map) => map.rectified_from_original(p),
            MapKind::Polar(map) => map.rectified_from_original(p),
        }
    }

    /// The homography (rectified from original pixels, last entry 1) of a planar map.
    pub fn homography(&self) -> Option<&Matrix3<f64>> {
        match &self.0 {
            MapKind::Planar(map) => Some(map.homography()),
            MapKind::Polar(_) => None,
        }
    }

    /// The table of a polar map.
    pub fn polar_table(&self) -> Option<PolarTable<'_>> {
        match &self.0 {
            MapKind::Planar(_) => None,
            MapKind::Polar(map) => Some(PolarTable {
                epipole: map.epipole,
                radius: map.radius,
                radius_step: map.radius_step,
                angles: &map.angles,
            }),
        }
    }

    /// Whether the rows meet inside the image.
    pub(super) fn has_epipole_in(&self, frame: Frame) -> bool {
        match &self.0 {
            MapKind::Planar(_) => false,
            MapKind::Polar(map) => frame.contains(map.epipole),
        }
    }
}
