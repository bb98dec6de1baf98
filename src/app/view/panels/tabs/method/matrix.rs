//! The similarity matrix of a click as a picture.
//!
//! The horizontal axis is the direction θ of the line in the left image. The vertical axis is the
//! rotation θ' − θ of the line in the right image. Only pairs within the largest rotation are
//! compared: against θ', they would lie in two narrow bands.

use std::f64::consts::{PI, TAU};

use egui::{
    Align2, Color32, ColorImage, FontId, Pos2, Rect, Stroke, TextureHandle, TextureOptions, Ui, pos2, vec2,
};

use crate::app::view::heat;
use crate::app::view::theme;
use crate::estimate::ComparedPencils;
use crate::geometry::Line;

/// Number of candidates marked, cheapest first.
const MARKED: usize = 80;
/// Distance within which the cursor snaps to a candidate, screen points.
const SNAP: f32 = 6.0;
/// Width of the label of an angle with its gap, screen points.
const LABEL: f32 = 34.0;

/// Picture of a matrix, kept from frame to frame.
#[derive(Clone)]
struct MatrixPicture {
    revision: u64,
    texture: TextureHandle,
    /// Largest rotation compared, radians.
    extent: f64,
}

/// Matrix of one click.
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
            let (image, extent) = painted(pencils);
            let texture = ui.ctx().load_texture("pencil matrix", image, TextureOptions::NEAREST);
            let picture = MatrixPicture { revision, texture, extent };
            ui.data_mut(|data| data.insert_temp(id, picture.clone()));
            picture
        });
        Self { pencils, picture }
    }

    /// Returns the position of a pair of directions.
    fn place(&self, plot: Rect, angles: [f64; 2]) -> Pos2 {
        let across = angles[0] / PI;
        let x = egui::lerp(plot.x_range(), across as f32);
        pos2(x, self.height(plot, turn(angles)))
    }

    /// Returns the vertical position of a rotation.
    fn height(&self, plot: Rect, turn: f64) -> f32 {
        let share = turn / self.picture.extent;
        plot.center().y - share as f32 * plot.height() / 2.0
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
        let turned = self.pencils.angles1[row] + (2.0 * up - 1.0) * self.picture.extent;
        let column = nearest(&self.pencils.angles2, turned.rem_euclid(TAU))?;
        self.pencils.costs.at(row, column).is_finite().then_some([row, column])
    }

    /// Describes a cell.
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

    /// Draws the matrix with axes, candidates, the cell under the cursor, and the lines of the
    /// geometry shown.
    pub fn draw(&self, ui: &Ui, plot: Rect, lit: Option<[usize; 2]>, shown: Option<(Line, Line)>) {
        let painter = ui.painter();
        painter.rect_filled(plot, 0.0, theme::palette(ui.visuals()).canvas);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(self.picture.texture.id(), plot, whole, Color32::WHITE);
        self.axes(ui, plot);
        let painter = ui.painter_at(plot.expand(5.0));
        let ring = |at: Pos2, radius: f32, color: Color32| {
            let width = radius / 4.0 + 0.8;
            painter.circle_stroke(at, radius, Stroke::new(width + 1.6, theme::HALO));
            painter.circle_stroke(at, radius, Stroke::new(width, color));
        };
        for candidate in self.pencils.candidates.iter().take(MARKED) {
            ring(self.place(plot, candidate.angles), 2.5, Color32::WHITE);
        }
        if let Some((line1, line2)) = shown {
            ring(self.place(plot, self.directions(&line1, &line2)), 5.5, theme::ESTIMATED);
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
    /// The second is the sense that was compared, with the smaller rotation if both were.
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
        let in_matrix =
            |angle2: f64| turn([angle1, angle2]).abs() <= self.picture.extent && was_compared(angle2);
        // If both senses were compared, the smaller rotation is taken.
        let less = turn([angle1, angle2]).abs() <= turn([angle1, other]).abs();
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
            let at = pos2(x, plot.max.y + 4.0);
            painter.text(at, Align2::CENTER_TOP, format!("{degrees}°"), font.clone(), color);
        }
        let extent = self.picture.extent.to_degrees();
        for share in [-1.0, 0.0, 1.0] {
            let y = self.height(plot, share * self.picture.extent);
            painter.hline(plot.min.x - 3.0..=plot.min.x, y, stroke);
            let at = pos2(plot.min.x, y) - vec2(5.0, 0.0);
            let text = format!("{:+.0}°", share * extent);
            painter.text(
                at,
                Align2::RIGHT_CENTER,
                if share == 0.0 { "0°" } else { &text },
                font.clone(),
                color,
            );
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
/// returns the largest rotation.
fn painted(pencils: &ComparedPencils) -> (ColorImage, f64) {
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
        return (ColorImage::filled([1, 1], Color32::TRANSPARENT), PI);
    }
    let cheapest = finite.iter().copied().fold(f32::INFINITY, f32::min);
    // Few pairs are similar, so the colours cover only the cheaper three quarters.
    let k = (finite.len() - 1) * 3 / 4;
    let dear = *finite.select_nth_unstable_by(k, f32::total_cmp).1;
    let step2 = PI / lines2 as f64;
    let extent = cells().map(|(angles, _)| turn(angles).abs()).fold(step2, f64::max);
    let height = (2.0 * extent / step2).round() as usize + 1;
    let mut image = ColorImage::filled([lines1, height], Color32::TRANSPARENT);
    for (angles, cost) in cells() {
        let x = (angles[0] / PI * lines1 as f64).round() as usize;
        let y = ((extent - turn(angles)) / step2).round() as usize;
        let share = (dear - cost) / (dear - cheapest).max(f32::MIN_POSITIVE);
        image.pixels[y.min(height - 1) * lines1 + x.min(lines1 - 1)] = heat::color(share);
    }
    (image, extent)
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
    fn the_nearest_line_is_found_at_the_ends_too() {
        let values = [0.0, 1.0, 3.0];
        for (wanted, found) in [(-5.0, 0), (0.4, 0), (0.6, 1), (2.5, 2), (9.0, 2)] {
            assert_eq!(nearest(&values, wanted), Some(found));
        }
        assert_eq!(nearest(&[], 1.0), None);
    }
}
