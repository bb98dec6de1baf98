//! Judgement of a case: one closed list of tests, and the verdict that follows from it.
//!
//! Each test asks a question that wrong geometries usually fail:
//! - the lines are probably right near the matches ([`lines`]);
//! - the clicks and the given matches lie on their lines;
//! - the matches determine the lines precisely;
//! - neither picture is a mirror image of the other, or taken through a fisheye lens;
//! - parallax determines the epipoles ([`epipole`]).
//!
//! A result is reliable if each test that applies was passed. A test that lacks its data is a doubt, which names
//! the data. The judgement is a pure function of the figures; `assessment` gathers them.

mod epipole;
mod lines;

use super::case::{BarcodeFigures, Case, GivenFigures, RefinedOn};
use super::{Missing, Reason, Suspect, Trust, Verdict};
use crate::estimate::fit::false_alarms::OF_LINES;
use crate::estimate::verdict::constants::{CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, LOOSEST, SURE_LINES};

/// Outcome of one test.
#[derive(Debug, Clone, PartialEq)]
enum TestResult {
    Passed,
    Failed(Reason),
    /// Failed so clearly that the result is unreliable.
    Refuted(Reason),
    /// The data of the test are missing.
    NotAsked(Missing),
}

use TestResult::{Failed, NotAsked, Passed, Refuted};

impl TestResult {
    fn of(failed: Option<Reason>) -> Self {
        failed.map_or(Passed, Failed)
    }

    fn into_reason(self) -> Option<Reason> {
        match self {
            Passed => None,
            Failed(reason) | Refuted(reason) => Some(reason),
            NotAsked(missing) => Some(missing.into()),
        }
    }
}

impl Trust {
    /// Judges a case.
    pub(in crate::estimate) fn judge(case: &Case) -> Self {
        let of_the_geometry = tests(case);
        let is_doubted = of_the_geometry.iter().any(|test| *test != Passed);
        let [far, near] = clicks(case, is_doubted);
        // Far clicks come first, because such a click is a mistake, and spoils other figures.
        let all: Vec<TestResult> = far.into_iter().chain(of_the_geometry).chain(near).collect();
        let is_refuted = all.iter().any(|test| matches!(test, Refuted(_)));
        let mut reasons: Vec<Reason> = Vec::new();
        for reason in all.into_iter().filter_map(TestResult::into_reason) {
            // Several tests may lack the same data.
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        let is_different = |reason: &Reason| matches!(reason, Reason::DifferentScenes { .. });
        let has_no_guide = case.clicks.is_empty() && case.given.is_none();
        let verdict = match (reasons.is_empty(), is_refuted) {
            (true, _) => Verdict::Reliable,
            (false, false) => Verdict::Doubtful,
            (false, true) if has_no_guide && reasons.iter().any(is_different) => Verdict::DifferentScenes,
            (false, true) => Verdict::Unreliable,
        };
        // Further failed tests give no advice about pictures that have nothing in common.
        if verdict == Verdict::DifferentScenes {
            reasons.retain(is_different);
        }
        Self { verdict, reasons }
    }
}

/// Returns the results of all tests that apply to a geometry, but those of the clicks.
fn tests(case: &Case) -> Vec<TestResult> {
    if let Some(figures) = case.barcodes {
        return of_barcodes(case, figures);
    }
    let has_pictures = !matches!(case.refined_on, RefinedOn::Points(_));
    // First, because people trust the matches that they give.
    let mut tests = vec![given(case)];
    tests.extend(lines::tests(case));
    tests.push(precision(case));
    if has_pictures {
        tests.push(mirror(case));
    }
    tests.extend(epipole::tests(case));
    if has_pictures {
        tests.push(lens(case));
    }
    tests
}

impl Case {
    /// Returns the data without which no test of matches can be asked, if they are missing.
    fn missing_matches(&self) -> Option<Missing> {
        match self.refined_on {
            RefinedOn::Matches(_) | RefinedOn::Given(_) | RefinedOn::Points(_) => None,
            RefinedOn::Clicks => Some(Missing::Agreement),
            _ if !self.patches => Some(Missing::Patches),
            RefinedOn::Nothing => Some(Missing::Refinement),
            RefinedOn::TooFewMatches => Some(Missing::Matches),
        }
    }

