//! What each step draws. All times are seconds since the step began, at the usual speed.

use super::course::Place;
use super::moment::{Filled, Ink, Moment, Racer, Shape};
use super::record::{Record, RecordedPencils, Trip, short_origin};
use crate::app::model::document::Side;
use crate::app::model::ids::MethodStep;
use crate::app::model::verdict::short_epipole_text;
use crate::estimate::{HypothesisNote, ProposedBy, lines_at};
use crate::geometry::{
    AnchoredLine, FundamentalMatrix, Line, Point, fan, finite_point, regions_between_lines,
};

/// Time of one line or crossing, s.
pub const NUDGE: f64 = 0.02;

/// Number of earlier lines of a sweep that stay visible.
const TRAIL: usize = 45;
/// Number of candidates of a pencil that are drawn.
const DRAWN: usize = 40;
/// Number of crossings that are shown one by one.
const CROSSINGS: usize = 3;
/// Largest zoom.
const FARTHEST: f64 = 6.0;
/// Share of the epipoles that the zoom brings into view.
const IN_VIEW: f64 = 0.9;

/// Returns the share of a part of a step that has passed, 0 to 1.
fn share(seconds: f64, begin: f64, length: f64) -> f64 {
    ((seconds - begin) / length).clamp(0.0, 1.0)
}

fn ease_out(share: f64) -> f64 {
    1.0 - (1.0 - share).powi(3)
}

fn ease_in_out(share: f64) -> f64 {
    if share < 0.5 { 4.0 * share.powi(3) } else { 1.0 - (2.0 - 2.0 * share).powi(3) / 2.0 }
}

fn both(lines: &[AnchoredLine; 2]) -> [Option<Line>; 2] {
    lines.each_ref().map(|line| Some(line.line()))
}

/// Returns a place on a line for its note, clear of the anchor: on its longer part.
fn beside(record: &Record, side: Side, line: &AnchoredLine) -> Option<Point> {
    let segment = record.frames[side.index()].clip(&line.line())?;
    let away = |end: &Point| (end - line.anchor).norm();
    let end = if away(&segment.start) > away(&segment.end) { segment.start } else { segment.end };
    Some(line.anchor + (end - line.anchor) * 0.6)
}

fn pencil_lines(lines: [Option<Line>; 2], width: f32) -> Shape {
    Shape::Lines { lines, width, dashed: false }
}

/// Draws a moment. It depends on nothing but the record and the place.
pub fn draw(record: &Record, place: Place) -> Moment {
    let mut moment = Moment::empty(place.step);
    if !record.has(place.step) {
        return moment;
    }
    let draw_step = match place.step {
        MethodStep::Pencils => pencils,
        MethodStep::Candidates => candidates,
        MethodStep::Features => features,
        MethodStep::Epipoles => epipoles,
        MethodStep::RoundTrip => round_trip,
        MethodStep::Validation => validation,
        MethodStep::Refinement => refinement,
    };
    draw_step(&mut moment, record, place.usual_seconds(record.plan));
    moment
}

