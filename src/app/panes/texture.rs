//! Pictures as textures, of any size.
//!
//! A texture larger than the graphics card allows ends the program, so a picture is never uploaded whole:
//! an overview of at most 2048 px serves the zoomed-out view, and tiles of the full resolution are
//! uploaded when they come into sight, a few a frame, and dropped when they have been out of sight.
//! Work a frame is bounded whatever the size of the picture.

use std::collections::HashMap;
use std::sync::Arc;

use egui::{Color32, ColorImage, Mesh, Painter, Rect, TextureFilter, TextureHandle, TextureOptions, pos2};
use image::DynamicImage;

use super::Transform;
use crate::image::Picture;

/// Longest side of an overview, px. Every graphics system we can run on allows textures of this size.
const OVERVIEW_SIDE: u32 = 2048;
/// Side of a tile, px: small enough to be converted within a frame.
const TILE_SIDE: usize = 512;
/// Tiles uploaded a frame.
const UPLOADS_A_FRAME: usize = 3;
/// Tiles kept although out of sight.
const TILES_KEPT: usize = 96;
/// How many times the overview may be magnified before tiles take its place.
const OVERVIEW_MAGNIFICATION: f64 = 1.5;

/// Crisp pixels when magnified, smooth when reduced.
const PIXELS: TextureOptions = TextureOptions {
    magnification: TextureFilter::Nearest,
    minification: TextureFilter::Linear,
    wrap_mode: egui::TextureWrapMode::ClampToEdge,
    mipmap_mode: Some(TextureFilter::Linear),
};
/// Smooth always.
const SMOOTH: TextureOptions = TextureOptions { magnification: TextureFilter::Linear, ..PIXELS };

/// A reduced copy of a picture, made off the window's thread.
pub struct Overview {
    image: Arc<ColorImage>,
    /// Overview pixels per picture pixel; 1 when the picture is small.
    scale: f64,
}

impl Overview {
    /// Reduces a picture to what fits one texture.
    pub fn new(picture: &Picture) -> Self {
        let pixels = &picture.pixels;
        let (width, height) = (pixels.width(), pixels.height());
        let longer = width.max(height);
        if longer <= OVERVIEW_SIDE {
            return Self { image: Arc::new(color_image(pixels)), scale: 1.0 };
        }
        let scale = f64::from(OVERVIEW_SIDE) / f64::from(longer);
        let reduced = |v: u32| ((f64::from(v) * scale).round() as u32).clamp(1, OVERVIEW_SIDE);
        let small = pixels.thumbnail_exact(reduced(width), reduced(height));
        Self { image: Arc::new(color_image(&small)), scale }
    }
}

fn color_image(pixels: &DynamicImage) -> ColorImage {
    let size = [pixels.width() as usize, pixels.height() as usize];
    if pixels.color().has_alpha() {
        ColorImage::from_rgba_unmultiplied(size, pixels.to_rgba8().as_raw())
    } else {
        // Several times faster, and most photographs are like this.
        ColorImage::from_rgb(size, pixels.to_rgb8().as_raw())
    }
}

struct Tile {
    handle: TextureHandle,
    seen: u64,
}

/// A picture that can be drawn.
pub struct PictureTexture {
    picture: Arc<Picture>,
    overview: TextureHandle,
    scale: f64,
    tiles: HashMap<[usize; 2], Tile>,
    frame: u64,
}

impl PictureTexture {
    /// Uploads the overview.
    pub fn new(ctx: &egui::Context, picture: Arc<Picture>, overview: &Overview) -> Self {
        let options = if overview.scale < 1.0 { SMOOTH } else { PIXELS };
        let handle = ctx.load_texture("overview", Arc::clone(&overview.image), options);
        Self { picture, overview: handle, scale: overview.scale, tiles: HashMap::new(), frame: 0 }
    }

    /// Draws what is in sight.
    pub fn draw(&mut self, painter: &Painter, transform: &Transform) {
        let size = [self.picture.pixels.width() as usize, self.picture.pixels.height() as usize];
        draw(painter, &self.overview, transform.screen_from_pixels([0, 0], size));
        let pixels_a_pixel = transform.scale * f64::from(painter.pixels_per_point());
        if self.scale < 1.0 && pixels_a_pixel > self.scale * OVERVIEW_MAGNIFICATION {
            self.draw_tiles(painter, transform, size);
        }
    }

    fn draw_tiles(&mut self, painter: &Painter, transform: &Transform, size: [usize; 2]) {
        self.frame += 1;
        let clip = painter.clip_rect();
        let (min, max) = (transform.image_from_screen(clip.min), transform.image_from_screen(clip.max));
        let range = |low: f64, high: f64, size: usize| {
            let pixel = |v: f64| (v + 0.5).floor().clamp(0.0, size as f64 - 1.0) as usize;
            pixel(low) / TILE_SIDE..=pixel(high) / TILE_SIDE
        };
        let mut uploads = 0;
        for row in range(min.y, max.y, size[1]) {
            for column in range(min.x, max.x, size[0]) {
                let first = [column * TILE_SIDE, row * TILE_SIDE];
                let end = [(first[0] + TILE_SIDE).min(size[0]), (first[1] + TILE_SIDE).min(size[1])];
                let area = transform.screen_from_pixels(first, end);
                if let Some(tile) = self.tiles.get_mut(&[column, row]) {
                    tile.seen = self.frame;
                    draw(painter, &tile.handle, area);
                } else if uploads < UPLOADS_A_FRAME {
                    uploads += 1;
                    let [x, y, w, h] =
                        [first[0], first[1], end[0] - first[0], end[1] - first[1]].map(|v| v as u32);
                    let pixels = self.picture.pixels.crop_imm(x, y, w, h);
                    let handle = painter.ctx().load_texture("tile", color_image(&pixels), PIXELS);
                    draw(painter, &handle, area);
                    self.tiles.insert([column, row], Tile { handle, seen: self.frame });
                } else {
                    // The overview shows through until the next frames bring the rest.
                    painter.ctx().request_repaint();
                }
            }
        }
        if self.tiles.len() > TILES_KEPT {
            let mut hidden: Vec<_> = self.tiles.iter().map(|(at, tile)| (tile.seen, *at)).collect();
            hidden.sort_unstable();
            hidden.truncate(self.tiles.len() - TILES_KEPT);
            for (seen, at) in hidden {
                // A loupe draws after the pane and sees other tiles.
                if seen + 1 < self.frame {
                    self.tiles.remove(&at);
                }
            }
        }
    }
}

/// A mesh and not an image shape, whose soft edges would show as seams between tiles.
fn draw(painter: &Painter, handle: &TextureHandle, area: Rect) {
    let mut mesh = Mesh::with_texture(handle.id());
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    mesh.add_rect_with_uv(area, whole, Color32::WHITE);
    painter.add(mesh);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overview(width: u32, height: u32) -> Overview {
        let pixels = image::DynamicImage::new_luma8(width, height);
        Overview::new(&Picture::from_pixels("test".into(), None, pixels).unwrap())
    }

    #[test]
    fn overviews_fit_a_texture_and_small_pictures_stay_as_they_are() {
        assert_eq!(overview(1, 1).image.size, [1, 1]);
        assert_eq!(overview(2048, 3).image.size, [2048, 3]);
        assert_eq!(overview(12_000, 200).image.size, [2048, 34]);
        assert_eq!(overview(1, 9_000).image.size, [1, 2048]);
    }
}
