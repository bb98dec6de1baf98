//! What the table says of a parameter, and what follows from that: its check, and its range in words.

use std::f64::consts::PI;

use super::{Parameters, Preset};
use crate::estimate::{EstimateError, Stage};

/// A parameter as a person sets it.
pub struct ParameterEntry {
    /// Name in files and on the command line; `outer.inner` when it is nested.
    pub key: &'static str,
    /// The step of the algorithm it belongs to.
    pub stage: Stage,
    /// What it is called in the window.
    pub name: &'static str,
    /// Sentence about it.
    pub tooltip: &'static str,
    /// What kind of value it has.
    pub value: ParameterValue,
}

/// How a parameter is shown and changed.
pub enum ParameterValue {
    /// A number.
    Number {
        /// The unit it is shown in, with the space before it.
        unit: &'static str,
        /// Value in files for one of that unit: `π/180` for an angle shown in degrees.
        of_unit: f64,
        /// Values that make sense, as in files.
        range: [f64; 2],
        /// Whether other values are refused; else the range is what a drag reaches.
        enforced: bool,
        /// Decimals shown.
        decimals: usize,
        /// Reads it, as in files.
        get: fn(&Parameters) -> f64,
        /// Sets it, as in files.
        set: fn(&mut Parameters, f64),
    },
    /// Something that is on or off.
    Switch {
        /// Reads it.
        get: fn(&Parameters) -> bool,
        /// Sets it.
        set: fn(&mut Parameters, bool),
    },
    /// A choice among a few.
    Choice {
        /// Names of the choices.
        names: &'static [&'static str],
        /// Reads which one it is.
        get: fn(&Parameters) -> usize,
        /// Sets it.
        set: fn(&mut Parameters, usize),
    },
}

impl ParameterEntry {
    pub(super) const fn in_degrees(mut self) -> Self {
        if let ParameterValue::Number { of_unit, .. } = &mut self.value {
            *of_unit = PI / 180.0;
        }
        self
    }

    pub(super) const fn for_dragging(mut self) -> Self {
        if let ParameterValue::Number { enforced, .. } = &mut self.value {
            *enforced = false;
        }
        self
    }

    /// Whether two sets of parameters have the same value here.
    pub fn is_same(&self, a: &Parameters, b: &Parameters) -> bool {
        match self.value {
            ParameterValue::Number { get, .. } => get(a).to_bits() == get(b).to_bits(),
            ParameterValue::Switch { get, .. } => get(a) == get(b),
            ParameterValue::Choice { get, .. } => get(a) == get(b),
        }
    }

    /// Gives `to` the value that `from` has here.
    pub fn copy(&self, from: &Parameters, to: &mut Parameters) {
        match self.value {
            ParameterValue::Number { get, set, .. } => set(to, get(from)),
            ParameterValue::Switch { get, set } => set(to, get(from)),
            ParameterValue::Choice { get, set, .. } => set(to, get(from)),
        }
    }

    /// An error when the value these parameters have here is out of its range, or no number.
    pub fn check(&self, parameters: &Parameters) -> Result<(), EstimateError> {
        let ParameterValue::Number { unit, range: [least, most], enforced: true, get, .. } = self.value
        else {
            return Ok(());
        };
        let value = get(parameters);
        if value >= least && value <= most {
            return Ok(());
        }
        // What is shown in another unit than in files has none there.
        let unit = if self.is_converted() { "" } else { unit };
        Err(EstimateError::Parameter {
            name: self.key.replace('_', " "),
            value: value.to_string(),
            allowed: format!("between {} and {}{unit}", in_words(least), in_words(most)),
        })
    }

    /// What is wrong with the value these parameters have here, if something is: a sentence in the units of the window.
    pub fn problem(&self, parameters: &Parameters) -> Option<String> {
        self.check(parameters).err()?;
        let range = self.shown_range_text()?;
        Some(format!("{} must be between {range}.", self.name))
    }

    /// What it may be and what it is when nobody changed it, as the user reads it.
    pub fn range_text(&self, preset: Preset) -> String {
        let default = self.default_text(preset);
        match self.shown_range() {
            Some([least, most]) => {
                let unit = self.unit();
                format!("From {least} to {most}{unit}, by default {default}.")
            }
            None => format!("By default {default}."),
        }
    }

    /// What it is in a preset, as the user reads it.
    pub fn default_text(&self, preset: Preset) -> String {
        let defaults = Parameters::from(preset);
        match self.value {
            ParameterValue::Number { unit, of_unit, decimals, get, .. } => {
                format!("{:.decimals$}{unit}", get(&defaults) / of_unit)
            }
            ParameterValue::Switch { get, .. } => if get(&defaults) { "on" } else { "off" }.to_owned(),
            ParameterValue::Choice { names, get, .. } => names[get(&defaults)].to_owned(),
        }
    }

    /// The range of a number in the unit it is shown in.
    pub fn shown_range(&self) -> Option<[f64; 2]> {
        match self.value {
            ParameterValue::Number { of_unit, range, .. } => Some(range.map(|end| end / of_unit)),
            _ => None,
        }
    }

    /// Whether it is shown in another unit than it has in files.
    pub fn is_converted(&self) -> bool {
        matches!(self.value, ParameterValue::Number { of_unit, .. } if of_unit.to_bits() != 1f64.to_bits())
    }

    fn shown_range_text(&self) -> Option<String> {
        let [least, most] = self.shown_range()?;
        Some(format!("{least} and {most}{}", self.unit()))
    }

    pub(super) fn unit(&self) -> &'static str {
        match self.value {
            ParameterValue::Number { unit, .. } => unit,
            _ => "",
        }
    }
}

/// A number as in sentences: thousands apart, π by its name.
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
    fn numbers_in_sentences() {
        assert_eq!([0.005, 60.0, 1000.0, 1e6, PI].map(in_words), ["0.005", "60", "1,000", "1,000,000", "π"]);
    }
}