    /// Tests a figure of the matches, which lacks `missing` if the figure does.
    fn test<T>(
        &self,
        figure: Option<T>,
        missing: Missing,
        test: impl FnOnce(T) -> Option<Reason>,
    ) -> TestResult {
        let missing = self.missing_matches().or(figure.is_none().then_some(missing));
        match (figure, missing) {
            (Some(figure), None) => TestResult::of(test(figure)),
            (_, missing) => missing.map_or(Passed, NotAsked),
        }
    }
}

/// Tests the barcodes of two sequences.
fn of_barcodes(case: &Case, figures: BarcodeFigures) -> Vec<TestResult> {
    let BarcodeFigures { correlation, by_chance, lines, .. } = figures;
    let agreement = if correlation <= by_chance {
        Refuted(Reason::BarcodesByChance { correlation, by_chance })
    } else {
        Passed
    };
    // Twice the seven unknowns.
    let is_few = lines < 2.0 * OF_LINES.matches as f64;
    let few = is_few.then(|| Reason::FewBarcodes { lines: figures.whole_lines() });
    vec![agreement, TestResult::of(few), lines::rival(case), precision(case)]
}

/// Tests how precisely the matches determine the lines.
fn precision(case: &Case) -> TestResult {
    let is_loose = |deviation: &f64| *deviation > LOOSEST * case.side;
    if case.barcodes.is_some() {
        let loose = |deviation: f64| {
            TestResult::of(
                Some(deviation).filter(is_loose).map(|deviation| Reason::LooseBarcodes { deviation }),
            )
        };
        return case.deviation.map_or(NotAsked(Missing::Precision), loose);
    }
    case.test(case.deviation, Missing::Precision, |deviation| {
        Some(deviation).filter(is_loose).map(|deviation| Reason::Loose { deviation })
    })
}

fn mirror(case: &Case) -> TestResult {
    case.test(case.mirror, Missing::Matches, |mirror| {
        mirror.is_likely().then_some(Reason::Mirrored { matches: mirror.matches.flipped })
    })
}

fn lens(case: &Case) -> TestResult {
    case.test(case.strong_lens, Missing::Matches, |is_strong| is_strong.then_some(Reason::Fisheye))
}

/// Tests whether given matches contradict the geometry. Without any, there is nothing to ask.
fn given(case: &Case) -> TestResult {
    TestResult::of(case.given.filter(GivenFigures::contradict).map(
        |GivenFigures { matches, off, distance }| Reason::GivenContradict {
            contradicting: off,
            matches,
            distance,
        },
    ))
}

/// Tests the clicks. Returns the results of those that are far from their lines, and of the others.
fn clicks(case: &Case, is_doubted: bool) -> [Vec<TestResult>; 2] {
    let suspect = if is_doubted { Suspect::Geometry } else { Suspect::Click };
    let lines_are_doubted = case.lines.is_none_or(|lines| lines.probability() < SURE_LINES);
    let [mut far, mut near] = [Vec::new(), Vec::new()];
    for (k, distance) in case.clicks.iter().enumerate() {
        let deviations = distance / case.click_sigma;
        let reason = Reason::ClickOff { pair: k + 1, distance: *distance, suspect };
        if deviations > CLICK_DEVIATIONS_WRONG {
            // If the images show the lines, they have outvoted a mistaken click. Otherwise a click that is far off
            // makes the result unreliable.
            far.push(if is_doubted && lines_are_doubted { Refuted(reason) } else { Failed(reason) });
        } else if deviations > CLICK_DEVIATIONS {
            near.push(Failed(reason));
        }
    }
    [far, near]
}

#[cfg(test)]
mod examples;

#[cfg(test)]
mod tests {
    use super::examples::{BY_CHANCE, EQUALLED, GOOD, SUPPORTED, clicks, plane, reasons, verdict};
    use super::*;
    use crate::estimate::evidence::patches::MirrorMatches;
    use crate::estimate::verdict::trust::case::{GivenPoints, Mirror};

