//! Black and white of a picture on the screen. They do not affect computations.

use image::DynamicImage;

use super::load::Picture;

/// Fraction of pixels that a stretch clips to black, and to white.
const CLIPPED: f32 = 0.005;
/// Maximum number of pixels sampled by a stretch.
const SAMPLED: usize = 200_000;

/// Appearance of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rendition {
    /// Values shown as black and as white, 0 to 1.
    pub range: [f32; 2],
}

impl Default for Rendition {
    fn default() -> Self {
        Self { range: [0.0, 1.0] }
    }
}

impl Rendition {
    /// Returns the rendition with black and white at the darkest and brightest values, except for a
    /// few pixels.
    pub fn stretched(picture: &Picture) -> Self {
        let values = picture.gray.values();
        let step = (values.len() / SAMPLED).max(1);
        let mut sampled: Vec<f32> = values.iter().step_by(step).map(|v| v / 255.0).collect();
        sampled.sort_unstable_by(f32::total_cmp);
        let at = |part: f32| sampled.get(((sampled.len() - 1) as f32 * part) as usize).copied();
        let range = at(CLIPPED).zip(at(1.0 - CLIPPED)).filter(|(black, white)| white > black);
        Self { range: range.map_or([0.0, 1.0], <[f32; 2]>::from) }
    }

    /// Returns whether the picture is unchanged.
    pub fn is_plain(self) -> bool {
        self == Self::default()
    }

    /// Returns red, green, blue and alpha of each pixel, with premultiplied colours.
    pub fn render(self, pixels: &DynamicImage) -> Vec<u8> {
        match pixels {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                self.each(1.0, pixels.to_rgba32f().as_raw().as_chunks().0)
            }
            DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_) => {
                self.each(u8::MAX.into(), pixels.to_rgba8().as_raw().as_chunks().0)
            }
            // 8 bits would lose the dark details of 16 bits.
            _ => self.each(u16::MAX.into(), pixels.to_rgba16().as_raw().as_chunks().0),
        }
    }

    /// Renders pixels with values up to `full`.
    fn each<T: Copy + Into<f32>>(self, full: f32, pixels: &[[T; 4]]) -> Vec<u8> {
        let [black, white] = self.range;
        let (factor, mut bytes) = (255.0 / (white - black).max(1e-6), Vec::with_capacity(4 * pixels.len()));
        for pixel in pixels {
            let [colours @ .., alpha] = pixel.map(|value| value.into() / full);
            let alpha = alpha.clamp(0.0, 1.0);
            let shown = |value: f32| ((value - black) * factor).clamp(0.0, 255.0) * alpha;
            bytes.extend(colours.map(|colour| shown(colour).round() as u8));
            bytes.push((alpha * 255.0).round() as u8);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_rendition_is_the_picture() {
        let pixels =
            image::RgbaImage::from_fn(16, 16, |x, y| image::Rgba([x as u8 * 16, y as u8, 77, 255 - x as u8]));
        let pixels = DynamicImage::from(pixels);
        let (shown, own) = (Rendition::default().render(&pixels), pixels.to_rgba8());
        assert_eq!(shown.len(), own.len());
        for (shown, own) in shown.as_chunks::<4>().0.iter().zip(own.pixels()) {
            let [red, green, blue, alpha] = own.0.map(f64::from);
            let premultiplied = [red, green, blue, 255.0].map(|v| v * alpha / 255.0);
            assert!(
                shown.iter().zip(premultiplied).all(|(a, b)| (f64::from(*a) - b).abs() <= 1.0),
                "{own:?}"
            );
        }
    }

    #[test]
    fn a_stretch_shows_dark_details_of_16_bits() {
        let pixels =
            image::ImageBuffer::<image::Luma<u16>, _>::from_fn(256, 1, |x, _| image::Luma([x as u16]));
        let picture = Picture::from_pixels("test".into(), None, DynamicImage::ImageLuma16(pixels)).unwrap();
        assert_eq!(picture.pixels.to_rgba8().as_raw()[8], 0, "8 bits lose it");
        let shown = Rendition::stretched(&picture).render(&picture.displayed(&picture.pixels));
        let grey: Vec<u8> = shown.chunks(4).map(|pixel| pixel[0]).collect();
        assert!(grey[0] < 5 && grey[64] > 40 && grey[128] > grey[64] + 40, "{grey:?}");
    }
}
