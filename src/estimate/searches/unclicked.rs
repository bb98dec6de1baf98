//! Search without clicks, or with one: covariant features, then lines through two of their matches.
//!
//! Proposals of features are ranked by patches and features and refined, as in the search with
//! clicks. If doubts remain, searches with lines follow, each through two putative matches. Two
//! right matches suffice there, while features need five or more. If half of the matches are right,
//! two right ones take 17 draws, and eight take 1,177 (paper, section 1).
//!
//! Stand-ins are not observations: fits and verdicts ignore them.

use super::features::FeatureProposals;
use super::judged::Judged;
use super::patches;
use super::record::SearchRecord;
use super::stand_ins::{drawn_stand_ins, farthest_apart, putative_matches};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::verdict::selection::{ClickedPairs, select};
use crate::estimate::{Clicks, EstimateError, PreparedPair};
use crate::features::FeatureViews;
use crate::image::RelativeView;

/// Searches with features and, if the result leaves doubts, with lines through drawn matches.
pub(in crate::estimate) fn search(
    input: SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let SearchInput { prepared, clicks, parameters } = input;
    let mut all: Vec<Judged> = Vec::new();
    for of in [FeatureViews::Frontal, FeatureViews::Slanted] {
        let proposals = FeatureProposals::new(input, of, record)?;
        let held = with_stand_ins(prepared, clicks, &proposals);
        let held = SearchInput { clicks: &held, ..input };
        if let Some(found) = proposals.judge_under_views(held, record, &mut all)? {
            return Ok(found);
        }
    }
    let features = prepared.features(FeatureViews::Slanted);
    let view = all.first().map_or(RelativeView::UPRIGHT, |found| found.patches.view());
    let patches = prepared.patches_with_features(view, FeatureViews::Slanted);
    let viewed = ViewedPair::new(input, patches);
    let putative = putative_matches(prepared, features, &viewed.patches);
    for pair in drawn_stand_ins(prepared, &putative, parameters.features.stand_ins, parameters.seed) {
        let found = match patches::search(&viewed.with_clicks(&clicks.with_chosen(pair)), record) {
            Ok(found) => found,
            Err(EstimateError::NoCandidates(_) | EstimateError::NoGeometry) => continue,
            Err(error) => return Err(error),
        };
        let is_open = found.is_open();
        all.push(found);
        if !is_open {
            break;
        }
    }
    let best = select(&all, &ClickedPairs::of(input)).map(|k| all.swap_remove(k));
    best.ok_or(EstimateError::NothingWithoutClicks)
}

