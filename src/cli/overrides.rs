//! Overrides of single parameters of the estimator.

use clap::Args;
use serde_json::Value;

use super::CliError;
use crate::estimate::{Parameters, Preset};

/// Options that change parameters of a preset.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Overrides {
    /// Refine F at full resolution on patches matched along the epipolar lines; on in the preset
    /// robust, off in paper
    #[arg(long, value_name = "true|false", num_args = 0..=1, default_missing_value = "true",
        require_equals = true)]
    refine: Option<bool>,
    /// Set one parameter of the estimator, with its name under "parameters" in result files;
    /// repeatable
    #[arg(long = "set", value_name = "NAME=VALUE", help_heading = "Advanced")]
    set: Vec<String>,
}

impl Overrides {
    /// Returns whether no parameter is changed.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the parameters of a preset with the overrides applied.
    ///
    /// The overrides act on the serialised parameters. Every parameter can be changed by its name,
    /// nested ones as `outer.inner`, without code for each.
    pub fn parameters(&self, preset: Preset) -> Result<Parameters, CliError> {
        let mut parameters = Parameters::from(preset);
        if let Some(refine) = self.refine {
            parameters.refinement.refine = refine;
        }
        for assignment in &self.set {
            parameters = with_parameter(&parameters, assignment)
                .map_err(|problem| CliError::Arguments(format!("--set {assignment}: {problem}")))?;
        }
        Ok(parameters)
    }
}

/// Returns parameters with one of them changed: `NAME=VALUE`, the value in JSON.
///
/// # Errors
/// A clause for the user.
pub fn with_parameter(parameters: &Parameters, assignment: &str) -> Result<Parameters, String> {
    let (name, text) = assignment.split_once('=').ok_or("expected NAME=VALUE")?;
    if matches!(name, "preset" | "method") {
        return Err(format!("use --{name}"));
    }
    let mut data = serde_json::to_value(parameters).map_err(|e| e.to_string())?;
    let mut place = &mut data;
    for part in name.split('.') {
        let known = place.as_object().map(|o| o.keys().cloned().collect::<Vec<_>>().join(", "));
        let choose = known.map_or_else(String::new, |known| format!(". Choose one of {known}"));
        place = place.get_mut(part).ok_or_else(|| format!("there is no parameter {name}{choose}"))?;
    }
    // Text that is not valid JSON is a plain string.
    *place = serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned()));
    serde_json::from_value(data).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(set: &[&str]) -> Result<Parameters, String> {
        let set = set.iter().map(|s| (*s).to_owned()).collect();
        Overrides { set, refine: None }.parameters(Preset::Robust).map_err(|e| e.to_string())
    }

    #[test]
    fn refinement_is_switched_by_its_own_option() {
        let refine = |refine, preset| {
            Overrides { refine, ..Overrides::default() }.parameters(preset).unwrap().refinement.refine
        };
        assert!(refine(None, Preset::Robust) && !refine(None, Preset::Paper));
        assert!(!refine(Some(false), Preset::Robust) && refine(Some(true), Preset::Paper));
    }

    #[test]
    fn changes_what_is_named_and_nothing_else() {
        let expected = Parameters { seed: 7, ..Parameters::from(Preset::Robust) };
        assert_eq!(with(&["seed=7"]).unwrap(), expected);
        assert_eq!(with(&[]).unwrap(), Parameters::from(Preset::Robust));
    }

    #[test]
    fn refuses_unknown_names_and_wrong_kinds() {
        assert!(with(&["sed=7"]).unwrap_err().contains("there is no parameter sed. Choose one of"));
        assert!(with(&["seed.x=7"]).unwrap_err().ends_with("there is no parameter seed.x"));
        assert!(with(&["seed=many"]).unwrap_err().starts_with("--set seed=many: "));
        assert!(with(&["seed"]).unwrap_err().contains("expected NAME=VALUE"));
        assert!(with(&["preset=paper"]).unwrap_err().contains("use --preset"));
    }
}
