//! Tests whether parallax determines the epipoles.

use super::TestResult::{self, NotAsked, Passed};
use crate::estimate::fit::ResidualPattern;
use crate::estimate::verdict::constants::{EVEN, PATTERN_SIZE, largest_error};
use crate::estimate::verdict::trust::case::Case;
use crate::estimate::verdict::trust::parallax::{Baseline, OffPlane, PlaneEvidence, Relief, Witnesses};
use crate::estimate::verdict::trust::{Missing, Reason};

/// Returns the results of the tests. Known cameras have their own. Without known cameras, a plane, a smooth warp and a
/// lens are three explanations of the same matches, so the simplest one that holds is told.
pub(super) fn tests(case: &Case) -> Vec<TestResult> {
    match case.baseline {
        Some(baseline) => of_known_cameras(baseline).into_iter().chain([pattern(case)]).collect(),
        None => vec![first_doubt(&[plane(case), relief(case), pattern(case)])],
    }
}

/// Returns the first failed test, or else the first one that was not asked.
fn first_doubt(tests: &[TestResult]) -> TestResult {
    let is_failed = |test: &&TestResult| !matches!(test, Passed | NotAsked(_));
    let is_open = |test: &&TestResult| **test != Passed;
    tests.iter().find(is_failed).or_else(|| tests.iter().find(is_open)).cloned().unwrap_or(Passed)
}

fn of_known_cameras(baseline: Baseline) -> [TestResult; 3] {
    let Baseline { beside, other, in_front, matches } = baseline;
    let Witnesses { along, across, on_warp: turned, .. } = beside;
    let turned = (!beside.show_the_epipole()).then_some(Reason::OnlyTurned { along, across, turned });
    let behind = baseline.is_behind().then_some(Reason::BehindCameras { in_front, matches });
    let other = other.filter(|other| !other.is_decided());
    let other = other.map(|other| Reason::Ambiguous { margin: other.margin() });
    [turned, behind, other].map(TestResult::of)
}

fn plane(case: &Case) -> TestResult {
    case.test(case.plane, Missing::Relief, |plane| {
        let PlaneEvidence { share, off: OffPlane { groups, agreeing, .. }, is_still } = plane;
        let percent = (100.0 * share) as u32;
        plane.leaves_the_epipoles_open(case.relief).then_some(Reason::OnePlane {
            percent,
            groups,
            agreeing,
            is_still,
        })
    })
}

fn relief(case: &Case) -> TestResult {
    case.test(case.relief.map(Relief::doubt), Missing::Relief, |doubt| {
        doubt.map(|Witnesses { along, across, on_warp, .. }| Reason::NoRelief { along, across, on_warp })
    })
}

/// Tests whether neighbouring matches are off their lines by the same distance.
fn pattern(case: &Case) -> TestResult {
    case.test(case.pattern, Missing::Neighbours, |pattern| {
        let ResidualPattern { share, size } = pattern;
        let is_bent = share > EVEN && size > PATTERN_SIZE * largest_error(case.side);
        is_bent.then_some(Reason::Pattern { size })
    })
}

#[cfg(test)]
mod tests {
    use super::super::examples::{GOOD, NOTHING, SHOWN, plane, reasons, verdict};
    use super::*;
    use crate::estimate::Verdict;
    use crate::estimate::fit::false_alarms::BY_CHANCE;
    use crate::estimate::verdict::constants::{ANY_EPIPOLE, HALF_PLANE, ONE_PLANE, USUAL_SIDE};
    use crate::estimate::verdict::trust::parallax::OtherPose;

