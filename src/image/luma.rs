//! The grey plane of a picture, computed from its pixels without an intermediate copy.

use std::sync::Arc;

use image::DynamicImage;

use super::GrayPlane;
use super::fill::fill;
use super::numbers;
use super::validity::Validity;
use crate::geometry::Frame;

/// Returns the luma (ITU-R BT.709 weights) in grey levels 0 ..= 255, not rounded to 8 bits. `levels` are
/// the values of black and of white of 16-bit pixels; values beyond are black or white. Pixels with an
/// alpha of zero are no picture; any other alpha is ignored.
pub(super) fn gray_plane(pixels: &DynamicImage, [black, white]: [f32; 2]) -> GrayPlane {
    let frame = Frame::new(pixels.width() as usize, pixels.height() as usize);
    let step = (white - black) / 255.0;
    let deep = |v: f32| if step > 0.0 { ((v - black) / step).clamp(0.0, 255.0) } else { 0.0 };
    let mut opaque = None;
    let mut values = match pixels {
        DynamicImage::ImageLuma8(p) => levels(p.as_raw(), |[v]| f32::from(*v)),
        DynamicImage::ImageLumaA8(p) => {
            opaque = numbers::opaque(p.as_raw(), 2);
            levels(p.as_raw(), |[v, _]| f32::from(*v))
        }
        DynamicImage::ImageRgb8(p) => levels(p.as_raw(), |c: &[u8; 3]| luma(*c)),
        DynamicImage::ImageRgba8(p) => {
            opaque = numbers::opaque(p.as_raw(), 4);
            levels(p.as_raw(), |[r, g, b, _]| luma([*r, *g, *b]))
        }
        DynamicImage::ImageLuma16(p) => levels(p.as_raw(), |[v]| deep(f32::from(*v))),
        DynamicImage::ImageLumaA16(p) => {
            opaque = numbers::opaque(p.as_raw(), 2);
            levels(p.as_raw(), |[v, _]| deep(f32::from(*v)))
        }
        DynamicImage::ImageRgb16(p) => levels(p.as_raw(), |c: &[u16; 3]| deep(luma(*c))),
        DynamicImage::ImageRgba16(p) => {
            opaque = numbers::opaque(p.as_raw(), 4);
            levels(p.as_raw(), |[r, g, b, _]| deep(luma([*r, *g, *b])))
        }
        // Floating point is converted before, and future versions of the decoders may add formats.
        other => other.to_luma16().into_raw().into_iter().map(|v| deep(f32::from(v))).collect(),
    };
    let validity = opaque.map(|opaque| {
        // The values have a single owner here, so nothing is copied.
        fill(frame, Arc::make_mut(&mut values), &opaque);
        Validity::new(frame, &opaque)
    });
    GrayPlane::shared(frame, values).with_validity(validity)
}

/// Returns the grey level of each pixel of `N` channels.
fn levels<T, const N: usize>(channels: &[T], level: impl Fn(&[T; N]) -> f32) -> Arc<[f32]> {
    channels.as_chunks::<N>().0.iter().map(level).collect()
}

fn luma<T: Into<f32>>(color: [T; 3]) -> f32 {
    let [r, g, b] = color.map(Into::into);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [f32; 2] = [0.0, 65535.0];

    #[test]
    fn every_kind_of_pixels_has_the_same_grey_levels() {
        let rgb = image::RgbImage::from_fn(5, 3, |x, y| image::Rgb([(50 * x) as u8, (80 * y) as u8, 7]));
        let rgb = DynamicImage::from(rgb);
        let expected = gray_plane(&rgb, ALL);
        assert!((expected.at(4, 2) - (0.2126 * 200.0 + 0.7152 * 160.0 + 0.0722 * 7.0)).abs() < 1e-3);
        let kinds: [DynamicImage; 3] = [rgb.to_rgba8().into(), rgb.to_rgb16().into(), rgb.to_rgba16().into()];
        let off = |a: &GrayPlane, b: &GrayPlane| {
            a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        for kind in kinds {
            assert!(off(&gray_plane(&kind, ALL), &expected) < 1e-3, "{:?}", kind.color());
        }
        let gray = DynamicImage::from(rgb.to_luma8());
        let expected = gray_plane(&gray, ALL);
        let kinds: [DynamicImage; 3] =
            [gray.to_luma_alpha8().into(), gray.to_luma16().into(), gray.to_luma_alpha16().into()];
        for kind in kinds {
            assert!(off(&gray_plane(&kind, ALL), &expected) < 1e-3, "{:?}", kind.color());
        }
    }
}
