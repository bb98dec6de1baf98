//! From a scene and a camera to pixels.

use image::{Rgb as Pixel, RgbImage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use rayon::prelude::*;

use super::ray::Eye;
use super::scene::Scene;
use super::shading::{Directions, radiance};
use super::texture::Rgb;
use epiline::geometry::{Camera, Frame, Point};

/// Samples along each side of a pixel, on a regular grid.
const SUPERSAMPLING: usize = 4;
/// Ambient directions for each sample.
const AMBIENT_RAYS: usize = 4;
/// Standard deviation of the sensor noise, grey levels.
const NOISE: f64 = 0.8;
/// Darkening of the corners, as a fraction.
const VIGNETTING: f64 = 0.14;
/// Side of the square a pixel averages over, px: more than one, as behind a real lens, and it spares aliasing.
const APERTURE: f64 = 1.4;
/// Luma weights, ITU-R BT.709.
const LUMA: Rgb = Rgb::new(0.2126, 0.7152, 0.0722);
/// The tone curve works on each channel and so exaggerates colours; this takes it back.
const SATURATION: f64 = 0.82;

/// Renders in parallel; the pixels do not depend on the number of threads. The seed is that of the noise: give the
/// two pictures of a pair different ones. `None` when the camera's centre is at infinity.
pub fn render(scene: &Scene, camera: &Camera, frame: Frame, seed: u64) -> Option<RgbImage> {
    let eye = Eye::new(camera)?;
    let side = SUPERSAMPLING;
    let directions = Directions::table(&scene.light, side * side, AMBIENT_RAYS);
    let sample = eye.pixel_angle() / side as f64;
    let (centre, half) = (frame.centre(), frame.diagonal() / 2.0);
    let mut bytes = vec![0u8; 3 * frame.width * frame.height];
    bytes.par_chunks_mut((3 * frame.width).max(1)).enumerate().for_each(|(y, row)| {
        // A generator per row keeps the noise independent of the order of the rows.
        let seed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(y as u64);
        let mut rng = Pcg32::seed_from_u64(seed);
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let mut sum = Rgb::zeros();
            for (k, set) in directions.iter().enumerate() {
                let offset = |i: usize| APERTURE * ((i as f64 + 0.5) / side as f64 - 0.5);
                let p = Point::new(x as f64 + offset(k % side), y as f64 + offset(k / side));
                // Highlights are cut before averaging, or edges against them would not be smooth.
                sum += radiance(scene, &eye.ray(p), set, sample).map(|c| c.min(4.0));
            }
            let r = (Point::new(x as f64, y as f64) - centre).norm() / half;
            let factor = scene.light.exposure * (1.0 - VIGNETTING * r * r);
            let exposed = sum * (factor / directions.len() as f64);
            let linear = Rgb::repeat(exposed.dot(&LUMA)) * (1.0 - SATURATION) + exposed * SATURATION;
            for (value, light) in pixel.iter_mut().zip(linear.iter()) {
                let level = 255.0 * tone(*light) + NOISE * normal(&mut rng);
                *value = level.round().clamp(0.0, 255.0) as u8;
            }
        }
    });
    let mut picture = RgbImage::new(frame.width as u32, frame.height as u32);
    for (pixel, rgb) in picture.pixels_mut().zip(bytes.chunks_exact(3)) {
        *pixel = Pixel([rgb[0], rgb[1], rgb[2]]);
    }
    Some(picture)
}

/// A film-like tone curve (fit by K. Narkowicz to the ACES reference), then the sRGB curve; 0 ..= 1.
fn tone(x: f64) -> f64 {
    let y = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    if y < 0.003_130_8 { 12.92 * y } else { 1.055 * y.powf(1.0 / 2.4) - 0.055 }
}

/// A standard normal number: the sum of three uniform ones is near enough for sensor noise.
fn normal(rng: &mut Pcg32) -> f64 {
    let sum: f64 = (0..3).map(|_| rng.random::<f64>()).sum();
    2.0 * (sum - 1.5)
}
