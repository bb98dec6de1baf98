//! A 3×3 matrix as programs and people print it: nine numbers, whatever stands around them.
//!
//! The text is split into numbers and words. Numbers without a word between them are a group; the words before a
//! group name it. The group of nine numbers is the matrix. A named `F` takes precedence; two matrices that no name
//! tells apart are refused, as is a matrix with the name of another one (`E`, `K`, `H`).
//!
//! Pitfalls: most notations list rows, some list columns (`F(:)`, R, `reshape` of MATLAB, `mat3`). A list without
//! rows is read row by row, with a note.

mod groups;
mod layout;
#[cfg(test)]
mod tests;
mod tokens;

use self::groups::{Group, Label, MATRIX, groups};
use self::layout::{Nine, nine};
use crate::foreign::excerpt;
use crate::io::values::MatrixName;

/// Nine numbers of `F`, row by row, and notes on how they were read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PrintedMatrix {
    pub numbers: [f64; MATRIX],
    pub notes: Vec<String>,
}

/// The reason why a text gives no matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum NoMatrix {
    /// No nine numbers stand together. The number is that of the largest group.
    Count(usize),
    /// The text has a matrix, but which one or how it is meant is not clear. A clause for the user.
    Unclear(String),
}

/// Group of nine numbers with its name.
struct Candidate {
    nine: Result<Nine, String>,
    name: MatrixName,
    word: Option<String>,
    is_transposed: bool,
    /// Places of its groups in the text.
    from: usize,
    to: usize,
}

/// Note on nine numbers in one row or one column.
pub(super) const ROW_BY_ROW: &str = "the nine numbers show no rows and were read row by row";

/// Most numbers of a text that are looked at. Files of matches are not printed matrices.
const MOST_NUMBERS: usize = 4000;

/// Reads the fundamental matrix that a text shows.
pub(super) fn read(text: &str) -> Result<PrintedMatrix, NoMatrix> {
    let groups = groups(text);
    let total = groups.iter().map(|group| group.entries.len()).sum::<usize>();
    if total > MOST_NUMBERS {
        return Err(NoMatrix::Count(total));
    }
    let found = candidates(&groups);
    let Some(chosen) = chosen(&groups, &found)? else {
        return decimal_commas(text).ok_or_else(|| none(&groups));
    };
    check_surroundings(&groups, chosen)?;
    let mut nine = chosen.nine.clone().map_err(NoMatrix::Unclear)?;
    let mut notes = Vec::new();
    if !nine.numbers.iter().all(|number| number.is_finite()) {
        let written = groups[chosen.from..=chosen.to].iter().find_map(|group| group.not_finite.as_deref());
        return Err(NoMatrix::Unclear(format!(
            "\"{}\" is not a finite number",
            written.unwrap_or("a number")
        )));
    }
    let left_out: Vec<&str> = found
        .iter()
        .filter(|other| other.from != chosen.from && other.nine != chosen.nine)
        .filter_map(|other| other.word.as_deref())
        .collect();
    if !left_out.is_empty() {
        let word = chosen.word.as_deref().unwrap_or("F");
        notes.push(format!("{word} was read, {} left out", listed(&left_out)));
    }
    let by_columns = lists_columns(text);
    let is_by_columns = by_columns == Some(Columns::Always) || (by_columns.is_some() && !nine.has_rows);
    if is_by_columns {
        notes.push("the numbers stand column by column there".to_owned());
    } else if !nine.has_rows && !nine.has_lines {
        notes.push(ROW_BY_ROW.to_owned());
    }
    if chosen.is_transposed {
        notes.push("a mark of transposition was applied".to_owned());
    }
    if is_by_columns != chosen.is_transposed {
        let n = nine.numbers;
        nine.numbers = [n[0], n[3], n[6], n[1], n[4], n[7], n[2], n[5], n[8]];
    }
    Ok(PrintedMatrix { numbers: nine.numbers, notes })
}

fn none(groups: &[Group]) -> NoMatrix {
    NoMatrix::Count(groups.iter().map(|group| group.entries.len()).max().unwrap_or(0))
}

