//! Thrown balls in the yard, seen by two static cameras far apart: a pair of synchronised sequences
//! with exact geometry.
//!
//! A ball of centre `c` and radius `r` projects to a conic. The conic's dual is `P Q* Pᵀ`, with the
//! dual quadric `Q* = (c cᵀ − r² I, c; cᵀ, 1)` (Hartley & Zisserman, §8.3). Silhouettes are
//! therefore exact to the pixel.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Matrix4, Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use rayon::prelude::*;

use super::yard::yard_picture;
use crate::geometry::{Camera, Frame, FundamentalMatrix, Point, PointPair};
use crate::image::GrayPlane;
use crate::motion::FrameSequence;

/// Parameters of a scene of thrown balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrownBalls {
    /// Size of the frames, px.
    pub frame: Frame,
    /// Number of frames.
    pub frames: usize,
    /// Number of balls.
    pub balls: usize,
    /// Offset between the sequences: frame `k` of camera 1 is simultaneous with frame `k + offset`
    /// of camera 2.
    pub offset: i32,
    /// Standard deviation of the camera noise, grey levels.
    pub noise: f64,
    /// Relative increase in brightness from the first frame to the last, as when the sun comes out.
    pub brightening: f64,
    /// Seed of the paths, the yard and the noise.
    pub seed: u64,
}

impl Default for ThrownBalls {
    fn default() -> Self {
        let frame = Frame::new(640, 480);
        Self { frame, frames: 300, balls: 8, offset: 0, noise: 2.0, brightening: 0.1, seed: 1 }
    }
}

/// The two cameras and the balls of a scene.
pub struct BallScene {
    thrown: ThrownBalls,
    cameras: [Camera; 2],
    balls: Vec<Ball>,
}

/// A ball and its path: the sum of two oscillations per axis around a midpoint.
struct Ball {
    radius: f64,
    shade: f64,
    middle: [f64; 3],
    swings: [[Swing; 2]; 3],
}

/// One oscillation of a path.
struct Swing {
    reach: f64,
    /// Period in frames.
    period: f64,
    phase: f64,
}

/// Bounds of the balls' positions, m: in front of everything else in the yard.
const SPACE: [[f64; 2]; 3] = [[-1.7, 1.7], [1.6, 4.3], [0.35, 2.5]];
/// Positions of the cameras and their common target, m. The viewing directions are 74° apart.
const POSITIONS: [[f64; 3]; 2] = [[-3.0, -0.9, 1.9], [3.0, -0.7, 1.4]];
const TARGET: [f64; 3] = [0.0, 3.1, 1.35];

impl Ball {
    fn new(random: &mut Pcg32) -> Self {
        let dark = random.random_range(0.0..1.0) < 0.5;
        let shade = if dark { random.random_range(5.0..35.0) } else { random.random_range(225.0..250.0) };
        let swings = SPACE.map(|[low, high]| {
            let half = 0.5 * (high - low);
            // The first oscillation is wide and slow; the second makes each throw different.
            [(0.75, 90.0..170.0), (0.25, 25.0..60.0)].map(|(share, periods)| Swing {
                reach: half * share,
                period: random.random_range(periods),
                phase: random.random_range(0.0..TAU),
            })
        });
        Self {
            radius: random.random_range(0.10..0.20),
            shade,
            middle: SPACE.map(|[low, high]| f64::midpoint(low, high)),
            swings,
        }
    }

    fn at(&self, time: f64) -> Point3<f64> {
        let along = |k: usize| {
            let swing = |s: &Swing| s.reach * (TAU * time / s.period + s.phase).sin();
            self.middle[k] + self.swings[k].iter().map(swing).sum::<f64>()
        };
        Point3::new(along(0), along(1), along(2))
    }
}

/// The projection of a ball into a camera at some time.
struct Disc {
    conic: Matrix3<f64>,
    /// First and last column. `rows` holds the first and last row.
    columns: [usize; 2],
    rows: [usize; 2],
    distance: f64,
    shade: f64,
}

