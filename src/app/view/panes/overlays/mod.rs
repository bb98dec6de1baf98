//! Overlays of the images, one file each, registered in [`OVERLAYS`].

mod crosshair;
mod epipoles;
mod given;
mod hover;
mod hypotheses;
mod lines;
mod matches;
mod next_click;
mod pinned;
mod pointed;
mod points;
pub mod replay;
mod residuals;
mod samples;
mod suggestion;
mod table;
mod true_lines;
mod true_matches;
mod uncertainty;

pub use crosshair::draw as draw_crosshair;
pub use pinned::number_at as pinned_at;
pub use suggestion::places as suggested_places;
pub use table::OVERLAYS;
pub use true_matches::cross;

use std::cell::RefCell;

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};

use super::Transform;
use super::chip::moved_into;
use crate::app::model::computation::Freshness;
use crate::app::model::shown::ShownGeometry;
use crate::app::model::verdict::LineLook;
use crate::app::model::{Model, OverlayId, Side, Target};
use crate::app::view::theme;
use crate::geometry::{Frame, FundamentalMatrix, Line, Point, PointPair, Segment};

/// An item under the cursor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pointing {
    pub target: Target,
    /// Distance from the cursor, screen points.
    distance: f32,
}

impl Pointing {
    /// Returns the nearest of numbered items on the screen, if it is within reach of a position.
    fn nearest(
        items: impl Iterator<Item = (usize, Pos2)>,
        position: Pos2,
        reach: f32,
        target: fn(usize) -> Target,
    ) -> Option<Self> {
        let distances = items.map(|(number, at)| (number, at.distance(position)));
        let (number, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (distance <= reach).then(|| Self { target: target(number), distance })
    }
}

/// Function that finds the item of an overlay at a screen position.
type Finder = fn(&Canvas, Pos2) -> Option<Pointing>;

/// Returns the nearest visible item within reach of the cursor.
pub fn pointed_at(canvas: &Canvas, position: Pos2) -> Option<Target> {
    let finders: [(OverlayId, Finder); 5] = [
        (OverlayId::Points, points::at),
        (OverlayId::Hypotheses, hypotheses::at),
        (OverlayId::Matches, matches::at),
        (OverlayId::TrueMatches, true_matches::at),
        (OverlayId::Given, given::at),
    ];
    // The replay draws only the points of these.
    let replayed = canvas.model.drawn_moment().is_some();
    let is_drawn =
        |overlay: OverlayId| canvas.model.look.shows(overlay) && (!replayed || overlay == OverlayId::Points);
    let found = finders.iter().filter(|(overlay, _)| is_drawn(*overlay));
    let found = found.filter_map(|(_, at)| at(canvas, position));
    // The plot marks the sample under the cursor even if its overlay is off.
    let is_paused = !canvas.model.open.replay.is_playing();
    let found = found.chain(samples::at(canvas, position));
    let found = found.chain(replay::at(canvas, position).filter(|_| is_paused));
    found.min_by(|a, b| a.distance.total_cmp(&b.distance)).map(|pointing| pointing.target)
}

/// Returns the true matches drawn over the images, with their indices; none if the overlay is off.
pub fn true_matches_shown(model: &Model) -> impl Iterator<Item = (usize, &PointPair)> {
    let shown = model.look.shows(OverlayId::TrueMatches);
    true_matches::drawn(model).filter(move |_| shown)
}

/// Areas of an image occupied by text.
#[derive(Debug, Default)]
pub struct Labels(RefCell<Vec<Rect>>);

impl Labels {
    fn is_free(&self, area: Rect) -> bool {
        self.0.borrow().iter().all(|other| !other.intersects(area))
    }

    /// Occupies an area.
    pub fn take(&self, area: Rect) {
        self.0.borrow_mut().push(area);
    }