fn pencils(moment: &mut Moment, record: &Record, seconds: f64) {
    // The sweep through p takes longer than the others, for it explains them.
    let [sweep, hold] = [1.1, 0.3];
    let others = (record.pencils.len().max(2) - 1) as f64;
    let (number, sweep, hold, begin) = if seconds <= sweep + hold {
        (0, sweep, hold, 0.0)
    } else {
        let each = 0.8 / others;
        let number = (1.0 + ((seconds - sweep - hold) / each).floor()).min(others);
        (number as usize, 0.75 * each, 0.25 * each, sweep + hold + (number - 1.0) * each)
    };
    let Some(own) = record.pencils.get(number).or(record.pencils.last()) else { return };
    let rows = own.compared.angles1.len();
    let swept = share(seconds, begin, sweep);
    let row = ((swept * rows as f64) as usize).min(rows.saturating_sub(1));
    let is_held = swept >= 1.0;
    let ink = Ink::Pair(own.color());
    let trail = |row: usize| own.partners[row].and_then(|(column, _)| own.compared.lines(row, column));
    let step = (rows / TRAIL).max(1);
    for earlier in (0..row).step_by(step) {
        if let Some(lines) = trail(earlier) {
            moment.add(pencil_lines(both(&lines), 0.8), ink, 0.25);
        }
    }
    let winner = own.winner.map(|place| &own.compared.candidates[place]);
    let held = winner.and_then(|winner| Some((own.compared.cell(winner)?, winner.cost))).filter(|_| is_held);
    let partner = || {
        let (column, cost) = (*own.partners.get(row)?)?;
        Some(([row, column], cost))
    };
    moment.filled = Some(Filled { pencil: number, rows: if is_held { rows } else { row + 1 } });
    moment.slide = if is_held { ease_out(share(seconds, begin + sweep, 0.8 * hold)) } else { 0.0 };
    let Some(([row, column], cost)) = held.or_else(partner) else { return };
    let Some(lines) = own.compared.lines(row, column) else { return };
    moment.add(pencil_lines(both(&lines), 2.6), ink, 1.0);
    let notes = [format!("line {} of {rows}", row + 1), format!("best partner, cost {cost:.2}")];
    for ((side, line), text) in Side::BOTH.into_iter().zip(&lines).zip(notes) {
        if let Some(at) = beside(record, side, line) {
            moment.add(Shape::Note { side, at, text }, ink, 1.0);
        }
    }
    let degrees = |line: &AnchoredLine| format!("{:.0}°", line.angle().to_degrees().rem_euclid(180.0));
    moment.tell("through", own.name.clone());
    moment.tell("line on the left", degrees(&lines[0]));
    moment.tell("best partner on the right", degrees(&lines[1]));
    moment.tell("cost, 1 is a random line", format!("{cost:.2}"));
    moment.lines = own.compared.angles(row, column).and_then(|angles| own.source(angles));
}

fn candidates(moment: &mut Moment, record: &Record, seconds: f64) {
    let fade = 1.0 - share(seconds, 0.0, 0.5);
    let violet = share(seconds, 0.5, 0.3);
    let mut lit = None;
    for own in &record.pencils {
        moment.tell(format!("candidates of {}", own.name), own.compared.candidates.len().to_string());
        let step = (own.partners.len() / TRAIL).max(1);
        for (row, partner) in own.partners.iter().enumerate().step_by(step) {
            if let Some(lines) = partner.and_then(|(column, _)| own.compared.lines(row, column)) {
                moment.add(pencil_lines(both(&lines), 0.8), Ink::Pair(own.color()), 0.25 * fade);
            }
        }
        let drawn = own.compared.candidates.iter().take(DRAWN).enumerate();
        for (rank, candidate) in drawn.rev() {
            let lines = lines_at(&own.compared.click, candidate.angles);
            let best = 1.0 - rank as f64 / DRAWN as f64;
            let (width, opacity) = (1.0 + best as f32, 0.25 + 0.6 * best);
            moment.add(pencil_lines(both(&lines), width), Ink::Pair(own.color()), opacity * (1.0 - violet));
            moment.add(pencil_lines(both(&lines), width), Ink::Unchecked, opacity * violet);
        }
        let turn = share(seconds, 0.8, 0.4);
        if turn > 0.0 && turn < 1.0 {
            let rank = ((turn * 10.0) as usize).min(own.compared.candidates.len().saturating_sub(1));
            if let Some(candidate) = own.compared.candidates.get(rank) {
                moment.add(
                    pencil_lines(both(&lines_at(&own.compared.click, candidate.angles)), 2.6),
                    Ink::Lit,
                    1.0,
                );
                lit.get_or_insert((own, rank));
            }
        }
    }
    let shown = lit.or_else(|| record.pencils.first().and_then(|own| Some((own, own.winner?))));
    if let Some((own, rank)) = shown {
        let candidate = &own.compared.candidates[rank];
        moment.tell("shown", format!("{} {}, cost {:.2}", own.name, rank + 1, candidate.cost));
        moment.lines = own.source(candidate.angles);
    }
}