impl Disc {
    fn new(ball: &Ball, camera: &Camera, time: f64, frame: Frame) -> Option<Self> {
        let centre = ball.at(time);
        let mut quadric = Matrix4::identity();
        let block = centre.coords * centre.coords.transpose() - Matrix3::identity() * ball.radius.powi(2);
        quadric.fixed_view_mut::<3, 3>(0, 0).copy_from(&block);
        quadric.fixed_view_mut::<3, 1>(0, 3).copy_from(&centre.coords);
        quadric.fixed_view_mut::<1, 3>(3, 0).copy_from(&centre.coords.transpose());
        let dual = camera.matrix() * quadric * camera.matrix().transpose();
        // Lines x = v tangent to the conic: d33 v² − 2 d13 v + d11 = 0.
        let bounds = |k: usize, last: usize| {
            let root = (dual[(k, 2)].powi(2) - dual[(k, k)] * dual[(2, 2)]).sqrt();
            let [a, b] = [-1.0, 1.0].map(|sign| (dual[(k, 2)] + sign * root) / dual[(2, 2)]);
            let (low, high) = (a.min(b).ceil().max(0.0), a.max(b).floor().min(last as f64));
            (low <= high).then_some([low as usize, high as usize])
        };
        let conic = dual.try_inverse()?;
        let middle = camera.project(&centre)?.to_homogeneous();
        let inside = middle.dot(&(conic * middle)).signum();
        let [x, y, z, w] = *camera.centre().as_ref();
        Some(Self {
            conic: conic * inside,
            columns: bounds(0, frame.width - 1)?,
            rows: bounds(1, frame.height - 1)?,
            distance: (centre - Point3::new(x, y, z) * (1.0 / w)).norm(),
            shade: ball.shade,
        })
    }

    /// Returns each row of the disc with its first and last column.
    fn spans(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        (self.rows[0]..=self.rows[1]).filter_map(|y| {
            let is_inside = |x: usize| {
                let p = Vector3::new(x as f64, y as f64, 1.0);
                p.dot(&(self.conic * p)) > 0.0
            };
            let first = (self.columns[0]..=self.columns[1]).find(|x| is_inside(*x))?;
            let last = (first..=self.columns[1]).rev().find(|x| is_inside(*x))?;
            Some((y, first, last))
        })
    }
}

impl BallScene {
    /// Creates the scene. Returns `None` only for a frame without pixels.
    pub fn new(thrown: ThrownBalls) -> Option<Self> {
        if thrown.frame.width == 0 || thrown.frame.height == 0 {
            return None;
        }
        let focal = 0.8 * thrown.frame.width as f64;
        let camera = |position: [f64; 3]| {
            let up = Vector3::new(0.0, 0.0, 1.0);
            Camera::looking_at(position.into(), TARGET.into(), up, focal, thrown.frame.centre())
        };
        let cameras = [camera(POSITIONS[0])?, camera(POSITIONS[1])?];
        let mut random = Pcg32::seed_from_u64(thrown.seed);
        let balls = (0..thrown.balls).map(|_| Ball::new(&mut random)).collect();
        Some(Self { thrown, cameras, balls })
    }

    /// Returns the two cameras.
    pub fn cameras(&self) -> &[Camera; 2] {
        &self.cameras
    }

    /// Returns the exact fundamental matrix.
    pub fn fundamental(&self) -> Option<FundamentalMatrix> {
        Camera::fundamental(&self.cameras[0], &self.cameras[1])
    }

    /// Returns up to `count` points in the balls' space that both cameras see.
    pub fn matches(&self, count: usize) -> Vec<PointPair> {
        let mut random = Pcg32::seed_from_u64(self.thrown.seed ^ 0x5eed);
        let mut anywhere = || {
            let [x, y, z] = SPACE.map(|[low, high]| random.random_range(low..high));
            let place = Point3::new(x, y, z);
            let (point1, point2) = (self.cameras[0].project(&place)?, self.cameras[1].project(&place)?);
            let sees = |p: Point| self.thrown.frame.contains(p);
            (sees(point1) && sees(point2)).then_some(PointPair { point1, point2 })
        };
        (0..20 * count).filter_map(|_| anywhere()).take(count).collect()
    }

    /// Returns the time of a frame of a camera, in frames of camera 1.
    fn time(&self, camera: usize, number: usize) -> f64 {
        number as f64 - if camera == 0 { 0.0 } else { f64::from(self.thrown.offset) }
    }

    fn discs(&self, camera: usize, number: usize) -> Vec<Disc> {
        let time = self.time(camera, number);
        let seen = |ball| Disc::new(ball, &self.cameras[camera], time, self.thrown.frame);
        let mut discs: Vec<Disc> = self.balls.iter().filter_map(seen).collect();
        discs.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        discs
    }

