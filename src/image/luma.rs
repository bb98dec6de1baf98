//! The grey plane of a picture, computed from its pixels without an intermediate copy.

use std::sync::Arc;

use image::DynamicImage;

use super::GrayPlane;
use crate::geometry::Frame;

/// Returns the luma (ITU-R BT.709 weights) in grey levels 0 ..= 255, not rounded to 8 bits. Alpha
/// is ignored.
pub(super) fn gray_plane(pixels: &DynamicImage) -> GrayPlane {
    let frame = Frame::new(pixels.width() as usize, pixels.height() as usize);
    let values = match pixels {
        DynamicImage::ImageLuma8(p) => levels(p.as_raw(), |[v]| f32::from(*v)),
        DynamicImage::ImageLumaA8(p) => levels(p.as_raw(), |[v, _]| f32::from(*v)),
        DynamicImage::ImageRgb8(p) => levels(p.as_raw(), |c: &[u8; 3]| luma(*c)),
        DynamicImage::ImageRgba8(p) => levels(p.as_raw(), |[r, g, b, _]| luma([*r, *g, *b])),
        DynamicImage::ImageLuma16(p) => levels(p.as_raw(), |[v]| f32::from(*v) / 257.0),
        DynamicImage::ImageLumaA16(p) => levels(p.as_raw(), |[v, _]| f32::from(*v) / 257.0),
        DynamicImage::ImageRgb16(p) => levels(p.as_raw(), |c: &[u16; 3]| luma(*c) / 257.0),
        DynamicImage::ImageRgba16(p) => levels(p.as_raw(), |[r, g, b, _]| luma([*r, *g, *b]) / 257.0),
        DynamicImage::ImageRgb32F(p) => levels(p.as_raw(), |c: &[f32; 3]| 255.0 * luma(c.map(unit))),
        DynamicImage::ImageRgba32F(p) => {
            levels(p.as_raw(), |[r, g, b, _]| 255.0 * luma([*r, *g, *b].map(unit)))
        }
        // Future versions of the decoders may add pixel formats.
        other => other.to_luma16().into_raw().into_iter().map(|v| f32::from(v) / 257.0).collect(),
    };
    GrayPlane::shared(frame, values)
}

/// Returns the grey level of each pixel of `N` channels.
fn levels<T, const N: usize>(channels: &[T], level: impl Fn(&[T; N]) -> f32) -> Arc<[f32]> {
    channels.as_chunks::<N>().0.iter().map(level).collect()
}

fn luma<T: Into<f32>>(color: [T; 3]) -> f32 {
    let [r, g, b] = color.map(Into::into);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Clamps a value to 0 to 1. NaN becomes 0.
fn unit(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_pixels_has_the_same_grey_levels() {
        let rgb = image::RgbImage::from_fn(5, 3, |x, y| image::Rgb([(50 * x) as u8, (80 * y) as u8, 7]));
        let rgb = DynamicImage::from(rgb);
        let expected = gray_plane(&rgb);
        assert!((expected.at(4, 2) - (0.2126 * 200.0 + 0.7152 * 160.0 + 0.0722 * 7.0)).abs() < 1e-3);
        let kinds: [DynamicImage; 5] = [
            rgb.to_rgba8().into(),
            rgb.to_rgb16().into(),
            rgb.to_rgba16().into(),
            rgb.to_rgb32f().into(),
            rgb.to_rgba32f().into(),
        ];
        let off = |a: &GrayPlane, b: &GrayPlane| {
            a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        for kind in kinds {
            assert!(off(&gray_plane(&kind), &expected) < 1e-3, "{:?}", kind.color());
        }
        let gray = DynamicImage::from(rgb.to_luma8());
        let expected = gray_plane(&gray);
        let kinds: [DynamicImage; 3] =
            [gray.to_luma_alpha8().into(), gray.to_luma16().into(), gray.to_luma_alpha16().into()];
        for kind in kinds {
            assert!(off(&gray_plane(&kind), &expected) < 1e-3, "{:?}", kind.color());
        }
    }
}