    #[test]
    fn a_plane_does_not_leave_the_baseline_of_known_cameras_open() {
        let flat = Case { plane: Some(plane(0.99, 1, 1.0)), relief: None, ..GOOD };
        assert_eq!(verdict(&flat), Verdict::Doubtful);
        let many_wrong = Witnesses { on_warp: 80, along: 430, across: 40, off: 250 };
        let with = |beside, other| Case {
            baseline: Some(Baseline { beside, other, in_front: 290, matches: 300 }),
            ..flat.clone()
        };
        assert_eq!(verdict(&with(many_wrong, None)), Verdict::Reliable);
        let turned = Witnesses { on_warp: 400, along: 9, across: 11, off: 40 };
        assert_eq!(reasons(&with(turned, None)), [Reason::OnlyTurned { along: 9, across: 11, turned: 400 }]);
        let mut behind = with(many_wrong, None);
        behind.baseline = behind.baseline.map(|baseline| Baseline { in_front: 160, ..baseline });
        assert_eq!(reasons(&behind), [Reason::BehindCameras { in_front: 160, matches: 300 }]);
        let other = |this_only, other_only| Some(OtherPose { this_only, other_only });
        assert_eq!(verdict(&with(many_wrong, other(30, 2))), Verdict::Reliable);
        assert_eq!(reasons(&with(many_wrong, other(6, 5))), [Reason::Ambiguous { margin: 1.0 / 11.0 }]);
    }

    #[test]
    fn evidence_that_determines_the_epipoles_comes_before_evidence_that_is_less_likely_by_chance() {
        let off = |motions, by_chance| plane(0.6, motions, by_chance).off;
        let of = |off| verdict(&Case { plane: Some(PlaneEvidence { off, ..plane(0.6, 0, 0.0) }), ..GOOD });
        let (one_motion, held, open) = (off(1, 1e-9), off(5, 1e-4), off(5, 0.1));
        for (a, b) in [(one_motion, held), (held, one_motion)] {
            assert_eq!((a.or_stronger(b).motions, of(a.or_stronger(b))), (5, Verdict::Reliable));
        }
        let neither = one_motion.or_stronger(open);
        assert_eq!((neither.motions, of(neither)), (1, Verdict::Doubtful));
    }

    #[test]
    fn the_epipole_is_open_if_matches_off_the_warp_are_few_or_point_anywhere() {
        let reasons_of = |on_warp, along, across, off| {
            let beside = Witnesses { on_warp, along, across, off };
            let relief = Some(Relief { beside, further: NOTHING, finer: SHOWN, clear: SHOWN });
            reasons(&Case { relief, ..GOOD })
        };
        let told = |on_warp, along, across| [Reason::NoRelief { on_warp, along, across }];
        assert_eq!(reasons_of(380, 20, 0, 0), []);
        // Less than a twentieth.
        assert_eq!(reasons_of(381, 20, 0, 0), told(381, 20, 0));
        // So few may all be along, though a quarter of such matches are across.
        assert_eq!(reasons_of(0, 9, 0, 0), []);
        assert_eq!(reasons_of(0, 8, 0, 0), told(0, 8, 0));
        // A quarter across.
        assert_eq!(reasons_of(100, 400, 100, 100), []);
        assert_eq!(reasons_of(100, 400, 130, 130), told(100, 400, 130));
        // Clearly more of them off their lines.
        assert_eq!(reasons_of(100, 400, 0, 440), []);
        assert_eq!(reasons_of(100, 400, 0, 460), told(100, 400, 0));
        // Each two of them have an epipole, so chance explains few with others off their lines.
        assert_eq!(reasons_of(0, 14, 0, 5), []);
        assert_eq!(reasons_of(0, 9, 0, 3), told(0, 9, 0));
        // It vanishes beside a warp that follows the rows.
        let finer = Witnesses { on_warp: 395, along: 3, across: 2, off: 12 };
        let relief = Some(Relief { beside: SHOWN, further: NOTHING, finer, clear: SHOWN });
        assert_eq!(reasons(&Case { relief, ..GOOD }), told(395, 3, 2));
        // It rests on matches that are equalled elsewhere.
        let clear = Witnesses { on_warp: 0, along: 5, across: 1, off: 1 };
        let relief = Some(Relief { beside: SHOWN, further: NOTHING, finer: SHOWN, clear });
        assert_eq!(reasons(&Case { relief, ..GOOD }), told(0, 5, 1));
    }

