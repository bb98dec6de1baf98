//! Rules of the verdict, and their thresholds.
//!
//! Each rule is a test that wrong geometries usually fail:
//! - the lines are probably right near the matches, by the matches that the images show without them;
//! - the clicks lie on their lines;
//! - the matches determine the lines precisely;
//! - matches off the largest plane determine the epipoles, or matches beside a turn those of known cameras.
//!
//! Geometries of given matches or of clicks alone, and those of searches without patches, have tests of their support
//! in place of the first one.
//!
//! A result is reliable if it passes all tests. Thresholds of counts and distances are round
//! numbers from results of known truth, with right and wrong clicks (`lab/notes.md` has the
//! figures).

use super::evidence::{
    BarcodeFigures, Baseline, Evidence, GivenFigures, GivenPoints, OffPlane, PlaneEvidence, RefinedOn,
    Witnesses,
};
use super::lines::{EVEN_LINES, LineEvidence, SURE_LINES};
use super::{Reason, Suspect, Trust, Verdict};

/// Fewest matches of a reliable result. A round number from results of known truth
/// (`lab/notes.md`).
pub const ENOUGH_MATCHES: usize = 60;
/// Number of matches below which a result is unreliable. A round number from results of known truth
/// (`lab/notes.md`).
pub const FAR_TOO_FEW: usize = 25;
/// Sampson distance of a click, in standard deviations, beyond which the click or the result is
/// wrong: one Gaussian error in 16,000.
pub const CLICK_DEVIATIONS: f64 = 4.0;
/// Sampson distance of a click, in standard deviations, beyond which it makes a result unreliable,
/// unless all other tests support the result. Only a mistaken click is that far off.
pub const CLICK_DEVIATIONS_WRONG: f64 = 12.0;
/// Least margin of a reliable result over a clearly different geometry. A round number from results
/// of known truth (`lab/notes.md`).
pub const CLEAR_MARGIN: f64 = 0.2;
/// Difference between two weights, in standard deviations, that chance explains: 95 % of Gaussian
/// differences are below it.
pub(in crate::estimate) const CHANCE_DEVIATIONS: f64 = 2.0;
/// Margin below which a result is a guess. It colours the gauge; no verdict depends on it.
pub const GUESS_MARGIN: f64 = 0.05;
/// Largest standard deviation of epipolar lines of a reliable result, as a share of the longer
/// side: 2 px in 1,000. A round number from results of known truth (`lab/notes.md`).
const LOOSEST: f64 = 0.002;
/// Fewest independent lines of a reliable result: twice the seven unknowns.
const ENOUGH_LINES: f64 = 14.0;

