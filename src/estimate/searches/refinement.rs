//! Refinement of the leading geometries at full resolution, and the selection of one of them.

use rayon::prelude::*;

use super::judged::Found;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::patches::{self, Proposal, Refined, Settling};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::verdict::assessment::RestsOn;
use crate::estimate::verdict::constants::FAR_TOO_FEW;
use crate::estimate::verdict::selection::{ClickedPairs, select};
use crate::estimate::{Estimate, EstimateError, Origin, Proposed};

/// Refines the ranked proposals. The result reports `hypotheses`.
pub(super) fn refine_ranked(
    ranked: &[Proposal],
    hypotheses: Vec<Estimate>,
    viewed: &ViewedPair,
    cancel: &CancelFlag,
) -> Result<Found, EstimateError> {
    let fine = viewed.patches.fine();
    let full_size = fine.scales.map(f64::recip);
    let matches = ranked.first().map(|leader| fine.support.matches(&leader.fundamental, patches::BAND));
    let supporting = matches.iter().flatten().map(|m| m.pair.rescaled(full_size)).collect();
    // Without refinement, the result is the best hypothesis that most of the clicks do not refuse.
    let clicked = ClickedPairs::of(viewed.input);
    let first = hypotheses.iter().find(|h| !clicked.refuse(h.fundamental())).or(hypotheses.first());
    let first = first.and_then(Estimate::as_proposed).ok_or(EstimateError::NoGeometry)?;
    // Near-copies of the leader are refined, too. One of them may become better.
    let starts = ranked.iter().filter_map(|proposal| proposal.proposed(fine.scales));
    let (refined, origin) = refine_best(starts, viewed, cancel)?.unzip();
    let proposed = Proposed { origin: origin.unwrap_or(first.origin), ..first };
    Ok(Found { proposed, hypotheses, supporting, refined, rests_on: RestsOn::Images })
}

/// Refines the first starts at full resolution and returns the best, with the origin of its start. `None` if none
/// has enough matches, or if refinement is off.
pub(super) fn refine_best(
    starts: impl Iterator<Item = Proposed>,
    viewed: &ViewedPair,
    cancel: &CancelFlag,
) -> Result<Option<(Refined, Origin)>, EstimateError> {
    let SearchInput { prepared, parameters, .. } = viewed.input;
    let (patches, refinement) = (&viewed.patches, &parameters.refinement);
    let clicked = ClickedPairs::of(viewed.input);
    let refine = |start: &Proposed| {
        let refine = || patches.refine(&start.fundamental, &clicked.0, cancel);
        let refined = if cancel.is_cancelled() { None } else { refine() };
        refined.map(|refined| (refined, start.origin))
    };
    // Few matches do not overrule the clicks.
    let is_of_this_scene = |(refined, _): &(Refined, Origin)| {
        refined.refinement.matches.len() >= FAR_TOO_FEW || !clicked.refuse(&refined.fundamental)
    };
    let count = if refinement.refine { refinement.refined } else { 0 };
    let starts: Vec<Proposed> = if count == 0 { Vec::new() } else { starts.collect() };
    let (leaders, rest) = starts.split_at(count.min(starts.len()));
    let Some((first, others)) = leaders.split_first() else { return Ok(None) };
    // Most starts need the comparisons and alignments of the first one. In parallel, they would be
    // computed twice.
    let first = refine(first);
    cancel.check()?;
    // If the first start fails early, corners of the larger sizes are missing. A thread that made
    // them inside the parallel loop could take up another start while it waits, and that start
    // would wait for the same corners for ever.
    patches.prepare_refinement();
    let others: Vec<Option<(Refined, Origin)>> = others.par_iter().map(refine).collect();
    cancel.check()?;
    let mut all: Vec<(Refined, Origin)> =
        std::iter::once(first).chain(others).flatten().filter(is_of_this_scene).collect();
    let selected = |all: &[(Refined, Origin)]| select(all.iter().map(|(refined, _)| refined), &clicked);
    let best = selected(&all).map(|k| all[k].0.fundamental);
    // If clicks speak against the best geometry, starts that the clicks prefer are refined, too.
    if !clicked.0.is_empty() && best.is_none_or(|best| clicked.speak_against(&best)) {
        let mut preferred = clicked.preferred(rest, best.as_ref());
        preferred.truncate(count);
        let more: Vec<Option<(Refined, Origin)>> = preferred.par_iter().map(refine).collect();
        cancel.check()?;
        all.extend(more.into_iter().flatten().filter(is_of_this_scene));
    }
    let Some((best, origin)) = selected(&all).map(|k| all.swap_remove(k)) else { return Ok(None) };
    let settling = Settling {
        clicks: &clicked.0,
        given: prepared.given().filter(|given| given.fit.is_ok()).map_or(&[][..], |given| &given.all),
        calibrations: prepared.calibrations(),
        allows: &|f| !clicked.prefer(&best.fundamental, f),
        seed: parameters.seed,
    };
    let settled = patches.settle(&best.fundamental, &settling, cancel);
    cancel.check()?;
    Ok(Some((best.replaced_by(settled), origin)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{Clicks, Parameters, PreparedPair, ProposedBy, SearchPlan};
    use crate::features::FeatureViews;
    use crate::geometry::{FundamentalMatrix, PointPair};
    use crate::image::RelativeView;

    /// Returns the best of the starts after refinement.
    fn refined(
        prepared: &PreparedPair,
        starts: &[FundamentalMatrix],
        pairs: &[PointPair],
        threads: usize,
    ) -> Option<FundamentalMatrix> {
        let parameters = Parameters::default();
        let patches = prepared.patches_with_features(RelativeView::UPRIGHT, FeatureViews::Frontal);
        let clicks = Clicks::for_plan(pairs, SearchPlan::Patches { clicks: 2 });
        let input = SearchInput { prepared, clicks: &clicks, parameters: &parameters };
        let viewed = ViewedPair::new(input, patches);
        let starts = starts.iter().map(|f| Proposed::by(ProposedBy::Features, *f));
        let cancel = CancelFlag::default();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| refine_best(starts, &viewed, &cancel)).unwrap();
        found.map(|(refined, _)| refined.fundamental)
    }

    #[test]
    fn a_first_start_that_fails_blocks_neither_threads_nor_other_starts() {
        let scene = ExactScene::aside();
        let mut starts = vec![scene.disturbed(150.0)];
        starts.extend((1..8).map(|k| scene.disturbed(0.4 * f64::from(k))));
        // Each run prepares its own pair, so that its threads make the corners.
        let found = [1, 2, 4].map(|threads| refined(&scene.prepared(), &starts, &scene.clicks(), threads));
        assert!(scene.error(&found[0].unwrap()) < 0.2);
        assert!(found.iter().all(|f| *f == found[0]), "the same on any number of threads");
    }

    #[test]
    fn a_start_that_several_clicks_prefer_is_refined_at_any_rank() {
        let scene = ExactScene::aside();
        let mut starts: Vec<FundamentalMatrix> =
            (0..20).map(|k| scene.disturbed(60.0 + f64::from(k))).collect();
        starts.push(scene.disturbed(2.0));
        let prepared = scene.prepared();
        let error = |clicks: &[PointPair]| refined(&prepared, &starts, clicks, 2).map(|f| scene.error(&f));
        assert!(error(&scene.pairs(5)).unwrap() < 0.3);
        assert!(error(&[]).is_none_or(|error| error > 10.0), "nothing tells it from the others");
    }
}
