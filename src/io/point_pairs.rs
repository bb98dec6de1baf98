//! Point pairs as text: one pair per row, `x1 y1 x2 y2`, separated by spaces, tabs, commas or
//! semicolons.
//!
//! Blank lines and lines that start with `#` are skipped. A heading in the first row may name the columns
//! in any order, among others; without these names, the rows are as above. Pitfall: a decimal comma is
//! indistinguishable from a separator.

use super::number::{cells, finite_number, finite_numbers, rows};
use super::read::Problem;
use crate::geometry::PointPair;

/// Columns of the coordinates, named by a heading.
struct Columns {
    at: [usize; 4],
    /// Separator of the heading; `None` for spaces.
    separator: Option<char>,
}

/// Parses all pairs of a text.
pub fn parse_point_pairs(text: &str) -> Result<Vec<PointPair>, Problem> {
    let (mut pairs, mut columns) = (Vec::new(), None);
    for (k, (line, row)) in rows(text).enumerate() {
        if k == 0 && is_heading(row) {
            columns = Columns::of(row);
            continue;
        }
        let failed = |problem| Problem::at(line, problem);
        let numbers = match &columns {
            Some(columns) => columns.in_order(row).into_iter().map(finite_number).collect(),
            None => finite_numbers(row),
        };
        let numbers = numbers.map_err(failed)?;
        let [x1, y1, x2, y2] = numbers[..] else {
            return Err(failed(format!("expected four numbers x1 y1 x2 y2, found {}", numbers.len())));
        };
        pairs.push(PointPair::new(x1, y1, x2, y2));
    }
    Ok(pairs)
}

impl Columns {
    /// Returns the columns of a heading; `None` if it does not name all coordinates.
    fn of(heading: &str) -> Option<Self> {
        let separator = [';', '\t', ','].into_iter().find(|separator| heading.contains(*separator));
        let names: Vec<_> = split(heading, separator).into_iter().map(coordinate).collect();
        let at = |wanted| names.iter().position(|name| *name == Some(wanted));
        let [x1, y1, x2, y2] = [0, 1, 2, 3].map(at);
        Some(Self { at: [x1?, y1?, x2?, y2?], separator })
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

/// Returns which coordinate a name stands for, in the usual order: `x1`, `left_x`, `x_left`, `xl` or `u1` is
/// the first.
fn coordinate(name: &str) -> Option<usize> {
    let name: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    [['x', 'u'], ['y', 'v']].into_iter().enumerate().find_map(|(axis, letters)| {
        match name.strip_prefix(letters).or(name.strip_suffix(letters))? {
            "1" | "left" | "l" | "a" => Some(axis),
            "2" | "right" | "r" | "b" => Some(2 + axis),
            _ => None,
        }
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
        ] {
            assert_eq!(parse_point_pairs(text).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn names_the_line_and_what_is_wrong() {
        assert_eq!(problem("1 2 3 4\n\n1 2 3\n"), (3, "expected four numbers x1 y1 x2 y2, found 3".into()));
        assert_eq!(problem("1 2 3 nan"), (1, "\"nan\" is not a finite number".into()));
        assert_eq!(problem("1 2 3 4\n1 2 inf 4").0, 2);
        assert_eq!(problem("1 2 3 4\nx1 y1 x2 y2").0, 2);
        assert_eq!(problem("1 2 3 4 5").0, 1);
        assert_eq!(problem("id x1 y1 x2 y2\n0 1 2 3\n").1, "expected four numbers x1 y1 x2 y2, found 3");
        assert_eq!(problem("u1;v1;u2;v2\n1,5;2;3;4").0, 2, "a decimal comma");
        // A heading consists of words only.
        assert_eq!(problem("nan nan nan nan").0, 1);
    }
}
