//! Evidence of line similarity for a geometry (paper, section 5.1): pencils and their candidates,
//! epipole hypotheses with bisectors and round trips, validation over whole images.
//!
//! Everything here compares lines through a [`crate::similarity::LineSimilarity`], many at a time,
//! and reads no pixels.

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
pub(in crate::estimate) use draws::{draw_pairs, of_line_pairs};
pub(in crate::estimate) use figures::{LineExaminer, unvalidated_figures};
pub(in crate::estimate) use pencil_pair::{PencilAngles, PencilPair};
pub(in crate::estimate) use score::line_scores;
pub(in crate::estimate) use unanchored::{
    LineCandidate, LineConsensus, compare_lines, geometries_from_lines,
};

/// Shortest line compared, as a share of the shorter side of the image. Shorter lines have too few
/// samples to be told apart: about 20 in an image of 192×144 px.
const SHORTEST_LINE: f64 = 0.15;
