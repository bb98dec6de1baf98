//! Verdict on a result, with its reasons. `case` and `parallax` have the figures, `judge` tests them.

mod case;
mod chance;
mod judge;
mod lines;
mod parallax;
#[cfg(test)]
mod table;

use serde::{Deserialize, Serialize};

pub use case::{BarcodeFigures, Case};
pub(in crate::estimate) use case::{Distinctive, GivenFigures, GivenPoints, Mirror, RefinedOn};
pub(in crate::estimate::verdict) use chance::fewer_than;
pub use lines::LineEvidence;
pub(in crate::estimate) use parallax::{Baseline, OffPlane, OtherPose, PlaneEvidence, Relief, Witnesses};

named! {
    fn label;
    /// Reliability of a result.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Verdict {
        /// Each test was passed.
        Reliable = "reliable",
        /// At least one test was failed, or lacks its data.
        Doubtful = "doubtful",
        /// The result contradicts the images or the clicks, or rests on far too few matches.
        Unreliable = "unreliable",
        /// No more matches agree on one geometry than by chance, so the pictures may show different scenes. Only without
        /// clicks and given matches; with them, the result is unreliable.
        DifferentScenes = "different scenes",
    }
}

impl Verdict {
    /// Returns whether the geometry is of no use.
    pub fn is_unreliable(self) -> bool {
        matches!(self, Self::Unreliable | Self::DifferentScenes)
    }
}

/// Failed test of a result, or a test that lacks its data. `presentation::reasons` has the sentences, `docs/verdicts.md` explains
/// them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// No patches were compared, so only lines support the result.
    NotChecked,
    /// The refinement did not find enough matches.
    NotRefined,
    /// The refinement was off.
    RefinementOff,
    /// The geometry follows from the clicks alone, and the matches of the images do not agree with it.
    ClicksAlone,
    /// There are no pictures: only the given matches agree with the geometry, this number of all.
    PointsAlone { agreeing: usize, matches: usize },
    /// There are no pictures, and chance explains that this number of all given matches agrees.
    PointsByChance { agreeing: usize, matches: usize },
    /// The geometry follows from the matches of another program alone, and the matches of the images agree
    /// with it no better than by chance: the number of given matches that agree with each other.
    GivenAlone { matches: usize },
    /// Most of the matches of another program contradict the geometry: the number of those that do, the number
    /// that agree with each other, and their median distance from their lines.
    GivenContradict { contradicting: usize, matches: usize, distance: f64 },
    /// The result rests on few matches.
    FewMatches { matches: usize },
    /// The matches found without the geometry agree with it no better than by chance: the number of them on
    /// their epipolar lines, and the number of all.
    ByChance { agreeing: usize, matches: usize },
    /// The matches found without the geometry agree with it no better than by chance, and few match along its lines: the
    /// number of them on their epipolar lines, the largest by chance, and the number of all.
    DifferentScenes { agreeing: usize, by_chance: usize, matches: usize },
    /// The barcodes of corresponding lines agree no better than by chance: agreement, 1 for equal barcodes,
    /// and the largest by chance.
    BarcodesByChance { correlation: f64, by_chance: f64 },
    /// Few lines have other barcodes than their neighbours: the number of independent lines.
    FewBarcodes { lines: usize },
    /// The barcodes leave the epipolar lines uncertain: their standard deviation.
    LooseBarcodes { deviation: f64 },
    /// A click is off its epipolar line by this Sampson distance; the suspect is more likely wrong.
    ClickOff { pair: usize, distance: f64, suspect: Suspect },
    /// More distinctive matches contradict the geometry than a right one leaves. `matches` are all distinctive matches.
    Contradicted { contradicting: usize, matches: usize },
    /// A lens as strong as a fisheye makes the matches clearly likelier.
    Fisheye,
    /// Neighbouring matches are off their lines by the same distance, the size of the pattern.
    Pattern { size: f64 },
    /// A clearly different geometry has nearly as much support as the result, or more: the relative
    /// advantage of the result, negative if it has less support.
    Ambiguous { margin: f64 },
    /// Most matches follow one homography, and the others do not determine the epipoles. `groups` of these
    /// move alike; `agreeing` ones agree with the epipoles. `is_still` if the homography leaves the matches
    /// in place, as if the camera stood still.
    OnePlane { percent: u32, groups: usize, agreeing: usize, is_still: bool },
    /// The parallax beside one smooth warp, as of a camera that turns behind a lens, does not show the
    /// epipole. Counts matches that were found without the geometry: beside the warp along and across
    /// their epipolar lines, and on the warp.
    NoRelief { along: usize, across: usize, on_warp: usize },
    /// The cameras are known, and most matches follow a camera that only turned. Counts matches that were found
    /// without the geometry: beside the turn along and across their epipolar lines, and on the turn.
    OnlyTurned { along: usize, across: usize, turned: usize },
    /// The cameras are known, and many scene points would lie behind one of them: the number in front of both, and the
    /// number of matches along the lines.
    BehindCameras { in_front: usize, matches: usize },
    /// One image is a mirror image of the other: the number of distinctive matches if image 2 is flipped.
    Mirrored { matches: usize },
    /// The matches leave the epipolar lines uncertain: their standard deviation.
    Loose { deviation: f64 },
    /// A test lacks its data.
    Untested { missing: Missing },
}

