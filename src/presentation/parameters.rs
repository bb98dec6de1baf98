//! Names, tooltips and units of the parameters.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::estimate::{PARAMETERS, ParameterEntry, ParameterValue, Parameters, Preset};

/// Words about one parameter.
struct Words {
    key: &'static str,
    name: &'static str,
    tooltip: &'static str,
    decimals: usize,
    /// Unit for people and its size in files, if they differ: `π/180` for an angle shown in degrees.
    converted: Option<(&'static str, f64)>,
    choices: &'static [&'static str],
}

const fn switch(key: &'static str, name: &'static str, tooltip: &'static str) -> Words {
    Words { key, name, tooltip, decimals: 0, converted: None, choices: &[] }
}

const fn choice(
    key: &'static str,
    name: &'static str,
    choices: &'static [&'static str],
    tooltip: &'static str,
) -> Words {
    Words { choices, ..switch(key, name, tooltip) }
}

const fn number(key: &'static str, name: &'static str, decimals: usize, tooltip: &'static str) -> Words {
    Words { decimals, ..switch(key, name, tooltip) }
}

impl Words {
    const fn in_degrees(mut self) -> Self {
        self.converted = Some(("°", PI / 180.0));
        self
    }
}

/// Words of all parameters.
const WORDS: [Words; PARAMETERS.len()] = [
    number("coarse_side", "Coarse size", 0, "Longer side of the images that the pencils are compared on."),
    number(
        "line_spacing",
        "Line spacing",
        1,
        "How far apart neighbouring lines of a pencil are at the farthest corner of the coarse image.",
    ),
    number(
        "rotation",
        "Rotation",
        0,
        "How far the images may be rotated against each other; lines turned farther are not compared.",
    )
    .in_degrees(),
    number(
        "texture",
        "Least texture",
        2,
        "Lines with less texture than this fraction of their pencil's median are dropped.",
    ),
    number(
        "disparity_reach",
        "Disparity reach",
        3,
        "Largest shift tried along a line pair, as a fraction of the longer image side.",
    ),
    number(
        "stereo.truncation",
        "Truncation",
        0,
        "Largest cost of one sample: more different than this counts alike.",
    ),
    number(
        "stereo.lambda",
        "Smoothness",
        0,
        "Cost of a change of disparity by one sample; larger changes cost its square as often.",
    ),
    number("stereo.alpha", "Jump", 0, "Largest cost of a change of disparity, as at the edge of an object."),
    number("stereo.outside", "Outside", 0, "Cost of a sample whose match falls outside the other image."),
    choice(
        "measure",
        "Lines compared by",
        &["Stereo", "Barcodes"],
        "What tells which lines correspond: stereo matching of the intensities along them, or, of two sequences of frames, in which frames they are crossed by something that moves.",
    ),
    choice(
        "stereo.ordering",
        "Ordering",
        &["Positions", "Free", "Disparities"],
        "Which changes of disparity are allowed: matches never go back along the line, anything, or disparities only grow as the paper prints it.",
    ),
    switch(
        "normalise",
        "Normalise",
        "Divide each cost by the medians of its row and column, so that a line that matches everything is no longer preferred.",
    ),
    number(
        "mutual",
        "Mutual best",
        0,
        "Two lines are a candidate when each is among this many best of the other.",
    ),
    number(
        "all_lines",
        "All lines",
        0,
        "About how many lines of each image are compared when lines alone are to give the geometry.",
    ),
    number("all_lines_side", "Their size", 0, "Longer side of the images that all lines are compared on."),
    number(
        "hypotheses",
        "Hypotheses",
        0,
        "How many combinations of one candidate for p and one for q are tried.",
    ),
    number(
        "all_lines_draws",
        "Draws",
        0,
        "How often two candidates and a third are drawn when lines alone are to give the geometry.",
    ),
    number("seed", "Seed", 0, "Start of the random numbers: the same seed gives the same result."),
    switch(
        "search",
        "Patch support",
        "Let small image patches choose among the combinations, instead of the round trip alone.",
    ),
    number(
        "agreement",
        "Agreement",
        1,
        "A line pair agrees with a geometry that lines alone gave when the area between its line and the one it is mapped to is below this many pixels times the width of the images that were compared.",
    ),
    number(
        "validated",
        "Validated",
        2,
        "Fraction of the hypotheses, those with the smallest round-trip area, whose lines are compared over the whole images.",
    ),
    number(
        "validation_lines",
        "Lines",
        0,
        "Epipolar lines of each image that are compared for one hypothesis.",
    ),
    choice(
        "line_score",
        "Line score",
        &["Cost", "Against mismatched"],
        "What a hypothesis is scored by: the matching cost of its lines as published, or that cost against the cost of mismatched lines.",
    ),
    number(
        "resampling",
        "Resampling",
        0,
        "Most rounds in which new hypotheses are drawn from the matches of the best ones; it stops earlier when they bring nothing.",
    ),
    switch(
        "parallax",
        "Plane and parallax",
        "When resampling, also draw epipoles from what lies off the largest planes of the scene.",
    ),
    switch(
        "refine",
        "Refine",
        "Fit all seven degrees of freedom to patches matched along the epipolar lines at full resolution.",
    ),
    number(
        "refined",
        "Refined",
        0,
        "How many of the best hypotheses are refined; the one that comes out best is the result.",
    ),
    number(
        "click_sigma",
        "Click accuracy",
        2,
        "Standard deviation of a click: how far the refinement may move the lines away from the clicked points.",
    ),
    number("supported", "Supported", 0, "Combinations of candidates whose exact patch support is computed."),
    number("pooled", "Pooled", 0, "Best hypotheses whose matches are pooled for resampling."),
    number("resampling_draws", "Resampling draws", 0, "Samples of each kind in a round of resampling."),
    number(
        "line_refinement_rounds",
        "Line refinement",
        0,
        "Rounds of the refinement on lines at each image size.",
    ),
    number(
        "line_refinement_step",
        "First step",
        1,
        "First step of the refinement on lines, at the far side of the image.",
    ),
    number(
        "line_refinement_lines",
        "Lines refined",
        0,
        "Lines in each direction that the refinement on lines compares.",
    ),
    number(
        "rivals",
        "Rivals",
        0,
        "Rivals that are refined if the margin before refinement is too small to decide.",
    ),
    number("feature_draws", "Feature draws", 0, "Minimal samples of covariant features."),
    number("features_refitted", "Features refitted", 0, "Hypotheses of features that are refitted."),
    number(
        "features_rematched",
        "Features rematched",
        0,
        "Refitted hypotheses whose features are matched again along the epipolar lines.",
    ),
    number("feature_views", "Feature views", 0, "Largest number of relative views that features suggest."),
    number(
        "stand_in_searches",
        "Stand-in searches",
        0,
        "Without clicks, largest number of searches through two drawn matches.",
    ),
    number(
        "barcode_side",
        "Barcode size",
        0,
        "Least longer side of the images in which barcodes are compared.",
    ),
    number(
        "barcodes_refined",
        "Barcodes refined",
        0,
        "Proposals refined on barcodes, of the clicks and of all lines each.",
    ),
];

