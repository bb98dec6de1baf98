//! Fundamental matrices as files: a result of `epiline estimate`, or the nine numbers alone.

use std::path::Path;

use nalgebra::Matrix3;
use serde_json::Value;

use super::number::{finite_numbers, rows};
use super::read::{ReadError, read_text};
use crate::geometry::FundamentalMatrix;

/// Reads `F` from JSON with nested rows under `fundamental`, from JSON rows alone, or from nine numbers row by
/// row separated by spaces, tabs, commas or semicolons; `#` begins a comment line. A matrix of rank 3, rounded
/// say, is brought to rank 2.
pub fn read_fundamental(path: &Path) -> Result<FundamentalMatrix, ReadError> {
    let text = read_text(path)?;
    let numbers = if text.trim_start().starts_with(['{', '[']) {
        json_numbers(&text).map_err(|problem| ReadError::content(path, problem))?
    } else {
        let mut numbers = Vec::new();
        for (line, row) in rows(&text) {
            numbers.extend(finite_numbers(row).map_err(|problem| ReadError::line(path, line, problem))?);
        }
        numbers
    };
    let [a, b, c, d, e, f, g, h, i] = numbers[..] else {
        let problem = format!("expected the nine numbers of a fundamental matrix, found {}", numbers.len());
        return Err(ReadError::content(path, problem));
    };
    let matrix = Matrix3::new(a, b, c, d, e, f, g, h, i);
    // In pixels the second singular value may be a millionth of the first, but it is no rounding error.
    let has_rank_two = matrix.rank(1e-13 * matrix.norm()) >= 2;
    has_rank_two
        .then(|| FundamentalMatrix::nearest_rank_two(matrix))
        .flatten()
        .ok_or_else(|| ReadError::content(path, "the matrix has rank 1 or 0, a fundamental matrix has 2"))
}

/// All numbers of the matrix in a JSON text, row by row.
fn json_numbers(text: &str) -> Result<Vec<f64>, String> {
    let value: Value = serde_json::from_str(text).map_err(|e| format!("this is not valid JSON: {e}"))?;
    let matrix = match &value {
        Value::Object(fields) => fields.get("fundamental").ok_or("there is no field \"fundamental\"")?,
        other => other,
    };
    let mut numbers = Vec::new();
    for row in matrix.as_array().ok_or("the fundamental matrix is not a list of rows")? {
        let cells = row.as_array().map_or(std::slice::from_ref(row), Vec::as_slice);
        for cell in cells {
            numbers.push(cell.as_f64().ok_or_else(|| format!("{cell} is not a number"))?);
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Camera;

    fn read(content: &str) -> Result<FundamentalMatrix, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f");
        std::fs::write(&path, content).unwrap();
        read_fundamental(&path).map_err(|e| e.to_string())
    }

    #[test]
    fn all_forms_give_the_same_matrix() {
        let (camera1, camera2) = Camera::example_pair();
        let f = Camera::fundamental(&camera1, &camera2).unwrap();
        let rows = f.rows();
        let lines: Vec<String> = rows.iter().map(|r| format!("{} {} {}", r[0], r[1], r[2])).collect();
        for content in [
            format!("{{\"score\": 1.5, \"fundamental\": {rows:?}}}"),
            format!("{rows:?}"),
            format!("{:?}", rows.concat()),
            format!("# F\n{}\n", lines.join("\n")),
            lines.join(", "),
        ] {
            let found = read(&content).unwrap();
            assert!((found.matrix() - f.matrix()).norm() < 1e-9, "{content}");
        }
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (content, words) in [
            ("1 2 3", "expected the nine numbers of a fundamental matrix, found 3"),
            ("1 2 3\n4 nan 6", "line 2: \"nan\" is not a finite number"),
            ("{\"score\": 1}", "no field \"fundamental\""),
            ("{\"fundamental\": 7}", "not a list of rows"),
            ("[[1, 2, \"x\"]]", "\"x\" is not a number"),
            ("[[1, 2", "not valid JSON"),
            ("1 1 1 1 1 1 1 1 1", "rank 1 or 0"),
            ("0 0 0 0 0 0 0 0 0", "rank 1 or 0"),
        ] {
            let message = read(content).unwrap_err();
            assert!(message.contains(words), "{words} in {message}");
        }
        assert!(read_fundamental(Path::new("no/such")).unwrap_err().to_string().contains("no such file"));
    }
}
