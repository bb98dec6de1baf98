//! Sub-pixel alignment of a patch under an affine map, gain and offset.
//!
//! Least squares over shift, affine map, gain and offset (Lucas & Kanade 1981; Baker & Matthews 2004, forward
//! additive):
//!
//! ```text
//!     gain·I1(p + x) + offset = I2(q + A x)        x in a square around 0
//! ```
//!
//! # Pitfalls
//! - Weakly textured patches do not determine the affine map, and those with one direction of texture slide: the map is
//!   held back, see [`Hold`].

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::GrayPlane;
use super::patch::{HALF, Warp};
use crate::geometry::{Point, Vector};

/// Where a patch of the first image lies in the second: `at + affine · x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub at: Point,
    pub affine: Warp,
}

/// How patches are aligned.
#[derive(Debug)]
pub(crate) struct Alignment {
    iterations: usize,
    /// A step shorter than this is the last one, px.
    settled: f64,
    /// Whether a patch that has not settled at the end is given up.
    must_settle: bool,
    /// Largest way from the start, px.
    largest_move: f64,
    /// Determinants that the affine map may have, if it matters.
    determinants: Option<Range<f64>>,
    /// Share of the samples that must lie inside both images, the others do not count. `None`: all count, with the
    /// nearest intensity of the border.
    least_inside: Option<f64>,
    hold: Hold,
    /// Grey levels are counted from here, and offsets from the centre in units of so many px: conditions the equations.
    middle: f64,
    unit: f64,
}

/// What keeps the affine map from going astray.
#[derive(Debug)]
enum Hold {
    /// A penalty on each step of it, squared grey levels.
    Step(f64),
    /// A penalty on its way from the start, in shares of what the gradients of the image say.
    Start(f64),
}

impl Alignment {
    /// For pairs of corners that look alike, from starts a pixel off.
    pub(crate) const STRICT: Self = Self {
        iterations: 10,
        settled: 0.01,
        must_settle: true,
        largest_move: 1.5,
        determinants: Some(0.2..4.0),
        least_inside: None,
        // About the texture of one grey level a pixel over a whole patch.
        hold: Hold::Step(500.0),
        middle: 0.0,
        unit: HALF as f64,
    };

    /// For any place of an image, borders too, from starts that a smaller size of the images gave.
    pub(crate) const LENIENT: Self = Self {
        iterations: 8,
        settled: 0.02,
        must_settle: false,
        largest_move: 2.5,
        determinants: None,
        least_inside: Some(LEAST_INSIDE),
        hold: Hold::Start(0.1),
        middle: 128.0,
        unit: 1.0,
    };
}

/// In the corner of an image little more than a quarter of a patch is inside.
pub(crate) const LEAST_INSIDE: f64 = 0.25;

/// Offsets of a patch's pixels from its centre, row by row.
pub(crate) fn offsets() -> impl Iterator<Item = Vector> {
    let half = HALF as i32;
    (-half..=half).flat_map(move |y| (-half..=half).map(move |x| Vector::new(f64::from(x), f64::from(y))))
}

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

