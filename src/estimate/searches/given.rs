//! Judgement of the geometry on which matches of another program agree. The geometry stays as it
//! is. The images and the clicks judge it, and geometries proposed by features compete with it.

use super::features::{FeatureProposals, ranked};
use super::judged::{Found, Judged, distinct_hypotheses};
use super::record::SearchRecord;
use crate::estimate::evidence::patches::Refined;
use crate::estimate::evidence::prepared::GivenMatches;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{EstimateError, Stage};
use crate::features::FeatureViews;
use crate::image::RelativeView;

/// Judges the geometry of given matches under the view that they suggest.
pub(in crate::estimate) fn search(
    input: SearchInput,
    given: &GivenMatches,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let of = FeatureViews::Frontal;
    let proposals = FeatureProposals::new(input, of, record)?;
    let view = proposals.views.first().copied().unwrap_or(RelativeView::UPRIGHT);
    let viewed = ViewedPair::new(input, input.prepared.patches_with_features(view, of));
    record.enter(Stage::Validation)?;
    let rivals = ranked(&proposals.fundamentals(), &[], &viewed, record.cancel())?;
    let rivals = distinct_hypotheses(&rivals, &viewed, record.cancel());
    record.enter(Stage::Refinement)?;
    let matched = viewed.patches.matched(&given.fundamental);
    let refined = matched.map(|Refined { mut refinement, weight, weight_deviation, .. }| {
        refinement.uncertainty.clone_from(&given.uncertainty);
        Refined { fundamental: given.fundamental, refinement, weight, weight_deviation }
    });
    let found = Found {
        fundamental: given.fundamental,
        // The images alone may show nothing.
        hypotheses: rivals.map_or_else(|_| Vec::new(), |(hypotheses, _)| hypotheses),
        supporting: given.inliers.clone(),
        refined,
        clicks_alone: false,
    };
    Ok(Judged::of(found, &viewed, record))
}
