//! Drawings over a rectified picture: guide lines, the row of the cursor, point pairs.

use std::fmt::Write;

use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, vec2};

use super::figures::fits;
use crate::app::model::rectified::{DrawnPair, RectifiedLayout, RectifiedSheet, guide_spacing};
use crate::app::model::{Model, Role, Side, Target};
use crate::app::view::panes::overlays::{cross, true_matches_shown};
use crate::app::view::panes::{Transform, label};
use crate::app::view::{heat, theme};
use crate::geometry::{Point, PointPair};
use crate::presentation::{pixels_in_words, search_range_in_words};

/// Half-width of the mark of a point pair, screen points.
const MARK: f32 = 4.0;
/// Size of the colour scale, screen points.
const SCALE: egui::Vec2 = vec2(180.0, 10.0);

/// Row of the cursor, in whatever part of the window it is.
pub struct SheetRow {
    /// Position in the pictures, px.
    at: Point,
    side: Side,
    text: String,
}

impl SheetRow {
    /// Returns the row at a position in a rectified picture.
    pub fn under_cursor(model: &Model, drawn: &DrawnPair, sheet: RectifiedSheet, at: Point) -> Self {
        let side = sheet.side();
        let mut text = row_text(model, drawn, at);
        let point = drawn.shown.maps[side.index()].original_from_rectified(at);
        let frame = model.document.frame(side);
        if let Some(point) = point.filter(|point| frame.is_some_and(|frame| frame.contains(*point))) {
            let _ = write!(text, ", {} image ({:.1}, {:.1})", side.name(), point.x, point.y);
        }
        if let Some((map, _)) = drawn.disparity.as_ref().filter(|_| sheet == RectifiedSheet::Disparity) {
            let frame = drawn.frame();
            let found = map.at((at.x + 0.5) / frame.width as f64, (at.y + 0.5) / frame.height as f64);
            text += &found.map_or(", no match".to_owned(), |found| {
                format!(", disparity {} px", pixels_in_words(found))
            });
        }
        Self { at, side, text }
    }

    /// Returns the row of a point in an original image; `None` if it is outside the rectified
    /// picture.
    pub fn of_original(model: &Model, drawn: &DrawnPair, side: Side, point: Point) -> Option<Self> {
        let at = drawn.shown.maps[side.index()].rectified_from_original(point)?;
        Some(Self { at, side, text: row_text(model, drawn, at) })
    }
}

/// Names the row of a position by its number in the exported picture.
fn row_text(model: &Model, drawn: &DrawnPair, at: Point) -> String {
    format!("{} {:.0}", drawn.row_name(&model.look.rectified), at.y / drawn.reduction())
}

/// Drawing surface over a rectified picture.
pub struct SheetCanvas<'a> {
    /// Painter, clipped to the picture.
    pub painter: &'a Painter,
    pub transform: &'a Transform,
    pub sheet: RectifiedSheet,
    pub drawn: &'a DrawnPair,
    pub model: &'a Model,
}