fn features(moment: &mut Moment, record: &Record, seconds: f64) {
    let count = record.matches.len() as f64;
    let dots = (share(seconds, 0.0, 0.3) * count).ceil() as usize;
    let strokes = (share(seconds, 0.3, 0.5) * count) as usize;
    let fade = share(seconds, 0.8, 0.4);
    for (number, own) in record.matches.iter().take(dots).enumerate().rev() {
        let opacity = if own.agrees { 0.9 } else { 0.55 - 0.45 * fade };
        let shape = Shape::Stroke { pair: own.found.pair, has_stroke: number < strokes };
        moment.add(shape, Ink::Unchecked, opacity);
    }
    let [distinctive, agree] = record.matches_that_count();
    moment.tell("tentative", record.tentative.to_string());
    moment.tell("distinctive", distinctive.to_string());
    if record.has_result() {
        moment.tell("on lines of the result", agree.to_string());
    }
}

/// Returns the zoom that brings most epipoles of both pictures into view, of those that any zoom does.
fn farthest(record: &Record) -> f64 {
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

/// Two candidates that cross, one of each pencil.
struct Crossing<'a> {
    /// Places in the lists of candidates.
    candidates: [usize; 2],
    lines: [(&'a RecordedPencils, [AnchoredLine; 2]); 2],
}

/// Returns the candidates that cross at the epipoles of a hypothesis, if line pairs proposed it.
fn crossing<'a>(record: &'a Record, own: &HypothesisNote) -> Option<Crossing<'a>> {
    let ProposedBy::LinePairs { ranks } = own.origin.source else { return None };
    let lines = |k: usize| {
        let pencils = record.pencils.get(k)?;
        let candidate = pencils.compared.candidates.get(ranks[k].checked_sub(1)?)?;
        Some((pencils, lines_at(&pencils.compared.click, candidate.angles)))
    };
    Some(Crossing { candidates: ranks.map(|rank| rank - 1), lines: [lines(0)?, lines(1)?] })
}

fn epipoles(moment: &mut Moment, record: &Record, seconds: f64) {
    let count = record.hypotheses.len();
    moment.zoom = 1.0 + (farthest(record) - 1.0) * ease_in_out(share(seconds, 0.0, 0.4));
    let winner = record.winner.unwrap_or(0);
    let crossed: Vec<usize> =
        (0..count).filter(|k| crossing(record, &record.hypotheses[*k]).is_some()).collect();
    // The last crossing is the one that led to the result, if it was one.
    let mut shown: Vec<usize> = (1..=CROSSINGS)
        .map(|k| k * crossed.len() / (CROSSINGS + 1))
        .filter_map(|k| crossed.get(k).copied())
        .collect();
    if let Some(last) = shown.last_mut().filter(|_| crossed.contains(&winner)) {
        *last = winner;
    }
    let shown_all = share(seconds, 1.0, 0.5);
    let dropped = (shown_all * count as f64) as usize;
    let epipoles = |k: usize| Side::BOTH.map(|side| side.epipole(&record.hypotheses[k].fundamental));
    for k in (0..dropped).rev().filter(|k| !shown.contains(k)) {
        let best = 1.0 - k as f64 / count as f64;
        moment.add(Shape::Dots { at: epipoles(k), drop: 1.0 }, Ink::Unchecked, 0.3 + 0.5 * best);
    }
    let mut now = None;
    for (turn, k) in shown.iter().enumerate() {
        let begin = 0.4 + 0.2 * turn as f64;
        let crosses = share(seconds, begin, 0.12);
        if crosses <= 0.0 {
            continue;
        }
        let is_last = turn + 1 == shown.len();
        let is_open = seconds < begin + 0.2 || is_last && seconds < 1.0;
        let falls = share(seconds, begin + 0.12, 0.08);
        if let Some(Crossing { candidates, lines }) =
            crossing(record, &record.hypotheses[*k]).filter(|_| is_open)
        {
            for (pencils, lines) in lines {
                moment.add(pencil_lines(both(&lines), 2.2), Ink::Pair(pencils.color()), crosses);
            }
            (now, moment.crossed) = (Some(*k), Some(candidates));
        }
        if falls > 0.0 {
            let drop = 2.4 - 1.4 * ease_out(falls);
            moment.add(Shape::Dots { at: epipoles(*k), drop: drop as f32 }, Ink::Unchecked, 1.0);
            let ripple = share(seconds, begin + 0.2, 0.24);
            if ripple > 0.0 && ripple < 1.0 {
                moment.add(
                    Shape::Ripple { at: epipoles(*k), share: ripple as f32 },
                    Ink::Unchecked,
                    1.0 - ripple,
                );
            }
        }
    }
    let lit = share(seconds, 1.5, 0.3);
    if lit > 0.0 && count > 0 {
        if let Some(Crossing { candidates, lines }) = crossing(record, &record.hypotheses[winner]) {
            for (pencils, lines) in lines {
                moment.add(pencil_lines(both(&lines), 2.2), Ink::Pair(pencils.color()), lit);
            }
            moment.crossed = Some(candidates);
        }
        let drop = 1.0 + 0.8 * ease_out(lit);
        moment.add(Shape::Dots { at: epipoles(winner), drop: drop as f32 }, Ink::Lit, lit);
        now = Some(winner);
    }
    if let Some(k) = now {
        let own = &record.hypotheses[k];
        moment.tell("from", short_origin(&own.origin));
        for (side, name) in Side::BOTH.into_iter().zip(["epipole on the left", "epipole on the right"]) {
            moment.tell(name, short_epipole_text(&side.epipole(&own.fundamental)));
        }
    }
    moment.tell("hypotheses shown", format!("{dropped} of {}", record.examined.max(count)));
}

