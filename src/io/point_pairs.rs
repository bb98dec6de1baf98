//! Point pairs as text: one pair per row, `x1 y1 x2 y2`, separated by spaces, tabs, commas or
//! semicolons.
//!
//! Blank lines and lines that start with `#` are skipped, as is a heading of words in the first
//! row. Pitfall: a decimal comma is indistinguishable from a separator.

use super::number::{cells, finite_numbers, rows};
use super::read::Problem;
use crate::geometry::PointPair;

/// Parses all pairs of a text.
pub fn parse_point_pairs(text: &str) -> Result<Vec<PointPair>, Problem> {
    let (mut pairs, mut columns) = (Vec::new(), None);
    for (k, (line, row)) in rows(text).enumerate() {
        if k == 0 && is_heading(row) {
            let names = cells(row).map(|cell| cell.trim_matches('"').to_lowercase());
            let is_named = names.take(4).eq(["x1", "y1", "x2", "y2"]);
            // Columns after the four coordinates, such as names, are ignored.
            columns = is_named.then_some(4);
            continue;
        }
        let failed = |problem| Problem::at(line, problem);
        let numbers = match columns {
            Some(columns) => finite_numbers(&cells(row).take(columns).collect::<Vec<_>>().join(" ")),
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
        // A heading consists of words only.
        assert_eq!(problem("nan nan nan nan").0, 1);
    }
}
