//! The parameters of the estimate as a person sets them: each with its step, name, unit, and how to read and
//! change it. Ranges are those of [`Parameters::check`], which also says in a sentence what is wrong.

use crate::estimate::{LineScore, Parameters, Stage};
use crate::similarity::Ordering;

/// A parameter.
pub struct Setting {
    /// The step of the algorithm it belongs to.
    pub stage: Stage,
    /// What it is called.
    pub name: &'static str,
    /// One sentence about it.
    pub tooltip: &'static str,
    /// What kind of value it has.
    pub value: Value,
}

/// How a parameter is shown and changed.
pub enum Value {
    /// A number.
    Number {
        /// Its unit, with the space before it.
        unit: &'static str,
        /// Values that a drag reaches, in that unit.
        range: [f64; 2],
        /// Decimals shown.
        decimals: usize,
        /// Reads it, in its unit.
        get: fn(&Parameters) -> f64,
        /// Sets it, in its unit.
        set: fn(&mut Parameters, f64),
    },
    /// Something that is on or off.
    Switch {
        /// Reads it.
        get: fn(&Parameters) -> bool,
        /// Sets it.
        set: fn(&mut Parameters, bool),
    },
    /// One of a few.
    Choice {
        /// Their names.
        names: &'static [&'static str],
        /// Reads which one it is.
        get: fn(&Parameters) -> usize,
        /// Sets it.
        set: fn(&mut Parameters, usize),
    },
}

const ORDERINGS: [Ordering; 3] = [Ordering::Positions, Ordering::Free, Ordering::Disparities];
const LINE_SCORES: [LineScore; 2] = [LineScore::Cost, LineScore::AgainstMismatched];

