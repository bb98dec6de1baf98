//! Quality of a rectified pair: row errors and distortion.

use nalgebra::Matrix2;
use rayon::prelude::*;
use serde::Serialize;

use super::Rectification;
use super::extent::Range;
use super::map::ImageMap;
use super::outline::{diagonals, middle_lines};
use crate::geometry::{Frame, Point, PointPair};

/// Points per side of the grid on which areas are compared.
const GRID: usize = 48;

/// Number of neighbours with which the disparity of a match is compared.
const NEIGHBOURS: usize = 8;
/// Number of neighbours that must agree: half. Where windows repeat, two or three wrong matches often slide by the
/// same distance. A facade from −219 to −9 px measured −636 to 1090 px with two, and −221 to −6 px with
/// four to seven.
const AGREEING: usize = NEIGHBOURS / 2;
/// Share of the matches below which a group that agrees only with itself is left out: wrong matches along
/// repeated windows slide together. A chosen number. With half of it, two of 90 ranges would be twice as
/// wide as the scene's; with more, few change.
const SMALL_GROUP: f64 = 0.02;
/// Largest disparity gradient of two matches on one surface (Burt & Julesz 1980; Pollard, Mayhew &
/// Frisby 1985): change of disparity over distance. Hardly any visible surface exceeds it.
const STEEPEST: f64 = 1.0;

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
    /// Mean of `|y1 − y2|`, where a polar map that shows a whole turn goes on from its last row to its first.
    pub mean: f64,
    /// Largest `|y1 − y2|`.
    pub max: f64,
    /// Smallest and largest disparity `x1 − x2`, without the outliers counted in `far_off`.
    pub disparity: [f64; 2],
    /// Number of matches with disparities unlike those of their neighbours. Most are wrong matches that
    /// fit F by chance.
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
        let distortion = [0, 1].map(|k| Distortion::of(&maps[k], frames[k], size, scale));
        Self { rows: RowErrors::of(maps, matches), distortion }
    }
}

impl Rectification {
    /// Returns the matches in the rectified pictures. Those outside are missing.
    pub fn placed(&self, matches: &[PointPair]) -> Vec<PointPair> {
        placed(&self.maps, matches)
    }

    /// Measures the range of disparities on other matches than the row errors. Nothing changes without
    /// a match in both pictures.
    pub fn measure_disparities(&mut self, matches: &[PointPair]) {
        let measured = RowErrors::of(&self.maps, matches);
        if let (Some(rows), Some(measured)) = (&mut self.measures.rows, measured) {
            rows.disparity = measured.disparity;
        }
    }
}

impl RowErrors {
    fn of(maps: &[ImageMap; 2], matches: &[PointPair]) -> Option<Self> {
        let placed = placed(maps, matches);
        if placed.is_empty() {
            return None;
        }
        // A match at the seam of a whole turn has one point in the first rows and one in the last.
        let turn = maps.iter().filter_map(ImageMap::rows_of_a_turn).fold(f64::INFINITY, f64::min);
        let errors = placed.iter().map(|m| (m.point1.y - m.point2.y).abs()).map(|e| e.min((turn - e).abs()));
        let agreed = on_surfaces(&placed);
        let range = Range::of(agreed.iter().map(disparity));
        Some(Self {
            matches: placed.len(),
            outside: matches.len() - placed.len(),
            mean: errors.clone().sum::<f64>() / placed.len() as f64,
            max: errors.fold(0.0, f64::max),
            disparity: [range.low, range.high],
            far_off: placed.len() - agreed.len(),
        })
    }
}

/// Returns the matches in the rectified pictures. Those outside are missing.
fn placed(maps: &[ImageMap; 2], matches: &[PointPair]) -> Vec<PointPair> {
    let place = |pair: &PointPair| pair.mapped(|k, point| maps[k].rectified_from_original(point));
    matches.iter().filter_map(place).collect()
}

fn disparity(rectified: &PointPair) -> f64 {
    rectified.point1.x - rectified.point2.x
}

