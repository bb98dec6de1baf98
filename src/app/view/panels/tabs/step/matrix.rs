//! The similarity matrix of a click as a picture.
//!
//! The horizontal axis is the direction θ of the line in the left image. The vertical axis is the
//! rotation θ' − θ of the line in the right image. Only pairs within the largest rotation from the relative
//! view are compared, and the axis shows this range alone.

use std::f64::consts::{PI, TAU};

use egui::{
    Align2, Color32, ColorImage, FontId, Pos2, Rect, Stroke, TextureHandle, TextureOptions, Ui, pos2, vec2,
};

use crate::app::view::{heat, theme};
use crate::estimate::ComparedPencils;
use crate::geometry::{Line, Vector};

/// Number of candidates marked, cheapest first.
const MARKED: usize = 80;
/// Distance within which the cursor snaps to a candidate, screen points.
const SNAP: f32 = 6.0;
/// Width of the label of an angle with its gap, screen points.
const LABEL: f32 = 34.0;

/// Distance from the plot to the end of the last label, screen points.
const LABEL_BEYOND: f32 = 8.0;
/// Outer radius of the largest ring, screen points.
const RING: f32 = 8.0;

/// Picture of a matrix, kept from frame to frame.
#[derive(Clone)]
struct MatrixPicture {
    revision: u64,
    texture: TextureHandle,
    rotations: Rotations,
}

/// Range of the rotations that were compared, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rotations {
    /// Rotation in the middle of the axis: 0 for upright images.
    middle: f64,
    /// Largest difference from the middle.
    extent: f64,
}

impl Rotations {
    /// Returns the range of these pairs of directions, with a middle at a multiple of 5°, and at least `least`
    /// on both sides.
    fn of(angles: impl Iterator<Item = [f64; 2]> + Clone, least: f64) -> Self {
        let sum: Vector = angles.clone().map(turn).map(|turn| Vector::new(turn.cos(), turn.sin())).sum();
        // The mean of directions on all sides has no meaning, and need not: all of them are in the range.
        let mean = sum.y.atan2(sum.x);
        let (low, high) = angles
            .clone()
            .map(|pair| turn([mean, turn(pair)]))
            .fold((0.0_f64, 0.0_f64), |(low, high), away| (low.min(away), high.max(away)));
        let step = PI / 36.0;
        let middle = turn([0.0, ((mean + f64::midpoint(low, high)) / step).round() * step]);
        let range = Self { middle, extent: least };
        Self { extent: angles.map(|pair| range.away(pair).abs()).fold(least, f64::max), ..range }
    }

    /// Returns the difference of a rotation from the middle, in `(−π, π]`.
    fn away(self, angles: [f64; 2]) -> f64 {
        turn([self.middle, turn(angles)])
    }
}

pub struct PencilMatrix<'a> {
    pencils: &'a ComparedPencils,
    picture: MatrixPicture,
}

/// Returns the rotation from the first direction to the second, radians in `(−π, π]`.
fn turn([a, b]: [f64; 2]) -> f64 {
    let turn = (b - a).rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}

impl<'a> PencilMatrix<'a> {
    /// Creates the matrix of the click with this number. The picture is drawn again when `revision`
    /// changes.
    pub fn new(ui: &Ui, number: usize, pencils: &'a ComparedPencils, revision: u64) -> Self {
        let id = egui::Id::unique(("pencil matrix", number));
        let kept =
            ui.data(|data| data.get_temp::<MatrixPicture>(id)).filter(|kept| kept.revision == revision);
        let picture = kept.unwrap_or_else(|| {
            let (image, rotations) = painted(pencils);
            let texture = ui.ctx().load_texture("pencil matrix", image, TextureOptions::NEAREST);
            let picture = MatrixPicture { revision, texture, rotations };
            ui.data_mut(|data| data.insert_temp(id, picture.clone()));
            picture
        });
        Self { pencils, picture }
    }

