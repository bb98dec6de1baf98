//! Pencils through the first two anchors, the beginning of every search through clicks.

use std::sync::Arc;

use rayon::prelude::*;

use super::record::SearchRecord;
use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{EstimateError, Stage};
use crate::geometry::PointPair;

/// Compares the pencils through the anchors. Returns the first two anchors and their pencils.
pub(super) fn compare_pencils(
    viewed: &ViewedPair,
    record: &mut SearchRecord,
) -> Result<([PointPair; 2], [Arc<ComparedPencils>; 2]), EstimateError> {
    let SearchInput { prepared, clicks, parameters } = viewed.input;
    let (source, cancel) = (&*viewed.source, record.cancel());
    record.enter(Stage::Pencils)?;
    let compare = |click: &PointPair| {
        let compare = || ComparedPencils::new(source, click, &parameters.pencils, cancel);
        prepared.pencils(click, viewed.patches.view(), parameters, compare)
    };
    let anchors = clicks.anchors();
    let all: Vec<Arc<ComparedPencils>> =
        anchors.par_iter().map(compare).collect::<Vec<_>>().into_iter().collect::<Result<_, _>>()?;
    record.pencils(clicks, all)?;
    match (anchors.as_slice(), record.present_pencils()) {
        ([p, q, ..], [pencils_p, pencils_q, ..]) => {
            Ok(([*p, *q], [Arc::clone(pencils_p), Arc::clone(pencils_q)]))
        }
        // `check_points` has made sure of two anchors.
        _ => Err(EstimateError::TooFewPairs { found: anchors.len(), needed: 2 }),
    }
}