    #[test]
    fn a_result_is_reliable_only_if_each_test_was_passed() {
        assert_eq!(Trust::judge(&GOOD), Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        assert_eq!(verdict(&Case { margin: None, ..GOOD }), Verdict::Reliable, "no rival to fear");
        for worse in [
            Case { patches: false, refined_on: RefinedOn::TooFewMatches, ..GOOD },
            Case { refined_on: RefinedOn::TooFewMatches, ..GOOD },
            Case { lines: Some(EQUALLED), ..GOOD },
            Case { clicks: clicks(&[0.5, 5.0]), ..GOOD },
            Case { deviation: Some(3.0), ..GOOD },
            Case { plane: Some(plane(0.98, 5, 0.0)), ..GOOD },
            Case { plane: Some(plane(0.6, 5, 0.1)), ..GOOD },
            Case { strong_lens: Some(true), ..GOOD },
        ] {
            assert_eq!(verdict(&worse), Verdict::Doubtful);
        }
        assert_eq!(verdict(&Case { lines: Some(BY_CHANCE), ..GOOD }), Verdict::Unreliable);
    }

    #[test]
    fn a_test_without_its_data_is_a_doubt_that_names_them() {
        let untested = |missing| vec![Reason::Untested { missing }];
        let not_refined = || vec![Reason::NotRefined];
        let alone = Case { refined_on: RefinedOn::Given(300), ..SUPPORTED };
        for (case, expected) in [
            (Case { deviation: None, ..GOOD }, untested(Missing::Precision)),
            (Case { plane: None, ..GOOD }, untested(Missing::Relief)),
            (Case { relief: None, ..GOOD }, untested(Missing::Relief)),
            (Case { relief: None, ..alone.clone() }, untested(Missing::Relief)),
            (Case { pattern: None, ..GOOD }, untested(Missing::Neighbours)),
            (Case { mirror: None, ..GOOD }, not_refined()),
            (Case { strong_lens: None, ..GOOD }, not_refined()),
            (Case { distinctive: None, ..SUPPORTED }, not_refined()),
            (Case::default(), vec![Reason::NotChecked]),
            (Case { patches: true, ..Case::default() }, vec![Reason::RefinementOff]),
        ] {
            assert_eq!(Trust::judge(&case), Trust { verdict: Verdict::Doubtful, reasons: expected });
        }
        let given = Some(GivenFigures { matches: 300, off: 0, distance: 0.1 });
        let unconfirmed = Case { given, unguided: None, ..alone };
        assert_eq!(reasons(&unconfirmed), [Reason::RefinementOff]);
    }

    #[test]
    fn an_epipole_whose_tests_were_not_asked_is_not_determined() {
        let determines = |case: &Case| Trust::judge(case).determines_the_epipole();
        assert!(determines(&GOOD));
        assert!(determines(&Case { lines: Some(EQUALLED), ..GOOD }), "another question");
        assert!(!determines(&Case { relief: None, ..GOOD }));
        assert!(!determines(&Case { plane: Some(plane(0.98, 5, 0.0)), ..GOOD }));
        assert!(!determines(&Case { refined_on: RefinedOn::TooFewMatches, ..GOOD }));
    }

    #[test]
    fn points_without_pictures_are_never_reliable_and_unreliable_by_chance() {
        let of = |is_chance| {
            let points = GivenPoints { agreeing: 290, matches: 300, is_chance };
            Trust::judge(&Case { refined_on: RefinedOn::Points(points), mirror: None, ..GOOD })
        };
        let alone = Reason::PointsAlone { agreeing: 290, matches: 300 };
        assert_eq!(of(false), Trust { verdict: Verdict::Doubtful, reasons: vec![alone] });
        let by_chance = Reason::PointsByChance { agreeing: 290, matches: 300 };
        assert_eq!(of(true), Trust { verdict: Verdict::Unreliable, reasons: vec![by_chance] });
    }

    #[test]
    fn barcodes_are_tested_by_themselves() {
        let good =
            BarcodeFigures { correlation: 0.8, by_chance: 0.2, lines: 30.0, deviation: None, frames: 99 };
        let of = |barcodes, deviation| {
            Trust::judge(&Case { barcodes: Some(barcodes), deviation, side: 768.0, ..Case::default() })
        };
        assert_eq!(of(good, Some(0.5)).verdict, Verdict::Reliable);
        assert_eq!(of(good, Some(5.0)).reasons, [Reason::LooseBarcodes { deviation: 5.0 }]);
        assert_eq!(of(good, None).reasons, [Reason::Untested { missing: Missing::Precision }]);
        let few = BarcodeFigures { lines: 13.9, ..good };
        assert_eq!(of(few, Some(0.5)).reasons, [Reason::FewBarcodes { lines: 13 }]);
        let chance = BarcodeFigures { correlation: 0.2, ..good };
        assert_eq!(of(chance, Some(0.5)).verdict, Verdict::Unreliable);
    }

    #[test]
    fn a_click_is_blamed_only_if_nothing_else_speaks_against_the_geometry() {
        let off = |suspect| Reason::ClickOff { pair: 2, distance: 5.04, suspect };
        let case = Case { clicks: clicks(&[0.5, 5.04]), ..GOOD };
        assert_eq!(reasons(&case), [off(Suspect::Click)]);
        assert_eq!(reasons(&Case { lines: Some(EQUALLED), ..case })[1], off(Suspect::Geometry));
    }

    #[test]
    fn a_far_click_refutes_a_geometry_only_where_the_images_do_not_show_its_lines() {
        for (distance, is_far) in [(CLICK_DEVIATIONS_WRONG, false), (1.001 * CLICK_DEVIATIONS_WRONG, true)] {
            let far = Case { clicks: clicks(&[distance, 0.1]), ..GOOD };
            assert_eq!(verdict(&far), Verdict::Doubtful, "outvoted");
            let open = Case { plane: Some(plane(0.98, 5, 0.0)), ..far.clone() };
            assert_eq!(verdict(&open), Verdict::Doubtful, "outvoted beside a plane, too");
            let expected = if is_far { Verdict::Unreliable } else { Verdict::Doubtful };
            assert_eq!(verdict(&Case { lines: None, ..open }), expected);
            assert_eq!(verdict(&Case { lines: Some(EQUALLED), ..far.clone() }), expected);
            let first = |case: &Case| matches!(reasons(case)[0], Reason::ClickOff { .. });
            assert_eq!(first(&Case { lines: Some(EQUALLED), ..far }), is_far);
        }
    }

    #[test]
    fn a_pair_whose_corners_match_when_flipped_is_mirrored() {
        let reasons = |flipped, upright, is_suspect| {
            let matches = MirrorMatches { flipped, all_flipped: 100, upright, corners: 600, by_chance: 4e-4 };
            reasons(&Case { mirror: Some(Mirror { matches, is_suspect }), ..GOOD })
        };
        assert_eq!(reasons(59, 80, true), []);
        assert_eq!(reasons(60, 80, true), [Reason::Mirrored { matches: 60 }]);
        // A symmetric building matches either way, and better as it is.
        assert_eq!(reasons(14, 14, false), []);
        assert_eq!(reasons(14, 6, false), [Reason::Mirrored { matches: 14 }]);
        // Chance explains seven of a hundred.
        assert_eq!(reasons(7, 0, false), []);
    }

    #[test]
    fn given_matches_that_contradict_the_result_come_first() {
        let reasons = |off, margin| {
            let given = Some(GivenFigures { matches: 54, off, distance: 8.4 });
            reasons(&Case { given, margin: Some(margin), ..SUPPORTED })
        };
        // Of 54 coins, 38 show heads by chance (0.2 %), and 39 hardly do.
        assert_eq!(reasons(38, 0.5), []);
        let told = |contradicting| Reason::GivenContradict { contradicting, matches: 54, distance: 8.4 };
        assert_eq!(reasons(39, 0.5), [told(39)]);
        assert_eq!(reasons(54, 0.1), [told(54), Reason::Ambiguous { margin: 0.1 }]);
    }

    /// Tests both sides of thresholds, as close to them as the type of the number allows.
    #[test]
    fn each_threshold_is_where_its_constant_says() {
        let next = |v: f64| v * (1.0 + 1e-12);
        for silent in [
            Case { clicks: clicks(&[CLICK_DEVIATIONS]), ..GOOD },
            Case { clicks: clicks(&[2.0 * CLICK_DEVIATIONS]), click_sigma: 2.0, ..GOOD },
            Case { deviation: Some(LOOSEST * GOOD.side), ..GOOD },
        ] {
            assert_eq!(reasons(&silent), [], "{silent:?}");
        }
        let off = next(CLICK_DEVIATIONS);
        let deviation = next(LOOSEST * GOOD.side);
        let suspect = Suspect::Click;
        for (told, reason) in [
            (
                Case { clicks: clicks(&[0.1, off]), ..GOOD },
                Reason::ClickOff { pair: 2, distance: off, suspect },
            ),
            (
                Case { clicks: clicks(&[0.5 * off]), click_sigma: 0.5, ..GOOD },
                Reason::ClickOff { pair: 1, distance: 0.5 * off, suspect },
            ),
            (Case { deviation: Some(deviation), ..GOOD }, Reason::Loose { deviation }),
        ] {
            assert_eq!(reasons(&told), [reason], "{told:?}");
            assert_eq!(verdict(&told), Verdict::Doubtful, "{told:?}");
        }
    }
}
