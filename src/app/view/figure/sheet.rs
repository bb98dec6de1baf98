//! The sheet of a figure: both images in their places, and the shapes of the overlays.

use egui::epaint::ClippedShape;
use egui::{Color32, Rect, Vec2, pos2, vec2};
use image::DynamicImage;

use super::pieces::{area, color, take_apart};
use crate::app::model::exchange::{FigureChoices, trust_note};
use crate::app::model::pane_view::{PaneView, QuarterTurns};
use crate::app::model::picture::Pictures;
use crate::app::model::{Model, OverlayId, Side};
use crate::app::view::panes::overlays::{Canvas, Labels, OVERLAYS};
use crate::app::view::panes::{PanePlace, Transform};
use crate::app::view::theme;
use crate::geometry::Frame;
use crate::image::Rendition;
use crate::io::{Figure, FigurePicture, TrustNote};

/// Height of images side by side, and width of stacked images, in points. With text of 13 points,
/// this fits a column of a paper.
const EXTENT: f32 = 360.0;
/// Space between and around the images, points.
const GAP: f32 = 8.0;
/// Largest total number of pixels up to which the scale follows the image resolution.
const MOST_PIXELS: f32 = 120e6;
/// Largest number of pixels per point. Beyond it the sheet grows instead of the letters.
const MOST_A_POINT: f32 = 8.0;

/// An image in its place on the sheet.
struct Placed {
    transform: Transform,
    first: [u32; 2],
    count: [u32; 2],
    rendition: Rendition,
}

impl Placed {
    /// Finds the pixels that are visible in the rectangle of a transform.
    fn new(transform: &Transform, frame: Frame, rendition: Rendition) -> Self {
        let [low, high] = transform.pixel_range(transform.rect);
        let range = |low: f64, high: f64, size: usize| {
            let first = (low + 0.5 + 1e-6).floor().clamp(0.0, size as f64 - 1.0);
            let end = (high + 0.5 - 1e-6).ceil().clamp(first + 1.0, size as f64);
            (first as u32, (end - first) as u32)
        };
        let (x, width) = range(low.x, high.x, frame.width);
        let (y, height) = range(low.y, high.y, frame.height);
        Self { transform: *transform, first: [x, y], count: [width, height], rendition }
    }
}

pub struct Sheet {
    pictures: Pictures,
    /// Frames of sequences, shown instead of the pictures.
    frames: Option<[DynamicImage; 2]>,
    places: [Placed; 2],
    size: Vec2,
    background: Color32,
    /// Shapes of the overlays, each clipped to its image.
    drawn: Vec<ClippedShape>,
    trust: Option<TrustNote>,
    title: String,
}