    /// Occupies and returns an area for a text of this size near `at`. It is the first area in the pane
    /// that is free, or else the first one in the pane.
    fn place(&self, pane: Rect, at: Pos2, size: Vec2) -> Rect {
        let places = [1.0, 2.2, 3.4].into_iter().flat_map(|steps| {
            let away = 9.0 + (steps - 1.0) * size.y;
            let (left, right) = (at.x - 9.0 - size.x, at.x + 9.0);
            let (above, below) = (at.y - away - size.y, at.y + away);
            [(right, above), (left, above), (right, below), (left, below)]
        });
        let areas: Vec<Rect> = places.map(|(x, y)| Rect::from_min_size(Pos2::new(x, y), size)).collect();
        let inside = |area: &&Rect| pane.contains_rect(**area);
        let free = |area: &&Rect| self.is_free(**area);
        let found = areas.iter().filter(inside).find(free).or(areas.iter().find(inside)).or(areas.first());
        let area = found.copied().unwrap_or(Rect::from_min_size(at, size));
        self.take(area);
        area
    }
}

/// Number of places tried for a text on a line, from the border inwards.
const STEPS: usize = 7;
/// Space between these places, screen points.
const BETWEEN: f32 = 3.0;
/// Share of a line, from the border, on which its text may stand. Farther inwards it would cover the image.
const BORDER: f32 = 0.4;

/// Number of pairs that hide the pictures if each has a ring, a name and a strong line.
const CROWD: usize = 25;

/// Drawing surface over an image.
pub struct Canvas<'a> {
    /// Painter, clipped to the pane.
    pub painter: &'a Painter,
    pub transform: &'a Transform,
    pub side: Side,
    pub frame: Frame,
    pub model: &'a Model,
    /// Occupied text areas; `None` if no labels are drawn.
    pub labels: Option<&'a Labels>,
    /// Whether the surface is a figure instead of the window.
    pub is_figure: bool,
}