impl Trust {
    pub(in crate::estimate) fn judge(evidence: &Evidence) -> Self {
        let mut reasons = Vec::new();
        let mut unreliable = false;
        if let Some(figures) = evidence.barcodes {
            let BarcodeFigures { correlation, by_chance, lines, .. } = figures;
            if correlation <= by_chance {
                unreliable = true;
                reasons.push(Reason::BarcodesByChance { correlation, by_chance });
            }
            if lines < ENOUGH_LINES {
                reasons.push(Reason::FewBarcodes { lines: figures.whole_lines() });
            }
        } else if let RefinedOn::Points(GivenPoints { agreeing, matches, is_chance }) = evidence.refined_on {
            unreliable |= is_chance;
            reasons.push(if is_chance {
                Reason::PointsByChance { agreeing, matches }
            } else {
                Reason::PointsAlone { agreeing, matches }
            });
        } else if !evidence.patches {
            reasons.push(Reason::NotChecked);
        }
        match evidence.refined_on {
            RefinedOn::Nothing if evidence.patches => reasons.push(Reason::RefinementOff),
            RefinedOn::Clicks => reasons.push(Reason::ClicksAlone),
            RefinedOn::TooFewMatches if evidence.patches => reasons.push(Reason::NotRefined),
            _ => {}
        }
        let of_lines = match &evidence.lines {
            Some(lines) => of_the_lines(lines, evidence),
            None => of_support(evidence),
        };
        unreliable |= of_lines.unreliable;
        let lines_are_doubted = evidence.lines.is_none() || !of_lines.reasons.is_empty();
        reasons.extend(of_lines.reasons);
        if let Some(deviation) = evidence.deviation.filter(|d| *d > LOOSEST * evidence.side) {
            reasons.push(match evidence.barcodes {
                Some(_) => Reason::LooseBarcodes { deviation },
                None => Reason::Loose { deviation },
            });
        }
        if let Some(mirror) = evidence.mirror.filter(|mirror| mirror.is_likely()) {
            reasons.push(Reason::Mirrored { matches: mirror.matches.flipped });
        }
        reasons.extend(of_the_epipole(evidence));
        if evidence.strong_lens {
            reasons.push(Reason::Fisheye);
        }
        if let Some(given) = evidence.given.filter(GivenFigures::contradict) {
            let GivenFigures { matches, off: contradicting, distance } = given;
            // First, because people trust the matches that they give.
            reasons.insert(0, Reason::GivenContradict { contradicting, matches, distance });
        }
        let but_clicks = !reasons.is_empty();
        let suspect = if but_clicks { Suspect::Geometry } else { Suspect::Click };
        let mut far_off = 0;
        for (k, distance) in evidence.clicks.iter().enumerate() {
            let deviations = distance / evidence.click_sigma;
            let reason = Reason::ClickOff { pair: k + 1, distance: *distance, suspect };
            if deviations > CLICK_DEVIATIONS_WRONG {
                // First, because such a click is a mistake, and spoils other figures.
                reasons.insert(far_off, reason);
                far_off += 1;
            } else if deviations > CLICK_DEVIATIONS {
                reasons.push(reason);
            }
        }
        // If the images show the lines, they have outvoted a mistaken click. Otherwise a click that is far off
        // makes the result unreliable.
        unreliable |= far_off > 0 && but_clicks && lines_are_doubted;
        let verdict = match (reasons.is_empty(), unreliable) {
            (true, _) => Verdict::Reliable,
            (false, false) => Verdict::Doubtful,
            (false, true) => Verdict::Unreliable,
        };
        Self { verdict, reasons }
    }
}

/// Failed tests of the lines near the matches.
struct OfLines {
    reasons: Vec<Reason>,
    unreliable: bool,
}

/// Returns what speaks against lines that rest on the images, if they are not probable enough: what cost most.
fn of_the_lines(lines: &LineEvidence, evidence: &Evidence) -> OfLines {
    let probability = lines.probability();
    let mut reasons = Vec::new();
    if probability < SURE_LINES && lines.probability_without_rival() >= SURE_LINES {
        reasons.push(Reason::Ambiguous { margin: lines.margin() });
    } else if probability < SURE_LINES {
        if let RefinedOn::Matches(matches) = evidence.refined_on
            && matches < ENOUGH_MATCHES
        {
            reasons.push(Reason::FewMatches { matches });
        }
        let matches = evidence.unguided.map_or(0, |agreement| agreement.matches);
        reasons.push(Reason::ByChance { agreeing: evidence.unguided_on_lines, matches });
        reasons.extend(contradicted(evidence));
    }
    OfLines { reasons, unreliable: probability < EVEN_LINES }
}

/// Returns the failed tests of support of a geometry that the images did not propose: of given matches, of clicks
/// alone, and of a search without patches.
fn of_support(evidence: &Evidence) -> OfLines {
    let (mut reasons, mut unreliable) = (Vec::new(), false);
    if let RefinedOn::Matches(matches) | RefinedOn::Given(matches) = evidence.refined_on
        && matches < ENOUGH_MATCHES
    {
        unreliable |= matches < FAR_TOO_FEW;
        reasons.push(Reason::FewMatches { matches });
    }
    let is_chance = evidence.unguided.is_some_and(|agreement| !agreement.is_no_chance());
    if let (true, RefinedOn::Given(_), Some(given)) = (is_chance, evidence.refined_on, evidence.given) {
        unreliable = true;
        reasons.push(Reason::GivenAlone { matches: given.matches });
    }
    if let Some(margin) = evidence.margin.filter(|m| *m < CLEAR_MARGIN) {
        // No search has preferred a geometry of given matches or of clicks alone.
        let is_given = matches!(evidence.refined_on, RefinedOn::Given(_) | RefinedOn::Clicks);
        unreliable |= is_given && margin < -CLEAR_MARGIN;
        reasons.push(Reason::Ambiguous { margin });
    }
    reasons.extend(contradicted(evidence));
    OfLines { reasons, unreliable }
}

