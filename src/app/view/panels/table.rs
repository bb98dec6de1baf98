//! A table that can be sorted by its headings.
//!
//! Only visible rows are painted, so that long lists cost no more than short ones.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Id, Rect, Role, ScrollArea, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::terms;
use crate::app::view::theme;

/// A column: its heading, and what its cells hold.
pub struct Column<'a> {
    title: &'static str,
    /// Written behind the title.
    unit: &'static str,
    tooltip: &'static str,
    width: f32,
    /// Whether the column holds text instead of figures. Text is left-aligned, and may continue
    /// over the following columns where they are empty.
    is_text: bool,
    /// Value by which a row is sorted; NaN comes last.
    key: Box<dyn Fn(usize) -> f64 + 'a>,
    text: Box<dyn Fn(usize) -> String + 'a>,
}

impl<'a> Column<'a> {
    /// Returns the width below which figures touch each other, screen points.
    pub fn least_width(&self) -> f32 {
        self.width * 0.7
    }

    /// Creates a column of figures. NaN stands for a missing one.
    pub fn figures(
        title: &'static str,
        width: f32,
        tooltip: &'static str,
        figure: impl Fn(usize) -> f64 + Clone + 'a,
        format: impl Fn(f64) -> String + 'a,
    ) -> Self {
        let own = figure.clone();
        let text = move |row: usize| {
            let figure = own(row);
            if figure.is_nan() { String::new() } else { format(figure) }
        };
        Self { is_text: false, key: Box::new(figure), ..Self::words(title, width, tooltip, text) }
    }

    /// Creates a column of text, in the order of the rows.
    pub fn words(
        title: &'static str,
        width: f32,
        tooltip: &'static str,
        text: impl Fn(usize) -> String + 'a,
    ) -> Self {
        let key = Box::new(|row| row as f64);
        Self { title, unit: "", tooltip, width, is_text: true, key, text: Box::new(text) }
    }

    /// Tells the unit of the figures in the heading.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Writes other texts than the figures.
    pub fn written(self, text: impl Fn(usize) -> String + 'a) -> Self {
        Self { text: Box::new(text), ..self }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sort {
    pub column: usize,
    /// Whether the largest value comes first.
    pub descending: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RowLook {
    pub chosen: bool,
    /// Whether the row, or its item elsewhere, is under the cursor.
    pub lit: bool,
}

/// User actions on the rows in this frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Touched {
    pub hovered: Option<usize>,
    pub clicked: Option<usize>,
}

pub struct Table<'a> {
    /// Name, used for stored state and by screen readers.
    pub name: &'static str,
    pub columns: &'a [Column<'a>],
    pub rows: usize,
    /// Revision of the figures; a change triggers sorting.
    pub revision: u64,
    /// Run of the computation, and number of the list in it. Another list opens at its top; later figures of
    /// the same list leave it scrolled as it is.
    pub list: (u64, usize),
    pub row_name: &'a dyn Fn(usize) -> String,
    pub about: &'a dyn Fn(usize) -> Option<String>,
    pub look: &'a dyn Fn(usize) -> RowLook,
}

struct Headings {
    texts: Vec<String>,
    /// Width of the column that each heading needs, screen points.
    needed: Vec<f32>,
    font: FontId,
}

/// Order of the rows, kept from frame to frame.
#[derive(Clone)]
struct Ordered {
    sort: Sort,
    revision: u64,
    list: (u64, usize),
    rows: usize,
    order: Arc<[usize]>,
}

const ROW: f32 = 22.0;
/// Distances of text from the left and the right edge of its column, screen points. The mark of the sort order
/// has room at the right.
const INSET: f32 = 6.0;
const MARK: f32 = 14.0;