/// Parameter with its name, tooltip and unit for people.
#[derive(Clone, Copy)]
pub struct ShownParameter {
    /// Entry of the estimator.
    pub entry: &'static ParameterEntry,
    words: &'static Words,
}

/// Returns all parameters, in the order of the stages.
pub fn shown_parameters() -> impl Iterator<Item = ShownParameter> {
    static ENTRIES: [ParameterEntry; PARAMETERS.len()] = PARAMETERS;
    static ALL: [Words; PARAMETERS.len()] = WORDS;
    let words = |key: &str| ALL.iter().find(|words| words.key == key);
    ENTRIES.iter().filter_map(move |entry| Some(ShownParameter { entry, words: words(entry.key)? }))
}

impl ShownParameter {
    /// Name in the window.
    pub fn name(&self) -> &'static str {
        self.words.name
    }

    /// Sentence about it.
    pub fn tooltip(&self) -> &'static str {
        self.words.tooltip
    }

    /// Unit shown, with the space before it.
    pub fn unit(&self) -> &'static str {
        self.words.converted.map_or(self.entry.unit, |(unit, _)| unit)
    }

    /// Value in files of one unit shown.
    pub fn of_unit(&self) -> f64 {
        self.words.converted.map_or(1.0, |(_, of_unit)| of_unit)
    }

    /// Whether the unit shown differs from that in files.
    pub fn is_converted(&self) -> bool {
        self.words.converted.is_some()
    }

    /// Decimals shown.
    pub fn decimals(&self) -> usize {
        self.words.decimals
    }

    /// Names of the choices, if it is a choice.
    pub fn choices(&self) -> &'static [&'static str] {
        self.words.choices
    }

    /// Returns the error message for the value in `parameters`, in the unit shown. `None` if the value
    /// is valid.
    pub fn problem(&self, parameters: &Parameters) -> Option<String> {
        self.entry.check(parameters).err()?;
        let [least, most] = self.shown_range()?;
        Some(format!("{} must be between {least} and {most}{}.", self.name(), self.unit()))
    }

    /// Returns a sentence with the range and the default.
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

    /// Returns the default of a preset, with its unit.
    pub fn default_text(&self, preset: Preset) -> String {
        let defaults = Parameters::from(preset);
        match self.entry.value {
            ParameterValue::Number { get, .. } => {
                let (decimals, value) = (self.decimals(), get(&defaults) / self.of_unit());
                format!("{value:.decimals$}{}", self.unit())
            }
            ParameterValue::Switch { get, .. } => if get(&defaults) { "on" } else { "off" }.to_owned(),
            ParameterValue::Choice { get, .. } => self.choices()[get(&defaults)].to_owned(),
        }
    }

    /// Range of a number, in the unit shown.
    fn shown_range(&self) -> Option<[f64; 2]> {
        match self.entry.value {
            ParameterValue::Number { range, .. } => Some(range.map(|end| end / self.of_unit())),
            _ => None,
        }
    }
}

