//! How good a rectified pair is: rows that agree, and how the pictures were bent.

use nalgebra::Matrix2;
use serde::Serialize;

use super::map::ImageMap;
use super::outline::{diagonals, middle_lines};
use crate::geometry::{Frame, Point, PointPair, Vector};

/// Points a side of the grid on which areas are compared.
const GRID: usize = 48;

/// The middle half of disparities is taken to be at least this wide, px, or a scene on one plane would allow none.
const NARROW: f64 = 8.0;

/// Everything measured on a rectified pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Vertical distance of matches; `None` without a match in both pictures.
    pub rows: Option<RowErrors>,
    /// How each picture differs from its image.
    pub distortion: [Distortion; 2],
}

/// How well matches come to lie in the same row. Pixels of the rectified pictures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RowErrors {
    /// Matches that are in both pictures.
    pub matches: usize,
    /// Matches that are outside one of them.
    pub outside: usize,
    /// Mean of `|y1 − y2|`.
    pub mean: f64,
    /// Largest `|y1 − y2|`.
    pub max: f64,
    /// Smallest and largest disparity `x1 − x2` of those that are not far off all others.
    pub disparity: [f64; 2],
    /// Matches whose disparity is far off: mostly wrong matches, which rows cannot tell.
    pub far_off: usize,
}

/// How a picture differs from its image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distortion {
    /// Angle between the images of the two middle lines, degrees; 90 keeps right angles. `None` where the epipole is
    /// in the image or the middle lines are not all in the picture.
    pub orthogonality: Option<f64>,
    /// Ratio of the two diagonals (Mallon & Whelan 2005); 1 keeps proportions.
    pub aspect_ratio: Option<f64>,
    /// Part of the image, 0 to 1, that is outside the picture.
    pub cut: f64,
    /// Part of the image, 0 to 1, drawn on less than half its area (a limit of pixels apart).
    pub shrunk: f64,
    /// Part of the image, 0 to 1, drawn on more than twice its area.
    pub stretched: f64,
}

impl Measures {
    /// `scale` is by how much the limit makes both pictures smaller; that is no distortion.
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

/// Numbers, of some ascending ones, that lie within three times the width of the middle half beside it (Tukey's outer
/// fences); the width counts as at least [`NARROW`]. Never empty.
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

/// Rectified area over original area at a rectified pixel.
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
