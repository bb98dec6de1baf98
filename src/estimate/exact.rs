//! Exactly known geometry for tests: two cameras, points and textured walls that both see, and a
//! line similarity that knows the truth.

use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;

use super::PreparedPair;
use super::evidence::lines::PencilAngles;
pub(super) use crate::geometry::random_scene::rows;
use crate::geometry::{
    AnchoredLine, Camera, Frame, FundamentalMatrix, Point, PointPair, area_between_lines,
    symmetric_epipolar_distance,
};
use crate::image::GrayPlane;
use crate::similarity::{CostMatrix, LineSimilarity, ScaledSimilarity, SimilaritySource};

/// Size of both images.
pub(super) const FRAME: Frame = Frame { width: 320, height: 240 };
const FOCAL: f64 = 340.0;

/// Two cameras in front of a slanted far wall, and of a near wall that covers a part of the lower
/// half.
pub(super) struct ExactScene([Camera; 2]);

/// A wall `z = depth + slope x`, for these `x` and `y`.
struct Wall {
    depth: f64,
    slope: f64,
    x: [f64; 2],
    y: [f64; 2],
}

const WALLS: [Wall; 2] = [
    Wall { depth: 4.4, slope: -0.2, x: [-1.2, 1.2], y: [0.0, 1.6] },
    Wall { depth: 6.5, slope: 0.3, x: [-9.0, 9.0], y: [-9.0, 9.0] },
];

impl ExactScene {
    /// Returns a scene with camera 2 to the right of camera 1 and turned towards it. The epipoles
    /// are outside the images.
    pub fn aside() -> Self {
        Self::moved([0.5, -0.15, 0.3])
    }

    /// Returns a scene with camera 2 in front of camera 1. The epipoles are in the images.
    pub fn forward() -> Self {
        Self::moved([-0.25, 0.12, 1.2])
    }

    /// Returns a scene with camera 2 at this place.
    pub fn moved(place: [f64; 3]) -> Self {
        let camera = |place: [f64; 3]| {
            let (target, up) = (Point3::new(0.05, 0.0, 6.0), Vector3::new(0.0, -1.0, 0.05));
            Camera::looking_at(Point3::from(place), target, up, FOCAL, FRAME.centre()).unwrap()
        };
        Self([camera([-0.4, 0.0, 0.0]), camera(place)])
    }

    pub fn fundamental(&self) -> FundamentalMatrix {
        Camera::fundamental(&self.0[0], &self.0[1]).unwrap()
    }

    /// Returns the calibration matrices of the cameras, with focal lengths of these ratios to the true ones.
    pub fn calibrations(ratios: [f64; 2]) -> [Matrix3<f64>; 2] {
        let middle = FRAME.centre();
        ratios.map(|ratio| {
            let focal = ratio * FOCAL;
            Matrix3::new(focal, 0.0, middle.x, 0.0, focal, middle.y, 0.0, 0.0, 1.0)
        })
    }

    /// Returns the images of a scene point.
    pub fn seen(&self, x: f64, y: f64, z: f64) -> PointPair {
        let [point1, point2] = self.0.each_ref().map(|camera| camera.project(&Point3::new(x, y, z)).unwrap());
        PointPair { point1, point2 }
    }

    /// Returns two clicks far apart.
    pub fn clicks(&self) -> [PointPair; 2] {
        [self.seen(-0.7, -0.8, 5.8), self.seen(0.8, 0.7, 4.4)]
    }

    /// Returns points spread over the common field of view, at depths from 4 to 8.
    pub fn pairs(&self, count: usize) -> Vec<PointPair> {
        // Multiples of the square roots of primes spread evenly.
        let spread =
            |k: usize, root: f64, low: f64, high: f64| low + (high - low) * (k as f64 * root).fract();
        (1..)
            .map(|k| {
                let z = spread(k, 5f64.sqrt(), 4.0, 8.0);
                self.seen(spread(k, 2f64.sqrt(), -0.4, 0.4) * z, spread(k, 3f64.sqrt(), -0.3, 0.3) * z, z)
            })
            .filter(|pair| FRAME.contains(pair.point1) && FRAME.contains(pair.point2))
            .take(count)
            .collect()
    }

    /// Returns the directions of the true epipolar lines at the clicks, and κ.
    pub fn angles(&self) -> PencilAngles {
        PencilAngles::of(&self.fundamental(), &self.clicks(), 0.0).unwrap()
    }

    /// Returns the mean distance of exact matches from the lines of `f`, px.
    pub fn error(&self, f: &FundamentalMatrix) -> f64 {
        let pairs = self.pairs(60);
        pairs.iter().map(|pair| symmetric_epipolar_distance(f, pair)).sum::<f64>() / pairs.len() as f64
    }

    /// Returns a geometry whose lines are off by about `size` px.
    pub fn disturbed(&self, size: f64) -> FundamentalMatrix {
        let moved = |s: f64| Matrix3::new(1.0, s * 0.006, 2.0 * s, -s * 0.006, 1.0, -1.5 * s, 0.0, 0.0, 1.0);
        let f = moved(0.5 * size).transpose() * self.fundamental().matrix() * moved(-0.5 * size);
        FundamentalMatrix::from_rank_two(f).unwrap()
    }

    pub fn prepared(&self) -> PreparedPair {
        let [plane1, plane2] = self.planes();
        PreparedPair::new(&plane1, &plane2)
    }

