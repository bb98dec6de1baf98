//! What each step draws. All times are seconds since the step began, at the usual speed.

use super::course::Place;
use super::moment::{Filled, Ink, Moment, Shape};
use super::record::{Record, RecordedPencils, Trip};
use super::strokes::{
    CANDIDATES, both, candidate, ease_in_out, ease_out, epipoles_of, farthest, noted_lines, pencil_lines,
    share,
};
use super::sweep::nearest_pairs;
use super::{kept, race, sequences};
use crate::app::model::document::Side;
use crate::app::model::focus::{Replayed, Target};
use crate::app::model::ids::MethodStep;
use crate::app::model::verdict::short_epipole_text;
use crate::estimate::{Candidate, HypothesisNote, ProposedBy, SearchPlan, lines_at};
use crate::geometry::{AnchoredLine, Line, fan, regions_between_lines};
use crate::presentation::proposer_in_words;

/// Time of one line or crossing, s.
pub const NUDGE: f64 = 0.02;

/// Number of earlier lines of a sweep that stay visible.
const TRAIL: usize = 45;
/// Number of crossings that are shown one by one.
const CROSSINGS: usize = 3;
/// Number of candidates among all lines that cross, and the least angle between them, radians.
const CROSSED: usize = 3;
const LEAST_TURN: f64 = 0.2;