    #[test]
    fn relief_beside_further_planes_decides_where_the_motions_are_too_few() {
        let few_motions = plane(0.6, ANY_EPIPOLE, 9.0);
        let shown = Witnesses { on_warp: 90, along: 30, across: 2, off: 8 };
        let open = Witnesses { on_warp: 90, along: 10, across: 8, off: 28 };
        let with = |plane, further| {
            let relief = Some(Relief { beside: SHOWN, further, finer: SHOWN, clear: SHOWN });
            verdict(&Case { plane: Some(plane), relief, ..GOOD })
        };
        assert_eq!(with(few_motions, shown), Verdict::Reliable);
        for further in [open, NOTHING] {
            assert_eq!(with(few_motions, further), Verdict::Doubtful);
        }
        // Few matches beside one plane, and a camera that stood still, are not made up for.
        assert_eq!(with(PlaneEvidence { share: 0.96, ..few_motions }, shown), Verdict::Doubtful);
        let still = PlaneEvidence { is_still: true, ..plane(0.6, 9, 0.0) };
        assert_eq!(with(still, shown), Verdict::Doubtful);
        // A far background stays in its place. Things that move by themselves seldom agree.
        for (agreeing, verdict) in [(50, Verdict::Doubtful), (51, Verdict::Reliable)] {
            let off = OffPlane { groups: 100, agreeing, ..still.off };
            assert_eq!(with(PlaneEvidence { share: HALF_PLANE, off, ..still }, shown), verdict);
        }
    }

    /// Tests both sides of thresholds, as close to them as the type of the number allows.
    #[test]
    fn each_threshold_is_where_its_constant_says() {
        let next = |v: f64| v * (1.0 + 1e-12);
        let beside = |motions, by_chance, motions_by_chance| OffPlane {
            motions,
            motions_by_chance,
            ..plane(0.0, 0, by_chance).off
        };
        let with = |share, off| Some(PlaneEvidence { off, ..plane(share, 0, 0.0) });
        let three = ANY_EPIPOLE + 1;
        let plane = |share, by_chance| with(share, beside(three, by_chance, 1.0));
        let pattern = |share, size| Some(ResidualPattern { share, size });
        for silent in [
            Case { plane: plane(ONE_PLANE, BY_CHANCE), ..GOOD },
            Case { plane: plane(EVEN, 1.0), ..GOOD },
            Case { pattern: pattern(EVEN, 3.0), ..GOOD },
            Case { pattern: pattern(0.9, PATTERN_SIZE), ..GOOD },
            Case { pattern: pattern(0.9, 2.0 * PATTERN_SIZE), side: 2.0 * USUAL_SIDE, ..GOOD },
        ] {
            assert_eq!(reasons(&silent), [], "{silent:?}");
        }
        let one_plane = |percent, plane| {
            let reason = Reason::OnePlane { percent, groups: 9, agreeing: 7, is_still: false };
            (Case { plane, ..GOOD }, reason)
        };
        for (told, reason) in [
            one_plane(95, plane(next(ONE_PLANE), 0.0)),
            one_plane(50, plane(next(EVEN), next(BY_CHANCE))),
            one_plane(50, with(next(EVEN), beside(three, 0.0, next(1.0)))),
            one_plane(50, with(next(EVEN), beside(ANY_EPIPOLE, 0.0, 0.0))),
            one_plane(40, with(next(HALF_PLANE), beside(ANY_EPIPOLE, 0.0, 0.0))),
            (Case { pattern: pattern(next(EVEN), 0.4), ..GOOD }, Reason::Pattern { size: 0.4 }),
            (
                Case { pattern: pattern(0.9, next(PATTERN_SIZE)), ..GOOD },
                Reason::Pattern { size: next(PATTERN_SIZE) },
            ),
        ] {
            assert_eq!(reasons(&told), [reason], "{told:?}");
            assert_eq!(verdict(&told), Verdict::Doubtful, "{told:?}");
        }
    }
}
