//! Reads tables of point pairs as spreadsheets copy them.

use crate::geometry::PointPair;

/// Maximum number of pasted rows, far more than anybody clicks.
const MOST_PASTED: usize = 1000;

/// Reads rows of `name x1 y1 x2 y2` or `x1 y1 x2 y2`, with or without a heading. Tabs, semicolons,
/// commas or spaces separate. With tabs or semicolons, a comma is a decimal comma. Further cells
/// are ignored.
pub fn parse_table(text: &str) -> Result<Vec<(Option<String>, PointPair)>, String> {
    let (mut rows, mut pairs_first) = (Vec::new(), false);
    let lines =
        text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    for (number, (line, row)) in lines.enumerate() {
        match parse_row(row, pairs_first) {
            Some(pair) => rows.push(pair),
            // The heading shows whether names come first.
            None if number == 0 && row.chars().any(char::is_alphabetic) => {
                pairs_first = row.trim_start_matches(['"', ' ']).to_lowercase().starts_with('x');
            }
            None => {
                let row: String = row.trim().chars().take(40).collect();
                return Err(format!(
                    "Nothing was pasted: line {} (\"{row}\") has no four numbers. Copy rows of x1 \
                     y1 x2 y2, with or without a name in front.",
                    line + 1
                ));
            }
        }
        if rows.len() > MOST_PASTED {
            return Err(format!(
                "Nothing was pasted: the table has more than {MOST_PASTED} rows. Import a file instead."
            ));
        }
    }
    if rows.is_empty() {
        return Err("Nothing was pasted: there are no point pairs. Copy rows of x1 y1 x2 y2, with or \
             without a name in front."
            .into());
    }
    Ok(rows)
}

fn parse_row(row: &str, pairs_first: bool) -> Option<(Option<String>, PointPair)> {
    let separator = ['\t', ';', ','].into_iter().find(|separator| row.contains(*separator));
    let cells: Vec<&str> = match separator {
        Some(separator) => row.split(separator).map(|cell| cell.trim().trim_matches('"')).collect(),
        None => row.split_whitespace().collect(),
    };
    let decimal_comma = matches!(separator, Some('\t' | ';'));
    let number = |cell: &&str| {
        let cell = if decimal_comma { cell.replace(',', ".") } else { (*cell).to_owned() };
        cell.parse::<f64>().ok().filter(|value| value.is_finite())
    };
    let pair = |cells: &[&str]| {
        let numbers: Vec<f64> = cells.get(..4)?.iter().map_while(number).collect();
        let [x1, y1, x2, y2] = numbers[..] else { return None };
        Some(PointPair::new(x1, y1, x2, y2))
    };
    let named = cells.get(1..).and_then(|rest| Some((cells.first()?, pair(rest)?)));
    if let Some((name, pair)) = named.filter(|_| !pairs_first) {
        let name = Some((*name).to_owned()).filter(|name| !name.is_empty());
        return Some((name, pair));
    }
    Some((None, pair(&cells)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_with_headings_commas_and_names() {
        let pair = PointPair::new(1.5, 2.0, -3.0, 4.25);
        for text in [
            "1.5 2 -3 4.25",
            "x1,y1,x2,y2\n1.5,2,-3,4.25\n",
            "\"x1\";\"y1\";\"x2\";\"y2\"\r\n1,5;2;-3;4,25\r\n",
            "# a comment\n\n1,5\t2\t-3\t4,25\tclicked",
            "\t1.5\t2\t-3\t4.25",
            "x1 y1 x2 y2 distance\n1.5 2 -3 4.25 0.7",
        ] {
            assert_eq!(parse_table(text), Ok(vec![(None, pair)]), "{text:?}");
        }
        for text in ["door 1.5 2 -3 4.25", "Name,x1,y1,x2,y2,role\ndoor,1.5,2,-3,4.25,used"] {
            assert_eq!(parse_table(text), Ok(vec![(Some("door".to_owned()), pair)]), "{text:?}");
        }
        for text in ["", "hello", "1 2 3", "1 2 3 4\nx y z w", "1 2 3 inf"] {
            assert!(parse_table(text).is_err(), "{text:?}");
        }
        assert!(parse_table("1 2 3 4\n1 2 3\n").unwrap_err().contains("line 2"));
    }
}
