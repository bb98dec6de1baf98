//! Rectified pictures put together for people to look at.

use image::{DynamicImage, Rgba, RgbaImage};

/// Colour of the guide lines: an orange that shows on grey, bright and dark alike.
const GUIDE: Rgba<u8> = Rgba([230, 159, 0, 255]);

/// Both pictures side by side with a horizontal guide line every `spacing` rows (none for 0): what lies on a line in
/// one picture lies on it in the other.
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

/// Both pictures in one, the first in red and the second in green and blue, for red-cyan glasses. Rows that do not
/// agree show as coloured edges above and below things.
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
