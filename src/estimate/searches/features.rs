//! Search with covariant features under the views they suggest.

use super::judged::{Judged, distinct_hypotheses};
use super::pencils::compare_pencils;
use super::ranked::Ranked;
use super::record::SearchRecord;
use crate::estimate::evidence::features::{
    FeatureEvidence, hypotheses_from_features, is_same_view, view_of, view_of_pairs,
};
use crate::estimate::evidence::patches::{Proposal, rank_fine};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{CancelFlag, Estimate, EstimateError, HypothesisNote, Proposed, ProposedBy, Stage};
use crate::features::FeatureViews;
use crate::geometry::PointPair;
use crate::image::RelativeView;

/// Geometry with the matches that it explains.
pub(in crate::estimate) struct FeatureProposal {
    pub proposed: Proposed,
    pub matches: Vec<PointPair>,
}

/// Geometries proposed by given matches and by covariant features, best first.
pub(in crate::estimate) struct FeatureProposals {
    pub proposals: Vec<FeatureProposal>,
    /// Kind of the features.
    pub of: FeatureViews,
    /// Relative views of the images, from the features that the hypotheses explain.
    pub views: Vec<RelativeView>,
}

impl FeatureProposals {
    /// Proposes geometries from features and any number of clicks.
    pub fn new(
        input: SearchInput,
        of: FeatureViews,
        record: &mut SearchRecord,
    ) -> Result<Self, EstimateError> {
        let SearchInput { prepared, clicks, parameters } = input;
        record.enter(Stage::Features)?;
        let features = prepared.features(of);
        let observed = clicks.observed();
        let evidence = FeatureEvidence {
            sets: features.sets.each_ref(),
            matches: &features.matches,
            frames: prepared.frames(),
            clicks: &observed,
            click_sigma: parameters.click_sigma,
        };
        let found = hypotheses_from_features(&evidence, &parameters.features, parameters.seed);
        record.cancel().check()?;
        record.note_matches(&features.matches);
        let frames = prepared.frames();
        let proposal = |f, by, matches| FeatureProposal { proposed: Proposed::by(by, f), matches };
        let given = prepared.given_fit();
        let of_given =
            given.map(|given| proposal(given.fundamental, ProposedBy::GivenMatches, given.inliers.clone()));
        let known = prepared.essential_of_features(of, parameters.seed);
        let known = known.map(|(f, matches)| proposal(f, ProposedBy::KnownCameras, matches));
        let free = found.into_iter().map(|h| proposal(h.fundamental, ProposedBy::Features, h.matches));
        let proposals: Vec<FeatureProposal> = of_given.into_iter().chain(known).chain(free).collect();
        let given_view = given.and_then(|given| view_of_pairs(&given.inliers, frames));
        let mut views: Vec<RelativeView> = Vec::new();
        let found = proposals.iter().filter_map(|p| view_of(&p.proposed.fundamental, features, frames));
        for view in given_view.into_iter().chain(found) {
            if !views.iter().any(|known| is_same_view(known, &view)) {
                views.push(view);
            }
            if views.len() >= parameters.features.views {
                break;
            }
        }
        views.truncate(parameters.features.views);
        let noted: Vec<HypothesisNote> = proposals.iter().map(|proposal| proposal.proposed.into()).collect();
        record.note_proposals(parameters.features.draws, &noted);
        Ok(Self { proposals, of, views })
    }

    /// Returns the proposed geometries.
    pub fn proposed(&self) -> Vec<Proposed> {
        self.proposals.iter().map(|proposal| proposal.proposed).collect()
    }

    /// Ranks the proposals under one of the views, together with `rivals` found before. `show` asks for the pencils
    /// through stand-ins, to look at; the geometry does not depend on them. `None` if no geometry passes through
    /// the clicks.
    pub fn ranked_under(
        &self,
        viewed: &ViewedPair,
        rivals: &[Estimate],
        show: bool,
        record: &mut SearchRecord,
    ) -> Result<Option<Ranked>, EstimateError> {
        if show && !viewed.input.clicks.chosen().is_empty() {
            match compare_pencils(viewed, record) {
                Ok(_) | Err(EstimateError::NoCandidates(_)) => {}
                Err(error) => return Err(error),
            }
        }
        record.enter(Stage::Validation)?;
        rank_proposed(&self.proposed(), rivals, viewed, record)
    }
}

