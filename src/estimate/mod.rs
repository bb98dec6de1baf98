//! From clicked point pairs to a fundamental matrix, with everything that led to it.
//!
//! [`estimate`] is the driver: propose → rank → refine → judge. What lines say stands in `lines`, what patches say in
//! `patches`, what covariant features propose in [`covariant`], how far a result is to be trusted in `assess`. An
//! [`Estimate`] is a geometry with what was found out about it and, if a search found it, the trace of that search.
//!
//! The method in equations is `docs/estimator.md`; `docs/parameters.md` lists every parameter.

mod assess;
mod barcodes;
mod choice;
mod clicks;
#[doc(hidden)]
pub mod covariant;
mod driver;
mod error;
#[cfg(test)]
mod exact;
mod fit;
mod follow;
mod lines;
mod lines_alone;
mod made_once;
mod matched_features;
mod monitor;
mod parameters;
mod patches;
mod prepared;
mod record;
mod result;
mod scale;
mod search;
mod stage;
mod stream;
mod trust;
mod unclicked;
mod views;
mod wider;

pub use crate::cancel::CancelFlag;
pub use assess::{SMALLEST_SIDE, examine};
pub use clicks::{Click, ClickRole, Clicks};
pub use driver::{estimate, estimate_prepared};
pub use error::{EstimateError, Warning};
pub use fit::{EpipoleEllipse, Match, MatchFit, MatchFitError, Noise, Uncertainty, estimate_fundamental};
pub use follow::follow;
pub use lines::{Candidate, ComparedPencils, Construction, LineFigures, RoundTrip, lines_at};
pub use monitor::{Monitor, Progress};
pub use parameters::{
    LineScore, LinesAloneParameters, Method, Parameters, PatchParameters, PencilParameters, Preset,
    RefinementParameters, Search, SearchPlan, ValidationParameters,
};
#[doc(hidden)]
pub use parameters::{PARAMETERS, ParameterEntry, ParameterValue, parameters_as_markdown};
pub use patches::{PatchSupport, RefinedMatch, Refinement};
pub use prepared::PreparedPair;
pub use result::{
    Apart, Assessment, BarcodeFigures, Estimate, PlaneHomography, SearchCounts, SearchTrace, StageTiming,
};
pub use scale::Scale;
pub use stage::Stage;
pub use trust::{
    CLEAR_MARGIN, CLICK_DEVIATIONS, ENOUGH_MATCHES, FAR_TOO_FEW, Reason, Suspect, Trust, Verdict,
};
