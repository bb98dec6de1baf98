//! Scales that tell good figures of a result from bad ones, with the limits of the verdict's rules.

use crate::estimate::{
    CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, ENOUGH_MATCHES, EVEN, FAR_TOO_FEW, SURE_LINES,
    Verdict,
};

/// Margin below which a result is a guess. It colours the gauge; no verdict depends on it.
const GUESS_MARGIN: f64 = 0.05;

/// Two limits of a figure. A figure between them leaves doubts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Limit of good figures. A figure as good as this one leaves no doubt.
    pub good: f64,
    /// Limit of bad figures. A worse figure alone speaks against the result.
    pub bad: f64,
}

impl Scale {
    /// Probability that the lines are right, 0 to 1.
    pub const LINES: Self = Self { good: SURE_LINES, bad: EVEN };
    /// Number of matches at full resolution, of a geometry that the images did not propose.
    pub const MATCHES: Self = Self { good: ENOUGH_MATCHES as f64, bad: FAR_TOO_FEW as f64 };
    /// Advantage over the best clearly different geometry, as a fraction.
    pub const MARGIN: Self = Self { good: CLEAR_MARGIN, bad: GUESS_MARGIN };

    /// Returns the scale for the Sampson distance of a click whose standard deviation is
    /// `sigma` px.
    pub fn click(sigma: f64) -> Self {
        Self { good: CLICK_DEVIATIONS * sigma, bad: CLICK_DEVIATIONS_WRONG * sigma }
    }

    /// Returns the scale for the support of a geometry whose rival has support `rival`. Its limits
    /// are the margins of [`Scale::MARGIN`].
    pub fn support_beside(rival: f64) -> Self {
        Self { good: rival / (1.0 - CLEAR_MARGIN), bad: rival / (1.0 - GUESS_MARGIN) }
    }

    /// Returns the scale for the line score of a geometry whose rival has the score `rival`. Its
    /// limits are the margins of [`Scale::MARGIN`].
    pub fn line_score_beside(rival: f64) -> Self {
        Self { good: rival * (1.0 - CLEAR_MARGIN), bad: rival * (1.0 - GUESS_MARGIN) }
    }

    /// Returns whether larger figures are better.
    pub fn more_is_better(self) -> bool {
        self.good > self.bad
    }

    /// Returns the verdict that follows from a figure alone.
    pub fn judge(self, figure: f64) -> Verdict {
        let reaches = |limit: f64| if self.more_is_better() { figure >= limit } else { figure <= limit };
        if reaches(self.good) {
            Verdict::Reliable
        } else if reaches(self.bad) {
            Verdict::Doubtful
        } else {
            Verdict::Unreliable
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_judged_in_both_directions() {
        for (figure, verdict) in
            [(60.0, Verdict::Reliable), (59.0, Verdict::Doubtful), (24.0, Verdict::Unreliable)]
        {
            assert_eq!(Scale::MATCHES.judge(figure), verdict, "{figure} matches");
        }
        for (figure, verdict) in
            [(8.0, Verdict::Reliable), (8.1, Verdict::Doubtful), (24.1, Verdict::Unreliable)]
        {
            assert_eq!(Scale::click(2.0).judge(figure), verdict, "{figure} px");
        }
        assert_eq!(Scale::MARGIN.judge(f64::NAN), Verdict::Unreliable);
    }

    #[test]
    fn beside_a_rival_the_margin_decides() {
        for rival in [3.0, 200.0] {
            for own in [0.5 * rival, 1.04 * rival, 1.1 * rival, 1.3 * rival] {
                let margin = (own - rival) / own;
                assert_eq!(Scale::support_beside(rival).judge(own), Scale::MARGIN.judge(margin));
            }
            for own in [0.5 * rival, 0.9 * rival, 0.96 * rival, 2.0 * rival] {
                let margin = (rival - own) / rival;
                assert_eq!(Scale::line_score_beside(rival).judge(own), Scale::MARGIN.judge(margin));
            }
        }
    }
}
