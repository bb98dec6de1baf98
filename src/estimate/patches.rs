//! Square patches: normalised correlation and sub-pixel alignment.

use nalgebra::{Matrix4, Vector4};

use crate::geometry::Point;
use crate::image::GrayPlane;

/// Half width of a patch: 11×11 pixels.
pub(crate) const HALF: usize = 5;
const SIDE: usize = 2 * HALF + 1;
/// Patch values padded to a multiple of eight for the vector units.
const PADDED: usize = 128;

/// A patch with mean zero and norm one, padded with zeros.
pub(crate) type Patch = [f32; PADDED];

/// The patch around a pixel at least [`HALF`] px from the border; `None` where it is flat.
pub(crate) fn patch(plane: &GrayPlane, corner: Point) -> Option<Patch> {
    let (x, y) = (corner.x as usize, corner.y as usize);
    let mut patch = [0.0; PADDED];
    for (row, out) in patch.chunks_exact_mut(SIDE).take(SIDE).enumerate() {
        out.copy_from_slice(&plane.row(y + row - HALF)[x - HALF..=x + HALF]);
    }
    let values = &mut patch[..SIDE * SIDE];
    let mean = values.iter().sum::<f32>() / values.len() as f32;
    for value in values.iter_mut() {
        *value -= mean;
    }
    let norm = values.iter().map(|v| v * v).sum::<f32>().sqrt();
    for value in values.iter_mut() {
        *value /= norm;
    }
    (norm > 1e-3).then_some(patch)
}

/// Correlation of two normalised patches, −1 to 1.
pub(crate) fn correlate(a: &Patch, b: &Patch) -> f32 {
    // Eight running sums, so that the compiler may use vectors without reordering a float sum.
    let mut sums = [0f32; 8];
    for (x, y) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum()
}

/// The position in `plane2` near `start2` whose surroundings fit those of `corner1` in `plane1` best, by
/// least squares over shift, gain and offset (Lucas & Kanade 1981). `None` when it does not settle within
/// 1.5 px of the start.
pub(crate) fn align(planes: [&GrayPlane; 2], corner1: Point, start2: Point) -> Option<Point> {
    let offsets = || {
        let half = HALF as i32;
        (-half..=half).flat_map(move |y| (-half..=half).map(move |x| (f64::from(x), f64::from(y))))
    };
    let mut at = start2;
    for _ in 0..ITERATIONS {
        let (mut normal, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
        for (x, y) in offsets() {
            let p = Point::new(at.x + x, at.y + y);
            let value = |dx: f64, dy: f64| f64::from(planes[1].sample(Point::new(p.x + dx, p.y + dy)));
            let reference = f64::from(planes[0].sample(Point::new(corner1.x + x, corner1.y + y)));
            // gain·I1 + offset − ∇I2·step = I2
            let row = Vector4::new(
                -0.5 * (value(1.0, 0.0) - value(-1.0, 0.0)),
                -0.5 * (value(0.0, 1.0) - value(0.0, -1.0)),
                reference,
                1.0,
            );
            normal += row * row.transpose();
            right += row * value(0.0, 0.0);
        }
        let solution = normal.cholesky()?.solve(&right);
        let step = nalgebra::Vector2::new(solution[0], solution[1]);
        at += step;
        if (at - start2).norm() > 1.5 || !step.norm().is_finite() {
            return None;
        }
        if step.norm() < 0.01 {
            return Some(at);
        }
    }
    None
}

const ITERATIONS: usize = 10;

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
        let found = align([&plane1, &plane2], corner, corner).unwrap();
        assert!((found - Point::new(30.0 + dx, 28.0 + dy)).norm() < 0.03, "{found}");
    }

    #[test]
    fn correlation_ignores_brightness_and_flat_patches_have_none() {
        let frame = Frame::new(30, 30);
        let plane = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let darker = GrayPlane::from_fn(frame, |x, y| 0.5 * texture(x as f64, y as f64) + 3.0);
        let at = Point::new(12.0, 13.0);
        let (a, b) = (patch(&plane, at).unwrap(), patch(&darker, at).unwrap());
        assert!((correlate(&a, &b) - 1.0).abs() < 1e-4);
        assert!(patch(&GrayPlane::from_fn(frame, |_, _| 5.0), at).is_none());
        assert!(align([&GrayPlane::from_fn(frame, |_, _| 5.0), &plane], at, at).is_none());
    }
}
