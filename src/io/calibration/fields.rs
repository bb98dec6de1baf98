//! Numbers and words of a calibration, with their names.

use serde_json::{Map, Value};

use super::super::number::finite_number;
use super::names::{Meaning, meaning, setting};

/// Content of a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// Numbers of a list or of a matrix, row by row.
    List(Vec<f64>),
    Number(f64),
    Word(String),
    /// Content that cannot be read, with the reason.
    Broken(String),
}

/// A named content.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// Names of the sections and the own name.
    pub path: Vec<String>,
    pub content: Content,
    pub meaning: Meaning,
}

/// Keys of a matrix of OpenCV, ROS or JSON.
const MATRIX_KEYS: [&str; 11] =
    ["rows", "cols", "dt", "data", "type_id", "channels", "shape", "dtype", "layout", "dims", "type"];

/// Returns all fields of a tree.
pub(super) fn fields(root: &Value) -> Vec<Field> {
    let mut found = Vec::new();
    collect(root, &mut Vec::new(), &mut found);
    found
}

impl Field {
    fn new(path: &[String], content: Content) -> Self {
        let names: Vec<&str> = path.iter().map(String::as_str).collect();
        let count = match &content {
            Content::List(numbers) => Some(numbers.len()),
            Content::Broken(_) => Some(0),
            _ => None,
        };
        Self { path: path.to_vec(), content, meaning: meaning(&names, count) }
    }

    /// Returns the name as a person wrote it.
    pub fn name(&self) -> String {
        self.path.join(".")
    }

    /// Returns the names of the sections.
    pub fn section(&self) -> &[String] {
        self.path.split_last().map_or(&[], |(_, section)| section)
    }

    /// Returns the numbers of a list or of a single number; empty for words.
    pub fn numbers(&self) -> &[f64] {
        match &self.content {
            Content::List(numbers) => numbers,
            Content::Number(number) => std::slice::from_ref(number),
            _ => &[],
        }
    }

    /// Returns the words of the sections that tell a camera.
    pub fn section_camera(&self) -> Vec<String> {
        let mut path = self.section().to_vec();
        path.push(String::new());
        setting(&path).1
    }

    /// Returns the name of a setting, without the words for the camera, and these words.
    pub fn setting(&self) -> (String, Vec<String>) {
        setting(&self.path)
    }
}

fn collect(value: &Value, path: &mut Vec<String>, found: &mut Vec<Field>) {
    match value {
        Value::Object(object) if is_matrix(object) => found.push(Field::new(path, matrix(object))),
        Value::Object(object) => {
            for (name, value) in object {
                // ORB-SLAM writes LEFT.K, ROS narrow_stereo/left.
                let before = path.len();
                path.extend(name.split(['.', '/']).filter(|part| !part.is_empty()).map(str::to_owned));
                if path.len() == before {
                    path.push(name.clone());
                }
                collect(value, path, found);
                path.truncate(before);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            for (k, item) in items.iter().enumerate() {
                path.push(k.to_string());
                collect(item, path, found);
                path.pop();
            }
        }
        Value::Array(_) => {
            let mut numbers = Vec::new();
            let content = match flat(value, &mut numbers) {
                Ok(()) => Content::List(numbers),
                Err(problem) => Content::Broken(problem),
            };
            found.push(Field::new(path, content));
        }
        Value::Number(number) => {
            found.push(Field::new(path, Content::Number(number.as_f64().unwrap_or(f64::NAN))));
        }
        Value::Bool(set) => found.push(Field::new(path, Content::Word(set.to_string()))),
        Value::String(word) => {
            let content = finite_number(word).map_or_else(|_| Content::Word(word.clone()), Content::Number);
            found.push(Field::new(path, content));
        }
        Value::Null => {}
    }
}

fn is_matrix(object: &Map<String, Value>) -> bool {
    object.get("data").is_some_and(|data| data.is_array() || data.is_number())
        && object.keys().all(|key| MATRIX_KEYS.contains(&key.as_str()))
}

/// Reads a matrix, whose number of rows and columns must agree with its numbers.
fn matrix(object: &Map<String, Value>) -> Content {
    let mut numbers = Vec::new();
    if let Err(problem) = flat(&object["data"], &mut numbers) {
        return Content::Broken(problem);
    }
    let side = |name: &str| object.get(name).and_then(Value::as_u64);
    if let (Some(rows), Some(columns)) = (side("rows"), side("cols"))
        && rows.checked_mul(columns) != Some(numbers.len() as u64)
    {
        return Content::Broken(format!("expected {rows}×{columns} numbers, found {}", numbers.len()));
    }
    Content::List(numbers)
}

fn flat(value: &Value, numbers: &mut Vec<f64>) -> Result<(), String> {
    match value {
        Value::Array(items) => items.iter().try_for_each(|item| flat(item, numbers)),
        Value::Number(number) => {
            numbers.push(number.as_f64().unwrap_or(f64::NAN));
            Ok(())
        }
        Value::String(word) => {
            numbers.push(finite_number(word)?);
            Ok(())
        }
        _ => Err("expected numbers".into()),
    }
}
