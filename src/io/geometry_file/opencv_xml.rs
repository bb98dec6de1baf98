//! OpenCV `FileStorage` as XML.

use std::fmt::Write;

use serde_json::{Map, Value};

use super::coordinates::{NamedTable, WrittenGeometry, numbers, one_line};
use super::fields::Fields;
use super::{Format, ImageNote, Problem, xml};
use crate::foreign::excerpt;

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
    if let Some(trust) = written.trust {
        let _ = writeln!(text, "<verdict>{}</verdict>", quoted(&trust.verdict));
    }
    for (name, words) in written.words() {
        let words: Vec<_> = words.iter().map(|word| format!("\n  <_>{}</_>", quoted(word))).collect();
        let _ = writeln!(text, "<{name}>{}</{name}>", words.join(""));
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

/// Inside the quotes OpenCV keeps spaces; it knows these five names.
fn quoted(text: &str) -> String {
    let text = one_line(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&apos;");
    format!("\"{text}\"")
}

fn image_element(number: usize, image: &ImageNote) -> String {
    let name = quoted(&image.name);
    let frame = image.frame;
    format!(
        "<image{number}>\n  <name>{name}</name>\n  <width>{}</width>\n  <height>{}</height></image{number}>\n",
        frame.width, frame.height
    )
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    let (name, value) = xml::parse(text)?;
    if name != "opencv_storage" {
        return Err(Problem::whole(format!("expected the element opencv_storage, found {}", excerpt(name))));
    }
    match value {
        Value::String(_) => Fields::from_value(&Value::Object(Map::new())),
        fields => Fields::from_value(&fields),
    }
}
