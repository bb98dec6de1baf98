//! Sub-pixel alignment of a patch under an affine map, gain and offset.
//!
//! Least squares over shift, affine map, gain and offset (Lucas & Kanade 1981; Baker & Matthews
//! 2004, inverse compositional):
//!
//! ```text
//!     gain·I1(p + x) + offset = I2(q + A x)        x in a square around 0
//! ```
//!
//! Each step moves the patch of the first image and applies the inverse to the map. Only gradients of
//! the first image are needed, so the matrix of the equations is the same for all steps.
//!
//! # Pitfalls
//! - Weakly textured patches do not determine the affine map, and patches with one texture
//!   direction slide along it. [`Hold`] therefore penalises changes of the affine map.

use multiversion::multiversion;

use super::GrayPlane;
use super::alignment_equations::{Equations, PADDED, SampledOffsets};
use super::alignment_settings::{Alignment, Hold};
use super::patch::{HALF, Warp, offsets};
use super::plane::interpolate_all;
use crate::geometry::{Point, Vector};

/// Position of a first-image patch in the second image: `at + affine · x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub at: Point,
    pub affine: Warp,
}

/// Finds the placement near `start` that best aligns the surroundings of `point1` in the first
/// plane with the second plane. Returns `None` when the placement diverges, does not converge, or
/// lies too far outside or where there is no picture.
pub(crate) fn align(
    planes: [&GrayPlane; 2],
    point1: Point,
    start: Placement,
    how: &Alignment,
) -> Option<Placement> {
    let counts = |image: usize, p: Point| {
        how.least_inside.is_none() || planes[image].frame().contains(p) && planes[image].is_clear(p, 0.0)
    };
    // Samples that count as they are must all be picture.
    let clear = if how.least_inside.is_none() { HALF as f64 } else { 0.0 };
    let area = (2 * how.half + 1).pow(2);
    let least = how.least_inside.unwrap_or(0.0) * area as f64;
    let samples: SampledOffsets = offsets(how.half).filter(|x| counts(0, point1 + x)).collect();
    let mut sampler = Sampler::new(planes[1]);
    let mut placed = start;
    let mut equations: Option<Equations> = None;
    let mut gain = 1.0;
    for _ in 0..how.iterations {
        sampler.sample(&samples, &placed);
        if how.least_inside.is_some() {
            sampler.count(&samples, |offset| counts(1, placed.at + placed.affine * offset));
        }
        let used = sampler.used(&samples);
        if (used as f64) < least {
            return None;
        }
        let equations = if let Some(same) = equations.take().filter(|equations| equations.used == used) {
            equations.insert(same)
        } else {
            equations.insert(Equations::new(planes[0], point1, &samples, &sampler.counts, how)?)
        };
        let mut right = equations.right(&sampler.values, how.middle);
        if let Hold::Start(_) = how.hold {
            // The change that would lead back to the start.
            let back = placed.affine.try_inverse()? * (placed.affine - start.affine) * (how.unit * gain);
            for k in 2..6 {
                right[k] += equations.penalty * back[((k - 2) / 2, (k - 2) % 2)];
            }
        }
        let solution = equations.cholesky.solve(&right);
        gain = solution[6];
        let step = |k: usize| solution[k] / gain;
        let change = Warp::new(step(2), step(3), step(4), step(5)) / how.unit;
        placed.affine *= (Warp::identity() + change).try_inverse()?;
        let step = placed.affine * Vector::new(step(0), step(1));
        placed.at -= step;
        let far = (placed.at - start.at).norm();
        let determinant = placed.affine.determinant();
        if !far.is_finite()
            || far > how.largest_move
            || !planes[1].is_clear(placed.at, clear)
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

/// Values of the second plane under the current placement.
struct Sampler<'a> {
    plane: &'a GrayPlane,
    x: [f32; PADDED],
    y: [f32; PADDED],
    values: [f32; PADDED],
    /// Whether each sample counts. Empty if all do.
    counts: Vec<bool>,
}

impl<'a> Sampler<'a> {
    fn new(plane: &'a GrayPlane) -> Self {
        Self { plane, x: [0.0; PADDED], y: [0.0; PADDED], values: [0.0; PADDED], counts: Vec::new() }
    }

    /// Samples around the placement. Outside the plane, the nearest border value is taken.
    fn sample(&mut self, samples: &SampledOffsets, placed: &Placement) {
        let frame = self.plane.frame();
        let ends = [frame.right().max(0.0) as f32, frame.bottom().max(0.0) as f32];
        let padded = samples.padded();
        let (x, y) = (&mut self.x[..padded], &mut self.y[..padded]);
        positions(samples, placed, ends, x, y);
        interpolate_all(self.plane, x, y, &mut self.values[..padded]);
    }

    /// Finds out which samples count.
    fn count(&mut self, samples: &SampledOffsets, counts: impl Fn(Vector) -> bool) {
        self.counts.clear();
        self.counts.extend(samples.iter().map(counts));
    }

    /// Returns the number of samples that count.
    fn used(&self, samples: &SampledOffsets) -> usize {
        if self.counts.is_empty() {
            samples.len()
        } else {
            self.counts.iter().filter(|counts| **counts).count()
        }
    }
}

/// Computes the positions of samples under a placement, moved to the nearest position up to `ends`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn positions(samples: &SampledOffsets, placed: &Placement, ends: [f32; 2], x: &mut [f32], y: &mut [f32]) {
    let Placement { at, affine } = placed;
    let (across, down) = (&samples.x[..x.len()], &samples.y[..x.len()]);
    let y = &mut y[..x.len()];
    for k in 0..x.len() {
        let moved_x = at.x + (affine.m11 * across[k] + affine.m12 * down[k]);
        let moved_y = at.y + (affine.m21 * across[k] + affine.m22 * down[k]);
        x[k] = (moved_x as f32).clamp(0.0, ends[0]);
        y[k] = (moved_y as f32).clamp(0.0, ends[1]);
    }
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
