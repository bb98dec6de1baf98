//! The table of all parameters: key, step, name, unit, range and a sentence, read by the check, the command line, the
//! window and the documents.

use std::f64::consts::PI;
use std::fmt::Write;

use super::{LineScore, Parameters, Preset, Search};
use crate::estimate::{EstimateError, Stage};
use crate::similarity::Ordering;

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

const ORDERINGS: [Ordering; 3] = [Ordering::Positions, Ordering::Free, Ordering::Disparities];
const LINE_SCORES: [LineScore; 2] = [LineScore::Cost, LineScore::AgainstMismatched];

const fn number(
    (key, stage, name, unit, tooltip): (&'static str, Stage, &'static str, &'static str, &'static str),
    range: [f64; 2],
    decimals: usize,
    get: fn(&Parameters) -> f64,
    set: fn(&mut Parameters, f64),
) -> ParameterEntry {
    let value = ParameterValue::Number { unit, of_unit: 1.0, range, enforced: true, decimals, get, set };
    ParameterEntry { key, stage, name, tooltip, value }
}

/// Every parameter, in the order of the steps.
pub const PARAMETERS: [ParameterEntry; 23] = [
    number(
        (
            "coarse_side",
            Stage::Pyramid,
            "Coarse size",
            " px",
            "Longer side of the images that the pencils are compared on.",
        ),
        [32.0, 1024.0],
        0,
        |p| p.pencils.coarse_side,
        |p, v| p.pencils.coarse_side = v,
    ),
    number(
        (
            "line_spacing",
            Stage::Pencils,
            "Line spacing",
            " px",
            "How far apart neighbouring lines of a pencil are at the farthest corner of the coarse image.",
        ),
        [0.5, 16.0],
        1,
        |p| p.pencils.line_spacing,
        |p, v| p.pencils.line_spacing = v,
    ),
    number(
        (
            "rotation",
            Stage::Pencils,
            "Rotation",
            "°",
            "How far the images may be rotated against each other; lines turned farther are not compared.",
        ),
        [0.0, PI],
        0,
        |p| p.pencils.rotation,
        |p, v| p.pencils.rotation = v,
    )
    .in_degrees(),
    number(
        (
            "texture",
            Stage::Pencils,
            "Least texture",
            " of median",
            "Lines with less texture than this fraction of their pencil's median are dropped.",
        ),
        [0.0, 1.0],
        2,
        |p| p.pencils.texture,
        |p, v| p.pencils.texture = v,
    ),
    number(
        (
            "disparity_reach",
            Stage::Pencils,
            "Disparity reach",
            " of image",
            "Largest shift tried along a line pair, as a fraction of the longer image side.",
        ),
        [0.005, 0.5],
        3,
        |p| p.similarity.disparity_reach,
        |p, v| p.similarity.disparity_reach = v,
    ),
    number(
        (
            "stereo.truncation",
            Stage::Pencils,
            "Truncation",
            " grey²",
            "Largest cost of one sample: more different than this counts alike.",
        ),
        [0.0, 65025.0],
        0,
        |p| f64::from(p.similarity.stereo.truncation),
        |p, v| p.similarity.stereo.truncation = v as u16,
    )
    .for_dragging(),
    number(
        (
            "stereo.lambda",
            Stage::Pencils,
            "Smoothness",
            " grey²",
            "Cost of a change of disparity by one sample; larger changes cost its square as often.",
        ),
        [0.0, 5000.0],
        0,
        |p| f64::from(p.similarity.stereo.lambda),
        |p, v| p.similarity.stereo.lambda = v as u16,
    )
    .for_dragging(),
    number(
        (
            "stereo.alpha",
            Stage::Pencils,
            "Jump",
            " grey²",
            "Largest cost of a change of disparity, as at the edge of an object.",
        ),
        [0.0, 20000.0],
        0,
        |p| f64::from(p.similarity.stereo.alpha),
        |p, v| p.similarity.stereo.alpha = v as u16,
    )
    .for_dragging(),
    number(
        (
            "stereo.outside",
            Stage::Pencils,
            "Outside",
            " grey²",
            "Cost of a sample whose match falls outside the other image.",
        ),
        [0.0, 20000.0],
        0,
        |p| f64::from(p.similarity.stereo.outside),
        |p, v| p.similarity.stereo.outside = v as u16,
    )
    .for_dragging(),
    ParameterEntry {
        key: "stereo.ordering",
        stage: Stage::Pencils,
        name: "Ordering",
        tooltip: "Which changes of disparity are allowed: matches never go back along the line, anything, or disparities only grow as the paper prints it.",
        value: ParameterValue::Choice {
            names: &["Positions", "Free", "Disparities"],
            get: |p| ORDERINGS.iter().position(|o| *o == p.similarity.stereo.ordering).unwrap_or(0),
            set: |p, k| p.similarity.stereo.ordering = ORDERINGS[k],
        },
    },
    ParameterEntry {
        key: "normalise",
        stage: Stage::Pencils,
        name: "Normalise",
        tooltip: "Divide each cost by the medians of its row and column, so that a line that matches everything is no longer preferred.",
        value: ParameterValue::Switch { get: |p| p.pencils.normalise, set: |p, v| p.pencils.normalise = v },
    },
    number(
        (
            "mutual",
            Stage::Pencils,
            "Mutual best",
            "",
            "Two lines are a candidate when each is among this many best of the other.",
        ),
        [1.0, 20.0],
        0,
        |p| p.pencils.mutual as f64,
        |p, v| p.pencils.mutual = v as usize,
    ),
    number(
        (
            "hypotheses",
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
        (
            "seed",
            Stage::Hypotheses,
            "Seed",
            "",
            "Start of the random numbers: the same seed gives the same result.",
        ),
        [0.0, 1e6],
        0,
        |p| p.seed as f64,
        |p, v| p.seed = v as u64,
    )
    .for_dragging(),
    ParameterEntry {
        key: "search",
        stage: Stage::Hypotheses,
        name: "Patch support",
        tooltip: "Let small image patches choose among the combinations, instead of the round trip alone.",
        value: ParameterValue::Switch {
            get: |p| p.search == Search::Patches,
            set: |p, v| p.search = if v { Search::Patches } else { Search::Lines },
        },
    },
    number(
        (
            "validated",
            Stage::Validation,
            "Validated",
            " of all",
            "Fraction of the hypotheses, those with the smallest round-trip area, whose lines are compared over the whole images.",
        ),
        [0.0, 1.0],
        2,
        |p| p.validation.validated,
        |p, v| p.validation.validated = v,
    ),
    number(
        (
            "validation_lines",
            Stage::Validation,
            "Lines",
            " per image",
            "Epipolar lines of each image that are compared for one hypothesis.",
        ),
        [4.0, 1000.0],
        0,
        |p| p.validation.lines as f64,
        |p, v| p.validation.lines = v as usize,
    ),
    ParameterEntry {
        key: "line_score",
        stage: Stage::Validation,
        name: "Line score",
        tooltip: "What a hypothesis is scored by: the matching cost of its lines as published, or that cost against the cost of mismatched lines.",
        value: ParameterValue::Choice {
            names: &["Cost", "Against mismatched"],
            get: |p| LINE_SCORES.iter().position(|s| *s == p.validation.line_score).unwrap_or(0),
            set: |p, k| p.validation.line_score = LINE_SCORES[k],
        },
    },
    number(
        (
            "resampling",
            Stage::Validation,
            "Resampling",
            " rounds",
            "Most rounds in which new hypotheses are drawn from the matches of the best ones; it stops earlier when they bring nothing.",
        ),
        [0.0, 20.0],
        0,
        |p| p.patches.resampling as f64,
        |p, v| p.patches.resampling = v as usize,
    ),
    ParameterEntry {
        key: "parallax",
        stage: Stage::Validation,
        name: "Plane and parallax",
        tooltip: "When resampling, also draw epipoles from what lies off the largest planes of the scene.",
        value: ParameterValue::Switch { get: |p| p.patches.parallax, set: |p, v| p.patches.parallax = v },
    },
    ParameterEntry {
        key: "refine",
        stage: Stage::Refinement,
        name: "Refine",
        tooltip: "Fit all seven degrees of freedom to patches matched along the epipolar lines at full resolution.",
        value: ParameterValue::Switch { get: |p| p.refinement.refine, set: |p, v| p.refinement.refine = v },
    },
    number(
        (
            "refined",
            Stage::Refinement,
            "Refined",
            " best",
            "How many of the best hypotheses are refined; the one that comes out best is the result.",
        ),
        [1.0, 60.0],
        0,
        |p| p.refinement.refined as f64,
        |p, v| p.refinement.refined = v as usize,
    ),
    number(
        (
            "click_sigma",
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

impl ParameterEntry {
    const fn in_degrees(mut self) -> Self {
        if let ParameterValue::Number { of_unit, .. } = &mut self.value {
            *of_unit = PI / 180.0;
        }
        self
    }

    const fn for_dragging(mut self) -> Self {
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

    fn unit(&self) -> &'static str {
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

/// The table as Markdown, for the documents.
pub fn parameters_as_markdown() -> String {
    let mut text = String::from(
        "| step | `--set` | in the window | paper | robust | range | what it is |\n|---|---|---|---|---|---|---|\n",
    );
    for entry in &PARAMETERS {
        let range = match entry.shown_range() {
            Some([least, most]) => format!("{least} … {most}{}", entry.unit()),
            None => match entry.value {
                ParameterValue::Choice { names, .. } => names.join(", "),
                _ => "on, off".to_owned(),
            },
        };
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} | {range} | {} |",
            entry.stage.label(),
            entry.key,
            entry.name,
            entry.default_text(Preset::Paper),
            entry.default_text(Preset::Robust),
            entry.tooltip
        );
    }
    text
}

#[cfg(test)]
mod tests {
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
    fn numbers_in_sentences() {
        assert_eq!([0.005, 60.0, 1000.0, 1e6, PI].map(in_words), ["0.005", "60", "1,000", "1,000,000", "π"]);
    }

    #[test]
    fn the_document_has_the_table_as_it_is() {
        let document = include_str!("../../../docs/parameters.md");
        let table = parameters_as_markdown();
        assert!(document.ends_with(&table), "the table of docs/parameters.md should be:\n{table}");
    }
}
