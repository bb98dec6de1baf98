//! Searches, one a file or folder: each from prepared images and clicks to a judged geometry.
//!
//! | search | candidates from | ranked by |
//! |---|---|---|
//! | `published` | lines through two or three clicks (paper, section 5.1) | lines |
//! | `patches` | lines through two clicks | patches |
//! | `features` | covariant features, under the views that they suggest | patches and features |
//! | `passes` | `patches` with two clicks, then `features`; without, `features`, then `patches` of two matches | patches and features |
//! | `given` | matches of another program, alone | nothing: their geometry stays as it is |
//! | `lines` | all lines of both images (paper, section 4) | agreement of lines, or patches |
//! | `barcodes` | lines through clicks and all lines, by motion barcodes (paper, section 2.3) | motion barcodes |

pub(super) mod barcodes;
mod clicks_alone;
mod event_log;
mod features;
pub(super) mod given;
mod judged;
pub(super) mod lines;
mod more_features;
pub(super) mod passes;
mod patches;
mod pencils;
pub(super) mod published;
mod ranked;
pub(super) mod record;
mod refinement;
mod stand_ins;

/// Largest number of hypotheses reported with all their figures, rivals included. It bounds the
/// time and the size of a result.
const REPORTED: usize = 60;
