//! Planar rectification: one homography per image (Loop & Zhang, *Computing rectifying homographies
//! for stereo vision*, CVPR 1999).
//!
//! `H = S · R · P`. The projective part `P` sends the epipole to infinity. The similarity `R` makes
//! the epipolar lines horizontal and puts corresponding lines into the same row. The shear `S`
//! restores right angles and proportions of the middle lines.
//!
//! `P1` sends a line `w1` through the epipole to infinity, `P2` the corresponding line `w2`. Loop &
//! Zhang search the points at infinity of image 1 for the pair with the least distortion. With the
//! epipole at infinity these points give a single line. The search here therefore covers the whole
//! pencil. A point on the line through the image centre, across the direction of the epipole,
//! selects each line.
//!
//! Pitfall: neither line may cross its image, so both epipoles must lie outside. The nearer the
//! epipoles, the greater the distortion.

use nalgebra::{Matrix3, Vector3};

use super::RectifyError;
use super::extent::{Extent, Range};
use super::row::RowTrace;
use crate::geometry::{Frame, FundamentalMatrix, Point, golden_section, polygon_area, scaling};

/// Number of lines sampled per pencil before the refinement of the best one.
const TRIED: usize = 720;

/// Homography and its inverse.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlanarMap {
    /// Homography `H`: rectified from original pixels.
    pub(super) rectified_from_original: Matrix3<f64>,
    original_from_rectified: Matrix3<f64>,
}

impl PlanarMap {
    pub(super) fn new(rectified_from_original: Matrix3<f64>) -> Option<Self> {
        let h = rectified_from_original / rectified_from_original[(2, 2)];
        let inverse = h.try_inverse()?;
        // The third coordinate of a visible point must be positive in both directions.
        let sign = (inverse * h * Vector3::z()).z.signum();
        h.iter()
            .chain(inverse.iter())
            .all(|v| v.is_finite())
            .then(|| Self { rectified_from_original: h, original_from_rectified: inverse * sign })
    }

    pub(super) fn row(&self, y: f64) -> RowTrace {
        let inverse = &self.original_from_rectified;
        RowTrace { start: inverse * Vector3::new(0.0, y, 1.0), step: inverse.column(0).into_owned() }
    }

    pub(super) fn rectified_from_original(&self, p: Point) -> Option<Point> {
        map(&self.rectified_from_original, p)
    }
}

/// Returns both maps, their common size and the factor of reduction by the pixel limit.
pub(super) fn planar(
    fundamental: &FundamentalMatrix,
    frames: [Frame; 2],
    limit: usize,
) -> Result<([PlanarMap; 2], Frame, f64), RectifyError> {
    let normalised = [Normalised::new(frames[0]), Normalised::new(frames[1])];
    let f = normalised[1].original_from_normalised().transpose()
        * fundamental.matrix()
        * normalised[0].original_from_normalised();
    let f = FundamentalMatrix::from_rank_two(f).ok_or(RectifyError::NoCommonPlane)?;
    let [w1, w2] = lines_to_infinity(&f, normalised)?;
    let projective = [projective(&w1), projective(&w2)];
    let undone = |k: usize| projective[k].try_inverse().ok_or(RectifyError::NoCommonPlane);
    // Both epipoles are now at infinity: c x1 + d y1 + a x2 + b y2 + e = 0.
    let g = undone(1)?.transpose() * f.matrix() * undone(0)?;
    let normal1 = Vector3::new(g[(2, 0)], g[(2, 1)], 0.0);
    let normal2 = -Vector3::new(g[(0, 2)], g[(1, 2)], g[(2, 2)]);
    let upright = normal1.y / normal1.xy().norm() + normal2.y / normal2.xy().norm();
    let sign = if upright < 0.0 { -1.0 } else { 1.0 };
    let mut maps = [Matrix3::identity(); 2];
    for (k, normal) in [normal1 * sign, normal2 * sign].iter().enumerate() {
        let similarity = Matrix3::new(normal.y, -normal.x, 0.0, normal.x, normal.y, normal.z, 0.0, 0.0, 1.0);
        let flat = similarity * projective[k] * normalised[k].normalised_from_original();
        maps[k] = shear(&flat, frames[k]).ok_or(RectifyError::NoCommonPlane)? * flat;
    }
    fit(maps, frames, limit)
}

