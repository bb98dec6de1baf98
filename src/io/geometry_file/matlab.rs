//! A script for MATLAB and Octave, which also suits the VGG toolbox: assignments of matrices.
//!
//! MATLAB counts pixels from 1. Its `estimateFundamentalMatrix` documents `[P2 1] * F * [P1 1]' = 0` with points as
//! rows, which is `x2ᵀ F x1 = 0`; so does `vgg_F_from_P` of the toolbox of Hartley & Zisserman's book, while
//! `vgg_gui_F` and `vgg_F_from_7pts_2img` go the other way round, with the transpose.
//!
//! Read are assignments of matrices of numbers, `F = [1 2 3; 4 5 6; 7 8 9];`, also transposed ones (`[...]'`), and
//! the two image notes; all else is passed over. Nothing is evaluated.

use std::fmt::Write;

use super::coordinates::{Written, numbers, one_line};
use super::fields::{Fields, Table, parse_number};
use super::quantity::Quantity;
use super::{ImageNote, Problem};
use crate::geometry::Frame;

pub(super) fn write(written: &Written) -> String {
    let mut text = String::new();
    for line in written.preamble() {
        let _ = writeln!(text, "% {line}");
    }
    for (k, image) in written.images.iter().flat_map(|i| i.iter()).enumerate() {
        let name = one_line(&image.name).replace('\'', "''");
        let (number, frame) = (k + 1, image.frame);
        let _ = writeln!(
            text,
            "image{number} = struct('name', '{name}', 'width', {}, 'height', {});",
            frame.width, frame.height
        );
    }
    for table in written.tables() {
        let symbol = table.quantity.symbol();
        let _ = writeln!(text, "% {}\n{symbol} = [", table.quantity.meaning());
        for row in table.values.chunks(table.columns) {
            let _ = writeln!(text, "   {};", numbers(row, ", "));
        }
        text.push_str("];\n");
        let transposed = match table.quantity {
            Quantity::Fundamental => "F_vgg = F';\n",
            Quantity::Homography1 => "tform1 = H1';\n",
            Quantity::Homography2 => "tform2 = H2';\n",
            _ => "",
        };
        text.push_str(transposed);
    }
    if let Some(check) = written.check {
        let _ = writeln!(
            text,
            "self_check = struct('pairs', {}, 'mean_distance', {:?}, 'max_distance', {:?});",
            check.pairs, check.mean, check.max
        );
    }
    text
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    let mut fields = Fields::default();
    let code = without_comments(text);
    let mut rest = Cursor { code: &code, line: 1 };
    while let Some((name, line)) = rest.assignment() {
        let is_image = matches!(&name[..], "image1" | "image2");
        match Quantity::named(&name) {
            Some(quantity) if rest.code.starts_with('[') => {
                let table = rest.matrix().map_err(|e| Problem::at(line, format!("{name}: {e}")))?;
                fields.assign(quantity, table);
            }
            None if is_image => {
                if let Some(image) = image(rest.statement()) {
                    fields.add_image(usize::from(name == "image2"), image);
                }
            }
            _ => {}
        }
    }
    Ok(fields)
}

/// Stands for `=` inside quotes, where it assigns nothing.
const QUOTED_EQUALS: char = '\u{1}';

/// The text without comments. Lines keep their number.
fn without_comments(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    for line in text.lines() {
        let mut quoted = false;
        let mut previous = ' ';
        for c in line.chars() {
            // After a value the mark means transposed; that is a value again.
            let is_value = previous.is_alphanumeric() || "_])}".contains(previous);
            match c {
                '\'' if !quoted && is_value => {
                    code.push(c);
                    previous = ']';
                    continue;
                }
                '\'' => quoted = !quoted,
                '%' | '#' if !quoted => break,
                _ => {}
            }
            code.push(if quoted && c == '=' { QUOTED_EQUALS } else { c });
            previous = c;
        }
        code.push('\n');
    }
    code
}

/// What is left of the code.
struct Cursor<'a> {
    code: &'a str,
    line: usize,
}

impl<'a> Cursor<'a> {
    /// Moves on by some bytes and counts the lines.
    fn skip(&mut self, bytes: usize) -> &'a str {
        let (passed, rest) = self.code.split_at(bytes.min(self.code.len()));
        self.line += passed.matches('\n').count();
        self.code = rest;
        passed
    }

    /// The name and the line of the next assignment; behind it stands its value.
    fn assignment(&mut self) -> Option<(String, usize)> {
        loop {
            let equals = self.code.find('=')?;
            let before = self.skip(equals + 1);
            let line = self.line;
            let name = before[..equals].trim_end_matches([' ', '\t']);
            let start = name.rfind(|c: char| !(c.is_alphanumeric() || c == '_'));
            let name = &name[start.map_or(0, |s| s + name[s..].chars().next().map_or(1, char::len_utf8))..];
            let spaces = self.code.len() - self.code.trim_start_matches([' ', '\t']).len();
            self.skip(spaces);
            if !name.is_empty() && !self.code.starts_with('=') {
                return Some((name.to_owned(), line));
            }
        }
    }

    /// The rest of the line.
    fn statement(&mut self) -> &'a str {
        self.skip(self.code.find('\n').unwrap_or(self.code.len()))
    }

    /// A matrix in brackets, which begins here, perhaps transposed.
    fn matrix(&mut self) -> Result<Table, String> {
        let end = self.code.find(']').ok_or("the closing bracket ] is missing")?;
        let inside = &self.skip(end + 1)[1..end];
        let mut rows = Vec::new();
        for row in inside.replace("...\n", " ").split([';', '\n']) {
            let cells = row.split([' ', '\t', ',', '\r']).filter(|cell| !cell.is_empty());
            let numbers = cells.map(parse_number).collect::<Result<Vec<_>, _>>()?;
            if !numbers.is_empty() {
                rows.push(numbers);
            }
        }
        if self.code.starts_with('\'') {
            let columns = rows.first().map_or(0, Vec::len);
            if rows.iter().all(|r| r.len() == columns) {
                rows = (0..columns).map(|c| rows.iter().map(|r| r[c]).collect()).collect();
            }
        }
        Table::from_rows(&rows)
    }
}

/// `struct('name', '…', 'width', 1, 'height', 1)`.
fn image(statement: &str) -> Option<ImageNote> {
    let inside = statement.trim_start().strip_prefix("struct(")?;
    let (name, rest) = inside
        .trim_start()
        .strip_prefix("'name',")?
        .trim_start()
        .strip_prefix('\'')?
        .split_once("', 'width',")?;
    let (width, rest) = rest.split_once(',')?;
    let height = rest.trim_start().strip_prefix("'height',")?.split_once(')')?.0;
    let frame = Frame::new(width.trim().parse().ok()?, height.trim().parse().ok()?);
    Some(ImageNote { name: name.replace("''", "'").replace(QUOTED_EQUALS, "="), frame })
}
