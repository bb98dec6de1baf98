//! The thumbnails of the open folder. Any two images can form a pair.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align2, Button, Color32, ColorImage, CornerRadius, CursorIcon, FontId, Pos2, Rect, RichText, ScrollArea,
    Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, UiBuilder, Vec2, pos2, vec2,
};

use super::dialog::named;
use crate::app::model::document::counted;
use crate::app::model::picture::Overview;
use crate::app::model::thumbnails::ThumbnailQuestion;
use crate::app::model::{Command, Model, Side};
use crate::app::view::panes::shortened;
use crate::app::view::theme;
use crate::io::PictureFolder;

/// Width of a thumbnail, screen points.
const WIDTH: f32 = 104.0;
/// Space between thumbnails.
const GAP: f32 = 6.0;
/// Height of the caption: the name and two buttons.
const CAPTION: f32 = 20.0;
/// Height of the scroll bar below the captions.
const BAR: f32 = 5.0;
/// Window height below which thumbnails are smaller.
const LOW: f32 = 760.0;
/// Number of thumbnails loaded in advance on either side.
const AHEAD: usize = 3;

/// On-screen state of the strip.
#[derive(Default)]
pub struct FilmStrip {
    textures: HashMap<usize, (Arc<Overview>, TextureHandle)>,
    visible: Range<usize>,
    /// The pair last scrolled into view.
    shown: Option<[usize; 2]>,
}

impl FilmStrip {
    pub fn height(window: f32) -> f32 {
        image_height(window) + CAPTION + BAR + 12.0
    }

    /// Releases everything that the strip keeps for the screen.
    pub fn hide(&mut self) {
        *self = Self::default();
    }

    /// Returns the request for visible thumbnails that are not loaded.
    pub fn wanted(&self, model: &Model) -> Option<ThumbnailQuestion> {
        let (folder, _) = model.open.folder.as_ref()?;
        let views: Vec<usize> =
            self.visible.clone().filter(|view| model.thumbnails.of(*view).is_none()).collect();
        (!views.is_empty()).then(|| ThumbnailQuestion { folder: Arc::clone(folder), views })
    }

    pub fn show(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        (folder, pair): (&PictureFolder, [usize; 2]),
        commands: &mut Vec<Command>,
    ) {
        let count = folder.names().len();
        let size = vec2(WIDTH, image_height(ui.ctx().content_rect().height()) + CAPTION);
        let step = WIDTH + GAP;
        let moved = self.shown.replace(pair) != Some(pair);
        ScrollArea::horizontal().auto_shrink([false, true]).show_viewport(ui, |ui, viewport| {
            ui.set_width(step * count as f32);
            ui.set_height(size.y + BAR);
            let origin = ui.min_rect().min;
            let place = |view: usize| Rect::from_min_size(origin + vec2(step * view as f32, 0.0), size);
            let first = (viewport.min.x / step).floor().max(0.0) as usize;
            let end = ((viewport.max.x / step).ceil().max(0.0) as usize).min(count);
            self.visible = first.saturating_sub(AHEAD)..(end + AHEAD).min(count);
            for view in first..end {
                let mut cell = ui.new_child(UiBuilder::new().max_rect(place(view)).id_salt(view));
                self.cell(&mut cell, model, (folder, pair), view, commands);
            }
            if moved {
                ui.scroll_to_rect(place(pair[0]).union(place(pair[1])), None);
            }
        });
        let near = self.visible.clone();
        self.textures.retain(|view, _| near.contains(view));
    }

    fn cell(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        (folder, pair): (&PictureFolder, [usize; 2]),
        view: usize,
        commands: &mut Vec<Command>,
    ) {
        let area = ui.max_rect();
        let name = &folder.names()[view];
        let free = folder.pairs_freely();
        let image = Rect::from_min_max(area.min, pos2(area.max.x, area.max.y - CAPTION));
        let response = ui.interact(image, ui.scope_id().with("image"), Sense::click());
        // A click opens this image to the right of the left one, or else the pair it belongs to.
        let views = if free { [pair[0], view] } else { [view & !1, view | 1] };
        let points = model.points_on(views);
        let label = format!("Image {name}");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
        self.draw(ui, model, view, image, response.hovered());
        let palette = theme::palette(ui.visuals());
        if pair.contains(&view) {
            let stroke = Stroke::new(2.0, palette.accent);
            ui.painter().rect_stroke(image, CornerRadius::same(3), stroke, StrokeKind::Inside);
        }
        if points > 0 && (view == pair[1] || !pair.contains(&view)) {
            badge(ui, image.right_top(), points, palette.accent, palette.on_accent);
        }
        let beside = if !free {
            "Click to open its pair.".to_owned()
        } else if pair.contains(&view) {
            "This image is open.".to_owned()
        } else {
            format!("Click to open it beside {}.", folder.names()[pair[0]])
        };
        let placed = match points {
            0 => String::new(),
            _ => format!("\n{} placed.", counted(points)),
        };
        let response = response.on_hover_text(format!("{name}\n{beside}{placed}"));
        if response.on_hover_cursor(CursorIcon::PointingHand).clicked()
            && folder.is_pair(views)
            && views != pair
        {
            commands.push(Command::OpenViews(views));
        }
        let caption = Rect::from_min_max(pos2(area.min.x, image.max.y + 2.0), area.max);
        let room = if free { 2.0 * CAPTION } else { 0.0 };
        let (font, color) = (FontId::proportional(11.5), ui.visuals().text_color());
        let room = caption.width() - room - 4.0;
        let full = ui.painter().layout_no_wrap(name.clone(), font.clone(), color).size().x;
        let most = (name.chars().count() as f32 * room / full) as usize;
        // The ends usually distinguish names.
        let short = if full > room { shortened(name, most.saturating_sub(1)) } else { name.clone() };
        let mut job = LayoutJob::simple_singleline(short, font, color);
        job.wrap = TextWrapping::truncate_at_width(room);
        let galley = ui.painter().layout_job(job);
        ui.painter().galley(caption.center() - galley.size() / 2.0, galley, color);
        if free {
            for side in Side::BOTH {
                side_button(ui, caption, (folder, pair), view, side, commands);
            }
        }
    }

