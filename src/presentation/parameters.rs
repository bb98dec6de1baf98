//! Names, tooltips and units of the parameters.

use std::f64::consts::PI;

use crate::estimate::{PARAMETERS, ParameterEntry, ParameterValue, Parameters, Preset};

/// Name, tooltip and format of one parameter.
struct Words {
    key: &'static str,
    name: &'static str,
    tooltip: &'static str,
    decimals: usize,
    /// Unit shown, and its size in the unit of files, if they differ: `π/180` for degrees.
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

static WORDS: [Words; PARAMETERS.len()] = [
    number(
        "coarse_side",
        "Coarse size",
        0,
        "Longer side of the reduced images in which the pencils are compared.",
    ),
    number(
        "line_spacing",
        "Line spacing",
        1,
        "Distance between neighbouring lines of a pencil at the farthest corner of the coarse image.",
    ),
    number(
        "rotation",
        "Rotation",
        0,
        "Largest rotation between the images. Lines turned farther are not compared.",
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
        "Largest cost of one sample. All larger differences cost this much.",
    ),
    number(
        "stereo.lambda",
        "Smoothness",
        0,
        "Cost of a change of disparity by one sample. A change by n samples costs n² times as much.",
    ),
    number(
        "stereo.alpha",
        "Jump",
        0,
        "Largest cost of a change of disparity. It applies at the edges of objects.",
    ),
    number("stereo.outside", "Outside", 0, "Cost of a sample whose match falls outside the other image."),
    choice(
        "measure",
        "Lines compared by",
        &["Stereo", "Barcodes"],
        "Measure of line similarity. Stereo matches the intensities along two lines. Barcodes compare the frames in which moving objects cross them, in two sequences.",
    ),
    choice(
        "stereo.ordering",
        "Ordering",
        &["Positions", "Free", "Disparities"],
        "Allowed changes of disparity. Positions: matches never go back along the line. Free: any change. Disparities: they never decrease, as printed in the paper.",
    ),
    switch(
        "normalise",
        "Normalise",
        "Divide the cost of two lines by the medians of all costs of either line. Otherwise a line without texture, which matches everything, is preferred.",
    ),
    number(
        "mutual",
        "Mutual best",
        0,
        "Two lines are a candidate pair when each is among this many best matches of the other.",
    ),
    number(
        "all_lines",
        "All lines",
        0,
        "Approximate number of lines of each image in the search with all lines.",
    ),
    number(
        "all_lines_side",
        "All-lines size",
        0,
        "Longer side of the reduced images in which all lines are compared.",
    ),
    number(
        "hypotheses",
        "Hypotheses",
        0,
        "Number of tried combinations of a candidate line pair through p and one through q.",
    ),
    number(
        "all_lines_draws",
        "Draws",
        0,
        "Number of samples of three candidate line pairs, in the search with all lines.",
    ),
    number("seed", "Seed", 0, "Start of the random numbers. The same seed gives the same result."),
    switch(
        "search",
        "Patch support",
        "Rank the hypotheses by small image patches that match. If off, lines alone rank them, as published.",
    ),
    number(
        "agreement",
        "Agreement",
        1,
        "Largest mean distance between a line and its mapped partner in a pair that agrees with a geometry. For the search with all lines.",
    ),
    number(
        "validated",
        "Validated",
        2,
        "Fraction of the hypotheses whose lines are compared over the whole images. Those with the smallest round-trip area are taken.",
    ),
    number(
        "validation_lines",
        "Lines",
        0,
        "Number of epipolar lines of each image compared for one hypothesis.",
    ),
    choice(
        "line_score",
        "Line cost",
        &["Cost", "Against mismatched"],
        "Cost of the lines of a hypothesis. Cost: the matching cost of its lines, as published. Against mismatched: this cost divided by the cost of mismatched lines.",
    ),
    number(
        "resampling",
        "Resampling",
        0,
        "Largest number of rounds that draw new hypotheses from the matches of the best ones. The rounds end when one of them finds nothing better.",
    ),
    switch(
        "parallax",
        "Plane and parallax",
        "When resampling, also draw epipoles from matches off the largest planes of the scene.",
    ),
    switch(
        "refine",
        "Refine",
        "Fit all seven degrees of freedom of F to patches matched along the epipolar lines at full resolution.",
    ),
    number(
        "refined",
        "Refined",
        0,
        "Number of best hypotheses that are refined. The best refined one is the result.",
    ),
    switch(
        "given_alone",
        "Given matches alone",
        "Fit F to the matches of another program alone, if there are any. The images and the clicks judge it but do not change it.",
    ),
    number(
        "click_sigma",
        "Click accuracy",
        2,
        "Standard deviation of a click. A larger value lets the refinement move the lines farther from the clicked points.",
    ),
    number(
        "supported",
        "Supported",
        0,
        "Number of candidate combinations whose exact patch support is computed.",
    ),
    number("pooled", "Pooled", 0, "Number of best hypotheses whose matches are pooled for resampling."),
    number(
        "resampling_draws",
        "Resampling draws",
        0,
        "Number of samples of each kind in a round of resampling.",
    ),
    number(
        "line_refinement_rounds",
        "Line refinement",
        0,
        "Number of rounds of the refinement on lines at each image size.",
    ),
    number(
        "line_refinement_step",
        "First step",
        1,
        "First step of the refinement on lines, measured at the far side of the image.",
    ),
    number(
        "line_refinement_lines",
        "Lines refined",
        0,
        "Number of lines compared in each direction by the refinement on lines.",
    ),
    number(
        "rivals",
        "Rivals",
        0,
        "Number of rivals refined if the margin of a geometry of clicks or given matches is too small to decide.",
    ),
    number("feature_draws", "Feature draws", 0, "Number of minimal samples of covariant features."),
    number("features_refitted", "Features refitted", 0, "Number of feature hypotheses that are refitted."),
    number(
        "features_rematched",
        "Features rematched",
        0,
        "Number of refitted hypotheses whose features are matched again along the epipolar lines.",
    ),
    number(
        "feature_views",
        "Feature views",
        0,
        "Largest number of relative views (rotation and scale) tried from features.",
    ),
    number(
        "stand_in_searches",
        "Stand-in searches",
        0,
        "Largest number of searches without clicks, each through two randomly drawn matches.",
    ),
    number(
        "barcode_side",
        "Barcode size",
        0,
        "Smallest longer side of the images in which barcodes are compared.",
    ),
    number(
        "barcodes_refined",
        "Barcodes refined",
        0,
        "Number of proposals refined on barcodes: this many from the clicks, and as many from all lines.",
    ),
];

/// Parameter with its name, tooltip and unit for display.
#[derive(Clone, Copy)]
pub struct ShownParameter {
    /// Entry in the table of the estimator.
    pub entry: &'static ParameterEntry,
    /// Name in the window.
    pub name: &'static str,
    /// Tooltip, in whole sentences.
    pub tooltip: &'static str,
    /// Number of decimals shown.
    pub decimals: usize,
    /// Names of the choices. Empty for numbers and switches.
    pub choices: &'static [&'static str],
    /// Unit shown, with the space before it.
    pub unit: &'static str,
    /// Value of one shown unit in the unit of files: `π/180` for degrees, otherwise 1.
    pub of_unit: f64,
}

