//! Probability that the lines of a result are right.
//!
//! The probability is a measured frequency. It follows from the verdict and from the kinds of tests
//! that failed, so it is never higher for a worse word. `lab/trust.py` counts the right results of
//! each [`Doubt`] on pairs with known truth.

use crate::estimate::{Assessment, Reason, Trust, Verdict};

/// Severest doubt about a result, from the least to the most severe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Doubt {
    Nothing,
    /// A click off its line, which the images outvote.
    Click,
    /// The matches may not determine the epipoles, but their support is good.
    Epipole,
    /// The support is weak: few matches, a rival, contradicting or imprecise matches.
    Support,
    Unreliable,
}

impl Doubt {
    /// Returns the severest doubt about a result. `None` if a test of the matches was left out: no
    /// probability was measured for such results.
    fn of(trust: &Trust) -> Option<Self> {
        let of_reasons = trust.reasons.iter().map(Self::of_reason).collect::<Option<Vec<_>>>()?;
        Some(match trust.verdict {
            Verdict::Reliable => Self::Nothing,
            Verdict::Doubtful => of_reasons.into_iter().max().unwrap_or(Self::Nothing),
            Verdict::Unreliable => Self::Unreliable,
        })
    }

    fn of_reason(reason: &Reason) -> Option<Self> {
        match reason {
            Reason::ClickOff { .. } => Some(Self::Click),
            Reason::OnePlane { .. }
            | Reason::NoRelief { .. }
            | Reason::OnlyTurned { .. }
            | Reason::BehindCameras { .. }
            | Reason::Bent { .. }
            | Reason::Pattern { .. }
            | Reason::Mirrored { .. } => Some(Self::Epipole),
            Reason::NotRefined
            | Reason::FewMatches { .. }
            | Reason::ByChance { .. }
            | Reason::GivenContradict { .. }
            | Reason::Fisheye
            | Reason::Contradicted { .. }
            | Reason::Ambiguous { .. }
            | Reason::Loose { .. } => Some(Self::Support),
            Reason::NotChecked
            | Reason::RefinementOff
            | Reason::ClicksAlone
            | Reason::PointsAlone { .. }
            | Reason::PointsByChance { .. }
            | Reason::GivenAlone { .. }
            | Reason::BarcodesByChance { .. }
            | Reason::FewBarcodes { .. }
            | Reason::LooseBarcodes { .. } => None,
        }
    }

    /// Returns the share of right results by the rule of succession, `(right + 1) / (all + 2)`:
    /// neither 0 nor 1. Fitted to the results of `lab/trust.py` (`lab/notes.md` has the counts).
    fn probability(self) -> f64 {
        let (right, all) = match self {
            // Counted together: an outvoted click was never seen to be worse than nothing.
            Self::Nothing | Self::Click => (142.0, 145.0),
            Self::Epipole => (105.0, 113.0),
            Self::Support => (31.0, 50.0),
            Self::Unreliable => (7.0, 25.0),
        };
        (right + 1.0) / (all + 2.0)
    }
}

impl Assessment {
    /// Returns the probability that the lines of the result are within 1 % of the longer side of the
    /// scene points, strictly between 0 and 1.
    ///
    /// It is the share of right results among results with the same verdict and the same kinds of
    /// failed tests, measured on pairs with known truth. If the epipoles are open
    /// ([`Trust::says_one_plane`]), it concerns the lines near the matches alone. `None` without a
    /// verdict, and for what was not measured: motion barcodes, a geometry of the clicks alone, and
    /// searches without patches or refinement.
    pub fn probability_within_one_percent(&self) -> Option<f64> {
        let trust = self.trust.as_ref().filter(|_| self.barcodes.is_none())?;
        Doubt::of(trust).map(Doubt::probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{BarcodeFigures, Suspect};

    const PLANE: Reason = Reason::OnePlane { percent: 98, groups: 9, agreeing: 2, is_still: false };
    const CLICK: Reason = Reason::ClickOff { pair: 1, distance: 30.0, suspect: Suspect::Click };
    const CHANCE: Reason = Reason::ByChance { agreeing: 9, matches: 140 };
    const FEW: Reason = Reason::FewMatches { matches: 40 };

    fn judged(verdict: Verdict, reasons: &[Reason]) -> Assessment {
        let trust = Some(Trust { verdict, reasons: reasons.to_vec() });
        Assessment { trust, ..Assessment::default() }
    }

    fn probability(verdict: Verdict, reasons: &[Reason]) -> f64 {
        judged(verdict, reasons).probability_within_one_percent().unwrap()
    }

    #[test]
    fn a_worse_word_or_a_worse_doubt_is_never_more_probable() {
        let doubtful = |reasons| probability(Verdict::Doubtful, reasons);
        let falling = [
            probability(Verdict::Reliable, &[]),
            doubtful(&[CLICK]),
            doubtful(&[CLICK, PLANE]),
            doubtful(&[PLANE, FEW]),
            probability(Verdict::Unreliable, &[CLICK, PLANE]),
            probability(Verdict::Unreliable, &[CHANCE]),
        ];
        assert!(falling.is_sorted_by(|better, worse| better >= worse), "{falling:?}");
        assert!(falling.iter().all(|probability| (0.001..0.999).contains(probability)), "{falling:?}");
        let both = doubtful(&[CLICK, PLANE]);
        assert!((both - doubtful(&[PLANE])).abs() < 1e-12, "the worst doubt counts: {both}");
    }

    #[test]
    fn what_was_not_measured_has_no_probability() {
        assert_eq!(Assessment::default().probability_within_one_percent(), None);
        let unchecked = judged(Verdict::Doubtful, &[FEW, Reason::RefinementOff]);
        assert_eq!(unchecked.probability_within_one_percent(), None);
        let barcodes =
            BarcodeFigures { correlation: 0.5, by_chance: 0.1, lines: 40.0, deviation: None, frames: 300 };
        let of_sequences = Assessment { barcodes: Some(barcodes), ..judged(Verdict::Reliable, &[]) };
        assert_eq!(of_sequences.probability_within_one_percent(), None);
    }
}
