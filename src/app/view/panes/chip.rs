//! Texts over pictures: the name of an image in the corner of its pane, and others on the same ground.

use std::fmt::Write;

use egui::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Ui, WidgetInfo, vec2};

use crate::app::model::{Model, OverlayId, Side};
use crate::app::view::theme;
use crate::camera::UndistortedView;
use crate::geometry::Frame;
use crate::presentation::interpretation_in_words;

/// Writes a text on a dark ground. The text of a visible place stays inside the picture.
pub fn label(painter: &Painter, at: Pos2, align: Align2, text: &str, color: Color32) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(theme::CAPTION), color);
    let area = align.anchor_size(at, galley.size() + vec2(12.0, 6.0));
    let visible = painter.clip_rect();
    let area = if visible.contains(at) { moved_into(area, visible) } else { area };
    painter.rect_filled(area, 4.0, theme::LABEL_FILL);
    painter.galley(area.min + vec2(6.0, 3.0), galley, color);
}

/// Moves a rectangle by the smallest distance that brings it inside another one.
pub fn moved_into(area: Rect, other: Rect) -> Rect {
    let by = (other.min - area.min).max(vec2(0.0, 0.0)) + (other.max - area.max).min(vec2(0.0, 0.0));
    area.translate(by)
}

pub struct Chip {
    pub side: Side,
    pub rect: Rect,
    /// Size of the picture on the screen, px.
    pub size: Frame,
    /// The view without distortion, if a lens bends the picture.
    pub lens: Option<UndistortedView>,
    pub is_turned: bool,
    /// Screen points per pixel; `None` if the whole image is visible.
    pub scale: Option<f64>,
}

impl Chip {
    /// Shows the name and the size of the image, its zoom, and whether its brightness is changed.
    /// Returns the area.
    pub fn show(&self, ui: &Ui, model: &Model) -> Rect {
        let title = self.side.title();
        let (mut name, mut text) = (String::new(), String::new());
        if let Some(picture) = model.document.pictures.as_ref().map(|p| &p[self.side.index()]) {
            name.clone_from(&picture.name);
            text = format!("  {} × {} px", self.size.width, self.size.height);
            match self.lens {
                Some(view) if view.camera().division(self.size).is_some() => text += "  lens corrected",
                Some(_) => text += "  lens calibrated",
                None => {}
            }
            let open = model.open.pictures();
            let interpretation = open.as_ref().map(|open| open[self.side.index()].interpretation);
            if let Some(words) = interpretation.as_ref().and_then(interpretation_in_words) {
                let _ = write!(text, "  {words}");
            }
            if self.is_turned {
                text += "  view turned";
            }
            if let Some(scale) = self.scale {
                let _ = write!(text, "  {:.0} %", scale * 100.0);
            }
            if model.open.stretched.is_some() {
                text += "  brightness stretched";
            }
        }
        let font = FontId::proportional(theme::CAPTION);
        let format = |color| TextFormat { font_id: font.clone(), color, ..TextFormat::default() };
        let knows_matches = model.truth().is_some_and(|truth| !truth.matches.is_empty());
        let legend = (knows_matches && model.look.shows(OverlayId::TrueMatches)).then_some("× true matches");
        let layout = |name: &str, width: f32| {
            let mut job = LayoutJob::default();
            job.append(title, 0.0, format(theme::SELECTED));
            job.append(&format!("{name}{text}"), 6.0, format(Color32::from_gray(190)));
            if let Some(legend) = legend {
                job.append(legend, 8.0, format(theme::TRUE));
            }
            // Copies of the view carry the word of the verdict.
            if let Some((word, look)) = model.doubt() {
                job.append(word, 8.0, format(theme::line_color(look)));
            }
            job.wrap = TextWrapping::truncate_at_width(width);
            ui.painter().layout_job(job)
        };
        // A long name must not push the size out of the chip.
        let width = |text: &str| layout(text, f32::INFINITY).size().x;
        let room = (self.rect.width() - 32.0).max(8.0);
        let share = (room - width("…")) / (width(&name) - width("")).max(1.0);
        let most = (name.chars().count() as f32 * share.max(0.0)) as usize;
        let shown = if width(&name) > room { shortened(&name, most) } else { name.clone() };
        let galley = layout(&shown, room);
        let chip = Rect::from_min_size(self.rect.min + vec2(6.0, 6.0), galley.size() + vec2(12.0, 6.0));
        // A click there places a point, so the pixels below the cursor have to be visible.
        if !ui.rect_contains_pointer(chip) {
            let painter = ui.painter_at(self.rect);
            painter.rect_filled(chip, 4.0, theme::LABEL_FILL);
            painter.galley(chip.min + vec2(6.0, 3.0), galley, theme::SELECTED);
        }
        let response = ui.interact(chip, ui.scope_id().with("chip"), Sense::hover());
        let legend = legend.map_or(String::new(), |legend| format!("  {legend}"));
        let whole = format!("{title} {name}{text}{legend}");
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, whole.clone()));
        chip
    }
}

/// Shortens a name in the middle to its beginning and its end, `most` characters in all.
fn shortened(name: &str, most: usize) -> String {
    let end = name.chars().count().saturating_sub(most / 2);
    name.chars().take(most - most / 2).chain(['…']).chain(name.chars().skip(end)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_keeps_its_beginning_and_its_end() {
        assert_eq!(shortened("IMG_2024-05-17_façade-left.jpeg", 9), "IMG_2…jpeg");
        assert_eq!(shortened("a.png", 0), "…");
    }
}
