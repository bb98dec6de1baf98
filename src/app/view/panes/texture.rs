//! Pictures of any size as textures.
//!
//! A texture larger than the graphics card allows would end the program, so large pictures are
//! never uploaded whole. An overview of at most 2048 px serves the zoomed-out view. Tiles of the
//! full resolution are uploaded when they come into view, a few per frame, and dropped later. The
//! work per frame is bounded for any picture size.

use std::collections::HashMap;
use std::sync::Arc;

use super::Transform;
use super::film::{Film, PIXELS, SMOOTH};
use crate::app::model::picture::{Opened, Overview, multiplied};
use crate::app::model::shared::Shared;
use crate::geometry::Point;
use crate::image::{Picture, Rendition};
use egui::epaint::Vertex;
use egui::{Color32, ColorImage, Mesh, Painter, TextureHandle, pos2};
use image::DynamicImage;

/// Side of a tile, px: small enough to convert within a frame.
const TILE_SIDE: usize = 512;
/// Number of tiles uploaded per frame.
const UPLOADS_A_FRAME: usize = 3;
/// Number of tiles kept, including those out of view.
const TILES_KEPT: usize = 96;
/// Magnification of the overview from which tiles replace it.
const OVERVIEW_MAGNIFICATION: f64 = 1.5;

struct Tile {
    handle: TextureHandle,
    seen: u64,
}

pub struct PictureTexture {
    picture: Shared<Picture>,
    overview: TextureHandle,
    reduced: Arc<Overview>,
    rendition: Rendition,
    scale: f64,
    tiles: HashMap<[usize; 2], Tile>,
    frame: u64,
    /// The sequence shown instead of the picture.
    film: Option<Film>,
}

impl PictureTexture {
    pub fn new(ctx: &egui::Context, opened: &Opened) -> Self {
        let Overview { size, pixels, scale, .. } = &*opened.overview;
        let options = if *scale < 1.0 { SMOOTH } else { PIXELS };
        let handle =
            ctx.load_texture("overview", ColorImage::from_rgba_premultiplied(*size, pixels), options);
        Self {
            picture: opened.shown().clone(),
            overview: handle,
            reduced: opened.overview.clone(),
            rendition: Rendition::default(),
            scale: *scale,
            tiles: HashMap::new(),
            frame: 0,
            film: opened.recording.clone().map(|recording| Film::new(ctx, recording)),
        }
    }

    pub fn show_frame(&mut self, frame: usize, silhouettes: bool, rendition: Rendition) {
        if let Some(film) = &mut self.film {
            film.show(frame, silhouettes, rendition);
        }
    }

    pub fn set_rendition(&mut self, rendition: Rendition) {
        if rendition == self.rendition {
            return;
        }
        self.rendition = rendition;
        self.tiles.clear();
        let whole;
        let source = if let Some(reduced) = &self.reduced.reduced {
            reduced
        } else {
            whole = self.picture.displayed(&self.picture.pixels);
            &*whole
        };
        let size = [source.width(), source.height()].map(|v| v as usize);
        let image = ColorImage::from_rgba_premultiplied(size, &rendered(rendition, source));
        self.overview.set(image, if self.scale < 1.0 { SMOOTH } else { PIXELS });
    }

    /// Draws a number of silhouettes of the sequence over its frame.
    pub fn draw_pile(&mut self, painter: &Painter, transform: &Transform, count: usize) {
        let size = [self.picture.pixels.width() as usize, self.picture.pixels.height() as usize];
        if let Some(film) = self.film.as_mut().filter(|_| count > 0) {
            film.pile_up(count);
            draw(painter, &film.pile, transform, [[0, 0], size], Color32::WHITE);
        }
    }

    pub fn draw(&mut self, painter: &Painter, transform: &Transform) {
        self.draw_tinted(painter, transform, Color32::WHITE);
    }

