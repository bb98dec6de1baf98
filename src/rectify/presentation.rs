//! Displays of both rectified pictures together.

use image::{DynamicImage, Rgba, RgbaImage};

/// Colour of the guide lines: an orange that shows on grey, bright and dark.
const GUIDE: Rgba<u8> = Rgba([230, 159, 0, 255]);

/// Puts both pictures side by side, with a horizontal guide line every `spacing` rows (0: none).
/// Corresponding points touch the same guide line.
pub fn stacked(pictures: [&DynamicImage; 2], spacing: usize) -> RgbaImage {
    let [left, right] = pictures.map(DynamicImage::to_rgba8);
    let (width, height) = (left.width() + right.width(), left.height().max(right.height()));
    let mut out = RgbaImage::new(width, height);
    image::imageops::replace(&mut out, &left, 0, 0);
    image::imageops::replace(&mut out, &right, i64::from(left.width()), 0);
    if spacing > 0 {
        for y in (spacing / 2..height as usize).step_by(spacing) {
            for x in 0..width {
                out.put_pixel(x, y as u32, GUIDE);
            }
        }
    }
    out
}

/// Combines both pictures into a red-cyan anaglyph: red from the first, green and blue from the
/// second. Row errors show as coloured edges above and below objects.
pub fn anaglyph(pictures: [&DynamicImage; 2]) -> RgbaImage {
    let [left, right] = pictures.map(DynamicImage::to_luma_alpha8);
    let (width, height) = (left.width().max(right.width()), left.height().max(right.height()));
    let mut out = RgbaImage::new(width, height);
    for (x, y, pixel) in out.enumerate_pixels_mut() {
        let [l, la] = left.get_pixel_checked(x, y).map_or([0, 0], |p| p.0);
        let [r, ra] = right.get_pixel_checked(x, y).map_or([0, 0], |p| p.0);
        let shown = |value: u8, alpha: u8| (u16::from(value) * u16::from(alpha) / 255) as u8;
        let right = shown(r, ra);
        *pixel = Rgba([shown(l, la), right, right, la.max(ra)]);
    }
    out
}
