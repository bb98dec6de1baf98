//! Search with patches: one pass after another proposes, until no further search could find a better geometry.
//!
//! Lines through two clicks propose first. Without two clicks, covariant features do. If doubts remain, lines through
//! two putative matches follow there. Two right matches suffice for them, while features need five or more. If half
//! of the matches are right, two right ones take 17 draws, and eight take 1,177 (paper, section 1).
//!
//! Stand-ins for clicks are not observations: fits and verdicts ignore them.
//!
//! If chance gives as good a geometry as the best one of a pass (one false alarm or more), none is refined before the
//! next pass. The geometries compete with those of the next pass as they are.

use std::cell::LazyCell;
use std::sync::Arc;

use super::clicks_alone::of_clicks_alone;
use super::features::FeatureProposals;
use super::judged::{Found, Judged};
use super::more_features::with_more_features;
use super::patches;
use super::ranked::Ranked;
use super::record::SearchRecord;
use super::stand_ins::{drawn_stand_ins, putative_matches, with_stand_ins};
use crate::estimate::evidence::patches::PatchLevels;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::fit::fit_matches;
use crate::estimate::verdict::assessment::{RestsOn, unguided_agreement};
use crate::estimate::verdict::selection::{ClickedPairs, select};
use crate::estimate::{Clicks, Estimate, EstimateError, Match, Proposed, ProposedBy, SearchPlan};
use crate::features::FeatureViews;
use crate::image::RelativeView;

/// What proposes in one pass of a search.
#[derive(Debug, Clone, Copy)]
enum Pass {
    /// Lines through two clicks.
    Clicks,
    /// Covariant features, and the views that they suggest.
    Features(FeatureViews),
    /// Lines through two putative matches, for several pairs of them.
    StandIns,
}

impl Pass {
    /// Returns the passes of a search, the fastest first.
    fn all(plan: SearchPlan) -> [Self; 3] {
        let [frontal, slanted] = [FeatureViews::Frontal, FeatureViews::Slanted].map(Self::Features);
        match plan {
            SearchPlan::Unclicked => [frontal, slanted, Self::StandIns],
            _ => [Self::Clicks, frontal, slanted],
        }
    }
}

/// Runs the passes of a search until one leaves nothing to find. The best of all judged geometries is the result,
/// unless the clicks agree on another one.
pub(in crate::estimate) fn search(
    input: SearchInput,
    plan: SearchPlan,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let failure = EstimateError::NothingWithoutClicks;
    let mut passes = Passes { input, all: Vec::new(), postponed: Vec::new(), first: None, failure };
    for pass in Pass::all(plan) {
        passes.run(pass, record)?;
        if passes.is_finished() {
            break;
        }
    }
    passes.judge_postponed(record)?;
    let Passes { mut all, failure, .. } = passes;
    let best = select(&all, &ClickedPairs::of(input)).map(|k| all.swap_remove(k)).ok_or(failure)?;
    Ok(overruled_by_clicks(best, input, record))
}

/// Geometries that the passes of a search found.
struct Passes<'a> {
    input: SearchInput<'a>,
    /// Every judged geometry. Only the last one can leave nothing to find.
    all: Vec<Judged>,
    /// Ranked geometries whose best one chance explains. They are refined only if the other passes find nothing.
    postponed: Vec<Postponed>,
    /// The first geometries that were found.
    first: Option<First>,
    /// Error if no pass finds a geometry.
    failure: EstimateError,
}

/// Ranked geometries with the clicks and the patches by which they were found.
struct Postponed {
    ranked: Ranked,
    clicks: Clicks,
    patches: Arc<PatchLevels>,
}

/// The first geometries that were found. They compete with the geometries of all later passes.
struct First {
    hypotheses: Vec<Estimate>,
    view: RelativeView,
}

