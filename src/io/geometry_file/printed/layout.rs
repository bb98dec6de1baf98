//! Rows of the nine numbers of a printed matrix.

use super::groups::{Entry, Group, MATRIX};

/// Nine numbers in their order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nine {
    pub numbers: [f64; MATRIX],
    /// Whether brackets or row marks show the rows.
    pub has_rows: bool,
    /// Whether at least line ends show them.
    pub has_lines: bool,
}

/// Returns the nine numbers of a group row by row. `None` if there are not nine.
///
/// # Errors
/// A clause, if the numbers stand in other rows than three of three.
pub(super) fn nine(group: &Group) -> Option<Result<Nine, String>> {
    let entries = without_shape(&group.entries);
    let entries = without_headings(entries).unwrap_or_else(|| entries.to_vec());
    if entries.len() != MATRIX {
        return None;
    }
    Some(ordered(&entries))
}

fn ordered(entries: &[Entry]) -> Result<Nine, String> {
    let last = entries.iter().map(|entry| entry.block).max().unwrap_or(0);
    if last > 0 {
        return in_blocks(entries, last)
            .ok_or_else(|| "the blocks of columns do not have three rows".to_owned());
    }
    let [brackets, marks, lines] = [
        runs(entries, |entry| entry.bracket),
        runs(entries, |entry| entry.row),
        runs(entries, |entry| entry.line),
    ];
    let is_rows = |runs: &[usize]| runs == [3, 3, 3];
    let is_list = |runs: &[usize]| runs.len() == 1 || runs.len() == MATRIX;
    let irregular = |runs: &[usize]| {
        let counts = runs.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        Err(format!("the nine numbers stand in rows of {counts}, expected three rows of three"))
    };
    let has_rows = is_rows(&brackets) || (is_list(&brackets) && is_rows(&marks));
    let has_lines = is_rows(&lines);
    match () {
        () if has_rows => {}
        () if !is_list(&brackets) => return irregular(&brackets),
        () if has_lines => {}
        () if !is_list(&marks) => return irregular(&marks),
        // Within one bracket the lines of a list may break anywhere.
        () if is_list(&lines) || (brackets.len() == 1 && entries[0].bracket > 0) => {}
        () => return irregular(&lines),
    }
    let mut numbers = [0.0; MATRIX];
    numbers.iter_mut().zip(entries).for_each(|(number, entry)| *number = entry.value);
    Ok(Nine { numbers, has_rows, has_lines })
}

/// Returns the lengths of the runs of entries with the same key.
fn runs(entries: &[Entry], key: fn(&Entry) -> usize) -> Vec<usize> {
    entries.chunk_by(|a, b| key(a) == key(b)).map(<[Entry]>::len).collect()
}

/// Joins blocks of columns, each of three lines.
fn in_blocks(entries: &[Entry], last: usize) -> Option<Nine> {
    let mut rows = [const { Vec::new() }; 3];
    for block in 0..=last {
        let block: Vec<Entry> = entries.iter().filter(|entry| entry.block == block).cloned().collect();
        let lines: Vec<&[Entry]> = block.chunk_by(|a, b| a.line == b.line).collect();
        let [first, second, third] = lines[..] else { return None };
        if first.len() != second.len() || first.len() != third.len() {
            return None;
        }
        for (row, line) in rows.iter_mut().zip([first, second, third]) {
            row.extend(line.iter().map(|entry| entry.value));
        }
    }
    let numbers = rows.concat().try_into().ok()?;
    Some(Nine { numbers, has_rows: true, has_lines: true })
}

/// Leaves out the shape `3, 3` before or behind the numbers.
fn without_shape(entries: &[Entry]) -> &[Entry] {
    let apart = |shape: &[Entry], rest: &[Entry]| {
        shape.iter().all(|entry| entry.value - 3.0 == 0.0)
            && (rest.iter().all(|entry| entry.bracket != shape[0].bracket)
                || (shape[0].line == shape[1].line && rest.iter().all(|entry| entry.line != shape[0].line)))
    };
    match entries.len().checked_sub(MATRIX) {
        Some(2) if apart(&entries[..2], &entries[2..]) => &entries[2..],
        Some(2) if apart(&entries[MATRIX..], &entries[..MATRIX]) => &entries[..MATRIX],
        _ => entries,
    }
}

/// Leaves out the numbers of columns and rows that tables of data frames have: `0 1 2` above and at the left.
fn without_headings(entries: &[Entry]) -> Option<Vec<Entry>> {
    let lines: Vec<&[Entry]> = entries.chunk_by(|a, b| a.line == b.line).collect();
    let [heading, rows @ ..] = &lines[..] else { return None };
    let counts = |mut numbers: [f64; 3]| {
        let first = numbers[0];
        for number in &mut numbers {
            *number -= first;
        }
        matches!(first, 0.0 | 1.0) && matches!(numbers, [0.0, 1.0, 2.0])
    };
    let ([a, b, c], [x, y, z]) = (*heading, rows) else { return None };
    let is_table = [x, y, z].iter().all(|row| row.len() == 4)
        && counts([a.value, b.value, c.value])
        && counts([x[0].value, y[0].value, z[0].value]);
    is_table.then(|| rows.iter().flat_map(|row| row[1..].iter().cloned()).collect())
}