/// Draws a moment. It depends on nothing but the record and the place.
pub fn draw(record: &Record, place: Place) -> Moment {
    let mut moment = Moment::empty(place.step);
    if !record.has(place.step) {
        return moment;
    }
    let draw_step = match place.step {
        MethodStep::Motion => sequences::motion,
        MethodStep::Barcodes => sequences::barcodes,
        MethodStep::Pencils => pencils,
        MethodStep::Candidates if record.is_by_clicks() => candidates,
        MethodStep::Candidates => sequences::candidates,
        MethodStep::Features if record.plan == SearchPlan::Unclicked => unmatched_features,
        MethodStep::Features => features,
        MethodStep::Matches => matches,
        MethodStep::Epipoles => epipoles,
        MethodStep::RoundTrip => round_trip,
        MethodStep::Validation => race::validation,
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
    let cell = |row: usize, column: usize| Some(Target::Cell { pair: own.number, row, column });
    let trail = |row: usize| {
        let (column, _) = own.partners[row]?;
        Some((cell(row, column), own.compared.lines(row, column)?))
    };
    let step = (rows / TRAIL).max(1);
    for earlier in (0..row).step_by(step) {
        if let Some((target, lines)) = trail(earlier) {
            moment.add_of(target, pencil_lines(both(&lines), 0.8), ink, 0.25);
        }
    }
    let winner = own.winner.map(|place| &own.compared.candidates[place]);
    let held = winner.and_then(|winner| Some((own.compared.cell(winner)?, winner.cost))).filter(|_| is_held);
    let partner = || {
        let (column, cost) = (*own.partners.get(row)?)?;
        Some(([row, column], cost))
    };
    moment.filled = Some(Filled { pencil: number, rows: if is_held { rows } else { row + 1 } });
    moment.slide = if is_held { ease_out(share(seconds, begin + sweep, 0.8 * hold)) } else { 1.0 };
    let Some(([row, column], cost)) = held.or_else(partner) else { return };
    let Some(lines) = own.compared.lines(row, column) else { return };
    moment.add_of(cell(row, column), pencil_lines(both(&lines), 2.6), ink, 1.0);
    let notes = [format!("line {} of {rows}", row + 1), format!("best partner, cost {cost:.2}")];
    noted_lines(moment, record, &lines, notes, ink);
    let degrees = |line: &AnchoredLine| format!("{:.0}°", line.angle().to_degrees().rem_euclid(180.0));
    moment.tell("through", own.name.clone());
    moment.tell("line on the left", degrees(&lines[0]));
    moment.tell("best partner on the right", degrees(&lines[1]));
    moment.tell("cost, 1 is a random line", format!("{cost:.2}"));
    // Lines through a match test the result.
    let tests = held.is_some() && own.pair.is_none();
    if let Some([off1, off2]) = record.off_result(&own.compared.click, &lines).filter(|_| tests) {
        let degrees = |angle: f64| format!("{:.1}°", angle.to_degrees());
        moment.tell("off the result's lines", format!("{} and {}", degrees(off1), degrees(off2)));
    }
    moment.lines = own.compared.angles(row, column).and_then(|angles| own.source(angles));
}

/// Returns the cell of a candidate.
fn cell_of(own: &RecordedPencils, candidate: &Candidate) -> Option<Target> {
    let [row, column] = own.compared.cell(candidate)?;
    Some(Target::Cell { pair: own.number, row, column })
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
        let drawn = own.compared.candidates.iter().take(CANDIDATES).enumerate();
        for (rank, found) in drawn.rev() {
            let (lines, target) = (lines_at(&own.compared.click, found.angles), cell_of(own, found));
            candidate(moment, target, (rank, &lines), (Ink::Pair(own.color()), violet));
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
    let shares = [share(seconds, 0.0, 0.3), share(seconds, 0.3, 0.5), share(seconds, 0.8, 0.4)];
    matched(moment, record, shares);
}

/// Draws the features of the matches that the next step joins.
fn unmatched_features(moment: &mut Moment, record: &Record, seconds: f64) {
    matched(moment, record, [share(seconds, 0.0, 1.0), 0.0, 0.0]);
}

fn matches(moment: &mut Moment, record: &Record, seconds: f64) {
    matched(moment, record, [1.0, share(seconds, 0.0, 1.4), share(seconds, 1.6, 0.4)]);
}

/// Draws matches by the shares of their dots and strokes that have appeared, in the order of use, and by how far the
/// unused ones have faded.
fn matched(moment: &mut Moment, record: &Record, [dots, strokes, fade]: [f64; 3]) {
    let count = record.matches.len() as f64;
    let (dots, strokes) = ((dots * count).ceil() as usize, (strokes * count) as usize);
    // Before there is a result, none is known to be unused.
    let fade = if record.has_result() { fade } else { 0.0 };
    for (number, own) in record.matches.iter().take(dots).enumerate().rev() {
        let opacity = if own.agrees { 0.9 } else { 0.55 - 0.45 * fade };
        let shape = Shape::Stroke { pair: own.found.pair, has_stroke: number < strokes };
        moment.add_part(Replayed::Match(number), shape, Ink::Unchecked, opacity);
    }
    let [distinctive, agree] = record.matches_that_count();
    moment.tell("tentative", record.tentative.to_string());
    moment.tell("distinctive", distinctive.to_string());
    if record.has_result() {
        moment.tell("on lines of the result", agree.to_string());
    }
}

/// Candidates that cross.
struct Crossing {
    /// Places in the lists of candidates, if they are one of each pencil.
    cell: Option<[usize; 2]>,
    lines: Vec<(Ink, [AnchoredLine; 2], Option<Target>)>,
}

/// Returns the candidates that cross at the epipoles of a hypothesis, if line pairs proposed it. Among all lines, these
/// are the nearest ones.
fn crossing(record: &Record, own: &HypothesisNote) -> Option<Crossing> {
    match own.origin.source {
        ProposedBy::LinePairs { ranks } => {
            let lines = |k: usize| {
                let pencils = record.pencils.get(k)?;
                let candidate = pencils.compared.candidates.get(ranks[k].checked_sub(1)?)?;
                let lines = lines_at(&pencils.compared.click, candidate.angles);
                Some((Ink::Pair(pencils.color()), lines, cell_of(pencils, candidate)))
            };
            Some(Crossing { cell: Some(ranks.map(|rank| rank - 1)), lines: vec![lines(0)?, lines(1)?] })
        }
        ProposedBy::AllLines => {
            let mut lines: Vec<(Ink, [AnchoredLine; 2], Option<Target>)> = Vec::new();
            for place in nearest_pairs(&own.fundamental, &record.line_pairs) {
                let pair = record.line_pairs[place].lines;
                let is_apart =
                    |other: &[AnchoredLine; 2]| other[0].line().angle_to(&pair[0].line()) > LEAST_TURN;
                if lines.len() < CROSSED && lines.iter().all(|(_, other, _)| is_apart(other)) {
                    lines.push((Ink::Unchecked, pair, Some(Target::Replayed(Replayed::Candidate(place)))));
                }
            }
            (!lines.is_empty()).then_some(Crossing { cell: None, lines })
        }
        _ => None,
    }
}

/// Draws candidates that cross.
fn cross(moment: &mut Moment, crossing: &Crossing, opacity: f64) {
    for (ink, lines, target) in &crossing.lines {
        moment.add_of(*target, pencil_lines(both(lines), 2.2), *ink, opacity);
    }
    moment.crossed = crossing.cell;
}

fn epipoles(moment: &mut Moment, record: &Record, seconds: f64) {
    let count = record.hypotheses.len();
    moment.zoom = 1.0 + (farthest(record) - 1.0) * ease_in_out(share(seconds, 0.0, 0.4));
    let winner = record.winner.unwrap_or(0);
    let is_of_lines = |own: &HypothesisNote| match own.origin.source {
        ProposedBy::LinePairs { .. } => crossing(record, own).is_some(),
        ProposedBy::AllLines => !record.line_pairs.is_empty(),
        _ => false,
    };
    let crossed: Vec<usize> = (0..count).filter(|k| is_of_lines(&record.hypotheses[*k])).collect();
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
    let epipoles = |k: usize| epipoles_of(&record.hypotheses[k]);
    for k in (0..dropped).rev().filter(|k| !shown.contains(k)) {
        let best = 1.0 - k as f64 / count as f64;
        let dots = Shape::Dots { at: epipoles(k), drop: 1.0 };
        moment.add_part(Replayed::Hypothesis(k), dots, Ink::Unchecked, 0.3 + 0.5 * best);
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
        if let Some(crossing) = crossing(record, &record.hypotheses[*k]).filter(|_| is_open) {
            cross(moment, &crossing, crosses);
            now = Some(*k);
        }
        if falls > 0.0 {
            let drop = 2.4 - 1.4 * ease_out(falls);
            let dots = Shape::Dots { at: epipoles(*k), drop: drop as f32 };
            moment.add_part(Replayed::Hypothesis(*k), dots, Ink::Unchecked, 1.0);
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
        if let Some(crossing) = crossing(record, &record.hypotheses[winner]) {
            cross(moment, &crossing, lit);
        }
        let drop = 1.0 + 0.8 * ease_out(lit);
        let dots = Shape::Dots { at: epipoles(winner), drop: drop as f32 };
        moment.add_part(Replayed::Hypothesis(winner), dots, Ink::Lit, lit);
        now = Some(winner);
    }
    if let Some(k) = now {
        let own = &record.hypotheses[k];
        moment.tell("from", proposer_in_words(own.origin.source));
        for (side, name) in Side::BOTH.into_iter().zip(["epipole on the left", "epipole on the right"]) {
            moment.tell(name, short_epipole_text(&side.epipole(&own.fundamental)));
        }
    }
    moment.tell("hypotheses examined", record.examined.max(count).to_string());
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
    let Trip { lines, gap, name, kept } = trip;
    moment.kept = *kept;
    let area = at_time(3);
    for region in regions_between_lines(&lines.line1, &lines.back1, record.frames[0]) {
        moment.add(Shape::Area(region), Ink::RoundTrip, 0.42 * area);
    }
    let line = |line1: Option<Line>, line2: Option<Line>, dashed: bool| Shape::Lines {
        lines: [line1, line2],
        width: 2.4,
        dashed,
    };
    let drawn = [
        line(Some(lines.line1), None, false),
        line(None, Some(lines.line2), false),
        line(Some(lines.back1), None, true),
    ];
    for (k, shape) in drawn.into_iter().enumerate() {
        moment.add_part(Replayed::Line(0), shape, Ink::RoundTrip, at_time(k));
    }
    let notes = [
        (Side::Left, lines.line1, "l", 0),
        (Side::Right, lines.line2, "H l", 1),
        (Side::Left, lines.back1, "G H l", 2),
    ];
    for (side, line, text, k) in notes {
        if let Some(segment) = record.frames[side.index()].clip(&line) {
            // The two names on the left stand apart even if both lines are one.
            let at = segment.start + (segment.end - segment.start) * [0.4, 0.5, 0.6][k];
            moment.add(Shape::Note { side, at, text: text.to_owned() }, Ink::RoundTrip, at_time(k));
        }
    }
    moment.tell("hypothesis", name.clone());
    if area > 0.0 {
        moment.tell("round trip, from l to G H l", format!("{gap:.1} px"));
        moment.gap = Some(*gap);
    }
    moment.tell("hypotheses with a round trip", record.gaps.len().to_string());
}

fn refinement(moment: &mut Moment, record: &Record, seconds: f64) {
    let fits = record.swing.len();
    let along = ease_out(share(seconds, 0.0, 0.7)) * (fits - 1) as f64;
    let fit = (along.floor() as usize).min(fits - 2);
    let [from, to] = [&record.swing[fit], &record.swing[fit + 1]];
    let recolour = share(seconds, 0.7, 0.3);
    // The lines end as those of the result.
    moment.kept =
        record.led_from.filter(|_| recolour <= 0.0).and_then(|from| kept::from_source(record, from));
    let shown = (along / (fits - 1) as f64 * record.matched.len() as f64) as usize;
    for pair in record.matched.iter().take(shown) {
        let shape = Shape::Stroke { pair: *pair, has_stroke: false };
        moment.add(shape, Ink::Unchecked, 0.7);
    }
    for (k, place) in record.fan.iter().enumerate() {
        let part = Replayed::Line(k);
        let (from, to) = (fan::lines(from, *place), fan::lines(to, *place));
        let on_way = |k: usize| fan::between(from[k].as_ref()?, to[k].as_ref()?, along - fit as f64);
        let lines = [on_way(0), on_way(1)];
        moment.add_part(part, pencil_lines(lines, 1.8), Ink::Unchecked, 0.9 * (1.0 - recolour));
        moment.add_part(part, pencil_lines(lines, 1.8), Ink::Verdict, recolour);
    }
    let number = along.round() as usize;
    moment.tell("fit", format!("{} of {fits}", number + 1));
    if let Some(barcodes) = &record.barcodes {
        let (own, by_chance) = (barcodes.correlation, barcodes.by_chance);
        moment.tell("correlation", format!("{own:.2}, by chance {by_chance:.2}"));
        moment.tell("independent lines", barcodes.whole_lines().to_string());
    } else if record.plan != SearchPlan::Barcodes {
        moment.tell("matches", record.fitted[number.min(record.fitted.len() - 1)].to_string());
    }
}
