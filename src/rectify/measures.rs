//! Quality of a rectified pair: row errors and distortion.

use nalgebra::Matrix2;
use serde::Serialize;

use super::map::ImageMap;
use super::outline::{diagonals, middle_lines};
use crate::geometry::{Frame, Point, PointPair, Vector};

/// Points per side of the grid on which areas are compared.
const GRID: usize = 48;

/// Minimum interquartile range of disparities, px. Without it a planar scene would have no
/// tolerance.
const NARROW: f64 = 8.0;

/// Measurements of a rectified pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Vertical distances of the matches; `None` if no match is in both pictures.
    pub rows: Option<RowErrors>,
    /// Distortion of each picture relative to its image.
    pub distortion: [Distortion; 2],
}

/// Vertical distances of matches, in pixels of the rectified pictures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RowErrors {
    /// Number of matches in both pictures.
    pub matches: usize,
    /// Number of matches outside a picture.
    pub outside: usize,
    /// Mean of `|y1 − y2|`.
    pub mean: f64,
    /// Largest `|y1 − y2|`.
    pub max: f64,
    /// Smallest and largest disparity `x1 − x2`, without the outliers counted in `far_off`.
    pub disparity: [f64; 2],
    /// Number of disparity outliers. Most are wrong matches that happen to fit F.
    pub far_off: usize,
}

/// Distortion of a picture relative to its image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distortion {
    /// Angle between the two middle lines in the picture, degrees; 90 is undistorted. `None` with
    /// the epipole in the image or a middle line partly outside the picture.
    pub orthogonality: Option<f64>,
    /// Ratio of the two diagonals (Mallon & Whelan 2005); 1 is undistorted. `None` as above.
    pub aspect_ratio: Option<f64>,
    /// Fraction of the image outside the picture, 0 to 1.
    pub cut: f64,
    /// Fraction of the image drawn on less than half its area, 0 to 1, the pixel limit aside.
    pub shrunk: f64,
    /// Fraction of the image drawn on more than twice its area, 0 to 1.
    pub stretched: f64,
}

impl Measures {
    /// Measures a pair. `scale` is the reduction by the pixel limit, which is no distortion.
    pub(super) fn of(
        maps: &[ImageMap; 2],
        frames: [Frame; 2],
        size: Frame,
        scale: f64,
        matches: &[PointPair],
    ) -> Self {
        Self {
            rows: RowErrors::of(maps, matches),
            distortion: [
                Distortion::of(&maps[0], frames[0], size, scale),
                Distortion::of(&maps[1], frames[1], size, scale),
            ],
        }
    }
}

impl RowErrors {
    fn of(maps: &[ImageMap; 2], matches: &[PointPair]) -> Option<Self> {
        let placed: Vec<Vector> = matches
            .iter()
            .filter_map(|m| {
                let a = maps[0].rectified_from_original(m.point1)?;
                Some(a - maps[1].rectified_from_original(m.point2)?)
            })
            .collect();
        if placed.is_empty() {
            return None;
        }
        let errors = placed.iter().map(|d| d.y.abs());
        let mut disparities: Vec<f64> = placed.iter().map(|d| d.x).collect();
        disparities.sort_by(f64::total_cmp);
        let near = near(&disparities);
        Some(Self {
            matches: placed.len(),
            outside: matches.len() - placed.len(),
            mean: errors.clone().sum::<f64>() / placed.len() as f64,
            max: errors.fold(0.0, f64::max),
            disparity: [near[0], near[near.len() - 1]],
            far_off: disparities.len() - near.len(),
        })
    }
}

/// Returns the values within Tukey's outer fences: three interquartile ranges beyond the quartiles.
/// The range counts as at least [`NARROW`]. Never empty; `ascending` is sorted.
fn near(ascending: &[f64]) -> &[f64] {
    let last = ascending.len() - 1;
    let [low, high] = [last / 4, last - last / 4].map(|k| ascending[k]);
    let reach = 3.0 * (high - low).max(NARROW);
    let from = ascending.partition_point(|v| *v < low - reach);
    let to = ascending.partition_point(|v| *v <= high + reach);
    &ascending[from..to]
}

impl Distortion {
    fn of(map: &ImageMap, frame: Frame, size: Frame, scale: f64) -> Self {
        let forward = |p: Point| map.rectified_from_original(p);
        let across = !map.has_epipole_in(frame);
        let orthogonality = across
            .then(|| middle_lines(frame, forward))
            .flatten()
            .map(|[x, y]| (x.dot(&y) / (x.norm() * y.norm())).clamp(-1.0, 1.0).acos().to_degrees());
        let aspect_ratio =
            across.then(|| diagonals(frame, forward)).flatten().map(|[a, b]| a.norm() / b.norm());
        let [mut cut, mut shrunk, mut stretched] = [0usize; 3];
        for j in 0..GRID {
            for i in 0..GRID {
                let p = Point::new(
                    frame.right() * (i as f64 + 0.5) / GRID as f64,
                    frame.bottom() * (j as f64 + 0.5) / GRID as f64,
                );
                let shown = forward(p).filter(|q| size.contains(*q));
                match shown.and_then(|q| area_factor(map, q)).map(|f| f / (scale * scale)) {
                    None => cut += 1,
                    Some(factor) if factor < 0.5 => shrunk += 1,
                    Some(factor) if factor > 2.0 => stretched += 1,
                    Some(_) => {}
                }
            }
        }
        let share = |count: usize| count as f64 / (GRID * GRID) as f64;
        Self {
            orthogonality,
            aspect_ratio,
            cut: share(cut),
            shrunk: share(shrunk),
            stretched: share(stretched),
        }
    }
}

/// Returns the ratio of rectified to original area at a rectified pixel.
fn area_factor(map: &ImageMap, q: Point) -> Option<f64> {
    let half = 0.25;
    let at = |x: f64, y: f64| map.row(y).at(x);
    let dx = (at(q.x + half, q.y)? - at(q.x - half, q.y)?) / (2.0 * half);
    let dy = (at(q.x, q.y + half)? - at(q.x, q.y - half)?) / (2.0 * half);
    let original_per_rectified = Matrix2::from_columns(&[dx, dy]).determinant();
    Some(1.0 / original_per_rectified.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_matches_do_not_widen_the_range_of_disparities_and_near_objects_do() {
        let scene: Vec<f64> = (0..100).map(|k| 4.0 + 0.13 * f64::from(k)).chain([35.0]).collect();
        assert_eq!(near(&scene), scene);
        let wrong: Vec<f64> = [-189.0].into_iter().chain(scene.clone()).chain([427.0]).collect();
        assert_eq!(near(&wrong), scene);
        assert_eq!(near(&[3.0]), [3.0]);
        assert_eq!(near(&[-2.0, 3.0]), [-2.0, 3.0]);
    }
}
