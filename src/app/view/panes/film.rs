//! Frames of a sequence as a texture, one at a time, with motion highlighted.

use egui::{Color32, ColorImage, TextureFilter, TextureHandle, TextureOptions};
use image::{DynamicImage, GrayImage};

use crate::app::model::recording::Recording;
use crate::app::model::shared::Shared;
use crate::app::view::theme;
use crate::image::Rendition;

/// Sharp pixels when magnified, smooth when reduced.
pub const PIXELS: TextureOptions = TextureOptions {
    magnification: TextureFilter::Nearest,
    minification: TextureFilter::Linear,
    wrap_mode: egui::TextureWrapMode::ClampToEdge,
    mipmap_mode: Some(TextureFilter::Linear),
};
pub const SMOOTH: TextureOptions = TextureOptions { magnification: TextureFilter::Linear, ..PIXELS };
/// Frame number, whether motion is highlighted, and the rendition.
type Shown = (usize, bool, Rendition);

pub struct Film {
    recording: Shared<Recording>,
    shown: Option<Shown>,
    pub texture: TextureHandle,
    piled: usize,
    pub pile: TextureHandle,
}

impl Film {
    /// Creates the film, without a frame yet.
    pub fn new(ctx: &egui::Context, recording: Shared<Recording>) -> Self {
        let texture = ctx.load_texture("frame", ColorImage::default(), PIXELS);
        let pile = ctx.load_texture("silhouettes", ColorImage::default(), SMOOTH);
        Self { recording, shown: None, texture, piled: 0, pile }
    }

    /// Shows a frame. Does nothing if it is shown already.
    pub fn show(&mut self, frame: usize, silhouettes: bool, rendition: Rendition) {
        let wanted = (frame, silhouettes, rendition);
        let sequence = &self.recording.sequence;
        if self.shown == Some(wanted) || frame >= sequence.len() {
            return;
        }
        self.shown = Some(wanted);
        let size = [sequence.size().width, sequence.size().height];
        let grey = sequence.frame(frame);
        let mut image = if rendition.is_plain() {
            ColorImage::from_gray(size, grey)
        } else {
            let [width, height] = size.map(|side| side as u32);
            let Some(pixels) = GrayImage::from_raw(width, height, grey.to_vec()) else { return };
            ColorImage::from_rgba_premultiplied(size, &rendition.render(&DynamicImage::from(pixels)))
        };
        if silhouettes {
            for (pixel, _) in image
                .pixels
                .iter_mut()
                .zip(self.recording.silhouettes.mask(frame))
                .filter(|(_, moving)| *moving)
            {
                *pixel = pixel.lerp_to_gamma(theme::MOVING, 0.6);
            }
        }
        self.texture.set(image, PIXELS);
    }

    /// Piles up the silhouettes of the first frames of an overview: the more often a pixel moves, the more colour it
    /// has.
    pub fn pile_up(&mut self, count: usize) {
        if std::mem::replace(&mut self.piled, count) == count {
            return;
        }
        let silhouettes = &self.recording.pile.silhouettes;
        let size = silhouettes.size();
        let colored = |count: u32| match count {
            0 => Color32::TRANSPARENT,
            _ => theme::MOVING.gamma_multiply((0.2 + 0.1 * count as f32).min(0.7)),
        };
        let pixels = silhouettes.moved_before(count).into_iter().map(colored).collect();
        self.pile.set(ColorImage::new([size.width, size.height], pixels), SMOOTH);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::recording::example;

    #[test]
    fn a_frame_is_unchanged_except_for_highlighted_motion() {
        let ctx = egui::Context::default();
        let recording = Shared::new(example(20));
        let size = recording.sequence.size();
        let mut film = Film::new(&ctx, recording.clone());
        let uploaded = |film: &mut Film, silhouettes| {
            film.show(3, silhouettes, Rendition::default());
            let mut delta = ctx.tex_manager().write().take_delta();
            let own = delta.set.remove(&film.texture.id()).and_then(|mut all| all.pop());
            delta.clear();
            own.map(|own| match own.image {
                egui::ImageData::Color(image) => image,
            })
        };
        let plain = uploaded(&mut film, false).expect("a frame");
        assert_eq!(plain.size, [size.width, size.height]);
        assert!(uploaded(&mut film, false).is_none(), "it is there already");
        let marked = uploaded(&mut film, true).expect("the same frame, marked");
        let mask = recording.silhouettes.mask(3);
        assert!(mask.iter().any(|moving| *moving));
        for ((plain, marked), moving) in plain.pixels.iter().zip(&marked.pixels).zip(mask) {
            assert_eq!(plain == marked, !moving);
        }
    }
}
