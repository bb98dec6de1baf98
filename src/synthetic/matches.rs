//! Exact matches: where one scene point is seen in two pictures.
//!
//! A ray through a pixel of image 1 finds the scene point `X`; image 2 shows it at `P2 X` if it lies in
//! front of camera 2, inside the picture, and nothing is between.
//!
//! # Pitfalls
//! Next to a depth edge a pixel mixes two surfaces, and no position in it is the match of what one sees.
//! [`true_matches`] keeps away from such edges, [`true_match`] does not.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::ray::{Eye, Ray};
use super::scene::{Hit, Scene};
use super::texture::Spot;
use crate::geometry::{Camera, Frame, Point, PointPair, Vector};

/// Matches keep this far from the border of both pictures, px.
const MARGIN: f64 = 5.0;
/// Share of the distance by which a point may seem to hide itself, for rounding.
const SELF_HIDING: f64 = 1e-6;
/// Neighbours at a larger relative difference of distance lie behind a depth edge.
const DEPTH_STEP: f64 = 0.04;
/// Standard deviation of the albedo over a few pixels below which a point counts as untextured.
const TEXTURE: f64 = 0.012;

/// The match of one position in image 1; `None` in the sky, outside image 2 and where image 2 shows
/// something nearer.
pub fn true_match(
    scene: &Scene,
    camera1: &Camera,
    camera2: &Camera,
    frame: Frame,
    point1: Point,
) -> Option<PointPair> {
    let (eye1, eye2) = (Eye::new(camera1)?, Eye::new(camera2)?);
    let hit = scene.intersect(&eye1.ray(point1))?;
    if !eye2.sees_in_front(camera2, &hit.point) {
        return None;
    }
    let point2 = camera2.project(&hit.point)?;
    let margin = MARGIN.min(frame.shorter_side() / 4.0);
    let inside = |p: Point| {
        p.x >= margin && p.y >= margin && p.x <= frame.right() - margin && p.y <= frame.bottom() - margin
    };
    if !inside(point1) || !inside(point2) {
        return None;
    }
    let offset = hit.point - eye2.centre();
    let distance = offset.norm();
    let back = Ray { origin: eye2.centre(), direction: offset / distance };
    let hidden = scene.blocked(&back, distance * (1.0 - SELF_HIDING));
    (!hidden).then_some(PointPair { point1, point2 })
}

/// `n` matches (fewer if the pictures share less) on textured surfaces away from depth edges, spread over
/// image 1. The frame is that of both pictures.
pub fn true_matches(
    scene: &Scene,
    camera1: &Camera,
    camera2: &Camera,
    frame: Frame,
    n: usize,
    seed: u64,
) -> Vec<PointPair> {
    let Some(eye1) = Eye::new(camera1) else { return Vec::new() };
    let mut rng = Pcg32::seed_from_u64(seed);
    let columns =
        ((n as f64 * frame.width as f64 / frame.height.max(1) as f64).sqrt().ceil() as usize).max(1);
    let rows = n.div_ceil(columns).max(1);
    let (w, h) = (frame.width as f64 / columns as f64, frame.height as f64 / rows as f64);
    let mut found = Vec::new();
    // Cells without a match, in the sky say, leave room for a second one elsewhere.
    for _round in 0..6 {
        for cell in 0..columns * rows {
            let (x0, y0) = ((cell % columns) as f64 * w, (cell / columns) as f64 * h);
            let best = (0..10)
                .filter_map(|_| {
                    let p = Point::new(x0 + w * rng.random::<f64>(), y0 + h * rng.random::<f64>());
                    let strength = texture(scene, &eye1, p)?;
                    let pair = true_match(scene, camera1, camera2, frame, p)?;
                    (strength > TEXTURE).then_some((strength, pair))
                })
                .max_by(|a, b| a.0.total_cmp(&b.0));
            found.extend(best.map(|(_, pair)| pair));
        }
        if found.len() >= n {
            break;
        }
    }
    // A round fills its cells row by row: shuffled, so that cutting to `n` leaves no part of the picture out.
    for k in (1..found.len()).rev() {
        found.swap(k, rng.random_range(0..=k));
    }
    found.truncate(n);
    found
}

/// Standard deviation of the albedo around a pixel; `None` at a depth edge and in the sky.
pub(super) fn texture(scene: &Scene, eye: &Eye, p: Point) -> Option<f64> {
    let centre = scene.intersect(&eye.ray(p))?;
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for k in 0..25 {
        let offset = Vector::new(f64::from(k % 5 - 2), f64::from(k / 5 - 2)) * 1.5;
        let hit = scene.intersect(&eye.ray(p + offset))?;
        // Planes seen at a slant recede too; a step is more than the neighbours on either side explain.
        let opposite = scene.intersect(&eye.ray(p - offset))?;
        let bend = hit.distance + opposite.distance - 2.0 * centre.distance;
        if bend.abs() > DEPTH_STEP * centre.distance {
            return None;
        }
        let v = albedo(scene, &hit, eye);
        sum += v;
        squares += v * v;
        count += 1.0;
    }
    let mean = sum / count;
    Some((squares / count - mean * mean).max(0.0).sqrt())
}

fn albedo(scene: &Scene, hit: &Hit, eye: &Eye) -> f64 {
    let spot = Spot {
        uv: hit.surface.uv,
        sample: hit.distance * eye.pixel_angle(),
        seed: scene.object(hit.object).seed,
    };
    scene.material(hit.object).look(&spot).albedo.mean()
}
