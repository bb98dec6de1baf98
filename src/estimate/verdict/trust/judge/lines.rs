//! Tests of the lines near the matches.
//!
//! Where the images propose a geometry, the probability of its lines decides, and counts explain what cost most. Even
//! probable lines are doubted if more distinctive matches contradict them than a right geometry leaves. A
//! geometry of given matches or of clicks alone, and one of lines alone, has tests of its support in place of the
//! probability.

use super::TestResult::{self, Failed, NotAsked, Passed, Refuted};
use crate::estimate::verdict::constants::{CLEAR_MARGIN, ENOUGH_MATCHES, EVEN, FAR_TOO_FEW, SURE_LINES};
use crate::estimate::verdict::trust::case::{Case, Distinctive, GivenPoints, RefinedOn};
use crate::estimate::verdict::trust::lines::LineEvidence;
use crate::estimate::verdict::trust::{Missing, Reason};

/// Returns the results of the tests.
pub(super) fn tests(case: &Case) -> Vec<TestResult> {
    let missing = case.missing_matches().map(NotAsked);
    let tests = match (case.refined_on, &case.lines) {
        (RefinedOn::Points(points), _) => vec![of_points(points), rival(case)],
        (_, Some(lines)) => of_the_images(lines, case),
        (_, None) => vec![few(case), of_given(case), rival(case), contradicted(case)],
    };
    missing.into_iter().chain(tests).collect()
}

/// Returns what speaks against lines that rest on the images, if they are not probable enough: what cost most.
fn of_the_images(lines: &LineEvidence, case: &Case) -> Vec<TestResult> {
    let probability = lines.probability();
    if probability >= SURE_LINES {
        // Distinctive matches may follow another motion than the lines: a bent sheet, something fixed to the picture.
        return vec![TestResult::of(case.distinctive.and_then(contradiction))];
    }
    if let Some(reason) = different_scenes(case).filter(|_| probability < EVEN) {
        return vec![Refuted(reason)];
    }
    let mut reasons = Vec::new();
    if lines.probability_without_rival() >= SURE_LINES {
        reasons.push(Reason::Ambiguous { margin: lines.margin() });
    } else {
        if let RefinedOn::Matches(matches) = case.refined_on
            && matches < ENOUGH_MATCHES
        {
            reasons.push(Reason::FewMatches { matches });
        }
        let matches = case.unguided.map_or(0, |agreement| agreement.matches);
        reasons.push(Reason::ByChance { agreeing: case.unguided_on_lines, matches });
        reasons.extend(case.distinctive.and_then(contradiction));
    }
    let doubted = if probability < EVEN { Refuted } else { Failed };
    reasons.into_iter().map(doubted).collect()
}

/// Returns the reason to take the pictures for those of different scenes: the matches found without the geometry agree
/// with it by chance, and few match along its lines.
fn different_scenes(case: &Case) -> Option<Reason> {
    let agreement = case.unguided.filter(|agreement| !agreement.is_no_chance())?;
    let is_few = !matches!(case.refined_on, RefinedOn::Matches(matches) if matches >= ENOUGH_MATCHES);
    is_few.then_some(Reason::DifferentScenes {
        agreeing: case.unguided_on_lines,
        by_chance: case.unguided_by_chance,
        matches: agreement.matches,
    })
}

/// Tests given matches without pictures, which nothing confirms.
fn of_points(points: GivenPoints) -> TestResult {
    let GivenPoints { agreeing, matches, is_chance } = points;
    if is_chance {
        Refuted(Reason::PointsByChance { agreeing, matches })
    } else {
        Failed(Reason::PointsAlone { agreeing, matches })
    }
}

fn few(case: &Case) -> TestResult {
    match case.refined_on {
        RefinedOn::Matches(matches) | RefinedOn::Given(matches) if matches < FAR_TOO_FEW => {
            Refuted(Reason::FewMatches { matches })
        }
        RefinedOn::Matches(matches) | RefinedOn::Given(matches) if matches < ENOUGH_MATCHES => {
            Failed(Reason::FewMatches { matches })
        }
        _ => Passed,
    }
}