    /// Draws the visible part, multiplied by a colour.
    pub fn draw_tinted(&mut self, painter: &Painter, transform: &Transform, tint: Color32) {
        let size = [self.picture.pixels.width() as usize, self.picture.pixels.height() as usize];
        if let Some(film) = &self.film {
            draw(painter, &film.texture, transform, [[0, 0], size], tint);
            return;
        }
        draw(painter, &self.overview, transform, [[0, 0], size], tint);
        let pixels_a_pixel = transform.scale * f64::from(painter.pixels_per_point());
        if self.scale < 1.0 && pixels_a_pixel > self.scale * OVERVIEW_MAGNIFICATION {
            self.draw_tiles(painter, transform, size, tint);
        }
    }

    fn draw_tiles(&mut self, painter: &Painter, transform: &Transform, size: [usize; 2], tint: Color32) {
        self.frame += 1;
        let [min, max] = transform.pixel_range(painter.clip_rect());
        let range = |low: f64, high: f64, size: usize| {
            let pixel = |v: f64| (v + 0.5).floor().clamp(0.0, size as f64 - 1.0) as usize;
            pixel(low) / TILE_SIDE..=pixel(high) / TILE_SIDE
        };
        let mut uploads = 0;
        for row in range(min.y, max.y, size[1]) {
            for column in range(min.x, max.x, size[0]) {
                let first = [column * TILE_SIDE, row * TILE_SIDE];
                let end = [(first[0] + TILE_SIDE).min(size[0]), (first[1] + TILE_SIDE).min(size[1])];
                if let Some(tile) = self.tiles.get_mut(&[column, row]) {
                    tile.seen = self.frame;
                    draw(painter, &tile.handle, transform, [first, end], tint);
                } else if uploads < UPLOADS_A_FRAME {
                    uploads += 1;
                    let [x, y, w, h] =
                        [first[0], first[1], end[0] - first[0], end[1] - first[1]].map(|v| v as u32);
                    let part = self.picture.pixels.crop_imm(x, y, w, h);
                    let pixels = rendered(self.rendition, &self.picture.displayed(&part));
                    let image = ColorImage::from_rgba_premultiplied([w, h].map(|v| v as usize), &pixels);
                    let handle = painter.ctx().load_texture("tile", image, PIXELS);
                    draw(painter, &handle, transform, [first, end], tint);
                    self.tiles.insert([column, row], Tile { handle, seen: self.frame });
                } else {
                    // The overview shows through until later frames bring the rest.
                    painter.ctx().request_repaint();
                }
            }
        }
        if self.tiles.len() > TILES_KEPT {
            let mut hidden: Vec<_> = self.tiles.iter().map(|(at, tile)| (tile.seen, *at)).collect();
            hidden.sort_unstable();
            hidden.truncate(self.tiles.len() - TILES_KEPT);
            for (seen, at) in hidden {
                // The loupe draws after the pane and uses other tiles.
                if seen + 1 < self.frame {
                    self.tiles.remove(&at);
                }
            }
        }
    }
}

fn rendered(rendition: Rendition, pixels: &DynamicImage) -> Vec<u8> {
    if rendition.is_plain() { multiplied(pixels) } else { rendition.render(pixels) }
}

/// Draws a texture over the pixels from `first` up to but not including `end`, as a mesh, since the
/// soft edges of an image shape would show as seams between tiles.
fn draw(
    painter: &Painter,
    handle: &TextureHandle,
    transform: &Transform,
    [first, end]: [[usize; 2]; 2],
    tint: Color32,
) {
    let mut mesh = Mesh::with_texture(handle.id());
    for uv in [pos2(0.0, 0.0), pos2(1.0, 0.0), pos2(1.0, 1.0), pos2(0.0, 1.0)] {
        let edge = |k: usize, at: f32| if at > 0.5 { end[k] } else { first[k] } as f64 - 0.5;
        let pos = transform.screen_from_pixel(Point::new(edge(0, uv.x), edge(1, uv.y)));
        mesh.vertices.push(Vertex { pos, uv, color: tint });
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    painter.add(mesh);
}