fn listed(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Returns all groups of nine numbers, and those whose rows or entries are named one by one.
fn candidates(groups: &[Group]) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for (at, group) in groups.iter().enumerate() {
        let Some(nine) = nine(group) else { continue };
        let (name, word) = group.name();
        let is_transposed = group.is_transposed != group.is_named_transposed();
        let word = word.map(excerpt);
        found.push(Candidate { nine, name, word, is_transposed, from: at, to: at });
    }
    let mut at = 0;
    while at < groups.len() {
        let Some((_, base)) = part(&groups[at]) else {
            at += 1;
            continue;
        };
        let count = groups[at..]
            .iter()
            .take_while(|group| part(group).is_some_and(|(_, other)| other == base))
            .count();
        if let Some(nine) = assembled(&groups[at..at + count]) {
            let name = match MatrixName::of(&base) {
                MatrixName::Unknown => groups[at].name().0,
                known => known,
            };
            let word = Some(excerpt(&base)).filter(|base| !base.is_empty());
            found.push(Candidate { nine, name, word, is_transposed: false, from: at, to: at + count - 1 });
        }
        at += count;
    }
    found
}

/// Place of a row, a column or an entry: row and column, `None` for all of them.
type Place = [Option<usize>; 2];

/// Returns the place of a group that is one entry or one row of a matrix by its name, and the name without it.
fn part(group: &Group) -> Option<(Place, String)> {
    let Label { word, index, .. } = group.labels.last()?;
    let digits = |word: &str| {
        let base = word.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_' || c == ',');
        let places =
            word[base.len()..].chars().filter_map(|c| c.to_digit(10)).map(|digit| Some(digit as usize));
        (base.to_owned(), places.collect::<Vec<_>>())
    };
    let (base, index) = if index.is_empty() { digits(word) } else { (word.clone(), index.clone()) };
    match (group.entries.len(), &index[..]) {
        (1, [Some(row), Some(column)]) => Some(([Some(*row), Some(*column)], base)),
        (3, [Some(row)] | [Some(row), None]) => Some(([Some(*row), None], base)),
        (3, [None, Some(column)]) => Some(([None, Some(*column)], base)),
        _ => None,
    }
}

/// Puts named entries, rows or columns in their places. `None` if they are too few for a matrix.
fn assembled(groups: &[Group]) -> Option<Result<Nine, String>> {
    let total: usize = groups.iter().map(|group| group.entries.len()).sum();
    if total < 4 {
        return None;
    }
    let places: Vec<Place> = groups.iter().filter_map(|group| Some(part(group)?.0)).collect();
    // C counts from 0, MATLAB from 1.
    let first = usize::from(places.iter().flatten().all(|place| *place != Some(0)));
    let mut numbers = [f64::NAN; MATRIX];
    let mut is_filled = [false; MATRIX];
    for (place, group) in places.iter().zip(groups) {
        for (k, entry) in group.entries.iter().enumerate() {
            let [row, column] = place.map(|place| place.map_or(Some(k), |place| place.checked_sub(first)));
            let at = row
                .zip(column)
                .filter(|(row, column)| *row < 3 && *column < 3)
                .map(|(row, column)| 3 * row + column);
            let Some(at) = at.filter(|at| !is_filled[*at]) else {
                return Some(Err("the named entries are not those of one 3×3 matrix".to_owned()));
            };
            (numbers[at], is_filled[at]) = (entry.value, true);
        }
    }
    Some(match total {
        MATRIX => Ok(Nine { numbers, has_rows: true, has_lines: true }),
        _ => Err(format!("expected nine named entries, found {total}")),
    })
}

/// Selects the fundamental matrix. `None` if there is no matrix.
fn chosen<'a>(groups: &[Group], found: &'a [Candidate]) -> Result<Option<&'a Candidate>, NoMatrix> {
    let named = |name| found.iter().filter(move |candidate| candidate.name == name);
    let is_part = |at: usize| found.iter().any(|candidate| (candidate.from..=candidate.to).contains(&at));
    for (at, group) in groups.iter().enumerate() {
        let count = group.entries.len();
        let is_matrix = (group.is_assigned || count > 3) && !group.is_shape();
        if !is_part(at) && is_matrix && group.name().0 == MatrixName::Fundamental {
            let word = excerpt(group.name().1.unwrap_or("F"));
            return Err(NoMatrix::Unclear(format!(
                "expected the nine numbers of a fundamental matrix, but {word} has {count}"
            )));
        }
    }
    let candidates: Vec<&Candidate> = match named(MatrixName::Fundamental).count() {
        0 => found.iter().collect(),
        _ => named(MatrixName::Fundamental).collect(),
    };
    let Some(first) = candidates.first() else { return Ok(None) };
    let differ = candidates.iter().skip(1).any(|other| {
        other.nine != first.nine || other.name != first.name || other.is_transposed != first.is_transposed
    });
    let word =
        |candidate: &Candidate| candidate.word.clone().unwrap_or_else(|| "one without a name".to_owned());
    if differ {
        let names: Vec<String> = candidates.iter().map(|candidate| word(candidate)).collect();
        let names = listed(&names.iter().map(String::as_str).collect::<Vec<_>>());
        return Err(NoMatrix::Unclear(format!(
            "there are {} matrices of nine numbers: {names}. Leave only the fundamental matrix, or name it F",
            candidates.len()
        )));
    }
    if first.name == MatrixName::Other {
        return Err(NoMatrix::Unclear(format!(
            "the matrix in it is called {}, not F. If it is a fundamental matrix, name it F",
            word(first)
        )));
    }
    Ok(Some(first))
}

