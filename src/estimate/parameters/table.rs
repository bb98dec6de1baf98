//! The table of all parameters: key, step, name, unit, range and a sentence, read by the check, the command line, the
//! window and the documents.

use std::f64::consts::PI;
use std::fmt::Write;

use super::entry::{ParameterEntry, ParameterValue};
use super::{LineScore, Parameters, Preset, Search};
use crate::estimate::{EstimateError, Stage};
use crate::similarity::{LineMeasure, Ordering};

const ORDERINGS: [Ordering; 3] = [Ordering::Positions, Ordering::Free, Ordering::Disparities];
const MEASURES: [LineMeasure; 2] = [LineMeasure::Stereo, LineMeasure::Barcodes];
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
pub const PARAMETERS: [ParameterEntry; 28] = [
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
        key: "measure",
        stage: Stage::Pencils,
        name: "Lines compared by",
        tooltip: "What tells which lines correspond: stereo matching of the intensities along them, or, of two sequences of frames, in which frames they are crossed by something that moves.",
        value: ParameterValue::Choice {
            names: &["Stereo", "Barcodes"],
            get: |p| MEASURES.iter().position(|m| *m == p.similarity.measure).unwrap_or(0),
            set: |p, k| p.similarity.measure = MEASURES[k],
        },
    },
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
            "all_lines",
            Stage::Pencils,
            "All lines",
            " per image",
            "About how many lines of each image are compared when lines alone are to give the geometry.",
        ),
        [50.0, 5000.0],
        0,
        |p| p.lines_alone.lines as f64,
        |p, v| p.lines_alone.lines = v as usize,
    ),
    number(
        (
            "all_lines_side",
            Stage::Pencils,
            "Their size",
            " px",
            "Longer side of the images that all lines are compared on.",
        ),
        [32.0, 1024.0],
        0,
        |p| p.lines_alone.side,
        |p, v| p.lines_alone.side = v,
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
            "all_lines_draws",
            Stage::Hypotheses,
            "Draws",
            "",
            "How often two candidates and a third are drawn when lines alone are to give the geometry.",
        ),
        [1.0, 1e6],
        0,
        |p| p.lines_alone.draws as f64,
        |p, v| p.lines_alone.draws = v as usize,
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
            "agreement",
            Stage::Hypotheses,
            "Agreement",
            " px",
            "A line pair agrees with a geometry that lines alone gave when the area between its line and the one it is mapped to is below this many pixels times the width of the images that were compared.",
        ),
        [0.1, 50.0],
        1,
        |p| p.lines_alone.agreement,
        |p, v| p.lines_alone.agreement = v,
    ),
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

impl Parameters {
    /// Checks every number against its range.
    pub fn check(&self) -> Result<(), EstimateError> {
        PARAMETERS.iter().try_for_each(|entry| entry.check(self))
    }
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
#[path = "table_tests.rs"]
mod tests;
