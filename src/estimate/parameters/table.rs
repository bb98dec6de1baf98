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

const fn number(
    (key, stage, unit): (&'static str, Stage, &'static str),
    range: [f64; 2],
    get: fn(&Parameters) -> f64,
    set: fn(&mut Parameters, f64),
) -> ParameterEntry {
    ParameterEntry {
        key,
        stage,
        unit,
        is_expert: false,
        value: ParameterValue::Number { range, enforced: true, get, set },
    }
}

/// All parameters: first the parameters in the window, in the order of the stages, then the
/// parameters for experts.
pub const PARAMETERS: [ParameterEntry; 42] = [
    number(
        ("coarse_side", Stage::Pyramid, " px"),
        [32.0, 1024.0],
        |p| p.pencils.coarse_side,
        |p, v| p.pencils.coarse_side = v,
    ),
    number(
        ("line_spacing", Stage::Pencils, " px"),
        [0.5, 16.0],
        |p| p.pencils.line_spacing,
        |p, v| p.pencils.line_spacing = v,
    ),
    number(
        ("rotation", Stage::Pencils, ""),
        [0.0, PI],
        |p| p.pencils.rotation,
        |p, v| p.pencils.rotation = v,
    ),
    number(
        ("texture", Stage::Pencils, " of median"),
        [0.0, 1.0],
        |p| p.pencils.texture,
        |p, v| p.pencils.texture = v,
    ),
    number(
        ("disparity_reach", Stage::Pencils, " of image"),
        [0.005, 0.5],
        |p| p.similarity.disparity_reach,
        |p, v| p.similarity.disparity_reach = v,
    ),
    number(
        ("stereo.truncation", Stage::Pencils, " grey²"),
        [0.0, 65025.0],
        |p| f64::from(p.similarity.stereo.truncation),
        |p, v| p.similarity.stereo.truncation = v as u16,
    )
    .for_dragging(),
    number(
        ("stereo.lambda", Stage::Pencils, " grey²"),
        [0.0, 5000.0],
        |p| f64::from(p.similarity.stereo.lambda),
        |p, v| p.similarity.stereo.lambda = v as u16,
    )
    .for_dragging(),
    number(
        ("stereo.alpha", Stage::Pencils, " grey²"),
        [0.0, 20000.0],
        |p| f64::from(p.similarity.stereo.alpha),
        |p, v| p.similarity.stereo.alpha = v as u16,
    )
    .for_dragging(),
    number(
        ("stereo.outside", Stage::Pencils, " grey²"),
        [0.0, 20000.0],
        |p| f64::from(p.similarity.stereo.outside),
        |p, v| p.similarity.stereo.outside = v as u16,
    )
    .for_dragging(),
    ParameterEntry {
        key: "measure",
        stage: Stage::Pencils,
        unit: "",
        is_expert: false,
        value: ParameterValue::Choice {
            get: |p| MEASURES.iter().position(|m| *m == p.similarity.measure).unwrap_or(0),
            set: |p, k| p.similarity.measure = MEASURES[k],
        },
    },
    ParameterEntry {
        key: "stereo.ordering",
        stage: Stage::Pencils,
        unit: "",
        is_expert: false,
        value: ParameterValue::Choice {
            get: |p| ORDERINGS.iter().position(|o| *o == p.similarity.stereo.ordering).unwrap_or(0),
            set: |p, k| p.similarity.stereo.ordering = ORDERINGS[k],
        },
    },
    ParameterEntry {
        key: "normalise",
        stage: Stage::Pencils,
        unit: "",
        is_expert: false,
        value: ParameterValue::Switch { get: |p| p.pencils.normalise, set: |p, v| p.pencils.normalise = v },
    },
    number(
        ("mutual", Stage::Pencils, ""),
        [1.0, 20.0],
        |p| p.pencils.mutual as f64,
        |p, v| p.pencils.mutual = v as usize,
    ),
    number(
        ("all_lines", Stage::Pencils, " per image"),
        [50.0, 5000.0],
        |p| p.lines_alone.lines as f64,
        |p, v| p.lines_alone.lines = v as usize,
    ),
    number(
        ("all_lines_side", Stage::Pencils, " px"),
        [32.0, 1024.0],
        |p| p.lines_alone.side,
        |p, v| p.lines_alone.side = v,
    ),
    number(
        ("hypotheses", Stage::Hypotheses, ""),
        [1.0, 1e6],
        |p| p.hypotheses as f64,
        |p, v| p.hypotheses = v as usize,
    ),
    number(
        ("all_lines_draws", Stage::Hypotheses, ""),
        [1.0, 1e6],
        |p| p.lines_alone.draws as f64,
        |p, v| p.lines_alone.draws = v as usize,
    ),
    number(("seed", Stage::Hypotheses, ""), [0.0, 1e6], |p| p.seed as f64, |p, v| p.seed = v as u64)
        .for_dragging(),
    ParameterEntry {
        key: "search",
        stage: Stage::Hypotheses,
        unit: "",
        is_expert: false,
        value: ParameterValue::Switch {
            get: |p| p.search == Search::Patches,
            set: |p, v| p.search = if v { Search::Patches } else { Search::Lines },
        },
    },
    number(
        ("agreement", Stage::Hypotheses, " px"),
        [0.1, 50.0],
        |p| p.lines_alone.agreement,
        |p, v| p.lines_alone.agreement = v,
    ),
    number(
        ("validated", Stage::Validation, " of all"),
        [0.0, 1.0],
        |p| p.validation.validated,
        |p, v| p.validation.validated = v,
    ),
    number(
        ("validation_lines", Stage::Validation, " per image"),
        [4.0, 1000.0],
        |p| p.validation.lines as f64,
        |p, v| p.validation.lines = v as usize,
    ),
    ParameterEntry {
        key: "line_score",
        stage: Stage::Validation,
        unit: "",
        is_expert: false,
        value: ParameterValue::Choice {
            get: |p| LINE_SCORES.iter().position(|s| *s == p.validation.line_score).unwrap_or(0),
            set: |p, k| p.validation.line_score = LINE_SCORES[k],
        },
    },
    number(
        ("resampling", Stage::Validation, " rounds"),
        [0.0, 20.0],
        |p| p.patches.resampling as f64,
        |p, v| p.patches.resampling = v as usize,
    ),
    ParameterEntry {
        key: "parallax",
        stage: Stage::Validation,
        unit: "",
        is_expert: false,
        value: ParameterValue::Switch { get: |p| p.patches.parallax, set: |p, v| p.patches.parallax = v },
    },
    ParameterEntry {
        key: "refine",
        stage: Stage::Refinement,
        unit: "",
        is_expert: false,
        value: ParameterValue::Switch { get: |p| p.refinement.refine, set: |p, v| p.refinement.refine = v },
    },
    number(
        ("refined", Stage::Refinement, " best"),
        [1.0, 60.0],
        |p| p.refinement.refined as f64,
        |p, v| p.refinement.refined = v as usize,
    ),
    number(
        ("click_sigma", Stage::Refinement, " px"),
        [0.01, 20.0],
        |p| p.click_sigma,
        |p, v| p.click_sigma = v,
    ),
    number(
        ("supported", Stage::Hypotheses, ""),
        [1.0, 100_000.0],
        |p| p.patches.supported as f64,
        |p, v| p.patches.supported = v as usize,
    )
    .for_experts(),
    number(
        ("pooled", Stage::Validation, ""),
        [1.0, 60.0],
        |p| p.patches.pooled as f64,
        |p, v| p.patches.pooled = v as usize,
    )
    .for_experts(),
    number(
        ("resampling_draws", Stage::Validation, ""),
        [1.0, 1e6],
        |p| p.patches.samples as f64,
        |p, v| p.patches.samples = v as usize,
    )
    .for_experts(),
    number(
        ("line_refinement_rounds", Stage::Refinement, " rounds"),
        [0.0, 1000.0],
        |p| p.line_refinement.rounds as f64,
        |p, v| p.line_refinement.rounds = v as usize,
    )
    .for_experts(),
    number(
        ("line_refinement_step", Stage::Refinement, " px"),
        [0.1, 20.0],
        |p| p.line_refinement.first_step,
        |p, v| p.line_refinement.first_step = v,
    )
    .for_experts(),
    number(
        ("line_refinement_lines", Stage::Refinement, " per image"),
        [4.0, 1000.0],
        |p| p.line_refinement.lines as f64,
        |p, v| p.line_refinement.lines = v as usize,
    )
    .for_experts(),
    number(
        ("rivals", Stage::Refinement, ""),
        [0.0, 60.0],
        |p| p.refinement.rivals as f64,
        |p, v| p.refinement.rivals = v as usize,
    )
    .for_experts(),
    number(
        ("feature_draws", Stage::Features, ""),
        [1.0, 1e6],
        |p| p.features.draws as f64,
        |p, v| p.features.draws = v as usize,
    )
    .for_experts(),
    number(
        ("features_refitted", Stage::Features, ""),
        [1.0, 1000.0],
        |p| p.features.refitted as f64,
        |p, v| p.features.refitted = v as usize,
    )
    .for_experts(),
    number(
        ("features_rematched", Stage::Features, ""),
        [1.0, 1000.0],
        |p| p.features.rematched as f64,
        |p, v| p.features.rematched = v as usize,
    )
    .for_experts(),
    number(
        ("feature_views", Stage::Features, ""),
        [1.0, 20.0],
        |p| p.features.views as f64,
        |p, v| p.features.views = v as usize,
    )
    .for_experts(),
    number(
        ("stand_in_searches", Stage::Features, ""),
        [0.0, 100.0],
        |p| p.features.stand_ins as f64,
        |p, v| p.features.stand_ins = v as usize,
    )
    .for_experts(),
    number(
        ("barcode_side", Stage::Pencils, " px"),
        [32.0, 1024.0],
        |p| p.barcodes.side,
        |p, v| p.barcodes.side = v,
    )
    .for_experts(),
    number(
        ("barcodes_refined", Stage::Refinement, ""),
        [1.0, 60.0],
        |p| p.barcodes.refined as f64,
        |p, v| p.barcodes.refined = v as usize,
    )
    .for_experts(),
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
