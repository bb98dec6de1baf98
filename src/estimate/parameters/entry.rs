//! Entry of the table of parameters, with its check.

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
    /// A number. Values outside the range are refused if that is `enforced`; otherwise the range only limits
    /// dragging.
    Number { range: [f64; 2], enforced: bool, get: fn(&Parameters) -> f64, set: fn(&mut Parameters, f64) },
    /// On or off.
    Switch { get: fn(&Parameters) -> bool, set: fn(&mut Parameters, bool) },
    /// One of a few choices, by number.
    Choice { get: fn(&Parameters) -> usize, set: fn(&mut Parameters, usize) },
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
        let ParameterValue::Number { range, enforced: true, get, .. } = self.value else {
            return Ok(());
        };
        let value = get(parameters);
        if value >= range[0] && value <= range[1] {
            return Ok(());
        }
        Err(EstimateError::Parameter { key: self.key, value, range, unit: self.unit })
    }
}
