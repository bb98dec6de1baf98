//! Polar rectification (Pollefeys, Koch & Van Gool, *A simple and efficient rectification method
//! for general motion*, ICCV 1999): one row per pair of corresponding half epipolar lines, columns
//! by the distance from the epipole.
//!
//! The epipoles may lie anywhere. Neighbouring rows are at most one pixel apart at the far end of
//! either image, so nothing shrinks. Near the epipole the picture is stretched. It can have as many
//! rows as the image has border pixels. Epipoles at infinity are moved to 10⁹ px, which bends a row
//! of a 4000 px image by less than 0.01 px. The result is then that of the planar method, up to a
//! shift along each row.
//!
//! Pitfall: `F` maps *lines*, not half lines. The matches determine which halves correspond
//! (oriented epipolar geometry). Without matches, and with an epipole inside an image, both cameras
//! are assumed to be held the same way up.

mod half_pencil;
mod orientation;

use half_pencil::HalfPencil;
use nalgebra::Vector3;
use orientation::Orientation;

use super::RectifyError;
use super::extent::{Extent, Range};
use super::row::RowTrace;
use crate::geometry::{Frame, FundamentalMatrix, Point, PointPair};

/// Rows of one image: half lines from its epipole.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PolarMap {
    /// Epipole, px. An epipole at infinity is placed at 10⁹ px.
    pub(super) epipole: Point,
    /// Direction of each row away from the epipole, radians from x towards y, strictly monotonic.
    pub(super) angles: Vec<f64>,
    /// Distance of column 0 from the epipole, px.
    pub(super) radius: f64,
    /// Increase of the distance per column, px; negative if the picture lies to the left of the
    /// epipole.
    pub(super) radius_step: f64,
    columns: usize,
}

impl PolarMap {
    pub(super) fn row(&self, y: f64) -> RowTrace {
        // Extrapolates beyond the first and the last row: half a pixel still belongs to the
        // picture.
        let k = (y.max(0.0) as usize).min(self.angles.len() - 2);
        let angle = self.angles[k] + (self.angles[k + 1] - self.angles[k]) * (y - k as f64);
        let (sin, cos) = angle.sin_cos();
        let direction = Vector3::new(cos, sin, 0.0);
        let start = self.epipole.to_homogeneous() + direction * self.radius;
        RowTrace { start, step: direction * self.radius_step }
    }

    /// Returns the number of rows of a whole turn about the epipole, if the picture shows one. Its first
    /// and last row are neighbours then.
    pub(super) fn rows_of_a_turn(&self) -> Option<f64> {
        let range = (self.angles[self.angles.len() - 1] - self.angles[0]).abs();
        let rows = self.angles.len() as f64;
        let missing = std::f64::consts::TAU - range;
        (missing < 2.0 * range / (rows - 1.0)).then_some(rows)
    }

    pub(super) fn rectified_from_original(&self, p: Point) -> Option<Point> {
        let from = p - self.epipole;
        let (first, last) = (self.angles[0], self.angles[self.angles.len() - 1]);
        let (low, high) = (first.min(last), first.max(last));
        let turn = std::f64::consts::TAU;
        // Tolerates half a row at either end, for points that rounding puts outside.
        let slack = (high - low) / self.angles.len() as f64;
        let angle = low - slack + (from.y.atan2(from.x) - (low - slack)).rem_euclid(turn);
        if angle > high + slack {
            return None;
        }
        let rising = last > first;
        let after = self.angles.partition_point(|a| if rising { *a < angle } else { *a > angle });
        let k = after.clamp(1, self.angles.len() - 1) - 1;
        let y = k as f64 + (angle - self.angles[k]) / (self.angles[k + 1] - self.angles[k]);
        let x = (from.norm() - self.radius) / self.radius_step;
        (x >= -0.5 && x <= self.columns as f64 - 0.5).then(|| Point::new(x, y))
    }
}

/// Both maps, their common size and the facts for the warnings.
pub(super) struct Polar {
    pub(super) maps: [PolarMap; 2],
    pub(super) frame: Frame,
    /// Factor by which the pixel limit reduced the picture.
    pub(super) scale: f64,
    /// True if the orientation was assumed: without matches, and with an epipole inside an image.
    pub(super) orientation_assumed: bool,
}

/// Computes a polar rectification.
pub(super) fn polar(
    fundamental: &FundamentalMatrix,
    frames: [Frame; 2],
    matches: &[PointPair],
    limit: usize,
) -> Result<Polar, RectifyError> {
    let pencil1 = HalfPencil::new(&fundamental.epipole1(), frames[0]);
    let pencil2 = HalfPencil::new(&fundamental.epipole2(), frames[1]);
    let orientation = Orientation::find(fundamental, [&pencil1, &pencil2], matches);
    let lines = orientation.lines(fundamental, &pencil1, &pencil2);
    let range = lines.common_range().ok_or(RectifyError::NoCommonLines)?;
    let full_size = lines.rows(range, 1.0);
    let columns = |rows: &[[f64; 2]], k: usize| {
        let pencil = [&pencil1, &pencil2][k];
        Range::of(rows.iter().filter_map(|r| pencil.reach(r[k])).flatten())
    };
    let radii = [columns(&full_size, 0), columns(&full_size, 1)];
    // With a wrong F the half lines may miss an image, which leaves no columns.
    if radii.iter().any(|range| range.low >= range.high) {
        return Err(RectifyError::NoCommonLines);
    }
    let wanted = Extent {
        width: radii[0].length().max(radii[1].length()),
        height: full_size.len().saturating_sub(1) as f64,
    };
    let (frame, scale) = wanted.limited(limit)?;
    let rows = if scale < 1.0 { lines.rows(range, 1.0 / scale) } else { full_size };
    if rows.len() < 2 {
        return Err(RectifyError::NoCommonLines);
    }
    let rows = upright(rows, [&pencil1, &pencil2]);
    let frame = Frame::new(frame.width, rows.len().min(frame.height.max(2)));
    let map = |k: usize| {
        let angles: Vec<f64> = rows.iter().take(frame.height).map(|r| r[k]).collect();
        // Keeps the handedness of the map: distances decrease where angles decrease.
        let rising = angles[angles.len() - 1] > angles[0];
        PolarMap {
            epipole: [&pencil1, &pencil2][k].epipole,
            angles,
            radius: if rising { radii[k].low } else { radii[k].high },
            radius_step: if rising { 1.0 } else { -1.0 } / scale,
            columns: frame.width,
        }
    };
    Ok(Polar { maps: [map(0), map(1)], frame, scale, orientation_assumed: orientation.assumed })
}

/// Turns the picture by 180° if that puts more of it upright.
fn upright(mut rows: Vec<[f64; 2]>, pencils: [&HalfPencil; 2]) -> Vec<[f64; 2]> {
    let rightwards: f64 = (0..2)
        .filter(|k| !pencils[*k].inside)
        .map(|k| {
            let rising = if rows[rows.len() - 1][k] > rows[0][k] { 1.0 } else { -1.0 };
            rising * rows[rows.len() / 2][k].cos()
        })
        .sum();
    if rightwards < 0.0 {
        rows.reverse();
    }
    rows
}
