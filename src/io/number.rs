//! Numbers in text files.

use crate::foreign::excerpt;

/// Parses the finite numbers of a row. Cells are separated by spaces, tabs, commas or semicolons.
/// The error names the first invalid cell.
pub(super) fn finite_numbers(row: &str) -> Result<Vec<f64>, String> {
    cells(row).map(finite_number).collect()
}

pub(super) fn finite_number(cell: &str) -> Result<f64, String> {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("\"{}\" is not a finite number", excerpt(cell))),
    }
}

pub(super) fn cells(row: &str) -> impl Iterator<Item = &str> {
    row.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|cell| !cell.is_empty())
}

/// Returns the lines with content, numbered from 1. Blank lines and `#` comments are skipped.
pub(super) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}
