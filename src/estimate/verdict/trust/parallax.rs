//! Figures of the parallax beside a plane, a smooth warp or a turn of the camera, and whether they show the epipole.

use std::f64::consts::FRAC_2_PI;

use serde::Serialize;

use super::chance::{at_least, tail};
use crate::estimate::fit::false_alarms::BY_CHANCE;
use crate::estimate::verdict::constants::{ALONG, ANY_EPIPOLE, EVEN, HALF_PLANE, MOSTLY_ALONG, ONE_PLANE};

/// Matches off the largest plane, as evidence for the epipoles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct OffPlane {
    /// Number of groups of matches that move alike.
    pub groups: usize,
    /// Number of groups that agree with `F`.
    pub agreeing: usize,
    /// Number of motions among the agreeing groups. Each has more matches than are expected to be
    /// wrong.
    pub motions: usize,
    /// Expected number of epipoles that do as well by chance.
    #[cfg_attr(test, serde(deserialize_with = "crate::estimate::fit::false_alarms::or_infinite"))]
    pub by_chance: f64,
    /// The same number if all groups of one motion count once.
    #[cfg_attr(test, serde(deserialize_with = "crate::estimate::fit::false_alarms::or_infinite"))]
    pub motions_by_chance: f64,
}

impl OffPlane {
    /// Returns whether the matches off the plane determine the epipoles by themselves. Static surfaces at different
    /// places can have equal parallax, so fewer than one epipole has to do as well by chance if each motion counts once.
    fn holds_the_epipoles(&self) -> bool {
        self.by_chance <= BY_CHANCE && self.motions_by_chance <= 1.0 && self.motions > ANY_EPIPOLE
    }

    /// Returns the evidence that determines the epipoles. If both kinds or neither do, returns the
    /// kind that is less likely by chance.
    pub fn or_stronger(self, other: Self) -> Self {
        let rank = |one: &Self| (!one.holds_the_epipoles(), one.by_chance);
        if rank(&other) < rank(&self) { other } else { self }
    }
}

/// Share of the matches that one homography explains, and the evidence of the other matches for the
/// epipoles.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct PlaneEvidence {
    /// Share of the matches explained by the homography, 0 to 1.
    pub share: f64,
    pub off: OffPlane,
    /// Whether the homography leaves the matches in their places, as if the camera stood still.
    pub is_still: bool,
}

impl PlaneEvidence {
    /// Returns whether the matches leave the epipoles undetermined. Relief beside
    /// [`ANY_EPIPOLE`] further planes shows the epipoles whatever the number of motions, since some
    /// epipole fits the planes but not the rest. If the camera stood still, everything that moved did
    /// so by itself. A far background stays in its place, too, but then most groups beside it agree.
    pub(super) fn leaves_the_epipoles_open(&self, relief: Option<Relief>) -> bool {
        let is_undecided = || !relief.is_some_and(|relief| relief.further.show_the_epipole());
        self.share > ONE_PLANE
            || self.is_still && (self.share > HALF_PLANE || 2 * self.off.agreeing <= self.off.groups)
            || self.share > EVEN && !self.off.holds_the_epipoles() && is_undecided()
            || self.share > HALF_PLANE && self.off.motions <= ANY_EPIPOLE && is_undecided()
    }
}

/// Matches found without `F`, beside the smooth warp that most matches follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct Witnesses {
    /// Number of matches on the warp, and of those that are likelier there than where they are.
    pub on_warp: usize,
    /// Number of matches beside the warp, along their epipolar lines.
    pub along: usize,
    /// Number of matches beside the warp, across their epipolar lines. `off` counts them too.
    pub across: usize,
    /// Number of matches beside the warp that are clearly off their epipolar lines and not along
    /// them.
    pub off: usize,
}

impl Witnesses {
    /// Returns whether parallax that no smooth warp, or no turn of known cameras, explains shows the epipole.
    pub fn show_the_epipole(self) -> bool {
        self.is_no_chance() && self.are_enough() && self.are_along() && !self.are_mostly_off()
    }