/// Scales both maps to preserve the area of the images, and crops to the rows visible in both.
fn fit(
    maps: [Matrix3<f64>; 2],
    frames: [Frame; 2],
    limit: usize,
) -> Result<([PlanarMap; 2], Frame, f64), RectifyError> {
    let quads = [corners(&maps[0], frames[0])?, corners(&maps[1], frames[1])?];
    let original: f64 = frames.iter().map(|f| f.right() * f.bottom()).sum();
    let scale = (original / quads.iter().map(|quad| polygon_area(quad)).sum::<f64>()).sqrt();
    if !scale.is_finite() {
        return Err(RectifyError::NoCommonPlane);
    }
    let rows = Range::of(quads[0].iter().map(|p| p.y)).common(&Range::of(quads[1].iter().map(|p| p.y)));
    let rows = rows.filter(|r| r.length() * scale >= 1.0).ok_or(RectifyError::NoCommonLines)?;
    let columns = [columns_within(&quads[0], rows), columns_within(&quads[1], rows)];
    let wanted =
        Extent { width: columns[0].length().max(columns[1].length()) * scale, height: rows.length() * scale };
    let (frame, smaller) = wanted.limited(limit)?;
    let scale = scale * smaller;
    let placed = |k: usize| {
        let placement = scaling(scale, -columns[k].low * scale, -rows.low * scale);
        PlanarMap::new(placement * maps[k]).ok_or(RectifyError::NoCommonPlane)
    };
    Ok(([placed(0)?, placed(1)?], frame, smaller))
}

