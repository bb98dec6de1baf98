//! A geometry for which nobody has clicked two pairs: features propose, and two of their matches stand in for the clicks.
//!
//! What covariant features propose is ranked by patches and features and refined, as after clicks. Where that leaves
//! doubts, searches with lines follow, each through two putative matches: two right ones are enough, where features need
//! five or more (paper, section 1: at half of the matches right, 17 draws of two where eight points need 1,177).
//!
//! The pairs that stand in are no observations: no fit rests on them, and no verdict counts them.

use rand::RngExt;

use crate::estimate::evidence::features::MatchedFeatures;
use crate::estimate::evidence::patches::PatchLevels;
use crate::estimate::searches::features::{FeatureProposals, by_features};
use crate::estimate::searches::patches::by_patches;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::searches::search::{Judged, SearchInput, compared};
use crate::estimate::stream::{Purpose, stream};
use crate::estimate::verdict::selection::{self, ClickedPairs};
use crate::estimate::{EstimateError, PreparedPair, Stage};
use crate::features::FeatureViews;
use crate::geometry::{FundamentalMatrix, PointPair, apart_across_lines, sampson_distance};
use crate::image::RelativeView;

/// Searches with lines through drawn matches, at most.
const DRAWN: usize = 4;
/// Matches among which two are chosen that stand in for clicks.
const CHOSEN_FROM: usize = 120;
/// A match that stands in is this near to its line, as a fraction of the longer side.
const EXPLAINED: f64 = 0.002;
/// Drawn matches are at least this far from each other, as a fraction of the longer side: lines through nearer ones turn
/// far when one of them is a pixel off.
const APART: f64 = 0.2;
/// Draws after which a search for two that are far enough apart is given up.
const TRIES: usize = 200;
/// Features that are this much nearer to their match than to the next best stand out.
const DISTINCTIVE: f64 = 0.8;

/// The search without clicks, or with one.
pub(in crate::estimate) fn without_clicks(
    input: &SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let SearchInput { prepared, clicks, parameters, .. } = *input;
    record.enter(Stage::Features)?;
    let mut all: Vec<Judged> = Vec::new();
    for of in [FeatureViews::Frontal, FeatureViews::Slanted] {
        if let Some(decided) = by_views(input, of, record, &mut all)? {
            return Ok(decided);
        }
    }
    let features = prepared.features(FeatureViews::Slanted);
    let view = all.first().map_or(RelativeView::UPRIGHT, |found| found.patches.view());
    let source = prepared.similarity_source(view, parameters);
    let patches = prepared.patches_with_features(view, FeatureViews::Slanted);
    for chosen in drawn(prepared, &putative_matches(prepared, features, &patches), parameters.seed) {
        let clicks = clicks.with_chosen(chosen);
        let seen = SearchInput { source: &*source, patches: &patches, clicks: &clicks, ..*input };
        let found = match by_patches(&seen, record) {
            Ok(found) => seen.judged(record, found),
            Err(EstimateError::NoCandidates { .. } | EstimateError::NoGeometry) => continue,
            Err(error) => return Err(error),
        };
        let is_open = found.is_open();
        all.push(found);
        if !is_open {
            break;
        }
    }
    let clicked = ClickedPairs { pairs: &clicks.observed(), sigma: parameters.click_sigma };
    let best = selection::chosen(&all, &clicked).map(|k| all.swap_remove(k));
    best.ok_or(EstimateError::NothingWithoutClicks)
}

