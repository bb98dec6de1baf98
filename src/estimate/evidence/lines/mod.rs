//! What line similarity says about a geometry (paper, section 5.1): pencils and candidates, epipole hypotheses with
//! their bisectors and round trips, validation over whole images, refinement on lines.
//!
//! Everything here asks a [`crate::similarity::LineSimilarity`], many lines at a time, and looks at no pixels.

mod bisectors;
mod construction;
mod draws;
mod figures;
mod pencil_pair;
mod pencils;
mod score;
mod unanchored;

pub use construction::{Construction, RoundTrip};
pub use figures::LineFigures;
pub use pencils::{Candidate, ComparedPencils, lines_at};

pub(in crate::estimate) use bisectors::{bisector_kappas, round_trip_area};
pub(in crate::estimate) use draws::draw_pairs;
pub(in crate::estimate) use figures::{LineExaminer, unvalidated_figures};
pub(in crate::estimate) use pencil_pair::{PencilAngles, PencilPair};
pub(in crate::estimate) use score::line_scores;
pub(in crate::estimate) use unanchored::{
    LineCandidate, LineConsensus, compare_lines, geometries_from_lines,
};

/// Shortest line compared, as a share of the shorter side of the image. A shorter one has too few
/// samples to tell lines apart. Not measured.
const SHORTEST_LINE: f64 = 0.15;
