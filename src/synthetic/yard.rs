//! A yard of flat, textured walls and boxes, drawn with exact matches.
//!
//! A point `c + a u + b v` of a rectangle projects to `x ∝ P (c + a u + b v, 1) = H (a, b, 1)` with
//! the homography `H = P [u v c]`. `H⁻¹ x` therefore gives both coordinates on the rectangle and,
//! as the reciprocal of its third entry, the depth. Of all rectangles at a pixel, the one with the
//! largest third entry is visible.

use image::DynamicImage;
use nalgebra::{Matrix3, Point3, Vector3, Vector4};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::Motion;
use crate::geometry::{Camera, Frame, FundamentalMatrix, Point, PointPair, Vector};
use crate::image::{GrayPlane, Picture};

/// A synthetic pair with its ground truth.
#[derive(Debug, Clone)]
pub struct TestPair {
    /// The two pictures, grey.
    pub pictures: [Picture; 2],
    /// Exact fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// About 60 exact matches, away from depth edges.
    pub matches: Vec<PointPair>,
}

/// A flat piece of the yard, spanned from `corner` along two orthogonal unit vectors, m.
struct Rectangle {
    corner: Point3<f64>,
    sides: [Vector3<f64>; 2],
    size: [f64; 2],
    brightness: f64,
    seed: u64,
}

/// Returns a pavement between three walls with six boxes on it; x to the right, y away, z up. The
/// seed moves the boxes and changes every texture.
fn yard(seed: u64) -> Vec<Rectangle> {
    let mut random = Pcg32::seed_from_u64(seed);
    let mut rectangles = Vec::new();
    let mut add = |corner, sides, size, brightness| {
        let seed = seed.wrapping_mul(100).wrapping_add(rectangles.len() as u64);
        rectangles.push(Rectangle { corner, sides, size, brightness, seed });
    };
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    add(Point3::new(-12.0, -6.0, 0.0), [x, y], [24.0, 24.0], 0.0);
    add(Point3::new(-6.0, 10.0, 0.0), [x, z], [12.0, 5.2], 15.0);
    add(Point3::new(-3.4, -2.0, 0.0), [y, z], [12.0, 3.6], -25.0);
    add(Point3::new(3.4, -2.0, 0.0), [y, z], [12.0, 4.2], 30.0);
    for k in 0..6 {
        let (sin, cos) = random.random_range(-0.5f64..0.5).sin_cos();
        let (right, away) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0));
        let corner = Point3::new(
            -2.8 + 0.95 * f64::from(k) + random.random_range(-0.2..0.2),
            if k % 2 == 0 { random.random_range(4.6..6.0) } else { random.random_range(6.2..8.5) },
            0.0,
        );
        let (width, height) = (random.random_range(0.5..0.9), random.random_range(0.5..1.9));
        add(corner, [right, z], [width, height], 10.0);
        add(corner, [away, z], [width, height], -35.0);
        add(corner + right * width, [away, z], [width, height], 25.0);
        add(corner + z * height, [right, away], [width, width], 40.0);
    }
    rectangles
}

impl Rectangle {
    /// Returns the grey level at a position on the rectangle: smooth noise of four wavelengths, 0
    /// ..= 255.
    fn shade(&self, a: f64, b: f64) -> f64 {
        let octaves = [(0.9, 70.0), (0.34, 60.0), (0.13, 55.0), (0.05, 45.0)];
        let noise: f64 = octaves
            .iter()
            .map(|(wavelength, weight)| {
                weight * (value_noise(a / wavelength, b / wavelength, self.seed) - 0.5)
            })
            .sum();
        (120.0 + self.brightness + noise).clamp(0.0, 255.0)
    }
}