/// What features propose under each of the views that they suggest, added to the others; the first that leaves nothing
/// open is the result.
fn by_views(
    input: &SearchInput,
    of: FeatureViews,
    record: &mut SearchRecord,
    all: &mut Vec<Judged>,
) -> Result<Option<Judged>, EstimateError> {
    let SearchInput { prepared, clicks, parameters, .. } = *input;
    let FeatureProposals { hypotheses, views } = FeatureProposals::new(input, of)?;
    let proposed: Vec<FundamentalMatrix> = hypotheses.iter().map(|h| h.fundamental).collect();
    let view = views.first().copied().unwrap_or(RelativeView::UPRIGHT);
    let patches = prepared.patches_with_features(view, of);
    let putative = putative_matches(prepared, prepared.features(of), &patches);
    let of_leader = hypotheses
        .first()
        .and_then(|leader| chosen(prepared, &leader.fundamental, &leader.matches, &putative));
    let held = of_leader.map_or_else(|| clicks.clone(), |chosen| clicks.with_chosen(chosen));
    for view in views {
        let source = prepared.similarity_source(view, parameters);
        let patches = prepared.patches_with_features(view, of);
        let seen = SearchInput { source: &*source, patches: &patches, clicks: &held, ..*input };
        if all.is_empty() && of_leader.is_some() {
            // To look at; the geometry does without them.
            match compared(&seen, record) {
                Ok(_) | Err(EstimateError::NoCandidates { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let rivals = all.first().map_or(&[][..], |first: &Judged| &first.hypotheses);
        record.enter(Stage::Validation)?;
        let Some(found) = by_features(&seen, &proposed, rivals)? else { continue };
        let found = seen.judged(record, found);
        if !found.is_open() {
            return Ok(Some(found));
        }
        all.push(found);
    }
    Ok(None)
}

/// Matches that stand out whatever the geometry, those of features first.
fn putative_matches(
    prepared: &PreparedPair,
    features: &MatchedFeatures,
    patches: &PatchLevels,
) -> Vec<PointPair> {
    let features = features.matches.iter().filter(|m| m.ratio < DISTINCTIVE).map(|m| m.pair);
    let fine = patches.fine(prepared.pyramids());
    let full_size = fine.scales.map(f64::recip);
    let corners = fine.support.distinctive().into_iter().map(|m| m.rescaled(full_size));
    let frames = prepared.frames();
    let inside = |m: &PointPair| frames[0].contains(m.point1) && frames[1].contains(m.point2);
    features.chain(corners).filter(inside).collect()
}

/// Two of the putative matches that a geometry explains, or of its own ones where few are explained: those whose epipolar
/// lines are farthest apart in either image.
pub(in crate::estimate) fn chosen(
    prepared: &PreparedPair,
    f: &FundamentalMatrix,
    own: &[PointPair],
    putative: &[PointPair],
) -> Option<[PointPair; 2]> {
    let frames = prepared.frames();
    let sides = frames.map(|frame| frame.longer_side());
    let near = EXPLAINED * sides[0].max(sides[1]);
    let mut explained: Vec<PointPair> =
        putative.iter().copied().filter(|m| sampson_distance(f, m) < near).collect();
    if explained.len() < own.len().min(CHOSEN_FROM / 2) {
        explained = own.to_vec();
    }
    let step = explained.len().div_ceil(CHOSEN_FROM).max(1);
    let few: Vec<PointPair> = explained.into_iter().step_by(step).collect();
    let apart = |p: &PointPair, q: &PointPair| {
        let [in1, in2] = apart_across_lines(f, p, q);
        (in1 / sides[0]).min(in2 / sides[1])
    };
    let mut best: Option<(f64, [PointPair; 2])> = None;
    for (k, p) in few.iter().enumerate() {
        for q in &few[..k] {
            let distance = apart(p, q);
            if best.is_none_or(|(most, _)| distance > most) {
                best = Some((distance, [*q, *p]));
            }
        }
    }
    best.map(|(_, pairs)| pairs)
}

/// Two putative matches each time, far from each other in both images. The seed decides.
fn drawn(prepared: &PreparedPair, putative: &[PointPair], seed: u64) -> Vec<[PointPair; 2]> {
    let mut random = stream(seed, Purpose::PutativePairs, 0);
    let least = prepared.frames().map(|frame| APART * frame.longer_side());
    let mut drawn = Vec::new();
    if putative.len() < 2 {
        return drawn;
    }
    for _ in 0..TRIES {
        let [p, q] = [(); 2].map(|()| putative[random.random_range(0..putative.len())]);
        let apart = [(p.point1 - q.point1).norm(), (p.point2 - q.point2).norm()];
        if apart[0] > least[0] && apart[1] > least[1] {
            drawn.push([p, q]);
            if drawn.len() == DRAWN {
                break;
            }
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{ClickRole, Method, Monitor, Parameters, Preset, estimate_prepared};

    #[test]
    fn nobody_has_to_click_and_what_stands_in_is_no_observation() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let run = |pairs: &[PointPair]| {
            estimate_prepared(&prepared, pairs, &Parameters::default(), &Monitor::silent()).unwrap()
        };
        let [click, _] = scene.clicks();
        for pairs in [&[][..], &[click]] {
            let found = run(pairs);
            let error = scene.error(found.fundamental());
            assert!(error < 0.3, "{error} px with {} clicks", pairs.len());
            let trace = found.trace.as_ref().unwrap();
            let roles: Vec<ClickRole> = trace.clicks.iter().map(|click| click.role).collect();
            let expected = [ClickRole::Observed, ClickRole::Chosen, ClickRole::Chosen];
            assert_eq!(roles, expected[1 - pairs.len()..]);
            assert_eq!((trace.clicks.observed(), trace.clicks.chosen().len()), (pairs.to_vec(), 2));
            let shown: Vec<PointPair> = trace.pencils.iter().map(|pencils| pencils.click).collect();
            assert_eq!(shown, trace.clicks.chosen(), "to look at");
            assert_eq!(found.fundamental(), run(pairs).fundamental(), "the seed decides");
        }
    }

    #[test]
    fn lines_alone_need_no_click_either() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let mut parameters = Parameters { method: Method::LinesAlone, ..Parameters::from(Preset::Paper) };
        parameters.lines_alone.lines = 600;
        let found = estimate_prepared(&prepared, &[], &parameters, &Monitor::silent()).unwrap();
        let trace = found.trace.as_ref().unwrap();
        assert!(trace.clicks.is_empty() && trace.counts.candidates[0] > 50, "{:?}", trace.counts);
        assert!(found.assessment.trust.is_some());
        let error = scene.error(found.fundamental());
        assert!(error < 10.0, "{error} px");
    }

    #[test]
    fn drawn_matches_are_far_apart() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let putative = scene.pairs(60);
        let least = prepared.frames().map(|frame| APART * frame.longer_side());
        let pairs = drawn(&prepared, &putative, 5);
        assert_eq!(pairs.len(), DRAWN);
        for [p, q] in &pairs {
            assert!((p.point1 - q.point1).norm() > least[0] && (p.point2 - q.point2).norm() > least[1]);
        }
        assert_eq!(pairs, drawn(&prepared, &putative, 5), "the seed decides");
        assert!(drawn(&prepared, &putative[..1], 5).is_empty());
    }
}