/// Composes the sheet: places both images and draws the overlays onto it.
pub fn sheet(model: &Model, panes: [Option<PanePlace>; 2], choices: &FigureChoices) -> Option<Sheet> {
    let opened = model.open.pictures.as_ref()?;
    let pictures = opened.each_ref().map(|opened| opened.shown().clone());
    let frames = pictures.each_ref().map(|picture| picture.frame());
    let turns = panes.each_ref().map(|pane| pane.map_or_else(QuarterTurns::default, |pane| pane.view.turn));
    // A visible part has the shape of its pane, a whole image its own shape.
    let seen = panes.map(|pane| pane.filter(|_| choices.seen));
    let turned = |k: usize| turns[k].turned_frame(frames[k]);
    let aspect = |k: usize| match &seen[k] {
        Some(pane) => pane.rect.width() / pane.rect.height().max(1.0),
        None => turned(k).width as f32 / turned(k).height as f32,
    };
    let stacked = model.look.stacked.unwrap_or(false);
    let sizes = [0, 1].map(|k| {
        let (width, height) =
            if stacked { (EXTENT, EXTENT / aspect(k)) } else { (EXTENT * aspect(k), EXTENT) };
        vec2(width.clamp(8.0, 40.0 * EXTENT), height.clamp(8.0, 40.0 * EXTENT))
    });
    let whole = |k: usize| PaneView { turn: turns[k], ..PaneView::fitting(frames[k]) };
    let views = [0, 1].map(|k| seen[k].as_ref().map_or_else(|| whole(k), |pane| pane.view));
    // The transforms at the size of the sheet.
    let fit = [0, 1].map(|k| {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), sizes[k]);
        let mut transform = views[k].transform(frames[k], rect).through(opened[k].distortion());
        match (&seen[k], views[k].scale) {
            // The same part of the image, scaled to the sheet.
            (Some(pane), Some(scale)) => {
                transform.scale = scale * f64::from(sizes[k].x / pane.rect.width().max(1.0));
            }
            (None, _) => {
                transform.scale = f64::from(sizes[k].x) / turned(k).width as f64;
            }
            _ => {}
        }
        transform
    });
    let full = fit.iter().map(|transform| (1.0 / transform.scale) as f32).fold(0.1, f32::max);
    let total = |sizes: [Vec2; 2]| {
        let [a, b] = sizes;
        let together =
            if stacked { vec2(a.x.max(b.x), a.y + b.y + GAP) } else { vec2(a.x + b.x + GAP, a.y.max(b.y)) };
        together + Vec2::splat(2.0 * GAP)
    };
    let mut scale = full.min((MOST_PIXELS / (total(sizes).x * total(sizes).y)).sqrt());
    // Enlarge the sheet rather than the letters.
    let enlarged = (scale / MOST_A_POINT).max(1.0);
    scale /= enlarged;
    let sizes = sizes.map(|size| size * enlarged);
    let size = total(sizes);
    let first = pos2(GAP, GAP);
    let second = first + if stacked { vec2(0.0, sizes[0].y + GAP) } else { vec2(sizes[0].x + GAP, 0.0) };
    let places = [first, second].map(egui::Pos2::to_vec2);
    let places = Side::BOTH.map(|side| {
        let k = side.index();
        let rect = Rect::from_min_size(places[k].to_pos2(), sizes[k]);
        let scale = fit[k].scale * f64::from(enlarged);
        Placed::new(&fit[k].at(rect, scale), frames[k], model.open.rendition(side))
    });
    let context = egui::Context::default();
    context.set_fonts(theme::fonts());
    let input = egui::RawInput {
        screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size)),
        max_texture_side: Some(16_384),
        ..egui::RawInput::default()
    };
    context.set_pixels_per_point(scale);
    // A new scale takes effect in the next frame.
    let mut before = context.run_ui(input.clone(), |_| ());
    let mut drawn = context.run_ui(input, |ui| {
        for (side, place) in Side::BOTH.into_iter().zip(&places) {
            let painter = ui.painter().with_clip_rect(place.transform.rect);
            let labels = Labels::default();
            let canvas = Canvas {
                painter: &painter,
                transform: &place.transform,
                side,
                frame: opened[side.index()].picture.frame(),
                model,
                labels: choices.labels.then_some(&labels),
                is_figure: true,
            };
            let shown = |id: OverlayId| id.is_for_figures() && model.look.shows(id) && choices.has(id);
            for overlay in OVERLAYS.iter().filter(|overlay| shown(overlay.id)) {
                (overlay.draw)(&canvas);
            }
            if let Some((word, look)) = model.doubt().filter(|_| side == Side::Left) {
                canvas.label(place.transform.rect.min, word, theme::line_color(look));
            }
        }
    });
    // The files contain text as such, so the glyph textures are not needed.
    before.textures_delta.clear();
    drawn.textures_delta.clear();
    let names = model.document.pictures.as_ref().map(|pictures| pictures.each_ref().map(|p| p.name.clone()));
    Some(Sheet {
        pictures,
        frames: model.frame_pictures(),
        places,
        size,
        background: if choices.dark { Color32::from_gray(24) } else { Color32::WHITE },
        drawn: drawn.shapes,
        trust: trust_note(model),
        title: names.map_or(String::new(), |[left, right]| format!("{left} and {right}")),
    })
}

impl Sheet {
    pub fn figure(self) -> Figure {
        Figure {
            pictures: [0, 1].map(|k| self.picture(k)),
            title: self.title,
            trust: self.trust,
            size: [self.size.x, self.size.y],
            background: color(self.background),
        }
    }

    /// Returns the visible part of an image with its place on the sheet, and the shapes over it.
    fn picture(&self, k: usize) -> FigurePicture {
        let Placed { transform, first: [x, y], count: [width, height], rendition } = &self.places[k];
        let crop = |pixels: &DynamicImage| pixels.crop_imm(*x, *y, *width, *height);
        let pixels = match &self.frames {
            Some(frames) => rendition.render(&crop(&frames[k])),
            None => rendition.render(&self.pictures[k].displayed(&crop(&self.pictures[k].pixels))),
        };
        let pixels: DynamicImage =
            image::RgbaImage::from_raw(*width, *height, pixels).unwrap_or_default().into();
        let pixels = match transform.turn.count() {
            0 => pixels,
            1 => pixels.rotate90(),
            2 => pixels.rotate180(),
            _ => pixels.rotate270(),
        };
        let end = [x + width, y + height].map(|v| v as usize);
        let mut shapes = Vec::new();
        let near = transform.rect.expand(0.5);
        for drawn in self.drawn.iter().filter(|drawn| near.contains_rect(drawn.clip_rect)) {
            take_apart(&drawn.shape, &mut shapes);
        }
        FigurePicture {
            area: area(transform.rect),
            pixels,
            place: area(transform.screen_from_pixels([*x as usize, *y as usize], end)),
            is_magnified: transform.scale > 1.5,
            shapes,
        }
    }
}
