//! Shapes and times that several steps share.

use super::moment::{Ink, Moment, Shape};
use super::record::Record;
use crate::app::model::document::Side;
use crate::app::model::focus::{Replayed, Target};
use crate::estimate::HypothesisNote;
use crate::geometry::{AnchoredLine, FundamentalMatrix, HomogeneousPoint, Line, Point, fan, finite_point};

/// Number of candidates of a list that are drawn.
pub const CANDIDATES: usize = 40;
/// Largest zoom.
const FARTHEST: f64 = 6.0;
/// Share of the epipoles that the zoom brings into view.
const IN_VIEW: f64 = 0.9;

/// Returns the share of a part of a step that has passed, 0 to 1.
pub fn share(seconds: f64, begin: f64, length: f64) -> f64 {
    ((seconds - begin) / length).clamp(0.0, 1.0)
}

pub fn ease_out(share: f64) -> f64 {
    1.0 - (1.0 - share).powi(3)
}

pub fn ease_in_out(share: f64) -> f64 {
    if share < 0.5 { 4.0 * share.powi(3) } else { 1.0 - (2.0 - 2.0 * share).powi(3) / 2.0 }
}

pub fn both(lines: &[AnchoredLine; 2]) -> [Option<Line>; 2] {
    lines.each_ref().map(|line| Some(line.line()))
}

pub fn pencil_lines(lines: [Option<Line>; 2], width: f32) -> Shape {
    Shape::Lines { lines, width, dashed: false }
}

pub fn epipoles_of(own: &HypothesisNote) -> [HomogeneousPoint; 2] {
    Side::BOTH.map(|side| side.epipole(&own.fundamental))
}

/// Draws a candidate that turns from the colour of its pencil to violet: the better, the stronger.
pub fn candidate(
    moment: &mut Moment,
    target: Option<Target>,
    (rank, lines): (usize, &[AnchoredLine; 2]),
    (ink, violet): (Ink, f64),
) {
    let best = 1.0 - rank as f64 / CANDIDATES as f64;
    let (shape, opacity) = (pencil_lines(both(lines), 1.0 + best as f32), 0.25 + 0.6 * best);
    moment.add_of(target, shape.clone(), ink, opacity * (1.0 - violet));
    moment.add_of(target, shape, Ink::Unchecked, opacity * violet);
}

/// Returns a place on a line for its note, clear of the anchor: on its longer part.
pub fn beside(record: &Record, side: Side, line: &AnchoredLine) -> Option<Point> {
    let segment = record.frames[side.index()].clip(&line.line())?;
    let away = |end: &Point| (end - line.anchor).norm();
    let end = if away(&segment.start) > away(&segment.end) { segment.start } else { segment.end };
    Some(line.anchor + (end - line.anchor) * 0.6)
}

/// Draws two lines with notes beside them.
pub fn noted_lines(
    moment: &mut Moment,
    record: &Record,
    lines: &[AnchoredLine; 2],
    notes: [String; 2],
    ink: Ink,
) {
    for ((side, line), text) in Side::BOTH.into_iter().zip(lines).zip(notes) {
        if let Some(at) = beside(record, side, line) {
            moment.add(Shape::Note { side, at, text }, ink, 1.0);
        }
    }
}

/// Returns the zoom that brings most epipoles of both pictures into view, of those that any zoom does.
pub fn farthest(record: &Record) -> f64 {
    let mut needed: Vec<f64> = record
        .hypotheses
        .iter()
        .map(|own| {
            let of = |side: Side| {
                let frame = record.frames[side.index()];
                finite_point(&side.epipole(&own.fundamental)).map_or(f64::INFINITY, |at| {
                    let away = at - frame.centre();
                    (2.0 * away.x.abs() / frame.width as f64).max(2.0 * away.y.abs() / frame.height as f64)
                })
            };
            of(Side::Left).max(of(Side::Right))
        })
        .collect();
    // Those still farther have arrows. The pictures stay large if there are no others.
    needed.retain(|needed| *needed <= FARTHEST);
    needed.sort_by(f64::total_cmp);
    let wanted = needed.get(((needed.len() as f64 * IN_VIEW) as usize).min(needed.len().saturating_sub(1)));
    (wanted.copied().unwrap_or(1.0) * 1.1).clamp(1.0, FARTHEST)
}

/// Draws the evenly spaced lines of a geometry.
pub fn lines_of(moment: &mut Moment, record: &Record, f: &FundamentalMatrix, ink: Ink, opacity: f64) {
    for (k, place) in record.fan.iter().enumerate() {
        moment.add_part(Replayed::Line(k), pencil_lines(fan::lines(f, *place), 1.6), ink, opacity);
    }
}

/// Returns what lights up in the pictures while a part of the record is pointed at in a chart. Matches and evenly
/// spaced lines depend on the moment, and have no chart.
pub fn parts_of(record: &Record, part: Replayed) -> Vec<Shape> {
    let lines = |lines: Option<&[AnchoredLine; 2]>| {
        lines.map(|lines| pencil_lines(both(lines), 2.2)).into_iter().collect()
    };
    match part {
        Replayed::Hypothesis(k) => {
            let dots = |own: &HypothesisNote| Shape::Dots { at: epipoles_of(own), drop: 1.5 };
            record.hypotheses.get(k).map(dots).into_iter().collect()
        }
        Replayed::Racer(k) => {
            let Some(own) = record.race.get(k) else { return Vec::new() };
            let of = |place: &Point| pencil_lines(fan::lines(&own.hypothesis.fundamental, *place), 1.6);
            record.fan.iter().map(of).collect()
        }
        Replayed::Swept(k) => {
            let swept = record.sweep.as_ref().and_then(|sweep| sweep.swept.get(k));
            lines(swept.map(|own| &own.lines))
        }
        Replayed::Candidate(k) => lines(record.line_pairs.get(k).map(|own| &own.lines)),
        Replayed::Match(_) | Replayed::Line(_) => Vec::new(),
    }
}
