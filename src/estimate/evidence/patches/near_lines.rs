//! Search for the matches near their epipolar lines, fast enough for many geometries.

use multiversion::multiversion;

use crate::geometry::{FundamentalMatrix, Line, Point, PointPair};
use crate::lanes::{LANES, SetLanes};

/// Allowance for rounding to single precision, px. No result depends on it.
const SLACK: f64 = 0.1;

/// Positions of matches, laid out for the vector units.
#[derive(Debug, Clone, Default)]
pub(super) struct NearLines {
    blocks: Vec<PointBlock>,
}

/// Positions of a block of matches in both images; NaN in empty lanes.
#[derive(Debug, Clone, Copy)]
struct PointBlock {
    x1: [f32; LANES],
    y1: [f32; LANES],
    x2: [f32; LANES],
    y2: [f32; LANES],
}

impl NearLines {
    /// Lays out matches, which keep their indices.
    pub fn new(pairs: impl IntoIterator<Item = PointPair>) -> Self {
        let mut blocks: Vec<PointBlock> = Vec::new();
        for (k, PointPair { point1, point2 }) in pairs.into_iter().enumerate() {
            if k % LANES == 0 {
                let [x1, y1, x2, y2] = [[f32::NAN; LANES]; 4];
                blocks.push(PointBlock { x1, y1, x2, y2 });
            }
            let lane = k % LANES;
            if let Some(block) = blocks.last_mut() {
                (block.x1[lane], block.y1[lane]) = (point1.x as f32, point1.y as f32);
                (block.x2[lane], block.y2[lane]) = (point2.x as f32, point2.y as f32);
            }
        }
        Self { blocks }
    }

    /// Returns the indices of all matches within `band` px of each other's epipolar lines, in
    /// ascending order, and of some slightly farther off. Nearly all matches are far off, for which
    /// single precision suffices: lines are good to some thousandths of a pixel.
    pub fn candidates(&self, f: &FundamentalMatrix, band: f64) -> Vec<usize> {
        let scaled = f.matrix() / f.matrix().amax();
        let rows = std::array::from_fn(|k| scaled[(k / 3, k % 3)] as f32);
        near_lines(&self.blocks, &rows, (band + SLACK) as f32)
    }
}

/// Returns the indices of the matches whose points are within `band` px of their lines in both
/// images.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near_lines(blocks: &[PointBlock], f: &[f32; 9], band: f32) -> Vec<usize> {
    let mut found = Vec::with_capacity(256);
    let band = band * band;
    for (index, block) in blocks.iter().enumerate() {
        let mut is_near = [0u8; LANES];
        for (k, is_near) in is_near.iter_mut().enumerate() {
            let (x1, y1, x2, y2) = (block.x1[k], block.y1[k], block.x2[k], block.y2[k]);
            let (a2, b2) = (f[0] * x1 + f[1] * y1 + f[2], f[3] * x1 + f[4] * y1 + f[5]);
            let (a1, b1) = (f[0] * x2 + f[3] * y2 + f[6], f[1] * x2 + f[4] * y2 + f[7]);
            let c2 = f[6] * x1 + f[7] * y1 + f[8];
            let e = a2 * x2 + b2 * y2 + c2;
            let (n1, n2) = (a1 * a1 + b1 * b1, a2 * a2 + b2 * b2);
            *is_near = u8::from(e * e <= band * if n1 < n2 { n1 } else { n2 });
        }
        for lane in SetLanes::of(is_near) {
            found.push(index * LANES + lane);
        }
    }
    found
}

/// Returns whether both points of a pair are within `band` px of each other's epipolar lines.
pub(super) fn is_within(f: &FundamentalMatrix, pair: &PointPair, band: f64) -> bool {
    let (x1, x2) = (pair.point1.to_homogeneous(), pair.point2.to_homogeneous());
    let (line2, line1) = (f.matrix() * x1, f.matrix().tr_mul(&x2));
    let error = x2.dot(&line2).powi(2);
    // An epipole has no line.
    let is_near = |normal: f64| normal > 0.0 && error <= band * band * normal;
    is_near(line1.xy().norm_squared()) && is_near(line2.xy().norm_squared())
}

/// Points of one image, laid out for queries by lines and points.
#[derive(Debug)]
pub(super) struct Places {
    /// Points in their given order.
    pub points: Vec<Point>,
    /// Blocks of neighbours. Most blocks are far from a query.
    blocks: Vec<PlaceBlock>,
    /// Circles around the blocks.
    circles: Vec<Circles>,
}

/// Positions of a block of points; NaN in empty lanes.
#[derive(Debug, Clone, Copy)]
struct PlaceBlock {
    x: [f32; LANES],
    y: [f32; LANES],
    /// Indices of the points.
    numbers: [u32; LANES],
}

/// A block of circles; NaN in empty lanes.
#[derive(Debug, Clone, Copy)]
struct Circles {
    x: [f32; LANES],
    y: [f32; LANES],
    radius: [f32; LANES],
}

