//! Point pairs as text: one pair per row, `x1 y1 x2 y2`, separated by spaces, tabs, commas or
//! semicolons.
//!
//! Blank lines and lines that start with `#` are skipped. A heading in the first row may name the columns
//! in any order, among others. Without a heading, the first four of more columns are the pair, as in the text of
//! `MicMac` (`x1 y1 x2 y2 weight`); rows that begin with numbers of points are refused. Pitfall: a decimal comma is
//! indistinguishable from a separator, except beside another separator.

use super::number::{cells, finite_number, finite_numbers, rows};
use super::read::Problem;
use crate::geometry::PointPair;

/// Columns of the coordinates, named by a heading.
struct Columns {
    at: [usize; 4],
    /// Separator of the heading; `None` for spaces.
    separator: Option<char>,
}

/// Parses all pairs of a text. Returns them with clauses about what was left out.
pub fn parse_point_pairs(text: &str) -> Result<(Vec<PointPair>, Vec<String>), Problem> {
    if let Some(found) = pairs_of_pictures(text) {
        return Ok((found?, Vec::new()));
    }
    let (mut numbers, mut columns, mut notes) = (Vec::new(), None, Vec::new());
    let mut heading = None;
    let mut is_mixed = None;
    for (k, (line, row)) in rows(text).enumerate() {
        if k == 0 && is_heading(row) {
            columns = Columns::of(row).map_err(|problem| Problem::at(line, problem))?;
            heading = Some(line).filter(|_| columns.is_none());
            continue;
        }
        let failed = |problem| Problem::at(line, problem);
        let found: Result<Vec<f64>, String> = match &columns {
            Some(columns) => columns.in_order(row).into_iter().map(finite_number).collect(),
            None => finite_numbers(row),
        };
        let found = found.map_err(failed)?;
        if found.len() < 4 {
            return Err(failed(format!("expected four numbers x1 y1 x2 y2, found {}", found.len())));
        }
        if has_decimal_commas(row) {
            is_mixed.get_or_insert(line);
        }
        numbers.push((line, found));
    }
    let Some((first, rest)) = numbers.split_first() else { return Ok((Vec::new(), notes)) };
    let count = first.1.len();
    if let Some((line, row)) = rest.iter().find(|(_, row)| row.len() != count) {
        let problem = format!("there are {} numbers, and {count} in the row before", row.len());
        return Err(Problem::at(*line, format!("expected four numbers x1 y1 x2 y2: {problem}")));
    }
    if count > 4 {
        if let Some(line) = is_mixed {
            let problem = format!(
                "found {count} numbers, or fewer with decimal commas. Write points in place of commas"
            );
            return Err(Problem::at(line, problem));
        }
        if let Some(line) = heading {
            let problem = format!(
                "the heading does not name x1, y1, x2 and y2 among the {count} columns. Name them so"
            );
            return Err(Problem::at(line, problem));
        }
        let rows: Vec<&[f64]> = numbers.iter().map(|(_, row)| &row[..]).collect();
        check_more_columns(&rows).map_err(Problem::whole)?;
        notes.push(first_four(count));
    } else if heading.is_some() {
        notes.push("the heading names no coordinates, so the columns were read as x1 y1 x2 y2".to_owned());
    }
    let pair = |row: &[f64]| PointPair::new(row[0], row[1], row[2], row[3]);
    Ok((numbers.iter().map(|(_, row)| pair(row)).collect(), notes))
}

/// Returns whether a row has a comma between two digits, and another separator.
fn has_decimal_commas(row: &str) -> bool {
    let bytes = row.as_bytes();
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let is_decimal = |at: usize| at > 0 && bytes[at] == b',' && is_digit(at - 1) && is_digit(at + 1);
    (0..bytes.len()).any(is_decimal) && row.trim().contains([';', ' ', '\t'])
}

/// Says that only the first four columns were read.
pub(super) fn first_four(count: usize) -> String {
    format!("of {count} columns the first four were read as x1 y1 x2 y2")
}

/// Refuses rows of five and more numbers of which the first four are hardly a pair: numbers of points in front, or
/// homogeneous coordinates.
pub(super) fn check_more_columns(rows: &[&[f64]]) -> Result<(), String> {
    let column = |k: usize| rows.iter().map(move |row| row[k]);
    let is_whole = |k: usize| column(k).all(|number| number.fract() == 0.0);
    let counts = rows.len() > 1 && rows.windows(2).all(|two| two[1][0] - two[0][0] - 1.0 == 0.0);
    let is_index = is_whole(0) && (counts || (!is_whole(1) && rows.len() > 1));
    let are_indices = rows[0].len() > 5 && is_whole(0) && is_whole(1) && !(is_whole(2) && is_whole(3));
    let is_constant =
        rows.len() > 1 && [0, 1, 2, 3].iter().any(|k| column(*k).all(|number| number - rows[0][*k] == 0.0));
    let unlike = match () {
        () if is_index => "begin with the number of the point",
        () if are_indices => "begin with two numbers of points",
        () if is_constant => "have the same number in one of the first four columns",
        () => return Ok(()),
    };
    Err(format!(
        "the rows of {} numbers {unlike}. Name the columns in the first row (x1 y1 x2 y2 among them), or leave only these four",
        rows[0].len()
    ))
}

