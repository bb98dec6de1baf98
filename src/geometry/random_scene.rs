//! Geometries for tests: two cameras in random general position with their common points, the cameras of
//! [`Camera::example_pair`], and corresponding rows.

use nalgebra::{Matrix3, Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{Camera, Frame, FundamentalMatrix, Point, PointPair};

/// Two cameras of 768×576 px with a focal length of 800 px. The baseline is about a fifth of the
/// depth; points are at depths 4 to 9.
pub(crate) struct RandomScene {
    cameras: [Camera; 2],
    random: Pcg64Mcg,
}

impl RandomScene {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut camera = |x: f64| {
            let mut near = |v: f64| v + random.random_range(-0.3..0.3);
            let (position, target) =
                (Point3::new(near(x), near(0.0), near(0.0)), Point3::new(near(0.0), near(0.0), 6.0));
            let up = Vector3::new(near(0.0), -1.0, 0.0);
            Camera::looking_at(position, target, up, 800.0, Point::new(383.5, 287.5)).unwrap()
        };
        Self { cameras: [camera(-0.6), camera(0.6)], random }
    }

    pub(crate) fn fundamental(&self) -> FundamentalMatrix {
        Camera::fundamental(&self.cameras[0], &self.cameras[1]).unwrap()
    }

    /// Returns exact images of `count` points spread over the common field of view.
    pub(crate) fn pairs(&mut self, count: usize) -> Vec<PointPair> {
        self.seen(count, |_, _, depth| depth)
    }

    /// Returns exact images of `count` points on one slanted plane.
    pub(crate) fn planar_pairs(&mut self, count: usize) -> Vec<PointPair> {
        self.seen(count, |x, y, _| 6.0 + 0.4 * x - 0.3 * y)
    }

    fn seen(&mut self, count: usize, depth: impl Fn(f64, f64, f64) -> f64) -> Vec<PointPair> {
        let frame = Frame::new(768, 576);
        let mut pairs = Vec::new();
        while pairs.len() < count {
            let (x, y) = (self.random.random_range(-3.0..3.0), self.random.random_range(-2.5..2.5));
            let z = depth(x, y, self.random.random_range(4.0..9.0));
            let [a, b] = self.cameras.map(|c| c.project(&Point3::new(x, y, z)));
            if let (Some(point1), Some(point2)) = (a, b)
                && frame.contains(point1)
                && frame.contains(point2)
            {
                pairs.push(PointPair { point1, point2 });
            }
        }
        pairs
    }

    /// Adds Gaussian noise of standard deviation `sigma` px to every coordinate (Box–Muller).
    pub(crate) fn disturbed(&mut self, pairs: &[PointPair], sigma: f64) -> Vec<PointPair> {
        let mut moved = |p: Point| {
            let radius = sigma * (-2.0 * (1.0 - self.random.random::<f64>()).ln()).sqrt();
            let angle = std::f64::consts::TAU * self.random.random::<f64>();
            Point::new(p.x + radius * angle.cos(), p.y + radius * angle.sin())
        };
        pairs.iter().map(|p| PointPair { point1: moved(p.point1), point2: moved(p.point2) }).collect()
    }
}

/// Returns `F` of [`Camera::example_pair`].
pub(crate) fn example_fundamental() -> FundamentalMatrix {
    let (camera1, camera2) = Camera::example_pair();
    Camera::fundamental(&camera1, &camera2).unwrap()
}

/// Returns the images of a scene point in the cameras of [`Camera::example_pair`].
pub(crate) fn example_seen(x: f64, y: f64, z: f64) -> PointPair {
    let (camera1, camera2) = Camera::example_pair();
    let [point1, point2] = [camera1, camera2].map(|camera| camera.project(&Point3::new(x, y, z)).unwrap());
    PointPair { point1, point2 }
}

/// Returns the geometry of corresponding rows, `shift` px lower in image 2.
pub(crate) fn rows(shift: f64) -> FundamentalMatrix {
    let m = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, shift);
    FundamentalMatrix::from_rank_two(m).unwrap()
}