fn round_trip(moment: &mut Moment, record: &Record, seconds: f64) {
    let back = share(seconds, 0.0, 0.2);
    let [first, second] = [(0.2, 0.2), (1.1, 0.125)];
    let (trip, (begin, part)) = match &record.trips[..] {
        [_, own] if seconds >= 1.1 => (own, second),
        [trip, ..] => (trip, first),
        [] => return,
    };
    moment.zoom = 1.0 + (farthest(record) - 1.0) * (1.0 - ease_in_out(back));
    let at_time = |k: usize| ease_out(share(seconds, begin + part * k as f64, part));
    let Trip { lines, gap, name } = trip;
    let area = at_time(3);
    for region in regions_between_lines(&lines.line1, &lines.back1, record.frames[0]) {
        moment.add(Shape::Area(region), Ink::RoundTrip, 0.42 * area);
    }
    let line = |line1: Option<Line>, line2: Option<Line>, dashed: bool| Shape::Lines {
        lines: [line1, line2],
        width: 2.4,
        dashed,
    };
    moment.add(line(Some(lines.line1), None, false), Ink::RoundTrip, at_time(0));
    moment.add(line(None, Some(lines.line2), false), Ink::RoundTrip, at_time(1));
    moment.add(line(Some(lines.back1), None, true), Ink::RoundTrip, at_time(2));
    let notes = [(Side::Left, lines.line1, "l", 0), (Side::Right, lines.line2, "H l", 1)];
    for (side, line, text, k) in notes {
        if let Some(segment) = record.frames[side.index()].clip(&line) {
            let at = nalgebra::center(&segment.start, &segment.end);
            moment.add(Shape::Note { side, at, text: text.to_owned() }, Ink::RoundTrip, at_time(k));
        }
    }
    moment.tell("hypothesis", name.clone());
    if area > 0.0 {
        moment.tell("gap", format!("{gap:.1} px"));
        moment.gap = Some(*gap);
    }
    moment.tell("hypotheses with a round trip", record.gaps.len().to_string());
}

/// Draws the lines of a geometry.
fn lines_of(moment: &mut Moment, record: &Record, f: &FundamentalMatrix, ink: Ink, opacity: f64) {
    for place in &record.fan {
        moment.add(pencil_lines(fan::lines(f, *place), 1.6), ink, opacity);
    }
}