    /// Returns whether enough of all matches are beside the warp along their lines.
    pub(super) fn are_enough(self) -> bool {
        1.0 - self.share_along() <= ONE_PLANE
    }

    /// Returns whether of the matches along and across their lines, clearly most are along.
    pub(super) fn are_along(self) -> bool {
        at_least(self.along, self.along + self.across) >= MOSTLY_ALONG
    }

    /// Returns whether clearly more matches lie off their lines than along them. Wrong matches lie anywhere, so many of
    /// them alone are no doubt.
    fn are_mostly_off(self) -> bool {
        at_least(self.off, self.along + self.off) >= EVEN
    }

    /// Returns whether chance seldom does as well. A wrong match lies in any direction from the warp.
    /// Some epipole fits any two matches, so there are as many epipoles as pairs of matches. The
    /// binomial tail says how likely each explains as many by chance.
    fn is_no_chance(self) -> bool {
        let n = self.along + self.off;
        let pairs = (n * n.saturating_sub(1) / 2) as f64;
        pairs * tail(self.off, n, along_by_chance()) <= BY_CHANCE
    }

    /// Returns whether the shares of the matches would show the epipole if there were more matches.
    pub fn would_show_the_epipole(self) -> bool {
        let Self { along, across, .. } = self;
        1.0 - self.share_along() <= ONE_PLANE
            && along > 0
            && along as f64 >= MOSTLY_ALONG * (along + across) as f64
    }

    /// Returns the share of the matches that are beside the warp along their lines, 0 to 1.
    fn share_along(self) -> f64 {
        self.along as f64 / (self.on_warp + self.along + self.off).max(1) as f64
    }
}

/// Matches found without `F` beside a smooth warp, counted in three ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct Relief {
    /// Beside the warp.
    pub beside: Witnesses,
    /// The same, with [`ANY_EPIPOLE`] more planes counted as the warp.
    pub further: Witnesses,
    /// Beside a warp that follows the rows more closely.
    pub finer: Witnesses,
    /// Beside the warp, matches alone that are clearly likelier than all similar places together.
    pub clear: Witnesses,
}

impl Relief {
    /// Returns the matches that leave the epipoles undetermined. `None` if parallax shows them. Beside the
    /// finer warp it must not vanish among wrong matches: a rolling shutter may swing faster than the coarser
    /// warp follows. Nor may it rest on matches that are equalled elsewhere, as on wallpaper.
    pub(super) fn doubt(self) -> Option<Witnesses> {
        let Self { beside, finer, clear, .. } = self;
        let doubted = [beside, clear].into_iter().find(|found| !found.show_the_epipole());
        doubted.or((!finer.is_no_chance()).then_some(finer))
    }
}

/// Evidence for the direction of the baseline of two known cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct Baseline {
    /// Matches found without the geometry, beside a camera that only turned.
    pub beside: Witnesses,
    /// The other solution of the largest plane, if there is one.
    pub other: Option<OtherPose>,
    /// Number of matches along the lines whose scene point is in front of both cameras.
    pub in_front: usize,
    /// Number of matches along the lines.
    pub matches: usize,
}

impl Baseline {
    /// Returns whether too many scene points are behind a camera. By chance, half of them are.
    pub fn is_behind(self) -> bool {
        at_least(self.in_front, self.matches) < MOSTLY_ALONG
    }
}

/// Matches found without the geometry that a pose explains and the other solution of a plane does not, and the
/// reverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct OtherPose {
    pub this_only: usize,
    pub other_only: usize,
}

impl OtherPose {
    /// Returns whether chance seldom favours a pose as much (sign test).
    pub fn is_decided(self) -> bool {
        self.this_only > self.other_only
            && tail(self.other_only, self.this_only + self.other_only, 0.5) <= BY_CHANCE
    }

    /// Returns the relative advantage of the pose.
    pub(super) fn margin(self) -> f64 {
        let (this, other) = (self.this_only as f64, self.other_only as f64);
        (this - other) / (this + other).max(1.0)
    }
}

/// Returns the probability that a displacement in any direction is along a line.
fn along_by_chance() -> f64 {
    FRAC_2_PI * ALONG.atan()
}
