//! How far to trust a result: a verdict with its reasons in words.
//!
//! Four things are looked at, each of which a wrong geometry usually fails: how many patches match along the
//! epipolar lines at full resolution, whether the clicks lie on their lines, how much better the result is than
//! the best clearly different geometry, and how firmly the matches hold the lines. A result is called reliable
//! when none of them speaks against it. The thresholds are round numbers from results whose truth is known,
//! right and wrong clicks alike; see the documentation of the estimator for the figures.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How far to trust a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Everything that was looked at speaks for it.
    #[serde(alias = "right")]
    Reliable,
    /// Something speaks against it.
    Doubtful,
    /// It contradicts the images or the clicks.
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
        "{percent} % of the matches fit one plane or a turn of the camera, so the epipoles are hardly determined: use views from places farther apart, or a scene with more depth"
    )]
    OnePlane {
        /// Percent of the matches.
        percent: u32,
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
/// Loosest epipolar lines, as a fraction of the longer side.
const LOOSEST: f64 = 0.002;

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
    /// Share of the matches that one homography explains, 0 to 1.
    pub on_one_plane: f64,
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
        if evidence.on_one_plane > ONE_PLANE {
            reasons.push(Reason::OnePlane { percent: (100.0 * evidence.on_one_plane) as u32 });
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
        on_one_plane: 0.4,
        side: 768.0,
    };

    fn verdict(evidence: Evidence) -> Verdict {
        Trust::judge(&evidence).verdict
    }

    #[test]
    fn a_result_is_reliable_only_when_nothing_speaks_against_it() {
        assert_eq!(Trust::judge(&GOOD), Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        assert_eq!(verdict(Evidence { margin: None, ..GOOD }), Verdict::Reliable);
        for worse in [
            Evidence { patches: false, matches: None, ..GOOD },
            Evidence { matches: None, ..GOOD },
            Evidence { matches: Some(50), ..GOOD },
            Evidence { clicks: &[0.5, 5.0], ..GOOD },
            Evidence { margin: Some(0.05), ..GOOD },
            Evidence { deviation: Some(3.0), ..GOOD },
            Evidence { on_one_plane: 0.98, ..GOOD },
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
}
