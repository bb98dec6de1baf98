//! Result and verdict: the selection among refined geometries, their assessment, and their
//! reliability.

pub(super) mod assessment;
pub(super) mod constants;
pub(super) mod events;
mod probability;
pub(super) mod result;
pub(super) mod selection;
pub(super) mod trust;
