//! Square patches and their normalised correlation.

use multiversion::multiversion;
use nalgebra::Matrix2;

use super::GrayPlane;
use crate::geometry::Point;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    fn texture(x: f64, y: f64) -> f32 {
        (120.0 + 50.0 * (0.41 * x).sin() * (0.37 * y).cos() + 30.0 * (0.23 * x + 0.31 * y).sin()) as f32
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
    }
}