impl Table<'_> {
    pub fn show(&self, ui: &mut Ui) -> Touched {
        let id = ui.make_persistent_id(self.name);
        let mut sort =
            ui.data(|data| data.get_temp::<Sort>(id)).unwrap_or(Sort { column: 0, descending: false });
        let font = TextStyle::Body.resolve(ui.style());
        let headings = self.headings_for(ui, &font);
        let edges = self.edges(ui.available_width(), &headings.needed);
        if let Some(clicked) = self.show_headings(ui, &edges, sort, &headings) {
            let descending = sort.column == clicked && !sort.descending;
            sort = Sort { column: clicked, descending };
            ui.data_mut(|data| data.insert_temp(id, sort));
        }
        let (order, is_new) = self.remembered_order(ui, id.with("order"), sort);
        let mut touched = Touched::default();
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut area = ScrollArea::vertical().id_salt(self.name).auto_shrink([false, false]);
        if is_new {
            // Another list begins at its top, or where the chosen row is in the middle.
            let chosen = order.iter().position(|row| (self.look)(*row).chosen).unwrap_or(0);
            area = area.vertical_scroll_offset((chosen as f32 * ROW - ui.available_height() / 2.0).max(0.0));
        }
        area.show_rows(ui, ROW, order.len(), |ui, visible| {
            for place in visible {
                let response = self.row(ui, order[place], place, &edges, id, &font);
                if response.contains_pointer() {
                    touched.hovered = Some(order[place]);
                }
                if response.clicked() {
                    touched.clicked = Some(order[place]);
                }
            }
        });
        touched
    }

    /// Returns the least width at which no heading touches the next one, screen points.
    pub fn least_width(&self, ui: &Ui) -> f32 {
        self.small_headings(ui).needed.iter().sum()
    }

    /// Returns headings that fit the available width. In little room they are small and have no unit.
    fn headings_for(&self, ui: &Ui, font: &FontId) -> Headings {
        let large = self.headings_in(ui, font.clone(), |column| format!("{}{}", column.title, column.unit));
        let fits = large.needed.iter().sum::<f32>() <= ui.available_width();
        if fits { large } else { self.small_headings(ui) }
    }

    fn small_headings(&self, ui: &Ui) -> Headings {
        self.headings_in(ui, FontId::proportional(theme::CAPTION), |column| column.title.to_owned())
    }

    fn headings_in(&self, ui: &Ui, font: FontId, text: impl Fn(&Column<'_>) -> String) -> Headings {
        let texts: Vec<String> = self.columns.iter().map(text).collect();
        let width = |text: &String| {
            ui.painter().layout_no_wrap(text.clone(), font.clone(), Color32::WHITE).size().x + INSET + MARK
        };
        let needed = texts.iter().map(width).collect();
        Headings { texts, needed, font }
    }

    /// Returns the right edge of each column, relative to the left edge of the table. Each column has at least
    /// the width that its heading needs, if there is room for all.
    fn edges(&self, available: f32, needed: &[f32]) -> Vec<f32> {
        let widths = |scale: f32| {
            self.columns.iter().zip(needed).map(move |(column, needed)| (column.width * scale).max(*needed))
        };
        // In a wide window, columns spread out only as far as a row stays readable.
        let (mut low, mut high) = (0.0, 1.6);
        for _ in 0..20 {
            let middle = f32::midpoint(low, high);
            if widths(middle).sum::<f32>() > available { high = middle } else { low = middle }
        }
        let right = |sum: &mut f32, width: f32| {
            *sum += width;
            Some(*sum)
        };
        widths(low).scan(0.0, right).collect()
    }

    /// Returns the order of the rows, sorted again only after a change, and whether it is of another list or
    /// sorted in another way.
    fn remembered_order(&self, ui: &Ui, id: Id, sort: Sort) -> (Arc<[usize]>, bool) {
        let (revision, list, rows) = (self.revision, self.list, self.rows);
        let kept = ui.data(|data| data.get_temp::<Ordered>(id));
        let is_new = kept.as_ref().is_none_or(|kept| kept.sort != sort || kept.list != list);
        if let Some(kept) = kept.filter(|k| !is_new && k.revision == revision && k.rows == rows) {
            return (kept.order, false);
        }
        let order: Arc<[usize]> = self.order(sort).into();
        let kept = Ordered { sort, revision, list, rows, order: Arc::clone(&order) };
        ui.data_mut(|data| data.insert_temp(id, kept));
        (order, is_new)
    }

    fn order(&self, sort: Sort) -> Vec<usize> {
        let key = &self.columns[sort.column].key;
        let mut keyed: Vec<(f64, usize)> = (0..self.rows).map(|row| (key(row), row)).collect();
        keyed.sort_by(|(a, _), (b, _)| match (a.is_nan(), b.is_nan()) {
            (false, false) if sort.descending => b.total_cmp(a),
            (false, false) => a.total_cmp(b),
            (a_missing, b_missing) => a_missing.cmp(&b_missing),
        });
        keyed.into_iter().map(|(_, row)| row).collect()
    }

    /// Shows the headings. Returns the column that was clicked.
    fn show_headings(&self, ui: &mut Ui, edges: &[f32], sort: Sort, headings: &Headings) -> Option<usize> {
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let mut clicked = None;
        for (number, column) in self.columns.iter().enumerate() {
            let left = if number == 0 { 0.0 } else { edges[number - 1] };
            let cell = Rect::from_min_max(
                pos2(area.min.x + left, area.min.y),
                pos2(area.min.x + edges[number], area.max.y),
            );
            let response = ui.interact(cell, ui.scope_id().with((self.name, number)), Sense::click());
            let text = format!("Sort by {}", column.title);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &text));
            let color = if response.hovered() || response.has_focus() {
                ui.visuals().strong_text_color()
            } else {
                ui.visuals().weak_text_color()
            };
            let (start, end) = (cell.left_center() + vec2(INSET, 0.0), cell.right_center() - vec2(MARK, 0.0));
            let (at, align) =
                if column.is_text { (start, Align2::LEFT_CENTER) } else { (end, Align2::RIGHT_CENTER) };
            let title = ui.painter().text(at, align, &headings.texts[number], headings.font.clone(), color);
            if sort.column == number {
                let mark = title.right_center() + vec2(8.0, 0.0);
                sort_mark(ui, mark, sort.descending, color);
            }
            let meaning = terms::mark(ui, title, column.title).unwrap_or_default();
            let tooltip = format!("{meaning} {} Click to sort.", column.tooltip);
            if response.on_hover_text(tooltip.trim_start()).clicked() {
                clicked = Some(number);
            }
        }
        ui.painter().hline(area.x_range(), area.max.y, ui.visuals().widgets.noninteractive.bg_stroke);
        clicked
    }

    fn row(
        &self,
        ui: &mut Ui,
        row: usize,
        place: usize,
        edges: &[f32],
        id: Id,
        font: &FontId,
    ) -> egui::Response {
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let response = ui.interact(area, id.with(("row", row)), Sense::click());
        let RowLook { chosen, lit } = (self.look)(row);
        let name = (self.row_name)(row);
        response.widget_info(|| WidgetInfo::selected(Role::Row, true, chosen, &name));
        let visuals = ui.visuals();
        let fill = if chosen {
            Some(visuals.selection.bg_fill)
        } else if lit || response.hovered() {
            Some(visuals.widgets.hovered.bg_fill)
        } else {
            (place % 2 == 1).then_some(visuals.faint_bg_color)
        };
        let color = if chosen { visuals.selection.stroke.color } else { visuals.text_color() };
        if let Some(fill) = fill {
            ui.painter().rect_filled(area, 2.0, fill);
        }
        if response.has_focus() {
            let stroke = Stroke::new(1.0, theme::palette(visuals).accent);
            ui.painter().rect_stroke(area, 2.0, stroke, egui::StrokeKind::Inside);
        }
        let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
        let mut left = 0.0;
        for (right, column) in edges.iter().zip(self.columns) {
            let (start, end) = (area.min.x + left + INSET, area.min.x + right - MARK);
            let text = (column.text)(row);
            if column.is_text {
                let at = pos2(start, area.center().y);
                painter.text(at, Align2::LEFT_CENTER, text, font.clone(), color);
            } else {
                let at = pos2(end, area.center().y);
                painter.text(at, Align2::RIGHT_CENTER, text, font.clone(), color);
            }
            left = *right;
        }
        match (self.about)(row).filter(|_| response.hovered()) {
            Some(words) => response.on_hover_text(words),
            None => response,
        }
    }
}

