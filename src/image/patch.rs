//! Square patches of intensities around image points, with zero mean and unit norm.

use multiversion::multiversion;
use nalgebra::Matrix2;

use super::GrayPlane;
use crate::geometry::{Point, Vector};
use crate::lanes::LANES;

/// Half width of a patch: 11×11 pixels.
pub(crate) const HALF: usize = 5;
pub(super) const SIDE: usize = 2 * HALF + 1;
pub(super) const AREA: usize = SIDE * SIDE;
/// Number of patch values, padded to a multiple of the vector lanes.
pub(super) const PADDED: usize = 128;

/// Returns the offsets from the centre of a square of `2 half + 1` pixels a side, row by row.
pub(crate) fn offsets(half: usize) -> impl Iterator<Item = Vector> {
    let side = 2 * half + 1;
    let from_middle = move |k: usize| k as f64 - half as f64;
    (0..side * side).map(move |k| Vector::new(from_middle(k % side), from_middle(k / side)))
}

/// A patch with zero mean and unit norm, padded with zeros.
pub(crate) type Patch = [f32; PADDED];

/// First-order map between the surroundings of matching points: offsets in image 2 are `warp` times
/// offsets in image 1.
pub(crate) type Warp = Matrix2<f64>;

/// Rotations without a change of scale, degrees. Correlation falls off slowly enough to cover
/// rotations in between.
const TURNS: [f64; 2] = [-20.0, 20.0];
/// Scale changes. `ZOOM_TURNS` are the rotations combined with each, degrees.
const ZOOMS: [f64; 2] = [0.75, 4.0 / 3.0];
const ZOOM_TURNS: [f64; 3] = [-15.0, 0.0, 15.0];
/// Widths of a wall seen from another side, relative to its width in this image. `SHEARS` are the
/// slants of its rows, px per px.
const SQUEEZES: [f64; 2] = [0.6, 1.6];
const SHEARS: [f64; 3] = [-0.3, 0.0, 0.3];

/// Returns the warps tried when nothing is known about the surface: the identity, rotations by 20°,
/// scales of 4/3, and the foreshortening of a wall. Correlation falls off slowly enough to cover
/// warps in between.
fn warps() -> Vec<Warp> {
    let turned = |degrees: f64, scale: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Warp::new(cos, -sin, sin, cos) * scale
    };
    let mut all = vec![Warp::identity()];
    all.extend(TURNS.map(|degrees| turned(degrees, 1.0)));
    all.extend(ZOOMS.iter().flat_map(|scale| ZOOM_TURNS.map(|degrees| turned(degrees, *scale))));
    all.extend(SQUEEZES.iter().flat_map(|squeeze| SHEARS.map(|shear| Warp::new(*squeeze, 0.0, shear, 1.0))));
    all
}

/// Returns [`warps`] composed with the warp common to both images; at most [`LANES`].
pub(crate) fn warps_around(common: &Warp) -> Vec<Warp> {
    let all = warps();
    if *common == Warp::identity() { all } else { all.iter().map(|warp| common * warp).collect() }
}

/// A sampler of patches from one plane under one warp.
///
/// Corners are at whole pixels, so the samples around all corners share their positions between
/// pixels, which are computed once.
#[derive(Debug)]
pub(crate) struct PatchSampler<'a> {
    plane: &'a GrayPlane,
    warp: Warp,
    /// Half width and half height of the sampled area, px.
    reach: [f64; 2],
    /// Index of the pixel above left of each sample, relative to the first pixel needed. `before`
    /// is the relative index of the centre.
    offsets: [usize; AREA],
    before: usize,
    /// Position of each sample between its pixels, px.
    right: [f32; AREA],
    down: [f32; AREA],
}

impl<'a> PatchSampler<'a> {
    pub(crate) fn new(plane: &'a GrayPlane, warp: &Warp) -> Self {
        let half = HALF as f64;
        let reach = [half * (warp.m11.abs() + warp.m12.abs()), half * (warp.m21.abs() + warp.m22.abs())];
        // Whole pixels, so that all offsets count from the first pixel.
        let [left, up] = reach.map(f64::ceil);
        let width = plane.frame().width;
        let (mut offsets, mut right, mut down) = ([0; AREA], [0.0; AREA], [0.0; AREA]);
        for (k, offset) in self::offsets(HALF).enumerate() {
            let q = warp * offset + nalgebra::Vector2::new(left, up);
            offsets[k] = q.y.floor() as usize * width + q.x.floor() as usize;
            (right[k], down[k]) = ((q.x - q.x.floor()) as f32, (q.y - q.y.floor()) as f32);
        }
        let before = up as usize * width + left as usize;
        Self { plane, warp: *warp, reach, offsets, before, right, down }
    }

