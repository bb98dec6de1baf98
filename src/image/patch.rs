//! Square patches: normalised correlation and sub-pixel alignment.

use multiversion::multiversion;
use nalgebra::{Matrix2, SMatrix, SVector};

use super::GrayPlane;
use crate::geometry::{Point, Vector};

/// Half width of a patch: 11×11 pixels.
pub(crate) const HALF: usize = 5;
const SIDE: usize = 2 * HALF + 1;
/// Patch values padded to a multiple of eight for the vector units.
const PADDED: usize = 128;

/// A patch with mean zero and norm one, padded with zeros.
pub(crate) type Patch = [f32; PADDED];

/// How the surroundings of a point look in the other image, to first order: offsets in image 2 are `warp` times
/// offsets in image 1.
pub(crate) type Warp = Matrix2<f64>;

/// Warps tried when nothing is known about the surface: the identity, turns by 20°, scale by 4/3, and the
/// foreshortening of a wall seen from another side. Between them, correlation falls off slowly enough.
fn warps() -> Vec<Warp> {
    let turned = |degrees: f64, scale: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Warp::new(cos, -sin, sin, cos) * scale
    };
    let mut all = vec![Warp::identity()];
    for degrees in [-20.0, 20.0] {
        all.push(turned(degrees, 1.0));
    }
    for scale in [0.75, 4.0 / 3.0] {
        for degrees in [-15.0, 0.0, 15.0] {
            all.push(turned(degrees, scale));
        }
    }
    for squeeze in [0.6, 1.6] {
        for shear in [-0.3, 0.0, 0.3] {
            all.push(Warp::new(squeeze, 0.0, shear, 1.0));
        }
    }
    all
}

/// [`warps`] after the one that both images have in common.
pub(crate) fn warps_around(common: &Warp) -> Vec<Warp> {
    let all = warps();
    if *common == Warp::identity() { all } else { all.iter().map(|warp| common * warp).collect() }
}

