//! OpenCV `FileStorage` as XML.

use std::fmt::Write;

use roxmltree::{Document, Node, ParsingOptions};
use serde_json::{Map, Value};

use super::coordinates::{NamedTable, WrittenGeometry, numbers, one_line};
use super::fields::{Fields, insert};
use super::{Format, ImageNote, Problem};

/// Levels of elements in elements. Matrices need three.
const DEEPEST: usize = 32;
/// Elements, attributes and texts of a file; numbers are none.
const MOST_NODES: u32 = 1_000_000;

pub(super) fn write(written: &WrittenGeometry) -> String {
    debug_assert_eq!(written.format, Format::OpencvXml);
    let mut text = String::from("<?xml version=\"1.0\"?>\n<opencv_storage>\n");
    for line in written.preamble() {
        let _ = writeln!(text, "<!-- {line} -->");
    }
    for (k, image) in written.images.iter().flat_map(|i| i.iter()).enumerate() {
        text.push_str(&image_element(k + 1, image));
    }
    for table in written.tables() {
        text.push_str(&matrix_element(&table));
    }
    if let Some(check) = written.check {
        let distances = numbers(&[check.mean, check.max], "</mean_distance>\n  <max_distance>");
        let _ = write!(
            text,
            "<self_check>\n  <pairs>{}</pairs>\n  <mean_distance>{distances}</max_distance></self_check>\n",
            check.pairs
        );
    }
    text.push_str("</opencv_storage>\n");
    text
}

fn matrix_element(table: &NamedTable) -> String {
    let NamedTable { quantity, columns, values } = table;
    let name = quantity.symbol();
    let lines: Vec<_> = values.chunks(3.max(*columns)).map(|c| numbers(c, " ")).collect();
    format!(
        "<!-- {} -->\n<{name} type_id=\"opencv-matrix\">\n  <rows>{}</rows>\n  <cols>{columns}</cols>\n  <dt>d</dt>\n  <data>\n    {}</data></{name}>\n",
        quantity.meaning(),
        values.len() / columns,
        lines.join("\n    ")
    )
}

fn image_element(number: usize, image: &ImageNote) -> String {
    // Inside the quotes OpenCV keeps spaces; it knows these five names.
    let name = one_line(&image.name)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&apos;");
    let frame = image.frame;
    format!(
        "<image{number}>\n  <name>\"{name}\"</name>\n  <width>{}</width>\n  <height>{}</height></image{number}>\n",
        frame.width, frame.height
    )
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| Problem::at(e.pos().row as usize, format!("this is not valid XML: {e}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        let found = super::fields::shortened(root.tag_name().name());
        return Err(Problem::whole(format!("expected the element opencv_storage, found {found}")));
    }
    match value(root, 0)? {
        Value::String(_) => Fields::from_value(&Value::Object(Map::new())),
        fields => Fields::from_value(&fields),
    }
}

/// Elements with elements in them are objects, or lists if those are called `_`; others are texts.
fn value(node: Node, depth: usize) -> Result<Value, Problem> {
    if depth > DEEPEST {
        return Err(Problem::whole(format!("elements are nested more than {DEEPEST} deep")));
    }
    let mut children = node.children().filter(Node::is_element).peekable();
    match children.peek().map(|first| first.tag_name().name()) {
        None => {
            let text: String = node.children().filter_map(|child| child.text()).collect();
            let text = text.trim();
            let inside = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
            Ok(Value::String(inside.unwrap_or(text).to_owned()))
        }
        Some("_") => Ok(Value::Array(children.map(|c| value(c, depth + 1)).collect::<Result<_, _>>()?)),
        Some(_) => {
            let mut fields = Map::new();
            for child in children {
                let name = child.tag_name().name().to_owned();
                insert(&mut fields, name, value(child, depth + 1)?).map_err(Problem::whole)?;
            }
            Ok(Value::Object(fields))
        }
    }
}
