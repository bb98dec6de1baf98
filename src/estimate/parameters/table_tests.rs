//! Tests of the table of parameters.

use super::*;
use crate::estimate::Preset;

#[test]
fn both_ends_of_every_range_are_allowed_and_kept() {
    for entry in &PARAMETERS {
        let ParameterValue::Number { range, get, set, .. } = entry.value else { continue };
        for end in range {
            let mut parameters = Parameters::default();
            set(&mut parameters, end);
            assert!((get(&parameters) - end).abs() < 1e-9, "{}", entry.key);
            assert_eq!(entry.check(&parameters), Ok(()), "{}", entry.key);
        }
    }
}

#[test]
fn costs_that_make_the_comparison_of_all_lines_slow_are_refused() {
    let check = |method, lambda, alpha| {
        let mut parameters = Parameters { method, ..Parameters::default() };
        (parameters.similarity.stereo.lambda, parameters.similarity.stereo.alpha) = (lambda, alpha);
        parameters.check()
    };
    for (lambda, alpha) in [(0, 20_000), (100, 8100), (400, 2000)] {
        assert_eq!(check(Method::LinesAlone, lambda, alpha), Ok(()));
    }
    let refused = Err(EstimateError::ManyChanges { alpha: 8101, times: MOST_TIMES });
    assert_eq!(check(Method::LinesAlone, 100, 8101), refused);
    assert_eq!(check(Method::TwoPoint, 1, 20_000), Ok(()));
}

#[test]
fn copying_every_entry_carries_all_parameters_but_preset_and_method() {
    let from = Parameters::from(Preset::Paper);
    let mut to = Parameters::from(Preset::Robust);
    assert!(PARAMETERS.iter().any(|entry| !entry.is_same(&from, &to)));
    for entry in &PARAMETERS {
        entry.copy(&from, &mut to);
        assert!(entry.is_same(&from, &to), "{}", entry.key);
    }
    assert_eq!(Parameters { preset: from.preset, ..to }, from);
}

#[test]
fn keys_are_the_keys_in_files() {
    let data = serde_json::to_value(Parameters::default()).unwrap();
    for entry in &PARAMETERS {
        let place = format!("/{}", entry.key.replace('.', "/"));
        assert!(data.pointer(&place).is_some(), "{}", entry.key);
    }
}
