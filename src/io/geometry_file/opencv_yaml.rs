//! OpenCV `FileStorage` as YAML.
//!
//! Other YAML with the same names (nested rows, for example) is read as well.

use std::fmt::Write;

use super::coordinates::{NamedTable, WrittenGeometry, numbers, one_line};
use super::fields::Fields;
use super::{Format, ImageNote, Problem, views};
use crate::io::values::yaml_value;

pub(super) fn write(written: &WrittenGeometry) -> String {
    debug_assert_eq!(written.format, Format::OpencvYaml);
    let mut text = String::from("%YAML:1.0\n---\n");
    for line in written.preamble() {
        let _ = writeln!(text, "# {line}");
    }
    for (k, image) in written.images.iter().flat_map(|i| i.iter()).enumerate() {
        text.push_str(&image_map(k + 1, image));
    }
    text += &views::as_yaml(written.pictures);
    for table in written.tables() {
        text.push_str(&matrix_map(&table));
    }
    if let Some(check) = written.check {
        let distances = numbers(&[check.mean, check.max], "\n   max_distance: ");
        let _ = write!(text, "self_check:\n   pairs: {}\n   mean_distance: {distances}\n", check.pairs);
    }
    if let Some(trust) = written.trust {
        let (geometry, verdict) = (quoted(&trust.geometry), quoted(&trust.verdict));
        let _ = writeln!(text, "geometry: {geometry}\nverdict: {verdict}");
    }
    for (name, words) in written.words() {
        let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
        let _ = writeln!(text, "{name}: [ {} ]", words.join(",\n   "));
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", one_line(text).replace('\\', "\\\\").replace('"', "\\\""))
}

fn matrix_map(table: &NamedTable) -> String {
    let NamedTable { quantity, columns, values } = table;
    let lines: Vec<_> = values.chunks(3.max(*columns)).map(|c| numbers(c, ", ")).collect();
    format!(
        "# {}\n{}: !!opencv-matrix\n   rows: {}\n   cols: {columns}\n   dt: d\n   data: [ {} ]\n",
        quantity.meaning(),
        quantity.symbol(),
        values.len() / columns,
        lines.join(",\n       ")
    )
}

fn image_map(number: usize, image: &ImageNote) -> String {
    let name = quoted(&image.name);
    let frame = image.frame;
    format!("image{number}:\n   name: {name}\n   width: {}\n   height: {}\n", frame.width, frame.height)
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    Fields::from_value(&yaml_value(text)?)
}
