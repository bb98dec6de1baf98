//! Estimation of a fundamental matrix from clicked point pairs, with a record of the search.
//!
//! [`estimate`] is the driver: propose, rank, refine, judge. `searches` has one search per file,
//! `evidence` the evidence of lines, patches and features, `fit` the fits of matches, `sampling`
//! the parts common to all random sampling, and `verdict` the reliability of a result. An
//! [`Estimate`] is a geometry with its assessment and, if a search found it, the trace of the
//! search.
//!
//! `docs/estimator.md` has the method in equations; `docs/parameters.md` lists every parameter.
//! `lab/notes.md`, "Constants at half and at twice", says how results change with each constant.

mod checks;
mod clicks;
mod driver;
mod error;
mod evidence;
#[cfg(test)]
mod exact;
mod fit;
mod follow;
mod lens;
mod monitor;
mod origin;
mod parameters;
mod points;
mod sampling;
mod searches;
mod stage;
mod verdict;

pub use crate::cancel::CancelFlag;
pub use checks::SMALLEST_SIDE;
pub use clicks::{Click, ClickRole, Clicks};
#[cfg(feature = "pictures")]
pub(crate) use driver::estimate_since;
pub use driver::{estimate, estimate_prepared};
pub use error::{EstimateError, PairNames, PairNumbers, Warning};
#[doc(hidden)]
pub use evidence::features as covariant;
#[cfg(feature = "pictures")]
pub(crate) use evidence::lazy::Lazy;
pub use evidence::lines::{Candidate, ComparedPencils, Construction, LineFigures, RoundTrip, lines_at};
pub use evidence::patches::{CHECKPOINTS, PatchSupport, RefinedMatch, Refinement, RefinementStep};
pub use evidence::prepared::PreparedPair;
pub use fit::{
    DivisionFit, EpipoleBearing, EpipoleCertainty, EpipoleEllipse, LineBands, Match, MatchFit, MatchFitError,
    Noise, Uncertainty, estimate_essential, estimate_fundamental,
};
pub use follow::follow;
pub use lens::find_lens;
pub use monitor::{Monitor, Progress};
use origin::Proposed;
pub use origin::{Origin, ProposedBy, Resampling};
pub use parameters::{
    BarcodeParameters, FeatureParameters, LineRefinementParameters, LineScore, LinesAloneParameters, Method,
    Parameters, PatchParameters, PencilParameters, Preset, RefinementParameters, Search, SearchPlan,
    ValidationParameters,
};
#[doc(hidden)]
pub use parameters::{PARAMETERS, ParameterEntry, ParameterValue};
pub use points::{PointEstimate, PointsError, check_inside, estimate_points};
pub use stage::Stage;
pub use verdict::assessment::examine;
pub use verdict::constants::{
    CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, ENOUGH_MATCHES, EVEN, FAR_TOO_FEW, SURE_LINES,
};
pub use verdict::events::{DistinctMatch, Event, EventKind, HypothesisNote, LinePairNote, RankedHypothesis};
pub use verdict::result::{
    Apart, Assessment, Determined, Estimate, PlaneHomography, SearchCounts, SearchTrace, StageTiming,
};
pub use verdict::trust::{
    BarcodeFigures, Case, Lack, LineEvidence, Missing, Reason, Suspect, Trust, Verdict,
};