/// Returns all parameters in the order of the stages.
pub fn shown_parameters() -> impl Iterator<Item = ShownParameter> {
    static ENTRIES: [ParameterEntry; PARAMETERS.len()] = PARAMETERS;
    ENTRIES.iter().filter_map(|entry| {
        let Words { name, tooltip, decimals, converted, choices, .. } =
            *WORDS.iter().find(|words| words.key == entry.key)?;
        let (unit, of_unit) = converted.unwrap_or((entry.unit, 1.0));
        Some(ShownParameter { entry, name, tooltip, decimals, choices, unit, of_unit })
    })
}

impl ShownParameter {
    /// Returns the error message for the value in `parameters`, in the shown unit. `None` if the
    /// value is valid.
    pub fn problem(&self, parameters: &Parameters) -> Option<String> {
        self.entry.check(parameters).err()?;
        let [least, most] = self.shown_range()?;
        Some(format!("{} must be between {least} and {most}{}.", self.name, self.unit))
    }

    /// Returns a sentence with the range and the default.
    pub fn range_text(&self, preset: Preset) -> String {
        let default = self.default_text(preset);
        match self.shown_range() {
            Some([least, most]) => {
                let unit = self.unit;
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
                let (decimals, value) = (self.decimals, get(&defaults) / self.of_unit);
                format!("{value:.decimals$}{}", self.unit)
            }
            ParameterValue::Switch { get, .. } => if get(&defaults) { "on" } else { "off" }.to_owned(),
            ParameterValue::Choice { get, .. } => self.choices[get(&defaults)].to_owned(),
        }
    }

    /// Returns the range of a number in the shown unit.
    fn shown_range(&self) -> Option<[f64; 2]> {
        match self.entry.value {
            ParameterValue::Number { range, .. } => Some(range.map(|end| end / self.of_unit)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    /// Returns the table of all parameters as Markdown.
    fn parameters_as_markdown() -> String {
        let mut text = String::from(
            "| step | `--set` | in the window | paper | robust | range | what it is |\n|---|---|---|---|---|---|---|\n",
        );
        for shown in shown_parameters() {
            let range = match shown.shown_range() {
                Some([least, most]) => format!("{least} … {most}{}", shown.unit),
                None if shown.choices.is_empty() => "on, off".to_owned(),
                None => shown.choices.join(", "),
            };
            let _ = writeln!(
                text,
                "| {} | `{}` | {} | {} | {} | {range} | {} |",
                shown.entry.stage.label(),
                shown.entry.key,
                if shown.entry.is_expert { "–" } else { shown.name },
                shown.default_text(Preset::Paper),
                shown.default_text(Preset::Robust),
                shown.tooltip
            );
        }
        text
    }

    #[test]
    fn every_parameter_has_words() {
        assert_eq!(shown_parameters().count(), PARAMETERS.len());
        for shown in shown_parameters() {
            assert!(shown.tooltip.ends_with('.'), "{}", shown.entry.key);
            let is_choice = matches!(shown.entry.value, ParameterValue::Choice { .. });
            assert_eq!(is_choice, !shown.choices.is_empty(), "{}", shown.entry.key);
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