    fn draw(&mut self, ui: &Ui, model: &Model, view: usize, area: Rect, hovered: bool) {
        let fill = if hovered { ui.visuals().widgets.hovered.bg_fill } else { ui.visuals().extreme_bg_color };
        ui.painter().rect_filled(area, CornerRadius::same(3), fill);
        let weak = ui.visuals().weak_text_color();
        match model.thumbnails.of(view) {
            None => {}
            Some(None) => {
                let font = FontId::proportional(11.5);
                ui.painter().text(area.center(), Align2::CENTER_CENTER, "cannot be read", font, weak);
            }
            Some(Some(thumbnail)) => {
                let kept = self.textures.get(&view).filter(|(own, _)| Arc::ptr_eq(own, thumbnail));
                let kept = kept.map(|(_, texture)| texture.clone());
                let texture = kept.unwrap_or_else(|| {
                    let image = ColorImage::from_rgba_premultiplied(thumbnail.size, &thumbnail.pixels);
                    let texture = ui.ctx().load_texture("thumbnail", image, TextureOptions::LINEAR);
                    self.textures.insert(view, (Arc::clone(thumbnail), texture.clone()));
                    texture
                });
                let [width, height] = thumbnail.size.map(|v| v as f32);
                let room = area.shrink(3.0).size();
                let scale = (room.x / width).min(room.y / height);
                let place = Rect::from_center_size(area.center(), vec2(width, height) * scale);
                let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                ui.painter().image(texture.id(), place, whole, Color32::WHITE);
            }
        }
    }
}

fn image_height(window: f32) -> f32 {
    if window < LOW { 36.0 } else { 58.0 }
}

/// Draws the number of point pairs in the corner of a thumbnail.
fn badge(ui: &Ui, corner: Pos2, points: usize, fill: Color32, text: Color32) {
    let galley = ui.painter().layout_no_wrap(points.to_string(), FontId::proportional(11.0), text);
    let size = vec2((galley.size().x + 8.0).max(16.0), 15.0);
    let area = Rect::from_min_size(corner + vec2(-size.x - 2.0, 2.0), size);
    ui.painter().rect_filled(area, CornerRadius::same(7), fill);
    ui.painter().galley(area.center() - galley.size() / 2.0, galley, text);
}

/// Shows the button that opens an image on one side.
fn side_button(
    ui: &mut Ui,
    caption: Rect,
    (folder, pair): (&PictureFolder, [usize; 2]),
    view: usize,
    side: Side,
    commands: &mut Vec<Command>,
) {
    let (letter, x) = match side {
        Side::Left => ("L", caption.min.x),
        Side::Right => ("R", caption.max.x - CAPTION),
    };
    let area = Rect::from_min_size(pos2(x, caption.min.y), vec2(CAPTION - 1.0, CAPTION - 3.0));
    let is_open = pair[side.index()] == view;
    let label = format!("Show {} on the {}", folder.names()[view], side.name());
    ui.spacing_mut().button_padding = Vec2::ZERO;
    let button = Button::selectable(is_open, RichText::new(letter).size(11.0)).frame_when_inactive(true);
    let response = named(ui.put(area, button), &label);
    let mut views = pair;
    views[side.index()] = view;
    // An image that is open on the other side trades places.
    if pair[side.other().index()] == view {
        views = [pair[1], pair[0]];
    }
    let tooltip =
        if is_open { format!("This image is open on the {}.", side.name()) } else { format!("{label}.") };
    if response.on_hover_text(tooltip).clicked() && folder.is_pair(views) && views != pair {
        commands.push(Command::OpenViews(views));
    }
}