impl Passes<'_> {
    /// Returns whether no further search could find a better geometry.
    fn is_finished(&self) -> bool {
        self.all.last().is_some_and(|found| !found.is_open())
    }

    fn run(&mut self, pass: Pass, record: &mut SearchRecord) -> Result<(), EstimateError> {
        match pass {
            Pass::Clicks => match self.lines_through(self.input.clicks, true, record) {
                Err(error @ (EstimateError::NoCandidates(_) | EstimateError::NoGeometry)) => {
                    self.failure = error;
                    Ok(())
                }
                done => done,
            },
            Pass::Features(of) => self.features(of, record),
            Pass::StandIns => self.stand_ins(record),
        }
    }

    /// Refines and judges ranked geometries. If chance explains the best one, another pass may come first.
    fn judge(
        &mut self,
        ranked: Ranked,
        viewed: &ViewedPair,
        may_wait: bool,
        record: &mut SearchRecord,
    ) -> Result<(), EstimateError> {
        let (input, view) = (viewed.input, viewed.patches.view());
        self.first.get_or_insert_with(|| First { hypotheses: ranked.hypotheses.clone(), view });
        if may_wait && input.parameters.refinement.refine && ranked.are_by_chance(viewed) {
            let (clicks, patches) = (input.clicks.clone(), Arc::clone(&viewed.patches));
            self.postponed.push(Postponed { ranked, clicks, patches });
            return Ok(());
        }
        let found = ranked.judged(viewed, record)?;
        self.all.push(with_more_features(found, input, record)?);
        Ok(())
    }

    /// Judges the geometries that chance explains if there are no others.
    fn judge_postponed(&mut self, record: &mut SearchRecord) -> Result<(), EstimateError> {
        let postponed = std::mem::take(&mut self.postponed);
        if self.all.is_empty() {
            for Postponed { ranked, clicks, patches } in postponed {
                let viewed = ViewedPair::new(SearchInput { clicks: &clicks, ..self.input }, patches);
                self.judge(ranked, &viewed, false, record)?;
            }
        }
        Ok(())
    }

    fn lines_through(
        &mut self,
        clicks: &Clicks,
        may_wait: bool,
        record: &mut SearchRecord,
    ) -> Result<(), EstimateError> {
        let input = SearchInput { clicks, ..self.input };
        let viewed = match &self.first {
            None => ViewedPair::upright(input),
            // Features have been found by now.
            Some(first) => {
                let of = FeatureViews::Slanted;
                ViewedPair::new(input, input.prepared.patches_with_features(first.view, of))
            }
        };
        let ranked = patches::ranked(&viewed, record)?;
        self.judge(ranked, &viewed, may_wait, record)
    }

    fn features(&mut self, of: FeatureViews, record: &mut SearchRecord) -> Result<(), EstimateError> {
        let proposals = FeatureProposals::new(self.input, of, record)?;
        let clicks = with_stand_ins(self.input, &proposals);
        let input = SearchInput { clicks: &clicks, ..self.input };
        for view in &proposals.views {
            let viewed = ViewedPair::new(input, input.prepared.patches_with_features(*view, of));
            let rivals = self.first.as_ref().map_or(&[][..], |first| &first.hypotheses);
            if let Some(ranked) = proposals.ranked_under(&viewed, rivals, self.first.is_none(), record)? {
                // Features of slanted surfaces follow frontal ones.
                self.judge(ranked, &viewed, of == FeatureViews::Frontal, record)?;
                if self.is_finished() {
                    break;
                }
            }
        }
        Ok(())
    }

    fn stand_ins(&mut self, record: &mut SearchRecord) -> Result<(), EstimateError> {
        let SearchInput { prepared, clicks, parameters } = self.input;
        let of = FeatureViews::Slanted;
        let view = self.first.as_ref().map_or(RelativeView::UPRIGHT, |first| first.view);
        let patches = prepared.patches_with_features(view, of);
        let putative = putative_matches(prepared, prepared.features(of), &patches);
        for pair in drawn_stand_ins(prepared, &putative, parameters.features.stand_ins, parameters.seed) {
            match self.lines_through(&clicks.with_chosen(pair), false, record) {
                Err(EstimateError::NoCandidates(_) | EstimateError::NoGeometry) => {}
                done => done?,
            }
            if self.is_finished() {
                break;
            }
        }
        Ok(())
    }
}

