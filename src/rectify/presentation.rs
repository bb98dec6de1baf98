//! Rectified pictures, and displays of both together.

use image::{DynamicImage, Rgba, RgbaImage};

use super::{ImageMap, Rectification};
use crate::cancel::CancelFlag;
use crate::geometry::Point;
use crate::image::{PixelMap, warp};

/// Colour of the guide lines: an orange that shows on grey, bright and dark.
const GUIDE: Rgba<u8> = Rgba([230, 159, 0, 255]);

impl Rectification {
    /// Draws the rectified picture of image `which` (0 or 1) with bilinear interpolation, on all
    /// cores. The picture keeps the bit depth and the colours of the original. Its alpha channel is
    /// transparent where the image does not reach. Returns `None` when cancelled.
    pub fn warp(&self, which: usize, original: &DynamicImage, cancel: &CancelFlag) -> Option<DynamicImage> {
        warp(original, &self.maps[which], self.size, cancel)
    }
}

impl PixelMap for ImageMap {
    fn row(&self, y: usize) -> impl Fn(usize) -> Option<Point> {
        let trace = self.row(y as f64);
        move |x| self.in_picture(trace.at(x as f64)?)
    }
}

/// Puts both pictures side by side, with a horizontal guide line every `spacing` rows (0: none).
/// Corresponding points touch the same guide line.
pub fn side_by_side(pictures: [&DynamicImage; 2], spacing: usize) -> RgbaImage {
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