impl Places {
    pub fn new(points: Vec<Point>) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|a, b| points[*a].y.total_cmp(&points[*b].y));
        // Strips are about as high as their blocks are wide.
        let blocks = points.len().div_ceil(LANES);
        let strip = blocks.isqrt().max(1) * LANES;
        for few in order.chunks_mut(strip) {
            few.sort_by(|a, b| points[*a].x.total_cmp(&points[*b].x));
        }
        let blocks: Vec<PlaceBlock> = order.chunks(LANES).map(|few| PlaceBlock::new(few, &points)).collect();
        let circles = blocks.chunks(LANES).map(Circles::around).collect();
        Self { points, blocks, circles }
    }

    /// Adds the indices of the points within `band` px of a line, neighbours after each other.
    pub fn near_line(&self, line: &Line, band: f64, near: &mut Vec<usize>) {
        let coefficients = [0, 1, 2].map(|k| line.coefficients()[k] as f32);
        points_near_line(&self.circles, &self.blocks, coefficients, (band + SLACK) as f32, near);
        near.retain(|j| line.distance(self.points[*j]) <= band);
    }

    /// Returns a function that adds the indices of the points within `band` px of the line of a point of
    /// image 1, if that point is as near to their lines.
    pub fn mutually_near(&self, f: &FundamentalMatrix, band: f64) -> impl Fn(Point, &mut Vec<usize>) + Sync {
        let lines1: Vec<Option<Line>> = self.points.iter().map(|p| f.line1_from_point2(*p)).collect();
        move |point1, near| {
            let Some(line2) = f.line2_from_point1(point1) else { return };
            self.near_line(&line2, band, near);
            near.retain(|j| lines1[*j].as_ref().is_some_and(|line1| line1.distance(point1) <= band));
        }
    }
}

impl PlaceBlock {
    fn new(numbers: &[usize], points: &[Point]) -> Self {
        let [x, y] = [[f32::NAN; LANES]; 2];
        let mut block = Self { x, y, numbers: [0; LANES] };
        for (lane, number) in numbers.iter().enumerate() {
            (block.x[lane], block.y[lane]) = (points[*number].x as f32, points[*number].y as f32);
            block.numbers[lane] = *number as u32;
        }
        block
    }
}

impl Circles {
    fn around(blocks: &[PlaceBlock]) -> Self {
        let [x, y, radius] = [[f32::NAN; LANES]; 3];
        let mut circles = Self { x, y, radius };
        for (lane, block) in blocks.iter().enumerate() {
            // Comparisons ignore NaN, so empty lanes change nothing.
            let middle = |all: &[f32; LANES]| {
                let least = all.iter().copied().fold(f32::INFINITY, f32::min);
                0.5 * (least + all.iter().copied().fold(f32::NEG_INFINITY, f32::max))
            };
            let (x, y) = (middle(&block.x), middle(&block.y));
            let distances = block.x.iter().zip(&block.y).map(|(u, v)| (u - x).hypot(v - y));
            (circles.x[lane], circles.y[lane]) = (x, y);
            circles.radius[lane] = distances.fold(0.0, f32::max);
        }
        circles
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn points_near_line(
    circles: &[Circles],
    blocks: &[PlaceBlock],
    [a, b, c]: [f32; 3],
    reach: f32,
    near: &mut Vec<usize>,
) {
    for (index, Circles { x, y, radius }) in circles.iter().enumerate() {
        let mut is_reached = [0u8; LANES];
        for k in 0..LANES {
            is_reached[k] = u8::from((a * x[k] + b * y[k] + c).abs() <= reach + radius[k]);
        }
        for lane in SetLanes::of(is_reached) {
            let PlaceBlock { x, y, numbers } = &blocks[index * LANES + lane];
            let mut is_near = [0u8; LANES];
            for k in 0..LANES {
                is_near[k] = u8::from((a * x[k] + b * y[k] + c).abs() <= reach);
            }
            for lane in SetLanes::of(is_near) {
                near.push(numbers[lane] as usize);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_agree_with_a_check_of_every_point() {
        // Fewer points than a block, several blocks, and several blocks of circles.
        for count in [0, 5, 100, 700] {
            let at = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 12) / f64::from(1u32 << 20);
            let points: Vec<Point> =
                (0..count).map(|k| Point::new(800.0 * at(2 * k), 600.0 * at(2 * k + 1))).collect();
            let places = Places::new(points.clone());
            for k in 0..40 {
                let (from, to) =
                    (Point::new(20.0 * f64::from(k), 0.0), Point::new(790.0, 15.0 * f64::from(k)));
                let line = Line::through(from, to).unwrap();
                for reach in [0.5, 4.0, 60.0] {
                    let by_one: Vec<usize> =
                        (0..points.len()).filter(|j| line.distance(points[*j]) <= reach).collect();
                    let mut found = Vec::new();
                    places.near_line(&line, reach, &mut found);
                    found.sort_unstable();
                    assert_eq!(found, by_one);
                }
            }
        }
    }
}
