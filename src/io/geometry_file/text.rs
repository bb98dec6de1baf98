//! Plain text: `#` comments, and names alone on a line above their rows of numbers.
//!
//! ```text
//! image1 768 576 house.000.pgm
//! F
//! 6.2e-7 -1.7e-5 -3.1e-3
//! …
//! pairs
//! 157.0 336.0 100.9 343.7
//! ```
//!
//! Numbers without a name are read too: nine are an `F` (see [`printed`](super::printed)), rows of four are point
//! pairs (see [`parse_point_pairs`]). Where a geometry is expected, six rows of four are two cameras.

use std::fmt::Write;

use super::coordinates::{WrittenGeometry, numbers, one_line};
use super::fields::{Fields, NumberTable};
use super::labels::runs;
use super::{BareNumbers, ImageNote, Problem, views};
use crate::geometry::{Frame, PointPair};
use crate::io::number::{cells, finite_numbers, rows};
use crate::io::point_pairs::parse_point_pairs;
use crate::io::values::Quantity;

pub(super) fn write(written: &WrittenGeometry) -> String {
    let mut text = String::new();
    for line in written.preamble() {
        let _ = writeln!(text, "# {line}");
    }
    if let Some(trust) = written.trust {
        let _ = writeln!(text, "# Geometry: {}.\n# Verdict: {}.", one_line(&trust.geometry), trust.verdict);
        for reason in &trust.reasons {
            let _ = writeln!(text, "#   {}", one_line(reason));
        }
    }
    for (k, image) in written.images.iter().flat_map(|i| i.iter()).enumerate() {
        let frame = image.frame;
        let _ = writeln!(text, "image{} {} {} {}", k + 1, frame.width, frame.height, one_line(&image.name));
    }
    text += &views::as_text(written.pictures);
    for matrix in &written.matrices {
        let _ = writeln!(text, "# {}\n{}", matrix.quantity.meaning(), matrix.quantity.symbol());
        for row in matrix.values.chunks(matrix.columns) {
            let _ = writeln!(text, "{}", numbers(row, " "));
        }
    }
    if !written.pairs.is_empty() {
        let _ = writeln!(text, "# {}\n{}", Quantity::Pairs.meaning(), Quantity::Pairs.symbol());
    }
    let mut pairs = written.pairs.iter();
    let runs: Vec<_> = if written.labels.is_empty() {
        vec![(written.pairs.len(), String::new())]
    } else {
        runs(written.labels).collect()
    };
    for (count, words) in runs {
        if !words.is_empty() {
            let _ = writeln!(text, "# {}", one_line(&words));
        }
        for pair in pairs.by_ref().take(count) {
            let _ = writeln!(text, "{}", numbers(&pair.numbers(), " "));
        }
    }
    text
}

/// Returns whether a text begins with the name of a section.
pub(super) fn has_sections(text: &str) -> bool {
    let first = rows(text).next().map(|(_, row)| row);
    first.is_some_and(|row| {
        Quantity::named(row).is_some() || image_number(row).is_some() || views::is_named(row)
    })
}

pub(super) fn read(text: &str, wanted: BareNumbers) -> Result<Fields, Problem> {
    if !has_sections(text) {
        return bare(text, wanted);
    }
    let mut fields = Fields::default();
    let mut current: Option<Section> = None;
    let close = |section: Option<Section>, fields: &mut Fields| {
        let Some((quantity, rows)) = section else { return Ok(()) };
        let table = NumberTable::from_rows(&rows);
        fields.add(quantity, table.map_err(|e| Problem::whole(format!("{}: {e}", quantity.symbol())))?)
    };
    for (line, row) in rows(text) {
        if let Some(quantity) = Quantity::named(row) {
            close(current.replace((quantity, Vec::new())), &mut fields)?;
        } else if views::is_named(row) {
            fields.pictures.read_row(row).map_err(|e| Problem::at(line, e))?;
        } else if let Some(number) = image_number(row) {
            fields.images[number - 1] = Some(image(row).map_err(|e| Problem::at(line, e))?);
        } else {
            let numbers = finite_numbers(row).map_err(|e| Problem::at(line, e))?;
            let Some((quantity, rows)) = &mut current else {
                return Err(Problem::at(line, "there is no name above these numbers"));
            };
            let (found, expected) = (numbers.len(), rows.first().map_or(numbers.len(), Vec::len));
            rows.push(numbers);
            if found != expected {
                let (symbol, row) = (quantity.symbol(), rows.len());
                let problem = format!("{symbol}: row {row} has {found} numbers, row 1 has {expected}");
                return Err(Problem::at(line, problem));
            }
        }
    }
    close(current, &mut fields)?;
    Ok(fields)
}

/// Quantity and the rows of numbers below its name.
type Section = (Quantity, Vec<Vec<f64>>);

/// Returns 1 or 2 for a line that describes this image.
fn image_number(row: &str) -> Option<usize> {
    match row.split_whitespace().next() {
        Some("image1") => Some(1),
        Some("image2") => Some(2),
        _ => None,
    }
}

/// Parses `image1 WIDTH HEIGHT NAME`; the name may contain spaces.
fn image(row: &str) -> Result<ImageNote, String> {
    let mut words = row.splitn(4, char::is_whitespace).skip(1);
    let mut side = || words.next().and_then(|w| w.parse().ok());
    match (side(), side()) {
        (Some(width), Some(height)) => {
            let name = words.next().unwrap_or("").trim().to_owned();
            Ok(ImageNote::new(name, Frame::new(width, height)))
        }
        _ => Err("expected the width, the height and the name of an image".into()),
    }
}

/// Reads numbers without names: point pairs, or six rows of two cameras.
fn bare(text: &str, wanted: BareNumbers) -> Result<Fields, Problem> {
    let mut fields = Fields::default();
    if wanted == BareNumbers::Anything {
        let (pairs, notes) = parse_point_pairs(text)?;
        let numbers: Vec<f64> = pairs.iter().flat_map(PointPair::numbers).collect();
        fields.add(Quantity::Pairs, NumberTable::new(pairs.len(), 4, numbers).map_err(Problem::whole)?)?;
        fields.notes = notes;
        return Ok(fields);
    }
    let count = rows(text).map(|(_, row)| cells(row).count()).sum::<usize>();
    if count > 24 {
        return Err(expected_nine(count));
    }
    let lists = rows(text)
        .map(|(line, row)| finite_numbers(row).map_err(|e| Problem::at(line, e)))
        .collect::<Result<Vec<_>, _>>()?;
    let table = NumberTable::from_rows(&lists).map_err(|_| expected_nine(count))?;
    fields.add_bare(table, wanted)?;
    Ok(fields)
}

/// Says how many numbers there are in place of the nine of `F`.
pub(super) fn expected_nine(count: usize) -> Problem {
    Problem::whole(format!("expected the nine numbers of a fundamental matrix, found {count}"))
}
