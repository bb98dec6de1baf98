//! Exposure, contrast, gamma and channel of a picture, for looking at it. They do not affect computations.

use image::DynamicImage;

use super::load::Picture;

/// Fraction of pixels that a stretch clips to black, and to white.
const CLIPPED: f32 = 0.005;
/// Maximum number of pixels sampled by a stretch.
const SAMPLED: usize = 200_000;

named! {
    fn name;

    /// Visible channel of a picture. A single channel is shown as grey.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Channel {
        #[default]
        Colour = "Colour",
        Red = "Red",
        Green = "Green",
        Blue = "Blue",
        /// Brightness, the input of all computations.
        Grey = "Grey",
    }
}

/// Appearance of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rendition {
    /// Exposure, as a power of two.
    pub stops: f32,
    /// Factor of the distance from middle grey.
    pub contrast: f32,
    /// Gamma. Above 1 brightens the dark parts most.
    pub gamma: f32,
    pub channel: Channel,
    /// Values shown as black and as white before the other settings, 0 to 1.
    pub range: [f32; 2],
}

impl Default for Rendition {
    fn default() -> Self {
        Self { stops: 0.0, contrast: 1.0, gamma: 1.0, channel: Channel::Colour, range: [0.0, 1.0] }
    }
}

impl Rendition {
    /// Returns whether the picture is unchanged.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Converts a value of a channel, 0 to 1, to a byte for the screen.
    fn shown(&self, value: f32) -> u8 {
        let [black, white] = self.range;
        let value = (value - black) / (white - black).max(1e-6) * self.stops.exp2();
        let value = (value - 0.5) * self.contrast + 0.5;
        (value.clamp(0.0, 1.0).powf(1.0 / self.gamma.max(0.01)) * 255.0).round() as u8
    }

    /// Returns red, green, blue and alpha of each pixel, with premultiplied colours.
    pub fn render(&self, pixels: &DynamicImage) -> Vec<u8> {
        match pixels {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                let pixels = pixels.to_rgba32f();
                self.each(pixels.as_raw().as_chunks::<4>().0.iter().copied(), |value| self.shown(value))
            }
            DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_) => {
                self.by_table(u8::MAX.into(), pixels.to_rgba8().as_raw().as_chunks::<4>().0)
            }
            // 8 bits would lose the dark details of 16 bits.
            _ => self.by_table(u16::MAX, pixels.to_rgba16().as_raw().as_chunks::<4>().0),
        }
    }

    /// Renders pixels of whole numbers up to `most`. A table is faster than powers for each pixel.
    fn by_table<T: Copy + Into<f32>>(&self, most: u16, pixels: &[[T; 4]]) -> Vec<u8> {
        let full = f32::from(most);
        let table: Vec<u8> = (0..=most).map(|value| self.shown(f32::from(value) / full)).collect();
        let values = pixels.iter().map(|pixel| pixel.map(|value| value.into() / full));
        self.each(values, |value| table[(value * full).round().clamp(0.0, full) as usize])
    }

    fn each(&self, pixels: impl Iterator<Item = [f32; 4]>, shown: impl Fn(f32) -> u8) -> Vec<u8> {
        let mut bytes = Vec::new();
        for [red, green, blue, alpha] in pixels {
            let single = match self.channel {
                Channel::Colour => None,
                Channel::Red => Some(red),
                Channel::Green => Some(green),
                Channel::Blue => Some(blue),
                Channel::Grey => Some(0.2126 * red + 0.7152 * green + 0.0722 * blue),
            };
            let colours = match single {
                Some(value) => [shown(value); 3],
                None => [red, green, blue].map(&shown),
            };
            let alpha = alpha.clamp(0.0, 1.0);
            bytes.extend(colours.map(|colour| (f32::from(colour) * alpha).round() as u8));
            bytes.push((alpha * 255.0).round() as u8);
        }
        bytes
    }

    /// Returns the rendition with black and white at the darkest and brightest values, except for a
    /// few pixels.
    #[must_use]
    pub fn stretched(self, picture: &Picture) -> Self {
        let values = picture.gray.values();
        let step = (values.len() / SAMPLED).max(1);
        let mut sampled: Vec<f32> = values.iter().step_by(step).map(|v| v / 255.0).collect();
        sampled.sort_unstable_by(f32::total_cmp);
        let at = |part: f32| sampled.get(((sampled.len() - 1) as f32 * part) as usize).copied();
        let range = at(CLIPPED).zip(at(1.0 - CLIPPED)).filter(|(black, white)| white > black);
        Self { range: range.map_or([0.0, 1.0], |(black, white)| [black, white]), ..self }
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
    fn exposure_contrast_gamma_and_channels_do_what_they_say() {
        let pixels = DynamicImage::from(image::RgbImage::from_pixel(1, 1, image::Rgb([40, 100, 200])));
        let shown = |rendition: Rendition| rendition.render(&pixels)[..3].to_vec();
        let plain = Rendition::default();
        assert_eq!(shown(Rendition { stops: 1.0, ..plain }), [80, 200, 255]);
        assert_eq!(shown(Rendition { stops: -1.0, ..plain }), [20, 50, 100]);
        assert_eq!(shown(Rendition { contrast: 0.0, ..plain }), [128, 128, 128]);
        assert_eq!(shown(Rendition { channel: Channel::Blue, ..plain }), [200, 200, 200]);
        let lifted = shown(Rendition { gamma: 2.0, ..plain });
        assert!(lifted[0] > 95 && lifted[0] < 105 && lifted[2] > 220);
    }

    #[test]
    fn a_stretch_shows_dark_details_of_16_bits() {
        let pixels =
            image::ImageBuffer::<image::Luma<u16>, _>::from_fn(256, 1, |x, _| image::Luma([x as u16]));
        let picture = Picture::from_pixels("test".into(), None, DynamicImage::ImageLuma16(pixels)).unwrap();
        assert_eq!(picture.pixels.to_rgba8().as_raw()[8], 0, "8 bits lose it");
        let shown = Rendition::default().stretched(&picture).render(&picture.displayed(&picture.pixels));
        let grey: Vec<u8> = shown.chunks(4).map(|pixel| pixel[0]).collect();
        assert!(grey[0] < 5 && grey[64] > 40 && grey[128] > grey[64] + 40, "{grey:?}");
    }
}