    /// Returns the position of a pair of directions.
    fn place(&self, plot: Rect, angles: [f64; 2]) -> Pos2 {
        let across = angles[0] / PI;
        let x = egui::lerp(plot.x_range(), across as f32);
        let share = self.picture.rotations.away(angles) / self.picture.rotations.extent;
        pos2(x, plot.center().y - share as f32 * plot.height() / 2.0)
    }

    /// Returns the cell at a position: a candidate within reach, or else the nearest compared pair
    /// of lines.
    pub fn cell_at(&self, plot: Rect, position: Pos2) -> Option<[usize; 2]> {
        let candidates = self.pencils.candidates.iter().take(MARKED);
        let distance = |angles| self.place(plot, angles).distance(position);
        let near = candidates.min_by(|a, b| distance(a.angles).total_cmp(&distance(b.angles)));
        if let Some(candidate) = near.filter(|candidate| distance(candidate.angles) <= SNAP) {
            return self.pencils.cell(candidate);
        }
        let across = f64::from((position.x - plot.min.x) / plot.width());
        let up = f64::from((plot.max.y - position.y) / plot.height());
        let angle1 = across.clamp(0.0, 1.0) * PI;
        let row = nearest(&self.pencils.angles1, angle1)?;
        let Rotations { middle, extent } = self.picture.rotations;
        let turned = self.pencils.angles1[row] + middle + (2.0 * up - 1.0) * extent;
        let column = nearest(&self.pencils.angles2, turned.rem_euclid(TAU))?;
        self.pencils.costs.at(row, column).is_finite().then_some([row, column])
    }

    pub fn describe(&self, cell: [usize; 2]) -> String {
        let [row, column] = cell;
        let Some(angles) = self.pencils.angles(row, column) else { return String::new() };
        let candidates = self.pencils.candidates.iter();
        let rank = candidates.map(|candidate| self.pencils.cell(candidate)).position(|at| at == Some(cell));
        let rank = rank.map_or(String::new(), |rank| format!("\nMutual best, rank {}", rank + 1));
        format!(
            "Left {:.1}°, right {:.1}°, rotation {:+.1}°\nCost {:.3}{rank}\nClick to inspect the two lines.",
            angles[0].to_degrees(),
            angles[1].to_degrees(),
            turn(angles).to_degrees(),
            self.pencils.costs.at(row, column)
        )
    }

    /// Covers the part of the matrix that has not been compared yet: the lines of the left picture from this row on.
    pub fn cover(&self, ui: &Ui, plot: Rect, row: usize) {
        let Some(angle) = self.pencils.angles1.get(row) else { return };
        let begin = self.place(plot, [*angle, *angle]).x;
        ui.painter().rect_filled(plot.with_min_x(begin), 0.0, theme::palette(ui.visuals()).canvas);
    }

    /// Draws the matrix with axes, candidates, the cell under the cursor, and the lines of the
    /// geometry shown in this colour.
    pub fn draw(
        &self,
        ui: &Ui,
        plot: Rect,
        lit: Option<[usize; 2]>,
        shown: Option<(Line, Line)>,
        color: Color32,
    ) {
        let painter = ui.painter();
        painter.rect_filled(plot, 0.0, theme::palette(ui.visuals()).canvas);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(self.picture.texture.id(), plot, whole, Color32::WHITE);
        self.axes(ui, plot);
        let painter = ui.painter_at(plot.expand(RING));
        let ring = |at: Pos2, radius: f32, color: Color32| {
            let width = radius / 4.0 + 0.8;
            painter.circle_stroke(at, radius, Stroke::new(width + 1.6, theme::HALO));
            painter.circle_stroke(at, radius, Stroke::new(width, color));
        };
        for candidate in self.pencils.candidates.iter().take(MARKED) {
            ring(self.place(plot, candidate.angles), 2.5, theme::UNCHECKED);
        }
        if let Some((line1, line2)) = shown {
            ring(self.place(plot, self.directions(&line1, &line2)), 5.5, color);
        }
        if let Some(angles) = lit.and_then(|[row, column]| self.pencils.angles(row, column)) {
            let at = self.place(plot, angles);
            let stroke = Stroke::new(1.0, Color32::from_white_alpha(170));
            painter.hline(plot.x_range(), at.y, stroke);
            painter.vline(at.x, plot.y_range(), stroke);
            ring(at, 5.5, theme::HOVER);
        }
    }

