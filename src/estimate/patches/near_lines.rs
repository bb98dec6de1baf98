//! Which of many matches lie near their epipolar lines, asked of one geometry after another.

use multiversion::multiversion;

use crate::geometry::{FundamentalMatrix, Line, Point, PointPair};

/// Matches that are looked at together.
const LANES: usize = 16;
/// What is added to the band where single precision looks first, px.
const SLACK: f64 = 0.1;

/// Positions of matches, laid out for the vector units.
#[derive(Debug, Clone, Default)]
pub(super) struct NearLines {
    blocks: Vec<Block>,
}

/// Positions of some matches in both images; not a number in lanes without a match.
#[derive(Debug, Clone, Copy)]
struct Block {
    x1: [f32; LANES],
    y1: [f32; LANES],
    x2: [f32; LANES],
    y2: [f32; LANES],
}

impl NearLines {
    /// Matches, which are numbered as they come.
    pub fn new(pairs: impl IntoIterator<Item = PointPair>) -> Self {
        let mut blocks: Vec<Block> = Vec::new();
        for (k, PointPair { point1, point2 }) in pairs.into_iter().enumerate() {
            if k % LANES == 0 {
                let [x1, y1, x2, y2] = [[f32::NAN; LANES]; 4];
                blocks.push(Block { x1, y1, x2, y2 });
            }
            let lane = k % LANES;
            if let Some(block) = blocks.last_mut() {
                (block.x1[lane], block.y1[lane]) = (point1.x as f32, point1.y as f32);
                (block.x2[lane], block.y2[lane]) = (point2.x as f32, point2.y as f32);
            }
        }
        Self { blocks }
    }

    /// Numbers of all matches within `band` px of each other's epipolar lines, ascending, and of some a little farther off.
    /// Nearly all are far from them, which single precision tells: lines are good to some thousandths of a pixel.
    pub fn candidates(&self, f: &FundamentalMatrix, band: f64) -> Vec<usize> {
        let scaled = f.matrix() / f.matrix().amax();
        let rows = std::array::from_fn(|k| scaled[(k / 3, k % 3)] as f32);
        near_lines(&self.blocks, &rows, (band + SLACK) as f32)
    }
}

/// Numbers of the matches whose points are within `band` px of their lines in both images.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near_lines(blocks: &[Block], f: &[f32; 9], band: f32) -> Vec<usize> {
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
        add_numbers(is_near, index, &mut found);
    }
    found
}

/// Adds the numbers of the lanes of a block that are 1.
fn add_numbers(lanes: [u8; LANES], block: usize, numbers: &mut Vec<usize>) {
    let mut left = u128::from_le_bytes(lanes);
    while left != 0 {
        numbers.push(block * LANES + left.trailing_zeros() as usize / 8);
        left &= left - 1;
    }
}

/// Whether both points of a pair are within `band` px of each other's epipolar lines.
pub(super) fn is_within(f: &FundamentalMatrix, pair: &PointPair, band: f64) -> bool {
    let (x1, x2) = (pair.point1.to_homogeneous(), pair.point2.to_homogeneous());
    let (line2, line1) = (f.matrix() * x1, f.matrix().tr_mul(&x2));
    let error = x2.dot(&line2).powi(2);
    // An epipole has no line.
    let is_near = |normal: f64| normal > 0.0 && error <= band * band * normal;
    is_near(line1.xy().norm_squared()) && is_near(line2.xy().norm_squared())
}

/// Points of one image, of which those near a line or another point are looked for.
#[derive(Debug)]
pub(super) struct Places {
    /// The points.
    pub points: Vec<Point>,
    /// Not a number in lanes without a point.
    blocks: Vec<[[f32; LANES]; 2]>,
}

impl Places {
    pub fn new(points: Vec<Point>) -> Self {
        let mut blocks = vec![[[f32::NAN; LANES]; 2]; points.len().div_ceil(LANES)];
        for (k, point) in points.iter().enumerate() {
            let [x, y] = &mut blocks[k / LANES];
            (x[k % LANES], y[k % LANES]) = (point.x as f32, point.y as f32);
        }
        Self { points, blocks }
    }

    /// Adds the numbers of the points within `band` px of a line, ascending.
    pub fn near_line(&self, line: &Line, band: f64, near: &mut Vec<usize>) {
        let coefficients = [0, 1, 2].map(|k| line.coefficients()[k] as f32);
        points_near(&self.blocks, &Shape::Line(coefficients), (band + SLACK) as f32, near);
        near.retain(|j| line.distance(self.points[*j]) <= band);
    }

    /// Adds the numbers of the points within `radius` px of a point, ascending.
    pub fn near_point(&self, point: Point, radius: f64, near: &mut Vec<usize>) {
        let centre = [point.x as f32, point.y as f32];
        points_near(&self.blocks, &Shape::Point(centre), (radius + SLACK) as f32, near);
        near.retain(|j| (self.points[*j] - point).norm() <= radius);
    }
}

/// What points are near to.
enum Shape {
    Line([f32; 3]),
    Point([f32; 2]),
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn points_near(blocks: &[[[f32; LANES]; 2]], shape: &Shape, reach: f32, near: &mut Vec<usize>) {
    for (index, [x, y]) in blocks.iter().enumerate() {
        let mut is_near = [0u8; LANES];
        match shape {
            Shape::Line([a, b, c]) => {
                for k in 0..LANES {
                    is_near[k] = u8::from((a * x[k] + b * y[k] + c).abs() <= reach);
                }
            }
            Shape::Point([u, v]) => {
                for k in 0..LANES {
                    let (dx, dy) = (x[k] - u, y[k] - v);
                    is_near[k] = u8::from(dx * dx + dy * dy <= reach * reach);
                }
            }
        }
        add_numbers(is_near, index, near);
    }
}