/// The patch around a point under a warp, by bilinear interpolation; `None` where it is flat.
pub(crate) fn patch(plane: &GrayPlane, centre: Point, warp: &Warp) -> Option<Patch> {
    let mut patch = [0.0; PADDED];
    // In steps along the warped rows and columns; inside the image no position needs a clamp.
    let [a, b, c, d] = [warp.m11, warp.m21, warp.m12, warp.m22].map(|v| v as f32);
    let (x, y) = (centre.x as f32, centre.y as f32);
    let half = HALF as f32;
    let reach = [half * (a.abs() + c.abs()), half * (b.abs() + d.abs())];
    let (right, bottom) = (plane.frame().right() as f32, plane.frame().bottom() as f32);
    let inside = x >= reach[0] && y >= reach[1] && x + reach[0] <= right && y + reach[1] <= bottom;
    for (row, out) in patch.chunks_exact_mut(SIDE).take(SIDE).enumerate() {
        let v = row as f32 - half;
        for (column, value) in out.iter_mut().enumerate() {
            let u = column as f32 - half;
            let (px, py) = (x + a * u + c * v, y + b * u + d * v);
            *value = if inside {
                plane.interpolate(px, py)
            } else {
                plane.sample(Point::new(f64::from(px), f64::from(py)))
            };
        }
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

/// Offsets of a patch's pixels from its centre, row by row.
fn offsets() -> impl Iterator<Item = Vector> {
    let half = HALF as i32;
    (-half..=half).flat_map(move |y| (-half..=half).map(move |x| Vector::new(f64::from(x), f64::from(y))))
}

/// Correlations, −1 to 1, of each of a few normalised patches with many: those of the first patch, then those of
/// the second, and so on. The few stay in the first-level cache while the many pass by once.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
pub(crate) fn correlate_all(few: &[Patch], many: &[Patch], out: &mut Vec<f32>) {
    out.clear();
    out.resize(few.len() * many.len(), 0.0);
    for (j, b) in many.iter().enumerate() {
        for (i, a) in few.iter().enumerate() {
            // Sixteen running sums whatever the instruction set, so that all give the same number.
            let mut sums = [0f32; 16];
            for (x, y) in a.chunks_exact(16).zip(b.chunks_exact(16)) {
                for k in 0..16 {
                    sums[k] += x[k] * y[k];
                }
            }
            out[i * many.len() + j] = sums.iter().sum();
        }
    }
}

/// The position in the second plane near `start2` whose surroundings, under a warp that is adjusted too, fit
/// those of `point1` in the first plane best: least squares over six affine numbers, gain and offset (Lucas &
/// Kanade 1981; Baker & Matthews 2004). `None` when it does not settle within 1.5 px of the start.
pub(crate) fn align(
    planes: [&GrayPlane; 2],
    point1: Point,
    start2: Point,
    warp: &Warp,
) -> Option<(Point, Warp)> {
    let reference: Vec<f64> = offsets().map(|offset| f64::from(planes[0].sample(point1 + offset))).collect();
    let (mut at, mut warp) = (start2, *warp);
    for _ in 0..ITERATIONS {
        let mut normal = SMatrix::<f64, 8, 8>::zeros();
        let mut right = SVector::<f64, 8>::zeros();
        for (offset, reference) in offsets().zip(&reference) {
            let p = at + warp * offset;
            let value = |dx: f64, dy: f64| f64::from(planes[1].sample(Point::new(p.x + dx, p.y + dy)));
            let (gx, gy) =
                (0.5 * (value(1.0, 0.0) - value(-1.0, 0.0)), 0.5 * (value(0.0, 1.0) - value(0.0, -1.0)));
            // gain·I1 + offset − ∇I2·(shift + ΔW·offset) = I2, the warp in units of the half width.
            let (x, y) = (offset.x / HALF as f64, offset.y / HALF as f64);
            let row =
                SVector::<f64, 8>::from([-gx, -gy, -gx * x, -gx * y, -gy * x, -gy * y, *reference, 1.0]);
            normal += row * row.transpose();
            right += row * value(0.0, 0.0);
        }
        // A little damping of the warp keeps patches with one direction of texture from sliding.
        for k in 2..6 {
            normal[(k, k)] += WARP_DAMPING;
        }
        let solution = normal.cholesky()?.solve(&right);
        let step = Vector::new(solution[0], solution[1]);
        at += step;
        warp += Warp::new(solution[2], solution[3], solution[4], solution[5]) / HALF as f64;
        if !step.norm().is_finite() || (at - start2).norm() > 1.5 || !(0.2..4.0).contains(&warp.determinant())
        {
            return None;
        }
        if step.norm() < 0.01 {
            return Some((at, warp));
        }
    }
    None
}

/// Squared grey levels: about the texture of one grey level a pixel over a whole patch.
const WARP_DAMPING: f64 = 500.0;
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
        let (found, _) = align([&plane1, &plane2], corner, corner, &Warp::identity()).unwrap();
        assert!((found - Point::new(30.0 + dx, 28.0 + dy)).norm() < 0.03, "{found}");
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
        let nearest = Warp::new(0.95, -0.3, 0.3, 0.95);
        let (found, warp) = align([&plane1, &plane2], from, Point::new(41.0, 40.0), &nearest).unwrap();
        assert!((found - to).norm() < 0.03, "{found}");
        assert!((warp - truth).norm() < 0.05, "{warp}");
    }

    #[test]
    fn correlation_ignores_brightness_and_flat_patches_have_none() {
        let frame = Frame::new(30, 30);
        let plane = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let darker = GrayPlane::from_fn(frame, |x, y| 0.5 * texture(x as f64, y as f64) + 3.0);
        let at = Point::new(12.0, 13.0);
        let (a, b) =
            (patch(&plane, at, &Warp::identity()).unwrap(), patch(&darker, at, &Warp::identity()).unwrap());
        let mut found = Vec::new();
        correlate_all(&[a], &[b, a], &mut found);
        assert!(found.iter().all(|c| (c - 1.0).abs() < 1e-4));
        assert!(patch(&GrayPlane::from_fn(frame, |_, _| 5.0), at, &Warp::identity()).is_none());
        let flat = GrayPlane::from_fn(frame, |_, _| 5.0);
        assert!(align([&flat, &flat], at, at, &Warp::identity()).is_none());
    }
}