/// Returns the table of all parameters as Markdown.
pub fn parameters_as_markdown() -> String {
    let mut text = String::from(
        "| step | `--set` | in the window | paper | robust | range | what it is |\n|---|---|---|---|---|---|---|\n",
    );
    for shown in shown_parameters() {
        let range = match shown.shown_range() {
            Some([least, most]) => format!("{least} … {most}{}", shown.unit()),
            None if shown.choices().is_empty() => "on, off".to_owned(),
            None => shown.choices().join(", "),
        };
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} | {range} | {} |",
            shown.entry.stage.label(),
            shown.entry.key,
            if shown.entry.is_expert { "–" } else { shown.name() },
            shown.default_text(Preset::Paper),
            shown.default_text(Preset::Robust),
            shown.tooltip()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_has_words() {
        assert_eq!(shown_parameters().count(), PARAMETERS.len());
        for shown in shown_parameters() {
            assert!(shown.tooltip().ends_with('.'), "{}", shown.entry.key);
            let is_choice = matches!(shown.entry.value, ParameterValue::Choice { .. });
            assert_eq!(is_choice, !shown.choices().is_empty(), "{}", shown.entry.key);
        }
    }

    #[test]
    fn a_value_out_of_range_is_told_at_its_entry_alone() {
        let mut parameters = Parameters::default();
        parameters.pencils.line_spacing = 100.0;
        let problems: Vec<String> =
            shown_parameters().filter_map(|shown| shown.problem(&parameters)).collect();
        assert_eq!(problems, ["Line spacing must be between 0.5 and 16 px."]);
        let rotation = shown_parameters().find(|shown| shown.entry.key == "rotation").unwrap();
        assert!(rotation.range_text(Preset::Robust).starts_with("From 0 to 180°, by default 45°"));
    }

    #[test]
    fn the_document_has_the_table_as_it_is() {
        let document = include_str!("../../docs/parameters.md");
        let table = parameters_as_markdown();
        assert!(document.ends_with(&table), "the table of docs/parameters.md should be:\n{table}");
    }
}