    /// Returns the directions of two undirected lines as the matrix has them. The first is in `[0, π)`.
    /// The second is the sense that was compared, with the rotation nearer to the middle if both were.
    fn directions(&self, line1: &Line, line2: &Line) -> [f64; 2] {
        let angle = |line: &Line| {
            let d = line.direction();
            d.y.atan2(d.x)
        };
        let angle1 = angle(line1).rem_euclid(PI);
        let angle2 = angle(line2).rem_euclid(TAU);
        let other = (angle2 + PI).rem_euclid(TAU);
        let nearest = |all: &[f64], angle: f64, period: f64| {
            let apart = |other: f64| {
                let apart = (other - angle).rem_euclid(period);
                apart.min(period - apart)
            };
            (0..all.len()).min_by(|a, b| apart(all[*a]).total_cmp(&apart(all[*b])))
        };
        let was_compared = |angle2: f64| {
            let row = nearest(&self.pencils.angles1, angle1, PI);
            let column = nearest(&self.pencils.angles2, angle2, TAU);
            row.zip(column).is_some_and(|(row, column)| self.pencils.costs.at(row, column).is_finite())
        };
        let away = |angle2: f64| self.picture.rotations.away([angle1, angle2]).abs();
        let in_matrix = |angle2: f64| away(angle2) <= self.picture.rotations.extent && was_compared(angle2);
        let less = away(angle2) <= away(other);
        if in_matrix(angle2) && (less || !in_matrix(other)) { [angle1, angle2] } else { [angle1, other] }
    }

    fn axes(&self, ui: &Ui, plot: Rect) {
        let painter = ui.painter();
        let color = ui.visuals().weak_text_color();
        let font = FontId::proportional(12.0);
        let stroke = Stroke::new(1.0, color);
        let step = if plot.width() < 4.0 * LABEL { 90 } else { 45 };
        for degrees in (0..=180).step_by(step) {
            let x = egui::lerp(plot.x_range(), degrees as f32 / 180.0);
            painter.vline(x, plot.max.y..=plot.max.y + 3.0, stroke);
            // The last label ends near the plot, so that the edge of the panel does not cut it.
            let (x, align) = match degrees {
                180 => (x + LABEL_BEYOND, Align2::RIGHT_TOP),
                _ => (x, Align2::CENTER_TOP),
            };
            let at = pos2(x, plot.max.y + 4.0);
            painter.text(at, align, format!("{degrees}°"), font.clone(), color);
        }
        let [middle, extent] =
            [self.picture.rotations.middle, self.picture.rotations.extent].map(f64::to_degrees);
        for (y, degrees) in
            [(plot.max.y, middle - extent), (plot.center().y, middle), (plot.min.y, middle + extent)]
        {
            painter.hline(plot.min.x - 3.0..=plot.min.x, y, stroke);
            let at = pos2(plot.min.x, y) - vec2(5.0, 0.0);
            let text = if degrees == 0.0 { "0°".to_owned() } else { format!("{degrees:+.0}°") };
            painter.text(at, Align2::RIGHT_CENTER, text, font.clone(), color);
        }
    }
}

/// Returns the index of the value nearest to `wanted` in an ascending list.
fn nearest(values: &[f64], wanted: f64) -> Option<usize> {
    let after = values.partition_point(|v| *v < wanted);
    let near = [after.checked_sub(1), (after < values.len()).then_some(after)];
    near.into_iter()
        .flatten()
        .min_by(|a, b| (values[*a] - wanted).abs().total_cmp(&(values[*b] - wanted).abs()))
}

