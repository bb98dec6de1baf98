//! Static overlays: image content at the same place in both pictures although the scene moves, such
//! as captions, logos and dirt on the sensor.
//!
//! A static point lies on its own epipolar line under every pure translation, `x · [e]ₓ x = 0`,
//! whatever the epipole. A caption therefore supports every epipole and says nothing about the
//! scene. Such places are excluded before anything is matched.

use super::{GrayPlane, HALF, Patch, PatchSampler, Warp, correlation, find_corners};
use crate::geometry::{Point, Vector, rescaled};

/// Longer side at which pictures are compared, px. Letters have corners at this size.
pub(super) const COMPARED_SIDE: f64 = 768.0;
/// Number of corners compared.
const CORNERS: usize = 1500;
/// Correlation from which two patches show the same content. The margin allows for noise and
/// compression.
const SAME: f32 = 0.9;
/// Search radius for a moved corner, px.
const REACH: usize = 4;
/// Largest displacement of a static corner, px: about the accuracy of a correlation peak.
const STILL: f64 = 0.25;
/// Minimum number of static corners beyond the number expected by chance.
const FEWEST: f64 = 10.0;
/// Minimum excess over the number expected by chance, in standard deviations of that number.
const DEVIATIONS: f64 = 5.0;
/// Fraction of static corners above which the camera itself was static.
const MOST: f64 = 0.25;

/// Excluded places, the same in both pictures.
#[derive(Debug, Clone)]
pub(crate) struct FixedContent {
    /// Static corners, in pixels of the compared size.
    corners: Vec<Point>,
    /// Compared size over full size.
    scale: f64,
}

impl FixedContent {
    /// Finds static overlays in two pictures of one size, at `scale` times the full size. Returns
    /// `None` if there are none, or if the camera itself was static.
    pub(super) fn find(planes: [&GrayPlane; 2], scale: f64) -> Option<Self> {
        if planes[0].frame() != planes[1].frame() {
            return None;
        }
        let [sampler1, sampler2] = planes.map(|plane| PatchSampler::new(plane, &Warp::identity()));
        let patches: Vec<(Point, Patch)> = find_corners(planes[0], CORNERS, HALF + REACH + 1)
            .into_iter()
            .filter_map(|corner| Some((corner, sampler1.patch(corner)?)))
            .collect();
        let alike = |(corner, patch): &(Point, Patch), offset: Vector| {
            sampler2.patch(corner + offset).map_or(-1.0, |other| correlation(patch, &other))
        };
        let same_place = |of: &&(Point, Patch)| alike(of, Vector::zeros()) >= SAME;
        let stay: Vec<Point> = patches
            .iter()
            .filter(same_place)
            .filter(|of| is_still(|x, y| alike(of, Vector::new(x, y))))
            .map(|of| of.0)
            .collect();
        let count = stay.len() as f64;
        if count < FEWEST || count > MOST * patches.len() as f64 {
            return None;
        }
        // Under small motions some corners stay by chance. If all displacements were equally
        // frequent, this fraction of the slowly moving corners would count as static.
        let little = patches.iter().filter(|of| moves_little(|x, y| alike(of, Vector::new(x, y)))).count();
        let by_chance = STILL / (REACH as f64 + 0.5) * (count + little as f64);
        let is_more = count >= FEWEST + by_chance + DEVIATIONS * by_chance.sqrt();
        is_more.then_some(Self { corners: stay, scale })
    }

    /// Returns the number of static corners.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// Returns whether a patch around a point of either picture, in full-size pixels, shows static
    /// content.
    pub(crate) fn covers(&self, point: Point) -> bool {
        let near = (HALF + 1) as f64;
        let place = rescaled(point, self.scale);
        self.corners.iter().any(|corner| (corner - place).amax() <= near)
    }
}

/// Returns whether the correlation peaks at zero offset.
fn is_still(alike: impl Fn(f64, f64) -> f32) -> bool {
    let middle = f64::from(alike(0.0, 0.0));
    let off = |before: f32, behind: f32| {
        let (before, behind) = (f64::from(before), f64::from(behind));
        let bend = before + behind - 2.0 * middle;
        // A parabola through three values locates the peak.
        (before.max(behind) <= middle && bend < 0.0).then(|| 0.5 * (before - behind) / bend)
    };
    let x = off(alike(-1.0, 0.0), alike(1.0, 0.0));
    let y = off(alike(0.0, -1.0), alike(0.0, 1.0));
    x.zip(y).is_some_and(|(x, y)| x.hypot(y) < STILL)
}

/// Returns whether a corner is found again near its place, but not at it.
fn moves_little(alike: impl Fn(f64, f64) -> f32) -> bool {
    let (mut best, mut place) = (SAME, None);
    let reach = REACH as i32;
    for y in -reach..=reach {
        for x in -reach..=reach {
            let value = alike(f64::from(x), f64::from(y));
            if value > best {
                (best, place) = (value, Some((x, y)));
            }
        }
    }
    place.is_some_and(|place| place != (0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    /// Returns blobs that move by `(x, y)` px under a static caption.
    fn picture(x: f64, y: f64, caption: bool) -> GrayPlane {
        let hash = |i: i64, j: i64| {
            let h = (i.wrapping_mul(0x9E37_79B9) ^ j.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0xC2B2_AE35);
            ((h >> 13) & 255) as f32
        };
        GrayPlane::from_fn(Frame::new(480, 320), |px, py| {
            if caption && (285..305).contains(&py) && px < 160 {
                return hash(px as i64 / 5, py as i64 / 5 + 1000);
            }
            let (u, v) = ((px as f64 - x) / 7.0, (py as f64 - y) / 7.0);
            let (i, j) = (u.floor() as i64, v.floor() as i64);
            let (a, b) = ((u - u.floor()) as f32, (v - v.floor()) as f32);
            let row = |j: i64| hash(i, j) * (1.0 - a) + hash(i + 1, j) * a;
            row(j) * (1.0 - b) + row(j + 1) * b
        })
    }

    #[test]
    fn a_caption_is_found_and_what_moves_is_not_covered() {
        let [one, two] = [picture(0.0, 0.0, true), picture(23.4, -9.7, true)];
        let fixed = FixedContent::find([&one, &two], 0.5).expect("a caption");
        assert!(fixed.len() > 20, "{}", fixed.len());
        // At a scale of ½, full-size coordinates are doubled.
        assert!(fixed.covers(Point::new(205.0, 580.0)));
        assert!(!fixed.covers(Point::new(200.0, 300.0)) && !fixed.covers(Point::new(800.0, 590.0)));
    }

    #[test]
    fn without_a_caption_with_a_camera_that_stood_still_or_moved_little_nothing_is_left_out() {
        let one = picture(0.0, 0.0, false);
        for (x, y) in [(23.4, -9.7), (0.0, 0.0), (0.1, 0.0), (0.7, 0.4), (2.0, 1.0)] {
            assert!(FixedContent::find([&one, &picture(x, y, false)], 1.0).is_none(), "{x} {y}");
        }
        let other_size = GrayPlane::from_fn(Frame::new(320, 480), |x, y| (x + y) as f32);
        assert!(FixedContent::find([&one, &other_size], 1.0).is_none());
    }
}
