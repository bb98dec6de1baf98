//! Evidence of two images for or against a geometry: lines, patches and covariant features.

pub mod features;
pub(super) mod lazy;
pub(super) mod lines;
pub(super) mod patches;
pub(super) mod prepared;
pub(super) mod viewed;