fn contradicted(evidence: &Evidence) -> Option<Reason> {
    let (contradicting, matches) = evidence.together.contradict()?;
    Some(Reason::Contradicted { contradicting, matches })
}

/// Returns the failed tests of the epipoles.
fn of_the_epipole(evidence: &Evidence) -> Vec<Reason> {
    let pattern = evidence.pattern.filter(|pattern| pattern.is_bent(evidence.side));
    let pattern = pattern.map(|pattern| Reason::Pattern { size: pattern.size });
    if let Some(baseline) = evidence.baseline {
        let Baseline { beside, other, in_front, matches } = baseline;
        let Witnesses { along, across, on_warp: turned, .. } = beside;
        let turned = (!beside.show_the_epipole()).then_some(Reason::OnlyTurned { along, across, turned });
        let other = other.filter(|other| !other.is_decided());
        let other = other.map(|other| Reason::Ambiguous { margin: other.margin() });
        let behind = baseline.is_behind().then_some(Reason::BehindCameras { in_front, matches });
        return [turned, behind, other, pattern].into_iter().flatten().collect();
    }
    let only =
        if let Some(plane) = evidence.plane.filter(|plane| plane.leaves_the_epipoles_open(evidence.relief)) {
            let PlaneEvidence { share, off: OffPlane { groups, agreeing, .. }, is_still, .. } = plane;
            Some(Reason::OnePlane { percent: (100.0 * share) as u32, groups, agreeing, is_still })
        } else if let Some(Witnesses { along, across, on_warp, .. }) = without_relief(evidence) {
            Some(Reason::NoRelief { along, across, on_warp })
        } else if let Some(plane) = evidence.plane.filter(PlaneEvidence::is_bent) {
            Some(Reason::Bent { percent: (100.0 * plane.bent_share) as u32 })
        } else {
            pattern
        };
    only.into_iter().collect()
}