/// Draws the triangle of the sort order; it points up if the smallest value comes first.
pub fn sort_mark(ui: &Ui, centre: egui::Pos2, descending: bool, color: Color32) {
    let tip = if descending { 3.0 } else { -3.0 };
    let corners = vec![centre + vec2(0.0, tip), centre + vec2(-4.0, -tip), centre + vec2(4.0, -tip)];
    ui.painter().add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: Sort = Sort { column: 0, descending: false };

    fn table<'a>(columns: &'a [Column<'a>], rows: usize) -> Table<'a> {
        Table {
            name: "test",
            columns,
            rows,
            row_name: &|_| String::new(),
            about: &|_| None,
            look: &|_| RowLook::default(),
            revision: 0,
            list: (0, 0),
        }
    }

    #[test]
    fn later_figures_of_a_list_are_sorted_where_it_is_scrolled_to() {
        egui::__run_test_ui(|ui| {
            let of = |rows: usize, list, sort| {
                let columns = [Column::words("", 1.0, "", |_| String::new())];
                let table = Table { revision: rows as u64, list, ..table(&columns, rows) };
                let (order, is_new) = table.remembered_order(ui, Id::unique("order"), sort);
                (order.len(), is_new)
            };
            assert_eq!(of(3, (1, 0), UP), (3, true));
            assert_eq!(of(4, (1, 0), UP), (4, false), "a later result of the same run");
            assert_eq!(of(4, (2, 0), UP), (4, true), "another run");
            assert_eq!(of(4, (2, 1), UP), (4, true), "another list");
            assert_eq!(of(4, (2, 1), Sort { descending: true, ..UP }), (4, true));
        });
    }

    #[test]
    fn headings_have_room_for_the_mark_of_the_sort_order() {
        egui::__run_test_ui(|ui| {
            let column = |title, width| Column::words(title, width, "", |_| String::new()).in_unit(", px");
            let columns = [column("Rank", 74.0), column("Round trip", 20.0), column("Epipole", 130.0)];
            let table = table(&columns, 1);
            let font = TextStyle::Body.resolve(ui.style());
            for width in [table.least_width(ui) + 1.0, 260.0, 400.0] {
                ui.set_max_width(width);
                let headings = table.headings_for(ui, &font);
                let edges = table.edges(width, &headings.needed);
                assert!(edges.last().is_some_and(|right| *right <= width), "{edges:?} in {width}");
                let mut left = 0.0;
                for (text, right) in headings.texts.iter().zip(edges) {
                    let drawn =
                        ui.painter().layout_no_wrap(text.clone(), headings.font.clone(), Color32::WHITE);
                    assert!(right - left >= drawn.size().x + INSET + MARK - 0.1, "{text} in {width}");
                    left = right;
                }
            }
        });
    }

    #[test]
    fn rows_sort_both_ways_with_missing_values_last() {
        let figures = [3.0, f64::NAN, 1.0, 2.0];
        let columns = [Column::figures("", 1.0, "", |row| figures[row], |figure| figure.to_string())];
        let table = table(&columns, figures.len());
        assert_eq!(table.order(UP), [2, 3, 0, 1]);
        assert_eq!(table.order(Sort { column: 0, descending: true }), [0, 3, 2, 1]);
    }
}