    /// Returns the exact mask of a frame, row by row.
    pub fn mask(&self, camera: usize, number: usize) -> Vec<bool> {
        let frame = self.thrown.frame;
        let mut mask = vec![false; frame.width * frame.height];
        for disc in self.discs(camera, number) {
            for (y, first, last) in disc.spans() {
                mask[y * frame.width + first..=y * frame.width + last].fill(true);
            }
        }
        mask
    }

    /// Draws the grey frames of both cameras.
    pub fn sequences(&self) -> Option<[FrameSequence; 2]> {
        let of_camera = |camera: usize, name: &str| {
            let still = yard_picture(self.cameras[camera], self.thrown.frame, self.thrown.seed)?;
            let planes: Vec<GrayPlane> = (0..self.thrown.frames)
                .into_par_iter()
                .map(|number| self.drawn(&still, camera, number))
                .collect();
            let mut sequence = FrameSequence::new(name);
            planes.iter().try_for_each(|plane| sequence.push(plane)).ok()?;
            Some(sequence)
        };
        Some([of_camera(0, "balls-left")?, of_camera(1, "balls-right")?])
    }

    fn drawn(&self, still: &GrayPlane, camera: usize, number: usize) -> GrayPlane {
        let frame = self.thrown.frame;
        let mut values = still.values().to_vec();
        for disc in self.discs(camera, number) {
            for (y, first, last) in disc.spans() {
                values[y * frame.width + first..=y * frame.width + last].fill(disc.shade as f32);
            }
        }
        let light = 1.0 + self.thrown.brightening * number as f64 / self.thrown.frames.max(1) as f64;
        let seed = self.thrown.seed.wrapping_mul(7919).wrapping_add(2 * number as u64 + camera as u64);
        let mut random = Pcg32::seed_from_u64(seed);
        // The sum of two uniform bytes approximates a Gaussian of deviation 104.5 well enough.
        let spread = (self.thrown.noise / 104.5) as f32;
        for value in &mut values {
            let bits = random.random::<u32>();
            let noise = (bits & 255) as f32 + (bits >> 8 & 255) as f32 - 255.0;
            *value = *value * light as f32 + noise * spread;
        }
        GrayPlane::new(frame, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::symmetric_epipolar_distance;

    const SMALL: ThrownBalls = ThrownBalls {
        frame: Frame { width: 160, height: 120 },
        frames: 20,
        balls: 4,
        offset: 0,
        noise: 1.0,
        brightening: 0.0,
        seed: 3,
    };

    #[test]
    fn matches_are_exact_and_lines_through_balls_touch_them_in_both_views() {
        let scene = BallScene::new(SMALL).unwrap();
        let f = scene.fundamental().unwrap();
        for m in scene.matches(50) {
            assert!(symmetric_epipolar_distance(&f, &m) < 1e-6);
        }
        // The epipolar line of a ball's centre passes through the centre in the other view.
        let ball = &scene.balls[0];
        for time in 0..20 {
            let centre = ball.at(f64::from(time));
            let seen = scene.cameras[0].project(&centre).unwrap();
            let line2 = f.line2_from_point1(seen).unwrap();
            assert!(line2.distance(scene.cameras[1].project(&centre).unwrap()) < 1e-6);
        }
    }

    #[test]
    fn frames_show_the_masks_and_an_offset_moves_them_in_time() {
        let scene = BallScene::new(SMALL).unwrap();
        let later = BallScene::new(ThrownBalls { offset: 5, ..SMALL }).unwrap();
        assert_eq!(scene.mask(0, 7), later.mask(0, 7));
        assert_eq!(scene.mask(1, 7), later.mask(1, 12));
        let [left, _] = scene.sequences().unwrap();
        let mask = scene.mask(0, 7);
        let [a, b] = [left.frame(7), left.frame(17)];
        let differ = |k: &usize| a[*k].abs_diff(b[*k]) > 20;
        let (inside, outside): (Vec<usize>, Vec<usize>) =
            (0..a.len()).partition(|k| mask[*k] != scene.mask(0, 17)[*k]);
        assert!(inside.iter().filter(|k| differ(k)).count() * 10 > inside.len() * 7);
        assert!(outside.iter().filter(|k| differ(k)).count() * 100 < outside.len());
    }
}