impl SheetCanvas<'_> {
    pub fn draw(&self, row: Option<&SheetRow>) {
        self.guides();
        self.true_matches();
        self.pairs();
        if let Some(row) = row {
            self.row(row);
        }
        self.title();
        self.scale();
    }

    /// Draws horizontal lines at the same rows in both pictures.
    fn guides(&self) {
        if self.sheet == RectifiedSheet::Disparity || self.model.look.rectified.hides_guides {
            return;
        }
        let reduction = self.drawn.reduction();
        let spacing = guide_spacing(self.transform.scale * reduction) * reduction;
        let visible = self.painter.clip_rect();
        let [one, other] =
            [visible.min, visible.max].map(|corner| self.transform.image_from_screen(corner).y);
        let bottom = self.drawn.frame().bottom();
        let first = (one.min(other).max(0.0) / spacing).ceil();
        let last = (one.max(other).min(bottom) / spacing).floor();
        let mut k = first;
        while k <= last {
            let at = self.transform.screen_from_image(Point::new(0.0, k * spacing));
            self.along_row(at, Stroke::new(1.0, theme::GUIDE));
            k += 1.0;
        }
    }

    /// Draws the row through a position of the screen. It is a column where the pictures are turned.
    fn along_row(&self, at: Pos2, stroke: Stroke) {
        let visible = self.painter.clip_rect();
        if self.is_turned() {
            self.painter.vline(at.x, visible.y_range(), stroke);
        } else {
            self.painter.hline(visible.x_range(), at.y, stroke);
        }
    }

    fn is_turned(&self) -> bool {
        self.drawn.is_turned(&self.model.look.rectified)
    }

    /// Draws the row of the cursor and its position in the row.
    fn row(&self, row: &SheetRow) {
        let at = self.transform.screen_from_image(row.at);
        let visible = self.painter.clip_rect();
        for (width, color) in [(3.4, theme::HALO), (1.4, theme::HOVER)] {
            self.along_row(at, Stroke::new(width, color));
        }
        if row.side == self.sheet.side() {
            self.painter.circle_stroke(at, 5.0, Stroke::new(3.6, theme::HALO));
            self.painter.circle_stroke(at, 5.0, Stroke::new(1.8, theme::SELECTED));
            // Keep the label away from the cursor.
            let low = at.y > visible.center().y;
            let (corner, align) = if low {
                (visible.left_top() + vec2(6.0, 32.0), Align2::LEFT_TOP)
            } else {
                (visible.left_bottom() + vec2(6.0, -6.0), Align2::LEFT_BOTTOM)
            };
            label(self.painter, corner, align, &row.text, theme::HOVER);
        } else {
            // Marks the same column, for reading the disparity.
            for (width, color) in [(3.4, theme::HALO), (1.4, theme::HOVER)] {
                let across = if self.is_turned() { vec2(6.0, 0.0) } else { vec2(0.0, 6.0) };
                self.painter.line_segment([at - across, at + across], Stroke::new(width, color));
            }
        }
    }

    /// Returns the position of a pair's point; `None` if it is outside the rectified picture.
    fn place(&self, pair: &PointPair) -> Option<Pos2> {
        let side = self.sheet.side();
        let at = self.drawn.shown.maps[side.index()].rectified_from_original(side.point(pair))?;
        Some(self.transform.screen_from_image(at))
    }

    fn pairs(&self) {
        let document = &self.model.document;
        for (number, pair) in document.pairs.iter().enumerate() {
            let lit = self.model.open.focus.hovered() == Some(Target::Pair(number));
            let out = document.role(number) == Role::Excluded;
            let color =
                theme::pair_color(number).gamma_multiply(if out { theme::STALE_OPACITY } else { 1.0 });
            let radius = if lit { MARK + 3.0 } else { MARK };
            if let Some(at) = self.place(pair) {
                self.painter.circle_stroke(at, radius, Stroke::new(3.8, theme::HALO));
                self.painter.circle_stroke(at, radius, Stroke::new(1.8, color));
            }
        }
    }

    /// Draws the true matches while their overlay is on.
    fn true_matches(&self) {
        for (number, pair) in true_matches_shown(self.model) {
            let lit = self.model.open.focus.hovered() == Some(Target::TrueMatch(number));
            let (size, color) = if lit { (5.0, theme::SELECTED) } else { (2.0, theme::TRUE) };
            if let Some(at) = self.place(pair).filter(|at| self.painter.clip_rect().contains(*at)) {
                cross(self.painter, at, size, color);
            }
        }
    }

    /// Draws a title in layouts that do not show which picture it is.
    fn title(&self) {
        let text = match (self.model.look.rectified.layout, self.sheet) {
            (RectifiedLayout::Blink, RectifiedSheet::Left) => "Left",
            (RectifiedLayout::Blink, _) => "Right",
            (RectifiedLayout::Disparity, _) => match &self.drawn.disparity {
                None => "No disparities yet",
                Some((map, _)) if map.is_mostly_wrong() => "Left disparities, mostly wrong",
                _ => "Left disparities",
            },
            (RectifiedLayout::SideBySide, RectifiedSheet::Left) => "Left, rectified",
            (RectifiedLayout::SideBySide, _) => "Right, rectified",
        };
        let corner = self.painter.clip_rect().left_top() + vec2(6.0, 6.0);
        // Copies of the view carry the word of the verdict.
        let doubt = self.model.doubt().map_or_else(String::new, |(word, _)| format!(" · {word}"));
        label(self.painter, corner, Align2::LEFT_TOP, &format!("{text}{doubt}"), theme::SELECTED);
    }

    /// Draws the colour scale of the disparities at the upper right, with the suggested search range.
    fn scale(&self) {
        let map = self.drawn.disparity.as_ref().filter(|_| self.sheet == RectifiedSheet::Disparity);
        let Some((map, _)) = map else { return };
        let corner = self.painter.clip_rect().right_top() + vec2(-6.0, 6.0);
        let area = Rect::from_min_size(corner - vec2(SCALE.x + 12.0, 0.0), SCALE + vec2(12.0, 26.0));
        self.painter.rect_filled(area, 4.0, theme::LABEL_FILL);
        let bar = Rect::from_min_size(area.min + vec2(6.0, 6.0), SCALE);
        heat::bar(self.painter, bar, heat::color);
        let [low, high] = map.range.map(pixels_in_words);
        for (at, align, text) in [
            (bar.left_bottom(), Align2::LEFT_TOP, low),
            (bar.right_bottom(), Align2::RIGHT_TOP, format!("{high} px")),
        ] {
            let font = FontId::proportional(theme::CAPTION);
            self.painter.text(at + vec2(0.0, 3.0), align, text, font, theme::SELECTED);
        }
        let full = &self.drawn.full;
        if let Some(rows) = full.measures.rows.filter(|_| fits(full)) {
            let text = search_range_in_words(rows.disparity);
            label(
                self.painter,
                area.right_bottom() + vec2(0.0, 4.0),
                Align2::RIGHT_TOP,
                &text,
                theme::SELECTED,
            );
        }
    }
}