/// The placement near `start` under which the surroundings of `point1` in the first plane fit the second best; `None`
/// when it runs away, does not settle or is too far outside.
pub(crate) fn align(
    planes: [&GrayPlane; 2],
    point1: Point,
    start: Placement,
    how: &Alignment,
) -> Option<Placement> {
    let counts = |image: usize, p: Point| how.least_inside.is_none() || planes[image].frame().contains(p);
    let reference: Vec<(Vector, f64)> = offsets()
        .filter(|x| counts(0, point1 + x))
        .map(|x| (x, f64::from(planes[0].sample(point1 + x)) - how.middle))
        .collect();
    let least = how.least_inside.unwrap_or(0.0) * offsets().count() as f64;
    let mut placed = start;
    for _ in 0..how.iterations {
        let (mut normal, mut right, mut inside) = (Matrix8::zeros(), Vector8::zeros(), 0.0);
        for (offset, reference) in &reference {
            let q = placed.at + placed.affine * offset;
            if !counts(1, q) {
                continue;
            }
            inside += 1.0;
            let value = |dx: f64, dy: f64| f64::from(planes[1].sample(Point::new(q.x + dx, q.y + dy)));
            let gx = 0.5 * (value(1.0, 0.0) - value(-1.0, 0.0));
            let gy = 0.5 * (value(0.0, 1.0) - value(0.0, -1.0));
            // gain·I1 + offset − ∇I2·(step + dA x) = I2
            let (x, y) = (offset.x / how.unit, offset.y / how.unit);
            let row = Vector8::from([-gx, -gy, -gx * x, -gx * y, -gy * x, -gy * y, *reference, 1.0]);
            normal.syger(1.0, &row, &row, 1.0);
            right += row * (value(0.0, 0.0) - how.middle);
        }
        if inside < least {
            return None;
        }
        let gradient = normal[(0, 0)] + normal[(1, 1)];
        for k in 2..6 {
            match how.hold {
                Hold::Step(penalty) => normal[(k, k)] += penalty,
                Hold::Start(share) => {
                    let penalty = share * gradient * (HALF as f64 / how.unit).powi(2);
                    let drift = how.unit * (placed.affine - start.affine)[((k - 2) / 2, (k - 2) % 2)];
                    normal[(k, k)] += penalty;
                    right[k] -= penalty * drift;
                }
            }
        }
        let solution = normal.cholesky()?.solve(&right);
        let step = Vector::new(solution[0], solution[1]);
        placed.at += step;
        placed.affine += Warp::new(solution[2], solution[3], solution[4], solution[5]) / how.unit;
        let far = (placed.at - start.at).norm();
        let determinant = placed.affine.determinant();
        if !far.is_finite()
            || far > how.largest_move
            || how.determinants.as_ref().is_some_and(|allowed| !allowed.contains(&determinant))
        {
            return None;
        }
        if step.norm() < how.settled {
            return Some(placed);
        }
    }
    (!how.must_settle).then_some(placed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    fn texture(x: f64, y: f64) -> f32 {
        (120.0 + 50.0 * (0.41 * x).sin() * (0.37 * y).cos() + 30.0 * (0.23 * x + 0.31 * y).sin()) as f32
    }

    #[test]
    fn alignment_finds_a_fraction_of_a_pixel_under_a_change_of_brightness() {
        let frame = Frame::new(60, 60);
        let plane1 = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let (dx, dy) = (0.37, -0.61);
        let plane2 = GrayPlane::from_fn(frame, |x, y| 0.8 * texture(x as f64 - dx, y as f64 - dy) + 12.0);
        let corner = Point::new(30.0, 28.0);
        let start = Placement { at: corner, affine: Warp::identity() };
        for how in [&Alignment::STRICT, &Alignment::LENIENT] {
            let Placement { at, .. } = align([&plane1, &plane2], corner, start, how).unwrap();
            assert!((at - Point::new(30.0 + dx, 28.0 + dy)).norm() < 0.03, "{at}");
        }
    }

    #[test]
    fn alignment_follows_a_turned_and_scaled_surface() {
        let frame = Frame::new(80, 80);
        let truth = Warp::new(1.1, -0.25, 0.2, 1.15);
        let (from, to) = (Point::new(40.0, 38.0), Point::new(41.3, 39.6));
        let plane1 = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let inverse = truth.try_inverse().unwrap();
        let plane2 = GrayPlane::from_fn(frame, |x, y| {
            let p = from + inverse * (Point::new(x as f64, y as f64) - to);
            texture(p.x, p.y)
        });
        let start = Placement { at: Point::new(41.0, 40.0), affine: Warp::new(0.95, -0.3, 0.3, 0.95) };
        let Placement { at, affine } = align([&plane1, &plane2], from, start, &Alignment::STRICT).unwrap();
        assert!((at - to).norm() < 0.03, "{at}");
        assert!((affine - truth).norm() < 0.05, "{affine}");
    }

    #[test]
    fn flat_patches_are_not_aligned() {
        let flat = GrayPlane::from_fn(Frame::new(30, 30), |_, _| 5.0);
        let start = Placement { at: Point::new(12.0, 13.0), affine: Warp::identity() };
        assert!(align([&flat, &flat], start.at, start, &Alignment::STRICT).is_none());
    }
}