/// Returns whether a text begins as the matches of one picture with others do.
pub(super) fn is_of_pictures(text: &str) -> bool {
    let heading = rows(text).next().and_then(|(_, heading)| heading.split(':').next());
    heading.is_some_and(|name| name.trim().eq_ignore_ascii_case("nFeatures"))
}

/// Reads the matches of one picture with others, as courses in structure from motion give them: `nFeatures: N`, then
/// rows with the number of pictures, a colour, the place, and for each other picture its number and the place there.
/// `None` for another text.
fn pairs_of_pictures(text: &str) -> Option<Result<Vec<PointPair>, Problem>> {
    if !is_of_pictures(text) {
        return None;
    }
    let rows = rows(text).skip(1);
    let mut found: Vec<(usize, PointPair)> = Vec::new();
    for (line, row) in rows {
        let numbers = match finite_numbers(row) {
            Ok(numbers) if numbers.len() >= 6 && numbers.len() % 3 == 0 => numbers,
            Ok(numbers) => {
                let problem = "expected the number of pictures, red, green, blue, x, y, and the number of a picture, x, y for each other one";
                return Some(Err(Problem::at(line, format!("{problem}, found {} numbers", numbers.len()))));
            }
            Err(problem) => return Some(Err(Problem::at(line, problem))),
        };
        for other in numbers[6..].chunks_exact(3) {
            found.push((other[0] as usize, PointPair::new(numbers[4], numbers[5], other[1], other[2])));
        }
    }
    let mut pictures: Vec<usize> = found.iter().map(|(picture, _)| *picture).collect();
    pictures.sort_unstable();
    pictures.dedup();
    Some(match pictures[..] {
        [] | [_] => Ok(found.into_iter().map(|(_, pair)| pair).collect()),
        _ => {
            let pictures: Vec<String> = pictures.iter().map(ToString::to_string).collect();
            Err(Problem::whole(format!(
                "these are matches of one picture with several others, number {}. Write those with your second picture as rows of x1 y1 x2 y2",
                pictures.join(", ")
            )))
        }
    })
}

impl Columns {
    /// Returns the columns of a heading; `None` if it names no coordinates.
    ///
    /// # Errors
    /// A clause, if it names some of them, or one twice.
    fn of(heading: &str) -> Result<Option<Self>, String> {
        let separator = [';', '\t', ','].into_iter().find(|separator| heading.contains(*separator));
        let names = split(heading, separator);
        let from_zero = names.iter().any(|name| coordinate(name, true) == Some(0));
        let names: Vec<_> = names.into_iter().map(|name| coordinate(name, from_zero)).collect();
        let at = |wanted| {
            let mut places = (0..names.len()).filter(|k| names[*k] == Some(wanted));
            places.next().filter(|_| places.next().is_none())
        };
        match [0, 1, 2, 3].map(at) {
            [Some(x1), Some(y1), Some(x2), Some(y2)] => Ok(Some(Self { at: [x1, y1, x2, y2], separator })),
            _ if names.iter().all(Option::is_none) => Ok(None),
            _ => Err("the heading names some coordinates, but not each of x1, y1, x2 and y2 once".to_owned()),
        }
    }

    /// Returns the coordinates of a row in the usual order. Decimal commas stay in them.
    fn in_order<'a>(&self, row: &'a str) -> Vec<&'a str> {
        let cells = split(row, self.separator);
        self.at.iter().filter_map(|k| cells.get(*k).copied()).collect()
    }
}

fn split(row: &str, separator: Option<char>) -> Vec<&str> {
    match separator {
        Some(separator) => row.split(separator).map(|cell| cell.trim().trim_matches('"')).collect(),
        None => row.split_whitespace().collect(),
    }
}

/// Returns which coordinate a name stands for, in the usual order: `x1`, `left_x`, `x_left`, `xl`, `u1` or `col1` is
/// the first. Images may be counted from zero.
fn coordinate(name: &str, from_zero: bool) -> Option<usize> {
    let name: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    let axes: [&[&str]; 2] = [&["column", "col", "x", "u"], &["row", "y", "v"]];
    axes.into_iter().enumerate().find_map(|(axis, words)| {
        words.iter().find_map(|word| {
            match (name.strip_prefix(word).or(name.strip_suffix(word))?, from_zero) {
                ("1", false) | ("0", true) | ("left" | "l" | "a", _) => Some(axis),
                ("2", false) | ("1", true) | ("right" | "r" | "b", _) => Some(2 + axis),
                _ => None,
            }
        })
    })
}

