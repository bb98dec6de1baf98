//! Exact matches: where one scene point is seen in two pictures.
//!
//! A ray through a pixel of image 1 finds the scene point `X`; image 2 shows it at `P2 X` if it lies in
//! front of camera 2, inside the picture, and nothing is between.
//!
//! # Pitfalls
//! Next to a depth edge a pixel mixes two surfaces, and no position in it is the match of what one sees.
//! [`texture`] knows them, [`true_match`] does not.

use super::ray::{Eye, Ray};
use super::scene::{Hit, Scene};
use super::texture::Spot;
use epiline::geometry::{Camera, Frame, Point, PointPair, Vector};

/// Matches keep this far from the border of both pictures, px.
const MARGIN: f64 = 5.0;
/// Share of the distance by which a point may seem to hide itself, for rounding.
const SELF_HIDING: f64 = 1e-6;
/// Neighbours at a larger relative difference of distance lie behind a depth edge.
const DEPTH_STEP: f64 = 0.04;

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
    if !Eye::sees_in_front(camera2, &hit.point) {
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

/// Standard deviation of the albedo around a pixel; `None` at a depth edge and in the sky.
pub fn texture(scene: &Scene, eye: &Eye, p: Point) -> Option<f64> {
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