fn validation(moment: &mut Moment, record: &Record, seconds: f64) {
    if record.trips.is_empty() {
        moment.zoom = 1.0 + (farthest(record) - 1.0) * (1.0 - ease_in_out(share(seconds, 0.0, 0.2)));
    }
    let racers: Vec<_> = record.race.iter().filter(|own| !own.course.is_empty()).collect();
    let Some(checkpoints) = racers.first().map(|own| own.course.len()) else { return };
    let along = share(seconds, 0.0, 0.8) * checkpoints as f64;
    // Before the first checkpoint, no support has been counted.
    let support = |own: &[f64], along: f64| {
        let (last, part) = (along.floor() as usize, along.fract());
        let at = |k: usize| k.checked_sub(1).map_or(0.0, |k| own[k.min(own.len() - 1)]);
        at(last) + (at(last + 1) - at(last)) * part
    };
    let ranks = |along: f64| {
        let mut order: Vec<usize> = (0..racers.len()).collect();
        let own = |k: &usize| support(&racers[*k].course, along);
        order.sort_by(|a, b| own(b).total_cmp(&own(a)).then(a.cmp(b)));
        let mut ranks = vec![0; order.len()];
        for (rank, racer) in order.into_iter().enumerate() {
            ranks[racer] = rank;
        }
        ranks
    };
    // Rows change places within 0.12 s after a checkpoint.
    let (before, now) = (ranks((along.floor() - 1.0).max(0.0)), ranks(along.floor()));
    let swap = ease_in_out(share(along.fract() * 0.8 / checkpoints as f64, 0.0, 0.04));
    let is_over = along >= checkpoints as f64;
    let row = |k: usize| {
        let swap = if is_over { 1.0 } else { swap };
        before[k] as f64 + (now[k] as f64 - before[k] as f64) * swap
    };
    moment.race = (0..racers.len())
        .map(|k| Racer {
            name: short_origin(&racers[k].hypothesis.origin),
            support: support(&racers[k].course, along),
            at_end: racers[k].course.last().copied().unwrap_or(0.0),
            row: row(k),
        })
        .collect();
    let leader = (0..racers.len()).min_by_key(|k| now[*k]).unwrap_or(0);
    let turned_up = 0.25 + 0.65 * along / checkpoints as f64;
    lines_of(moment, record, &racers[leader].hypothesis.fundamental, Ink::Unchecked, turned_up);
    moment.tell("leader", moment.race[leader].name.clone());
    moment.tell("support", format!("{:.0}", moment.race[leader].support));
    let second = moment.race.iter().enumerate().filter(|(k, _)| *k != leader).map(|(_, own)| own.support);
    if let Some(second) = second.reduce(f64::max) {
        moment.tell("next best", format!("{second:.0}"));
    }
    moment.tell("counted", format!("{:.0} % of the evidence", 100.0 * along / checkpoints as f64));
}

fn refinement(moment: &mut Moment, record: &Record, seconds: f64) {
    let fits = record.swing.len();
    let along = ease_out(share(seconds, 0.0, 0.7)) * (fits - 1) as f64;
    let fit = (along.floor() as usize).min(fits - 2);
    let [from, to] = [&record.swing[fit], &record.swing[fit + 1]];
    let recolour = share(seconds, 0.7, 0.3);
    let shown = (along / (fits - 1) as f64 * record.matched.len() as f64) as usize;
    for pair in record.matched.iter().take(shown) {
        let shape = Shape::Stroke { pair: *pair, has_stroke: false };
        moment.add(shape, Ink::Unchecked, 0.7);
    }
    for place in &record.fan {
        let (from, to) = (fan::lines(from, *place), fan::lines(to, *place));
        let on_way = |k: usize| fan::between(from[k].as_ref()?, to[k].as_ref()?, along - fit as f64);
        let lines = [on_way(0), on_way(1)];
        moment.add(pencil_lines(lines, 1.8), Ink::Unchecked, 0.9 * (1.0 - recolour));
        moment.add(pencil_lines(lines, 1.8), Ink::Verdict, recolour);
    }
    let number = along.round() as usize;
    moment.tell("fit", format!("{} of {fits}", number + 1));
    moment.tell("matches", record.fitted[number.min(record.fitted.len() - 1)].to_string());
}
