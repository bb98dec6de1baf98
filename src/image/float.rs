//! Pictures whose numbers are floating and linear in the light, as EXR files have them: what of them is black and white.

use image::{DynamicImage, Rgba, Rgba32FImage};

/// Part of the pixels that may be darker than black, and as many brighter than white.
const BEYOND: f32 = 0.005;
/// Pixels that are looked at.
const SAMPLED: usize = 200_000;
/// Exponent from light to what a screen is told.
const GAMMA: f32 = 2.2;

/// A picture of floating numbers, linear in the light, with its range from 0 to 1 and even for the eye, as all others have
/// it: the darkest is black and the brightest white, but for a few pixels, which keep what they are beyond. What is no number
/// is black. Other pictures stay as they are.
pub fn developed(pixels: DynamicImage) -> DynamicImage {
    let colour = match &pixels {
        DynamicImage::ImageRgb32F(_) => true,
        DynamicImage::ImageRgba32F(_) => false,
        _ => return pixels,
    };
    let mut values = pixels.into_rgba32f();
    let [black, white] = range(&values);
    for Rgba([colours @ .., _]) in values.pixels_mut() {
        for value in colours {
            let light = ((*value - black) / (white - black)).max(0.0);
            // NaN is left behind by `max`.
            let shown = light.powf(1.0 / GAMMA);
            *value = if shown.is_finite() { shown } else { f32::MAX.powf(0.25) };
        }
    }
    let values = DynamicImage::from(values);
    if colour { values.into_rgb32f().into() } else { values }
}

/// What is black and what is white.
fn range(pixels: &Rgba32FImage) -> [f32; 2] {
    let count = (pixels.width() as usize) * (pixels.height() as usize);
    let mut sampled: Vec<f32> = pixels
        .pixels()
        .step_by((count / SAMPLED).max(1))
        .flat_map(|Rgba([red, green, blue, _])| [*red, *green, *blue])
        .filter(|value| value.is_finite())
        .collect();
    sampled.sort_unstable_by(f32::total_cmp);
    let at = |part: f32| sampled.get(((sampled.len().max(1) - 1) as f32 * part) as usize).copied();
    match at(BEYOND).zip(at(1.0 - BEYOND)) {
        // Light begins at none, and what is below is noise.
        Some((black, white)) if white > black.min(0.0) => [black.min(0.0), white],
        _ => [0.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use crate::image::Picture;

    fn exr(pixel: impl Fn(u32) -> f32) -> Picture {
        let pixels = image::Rgb32FImage::from_fn(200, 20, |x, _| image::Rgb([pixel(x); 3]));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        pixels.save(&path).unwrap();
        Picture::open(&path).unwrap()
    }

    #[test]
    fn a_float_picture_fills_the_grey_levels_whatever_its_unit() {
        for unit in [1e-3, 1.0, 5e4] {
            let picture = exr(|x| x as f32 * unit);
            let (dark, bright) = (picture.gray.at(2, 5), picture.gray.at(197, 5));
            assert!(dark < 40.0 && bright > 250.0, "{unit}: {dark} to {bright}");
            assert!(picture.gray.at(40, 5) > 110.0, "{unit}: even for the eye");
        }
    }

    #[test]
    fn what_is_no_number_does_no_harm() {
        let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0];
        let picture = exr(|x| broken.get(x as usize).copied().unwrap_or(0.5));
        assert!(picture.gray.values().iter().all(|v| (0.0..=255.0).contains(v)));
        let flat = exr(|_| 0.0);
        assert!(flat.gray.values().iter().all(|v| *v == 0.0));
    }
}