/// Ranks proposed geometries by patches and features under a view, refines and judges them. Takes any number of
/// clicks. `None` if no geometry passes through them.
pub(super) fn judge_proposed(
    proposed: &[Proposed],
    viewed: &ViewedPair,
    record: &mut SearchRecord,
) -> Result<Option<Judged>, EstimateError> {
    let ranked = rank_proposed(proposed, &[], viewed, record)?;
    ranked.map(|ranked| ranked.judged(viewed, record)).transpose()
}

/// Ranks proposed geometries by patches and features under a view. `rivals` compete under the same support. `None`
/// if no geometry passes through the clicks.
fn rank_proposed(
    proposed: &[Proposed],
    rivals: &[Estimate],
    viewed: &ViewedPair,
    record: &mut SearchRecord,
) -> Result<Option<Ranked>, EstimateError> {
    let cancel = record.cancel();
    let proposals = ranked(proposed, rivals, viewed, cancel)?;
    if proposals.is_empty() {
        return Ok(None);
    }
    let (hypotheses, _) = distinct_hypotheses(&proposals, viewed, cancel)?;
    record.note_ranking(&hypotheses, Some(viewed.patches.fine()));
    Ok(Some(Ranked { proposals, hypotheses }))
}

/// Ranks proposed geometries by patches and features under a view, together with `rivals`.
pub(super) fn ranked(
    proposed: &[Proposed],
    rivals: &[Estimate],
    viewed: &ViewedPair,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    let SearchInput { clicks, parameters, .. } = viewed.input;
    let anchors = clicks.anchors();
    let anchors = anchors.first_chunk::<2>();
    let fine = viewed.patches.fine();
    let turn = viewed.patches.view().rotation;
    let starts: Vec<Proposal> =
        proposed.iter().filter_map(|f| Proposal::of(f, anchors, turn, fine)).collect();
    // Geometries found under the upright view compete under the same support.
    let rivals = rivals.iter().filter_map(|h| Proposal::of(&h.as_proposed()?, anchors, h.turn(), fine));
    rank_fine(fine, starts, rivals.collect(), &clicks.observed(), parameters, cancel)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{Clicks, Monitor, Parameters, SearchPlan};

    #[test]
    fn features_are_ranked_without_clicks_and_lines_are_measured_only_with_two() {
        let scene = ExactScene::aside();
        let (prepared, parameters) = (scene.prepared(), Parameters::default());
        let patches = prepared.patches_with_features(RelativeView::UPRIGHT, FeatureViews::Frontal);
        let proposed = [2.0, -3.0].map(|by| Proposed::by(ProposedBy::Features, scene.disturbed(by)));
        for pairs in [&[][..], &scene.clicks()] {
            let clicks = Clicks::for_plan(pairs, SearchPlan::Patches { clicks: 2 });
            let input = SearchInput { prepared: &prepared, clicks: &clicks, parameters: &parameters };
            let viewed = ViewedPair::new(input, std::sync::Arc::clone(&patches));
            let monitor = Monitor::silent();
            let mut record = SearchRecord::new(Instant::now(), &monitor);
            let found = judge_proposed(&proposed, &viewed, &mut record).unwrap().unwrap();
            let error = scene.error(&found.fundamental);
            assert!(error < 0.3, "{error} px with {} clicks", pairs.len());
            assert_eq!(found.origin.source, ProposedBy::Features);
            let best = &found.hypotheses[0].assessment;
            assert_eq!(best.lines.is_some(), pairs.len() == 2);
            assert!(best.support.is_some_and(|support| support.matches > 50));
        }
    }
}