/// Returns random numbers 0 ..= 1 at the points of the unit lattice, interpolated smoothly.
fn value_noise(x: f64, y: f64, seed: u64) -> f64 {
    let lattice = |i: f64, j: f64| {
        let h = (seed.wrapping_mul(0x1656_67B1_9E37_79F9))
            ^ (i as i64 as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (j as i64 as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
        let h = (h ^ (h >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((h ^ (h >> 29)) >> 40) as f64 / f64::from(1 << 24)
    };
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (smooth(x - i), smooth(y - j));
    let row = |j: f64| lattice(i, j) * (1.0 - u) + lattice(i + 1.0, j) * u;
    row(j) * (1.0 - v) + row(j + 1.0) * v
}

/// The yard as seen by one camera.
struct YardView<'a> {
    rectangles: &'a [Rectangle],
    camera: Camera,
    /// Inverse homography `H⁻¹` of every rectangle; `None` for a rectangle seen edge-on.
    inverses: Vec<Option<Matrix3<f64>>>,
}

impl<'a> YardView<'a> {
    fn new(rectangles: &'a [Rectangle], camera: Camera) -> Self {
        let inverse = |r: &Rectangle| {
            let [u, v] = r.sides.map(|side| camera.matrix() * Vector4::new(side.x, side.y, side.z, 0.0));
            Matrix3::from_columns(&[u, v, camera.matrix() * r.corner.to_homogeneous()]).try_inverse()
        };
        Self { rectangles, camera, inverses: rectangles.iter().map(inverse).collect() }
    }

    /// Returns the rectangle visible at an image point and the position on it, or `None` in the
    /// sky.
    fn seen(&self, p: Point) -> Option<(usize, f64, f64)> {
        let mut nearest = (0.0, None);
        for (k, (r, inverse)) in self.rectangles.iter().zip(&self.inverses).enumerate() {
            let Some(inverse) = inverse else { continue };
            let place = inverse * p.to_homogeneous();
            let (a, b) = (place.x / place.z, place.y / place.z);
            if place.z > nearest.0 && (0.0..=r.size[0]).contains(&a) && (0.0..=r.size[1]).contains(&b) {
                nearest = (place.z, Some((k, a, b)));
            }
        }
        nearest.1
    }

    /// Returns the rectangle visible at an image point and around it, or `None` at the border, in
    /// the sky and at a depth edge.
    fn seen_whole(&self, p: Point, frame: Frame) -> Option<(usize, f64, f64)> {
        let around = [(-5.0, -5.0), (5.0, -5.0), (-5.0, 5.0), (5.0, 5.0)].map(|(x, y)| p + Vector::new(x, y));
        let (rectangle, a, b) = self.seen(p)?;
        let whole = |q: &Point| frame.contains(*q) && self.seen(*q).is_some_and(|(k, ..)| k == rectangle);
        around.iter().all(whole).then_some((rectangle, a, b))
    }

    /// Renders the picture with 3×3 samples per pixel and noise of half a grey level.
    fn picture(&self, frame: Frame, seed: u64) -> Option<Picture> {
        let mut random = Pcg32::seed_from_u64(seed);
        let pixels = image::GrayImage::from_fn(frame.width as u32, frame.height as u32, |x, y| {
            let third = |k: u32| (f64::from(k) - 1.0) / 3.0;
            let sample = |k: u32| {
                let p = Point::new(f64::from(x) + third(k % 3), f64::from(y) + third(k / 3));
                self.seen(p).map_or(235.0, |(r, a, b)| self.rectangles[r].shade(a, b))
            };
            let level = (0..9).map(sample).sum::<f64>() / 9.0 + random.random_range(-1.0..1.0);
            image::Luma([level.round() as u8])
        });
        Picture::from_pixels("test pair".to_owned(), None, DynamicImage::ImageLuma8(pixels)).ok()
    }
}

/// Renders the yard for a camera. Returns `None` only for a frame without pixels.
pub(super) fn yard_picture(camera: Camera, frame: Frame, seed: u64) -> Option<GrayPlane> {
    let yard = yard(seed);
    Some(YardView::new(&yard, camera).picture(frame, seed)?.gray)
}

/// Draws a pair. Returns `None` only for a frame without pixels.
pub fn test_pair(frame: Frame, motion: Motion, seed: u64) -> Option<TestPair> {
    let yard = yard(seed);
    let cameras = motion.cameras(frame)?;
    let [view1, view2] = cameras.map(|camera| YardView::new(&yard, camera));
    let pictures = [view1.picture(frame, 2 * seed)?, view2.picture(frame, 2 * seed + 1)?];
    let mut random = Pcg32::seed_from_u64(seed);
    let mut anywhere = || {
        let (x, y) = (random.random::<f64>(), random.random::<f64>());
        let point1 = Point::new(x * frame.right(), y * frame.bottom());
        let (rectangle, a, b) = view1.seen_whole(point1, frame)?;
        let Rectangle { corner, sides: [u, v], .. } = &yard[rectangle];
        let point2 = view2.camera.project(&(corner + u * a + v * b))?;
        (view2.seen_whole(point2, frame)?.0 == rectangle).then_some(PointPair { point1, point2 })
    };
    // Small frames have few points 5 px away from every edge.
    let matches = (0..6000).filter_map(|_| anywhere()).take(60).collect();
    Some(TestPair { pictures, fundamental: Camera::fundamental(&cameras[0], &cameras[1])?, matches })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::symmetric_epipolar_distance;

    const SMALL: Frame = Frame { width: 256, height: 192 };

    #[test]
    fn matches_fit_every_motion_exactly() {
        for motion in Motion::ALL {
            let pair = test_pair(SMALL, motion, 3).unwrap();
            assert!(pair.matches.len() >= 50, "{motion:?}: {}", pair.matches.len());
            for m in &pair.matches {
                assert!(symmetric_epipolar_distance(&pair.fundamental, m) < 1e-6);
                assert!(SMALL.contains(m.point1) && SMALL.contains(m.point2));
            }
        }
    }

    #[test]
    fn matches_look_alike_and_others_do_not() {
        let pair = test_pair(SMALL, Motion::Sideways, 5).unwrap();
        let [a, b] = [&pair.pictures[0].gray, &pair.pictures[1].gray];
        let difference = |p: Point, q: Point| f64::from((a.sample(p) - b.sample(q)).abs());
        let n = pair.matches.len();
        let mean = |shift: usize| {
            let other = |k: usize| pair.matches[(k + shift) % n].point2;
            (0..n).map(|k| difference(pair.matches[k].point1, other(k))).sum::<f64>() / n as f64
        };
        let (right, wrong) = (mean(0), (1..8).map(mean).sum::<f64>() / 7.0);
        // Half a pixel matters in fine texture, so the difference is not near zero but far below
        // that of wrong matches.
        assert!(right < 12.0 && right < 0.4 * wrong, "{right} against {wrong}");
    }

    #[test]
    fn the_nearest_rectangle_hides_the_others() {
        let straight = Motion::Sideways.cameras(SMALL).unwrap()[0];
        let wall = |distance: f64, half: f64| Rectangle {
            corner: Point3::new(-half, distance, 1.5 - half),
            sides: [Vector3::x(), Vector3::z()],
            size: [2.0 * half; 2],
            brightness: 0.0,
            seed: 0,
        };
        let rectangles = [wall(10.0, 4.0), wall(5.0, 0.5), wall(-3.0, 9.0)];
        let view = YardView::new(&rectangles, straight);
        // The small rectangle reaches 0.5 / 5 · focal = 21.76 px to either side of the centre and
        // hides the large one.
        for (offset, rectangle) in [(0.0, Some(1)), (21.0, Some(1)), (22.5, Some(0)), (95.0, None)] {
            let seen = view.seen(SMALL.centre() + Vector::new(offset, 0.0));
            assert_eq!(seen.map(|s| s.0), rectangle, "{offset}");
        }
    }

    #[test]
    fn pictures_are_repeatable_and_change_with_the_seed() {
        let first =
            |seed| test_pair(Frame::new(32, 24), Motion::Roll, seed).unwrap().pictures[0].gray.clone();
        assert!(first(1) == first(1) && first(1) != first(2));
    }
}