/// Data that a test lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Missing {
    /// Patches: only lines were compared.
    Patches,
    /// The refinement: it was off.
    Refinement,
    /// Matches along the lines: there are too few.
    Matches,
    /// Matches of the images that agree with the clicks.
    Agreement,
    /// Enough matches to fit a plane and a smooth warp to them.
    Relief,
    /// The uncertainty of the lines.
    Precision,
    /// Matches near each other.
    Neighbours,
}

impl From<Missing> for Reason {
    fn from(missing: Missing) -> Self {
        match missing {
            Missing::Patches => Self::NotChecked,
            Missing::Refinement => Self::RefinementOff,
            Missing::Matches => Self::NotRefined,
            Missing::Agreement => Self::ClicksAlone,
            Missing::Relief | Missing::Precision | Missing::Neighbours => Self::Untested { missing },
        }
    }
}

/// The part that is more likely wrong if a click and a geometry disagree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Suspect {
    /// The click: all other tests support the geometry.
    Click,
    /// The geometry: another test speaks against it, too.
    Geometry,
}

/// Verdict with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// The verdict.
    pub verdict: Verdict,
    /// Failed tests, and tests that lack their data. Empty for a reliable result.
    pub reasons: Vec<Reason>,
}

fn leaves_the_epipole_open(reason: &Reason) -> bool {
    matches!(
        reason,
        Reason::OnePlane { .. }
            | Reason::NoRelief { .. }
            | Reason::OnlyTurned { .. }
            | Reason::BehindCameras { .. }
    )
}

/// Reason why matches beside a warp, or beside a turn of the camera, do not show the epipole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// Too few of all matches are beside it, along their lines.
    Matches,
    /// Too many of those beside it are across their lines.
    Agreement,
    /// Chance may explain those along their lines.
    Significance,
}

impl Lack {
    /// Returns the reason for a failed test of the parallax, by the numbers of matches on the warp, and along and across
    /// their lines beside it.
    pub fn of(on_warp: usize, along: usize, across: usize) -> Self {
        let seen = Witnesses { on_warp, along, across, off: across };
        match (seen.are_enough(), seen.are_along()) {
            (false, _) => Self::Matches,
            (true, false) => Self::Agreement,
            (true, true) => Self::Significance,
        }
    }
}