/// Returns the columns that a convex outline covers between two rows.
fn columns_within(outline: &[Point], rows: Range) -> Range {
    let mut columns = Vec::new();
    for (k, a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        if a.y >= rows.low && a.y <= rows.high {
            columns.push(a.x);
        }
        for y in [rows.low, rows.high] {
            if (a.y < y) != (b.y < y) {
                columns.push(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
            }
        }
    }
    Range::of(columns.into_iter())
}

/// Maps the corners of an image.
pub(super) fn corners(h: &Matrix3<f64>, frame: Frame) -> Result<Vec<Point>, RectifyError> {
    let mapped = frame.corners().into_iter().map(|corner| map(h, corner));
    mapped.collect::<Option<_>>().ok_or(RectifyError::NoCommonPlane)
}

/// Maps a point; `None` on and behind the line sent to infinity.
pub(super) fn map(h: &Matrix3<f64>, p: Point) -> Option<Point> {
    let q = h * p.to_homogeneous();
    (q.z > 0.0).then(|| Point::new(q.x / q.z, q.y / q.z))
}

/// Coordinates about the image centre in units of half the longer side. They keep the entries of a
/// matrix at similar magnitudes.
#[derive(Debug, Clone, Copy)]
struct Normalised {
    centre: Point,
    unit: f64,
    /// Half the width and half the height, normalised.
    half: [f64; 2],
}

impl Normalised {
    fn new(frame: Frame) -> Self {
        let unit = frame.longer_side() / 2.0;
        Self {
            centre: frame.centre(),
            unit,
            half: [frame.width as f64 / 2.0 / unit, frame.height as f64 / 2.0 / unit],
        }
    }

    fn normalised_from_original(&self) -> Matrix3<f64> {
        let (s, c) = (1.0 / self.unit, self.centre);
        scaling(s, -c.x * s, -c.y * s)
    }

    fn original_from_normalised(&self) -> Matrix3<f64> {
        let (s, c) = (self.unit, self.centre);
        scaling(s, c.x, c.y)
    }

    /// Returns the mean of `((w·x − w·c) / w·c)²` over the image (Loop & Zhang, eq. 8): the
    /// distortion caused by sending `w` to infinity. `None` when the line crosses the image.
    fn distortion(&self, w: &Vector3<f64>) -> Option<f64> {
        let [x, y] = [w.x * self.half[0], w.y * self.half[1]];
        (x.abs() + y.abs() < w.z.abs()).then(|| (x * x + y * y) / (3.0 * w.z * w.z))
    }

    fn contains(&self, epipole: &Vector3<f64>) -> bool {
        epipole.x.abs() <= self.half[0] * epipole.z.abs() && epipole.y.abs() <= self.half[1] * epipole.z.abs()
    }
}

/// Pencil of epipolar lines. The angle of a point selects a line; the point lies on the line
/// through the image centre across the direction of the epipole. Angle 0 is the centre, ±π/2 is
/// infinity.
struct Baseline {
    epipole: Vector3<f64>,
    /// Unit vector across the direction of the epipole: a point at infinity.
    across: Vector3<f64>,
}

impl Baseline {
    fn new(epipole: Vector3<f64>) -> Self {
        let direction = epipole.xy().try_normalize(0.0).unwrap_or_else(nalgebra::Vector2::x);
        Self { epipole, across: Vector3::new(-direction.y, direction.x, 0.0) }
    }

    fn point(&self, angle: f64) -> Vector3<f64> {
        Vector3::z() * angle.cos() + self.across * angle.sin()
    }

    fn line(&self, angle: f64) -> Vector3<f64> {
        self.epipole.cross(&self.point(angle))
    }

    fn angle(&self, line: &Vector3<f64>) -> f64 {
        let point = line.cross(&Vector3::z().cross(&self.across));
        point.dot(&self.across).atan2(point.z).rem_euclid(std::f64::consts::PI)
    }
}

/// Finds the corresponding lines that distort the two images least when sent to infinity, in
/// normalised coordinates.
fn lines_to_infinity(
    f: &FundamentalMatrix,
    images: [Normalised; 2],
) -> Result<[Vector3<f64>; 2], RectifyError> {
    let pencils = [Baseline::new(f.epipole1()), Baseline::new(f.epipole2())];
    for k in 0..2 {
        if images[k].contains(&pencils[k].epipole) {
            return Err(RectifyError::EpipoleInside(k + 1));
        }
    }
    let pair = |angle: f64| [pencils[0].line(angle), f.matrix() * pencils[0].point(angle)];
    let cost = |angle: f64| {
        let [w1, w2] = pair(angle);
        let distortions = images[0].distortion(&w1).zip(images[1].distortion(&w2));
        distortions.map_or(f64::INFINITY, |(a, b)| a + b)
    };
    // Samples both pencils evenly: lines far apart in one may be close in the other.
    let step = std::f64::consts::PI / TRIED as f64;
    let mut angles: Vec<f64> = (0..TRIED)
        .flat_map(|k| {
            let angle = (k as f64 + 0.5) * step;
            [angle, pencils[0].angle(&f.matrix().tr_mul(&pencils[1].point(angle)))]
        })
        .chain([std::f64::consts::FRAC_PI_2])
        .collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let costs: Vec<f64> = angles.iter().map(|a| cost(*a)).collect();
    let best = (0..costs.len())
        .min_by(|a, b| costs[*a].total_cmp(&costs[*b]))
        .filter(|k| costs[*k].is_finite())
        .ok_or(RectifyError::NoCommonPlane)?;
    let before = if best == 0 { angles[best] - step } else { angles[best - 1] };
    let after = angles.get(best + 1).copied().unwrap_or(angles[best] + step);
    let refined = golden_section(cost, before, after);
    let angle = if cost(refined) < costs[best] { refined } else { angles[best] };
    Ok(pair(angle))
}

/// Returns the homography that sends a line to infinity and keeps the neighbourhood of the centre.
/// The line must miss the centre.
fn projective(w: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, w.x / w.z, w.y / w.z, 1.0)
}

/// Returns the horizontal shear that makes the middle lines of an image perpendicular again and
/// restores their ratio of lengths (Loop & Zhang, section 7).
fn shear(map_so_far: &Matrix3<f64>, frame: Frame) -> Option<Matrix3<f64>> {
    let [x, y] = super::outline::middle_lines(frame, |p| map(map_so_far, p))?;
    let (w, h) = (frame.right(), frame.bottom());
    let area = h * w * (x.y * y.x - x.x * y.y);
    let a = (h * h * x.y * x.y + w * w * y.y * y.y) / area;
    let b = (h * h * x.x * x.y + w * w * y.x * y.y) / -area;
    let (a, b) = if a < 0.0 { (-a, -b) } else { (a, b) };
    (a.is_finite() && b.is_finite()).then(|| Matrix3::new(a, b, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
}