    /// Renders the walls as both cameras see them.
    pub fn planes(&self) -> [GrayPlane; 2] {
        [0, 1].map(|image| {
            GrayPlane::from_fn(FRAME, |x, y| {
                let (wall, at) = self.wall_at(image, Point::new(x as f64, y as f64));
                let octave = |cell: f64, salt: u64| noise([at.x / cell, at.y / cell], salt + wall as u64);
                (20.0 + 140.0 * octave(0.1, 10) + 80.0 * octave(0.27, 20)) as f32
            })
        })
    }

    /// Returns the place in image 2 of the wall point seen at a point of image 1.
    pub fn partner(&self, point1: Point) -> Point {
        let (_, at) = self.wall_at(0, point1);
        self.0[1].project(&at).unwrap()
    }

    /// Returns the index of the wall seen at a point of an image, and the seen point.
    fn wall_at(&self, image: usize, point: Point) -> (usize, Point3<f64>) {
        let centre = self.0[image].centre();
        let from = Point3::from(centre.xyz() / centre.w);
        let inverse = self.0[image].matrix().fixed_columns::<3>(0).try_inverse().unwrap();
        let ray = inverse * point.to_homogeneous();
        // The near wall comes first.
        let hit = WALLS.iter().enumerate().find_map(|(k, wall)| {
            let t = (wall.depth + wall.slope * from.x - from.z) / (ray.z - wall.slope * ray.x);
            let at = from + ray * t;
            let on_it = (wall.x[0]..wall.x[1]).contains(&at.x) && (wall.y[0]..wall.y[1]).contains(&at.y);
            on_it.then_some((k, at))
        });
        hit.unwrap()
    }
}

/// Returns smooth noise, 0 to 1: random values at integer positions, blended between them.
fn noise([x, y]: [f64; 2], salt: u64) -> f64 {
    let value = |i: f64, j: f64| {
        let mixed = (i as i64 as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (j as i64 as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
            ^ salt.wrapping_mul(0x1656_67B1_9E37_79F9);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((mixed ^ (mixed >> 32)) & 0xFFFF) as f64 / 65_535.0
    };
    let (i, j) = (x.floor(), y.floor());
    let [u, v] = [x - i, y - j].map(|t| t * t * (3.0 - 2.0 * t));
    let blend = |a: f64, b: f64, t: f64| a + (b - a) * t;
    blend(blend(value(i, j), value(i + 1.0, j), u), blend(value(i, j + 1.0), value(i + 1.0, j + 1.0), u), v)
}

/// A line similarity that is a function of two lines.
pub(super) struct LinesBy<F>(pub F);

/// Cost of a line that misses its image.
pub(super) const OUTSIDE: f32 = 50.0;

impl<F: Fn(&AnchoredLine, &AnchoredLine) -> f32 + Sync> LineSimilarity for LinesBy<F> {
    fn pair_costs(&self, pairs: &[(AnchoredLine, AnchoredLine)]) -> Vec<f32> {
        pairs.par_iter().map(|(line1, line2)| self.0(line1, line2)).collect()
    }

    fn cost_matrix(
        &self,
        lines1: &[AnchoredLine],
        lines2: &[AnchoredLine],
        allowed: &(dyn Fn(usize, usize) -> bool + Sync),
        _stop: &(dyn Fn() -> bool + Sync),
    ) -> CostMatrix {
        let cost = |k: usize| {
            let (i, j) = (k / lines2.len(), k % lines2.len());
            if allowed(i, j) { self.0(&lines1[i], &lines2[j]) } else { f32::INFINITY }
        };
        let costs = (0..lines1.len() * lines2.len()).into_par_iter().map(cost).collect();
        CostMatrix::new(lines1.len(), lines2.len(), costs)
    }

    fn information(&self, _image: usize, lines: &[AnchoredLine]) -> Vec<f64> {
        vec![1.0; lines.len()]
    }

    fn outside_cost(&self) -> f32 {
        OUTSIDE
    }
}

/// Returns a similarity that knows the truth. The cost is the mean area between the line of image 2
/// and the true epipolar lines of three points of the line of image 1, over the image width, px.
pub(super) fn exact_lines(f: FundamentalMatrix, frames: [Frame; 2]) -> impl LineSimilarity {
    LinesBy(move |line1: &AnchoredLine, line2: &AnchoredLine| {
        let (Some(on1), Some(_)) = (frames[0].clip(&line1.line()), frames[1].clip(&line2.line())) else {
            return f32::INFINITY;
        };
        let off = |point1: Point| {
            f.line2_from_point1(point1)
                .map_or(0.0, |partner| area_between_lines(&partner, &line2.line(), frames[1]))
        };
        let areas = off(on1.start) + off(on1.midpoint()) + off(on1.end);
        (areas / 3.0 / frames[1].width as f64) as f32
    })
}

/// Images of size [`FRAME`] of which only the geometry is known.
pub(super) struct ExactSource(pub FundamentalMatrix);

impl SimilaritySource for ExactSource {
    fn at(&self, side: f64) -> ScaledSimilarity<'_> {
        let scale = (side / FRAME.longer_side()).min(1.0);
        let resized = |length: usize| (length as f64 * scale).round() as usize;
        let frames = [Frame::new(resized(FRAME.width), resized(FRAME.height)); 2];
        let f = self.0.rescaled([scale; 2]).unwrap();
        ScaledSimilarity { lines: Box::new(exact_lines(f, frames)), frames, scales: [scale; 2] }
    }
}
