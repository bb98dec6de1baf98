//! OpenCV's `FileStorage` as XML, as the tree of values that the YAML of OpenCV gives.
//!
//! The root is `opencv_storage`. An element with elements is a mapping, or a list if they are all named `_`. An
//! element with text is a number, a list of numbers, or a text. The `data` of a matrix is always a list.

use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesRef, Event};
use serde_json::{Map, Value};

use super::quantity::insert;
use super::yaml::{DEEPEST, plain_scalar};
use crate::foreign::excerpt;
use crate::io::read::Problem;

/// Element that is not closed yet.
struct Open {
    name: String,
    items: Vec<Value>,
    fields: Map<String, Value>,
    text: String,
}

/// Returns whether a text is XML.
pub(in crate::io) fn is_xml(text: &str) -> bool {
    let inside = text.trim_start().strip_prefix('<');
    inside.is_some_and(|inside| inside.starts_with(|c: char| c.is_ascii_alphabetic() || "?!".contains(c)))
}

/// Parses a document.
pub(in crate::io) fn xml_value(text: &str) -> Result<Value, Problem> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<Open> = Vec::new();
    loop {
        let at = reader.buffer_position() as usize;
        let failed = |problem: String| {
            let before = text.get(..at).unwrap_or(text);
            Problem::at(before.matches('\n').count() + 1, problem)
        };
        let event = reader.read_event().map_err(|e| failed(format!("this is not valid XML: {e}")))?;
        match event {
            Event::Start(element) => {
                let name = String::from_utf8_lossy(element.name().as_ref()).into_owned();
                if open.is_empty() && name != "opencv_storage" {
                    return Err(failed(format!(
                        "this XML file was not written by OpenCV: it begins with <{}>, not with <opencv_storage>",
                        excerpt(&name)
                    )));
                }
                open.push(Open { name, items: Vec::new(), fields: Map::new(), text: String::new() });
                if open.len() > DEEPEST {
                    return Err(failed(format!("elements are nested more than {DEEPEST} levels deep")));
                }
            }
            Event::End(_) => {
                let Some(closed) = open.pop() else { break };
                let name = closed.name.clone();
                let value = closed.value().map_err(failed)?;
                match open.last_mut() {
                    None => return Ok(value),
                    Some(parent) if name == "_" => parent.items.push(value),
                    Some(parent) => insert(&mut parent.fields, name, value).map_err(failed)?,
                }
            }
            Event::Text(words) => {
                let words = words.decode().map_err(|e| failed(e.to_string()))?;
                open.iter_mut().last().into_iter().for_each(|element| element.text.push_str(&words));
            }
            Event::GeneralRef(entity) => {
                let character = character(&entity).ok_or_else(|| {
                    let name = String::from_utf8_lossy(&entity);
                    failed(format!("the entity &{}; is not known. Write the text out", excerpt(&name)))
                })?;
                open.iter_mut().last().into_iter().for_each(|element| element.text.push_str(&character));
            }
            Event::DocType(_) => return Err(failed("document types are not supported".into())),
            Event::Eof => break,
            Event::CData(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::Empty(_) => {}
        }
    }
    Err(Problem::whole("this XML file is empty or ends too early"))
}

impl Open {
    /// Returns the content of an element.
    fn value(self) -> Result<Value, String> {
        let Self { name, items, fields, text } = self;
        let text = text.trim();
        match (items.is_empty(), fields.is_empty(), text.is_empty()) {
            (true, true, _) => Ok(of_text(&name, text)),
            (true, false, true) => Ok(Value::Object(fields)),
            (false, true, true) => Ok(Value::Array(items)),
            _ => Err(format!("<{}> mixes texts, lists and names", excerpt(&name))),
        }
    }
}

/// Returns the content of an element without elements.
fn of_text(name: &str, text: &str) -> Value {
    if let Some(quoted) = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        return Value::String(quoted.to_owned());
    }
    let mut cells: Vec<Value> = text.split_whitespace().map(plain_scalar).collect();
    match cells.len() {
        _ if name == "data" => Value::Array(cells),
        1 => cells.remove(0),
        2.. if cells.iter().all(Value::is_number) => Value::Array(cells),
        _ => Value::String(text.to_owned()),
    }
}

fn character(entity: &BytesRef<'_>) -> Option<String> {
    match entity.resolve_char_ref().ok()? {
        Some(character) => Some(character.to_string()),
        None => resolve_predefined_entity(&entity.decode().ok()?).map(str::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn elements_become_mappings_lists_numbers_and_texts() {
        let text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- 1 -->\n<K1 type_id=\"opencv-matrix\">\n\
                    <rows>1</rows><cols>2</cols><dt>d</dt>\n<data>\n 1. -2.5e-07</data></K1>\n<n>640</n>\
                    <size>640 480</size><model>\"a &lt; b\"</model><list><_>1</_><_><a>x y</a></_></list>\
                    <one><rows>1</rows><data>3</data></one><none/></opencv_storage>\n";
        assert_eq!(
            xml_value(text).unwrap(),
            json!({
                "K1": {"rows": 1, "cols": 2, "dt": "d", "data": [1.0, -2.5e-7]},
                "n": 640, "size": [640, 480], "model": "a < b",
                "list": [1, {"a": "x y"}],
                "one": {"rows": 1, "data": [3]}, "none": "",
            })
        );
    }

    #[test]
    fn other_documents_are_refused_with_a_sentence() {
        for (text, words) in [
            ("<html><body/></html>", "not written by OpenCV"),
            ("<opencv_storage><F>", "ends too early"),
            ("<opencv_storage><F>1</G></opencv_storage>", "not valid XML"),
            ("<opencv_storage><F>1<_>2</_></F></opencv_storage>", "mixes"),
            ("<opencv_storage><F>&x;</F></opencv_storage>", "entity &x;"),
            ("<!DOCTYPE a><opencv_storage></opencv_storage>", "document types"),
            ("<opencv_storage><F>1 2</F><F>1 3</F></opencv_storage>", "occurs twice"),
        ] {
            let problem = xml_value(text).unwrap_err().to_string();
            assert!(problem.contains(words), "{problem}");
        }
        let deep = format!("<opencv_storage>{}", "<a>".repeat(100_000));
        assert!(xml_value(&deep).unwrap_err().to_string().contains("levels deep"));
    }
}
