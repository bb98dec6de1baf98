//! Cases for the tests of judgements.

use std::borrow::Cow;

use crate::estimate::Trust;
use crate::estimate::evidence::patches::MirrorMatches;
use crate::estimate::fit::ResidualPattern;
use crate::estimate::fit::false_alarms::Agreement;
use crate::estimate::verdict::trust::case::{Case, Distinctive, Mirror, RefinedOn};
use crate::estimate::verdict::trust::lines::LineEvidence;
use crate::estimate::verdict::trust::parallax::{OffPlane, PlaneEvidence, Relief, Witnesses};
use crate::estimate::verdict::trust::{Reason, Verdict};

pub(super) const SHOWN: Witnesses = Witnesses { on_warp: 300, along: 90, across: 5, off: 20 };
pub(super) const NOTHING: Witnesses = Witnesses { on_warp: 0, along: 0, across: 0, off: 0 };
const SHOWN_LINES: LineEvidence = LineEvidence { likelihood: 400.0, rival: 20.0, log_false_alarms: -300.0 };
/// A rival is nearly as likely.
pub(super) const EQUALLED: LineEvidence = LineEvidence { rival: 392.0, ..SHOWN_LINES };
/// A rival is likelier.
pub(super) const BEATEN: LineEvidence = LineEvidence { rival: 500.0, ..SHOWN_LINES };
pub(super) const BY_CHANCE: LineEvidence =
    LineEvidence { likelihood: 2.0, rival: 1.0, log_false_alarms: 3.0 };
const NO_CHANCE: Agreement =
    Agreement { matches: 300, agreeing: 250, within: 0.002, log_false_alarms: -900.0 };
const UPRIGHT: MirrorMatches =
    MirrorMatches { flipped: 7, all_flipped: 100, upright: 80, corners: 600, by_chance: 4e-4 };
pub(super) const GOOD: Case = Case {
    patches: true,
    barcodes: None,
    refined_on: RefinedOn::Matches(300),
    clicks: Cow::Borrowed(&[0.5, 1.2]),
    click_sigma: 1.0,
    margin: Some(0.5),
    lines: Some(SHOWN_LINES),
    deviation: Some(0.05),
    plane: Some(plane(0.3, 1, 1.0)),
    distinctive: Some(Distinctive { all: 260, off: 20 }),
    relief: Some(Relief { beside: SHOWN, further: NOTHING, finer: SHOWN, clear: SHOWN }),
    strong_lens: Some(false),
    unguided: Some(NO_CHANCE),
    unguided_on_lines: 260,
    unguided_by_chance: 12,
    given: None,
    baseline: None,
    mirror: Some(Mirror { matches: UPRIGHT, is_suspect: false }),
    pattern: Some(ResidualPattern { share: 0.1, size: 0.1 }),
    side: 768.0,
};
/// The same without evidence of the images for the lines, so that tests of support decide.
pub(super) const SUPPORTED: Case = Case { lines: None, ..GOOD };

/// Returns a plane beside which seven of nine groups agree with the epipoles.
pub(super) const fn plane(share: f64, motions: usize, by_chance: f64) -> PlaneEvidence {
    let off = OffPlane { groups: 9, agreeing: 7, motions, by_chance, motions_by_chance: by_chance };
    PlaneEvidence { share, off, is_still: false }
}

pub(super) fn clicks(distances: &[f64]) -> Cow<'static, [f64]> {
    Cow::Owned(distances.to_vec())
}

pub(super) fn verdict(case: &Case) -> Verdict {
    Trust::judge(case).verdict
}

pub(super) fn reasons(case: &Case) -> Vec<Reason> {
    Trust::judge(case).reasons
}
