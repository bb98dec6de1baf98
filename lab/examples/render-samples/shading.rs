//! What sun and sky make of a surface.
//!
//! Radiance at a hit is `albedo · (sun · max(n·s, 0) · visible + ambient) + gloss`, where `ambient` is the
//! mean over cosine-distributed directions of either the sky or one diffuse bounce. The directions belong
//! to the subsample, not to the pixel: the two images of a pair are lit alike and without grain.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::light::Light;
use super::ray::Ray;
use super::scene::{Hit, Scene};
use super::shape::across;
use super::texture::{Rgb, Spot};

/// The directions used by one subsample of every pixel.
#[derive(Debug, Clone)]
pub struct Directions {
    sun: Vector3<f64>,
    ambient: Vec<Vector3<f64>>,
}

impl Directions {
    /// One set for each of `subsamples`, with `rays` ambient directions each; all of them together cover
    /// the hemisphere evenly (Hammersley points).
    pub fn table(light: &Light, subsamples: usize, rays: usize) -> Vec<Self> {
        let total = subsamples * rays;
        let [a, b] = across(&light.sun);
        (0..subsamples)
            .map(|s| {
                // Sunflower spiral over the disc.
                let r = light.sun_radius * ((s as f64 + 0.5) / subsamples as f64).sqrt();
                let angle = s as f64 * 2.399_963;
                let sun = (light.sun + a * (r * angle.cos()) + b * (r * angle.sin())).normalize();
                let ambient = (0..rays)
                    .map(|k| {
                        let index = s + k * subsamples;
                        let r = ((index as f64 + 0.5) / total as f64).sqrt();
                        let angle = TAU * (f64::from((index as u32).reverse_bits()) / 4_294_967_296.0);
                        Vector3::new(r * angle.cos(), r * angle.sin(), (1.0 - r * r).max(0.0).sqrt())
                    })
                    .collect();
                Self { sun, ambient }
            })
            .collect()
    }
}

/// Light that comes back along a ray. `sample` is the angle between neighbouring subsamples.
pub fn radiance(scene: &Scene, ray: &Ray, directions: &Directions, sample: f64) -> Rgb {
    let Some(hit) = scene.intersect(ray) else {
        return scene.light.sky(&ray.direction, sample);
    };
    let material = scene.material(hit.object);
    let flat = hit.surface.normal;
    let slant = flat.dot(&ray.direction).abs().max(0.25);
    let spot = Spot {
        uv: hit.surface.uv,
        sample: hit.distance * sample / slant,
        seed: scene.object(hit.object).seed,
    };
    let (look, slope) = material.look_and_slope(&spot);
    let [u, v] = hit.surface.tangents;
    let normal = (flat - u * slope.x - v * slope.y).normalize();
    let lifted = hit.point + flat * 1e-4;

    let facing = normal.dot(&directions.sun);
    let through = (-facing).max(0.0) * material.translucency;
    let lit = facing.max(0.0) + through;
    let sun_ray = Ray {
        origin: if facing > 0.0 { lifted } else { hit.point - flat * 1e-4 },
        direction: directions.sun,
    };
    let faces_sun = flat.dot(&directions.sun) > 0.0 || material.translucency > 0.0;
    let sunlit = lit > 0.0 && faces_sun && !scene.blocked(&sun_ray, f64::INFINITY);
    let sun = if sunlit { scene.light.sun_colour * lit } else { Rgb::zeros() };

    let ambient = ambient(scene, &hit, &normal, directions);
    let mut result = look.albedo.component_mul(&(sun + ambient));
    if look.gloss > 0.0 {
        let mirrored = ray.direction - normal * (2.0 * ray.direction.dot(&normal));
        if sunlit {
            let highlight = mirrored.dot(&directions.sun).max(0.0).powi(24);
            result += scene.light.sun_colour * (look.gloss * highlight);
        }
        let grazing = (1.0 - flat.dot(&ray.direction).abs()).powi(4);
        result += scene.light.horizon * (0.35 * look.gloss * grazing);
    }
    result
}

/// Light from everywhere but the sun.
fn ambient(scene: &Scene, hit: &Hit, normal: &Vector3<f64>, directions: &Directions) -> Rgb {
    // Halfway to the bumped normal: ambient light shows relief, yet rays stay outside the surface.
    let flat = hit.surface.normal;
    let axis = (flat + normal * 0.7).normalize();
    let [x, y] = across(&axis);
    let light = &scene.light;
    let mut sum = Rgb::zeros();
    for local in &directions.ambient {
        let direction = x * local.x + y * local.y + axis * local.z;
        let ray = Ray { origin: hit.point + flat * 1e-4, direction };
        let Some(other) = scene.intersect(&ray) else {
            sum += if direction.z > 0.0 { light.sky(&direction, 1.0) } else { light.horizon * 0.3 };
            continue;
        };
        let facing = other.surface.normal.dot(&light.sun);
        let beyond = Ray { origin: other.point + other.surface.normal * 1e-4, direction: light.sun };
        let mut arriving = (light.zenith + light.horizon) * 0.17;
        if facing > 0.0 && !scene.blocked(&beyond, f64::INFINITY) {
            arriving += light.sun_colour * facing;
        }
        sum += scene.material(other.object).mean.component_mul(&arriving);
    }
    sum / directions.ambient.len().max(1) as f64
}
