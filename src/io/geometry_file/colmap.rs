//! Text in the conventions of COLMAP: the upper left *corner* of the image is (0, 0), so the centre of the upper left
//! pixel is (0.5, 0.5).
//!
//! COLMAP keeps two-view geometries in a database, for which it has no text form; its tables and its text files
//! inspired this one: `#` comments, and one record a line that begins with what it is.
//!
//! ```text
//! IMAGE 1 768 576 house.000.pgm
//! IMAGE 2 768 576 house.001.pgm
//! F 6.2e-7 -1.7e-5 …            nine numbers row by row, as in the table two_view_geometries
//! MATCH 157.5 336.5 101.4 344.2 keypoints x1 y1 x2 y2 of a match
//! ```

use std::fmt::Write;

use super::coordinates::{Written, numbers, one_line, pair_numbers};
use super::fields::{Fields, Table, shortened};
use super::quantity::Quantity;
use super::{ImageNote, Problem};
use crate::geometry::Frame;
use crate::io::number::{finite_numbers, rows};

const IMAGE: &str = "IMAGE";
const MATCH: &str = "MATCH";

pub(super) fn write(written: &Written) -> String {
    let mut text = String::new();
    for line in written.preamble() {
        let _ = writeln!(text, "# {line}");
    }
    if let Some(images) = written.images {
        let _ = writeln!(text, "# {IMAGE} IMAGE_ID WIDTH HEIGHT NAME");
        for (k, image) in images.iter().enumerate() {
            let (frame, name) = (image.frame, one_line(&image.name));
            let _ = writeln!(text, "{IMAGE} {} {} {} {name}", k + 1, frame.width, frame.height);
        }
    }
    for matrix in &written.matrices {
        let (quantity, values) = (matrix.quantity, numbers(&matrix.rows.concat(), " "));
        let _ = writeln!(text, "# {}\n{} {values}", quantity.meaning(), quantity.symbol());
    }
    if !written.pairs.is_empty() {
        let _ = writeln!(text, "# {MATCH} X1 Y1 X2 Y2, keypoints of image 1 and image 2");
    }
    for pair in &written.pairs {
        let _ = writeln!(text, "{MATCH} {}", numbers(&pair_numbers(pair), " "));
    }
    text
}

/// Whether a line is a record: what it is, and something behind it.
pub(super) fn is_row(row: &str) -> bool {
    let mut words = row.split_whitespace();
    let is_known = words.next().is_some_and(|w| w == IMAGE || w == MATCH || Quantity::named(w).is_some());
    is_known && words.next().is_some_and(|w| w.parse::<f64>().is_ok())
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    let mut fields = Fields::default();
    let mut matches = Vec::new();
    for (line, row) in rows(text) {
        let (word, rest) = row.split_once(char::is_whitespace).unwrap_or((row, ""));
        let at = |problem: String| Problem::at(line, problem);
        if word == IMAGE {
            let (number, image) =
                image(rest).ok_or_else(|| at("expected IMAGE 1 or 2, WIDTH HEIGHT NAME".into()))?;
            fields.add_image(number - 1, image);
            continue;
        }
        let numbers = finite_numbers(rest).map_err(at)?;
        if word == MATCH {
            if numbers.len() != 4 {
                return Err(at(format!("expected four numbers x1 y1 x2 y2, found {}", numbers.len())));
            }
            matches.extend(numbers);
        } else if let Some(quantity) = Quantity::named(word) {
            fields.add(quantity, Table::new(1, numbers.len(), numbers).map_err(at)?)?;
        } else {
            return Err(at(format!("\"{}\" is not known here", shortened(word))));
        }
    }
    if !matches.is_empty() {
        fields.add(Quantity::Pairs, Table::new(matches.len() / 4, 4, matches).map_err(Problem::whole)?)?;
    }
    Ok(fields)
}

/// `1 WIDTH HEIGHT NAME`; the name may have spaces.
fn image(rest: &str) -> Option<(usize, ImageNote)> {
    let mut words = rest.splitn(4, char::is_whitespace);
    let number = words.next()?.parse().ok().filter(|n| (1..=2).contains(n))?;
    let frame = Frame::new(words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    Some((number, ImageNote { name: words.next().unwrap_or("").trim().to_owned(), frame }))
}
