//! Words for the estimator: sentences of verdicts and errors, names and tooltips of parameters.
//!
//! The estimator gives only codes and figures. The command line, the window and the result files
//! take their words from here.

mod cameras;
mod disparities;
mod epipoles;
mod errors;
mod facts;
mod figures;
mod glance;
mod interpretation;
mod judgement;
mod lens;
mod origin;
mod parameters;
mod pose;
mod probability;
mod reasons;
mod standing;
mod story;
mod tone;

pub use cameras::camera_doubts;
pub use disparities::{
    WRONG_PREVIEW, disparities_in_words, pixels_in_words, preview_in_words, search_range_in_words,
};
pub use epipoles::{NOT_DETERMINED, epipole_in_words, interval_in_words, length_in_words};
pub use errors::{error_in_words, named_error_in_words};
pub use interpretation::interpretation_in_words;
pub use judgement::{judgement_in_words, rows_in_words};
pub use lens::{lens_in_words, lenses_in_words, pictures_in_words};
pub use parameters::{ShownParameter, shown_parameters};
pub use pose::{NO_BASELINE, focal_lengths_in_words, pose_difference_in_words, pose_in_words, turn_in_words};
pub use probability::{
    NEAR_MATCHES, PARTLY_RELIABLE, is_open_elsewhere, is_partly_reliable, probability_in_words,
};
pub use reasons::{named_reason_in_words, named_warning_in_words, reason_in_words, warning_in_words};
pub use story::story_in_words;

#[doc(hidden)]
pub use self::{
    errors::sentence,
    facts::{
        Fact, ResultContext, corrected_fact, epipole_text, facts, hypothesis_facts, lens_fact, pose_facts,
        short_epipole_text,
    },
    figures::{HypothesisFigure, line_score_text},
    glance::{EpipolePlace, Glance, epipole_places, epipoles_at_a_glance, lines_at_a_glance},
    origin::{origin_in_words, proposer_in_words, resampling_in_words},
    probability::likely_in_words,
    reasons::{mostly_misplaced, sorted_reasons},
    standing::Standing,
    tone::Tone,
};
