//! What the steps draw that only sequences have. All times are seconds since the step began, at the usual speed.

use super::moment::{Grown, Ink, Moment};
use super::record::Record;
use super::strokes::{CANDIDATES, both, candidate, noted_lines, pencil_lines, share};
use super::sweep::SweptLine;
use crate::app::model::focus::{Replayed, Target};

/// Time in which all frames run, s.
const RUN: f64 = 1.5;
/// Times in which the first barcode grows, and in which the other lines sweep, s.
const GROW: f64 = 0.7;
const SWEEP: f64 = 1.1;
/// Number of candidates that light up in turn.
const BEST: usize = 10;
/// Colour of lines that belong to no click.
const SWEPT: Ink = Ink::Pair(usize::MAX);

/// Returns the number of a frame, from 0, of `count`.
fn frame_at(share: f64, count: usize) -> usize {
    ((share * count as f64) as usize).min(count.saturating_sub(1))
}

/// Runs the frames, while silhouettes pile up.
pub fn motion(moment: &mut Moment, record: &Record, seconds: f64) {
    let Some(synchronised) = &record.recordings else { return };
    let (first, count) = synchronised.in_common();
    let frame = frame_at(share(seconds, 0.0, RUN), count);
    let frames = first.map(|first| first + frame);
    let piled = [0, 1].map(|k| synchronised.recordings[k].pile.until(frames[k]));
    (moment.frames, moment.piled) = (Some(frames), Some(piled));
    moment.tell("frame", format!("{} of {count}", frame + 1));
    moment.tell("silhouettes drawn", piled[0].to_string());
    let offset = synchronised.offset;
    moment.tell("time offset", format!("{offset:+} frames"));
}

/// Grows the barcodes of one line pair, then sweeps the left line across its picture.
pub fn barcodes(moment: &mut Moment, record: &Record, seconds: f64) {
    let (Some(sweep), Some(synchronised)) = (&record.sweep, &record.recordings) else { return };
    let (first, count) = synchronised.in_common();
    let through = sweep.pencil.and_then(|number| record.pencils.get(number));
    let ink = through.map_or(SWEPT, |own| Ink::Pair(own.color()));
    let lines = sweep.swept.len();
    let along = share(seconds, GROW, SWEEP);
    let grows = seconds < GROW;
    let line = (along * lines as f64) as usize;
    let line = Some(line).filter(|line| !grows && *line < lines);
    let swept = if grows { 0 } else { line.map_or(lines, |line| line + 1) };
    for (k, own) in sweep.swept.iter().take(swept).enumerate() {
        moment.add_part(Replayed::Swept(k), pencil_lines(both(&own.lines), 0.8), ink, 0.25);
    }
    let SweptLine { lines: shown, compared } = line.map_or(&sweep.held, |line| &sweep.swept[line]);
    let frame = frame_at(share(seconds, 0.0, GROW), count);
    if grows {
        moment.frames = Some(first.map(|first| first + frame));
    }
    let frames = if grows { frame + 1 } else { count };
    moment.grown = Some(Grown { line, frames, swept });
    // While the frames run, a line is thicker as long as something crosses it.
    for (side, barcode) in compared.barcodes.iter().enumerate() {
        let mut own = [None, None];
        own[side] = Some(shown[side].line());
        let width = if grows && barcode.is_set(frame) { 4.5 } else { 2.6 };
        let shape = pencil_lines(own, width);
        match line {
            Some(line) => moment.add_part(Replayed::Swept(line), shape, ink, 1.0),
            None => moment.add(shape, ink, 1.0),
        }
    }
    let number = line.map_or_else(|| "line".to_owned(), |line| format!("line {} of {lines}", line + 1));
    noted_lines(moment, record, shown, [number, "best partner".to_owned()], ink);
    let name = through.map_or_else(|| "all directions".to_owned(), |own| format!("through {}", own.name));
    moment.tell("lines", name);
    let crossed = compared
        .barcodes
        .each_ref()
        .map(|barcode| (0..frames).filter(|frame| barcode.is_set(*frame)).count());
    moment.tell("crossed, left and right", format!("{} and {} of {frames} frames", crossed[0], crossed[1]));
    if !grows {
        let correlation = compared.correlation();
        let text = correlation.map_or_else(|| "too little motion".to_owned(), |value| format!("{value:.2}"));
        moment.tell("correlation", text);
    }
}

/// Fades all lines but the candidates among them, and lights the best ones in turn.
pub fn candidates(moment: &mut Moment, record: &Record, seconds: f64) {
    let fade = 1.0 - share(seconds, 0.0, 0.5);
    let violet = share(seconds, 0.5, 0.3);
    for (k, own) in record.sweep.iter().flat_map(|sweep| &sweep.swept).enumerate() {
        moment.add_part(Replayed::Swept(k), pencil_lines(both(&own.lines), 0.8), SWEPT, 0.25 * fade);
    }
    for (rank, own) in record.line_pairs.iter().take(CANDIDATES).enumerate().rev() {
        let target = Some(Target::Replayed(Replayed::Candidate(rank)));
        candidate(moment, target, (rank, &own.lines), (SWEPT, violet));
    }
    let turn = share(seconds, 0.8, 0.4);
    let lit = (turn > 0.0 && turn < 1.0).then_some((turn * BEST as f64) as usize);
    let [left, right] = record.lines_compared;
    moment.tell("lines compared", format!("{left} and {right}"));
    moment.tell("best candidates kept", record.line_pairs.len().to_string());
    if let Some((rank, own)) = lit.and_then(|rank| Some((rank, record.line_pairs.get(rank)?))) {
        moment.add_part(Replayed::Candidate(rank), pencil_lines(both(&own.lines), 2.6), Ink::Lit, 1.0);
        moment.tell("shown", format!("candidate {}, cost {:.2}", rank + 1, own.cost));
    }
}
