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
pub(super) mod published;
mod refinement;
mod score;
mod unanchored;

pub use construction::{Construction, RoundTrip};
pub use figures::LineFigures;
pub use pencils::{Candidate, ComparedPencils, lines_at};

pub(super) use draws::draw_pairs;
pub(super) use figures::{LineExaminer, unvalidated_figures};
pub(super) use pencil_pair::{PencilAngles, PencilPair};
pub(super) use unanchored::{LineCandidate, LineConsensus, compare_lines, geometries_from_lines};

/// Lines that cross less of an image than this fraction of its shorter side are not compared: they hold too few samples
/// to tell one line from another.
const SHORTEST_LINE: f64 = 0.15;
