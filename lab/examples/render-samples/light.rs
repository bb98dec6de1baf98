//! Sun and sky.

use nalgebra::{Vector2, Vector3};

use super::noise::{fractal, smoothstep};
use super::texture::Rgb;

/// Light of a clear or half-cloudy day. Colours are linear.
#[derive(Debug, Clone)]
pub struct Light {
    /// Unit vector towards the sun.
    pub sun: Vector3<f64>,
    /// Light of the sun on a surface that faces it.
    pub sun_colour: Rgb,
    /// Sky overhead.
    pub zenith: Rgb,
    /// Sky at the horizon.
    pub horizon: Rgb,
    /// How much of the sky is cloud, 0 ..= 1.
    pub clouds: f64,
    /// Factor before the tone curve.
    pub exposure: f64,
    /// Radius of the sun's disc, radians; sets the softness of shadows.
    pub sun_radius: f64,
}

impl Light {
    /// A day in late summer, the sun at the given direction.
    pub fn day(sun: Vector3<f64>) -> Self {
        Self {
            sun: sun.normalize(),
            sun_colour: Rgb::new(3.0, 2.62, 2.1),
            zenith: Rgb::new(0.24, 0.45, 0.86),
            horizon: Rgb::new(0.72, 0.84, 0.98),
            clouds: 0.45,
            exposure: 0.62,
            sun_radius: 0.012,
        }
    }

    /// Radiance of the sky in a direction; `sample` is the angle between samples.
    pub fn sky(&self, direction: &Vector3<f64>, sample: f64) -> Rgb {
        let up = direction.z.max(0.0);
        let clear = self.horizon + (self.zenith - self.horizon) * (1.0 - (1.0 - up).powi(3));
        if direction.z < 0.02 {
            return clear;
        }
        // Clouds on a plane overhead, as it looks from below.
        let p = Vector2::new(direction.x, direction.y) / (direction.z + 0.15);
        let density = fractal(p, 1.1, 0.55, sample / (direction.z + 0.15), 4711);
        let cover = smoothstep(0.55 - self.clouds, 1.15 - self.clouds, density + 0.35);
        let lit = 0.82 + 0.25 * fractal(p + Vector2::new(0.07, 0.05), 0.5, 0.5, sample, 815);
        clear + (Rgb::new(1.0, 0.98, 0.95) * lit - clear) * (0.92 * cover)
    }
}