const fn number(
    (stage, name, unit, tooltip): (Stage, &'static str, &'static str, &'static str),
    range: [f64; 2],
    decimals: usize,
    get: fn(&Parameters) -> f64,
    set: fn(&mut Parameters, f64),
) -> Setting {
    Setting { stage, name, tooltip, value: Value::Number { unit, range, decimals, get, set } }
}

/// All of them, in the order of the steps.
pub const SETTINGS: [Setting; 23] = [
    number(
        (Stage::Pyramid, "Coarse size", " px", "Longer side of the images that the pencils are compared on."),
        [32.0, 1024.0],
        0,
        |p| p.coarse_side,
        |p, v| p.coarse_side = v,
    ),
    number(
        (
            Stage::Pencils,
            "Line spacing",
            " px",
            "How far apart neighbouring lines of a pencil are at the farthest corner of the coarse image.",
        ),
        [0.5, 16.0],
        1,
        |p| p.line_spacing,
        |p, v| p.line_spacing = v,
    ),
    number(
        (
            Stage::Pencils,
            "Rotation",
            "°",
            "How far the images may be rotated against each other; lines turned farther are not compared.",
        ),
        [0.0, 180.0],
        0,
        |p| p.rotation.to_degrees(),
        // Half a turn typed in degrees must not exceed π by a rounding.
        |p, v| p.rotation = if (v - 180.0).abs() < 1e-9 { std::f64::consts::PI } else { v.to_radians() },
    ),
    number(
        (
            Stage::Pencils,
            "Least texture",
            " of median",
            "Lines with less texture than this fraction of their pencil's median are dropped.",
        ),
        [0.0, 1.0],
        2,
        |p| p.texture,
        |p, v| p.texture = v,
    ),
    number(
        (
            Stage::Pencils,
            "Disparity reach",
            " of image",
            "Largest shift tried along a line pair, as a fraction of the longer image side.",
        ),
        [0.005, 0.5],
        3,
        |p| p.disparity_reach,
        |p, v| p.disparity_reach = v,
    ),
    number(
        (
            Stage::Pencils,
            "Truncation",
            " grey²",
            "Largest cost of one sample: more different than this counts alike.",
        ),
        [0.0, 65025.0],
        0,
        |p| f64::from(p.stereo.truncation),
        |p, v| p.stereo.truncation = v as u16,
    ),
    number(
        (
            Stage::Pencils,
            "Smoothness",
            " grey²",
            "Cost of a change of disparity by one sample; larger changes cost its square as often.",
        ),
        [0.0, 5000.0],
        0,
        |p| f64::from(p.stereo.lambda),
        |p, v| p.stereo.lambda = v as u16,
    ),
    number(
        (
            Stage::Pencils,
            "Jump",
            " grey²",
            "Largest cost of a change of disparity, as at the edge of an object.",
        ),
        [0.0, 20000.0],
        0,
        |p| f64::from(p.stereo.alpha),
        |p, v| p.stereo.alpha = v as u16,
    ),
    number(
        (Stage::Pencils, "Outside", " grey²", "Cost of a sample whose match falls outside the other image."),
        [0.0, 20000.0],
        0,
        |p| f64::from(p.stereo.outside),
        |p, v| p.stereo.outside = v as u16,
    ),
    Setting {
        stage: Stage::Pencils,
        name: "Ordering",
        tooltip: "Which changes of disparity are allowed: matches never go back along the line, anything, or disparities only grow as the paper prints it.",
        value: Value::Choice {
            names: &["Positions", "Free", "Disparities"],
            get: |p| ORDERINGS.iter().position(|o| *o == p.stereo.ordering).unwrap_or(0),
            set: |p, k| p.stereo.ordering = ORDERINGS[k],
        },
    },
    Setting {
        stage: Stage::Pencils,
        name: "Normalise",
        tooltip: "Divide each cost by the medians of its row and column, so that a line that matches everything is no longer preferred.",
        value: Value::Switch { get: |p| p.normalise, set: |p, v| p.normalise = v },
    },
    number(
        (
            Stage::Pencils,
            "Mutual best",
            "",
            "Two lines are a candidate when each is among this many best of the other.",
        ),
        [1.0, 20.0],
        0,
        |p| p.mutual as f64,
        |p, v| p.mutual = v as usize,
    ),
    number(
        (
            Stage::Hypotheses,
            "Hypotheses",
            "",
            "How many combinations of one candidate for p and one for q are tried.",
        ),
        [1.0, 1e6],
        0,
        |p| p.hypotheses as f64,
        |p, v| p.hypotheses = v as usize,
    ),
    number(
        (Stage::Hypotheses, "Seed", "", "Start of the random numbers: the same seed gives the same result."),
        [0.0, 1e6],
        0,
        |p| p.seed as f64,
        |p, v| p.seed = v as u64,
    ),
    Setting {
        stage: Stage::Hypotheses,
        name: "Patch support",
        tooltip: "Let small image patches choose among the combinations, instead of the round trip alone.",
        value: Value::Switch { get: |p| p.patch_support, set: |p, v| p.patch_support = v },
    },
    number(
        (
            Stage::Validation,
            "Validated",
            " of all",
            "Fraction of the hypotheses, those with the smallest round-trip area, whose lines are compared over the whole images.",
        ),
        [0.0, 1.0],
        2,
        |p| p.validated,
        |p, v| p.validated = v,
    ),
    number(
        (
            Stage::Validation,
            "Lines",
            " per image",
            "Epipolar lines of each image that are compared for one hypothesis.",
        ),
        [4.0, 1000.0],
        0,
        |p| p.validation_lines as f64,
        |p, v| p.validation_lines = v as usize,
    ),
    Setting {
        stage: Stage::Validation,
        name: "Line score",
        tooltip: "What a hypothesis is scored by: the matching cost of its lines as published, or that cost against the cost of mismatched lines.",
        value: Value::Choice {
            names: &["Cost", "Against mismatched"],
            get: |p| LINE_SCORES.iter().position(|s| *s == p.line_score).unwrap_or(0),
            set: |p, k| p.line_score = LINE_SCORES[k],
        },
    },
    number(
        (
            Stage::Validation,
            "Resampling",
            " rounds",
            "Most rounds in which new hypotheses are drawn from the matches of the best ones; it stops earlier when they bring nothing.",
        ),
        [0.0, 20.0],
        0,
        |p| p.resampling as f64,
        |p, v| p.resampling = v as usize,
    ),
    Setting {
        stage: Stage::Validation,
        name: "Plane and parallax",
        tooltip: "When resampling, also draw epipoles from what lies off the largest planes of the scene.",
        value: Value::Switch { get: |p| p.parallax, set: |p, v| p.parallax = v },
    },
    Setting {
        stage: Stage::Refinement,
        name: "Refine",
        tooltip: "Fit all seven degrees of freedom to patches matched along the epipolar lines at full resolution.",
        value: Value::Switch { get: |p| p.refine, set: |p, v| p.refine = v },
    },
    number(
        (
            Stage::Refinement,
            "Refined",
            " best",
            "How many of the best hypotheses are refined; the one that comes out best is the result.",
        ),
        [1.0, 60.0],
        0,
        |p| p.refined as f64,
        |p, v| p.refined = v as usize,
    ),
    number(
        (
            Stage::Refinement,
            "Click accuracy",
            " px",
            "Standard deviation of a click: how far the refinement may move the lines away from the clicked points.",
        ),
        [0.01, 20.0],
        2,
        |p| p.click_sigma,
        |p, v| p.click_sigma = v,
    ),
];

impl Setting {
    /// Whether two sets of parameters have the same value here.
    pub fn is_same(&self, a: &Parameters, b: &Parameters) -> bool {
        match self.value {
            Value::Number { get, .. } => get(a).to_bits() == get(b).to_bits(),
            Value::Switch { get, .. } => get(a) == get(b),
            Value::Choice { get, .. } => get(a) == get(b),
        }
    }

    /// Gives `to` the value that `from` has here.
    pub fn copy(&self, from: &Parameters, to: &mut Parameters) {
        match self.value {
            Value::Number { get, set, .. } => set(to, get(from)),
            Value::Switch { get, set } => set(to, get(from)),
            Value::Choice { get, set, .. } => set(to, get(from)),
        }
    }

    /// What is wrong with the value these parameters have here, if something is: a sentence.
    pub fn problem(&self, parameters: &Parameters) -> Option<String> {
        let mut alone = Parameters::from(parameters.preset);
        self.copy(parameters, &mut alone);
        alone.check().err().map(|error| match self.value {
            Value::Number { unit, range: [least, most], .. } => {
                format!("{} must be between {least} and {most}{unit}.", self.name)
            }
            Value::Switch { .. } | Value::Choice { .. } => error.to_string(),
        })
    }

    /// What it may be and what it is when nobody changed it, as the user reads it.
    pub fn range_text(&self, parameters: &Parameters) -> String {
        let default = self.default_text(parameters);
        match self.value {
            Value::Number { unit, range: [least, most], .. } => {
                format!("From {least} to {most}{unit}, by default {default}.")
            }
            Value::Switch { .. } | Value::Choice { .. } => format!("By default {default}."),
        }
    }

    /// What it is when nobody changed it, as the user reads it.
    pub fn default_text(&self, parameters: &Parameters) -> String {
        let defaults = Parameters::from(parameters.preset);
        match self.value {
            Value::Number { unit, decimals, get, .. } => format!("{:.decimals$}{unit}", get(&defaults)),
            Value::Switch { get, .. } => if get(&defaults) { "on" } else { "off" }.to_owned(),
            Value::Choice { names, get, .. } => names[get(&defaults)].to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;

    #[test]
    fn every_number_is_allowed_at_both_ends_of_its_range_and_kept() {
        for setting in &SETTINGS {
            let Value::Number { range, get, set, .. } = setting.value else { continue };
            for end in range {
                let mut parameters = Parameters::default();
                set(&mut parameters, end);
                assert!((get(&parameters) - end).abs() < 1e-9, "{}", setting.name);
                assert_eq!(setting.problem(&parameters), None, "{}", setting.name);
            }
        }
    }

    #[test]
    fn a_value_out_of_range_is_told_at_its_setting_alone() {
        let parameters = Parameters { line_spacing: 100.0, ..Parameters::default() };
        let wrong: Vec<_> =
            SETTINGS.iter().filter(|setting| setting.problem(&parameters).is_some()).collect();
        assert_eq!(wrong.iter().map(|setting| setting.name).collect::<Vec<_>>(), ["Line spacing"]);
        assert!(wrong[0].problem(&parameters).unwrap().contains("between 0.5 and 16 px"));
    }

    #[test]
    fn copying_every_setting_carries_all_parameters_but_preset_and_method() {
        let from = Parameters::from(Preset::Paper);
        let mut to = Parameters::from(Preset::Robust);
        assert!(SETTINGS.iter().any(|setting| !setting.is_same(&from, &to)));
        for setting in &SETTINGS {
            setting.copy(&from, &mut to);
            assert!(setting.is_same(&from, &to), "{}", setting.name);
        }
        assert_eq!(Parameters { preset: from.preset, ..to }, from);
    }
}