/// Returns the rectified matches that lie on one surface with their neighbours, in groups that are not
/// small. Wrong matches that happen to fit F have any disparity. All are returned if there are too few to
/// compare, or none agree. Never empty unless `rectified` is.
fn on_surfaces(rectified: &[PointPair]) -> Vec<PointPair> {
    let mut kept = rectified.to_vec();
    while kept.len() > NEIGHBOURS {
        let agreeing: Vec<Vec<usize>> =
            (0..kept.len()).into_par_iter().map(|k| agreeing_neighbours(&kept, k)).collect();
        let agrees = |k: &usize| agreeing[*k].len() >= AGREEING;
        let left: Vec<PointPair> = (0..kept.len()).filter(agrees).map(|k| kept[k]).collect();
        if left.len() == kept.len() {
            let sizes = group_sizes(&agreeing);
            let is_large = |k: &usize| sizes[*k] as f64 >= SMALL_GROUP * kept.len() as f64;
            return (0..kept.len()).filter(is_large).map(|k| kept[k]).collect();
        }
        // Matches agree with each other until those that they agreed with are gone.
        kept = left;
    }
    if kept.is_empty() { rectified.to_vec() } else { kept }
}

/// Returns which of the nearest other matches may lie on one surface with match `k`.
fn agreeing_neighbours(rectified: &[PointPair], k: usize) -> Vec<usize> {
    let middle = |m: &PointPair| nalgebra::center(&m.point1, &m.point2);
    let one = &rectified[k];
    let distance = |other: &PointPair| (middle(other) - middle(one)).norm();
    let mut others: Vec<(f64, usize)> = (0..rectified.len())
        .filter(|other| *other != k)
        .map(|other| (distance(&rectified[other]), other))
        .collect();
    others.select_nth_unstable_by(NEIGHBOURS - 1, |a, b| a.0.total_cmp(&b.0));
    others.truncate(NEIGHBOURS);
    let agrees = |(distance, other): &(f64, usize)| {
        (disparity(&rectified[*other]) - disparity(one)).abs() <= STEEPEST * distance
    };
    others.into_iter().filter(agrees).map(|(_, other)| other).collect()
}

/// Returns the size of the group of each match; matches that agree are in one group.
fn group_sizes(agreeing: &[Vec<usize>]) -> Vec<usize> {
    let mut links = vec![Vec::new(); agreeing.len()];
    for (k, others) in agreeing.iter().enumerate() {
        for other in others {
            links[k].push(*other);
            links[*other].push(k);
        }
    }
    let mut sizes = vec![0; agreeing.len()];
    for start in 0..links.len() {
        if sizes[start] > 0 {
            continue;
        }
        let mut group = vec![start];
        sizes[start] = 1;
        let mut next = 0;
        while let Some(k) = group.get(next).copied() {
            next += 1;
            for other in &links[k] {
                if sizes[*other] == 0 {
                    sizes[*other] = 1;
                    group.push(*other);
                }
            }
        }
        for k in &group {
            sizes[*k] = group.len();
        }
    }
    sizes
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
        let at = |x: f64, y: f64, disparity: f64| PointPair::new(x, y, x - disparity, y);
        // A slope, a near object with five matches, and wrong matches all over.
        let mut scene: Vec<PointPair> = (0..100)
            .map(|k| (f64::from(k % 10), f64::from(k / 10)))
            .map(|(i, j)| at(40.0 * i, 30.0 * j, 4.0 + 0.5 * 30.0 * j))
            .collect();
        let near = [(205.0, 100.0), (212.0, 104.0), (208.0, 109.0), (214.0, 112.0), (206.0, 116.0)];
        scene.extend(near.map(|(x, y)| at(x, y, 235.0)));
        let mut all = scene.clone();
        all.extend([at(10.0, 12.0, -900.0), at(333.0, 215.0, 1200.0), at(90.0, 260.0, -300.0)]);
        let agreed = on_surfaces(&all);
        let ends = [f64::min, f64::max].map(|end| agreed.iter().map(disparity).reduce(end));
        assert_eq!(ends, [Some(4.0), Some(235.0)], "{agreed:?}");
        // The background right beside the object may be left out.
        assert!(agreed.len() > 95, "{}", agreed.len());
        assert_eq!(on_surfaces(&scene[..3]), scene[..3]);
        // Repeated windows: two groups of wrong matches slide together, one of them beside the other.
        let slid = |x: f64, by: f64| (0..5).map(move |k| at(x + 3.0 * f64::from(k), 150.0, by));
        let wall = (0..400).map(|k| at(20.0 * f64::from(k % 20), 20.0 * f64::from(k / 20), 50.0));
        let facade: Vec<PointPair> = wall.chain(slid(102.0, 700.0)).chain(slid(117.0, -600.0)).collect();
        let agreed = on_surfaces(&facade);
        assert!(
            agreed.iter().all(|m| disparity(m) < 51.0 && disparity(m) > 49.0) && agreed.len() > 380,
            "{}",
            agreed.len()
        );
    }
}