impl Trust {
    /// Returns whether the only doubts are about clicked pairs.
    pub fn doubts_clicks_alone(&self) -> bool {
        let of_a_click = |reason: &Reason| matches!(reason, Reason::ClickOff { .. });
        !self.reasons.is_empty() && self.reasons.iter().all(of_a_click)
    }

    /// Returns whether another search could find a better geometry: too few matches, matches of chance, or a close
    /// rival. Doubts about the scene, the lens and the cameras remain after any search.
    pub(in crate::estimate) fn leaves_another_search(&self) -> bool {
        let remains = |reason: &Reason| {
            let of_the_scene = matches!(
                reason,
                Reason::Mirrored { .. }
                    | Reason::Pattern { .. }
                    | Reason::Fisheye
                    | Reason::Contradicted { .. }
            );
            of_the_scene || leaves_the_epipole_open(reason)
        };
        !self.reasons.iter().all(remains)
    }

    /// Returns whether all failed tests would pass with more matches in the same proportions.
    pub(in crate::estimate) fn may_pass_with_more_matches(&self) -> bool {
        self.reasons.iter().all(|reason| match *reason {
            Reason::OnePlane { groups, agreeing, is_still, .. } => !is_still && 2 * agreeing > groups,
            Reason::NoRelief { along, across, on_warp }
            | Reason::OnlyTurned { along, across, turned: on_warp } => {
                Witnesses { on_warp, along, across, off: across }.would_show_the_epipole()
            }
            _ => false,
        })
    }

    /// Returns whether parallax determines the epipole: no test of the epipole was failed or lacks its data.
    pub fn determines_the_epipole(&self) -> bool {
        let is_untested = |reason: &Reason| {
            matches!(
                reason,
                Reason::Untested { missing: Missing::Relief }
                    | Reason::NotChecked
                    | Reason::RefinementOff
                    | Reason::NotRefined
                    | Reason::ClicksAlone
                    | Reason::DifferentScenes { .. }
            )
        };
        !self.reasons.iter().any(|reason| is_untested(reason) || leaves_the_epipole_open(reason))
    }

    /// Returns whether the recorded motion is too little, or agrees as by chance.
    pub fn doubts_the_motion(&self) -> bool {
        let is_of_motion =
            |reason: &Reason| matches!(reason, Reason::FewBarcodes { .. } | Reason::BarcodesByChance { .. });
        self.reasons.iter().any(is_of_motion)
    }

    /// Returns whether only one plane or a rotation of the camera is certain.
    pub fn says_one_plane(&self) -> bool {
        self.reasons.iter().any(leaves_the_epipole_open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_matches_help_only_if_those_found_agree() {
        let helps = |reasons: &[Reason]| {
            Trust { verdict: Verdict::Doubtful, reasons: reasons.to_vec() }.may_pass_with_more_matches()
        };
        let relief = |along, across, on_warp| Reason::NoRelief { along, across, on_warp };
        assert!(helps(&[relief(6, 1, 40)]));
        assert!(!helps(&[relief(6, 4, 40)]), "they disagree");
        assert!(!helps(&[relief(6, 1, 400)]), "nearly all are on the warp");
        assert!(!helps(&[relief(0, 0, 40)]));
        let plane = |agreeing, is_still| Reason::OnePlane { percent: 97, groups: 6, agreeing, is_still };
        assert!(helps(&[plane(5, false)]) && !helps(&[plane(3, false)]) && !helps(&[plane(5, true)]));
        assert!(!helps(&[relief(6, 1, 40), Reason::Fisheye]));
    }

    #[test]
    fn doubts_about_the_scene_remain_after_any_search() {
        let leaves =
            |reason| Trust { verdict: Verdict::Doubtful, reasons: vec![reason] }.leaves_another_search();
        assert!(!leaves(Reason::Fisheye) && !leaves(Reason::Mirrored { matches: 90 }));
        assert!(leaves(Reason::FewMatches { matches: 20 }) && leaves(Reason::Ambiguous { margin: 0.01 }));
    }
}
