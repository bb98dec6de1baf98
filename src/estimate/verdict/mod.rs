//! Result and verdict: the selection among refined geometries, their assessment, and how far to trust them.

pub(super) mod assessment;
mod poisson;
pub(super) mod result;
pub(super) mod selection;
pub(super) mod trust;
