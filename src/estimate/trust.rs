//! How far to trust a result: a verdict with its reasons in words.
//!
//! Four things are looked at, each of which a wrong geometry usually fails: how many patches match along the
//! epipolar lines at full resolution, whether the clicks lie on their lines, how much better the result is than
//! the best clearly different geometry, and how firmly the matches hold the lines. A result is called reliable
//! when none of them speaks against it. The thresholds are round numbers from results whose truth is known,
//! right and wrong clicks alike; see `docs/measurements.md` for the figures.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How far to trust a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Everything that was looked at speaks for the result.
    #[serde(alias = "right")]
    Reliable,
    /// Something speaks against the result.
    Doubtful,
    /// The result contradicts the images or the clicks.
    #[serde(alias = "wrong")]
    Unreliable,
}

impl Verdict {
    /// What the user reads.
    pub fn label(self) -> &'static str {
        match self {
            Self::Reliable => "reliable",
            Self::Doubtful => "doubtful",
            Self::Unreliable => "unreliable",
        }
    }
}

/// Something that speaks against a result. Each message is one sentence.
#[derive(Debug, Clone, PartialEq, Error, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// Patches were not looked at, so only the lines speak for it.
    #[error("patches were not compared, so nothing but the lines speaks for this geometry")]
    NotChecked,
    /// The refinement did not find enough matches.
    #[error("too few patches match along the epipolar lines at full resolution")]
    NotRefined,
    /// Few matches carry the result.
    #[error("only {matches} patches match along the epipolar lines")]
    FewMatches {
        /// Matches found.
        matches: usize,
    },
    /// A click is off its epipolar line.
    #[error(
        "point pair {pair} is {distance:.1} px off its epipolar line: check that it shows the same scene point"
    )]
    ClickOff {
        /// Number of the pair, from 1.
        pair: usize,
        /// Sampson distance, px.
        distance: f64,
    },
    /// A clearly different geometry has nearly as much support.
    #[error("a clearly different geometry has nearly as much support (margin {margin:.2})")]
    Ambiguous {
        /// Relative advantage over it.
        margin: f64,
    },
    /// Nearly all matches follow one homography.
    #[error(
        "{percent} % of the matches fit one plane or a turn of the camera, and of {groups} things beside it that moved, {agreeing} agree on where the epipolar lines meet: use views from places farther apart, or a scene with more depth and nothing that moves"
    )]
    OnePlane {
        /// Percent of the matches.
        percent: u32,
        /// Groups of matches off it that move alike.
        groups: usize,
        /// How many of these agree with the epipoles.
        agreeing: usize,
    },
    /// The matches leave the epipolar lines loose.
    #[error("the matches leave the epipolar lines uncertain by {deviation:.1} px")]
    Loose {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
}

/// A verdict and what led to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// The verdict.
    pub verdict: Verdict,
    /// What speaks against the result; empty when it is called reliable.
    pub reasons: Vec<Reason>,
}

/// Fewer matches than this do not call a result reliable, and far fewer call it unreliable.
const ENOUGH_MATCHES: usize = 60;
const FAR_TOO_FEW: usize = 25;
/// A click farther off its line than the first many standard deviations is a mistake, or the result is; far more,
/// and the result is unreliable unless everything else speaks for it.
const CLICK_DEVIATIONS: f64 = 4.0;
const CLICK_DEVIATIONS_WRONG: f64 = 12.0;
/// Smallest advantage over a clearly different geometry.
const CLEAR_MARGIN: f64 = 0.2;
/// Share of the matches on one plane from which on the epipoles hang on a handful of matches.
const ONE_PLANE: f64 = 0.95;
/// Share from which on what lies off the plane has to hold the epipoles by itself.
const MOSTLY_PLANE: f64 = 0.5;
/// Probability that what lies off the plane agrees by chance, at most: one of a thousand results may be called reliable
/// for it.
const BY_CHANCE: f64 = 1e-3;
/// Loosest epipolar lines, as a fraction of the longer side.
const LOOSEST: f64 = 0.002;

/// What one homography explains of the matches, and what the rest says of the epipoles.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaneEvidence {
    /// Share of the matches that it explains, 0 to 1.
    pub share: f64,
    /// Groups of distinctive matches off it that move alike, and how many of them agree with F.
    pub groups: usize,
    pub agreeing: usize,
    /// Probability that so many agree by chance, beyond those that an epipole always fits.
    pub chance: f64,
}

impl PlaneEvidence {
    /// Whether the epipoles hang on the plane alone.
    fn leaves_the_epipoles_open(&self) -> bool {
        self.share > ONE_PLANE || self.share > MOSTLY_PLANE && self.chance > BY_CHANCE
    }
}

