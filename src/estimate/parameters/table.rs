//! Table of all parameters: key, stage, unit and range. `presentation::parameters` has their names
//! and tooltips.

use std::f64::consts::PI;

use super::entry::{ParameterEntry, ParameterValue};
use super::{LineScore, Method, Parameters, Search};
use crate::estimate::{EstimateError, Stage};
use crate::similarity::{LineMeasure, Ordering, SimilarityParameters};

/// Largest ratio of α to λ if all lines are compared. Eight changes of disparity then have a cost of
/// their own (λ 8² < α), and the comparison takes some four times as long as with the presets.
const MOST_TIMES: u16 = 81;
const ORDERINGS: [Ordering; 3] = [Ordering::Positions, Ordering::Free, Ordering::Disparities];
const MEASURES: [LineMeasure; 2] = [LineMeasure::Stereo, LineMeasure::Barcodes];
const LINE_SCORES: [LineScore; 2] = [LineScore::Cost, LineScore::AgainstMismatched];

const fn plain((key, stage): (&'static str, Stage), value: ParameterValue) -> ParameterEntry {
    ParameterEntry { key, stage, unit: "", is_expert: false, value }
}

const fn number(
    (key, stage, unit): (&'static str, Stage, &'static str),
    range: [f64; 2],
    get: fn(&Parameters) -> f64,
    set: fn(&mut Parameters, f64),
) -> ParameterEntry {
    let value = ParameterValue::Number { range, enforced: true, get, set };
    ParameterEntry { unit, ..plain((key, stage), value) }
}

/// A number: key, stage, unit, range, its place in the parameters, and its type unless that is `f64`.
macro_rules! number {
    ($key:literal, $stage:ident, $unit:literal, $range:expr, $($at:ident).+) => {
        number(($key, Stage::$stage, $unit), $range, |p| p.$($at).+, |p, v| p.$($at).+ = v)
    };
    ($key:literal, $stage:ident, $unit:literal, $range:expr, $($at:ident).+; u16) => {
        number(($key, Stage::$stage, $unit), $range, |p| f64::from(p.$($at).+), |p, v| p.$($at).+ = v as u16)
    };
    ($key:literal, $stage:ident, $unit:literal, $range:expr, $($at:ident).+; $kind:ty) => {
        number(($key, Stage::$stage, $unit), $range, |p| p.$($at).+ as f64, |p, v| p.$($at).+ = v as $kind)
    };
}

/// A switch: key, stage, and its place in the parameters.
macro_rules! switch {
    ($key:literal, $stage:ident, $($at:ident).+) => {
        plain(
            ($key, Stage::$stage),
            ParameterValue::Switch { get: |p| p.$($at).+, set: |p, v| p.$($at).+ = v },
        )
    };
}

/// A choice: key, stage, all values, and its place in the parameters.
macro_rules! choice {
    ($key:literal, $stage:ident, $all:ident, $($at:ident).+) => {
        plain(
            ($key, Stage::$stage),
            ParameterValue::Choice {
                get: |p| $all.iter().position(|one| *one == p.$($at).+).unwrap_or(0),
                set: |p, k| p.$($at).+ = $all[k],
            },
        )
    };
}

/// All parameters: first the parameters in the window, in the order of the stages, then the
/// parameters for experts.
pub const PARAMETERS: [ParameterEntry; 43] = [
    number!("coarse_side", Pyramid, " px", [32.0, 1024.0], pencils.coarse_side),
    number!("line_spacing", Pencils, " px", [0.5, 16.0], pencils.line_spacing),
    number!("rotation", Pencils, "", [0.0, PI], pencils.rotation),
    number!("texture", Pencils, " of median", [0.0, 1.0], pencils.texture),
    number!("disparity_reach", Pencils, " of image", [0.005, 0.5], similarity.disparity_reach),
    number!("stereo.truncation", Pencils, " grey²", [0.0, 65025.0], similarity.stereo.truncation; u16)
        .for_dragging(),
    number!("stereo.lambda", Pencils, " grey²", [0.0, 5000.0], similarity.stereo.lambda; u16).for_dragging(),
    number!("stereo.alpha", Pencils, " grey²", [0.0, 20000.0], similarity.stereo.alpha; u16).for_dragging(),
    number!("stereo.outside", Pencils, " grey²", [0.0, 20000.0], similarity.stereo.outside; u16)
        .for_dragging(),
    choice!("measure", Pencils, MEASURES, similarity.measure),
    choice!("stereo.ordering", Pencils, ORDERINGS, similarity.stereo.ordering),
    switch!("normalise", Pencils, pencils.normalise),
    number!("mutual", Pencils, "", [1.0, 20.0], pencils.mutual; usize),
    number!("all_lines", Pencils, " per image", [50.0, 5000.0], lines_alone.lines; usize),
    number!("all_lines_side", Pencils, " px", [32.0, 1024.0], lines_alone.side),
    number!("hypotheses", Hypotheses, "", [1.0, 1e6], hypotheses; usize),
    number!("all_lines_draws", Hypotheses, "", [1.0, 1e6], lines_alone.draws; usize),
    number!("seed", Hypotheses, "", [0.0, 1e6], seed; u64).for_dragging(),
    plain(
        ("search", Stage::Hypotheses),
        ParameterValue::Switch {
            get: |p| p.search == Search::Patches,
            set: |p, v| p.search = if v { Search::Patches } else { Search::Lines },
        },
    ),
    number!("agreement", Hypotheses, " px", [0.1, 50.0], lines_alone.agreement),
    number!("validated", Validation, " of all", [0.0, 1.0], validation.validated),
    number!("validation_lines", Validation, " per image", [4.0, 1000.0], validation.lines; usize),
    choice!("line_score", Validation, LINE_SCORES, validation.line_score),
    number!("resampling", Validation, " rounds", [0.0, 20.0], patches.resampling; usize),
    switch!("parallax", Validation, patches.parallax),
    switch!("refine", Refinement, refinement.refine),
    number!("refined", Refinement, " best", [1.0, 60.0], refinement.refined; usize),
    switch!("given_alone", Refinement, features.given_alone),
    number!("click_sigma", Refinement, " px", [0.01, 20.0], click_sigma),
    number!("supported", Hypotheses, "", [1.0, 100_000.0], patches.supported; usize).for_experts(),
    number!("pooled", Validation, "", [1.0, 60.0], patches.pooled; usize).for_experts(),
    number!("resampling_draws", Validation, "", [1.0, 1e6], patches.samples; usize).for_experts(),
    number!("line_refinement_rounds", Refinement, " rounds", [0.0, 1000.0], line_refinement.rounds; usize)
        .for_experts(),
    number!("line_refinement_step", Refinement, " px", [0.1, 20.0], line_refinement.first_step).for_experts(),
    number!("line_refinement_lines", Refinement, " per image", [4.0, 1000.0], line_refinement.lines; usize)
        .for_experts(),
    number!("rivals", Refinement, "", [0.0, 60.0], refinement.rivals; usize).for_experts(),
    number!("feature_draws", Features, "", [1.0, 1e6], features.draws; usize).for_experts(),
    number!("features_refitted", Features, "", [1.0, 1000.0], features.refitted; usize).for_experts(),
    number!("features_rematched", Features, "", [1.0, 1000.0], features.rematched; usize).for_experts(),
    number!("feature_views", Features, "", [1.0, 20.0], features.views; usize).for_experts(),
    number!("stand_in_searches", Features, "", [0.0, 100.0], features.stand_ins; usize).for_experts(),
    number!("barcode_side", Pencils, " px", [32.0, 1024.0], barcodes.side).for_experts(),
    number!("barcodes_refined", Refinement, "", [1.0, 60.0], barcodes.refined; usize).for_experts(),
];

impl Parameters {
    /// Checks every number against its range, and that a comparison of all lines ends within
    /// seconds.
    pub fn check(&self) -> Result<(), EstimateError> {
        PARAMETERS.iter().try_for_each(|entry| entry.check(self))?;
        let SimilarityParameters { measure, stereo, .. } = self.similarity;
        let compares_all = self.method == Method::LinesAlone && measure == LineMeasure::Stereo;
        let most = u32::from(MOST_TIMES) * u32::from(stereo.lambda);
        if compares_all && u32::from(stereo.jump_cost()) > most {
            return Err(EstimateError::ManyChanges { alpha: stereo.alpha, times: MOST_TIMES });
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
