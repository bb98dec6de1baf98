//! YAML as a tree of values.
//!
//! OpenCV up to version 4 writes the first line `%YAML:1.0`, and so does Kalibr. The line is not
//! YAML and is removed before parsing.

use saphyr_parser::{Event, Parser, ScalarStyle};
use serde_json::{Map, Value};

use super::quantity::insert;
use crate::io::read::Problem;

/// Maximum depth of nested lists. Matrices need three.
pub(in crate::io) const DEEPEST: usize = 32;

pub(in crate::io) const NOT_YAML: &str = "this is not valid YAML";

/// List or mapping that is not closed yet.
enum Open {
    List(Vec<Value>),
    Mapping(Map<String, Value>, Option<String>),
}

/// Parses the first document. Numbers stay numbers; everything else becomes text. Aliases are
/// refused, because they can grow without bounds.
pub(in crate::io) fn yaml_value(text: &str) -> Result<Value, Problem> {
    let text = text.trim_start();
    // Keeps the line break of the first line, so that line numbers stay correct.
    let text = if text.starts_with("%YAML") { text.find('\n').map_or("", |end| &text[end..]) } else { text };
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) =
            event.map_err(|e| Problem::at(e.marker().line(), format!("{NOT_YAML}: {}", e.info())))?;
        let line = span.start.line();
        let complete = match event {
            Event::SequenceStart(..) => {
                open.push(Open::List(Vec::new()));
                None
            }
            Event::MappingStart(..) => {
                open.push(Open::Mapping(Map::new(), None));
                None
            }
            Event::SequenceEnd | Event::MappingEnd => open.pop().map(|closed| match closed {
                Open::List(items) => Value::Array(items),
                Open::Mapping(items, _) => Value::Object(items),
            }),
            Event::Scalar(text, ScalarStyle::Plain, ..) => Some(plain_scalar(&text)),
            Event::Scalar(text, ..) => Some(Value::String(text.into_owned())),
            Event::Alias(_) => {
                return Err(Problem::at(line, "aliases (*name) are not supported. Write the numbers out"));
            }
            Event::DocumentEnd | Event::StreamEnd => break,
            Event::Nothing | Event::StreamStart | Event::DocumentStart(_) => None,
        };
        if open.len() > DEEPEST {
            return Err(Problem::at(line, format!("lists are nested more than {DEEPEST} levels deep")));
        }
        let Some(complete) = complete else { continue };
        match open.last_mut() {
            None => return Ok(complete),
            Some(Open::List(items)) => items.push(complete),
            Some(Open::Mapping(items, key)) => match (key.take(), complete) {
                (Some(key), value) => {
                    insert(items, key, value).map_err(|e| Problem::at(line, e))?;
                }
                (None, Value::String(name)) => *key = Some(name),
                (None, other) => *key = Some(other.to_string()),
            },
        }
    }
    Err(Problem::whole("this YAML file is empty or ends too early"))
}

/// Returns a number, or a text.
pub(in crate::io) fn plain_scalar(text: &str) -> Value {
    // Integers are counts. A number that is not finite stays text, for the error message.
    let whole = text.parse::<u64>().ok().map(Value::from);
    let number = || text.parse().ok().and_then(serde_json::Number::from_f64).map(Value::Number);
    whole.or_else(number).unwrap_or_else(|| Value::String(text.to_owned()))
}
