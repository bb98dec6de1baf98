//! Entry of the table of parameters, with its check.

use std::f64::consts::PI;

use super::Parameters;
use crate::estimate::{EstimateError, Stage};

/// A parameter that a person can set.
pub struct ParameterEntry {
    /// Name in files and on the command line; `outer.inner` if nested.
    pub key: &'static str,
    /// Stage of the algorithm to which the parameter belongs.
    pub stage: Stage,
    /// Unit of a number, with a space before it. Angles are in radians and have no unit.
    pub unit: &'static str,
    /// Whether the window hides the parameter.
    pub is_expert: bool,
    /// Kind of value.
    pub value: ParameterValue,
}

/// Kind of value of a parameter, with functions to read and set the value.
pub enum ParameterValue {
    /// Number.
    Number {
        /// Smallest and largest value.
        range: [f64; 2],
        /// Whether values outside the range are refused. Otherwise, the range only limits dragging.
        enforced: bool,
        /// Reads it.
        get: fn(&Parameters) -> f64,
        /// Sets it.
        set: fn(&mut Parameters, f64),
    },
    /// On or off.
    Switch {
        /// Reads it.
        get: fn(&Parameters) -> bool,
        /// Sets it.
        set: fn(&mut Parameters, bool),
    },
    /// One of a few choices, by number.
    Choice {
        /// Reads it.
        get: fn(&Parameters) -> usize,
        /// Sets it.
        set: fn(&mut Parameters, usize),
    },
}

impl ParameterEntry {
    pub(super) const fn for_experts(mut self) -> Self {
        self.is_expert = true;
        self
    }

    pub(super) const fn for_dragging(mut self) -> Self {
        if let ParameterValue::Number { enforced, .. } = &mut self.value {
            *enforced = false;
        }
        self
    }

    /// Returns whether two sets of parameters have the same value here.
    pub fn is_same(&self, a: &Parameters, b: &Parameters) -> bool {
        match self.value {
            ParameterValue::Number { get, .. } => get(a).to_bits() == get(b).to_bits(),
            ParameterValue::Switch { get, .. } => get(a) == get(b),
            ParameterValue::Choice { get, .. } => get(a) == get(b),
        }
    }

    /// Copies the value of this parameter from `from` to `to`.
    pub fn copy(&self, from: &Parameters, to: &mut Parameters) {
        match self.value {
            ParameterValue::Number { get, set, .. } => set(to, get(from)),
            ParameterValue::Switch { get, set } => set(to, get(from)),
            ParameterValue::Choice { get, set, .. } => set(to, get(from)),
        }
    }

    /// Checks that the value is a number within its range.
    pub fn check(&self, parameters: &Parameters) -> Result<(), EstimateError> {
        let ParameterValue::Number { range: [least, most], enforced: true, get, .. } = self.value else {
            return Ok(());
        };
        let value = get(parameters);
        if value >= least && value <= most {
            return Ok(());
        }
        Err(EstimateError::Parameter {
            name: self.key.replace('_', " "),
            value: value.to_string(),
            allowed: format!("between {} and {}{}", in_words(least), in_words(most), self.unit),
        })
    }
}

/// Formats a number for sentences: with commas between thousands, and π by name.
fn in_words(value: f64) -> String {
    if value.to_bits() == PI.to_bits() {
        return "π".to_owned();
    }
    let plain = value.to_string();
    let digits = plain.find('.').unwrap_or(plain.len());
    let mut text = String::new();
    for (k, character) in plain.chars().enumerate() {
        if k > 0 && k < digits && (digits - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(character);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted_for_sentences() {
        assert_eq!([0.005, 60.0, 1000.0, 1e6, PI].map(in_words), ["0.005", "60", "1,000", "1,000,000", "π"]);
    }
}
