//! Searches, one a file or folder: each from prepared images and clicks to a judged geometry.
//!
//! | search | candidates from | ranked by |
//! |---|---|---|
//! | `published` | lines through two or three clicks (paper, section 5.1) | lines |
//! | `patches` | lines through two clicks | patches |
//! | `features` | `patches`, then covariant features if another search may help | patches and features |
//! | `unclicked` | covariant features, then lines through two of their matches | patches and features |
//! | `given` | matches of another program, alone | nothing: their geometry stays as it is |
//! | `lines` | all lines of both images (paper, section 4) | agreement of lines, or patches |
//! | `barcodes` | lines through clicks and all lines, by motion barcodes (paper, section 2.3) | motion barcodes |

pub(super) mod barcodes;
mod clicks_alone;
pub(super) mod features;
pub(super) mod given;
mod judged;
pub(super) mod lines;
mod more_features;
mod patches;
mod pencils;
pub(super) mod published;
pub(super) mod record;
mod refinement;
mod stand_ins;
pub(super) mod unclicked;