impl Canvas<'_> {
    /// Returns the geometry shown and the opacity of its lines.
    fn shown(&self) -> Option<(ShownGeometry<'_>, f32)> {
        self.model.shown().map(|shown| {
            (shown, if shown.freshness == Freshness::Stale { theme::STALE_OPACITY } else { 1.0 })
        })
    }

    /// Returns a cursor or selection state in the window, and nothing in a figure.
    fn at_hand<T>(&self, of_state: Option<T>) -> Option<T> {
        of_state.filter(|_| !self.is_figure)
    }

    /// Returns whether a pair is one of very many, and neither selected, nor pointed at, nor outvoted. Its
    /// marks are small and its line is faint.
    fn is_lost_in_a_crowd(&self, pair: usize) -> bool {
        let document = &self.model.document;
        let is_crowded = document.pairs.len() >= CROWD && !self.is_figure;
        let stands_out = || {
            document.selection.is_some_and(|selected| selected.pair == pair)
                || self.model.open.focus.hovered() == Some(Target::Pair(pair))
                || self.model.outvoted(pair).is_some()
        };
        is_crowded && !stands_out()
    }

    /// Returns the screen position of a pair's point in this image.
    fn place(&self, pair: &PointPair) -> Pos2 {
        self.transform.screen_from_image(self.side.point(pair))
    }

    /// Returns the visible area of the image on the screen.
    fn sight(&self) -> Rect {
        self.transform.rect.intersect(self.painter.clip_rect())
    }

    /// Returns the epipolar line in this image of a point in the other image.
    fn line_from_other(&self, f: &FundamentalMatrix, point: Point) -> Option<Line> {
        match self.side {
            Side::Left => f.line1_from_point2(point),
            Side::Right => f.line2_from_point1(point),
        }
    }

    /// Returns the epipolar line in this image through one of its points.
    fn line_through(&self, f: &FundamentalMatrix, point: Point) -> Option<Line> {
        let epipole = self.side.epipole(f);
        Line::joining(&epipole, &point.to_homogeneous())
    }

    /// Draws the part of a line on the image, with a dark edge.
    fn line(&self, line: &Line, width: f32, color: Color32) {
        if let Some(segment) = self.frame.clip(line) {
            self.segment(segment.start, segment.end, width, color);
        }
    }

    /// Draws the visible part of a line dashed, with a dark edge.
    fn dashed_line(&self, line: &Line, width: f32, color: Color32) {
        self.dashes(&self.in_sight(line), width, color);
    }

    /// Draws an epipolar line of the geometry shown, in the look of its verdict.
    fn epipolar_line(&self, line: &Line, width: f32, color: Color32) {
        if let Some(part) = self.frame.clip(line) {
            self.epipolar_part(&part, width, color);
        }
    }

    /// Draws a part of an epipolar line of the geometry shown, in the look of its verdict.
    fn epipolar_part(&self, part: &Segment, width: f32, color: Color32) {
        match self.model.line_look() {
            LineLook::Solid | LineLook::Other => self.segment(part.start, part.end, width, color),
            // Dashes out of view would cost time: many thousands when magnified.
            LineLook::Dashed => self.dashes(&self.visible(part), width, color),
            LineLook::Dotted => {
                let path = self.visible(part);
                for (radius, color) in [(width * 0.5 + 1.0, theme::HALO), (width * 0.5 + 0.4, color)] {
                    self.painter.extend(Shape::dotted_line(&path, color, 3.0 * width + 3.0, radius));
                }
            }
            LineLook::Hidden => {}
        }
    }

    fn dashes(&self, path: &[Pos2], width: f32, color: Color32) {
        self.stroke(path, width + 1.5, theme::HALO.gamma_multiply(0.5));
        self.painter.extend(Shape::dashed_line(path, Stroke::new(width, color), 12.0, 7.0));
    }

    /// Returns the visible part of a line on the screen; empty if there is none.
    fn in_sight(&self, line: &Line) -> Vec<Pos2> {
        self.frame.clip(line).map_or_else(Vec::new, |part| self.visible(&part))
    }

    /// Returns the visible part of a segment on the screen; empty if there is none.
    fn visible(&self, part: &Segment) -> Vec<Pos2> {
        let curve = self.transform.curve(part.start, part.end);
        let mut path: Vec<Pos2> = Vec::new();
        for ends in curve.windows(2).filter_map(|ends| within([ends[0], ends[1]], self.sight())) {
            if path.last() != Some(&ends[0]) {
                path.push(ends[0]);
            }
            path.push(ends[1]);
        }
        path
    }

    /// Draws a path: a plain segment, or the pieces of a curve.
    fn stroke(&self, path: &[Pos2], width: f32, color: Color32) {
        match *path {
            [] | [_] => {}
            [start, end] => {
                self.painter.line_segment([start, end], Stroke::new(width, color));
            }
            _ => {
                self.painter.line(path.to_vec(), Stroke::new(width, color));
            }
        }
    }

    /// Draws a segment between two image positions, with a dark edge.
    fn segment(&self, start: Point, end: Point, width: f32, color: Color32) {
        let path = self.transform.curve(start, end);
        let opacity = f32::from(color.a()) / 255.0;
        self.stroke(&path, width + 2.0, theme::HALO.gamma_multiply(opacity));
        self.stroke(&path, width, color);
    }

    /// Draws a dot at an image position, with a dark edge.
    fn dot(&self, at: Point, radius: f32, color: Color32) {
        let at = self.transform.screen_from_image(at);
        let opacity = f32::from(color.a()) / 255.0;
        self.painter.circle_filled(at, radius + 1.2, theme::HALO.gamma_multiply(opacity));
        self.painter.circle_filled(at, radius, color);
    }

    /// Writes a short text near a screen position, inside the pane and clear of other texts.
    pub fn label(&self, at: Pos2, text: &str, color: Color32) {
        let Some(labels) = self.labels else { return };
        let galley = self.painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), color);
        let size = galley.size() + vec2(8.0, 2.0);
        let area = labels.place(self.transform.rect.shrink(2.0), at, size);
        self.painter.rect_filled(area, 4.0, theme::LABEL_FILL);
        let corner = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), area).min;
        self.painter.galley(corner, galley, color);
    }

    /// Writes a text onto a path that begins at the border, as near to the border as other texts allow. Leaves out a
    /// text that would cover another one.
    fn label_on(&self, path: &[Pos2], text: &str, color: Color32) {
        let Some(labels) = self.labels else { return };
        let galley = self.painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), color);
        let size = galley.size() + vec2(8.0, 2.0);
        let length: f32 = path.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        let sight = self.sight();
        let step = size.x + BETWEEN;
        let ways =
            (0..STEPS).map(|k| (0.5 + k as f32) * step).take_while(|way| *way <= (BORDER * length).max(step));
        // The text of a line along the border is moved inside.
        let mut areas = ways.map(|way| moved_into(Rect::from_center_size(along(path, way), size), sight));
        let Some(area) = areas.find(|area| sight.contains_rect(*area) && labels.is_free(*area)) else {
            return;
        };
        labels.take(area);
        self.painter.rect_filled(area, 3.0, theme::LABEL_FILL);
        let corner = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), area).min;
        self.painter.galley(corner, galley, color);
    }
}