/// Returns whether a row is a heading: it has no number, where NaN and infinity count as numbers.
fn is_heading(row: &str) -> bool {
    cells(row).all(|cell| cell.trim_matches('"').parse::<f64>().is_err())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> (usize, String) {
        let Problem { line, problem } = parse_point_pairs(text).unwrap_err();
        (line.unwrap(), problem)
    }

    #[test]
    fn reads_text_and_csv_alike() {
        let expected = [PointPair::new(1.0, 2.5, -3.0, 4e2), PointPair::new(5.0, 6.0, 7.0, 8.0)];
        for text in [
            "1 2.5 -3 4e2\n5 6 7 8\n",
            "# a comment\n\n1\t2.5\t-3\t400\r\n  5 6 7 8  ",
            "x1,y1,x2,y2\n1,2.5,-3,400\n5,6,7,8",
            "x1,y1,x2,y2,name\n1,2.5,-3,400,\"left, eye\"\n5,6,7,8,q",
            "\"x1\"; \"y1\"; \"x2\"; \"y2\"\n1; 2.5; -3; 400\n5; 6; 7; 8",
            "x1,x2,y1,y2\n1,-3,2.5,400\n5,7,6,8",
            "right_x right_y left_x left_y\n-3 400 1 2.5\n7 8 5 6",
            "id,U1,V1,U2,V2,score\n0,1,2.5,-3,400,0.7\n1,5,6,7,8,0.9",
            "x_right,y_right,x_left,y_left\n-3,400,1,2.5\n7,8,5,6",
            "name;xl;yl;xr;yr\nleft eye;1;2.5;-3;400\nq;5;6;7;8",
            "a b c d\n1 2.5 -3 400\n5 6 7 8",
            "id,x0,y0,x1,y1\n0,1,2.5,-3,400\n1,5,6,7,8",
            "row1 col1 row2 col2\n2.5 1 400 -3\n6 5 8 7",
        ] {
            assert_eq!(parse_point_pairs(text).unwrap().0, expected, "{text:?}");
        }
    }

    #[test]
    fn names_the_line_and_what_is_wrong() {
        assert_eq!(problem("1 2 3 4\n\n1 2 3\n"), (3, "expected four numbers x1 y1 x2 y2, found 3".into()));
        assert_eq!(problem("1 2 3 nan"), (1, "\"nan\" is not a finite number".into()));
        assert_eq!(problem("1 2 3 4\n1 2 inf 4").0, 2);
        assert_eq!(problem("1 2 3 4\nx1 y1 x2 y2").0, 2);
        assert_eq!(problem("1 2 3 4\n1 2 3 4 5").0, 2);
        assert_eq!(problem("id x1 y1 x2 y2\n0 1 2 3\n").1, "expected four numbers x1 y1 x2 y2, found 3");
        assert_eq!(problem("u1;v1;u2;v2\n1,5;2;3;4").0, 2, "a decimal comma");
        assert_eq!(problem("1,5;2,5;3,5;4\n1,5;2,5;3,5;4").0, 1, "decimal commas");
        assert!(problem("id,a,b,c,d\n9,1,2,3,4").1.contains("does not name x1"));
        assert!(problem("a,y2,x1,y1\n9,1,2,3").1.contains("not each of x1"));
        // A heading consists of words only.
        assert_eq!(problem("nan nan nan nan").0, 1);
    }

    #[test]
    fn more_columns_are_told_or_refused() {
        let (pairs, notes) = parse_point_pairs("853.6 770.4 17.2 867.7 1\n866.6 556.3 15.9 617.1 1").unwrap();
        assert_eq!((pairs.len(), pairs[1].point2.y), (2, 617.1));
        assert_eq!(notes, ["of 5 columns the first four were read as x1 y1 x2 y2"]);
        for text in [
            "0 10.5 20.5 30 40\n1 11 21 31 41",
            "7 10.5 20 30 40\n3 11 21 31 41",
            "10 20 1 30 40 1\n11 21 1 31 41 1",
            "4 9 10.5 20.5 30 40\n8 2 11.5 21 31 41",
        ] {
            let problem = parse_point_pairs(text).unwrap_err().problem;
            assert!(problem.contains("Name the columns"), "{problem}");
        }
    }

    #[test]
    fn matches_of_several_pictures_are_named() {
        let one = "nFeatures: 2\n2 137 128 105 454.5 392 4 447.5 479\n2 1 2 3 5 6 4 7 8\n";
        let (pairs, _) = parse_point_pairs(one).unwrap();
        assert_eq!(pairs, [PointPair::new(454.5, 392.0, 447.5, 479.0), PointPair::new(5.0, 6.0, 7.0, 8.0)]);
        let problem = parse_point_pairs(&one.replace("6 4 7", "6 2 7")).unwrap_err().problem;
        assert!(problem.contains("with several others, number 2, 4"), "{problem}");
        assert_eq!(parse_point_pairs(&one.replace(" 7 8", " 7")).unwrap_err().line, Some(3));
    }
}