/// Tests whether the images confirm the geometry of given matches alone.
fn of_given(case: &Case) -> TestResult {
    let (RefinedOn::Given(_), Some(given)) = (case.refined_on, case.given) else { return Passed };
    match case.unguided {
        None => NotAsked(Missing::Refinement),
        Some(agreement) if agreement.is_no_chance() => Passed,
        Some(_) => Refuted(Reason::GivenAlone { matches: given.matches }),
    }
}

/// Tests the lead over the best clearly different geometry. Without such a geometry, there is none to fear.
pub(super) fn rival(case: &Case) -> TestResult {
    let Some(margin) = case.margin.filter(|margin| *margin < CLEAR_MARGIN) else { return Passed };
    // No search has preferred a geometry of given matches or of clicks alone.
    let is_given = matches!(case.refined_on, RefinedOn::Given(_) | RefinedOn::Clicks);
    let is_beaten = is_given && margin < -CLEAR_MARGIN;
    (if is_beaten { Refuted } else { Failed })(Reason::Ambiguous { margin })
}

fn contradicted(case: &Case) -> TestResult {
    match case.refined_on {
        RefinedOn::Clicks => TestResult::of(case.distinctive.and_then(contradiction)),
        _ => case.test(case.distinctive, Missing::Matches, contradiction),
    }
}

fn contradiction(distinctive: Distinctive) -> Option<Reason> {
    let Distinctive { all: matches, off: contradicting } = distinctive;
    distinctive.contradict().then_some(Reason::Contradicted { contradicting, matches })
}

#[cfg(test)]
mod tests {
    use super::super::examples::{BEATEN, BY_CHANCE, EQUALLED, GOOD, SUPPORTED, clicks, reasons, verdict};
    use super::*;
    use crate::estimate::fit::false_alarms::{Agreement, OF_LINES};
    use crate::estimate::verdict::trust::case::GivenFigures;
    use crate::estimate::{Trust, Verdict};

    #[test]
    fn probable_lines_are_doubted_if_more_distinctive_matches_contradict_them_than_right_lines_leave() {
        let of = |all, off| reasons(&Case { distinctive: Some(Distinctive { all, off }), ..GOOD });
        // If each of 18 is off with probability an eighth, 8 or more are in 0.08 % of the cases, and 7 in 0.4 %.
        assert_eq!(of(18, 8), [Reason::Contradicted { contradicting: 8, matches: 18 }]);
        assert_eq!(of(18, 7), []);
        assert_eq!(of(3, 3), [], "too few to tell");
    }

    #[test]
    fn what_cost_most_explains_improbable_lines() {
        let weak = Case {
            lines: Some(BY_CHANCE),
            refined_on: RefinedOn::Matches(40),
            unguided: Some(Agreement::of(vec![0.01; 20], OF_LINES)),
            unguided_on_lines: 3,
            distinctive: Some(Distinctive { all: 100, off: 80 }),
            ..GOOD
        };
        let expected = [
            Reason::FewMatches { matches: 40 },
            Reason::ByChance { agreeing: 3, matches: 20 },
            Reason::Contradicted { contradicting: 80, matches: 100 },
        ];
        assert_eq!(reasons(&weak), expected);
        assert_eq!(reasons(&Case { lines: Some(EQUALLED), ..GOOD }), [Reason::Ambiguous { margin: 0.02 }]);
        // Lines that are less likely than those of a rival are wrong.
        let beaten = Trust::judge(&Case { lines: Some(BEATEN), ..GOOD });
        assert_eq!((beaten.verdict, beaten.reasons.len()), (Verdict::Unreliable, 1));
        assert!(matches!(beaten.reasons[0], Reason::Ambiguous { margin } if margin < 0.0));
    }

    #[test]
    fn pictures_of_different_scenes_are_named_so_only_without_clicks() {
        let chance = Case {
            lines: Some(BY_CHANCE),
            refined_on: RefinedOn::Matches(ENOUGH_MATCHES - 1),
            unguided: Some(Agreement::of(vec![0.5; 20], OF_LINES)),
            unguided_on_lines: 3,
            unguided_by_chance: 11,
            ..GOOD
        };
        let told = Reason::DifferentScenes { agreeing: 3, by_chance: 11, matches: 20 };
        let clicked = Trust::judge(&chance);
        assert_eq!((clicked.verdict, &clicked.reasons[..]), (Verdict::Unreliable, &[told.clone()][..]));
        assert!(!clicked.determines_the_epipole());
        let unclicked = Case { clicks: clicks(&[]), ..chance };
        assert_eq!(
            Trust::judge(&unclicked),
            Trust { verdict: Verdict::DifferentScenes, reasons: vec![told] }
        );
        // Many matches along the lines are no chance, nor are probable lines.
        let many = Case { refined_on: RefinedOn::Matches(ENOUGH_MATCHES), ..unclicked.clone() };
        assert_eq!(verdict(&many), Verdict::Unreliable);
        assert_eq!(verdict(&Case { lines: GOOD.lines, ..unclicked }), Verdict::Reliable);
    }

