//! Features as further evidence for a geometry that another search cannot change.
//!
//! A doubt about the scene may rest on too few matches: with more of them in the same proportions, the verdict would be
//! reliable. Covariant features then join the support, and the geometry is refined and judged again. No other geometry is
//! proposed.

use super::judged::Judged;
use super::record::SearchRecord;
use super::refinement::refine_ranked;
use crate::estimate::evidence::patches::Proposal;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::fit::foreshortening;
use crate::estimate::{EstimateError, Stage};
use crate::features::FeatureViews;
use crate::geometry::PointPair;

/// Foreshortening beyond which features of slanted surfaces match better: they are simulated with a compression of
/// one half, and √½ is as far from one half as from none.
const SLANTED: f64 = std::f64::consts::SQRT_2;

/// Refines and judges a geometry that lacks matches again with features. Features of slanted surfaces join where its
/// matches show slanted surfaces.
pub(super) fn with_more_features(
    found: Judged,
    input: SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let mut found = found;
    for of in [FeatureViews::Frontal, FeatureViews::Slanted] {
        let has = found.patches.features();
        if !found.lacks_matches() || has == Some(of) || has == Some(FeatureViews::Slanted) {
            continue;
        }
        if of == FeatureViews::Slanted && !shows_slanted_surfaces(&found) {
            continue;
        }
        record.enter(Stage::Features)?;
        let patches = input.prepared.patches_with_features(found.patches.view(), of);
        let clicks = found.clicks.clone();
        let viewed = ViewedPair::new(SearchInput { clicks: &clicks, ..input }, patches);
        record.enter(Stage::Refinement)?;
        let (fine, turn) = (viewed.patches.fine(), viewed.patches.view().rotation);
        let anchors = clicks.anchors();
        let leader = Proposal::of(&found.proposed(), anchors.first_chunk(), turn, fine);
        let leader: Vec<Proposal> = leader.into_iter().collect();
        let again = refine_ranked(&leader, found.hypotheses, &viewed, record.cancel())?;
        found = Judged::of(again, &viewed, record);
    }
    Ok(found)
}

fn shows_slanted_surfaces(found: &Judged) -> bool {
    let refinement = found.assessment.refinement.as_ref();
    let matches: Vec<PointPair> = refinement.iter().flat_map(|r| r.matches.iter().map(|m| m.pair)).collect();
    foreshortening(&matches).is_some_and(|ratio| ratio > SLANTED)
}