/// Returns the point of a path at a distance from its start.
fn along(path: &[Pos2], mut way: f32) -> Pos2 {
    for ends in path.windows(2) {
        let length = ends[0].distance(ends[1]);
        if way <= length && length > 0.0 {
            return ends[0] + (ends[1] - ends[0]) * (way / length);
        }
        way -= length;
    }
    path.last().copied().unwrap_or_default()
}

/// Clips a segment to a rectangle.
fn within([start, end]: [Pos2; 2], area: Rect) -> Option<[Pos2; 2]> {
    let (mut from, mut to) = (0.0f32, 1.0f32);
    let way = end - start;
    for (at, along, range) in [(start.x, way.x, area.x_range()), (start.y, way.y, area.y_range())] {
        if along.abs() < f32::EPSILON {
            if !range.contains(at) {
                return None;
            }
            continue;
        }
        let (a, b) = ((range.min - at) / along, (range.max - at) / along);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from <= to).then(|| [start + way * from, start + way * to])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_is_clipped_to_a_rectangle() {
        let area = Rect::from_min_max(Pos2::new(10.0, 10.0), Pos2::new(110.0, 60.0));
        let at = |x: f32, y: f32| Pos2::new(x, y);
        assert_eq!(within([at(0.0, 20.0), at(200.0, 20.0)], area), Some([at(10.0, 20.0), at(110.0, 20.0)]));
        assert_eq!(within([at(50.0, 100.0), at(50.0, 40.0)], area), Some([at(50.0, 60.0), at(50.0, 40.0)]));
        assert_eq!(within([at(0.0, 5.0), at(200.0, 5.0)], area), None);
        assert_eq!(within([at(0.0, 55.0), at(40.0, 95.0)], area), None, "past a corner");
        let inside = [at(20.0, 20.0), at(30.0, 50.0)];
        assert_eq!(within(inside, area), Some(inside));
    }

    #[test]
    fn texts_stay_in_the_pane_and_off_each_other() {
        let pane = Rect::from_min_max(Pos2::ZERO, Pos2::new(200.0, 150.0));
        let labels = Labels::default();
        let size = vec2(40.0, 16.0);
        let mut placed: Vec<Rect> = Vec::new();
        for k in 0..6 {
            let area = labels.place(pane, Pos2::new(100.0 + k as f32, 70.0), size);
            assert!(
                pane.contains_rect(area) && placed.iter().all(|other| !other.intersects(area)),
                "{k}: {area:?}"
            );
            placed.push(area);
        }
        for corner in [pane.min, pane.max, pane.right_top(), pane.left_bottom()] {
            assert!(pane.contains_rect(Labels::default().place(pane, corner, size)));
        }
    }
}