/// Returns the matches that show no relief. Lines that rest on the images need relief to be shown: without any
/// matches beside a warp, there is none.
fn without_relief(evidence: &Evidence) -> Option<Witnesses> {
    match evidence.relief {
        Some(relief) => relief.doubt(),
        None => evidence.lines.map(|_| Witnesses::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::evidence::{
        ANY_EPIPOLE, HALF_PLANE, MOSTLY_PLANE, MOTIONS_BY_CHANCE, Mirror, ONE_PLANE, OtherPose, PATTERN,
        PATTERN_SIZE, Relief, ResidualPattern, Together, USUAL_SIDE,
    };
    use super::*;
    use crate::estimate::evidence::patches::MirrorMatches;
    use crate::estimate::fit::false_alarms::{Agreement, BY_CHANCE, OF_LINES};

    const SHOWN: Witnesses = Witnesses { on_warp: 300, along: 90, across: 5, off: 20 };
    const NOTHING: Witnesses = Witnesses { on_warp: 0, along: 0, across: 0, off: 0 };
    const SHOWN_LINES: LineEvidence =
        LineEvidence { likelihood: 400.0, rival: 20.0, log_false_alarms: -300.0 };
    /// A rival is nearly as likely.
    const EQUALLED: LineEvidence = LineEvidence { rival: 392.0, ..SHOWN_LINES };
    const BY_CHANCE_ALONE: LineEvidence = LineEvidence { likelihood: 2.0, rival: 1.0, log_false_alarms: 3.0 };
    const GOOD: Evidence = Evidence {
        patches: true,
        barcodes: None,
        refined_on: RefinedOn::Matches(300),
        clicks: &[0.5, 1.2],
        click_sigma: 1.0,
        margin: Some(0.5),
        lines: Some(SHOWN_LINES),
        deviation: Some(0.05),
        plane: Some(plane(0.3, 1, 1.0)),
        together: Together { all: 260, off: 20, matches: 200, contradicting: 2 },
        relief: Some(Relief { beside: SHOWN, further: NOTHING, finer: SHOWN, clear: SHOWN }),
        strong_lens: false,
        unguided: None,
        unguided_on_lines: 0,
        given: None,
        baseline: None,
        mirror: None,
        pattern: Some(ResidualPattern { share: 0.1, size: 0.1 }),
        side: 768.0,
    };

    /// The same without evidence of the images for the lines, so that tests of support decide.
    const SUPPORTED: Evidence = Evidence { lines: None, ..GOOD };

    #[test]
    fn what_cost_most_explains_improbable_lines() {
        let reasons = |evidence: &Evidence| Trust::judge(evidence).reasons;
        let together = Together { all: 100, off: 30, matches: 100, contradicting: 30 };
        let weak = Evidence {
            lines: Some(BY_CHANCE_ALONE),
            refined_on: RefinedOn::Matches(40),
            unguided: Some(Agreement::of(vec![0.5; 20], OF_LINES)),
            unguided_on_lines: 3,
            together,
            ..GOOD
        };
        let expected = [
            Reason::FewMatches { matches: 40 },
            Reason::ByChance { agreeing: 3, matches: 20 },
            Reason::Contradicted { contradicting: 30, matches: 100 },
        ];
        assert_eq!(reasons(&weak), expected);
        // Lines that are less likely than those of a rival are wrong.
        let beaten = LineEvidence { rival: 500.0, ..SHOWN_LINES };
        let beaten = Trust::judge(&Evidence { lines: Some(beaten), ..GOOD });
        assert_eq!((beaten.verdict, beaten.reasons.len()), (Verdict::Unreliable, 1));
        assert!(matches!(beaten.reasons[0], Reason::Ambiguous { margin } if margin < 0.0));
    }

    #[test]
    fn a_plane_does_not_leave_the_baseline_of_known_cameras_open() {
        let flat = Evidence { plane: Some(plane(0.99, 1, 1.0)), relief: None, ..GOOD };
        assert_eq!(verdict(&flat), Verdict::Doubtful);
        let many_wrong = Witnesses { on_warp: 80, along: 430, across: 40, off: 250 };
        let with = |beside, other| Evidence {
            baseline: Some(Baseline { beside, other, in_front: 290, matches: 300 }),
            ..flat
        };
        assert_eq!(verdict(&with(many_wrong, None)), Verdict::Reliable);
        let turned = Witnesses { on_warp: 400, along: 9, across: 11, off: 40 };
        let reasons = |evidence: &Evidence| Trust::judge(evidence).reasons;
        assert_eq!(reasons(&with(turned, None)), [Reason::OnlyTurned { along: 9, across: 11, turned: 400 }]);
        let mut behind = with(many_wrong, None);
        behind.baseline = behind.baseline.map(|baseline| Baseline { in_front: 160, ..baseline });
        assert_eq!(reasons(&behind), [Reason::BehindCameras { in_front: 160, matches: 300 }]);
        let other = |this_only, other_only| Some(OtherPose { this_only, other_only });
        assert_eq!(verdict(&with(many_wrong, other(30, 2))), Verdict::Reliable);
        assert_eq!(reasons(&with(many_wrong, other(6, 5))), [Reason::Ambiguous { margin: 1.0 / 11.0 }]);
    }

    /// Returns a plane beside which seven of nine groups agree with the epipoles.
    const fn plane(share: f64, motions: usize, by_chance: f64) -> PlaneEvidence {
        let off = OffPlane { groups: 9, agreeing: 7, motions, by_chance, motions_by_chance: by_chance };
        PlaneEvidence { share, bent_share: share, off, is_still: false }
    }

    fn verdict(evidence: &Evidence) -> Verdict {
        Trust::judge(evidence).verdict
    }

    #[test]
    fn a_result_is_reliable_only_when_nothing_speaks_against_it() {
        assert_eq!(Trust::judge(&GOOD), Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        assert_eq!(verdict(&Evidence { margin: None, ..GOOD }), Verdict::Reliable);
        let plane = |share, by_chance| Some(plane(share, 5, by_chance));
        assert_eq!(verdict(&Evidence { plane: plane(0.6, 1e-4), ..GOOD }), Verdict::Reliable);
        for worse in [
            Evidence { patches: false, refined_on: RefinedOn::TooFewMatches, ..GOOD },
            Evidence { refined_on: RefinedOn::TooFewMatches, ..GOOD },
            Evidence { lines: Some(EQUALLED), ..GOOD },
            Evidence { clicks: &[0.5, 5.0], ..GOOD },
            Evidence { relief: None, ..GOOD },
            Evidence { deviation: Some(3.0), ..GOOD },
            Evidence { plane: plane(0.98, 0.0), ..GOOD },
            Evidence { plane: plane(0.6, 0.1), ..GOOD },
            Evidence { strong_lens: true, ..GOOD },
        ] {
            assert_eq!(verdict(&worse), Verdict::Doubtful);
        }
        assert_eq!(verdict(&Evidence { lines: Some(BY_CHANCE_ALONE), ..GOOD }), Verdict::Unreliable);
        let of =
            |refined_on, margin| verdict(&Evidence { refined_on, margin: Some(margin), lines: None, ..GOOD });
        let [given, clicks] = [RefinedOn::Given(300), RefinedOn::Clicks];
        let expected = [Verdict::Reliable, Verdict::Doubtful, Verdict::Unreliable];
        assert_eq!([0.5, -0.1, -0.5].map(|margin| of(given, margin)), expected);
        assert_eq!([-0.1, -0.5].map(|margin| of(clicks, margin)), expected[1..]);
        assert_eq!(verdict(&Evidence { clicks: &[40.0, 0.1], ..GOOD }), Verdict::Doubtful, "outvoted");
        assert_eq!(
            verdict(&Evidence { clicks: &[40.0, 0.1], lines: Some(EQUALLED), ..GOOD }),
            Verdict::Unreliable
        );
        let open = Evidence { clicks: &[40.0, 0.1], plane: plane(0.98, 0.0), ..GOOD };
        assert_eq!(verdict(&open), Verdict::Doubtful, "outvoted beside a plane, too");
        assert_eq!(verdict(&Evidence { lines: None, ..open }), Verdict::Unreliable);
    }

    #[test]
    fn points_without_pictures_are_never_reliable_and_unreliable_by_chance() {
        let of = |is_chance| {
            let points = GivenPoints { agreeing: 290, matches: 300, is_chance };
            Trust::judge(&Evidence { patches: false, refined_on: RefinedOn::Points(points), ..GOOD })
        };
        let alone = Reason::PointsAlone { agreeing: 290, matches: 300 };
        assert_eq!(of(false), Trust { verdict: Verdict::Doubtful, reasons: vec![alone] });
        let by_chance = Reason::PointsByChance { agreeing: 290, matches: 300 };
        assert_eq!(of(true), Trust { verdict: Verdict::Unreliable, reasons: vec![by_chance] });
    }

    #[test]
    fn evidence_that_determines_the_epipoles_comes_before_evidence_that_is_less_likely_by_chance() {
        let off = |motions, by_chance| plane(0.6, motions, by_chance).off;
        let of =
            |off| verdict(&Evidence { plane: Some(PlaneEvidence { off, ..plane(0.6, 0, 0.0) }), ..GOOD });
        let (one_motion, held, open) = (off(1, 1e-9), off(5, 1e-4), off(5, 0.1));
        for (a, b) in [(one_motion, held), (held, one_motion)] {
            assert_eq!((a.or_stronger(b).motions, of(a.or_stronger(b))), (5, Verdict::Reliable));
        }
        let neither = one_motion.or_stronger(open);
        assert_eq!((neither.motions, of(neither)), (1, Verdict::Doubtful));
    }

    #[test]
    fn a_click_is_blamed_only_if_nothing_else_speaks_against_the_geometry() {
        let trust = Trust::judge(&Evidence { clicks: &[0.5, 5.04], ..GOOD });
        assert_eq!(trust.reasons, [Reason::ClickOff { pair: 2, distance: 5.04, suspect: Suspect::Click }]);
        let trust = Trust::judge(&Evidence { clicks: &[0.5, 5.04], lines: Some(EQUALLED), ..GOOD });
        assert_eq!(
            trust.reasons[1],
            Reason::ClickOff { pair: 2, distance: 5.04, suspect: Suspect::Geometry }
        );
    }

    #[test]
    fn the_epipole_is_open_if_matches_off_the_warp_are_few_or_point_anywhere() {
        let reasons = |on_warp, along, across, off| {
            let beside = Witnesses { on_warp, along, across, off };
            let relief = Some(Relief { beside, further: NOTHING, finer: SHOWN, clear: SHOWN });
            Trust::judge(&Evidence { relief, ..GOOD }).reasons
        };
        let told = |on_warp, along, across| [Reason::NoRelief { on_warp, along, across }];
        assert_eq!(reasons(380, 20, 0, 0), []);
        // Less than a twentieth.
        assert_eq!(reasons(381, 20, 0, 0), told(381, 20, 0));
        // So few may all be along, though a quarter of such matches are across.
        assert_eq!(reasons(0, 9, 0, 0), []);
        assert_eq!(reasons(0, 8, 0, 0), told(0, 8, 0));
        // A quarter across.
        assert_eq!(reasons(100, 400, 100, 100), []);
        assert_eq!(reasons(100, 400, 130, 130), told(100, 400, 130));
        // Half of them off their lines.
        assert_eq!(reasons(100, 400, 0, 350), []);
        assert_eq!(reasons(100, 400, 0, 380), told(100, 400, 0));
        // Each two of them have an epipole, so chance explains few with others off their lines.
        assert_eq!(reasons(0, 14, 0, 5), []);
        assert_eq!(reasons(0, 9, 0, 3), told(0, 9, 0));
        // Without matches, nothing shows it. Only points without pictures have no such test.
        assert_eq!(Trust::judge(&Evidence { relief: None, ..GOOD }).reasons, told(0, 0, 0));
        assert_eq!(Trust::judge(&Evidence { relief: None, ..SUPPORTED }).reasons, []);
        // It vanishes beside a warp that follows the rows.
        let finer = Witnesses { on_warp: 395, along: 3, across: 2, off: 12 };
        let relief = Some(Relief { beside: SHOWN, further: NOTHING, finer, clear: SHOWN });
        assert_eq!(Trust::judge(&Evidence { relief, ..GOOD }).reasons, told(395, 3, 2));
        // It rests on matches that are equalled elsewhere.
        let clear = Witnesses { on_warp: 0, along: 5, across: 1, off: 1 };
        let relief = Some(Relief { beside: SHOWN, further: NOTHING, finer: SHOWN, clear });
        assert_eq!(Trust::judge(&Evidence { relief, ..GOOD }).reasons, told(0, 5, 1));
    }

    #[test]
    fn relief_beside_further_planes_decides_where_the_motions_are_too_few() {
        let few_motions = plane(0.6, ANY_EPIPOLE, 9.0);
        let shown = Witnesses { on_warp: 90, along: 30, across: 2, off: 8 };
        let open = Witnesses { on_warp: 90, along: 10, across: 8, off: 28 };
        let with = |plane, further| {
            let relief = Some(Relief { beside: SHOWN, further, finer: SHOWN, clear: SHOWN });
            verdict(&Evidence { plane: Some(plane), relief, ..GOOD })
        };
        assert_eq!(with(few_motions, shown), Verdict::Reliable);
        for further in [open, NOTHING] {
            assert_eq!(with(few_motions, further), Verdict::Doubtful);
        }
        // Few matches beside one plane, and a camera that stood still, are not made up for.
        assert_eq!(with(PlaneEvidence { share: 0.96, ..few_motions }, shown), Verdict::Doubtful);
        let still = PlaneEvidence { is_still: true, ..plane(0.6, 9, 0.0) };
        assert_eq!(with(still, shown), Verdict::Doubtful);
        assert_eq!(with(PlaneEvidence { share: HALF_PLANE, ..still }, shown), Verdict::Reliable);
    }

    #[test]
    fn a_pair_whose_corners_match_when_flipped_is_mirrored() {
        let reasons = |flipped, upright, is_suspect| {
            let matches = MirrorMatches { flipped, all_flipped: 100, upright, corners: 600, by_chance: 4e-4 };
            Trust::judge(&Evidence { mirror: Some(Mirror { matches, is_suspect }), ..GOOD }).reasons
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
            Trust::judge(&Evidence { given, margin: Some(margin), ..SUPPORTED }).reasons
        };
        // Of 54 coins, 35 show heads by chance (2 %), and 36 hardly do.
        assert_eq!(reasons(35, 0.5), []);
        let told = |contradicting| Reason::GivenContradict { contradicting, matches: 54, distance: 8.4 };
        assert_eq!(reasons(36, 0.5), [told(36)]);
        assert_eq!(reasons(54, 0.1), [told(54), Reason::Ambiguous { margin: 0.1 }]);
    }

    #[test]
    fn given_matches_that_the_images_support_by_chance_alone_are_unreliable() {
        let with = |by_chance, refined_on| {
            let unguided = Some(Agreement::of([by_chance; 40], OF_LINES));
            let given = Some(GivenFigures { matches: 16, off: 0, distance: 0.8 });
            Trust::judge(&Evidence { unguided, unguided_on_lines: 3, given, refined_on, ..SUPPORTED })
        };
        let [given, clicks] = [RefinedOn::Given(300), RefinedOn::Clicks];
        assert_eq!(with(0.01, given).reasons, []);
        let unreliable = |reason| Trust { verdict: Verdict::Unreliable, reasons: vec![reason] };
        assert_eq!(with(0.9, given), unreliable(Reason::GivenAlone { matches: 16 }));
        // The clicks contradict the images, and are told so.
        assert_eq!(with(0.9, clicks).reasons, [Reason::ClicksAlone]);
    }

    #[test]
    fn a_geometry_that_most_distinctive_matches_contradict_is_doubtful() {
        let reasons = |all, off| {
            let together = Together { all, off, ..Together::default() };
            Trust::judge(&Evidence { together, ..SUPPORTED }).reasons
        };
        assert_eq!(reasons(6, 6), []);
        assert_eq!(reasons(7, 7), [Reason::Contradicted { contradicting: 7, matches: 7 }]);
        assert_eq!(reasons(20, 15), []);
        assert_eq!(reasons(20, 16), [Reason::Contradicted { contradicting: 16, matches: 20 }]);
    }

    /// Tests both sides of every threshold, as close to it as the type of the number allows.
    #[test]
    fn each_threshold_is_where_its_constant_says() {
        let reasons = |evidence: &Evidence| Trust::judge(evidence).reasons;
        let beside = |motions, by_chance, motions_by_chance| OffPlane {
            motions,
            motions_by_chance,
            ..plane(0.0, 0, by_chance).off
        };
        let with = |share, off| Some(PlaneEvidence { off, ..plane(share, 0, 0.0) });
        let three = ANY_EPIPOLE + 1;
        let plane = |share, by_chance| with(share, beside(three, by_chance, MOTIONS_BY_CHANCE));
        let bent = |bent_share| plane(0.4, 0.0).map(|plane| PlaneEvidence { bent_share, ..plane });
        let together = |matches, contradicting| Together { matches, contradicting, ..Together::default() };
        let pattern = |share, size| Some(ResidualPattern { share, size });
        let next = |v: f64| v * (1.0 + 1e-12);
        let before = |v: f64| v * (1.0 - 1e-12);
        let silent = [
            Evidence { refined_on: RefinedOn::Matches(10), ..GOOD },
            Evidence { margin: Some(0.05), together: together(200, 9), ..GOOD },
            Evidence { refined_on: RefinedOn::Matches(ENOUGH_MATCHES), ..SUPPORTED },
            Evidence { clicks: &[CLICK_DEVIATIONS], ..GOOD },
            Evidence { clicks: &[2.0 * CLICK_DEVIATIONS], click_sigma: 2.0, ..GOOD },
            Evidence { margin: Some(CLEAR_MARGIN), ..SUPPORTED },
            Evidence { deviation: Some(LOOSEST * GOOD.side), ..GOOD },
            Evidence { deviation: None, ..GOOD },
            Evidence { plane: plane(ONE_PLANE, BY_CHANCE), ..GOOD },
            Evidence { plane: plane(MOSTLY_PLANE, 1.0), ..GOOD },
            Evidence { plane: bent(0.69), ..GOOD },
            Evidence { plane: bent(MOSTLY_PLANE).map(|p| PlaneEvidence { share: 0.0, ..p }), ..GOOD },
            Evidence { plane: None, ..GOOD },
            // One of 200 is expected to be wrong. Six are, less than once in a thousand times.
            Evidence { together: together(200, 5), ..SUPPORTED },
            Evidence { together: Together::default(), ..SUPPORTED },
            Evidence { pattern: pattern(PATTERN, 3.0), ..GOOD },
            Evidence { pattern: pattern(0.9, PATTERN_SIZE), ..GOOD },
            Evidence { pattern: pattern(0.9, 2.0 * PATTERN_SIZE), side: 2.0 * USUAL_SIDE, ..GOOD },
            Evidence { pattern: None, ..GOOD },
        ];
        for evidence in silent {
            assert_eq!(reasons(&evidence), [], "{evidence:?}");
        }
        let one_plane = |percent, plane| {
            let reason = Reason::OnePlane { percent, groups: 9, agreeing: 7, is_still: false };
            (Evidence { plane, ..GOOD }, reason)
        };
        let off = next(CLICK_DEVIATIONS);
        let (few, margin, deviation) = (ENOUGH_MATCHES - 1, before(CLEAR_MARGIN), next(LOOSEST * GOOD.side));
        let told = [
            (
                Evidence { refined_on: RefinedOn::Matches(few), ..SUPPORTED },
                Reason::FewMatches { matches: few },
            ),
            (Evidence { lines: Some(EQUALLED), ..GOOD }, Reason::Ambiguous { margin: 0.02 }),
            (
                Evidence { clicks: &[0.1, off], ..GOOD },
                Reason::ClickOff { pair: 2, distance: off, suspect: Suspect::Click },
            ),
            (
                Evidence { clicks: &[0.5 * off], click_sigma: 0.5, ..GOOD },
                Reason::ClickOff { pair: 1, distance: 0.5 * off, suspect: Suspect::Click },
            ),
            (Evidence { margin: Some(margin), ..SUPPORTED }, Reason::Ambiguous { margin }),
            (Evidence { deviation: Some(deviation), ..GOOD }, Reason::Loose { deviation }),
            one_plane(95, plane(next(ONE_PLANE), 0.0)),
            one_plane(50, plane(next(MOSTLY_PLANE), next(BY_CHANCE))),
            one_plane(50, with(next(MOSTLY_PLANE), beside(three, 0.0, next(MOTIONS_BY_CHANCE)))),
            one_plane(50, with(next(MOSTLY_PLANE), beside(ANY_EPIPOLE, 0.0, 0.0))),
            one_plane(40, with(next(HALF_PLANE), beside(ANY_EPIPOLE, 0.0, 0.0))),
            (Evidence { plane: bent(0.71), ..GOOD }, Reason::Bent { percent: 71 }),
            (Evidence { pattern: pattern(next(PATTERN), 0.4), ..GOOD }, Reason::Pattern { size: 0.4 }),
            (
                Evidence { pattern: pattern(0.9, next(PATTERN_SIZE)), ..GOOD },
                Reason::Pattern { size: next(PATTERN_SIZE) },
            ),
            (
                Evidence { together: together(200, 6), ..SUPPORTED },
                Reason::Contradicted { contradicting: 6, matches: 200 },
            ),
        ];
        for (evidence, reason) in told {
            assert_eq!(reasons(&evidence), [reason], "{evidence:?}");
            assert_eq!(verdict(&evidence), Verdict::Doubtful, "{evidence:?}");
        }
    }

    #[test]
    fn too_few_matches_and_far_clicks_with_anything_else_are_unreliable() {
        assert_eq!(
            verdict(&Evidence { refined_on: RefinedOn::Matches(FAR_TOO_FEW), ..SUPPORTED }),
            Verdict::Doubtful
        );
        assert_eq!(
            verdict(&Evidence { refined_on: RefinedOn::Matches(FAR_TOO_FEW - 1), ..SUPPORTED }),
            Verdict::Unreliable
        );
        let [at, beyond] = [CLICK_DEVIATIONS_WRONG, CLICK_DEVIATIONS_WRONG * (1.0 + 1e-12)];
        for (distance, expected) in [(at, Verdict::Doubtful), (beyond, Verdict::Unreliable)] {
            let clicks = [distance, 0.0];
            assert_eq!(verdict(&Evidence { clicks: &clicks, margin: Some(0.1), ..SUPPORTED }), expected);
            assert_eq!(verdict(&Evidence { clicks: &clicks, ..GOOD }), Verdict::Doubtful, "outvoted");
        }
        // A search on lines alone has no refinement, which is no second reason.
        let lines = Evidence { patches: false, refined_on: RefinedOn::TooFewMatches, ..GOOD };
        assert_eq!(Trust::judge(&lines).reasons, [Reason::NotChecked]);
    }
}