    /// Returns the patch around a point, by bilinear interpolation. Returns `None` when the patch
    /// is flat or touches pixels that are no picture.
    pub(crate) fn patch(&self, centre: Point) -> Option<Patch> {
        if !self.plane.is_clear(centre, self.reach[0].max(self.reach[1])) {
            return None;
        }
        if let Some(pixels) = self.pixels(centre) {
            return sampled(self, pixels, self.plane.frame().width);
        }
        let mut patch = [0.0; PADDED];
        for (value, offset) in patch.iter_mut().zip(offsets(HALF)) {
            *value = self.plane.sample(centre + self.warp * offset);
        }
        normalised(&patch)
    }

    /// Returns the pixels from the first one needed, if the centre is a whole pixel and all samples
    /// are inside the image.
    fn pixels(&self, centre: Point) -> Option<&[f32]> {
        let frame = self.plane.frame();
        let [reach_x, reach_y] = self.reach.map(f64::ceil);
        let is_inside = centre.x >= reach_x
            && centre.y >= reach_y
            && centre.x + reach_x < frame.right()
            && centre.y + reach_y < frame.bottom();
        let is_whole = centre.x.fract() == 0.0 && centre.y.fract() == 0.0;
        let index = || centre.y as usize * frame.width + centre.x as usize;
        (is_inside && is_whole).then(|| &self.plane.values()[index() - self.before..])
    }
}

/// Samples a patch from the pixels that begin with the first one needed.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn sampled(sampler: &PatchSampler, pixels: &[f32], width: usize) -> Option<Patch> {
    // The pixels of a row and those below them, in slices of one length: one check serves both.
    let count = pixels.len() - width;
    let (upper, lower) = (&pixels[..count], &pixels[width..][..count]);
    let (mut tops, mut belows) = ([[0f32; 2]; AREA], [[0f32; 2]; AREA]);
    for k in 0..AREA {
        let first = sampler.offsets[k];
        let (top, below) = (&upper[first..first + 2], &lower[first..first + 2]);
        (tops[k], belows[k]) = ([top[0], top[1]], [below[0], below[1]]);
    }
    let mut patch = [0.0; PADDED];
    for k in 0..AREA {
        let a = tops[k][0] + (tops[k][1] - tops[k][0]) * sampler.right[k];
        let b = belows[k][0] + (belows[k][1] - belows[k][0]) * sampler.right[k];
        patch[k] = a + (b - a) * sampler.down[k];
    }
    normalised(&patch)
}

/// Returns the correlation of two patches, −1 to 1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
pub(crate) fn correlation(a: &Patch, b: &Patch) -> f32 {
    let mut products = [0f32; PADDED];
    for k in 0..PADDED {
        products[k] = a[k] * b[k];
    }
    sum(&products)
}

/// Normalises a patch to zero mean and unit norm. Returns `None` when the patch is flat.
#[inline]
fn normalised(patch: &Patch) -> Option<Patch> {
    let mean = sum(patch) / AREA as f32;
    let (mut centred, mut squares) = ([0.0; PADDED], [0.0; PADDED]);
    for k in 0..AREA {
        centred[k] = patch[k] - mean;
        squares[k] = centred[k] * centred[k];
    }
    let norm = sum(&squares).sqrt();
    if norm <= 1e-3 || norm.is_nan() {
        return None;
    }
    for value in &mut centred {
        *value /= norm;
    }
    Some(centred)
}

#[inline]
fn sum(values: &Patch) -> f32 {
    let mut sums = [0f32; LANES];
    for group in 0..PADDED / LANES {
        for lane in 0..LANES {
            sums[lane] += values[group * LANES + lane];
        }
    }
    let mut total = 0.0;
    for sum in sums {
        total += sum;
    }
    total
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::Frame;

    fn texture(x: f64, y: f64) -> f32 {
        (120.0 + 50.0 * (0.41 * x).sin() * (0.37 * y).cos() + 30.0 * (0.23 * x + 0.31 * y).sin()) as f32
    }

    /// Returns a textured plane with its intensities changed by `brightness`.
    pub(in crate::image) fn plane(brightness: impl Fn(f32) -> f32) -> GrayPlane {
        GrayPlane::from_fn(Frame::new(40, 36), |x, y| brightness(texture(x as f64, y as f64)))
    }

    #[test]
    fn what_is_computed_once_for_whole_pixels_is_what_interpolation_gives() {
        let plane = plane(|v| v);
        for warp in warps() {
            let sampler = PatchSampler::new(&plane, &warp);
            // Inside, at the border, and between pixels.
            for at in [
                Point::new(20.0, 17.0),
                Point::new(5.0, 6.0),
                Point::new(34.0, 30.0),
                Point::new(19.5, 17.25),
            ] {
                let mut expected = [0.0; PADDED];
                for (value, offset) in expected.iter_mut().zip(offsets(HALF)) {
                    *value = plane.sample(at + warp * offset);
                }
                let (found, expected) = (sampler.patch(at).unwrap(), normalised(&expected).unwrap());
                let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(apart < 1e-4, "{warp} {at}: {apart}");
            }
        }
    }
}