    #[test]
    fn counts_and_margins_do_not_decide_where_the_images_show_the_lines() {
        let distinctive = Some(Distinctive { all: 20, off: 20 });
        let case = Case { refined_on: RefinedOn::Matches(10), margin: Some(0.05), ..GOOD };
        assert_eq!(reasons(&case), []);
        let case = Case { distinctive, ..case };
        assert_eq!(reasons(&case), [Reason::Contradicted { contradicting: 20, matches: 20 }]);
        let expected = [
            Reason::FewMatches { matches: 10 },
            Reason::Ambiguous { margin: 0.05 },
            Reason::Contradicted { contradicting: 20, matches: 20 },
        ];
        assert_eq!(reasons(&Case { lines: None, ..case }), expected);
    }

    #[test]
    fn few_matches_and_a_near_rival_are_doubts_about_given_matches_and_far_too_few_refute() {
        let of = |matches, margin| {
            verdict(&Case { refined_on: RefinedOn::Given(matches), margin: Some(margin), ..SUPPORTED })
        };
        let [good, doubted, bad] = [Verdict::Reliable, Verdict::Doubtful, Verdict::Unreliable];
        let few = [ENOUGH_MATCHES, ENOUGH_MATCHES - 1, FAR_TOO_FEW, FAR_TOO_FEW - 1];
        assert_eq!(few.map(|matches| of(matches, 0.5)), [good, doubted, doubted, bad]);
        let margins = [CLEAR_MARGIN, CLEAR_MARGIN - 1e-9, -CLEAR_MARGIN, -CLEAR_MARGIN - 1e-9];
        assert_eq!(margins.map(|margin| of(300, margin)), [good, doubted, doubted, bad]);
        let on_clicks =
            |margin| verdict(&Case { refined_on: RefinedOn::Clicks, margin: Some(margin), ..SUPPORTED });
        assert_eq!([-0.1, -0.5].map(on_clicks), [doubted, bad]);
    }

    #[test]
    fn given_matches_that_the_images_support_by_chance_alone_are_unreliable() {
        let with = |by_chance, refined_on| {
            let unguided = Some(Agreement::of([by_chance; 40], OF_LINES));
            let given = Some(GivenFigures { matches: 16, off: 0, distance: 0.8 });
            Trust::judge(&Case { unguided, unguided_on_lines: 3, given, refined_on, ..SUPPORTED })
        };
        let [given, clicks] = [RefinedOn::Given(300), RefinedOn::Clicks];
        assert_eq!(with(0.01, given).reasons, []);
        let unreliable = |reason| Trust { verdict: Verdict::Unreliable, reasons: vec![reason] };
        assert_eq!(with(0.9, given), unreliable(Reason::GivenAlone { matches: 16 }));
        // The clicks contradict the images, and are told so.
        assert_eq!(with(0.9, clicks).reasons, [Reason::ClicksAlone]);
    }

    #[test]
    fn a_geometry_that_distinctive_matches_contradict_is_doubtful() {
        let reasons = |all, off| {
            let distinctive = Some(Distinctive { all, off });
            reasons(&Case { distinctive, ..SUPPORTED })
        };
        // All of three are off twice in a thousand times, if each is with probability an eighth, and all of four twice in
        // ten thousand.
        assert_eq!(reasons(3, 3), []);
        assert_eq!(reasons(4, 4), [Reason::Contradicted { contradicting: 4, matches: 4 }]);
        assert_eq!(reasons(20, 8), []);
        assert_eq!(reasons(20, 9), [Reason::Contradicted { contradicting: 9, matches: 20 }]);
        assert_eq!(reasons(0, 0), []);
    }
}
