//! Table of all parameters of the estimators.

use serde_json::Value;

use super::ReportSubject;
use crate::publish::{Publication, TextTable};

pub(super) fn write(subject: &ReportSubject, document: &mut Publication) {
    // One column per set of numbers; methods share the numbers of a preset.
    let mut columns: Vec<(String, Vec<(String, String)>)> = Vec::new();
    for contender in subject.contenders {
        let Some(preset) = contender.preset() else { continue };
        let mut numbers = Vec::new();
        flatten("", &contender.parameters(), &mut numbers);
        numbers.retain(|(name, _)| name != "method");
        if !columns.iter().any(|(name, same)| name == preset && *same == numbers) {
            columns.push((preset.to_owned(), numbers));
        }
    }
    let Some((_, first)) = columns.first() else { return };
    let rows = first.iter().map(|(name, _)| {
        let value = |numbers: &[(String, String)]| {
            numbers.iter().find(|(n, _)| n == name).map_or_else(|| "-".to_owned(), |(_, value)| value.clone())
        };
        std::iter::once(name.clone()).chain(columns.iter().map(|(_, numbers)| value(numbers))).collect()
    });
    let table = TextTable {
        caption:
            "Parameters of the estimator by preset, with the names of the option --set. Angles are in radians."
                .to_owned(),
        headings: std::iter::once("parameter".to_owned())
            .chain(columns.iter().map(|(preset, _)| preset.clone()))
            .collect(),
        rows: rows.collect(),
        words: 1,
        ruled: Vec::new(),
    };
    document.section("Parameters");
    document.table(table);
}

/// Lists the leaves of a value, with nested names joined by dots.
fn flatten(name: &str, value: &Value, leaves: &mut Vec<(String, String)>) {
    match value {
        Value::Object(inner) => {
            for (key, value) in inner {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(&name, value, leaves);
            }
        }
        Value::String(text) => leaves.push((name.to_owned(), text.clone())),
        other => leaves.push((name.to_owned(), short(other))),
    }
}

/// Formats a number without the digits of its binary fraction.
fn short(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if value.is_f64() => {
            let text = format!("{number:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nested_names_are_joined_as_on_the_command_line() {
        let mut leaves = Vec::new();
        flatten(
            "",
            &json!({ "stereo": { "lambda": 400 }, "rotation": 0.123_456_7, "preset": "a" }),
            &mut leaves,
        );
        let told: Vec<_> = leaves.iter().map(|(n, v)| format!("{n}={v}")).collect();
        assert_eq!(told, ["preset=a", "rotation=0.1235", "stereo.lambda=400"]);
    }
}
