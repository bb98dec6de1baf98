//! Tests of the table of parameters.

use super::*;

#[test]
fn every_number_is_allowed_at_both_ends_of_its_range_and_kept() {
    for entry in &PARAMETERS {
        let ParameterValue::Number { range, get, set, .. } = entry.value else { continue };
        for end in range {
            let mut parameters = Parameters::default();
            set(&mut parameters, end);
            assert!((get(&parameters) - end).abs() < 1e-9, "{}", entry.name);
            assert_eq!(entry.problem(&parameters), None, "{}", entry.name);
        }
    }
}

#[test]
fn a_value_out_of_range_is_told_at_its_entry_alone() {
    let mut parameters = Parameters::default();
    parameters.pencils.line_spacing = 100.0;
    let wrong: Vec<_> = PARAMETERS.iter().filter(|entry| entry.problem(&parameters).is_some()).collect();
    assert_eq!(wrong.iter().map(|entry| entry.name).collect::<Vec<_>>(), ["Line spacing"]);
    assert!(wrong[0].problem(&parameters).unwrap().contains("between 0.5 and 16 px"));
    assert!(PARAMETERS[2].range_text(Preset::Robust).starts_with("From 0 to 180°, by default 45°"));
}

#[test]
fn copying_every_entry_carries_all_parameters_but_preset_and_method() {
    let from = Parameters::from(Preset::Paper);
    let mut to = Parameters::from(Preset::Robust);
    assert!(PARAMETERS.iter().any(|entry| !entry.is_same(&from, &to)));
    for entry in &PARAMETERS {
        entry.copy(&from, &mut to);
        assert!(entry.is_same(&from, &to), "{}", entry.name);
    }
    assert_eq!(Parameters { preset: from.preset, ..to }, from);
}

#[test]
fn keys_are_those_of_files() {
    let data = serde_json::to_value(Parameters::default()).unwrap();
    for entry in &PARAMETERS {
        let place = format!("/{}", entry.key.replace('.', "/"));
        assert!(data.pointer(&place).is_some(), "{}", entry.key);
    }
}

#[test]
fn the_document_has_the_table_as_it_is() {
    let document = include_str!("../../../docs/parameters.md");
    let table = parameters_as_markdown();
    assert!(document.ends_with(&table), "the table of docs/parameters.md should be:\n{table}");
}
