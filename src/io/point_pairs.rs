//! Point pairs as text: one pair per row, `x1 y1 x2 y2`, separated by spaces, tabs, commas or
//! semicolons.
//!
//! Blank lines and lines that start with `#` are skipped. A heading in the first row may name the columns
//! in any order, among others; without these names, the rows are as above. Pitfall: a decimal comma is
//! indistinguishable from a separator.

use super::number::{cells, finite_numbers, rows};
use super::read::Problem;
use crate::geometry::PointPair;

/// Known names of the columns, by coordinate.
const NAMES: [[&str; 3]; 4] =
    [["x1", "left_x", "u1"], ["y1", "left_y", "v1"], ["x2", "right_x", "u2"], ["y2", "right_y", "v2"]];

/// Parses all pairs of a text.
pub fn parse_point_pairs(text: &str) -> Result<Vec<PointPair>, Problem> {
    let (mut pairs, mut columns) = (Vec::new(), None);
    for (k, (line, row)) in rows(text).enumerate() {
        if k == 0 && is_heading(row) {
            columns = named_columns(row);
            continue;
        }
        let failed = |problem| Problem::at(line, problem);
        let numbers = match columns {
            Some(columns) => {
                let cells: Vec<&str> = cells(row).collect();
                let named: Vec<&str> = columns.iter().filter_map(|k| cells.get(*k).copied()).collect();
                finite_numbers(&named.join(" "))
            }
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

/// Returns the positions of the coordinates in a heading; `None` if it does not name all four.
fn named_columns(heading: &str) -> Option<[usize; 4]> {
    let names: Vec<String> = cells(heading).map(|cell| cell.trim_matches('"').to_lowercase()).collect();
    let at = |known: &[&str; 3]| names.iter().position(|name| known.contains(&name.as_str()));
    let [x1, y1, x2, y2] = NAMES.each_ref().map(at);
    Some([x1?, y1?, x2?, y2?])
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
        // A heading consists of words only.
        assert_eq!(problem("nan nan nan nan").0, 1);
    }
}