/// What a verdict rests on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evidence<'a> {
    /// Whether patches were looked at.
    pub patches: bool,
    /// Whether the result was refined, and on how many matches.
    pub matches: Option<usize>,
    /// Sampson distances of the clicks, px.
    pub clicks: &'a [f64],
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
    /// Advantage over the best clearly different geometry.
    pub margin: Option<f64>,
    /// Median standard deviation of the epipolar lines at the matches, px.
    pub deviation: Option<f64>,
    /// The largest plane, where there are matches.
    pub plane: Option<PlaneEvidence>,
    /// Longer side of image 1, px.
    pub side: f64,
}

impl Trust {
    pub(super) fn judge(evidence: &Evidence) -> Self {
        let mut reasons = Vec::new();
        let mut unreliable = false;
        if !evidence.patches {
            reasons.push(Reason::NotChecked);
        }
        match evidence.matches {
            None if evidence.patches => reasons.push(Reason::NotRefined),
            Some(matches) if matches < ENOUGH_MATCHES => {
                unreliable |= matches < FAR_TOO_FEW;
                reasons.push(Reason::FewMatches { matches });
            }
            _ => {}
        }
        let mut far_off = false;
        for (k, distance) in evidence.clicks.iter().enumerate() {
            let deviations = distance / evidence.click_sigma;
            if deviations > CLICK_DEVIATIONS {
                far_off |= deviations > CLICK_DEVIATIONS_WRONG;
                reasons.push(Reason::ClickOff { pair: k + 1, distance: *distance });
            }
        }
        if let Some(margin) = evidence.margin.filter(|m| *m < CLEAR_MARGIN) {
            reasons.push(Reason::Ambiguous { margin });
        }
        if let Some(deviation) = evidence.deviation.filter(|d| *d > LOOSEST * evidence.side) {
            reasons.push(Reason::Loose { deviation });
        }
        if let Some(plane) = evidence.plane.filter(PlaneEvidence::leaves_the_epipoles_open) {
            let PlaneEvidence { share, groups, agreeing, .. } = plane;
            reasons.push(Reason::OnePlane { percent: (100.0 * share) as u32, groups, agreeing });
        }
        // A mistaken click beside a geometry that everything else speaks for is no more than that: patches have
        // outvoted it. With anything else against it, the result is unreliable.
        let but_clicks = reasons.iter().any(|r| !matches!(r, Reason::ClickOff { .. }));
        unreliable |= far_off && but_clicks;
        let verdict = match (reasons.is_empty(), unreliable) {
            (true, _) => Verdict::Reliable,
            (false, false) => Verdict::Doubtful,
            (false, true) => Verdict::Unreliable,
        };
        Self { verdict, reasons }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Evidence = Evidence {
        patches: true,
        matches: Some(300),
        clicks: &[0.5, 1.2],
        click_sigma: 1.0,
        margin: Some(0.5),
        deviation: Some(0.05),
        plane: Some(PlaneEvidence { share: 0.4, groups: 9, agreeing: 1, chance: 1.0 }),
        side: 768.0,
    };

    fn verdict(evidence: Evidence) -> Verdict {
        Trust::judge(&evidence).verdict
    }

    #[test]
    fn a_result_is_reliable_only_when_nothing_speaks_against_it() {
        assert_eq!(Trust::judge(&GOOD), Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        assert_eq!(verdict(Evidence { margin: None, ..GOOD }), Verdict::Reliable);
        let plane = |share, chance| Some(PlaneEvidence { share, groups: 9, agreeing: 7, chance });
        assert_eq!(verdict(Evidence { plane: plane(0.6, 1e-4), ..GOOD }), Verdict::Reliable);
        for worse in [
            Evidence { patches: false, matches: None, ..GOOD },
            Evidence { matches: None, ..GOOD },
            Evidence { matches: Some(50), ..GOOD },
            Evidence { clicks: &[0.5, 5.0], ..GOOD },
            Evidence { margin: Some(0.05), ..GOOD },
            Evidence { deviation: Some(3.0), ..GOOD },
            Evidence { plane: plane(0.98, 0.0), ..GOOD },
            Evidence { plane: plane(0.6, 0.01), ..GOOD },
        ] {
            assert_eq!(verdict(worse), Verdict::Doubtful);
        }
        assert_eq!(verdict(Evidence { matches: Some(12), ..GOOD }), Verdict::Unreliable);
        assert_eq!(verdict(Evidence { clicks: &[40.0, 0.1], ..GOOD }), Verdict::Doubtful, "outvoted");
        assert_eq!(
            verdict(Evidence { clicks: &[40.0, 0.1], margin: Some(0.1), ..GOOD }),
            Verdict::Unreliable
        );
        assert_eq!(verdict(Evidence { clicks: &[40.0, 0.1], matches: None, ..GOOD }), Verdict::Unreliable);
    }

    #[test]
    fn reasons_name_the_pair_and_the_distance() {
        let trust = Trust::judge(&Evidence { clicks: &[0.5, 5.04], ..GOOD });
        assert!(trust.reasons[0].to_string().starts_with("point pair 2 is 5.0 px off"));
    }

    /// Both sides of every threshold, as near as the kind of number allows.
    #[test]
    fn each_threshold_is_where_its_constant_says() {
        let reasons = |evidence: Evidence| Trust::judge(&evidence).reasons;
        let plane = |share, chance| Some(PlaneEvidence { share, groups: 9, agreeing: 2, chance });
        let next = |v: f64| v * (1.0 + 1e-12);
        let before = |v: f64| v * (1.0 - 1e-12);
        let silent = [
            Evidence { matches: Some(ENOUGH_MATCHES), ..GOOD },
            Evidence { clicks: &[CLICK_DEVIATIONS], ..GOOD },
            Evidence { clicks: &[2.0 * CLICK_DEVIATIONS], click_sigma: 2.0, ..GOOD },
            Evidence { margin: Some(CLEAR_MARGIN), ..GOOD },
            Evidence { deviation: Some(LOOSEST * GOOD.side), ..GOOD },
            Evidence { deviation: None, ..GOOD },
            Evidence { plane: plane(ONE_PLANE, BY_CHANCE), ..GOOD },
            Evidence { plane: plane(MOSTLY_PLANE, 1.0), ..GOOD },
            Evidence { plane: None, ..GOOD },
        ];
        for evidence in silent {
            assert_eq!(reasons(evidence), [], "{evidence:?}");
        }
        let off = next(CLICK_DEVIATIONS);
        let few = ENOUGH_MATCHES - 1;
        let (margin, deviation) = (before(CLEAR_MARGIN), next(LOOSEST * GOOD.side));
        let told = [
            (Evidence { matches: Some(few), ..GOOD }, Reason::FewMatches { matches: few }),
            (Evidence { clicks: &[0.1, off], ..GOOD }, Reason::ClickOff { pair: 2, distance: off }),
            (
                Evidence { clicks: &[0.5 * off], click_sigma: 0.5, ..GOOD },
                Reason::ClickOff { pair: 1, distance: 0.5 * off },
            ),
            (Evidence { margin: Some(margin), ..GOOD }, Reason::Ambiguous { margin }),
            (Evidence { deviation: Some(deviation), ..GOOD }, Reason::Loose { deviation }),
            (
                Evidence { plane: plane(next(ONE_PLANE), 0.0), ..GOOD },
                Reason::OnePlane { percent: 95, groups: 9, agreeing: 2 },
            ),
            (
                Evidence { plane: plane(next(MOSTLY_PLANE), next(BY_CHANCE)), ..GOOD },
                Reason::OnePlane { percent: 50, groups: 9, agreeing: 2 },
            ),
        ];
        for (evidence, reason) in told {
            assert_eq!(reasons(evidence), [reason], "{evidence:?}");
            assert_eq!(verdict(evidence), Verdict::Doubtful, "{evidence:?}");
        }
    }

    #[test]
    fn too_few_matches_and_far_clicks_with_anything_else_are_unreliable() {
        assert_eq!(verdict(Evidence { matches: Some(FAR_TOO_FEW), ..GOOD }), Verdict::Doubtful);
        assert_eq!(verdict(Evidence { matches: Some(FAR_TOO_FEW - 1), ..GOOD }), Verdict::Unreliable);
        let [at, beyond] = [CLICK_DEVIATIONS_WRONG, CLICK_DEVIATIONS_WRONG * (1.0 + 1e-12)];
        for (distance, expected) in [(at, Verdict::Doubtful), (beyond, Verdict::Unreliable)] {
            let clicks = [distance, 0.0];
            assert_eq!(verdict(Evidence { clicks: &clicks, margin: Some(0.1), ..GOOD }), expected);
            assert_eq!(verdict(Evidence { clicks: &clicks, ..GOOD }), Verdict::Doubtful, "outvoted");
        }
        // Lines alone: not refined is what is expected there, and no second reason.
        let lines = Evidence { patches: false, matches: None, ..GOOD };
        assert_eq!(Trust::judge(&lines).reasons, [Reason::NotChecked]);
    }
}