/// Returns the clicks, with two matches that the leading proposal explains as stand-ins, if there
/// are any.
fn with_stand_ins(prepared: &PreparedPair, clicks: &Clicks, proposals: &FeatureProposals) -> Clicks {
    let view = proposals.views.first().copied().unwrap_or(RelativeView::UPRIGHT);
    let patches = prepared.patches_with_features(view, proposals.of);
    let putative = putative_matches(prepared, prepared.features(proposals.of), &patches);
    let leader = proposals.proposals.first();
    let pair = leader.and_then(|leader| {
        farthest_apart(prepared, &leader.proposed.fundamental, &leader.matches, &putative)
    });
    pair.map_or_else(|| clicks.clone(), |pair| clicks.with_chosen(pair))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use rand::RngExt;

    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::estimate::sampling::{Purpose, stream};
    use crate::estimate::{
        ClickRole, Estimate, Match, Method, Monitor, Parameters, Preset, Reason, Uncertainty, Verdict,
        estimate_fundamental, estimate_prepared,
    };
    use crate::geometry::PointPair;
    use crate::image::GrayPlane;

    #[test]
    fn no_click_is_needed_and_stand_ins_are_no_observations() {
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
    fn known_cameras_give_an_essential_matrix_unless_the_images_contradict_them() {
        let scene = ExactScene::aside();
        let run = |ratios: [f64; 2]| {
            let prepared = scene.prepared().with_calibrations(Some(ExactScene::calibrations(ratios)));
            estimate_prepared(&prepared, &[], &Parameters::default(), &Monitor::silent()).unwrap()
        };
        let is_posed = |found: &Estimate| found.assessment.refinement.as_ref().unwrap().is_posed;
        // With one focal length twice as long, the best essential matrix is 1.2 px off; with both, 0.2 px.
        let [right, wrong] = [[1.0, 1.0], [1.0, 2.0]].map(run);
        assert!(is_posed(&right) && !is_posed(&wrong));
        for found in [&right, &wrong] {
            let error = scene.error(found.fundamental());
            assert!(error < 0.3, "{error} px");
        }
    }

    #[test]
    fn matches_from_elsewhere_compete_and_the_images_judge_them() {
        let scene = ExactScene::aside();
        let run = |matches: &[PointPair]| {
            let mut prepared = scene.prepared();
            if !matches.is_empty() {
                let matches: Vec<Match> = matches.iter().copied().map(Match::from).collect();
                prepared.add_matches(&matches, 0).unwrap();
            }
            estimate_prepared(&prepared, &[], &Parameters::default(), &Monitor::silent()).unwrap()
        };
        let (right, alone) = (run(&scene.pairs(60)), run(&[]));
        let [with, without] = [&right, &alone].map(|found| scene.error(found.fundamental()));
        // Sixty exact matches have less noise than the patches of the images.
        assert!(with < without && without < 0.3, "{with} px, {without} px without");
        let verdict = |found: &Estimate| found.assessment.trust.as_ref().unwrap().verdict;
        assert_eq!(verdict(&right), verdict(&alone), "as strict as without");
        // Matches of another motion agree with each other, and not with the images.
        let other = ExactScene::moved([0.3, 0.02, 0.3]);
        let misled = run(&other.pairs(60));
        assert!(scene.error(misled.fundamental()) < 0.3, "{}", scene.error(misled.fundamental()));
        // So do matches that are all wrong in one way, and their contradiction is told first.
        let lower = |m: PointPair| PointPair::new(m.point1.x, m.point1.y, m.point2.x, m.point2.y + 25.0);
        let misled = run(&scene.pairs(60).into_iter().map(lower).collect::<Vec<_>>());
        assert!(scene.error(misled.fundamental()) < 0.3, "{}", scene.error(misled.fundamental()));
        let reasons = &misled.assessment.trust.as_ref().unwrap().reasons;
        assert!(matches!(reasons[0], Reason::GivenContradict { .. }), "{reasons:?}");
    }

    #[test]
    fn matches_from_elsewhere_decide_where_the_images_show_nothing_and_are_not_trusted() {
        let scene = ExactScene::aside();
        // Noise without any common texture.
        let noise = |seed: u64| {
            let rng = RefCell::new(stream(seed, Purpose::PutativePairs, 0));
            GrayPlane::from_fn(FRAME, |_, _| 255.0 * rng.borrow_mut().random::<f32>())
        };
        let mut prepared = PreparedPair::new(&noise(1), &noise(2));
        let matches: Vec<Match> = scene.pairs(60).into_iter().map(Match::from).collect();
        prepared.add_matches(&matches, 0).unwrap();
        let found = estimate_prepared(&prepared, &[], &Parameters::default(), &Monitor::silent()).unwrap();
        let trust = found.assessment.trust.as_ref().unwrap();
        assert_eq!(trust.verdict, Verdict::Unreliable);
        assert!(trust.reasons.contains(&Reason::GivenAlone { matches: 60 }), "{:?}", trust.reasons);
        assert!(found.assessment.of_given);
        let error = scene.error(found.fundamental());
        assert!(error < 0.01, "{error} px");
    }

    #[test]
    fn matches_alone_give_their_own_geometry_and_the_images_judge_it() {
        let scene = ExactScene::aside();
        let run = |matches: &[PointPair], clicks: &[PointPair]| {
            let mut prepared = scene.prepared();
            let matches: Vec<Match> = matches.iter().copied().map(Match::from).collect();
            prepared.add_matches(&matches, 0).unwrap();
            let mut parameters = Parameters::default();
            parameters.features.given_alone = true;
            let found = estimate_prepared(&prepared, clicks, &parameters, &Monitor::silent()).unwrap();
            let verdict = found.assessment.trust.as_ref().unwrap().verdict;
            let fit = estimate_fundamental(&matches, prepared.frames(), 0).unwrap();
            assert_eq!(found.fundamental(), &fit.fundamental, "nothing else weighs in the fit");
            assert!(found.assessment.of_given);
            let of = |uncertainty: &Uncertainty| uncertainty.covariance();
            assert_eq!(found.uncertainty().map(of), fit.uncertainty.as_ref().map(of));
            verdict
        };
        let right = scene.pairs(60);
        let lower = |m: &PointPair| PointPair::new(m.point1.x, m.point1.y, m.point2.x, m.point2.y + 25.0);
        let wrong: Vec<PointPair> = right.iter().map(lower).collect();
        for clicks in [&[][..], &scene.clicks()] {
            let own =
                estimate_prepared(&scene.prepared(), clicks, &Parameters::default(), &Monitor::silent());
            assert_eq!(run(&right, clicks), own.unwrap().assessment.trust.as_ref().unwrap().verdict);
            assert_eq!(run(&wrong, clicks), Verdict::Unreliable);
        }
    }

    #[test]
    fn given_matches_that_agree_on_nothing_do_not_give_way_to_those_of_the_images() {
        let scene = ExactScene::aside();
        let mut prepared = scene.prepared();
        // The places in image 2 are those of other points.
        let pairs = scene.pairs(9);
        let exchanged = pairs.iter().zip(pairs.iter().rev());
        let few: Vec<Match> = exchanged.map(|(a, b)| PointPair { point2: b.point2, ..*a }.into()).collect();
        let error = prepared.add_matches(&few, 0).unwrap_err();
        let run = |given_alone| {
            let mut parameters = Parameters::default();
            parameters.features.given_alone = given_alone;
            estimate_prepared(&prepared, &[], &parameters, &Monitor::silent())
        };
        assert_eq!(run(true).unwrap_err(), EstimateError::Given(error));
        assert!(!run(false).unwrap().assessment.of_given);
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
        // 4.3 to 5.0 px with 20 seeds: 600 lines of a side of 320 px are 2 px apart, and nothing refines.
        assert!(error < 5.5, "{error} px");
    }
}
