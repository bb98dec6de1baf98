//! What both pictures show at the very same place though the scene does not stay: captions, a logo, dirt on the sensor.
//!
//! A point that does not move lies on its own line under every pure translation, `x · [e]ₓ x = 0`, whatever the epipole: a
//! caption supports any epipole there is, and says nothing of the scene. So such places are left out before anything is
//! matched.

use super::{GrayPlane, HALF, Patch, PatchSampler, Warp, correlation, find_corners};
use crate::geometry::{Point, Vector, rescaled};

/// Longer side at which pictures are compared, px: letters have corners there.
pub(super) const COMPARED_SIDE: f64 = 768.0;
/// Corners that are compared.
const CORNERS: usize = 1500;
/// Correlation from which two patches show the same: noise and compression are left to it.
const SAME: f32 = 0.9;
/// How far corners are looked for around their place, px.
const REACH: usize = 4;
/// Within this they have not moved, px: what the place of a correlation's peak is good to.
const STILL: f64 = 0.25;
/// Corners that stay, at least, beyond those that chance puts there.
const FEWEST: f64 = 10.0;
/// More than chance, in standard deviations of its number.
const DEVIATIONS: f64 = 5.0;
/// With more of the corners than these staying it is the camera that stood still.
const MOST: f64 = 0.25;

/// Places that are left out, the same in both pictures.
#[derive(Debug, Clone)]
pub(crate) struct FixedContent {
    /// Corners that stay, pixels of the compared size.
    corners: Vec<Point>,
    /// Size over full size.
    scale: f64,
}

impl FixedContent {
    /// Looks for it in two pictures of a size, `scale` of the full one.
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
        // Where everything moves a little, some corners stay by chance. Were all distances equally frequent, as around a
        // point that stays, this part of those that move little would.
        let little = patches.iter().filter(|of| moves_little(|x, y| alike(of, Vector::new(x, y)))).count();
        let by_chance = STILL / (REACH as f64 + 0.5) * (count + little as f64);
        let is_more = count >= FEWEST + by_chance + DEVIATIONS * by_chance.sqrt();
        is_more.then_some(Self { corners: stay, scale })
    }

    /// Corners that stay.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether a point of either picture, in full-size pixels, is so near to it that a patch around it shows some of it.
    pub(crate) fn covers(&self, point: Point) -> bool {
        let near = (HALF + 1) as f64;
        let place = rescaled(point, self.scale);
        self.corners.iter().any(|corner| (corner - place).amax() <= near)
    }
}

/// Whether the correlation has its peak where there is no offset.
fn is_still(alike: impl Fn(f64, f64) -> f32) -> bool {
    let middle = f64::from(alike(0.0, 0.0));
    let off = |before: f32, behind: f32| {
        let (before, behind) = (f64::from(before), f64::from(behind));
        let bend = before + behind - 2.0 * middle;
        // A parabola through three values.
        (before.max(behind) <= middle && bend < 0.0).then(|| 0.5 * (before - behind) / bend)
    };
    let x = off(alike(-1.0, 0.0), alike(1.0, 0.0));
    let y = off(alike(0.0, -1.0), alike(0.0, 1.0));
    x.zip(y).is_some_and(|(x, y)| x.hypot(y) < STILL)
}

/// Whether a corner is found again near its place, but not there.
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

    /// Blobs that move by `(x, y)` px, under a caption that stays.
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
        // Full-size pixels: twice those.
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