/// Refuses a matrix beside numbers that may belong to it.
fn check_surroundings(groups: &[Group], chosen: &Candidate) -> Result<(), NoMatrix> {
    let is_clear = groups[chosen.from].is_clear
        && !groups[chosen.from].is_broken
        && groups.get(chosen.to + 1).is_none_or(|next| next.is_clear);
    let outside = |at: &usize| !(chosen.from..=chosen.to).contains(at);
    let strange = (0..groups.len()).filter(outside).find(|at| {
        let group = &groups[*at];
        !group.is_described && !group.is_shape() && group.name().0 != MatrixName::Other
    });
    match strange {
        None if is_clear => Ok(()),
        _ => {
            let count = MATRIX + strange.map_or(1, |at| groups[at].entries.len());
            Err(NoMatrix::Unclear(format!(
                "expected the nine numbers of a fundamental matrix, found {count} that cannot be told apart"
            )))
        }
    }
}

/// Whether the numbers of a notation stand column by column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Columns {
    /// If nothing but line ends shows rows.
    WithoutRows,
    Always,
}

/// Returns how the notation lists a matrix by columns, if it does.
fn lists_columns(text: &str) -> Option<Columns> {
    let called = |name: &str| {
        text.match_indices(&format!("{name}("))
            .any(|(at, _)| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.'))
    };
    let lower = text.to_lowercase();
    if lower.contains("from_col") || lower.contains("fromcol") {
        return Some(Columns::Always);
    }
    // R lists columns unless it is told otherwise.
    let by_rows =
        lower.split("byrow").skip(1).any(|rest| rest.trim_start_matches([' ', '=']).starts_with('t'));
    let is_r = called("c") && (called("matrix") || called("structure") || called("array")) && !by_rows;
    let is_reshaped = called("reshape")
        || (text.contains("reshape(") && (lower.contains("order='f'") || lower.contains("order=\"f\"")));
    let is_other = called("mat3")
        || called("dmat3")
        || text.contains("(:)")
        || text.contains(">|<")
        || text.starts_with("%%MatrixMarket")
        || ["column-major", "column major", "column_major"].iter().any(|words| lower.contains(words));
    (is_r || is_reshaped || is_other).then_some(Columns::WithoutRows)
}

/// Reads three rows of three numbers with decimal commas. `None` if another reading is possible.
fn decimal_commas(text: &str) -> Option<PrintedMatrix> {
    let digits: Vec<char> = text.chars().collect();
    let is_decimal = |k: usize| {
        digits[k] == ','
            && k > 0
            && digits[k - 1].is_ascii_digit()
            && digits.get(k + 1).is_some_and(char::is_ascii_digit)
    };
    let points: String = (0..digits.len()).map(|k| if is_decimal(k) { '.' } else { digits[k] }).collect();
    // Entries of F below 1 have a zero before the comma, or an exponent. Coordinates have neither.
    let small = |number: &f64| number.abs() < 1.0 && *number != 0.0;
    // A comma that is left belongs to no number, so the others may not be decimal ones either.
    if points == text || points.contains(',') {
        return None;
    }
    let mut found = read(&points).ok()?;
    let rows = groups(&points);
    let has_lines =
        rows.iter().any(|group| matches!(nine(group), Some(Ok(nine)) if nine.has_lines || nine.has_rows));
    let is_matrix = has_lines && found.numbers.iter().filter(|number| small(number)).count() >= 6;
    found.notes.push("the commas were read as decimal commas".to_owned());
    is_matrix.then_some(found)
}