/// Paints the matrix, one pixel per pair of lines, transparent where nothing was compared. Also
/// returns the range of the rotations.
fn painted(pencils: &ComparedPencils) -> (ColorImage, Rotations) {
    let costs = &pencils.costs;
    let cells = || {
        let rows = pencils.angles1.iter().enumerate();
        rows.flat_map(|(row, angle1)| {
            let columns = pencils.angles2.iter().enumerate();
            columns.map(move |(column, angle2)| ([*angle1, *angle2], costs.at(row, column)))
        })
        .filter(|(_, cost)| cost.is_finite())
    };
    let mut finite: Vec<f32> = cells().map(|(_, cost)| cost).collect();
    let [lines1, lines2] = pencils.lines_before.map(|lines| lines.max(1));
    if finite.is_empty() {
        return (ColorImage::filled([1, 1], Color32::TRANSPARENT), Rotations { middle: 0.0, extent: PI });
    }
    let cheapest = finite.iter().copied().fold(f32::INFINITY, f32::min);
    // Few pairs are similar, so the colours cover only the cheaper three quarters.
    let k = (finite.len() - 1) * 3 / 4;
    let dear = *finite.select_nth_unstable_by(k, f32::total_cmp).1;
    let step2 = PI / lines2 as f64;
    let angles: Vec<[f64; 2]> = cells().map(|(angles, _)| angles).collect();
    let rotations = Rotations::of(angles.iter().copied(), step2);
    let height = (2.0 * rotations.extent / step2).round() as usize + 1;
    let mut image = ColorImage::filled([lines1, height], Color32::TRANSPARENT);
    for (angles, cost) in cells() {
        let x = (angles[0] / PI * lines1 as f64).round() as usize;
        let y = ((rotations.extent - rotations.away(angles)) / step2).round() as usize;
        let share = (dear - cost) / (dear - cheapest).max(f32::MIN_POSITIVE);
        image.pixels[y.min(height - 1) * lines1 + x.min(lines1 - 1)] = heat::grey(share);
    }
    (image, rotations)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_go_the_short_way() {
        assert!((turn([0.1, 0.3]) - 0.2).abs() < 1e-12);
        assert!((turn([0.3, 0.1]) + 0.2).abs() < 1e-12);
        assert!((turn([3.0, TAU - 0.1]) - (TAU - 3.1)).abs() < 1e-12 || turn([3.0, TAU - 0.1]) < PI);
        assert!((turn([0.1, TAU - 0.1]) + 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_axis_shows_the_rotations_that_were_compared_and_no_others() {
        // All lines, each with those within 45° of the rotation between the images.
        for (rotation, middle) in [(0_i32, 0.0), (90, 90.0), (-88, -90.0), (178, 180.0)] {
            let pairs =
                (0..60_i32).flat_map(|k| (-45..=45).map(move |away| [3 * k, 3 * k + rotation + away]));
            let pairs = pairs.map(|pair| pair.map(|degrees| f64::from(degrees).to_radians().rem_euclid(TAU)));
            let range = Rotations::of(pairs.collect::<Vec<_>>().into_iter(), 0.01);
            assert!(turn([range.middle, f64::to_radians(middle)]).abs() < 1e-9, "{rotation}: {range:?}");
            assert!((44.9..=47.1).contains(&range.extent.to_degrees()), "{rotation}: {range:?}");
        }
    }

    #[test]
    fn the_nearest_line_is_found_at_the_ends_too() {
        let values = [0.0, 1.0, 3.0];
        for (wanted, found) in [(-5.0, 0), (0.4, 0), (0.6, 1), (2.5, 2), (9.0, 2)] {
            assert_eq!(nearest(&values, wanted), Some(found));
        }
        assert_eq!(nearest(&[], 1.0), None);
    }
}