/// Returns the geometry of the clicks if they agree with each other and contradict the result, or if the result is one
/// of chance. It is judged under the view of the result, with the same rivals.
fn overruled_by_clicks(best: Judged, input: SearchInput, record: &mut SearchRecord) -> Judged {
    let (observed, click_sigma) = (input.clicks.observed(), input.parameters.click_sigma);
    // Given matches are no matches of the images, and may be right where these show nothing.
    let is_chance = LazyCell::new(|| {
        let agreement = || unguided_agreement(&best.patches, &best.fundamental, input.prepared.frames());
        !best.assessment.of_given && agreement().log_false_alarms >= 0.0
    });
    let posed = || {
        let (prepared, clicks) =
            (input.prepared, observed.iter().copied().map(Match::from).collect::<Vec<_>>());
        let calibrations = Some(prepared.calibrations()?);
        let fit = fit_matches(&clicks, prepared.frames(), calibrations, input.parameters.seed).ok()?;
        (fit.is_posed && fit.agreement.is_no_chance()).then_some(fit.fundamental)
    };
    let alone = of_clicks_alone(&observed, &best.fundamental, || *is_chance, click_sigma, posed);
    let Some(f) = alone else { return best };
    let viewed = ViewedPair::new(SearchInput { clicks: &best.clicks, ..input }, best.patches);
    let support = viewed.patches.measure(&f);
    let proposed = Proposed::by(ProposedBy::Clicks, f);
    let mut hypotheses = vec![Estimate::proposed(proposed, None, support)];
    hypotheses.extend(best.hypotheses);
    let found =
        Found { proposed, hypotheses, supporting: observed, refined: None, rests_on: RestsOn::ClicksAlone };
    Judged::of(found, &viewed, record)
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use rand::RngExt;

    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::estimate::sampling::{Purpose, stream};
    use crate::estimate::{
        ClickRole, Estimate, Match, Method, Monitor, Parameters, PreparedPair, Preset, Reason, Uncertainty,
        Verdict, estimate_fundamental, estimate_prepared,
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
    fn clicks_decide_where_the_images_show_nothing() {
        let scene = ExactScene::aside();
        let noise = |seed: u64| {
            let rng = RefCell::new(stream(seed, Purpose::PutativePairs, 0));
            GrayPlane::from_fn(FRAME, |_, _| 255.0 * rng.borrow_mut().random::<f32>())
        };
        let clicks = scene.pairs(8);
        let run = |count: usize, calibrations| {
            let prepared = PreparedPair::new(&noise(1), &noise(2)).with_calibrations(calibrations);
            estimate_prepared(&prepared, &clicks[..count], &Parameters::default(), &Monitor::silent())
                .unwrap()
        };
        // A pose has two unknowns fewer than F, so fewer clicks determine it and show that they agree.
        let known = |ratio: f64| Some(ExactScene::calibrations([ratio; 2]));
        let (eight, posed) = (run(8, None), run(7, known(1.0)));
        let others = [run(7, None), run(7, known(2.0))];
        for found in [&eight, &posed] {
            let error = scene.error(found.fundamental());
            assert!(error < 1e-3, "{error} px");
            let trust = found.assessment.trust.as_ref().unwrap();
            assert_eq!(trust.verdict, Verdict::Unreliable);
            assert!(trust.reasons.contains(&Reason::ClicksAlone), "{:?}", trust.reasons);
        }
        for found in &others {
            let error = scene.error(found.fundamental());
            assert!(error > 0.5, "{error} px");
        }
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
