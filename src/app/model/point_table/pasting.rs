//! Reads tables of point pairs as spreadsheets copy them.

use crate::app::model::document::pair_name;
use crate::geometry::PointPair;

/// Maximum number of pasted rows, far more than anybody clicks.
const MOST_PASTED: usize = 1000;

/// Returns whether a name is the automatic name of a place in the list.
pub fn is_name_of_a_place(name: &str) -> bool {
    (0..3).any(|pair| pair_name(pair) == name) || name.parse::<usize>().is_ok()
}

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
