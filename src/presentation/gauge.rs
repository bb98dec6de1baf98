//! Place of a figure between bad and good, for a bar beside it. The limits come from the estimator.
//! Without limits, the bar runs from the worst to the best hypothesis and has no colour.

use super::scale::Scale;
use super::tone::Tone;
use crate::estimate::{self, Construction, Estimate, LineScore};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};

/// A bar: bad on the left, good on the right.
#[derive(Debug, Clone, PartialEq)]
pub struct Gauge {
    /// Place of the figure, 0 to 1.
    pub place: f32,
    /// Limits of bad and of good, if there is a rule.
    pub limits: Option<[f32; 2]>,
    /// Judgement by this figure alone, if there is a rule.
    pub tone: Option<Tone>,
    /// Explanation of the limits.
    pub words: String,
}

impl Gauge {
    /// Creates the bar of a figure with a rule.
    pub fn judged(scale: Scale, figure: f64, text: impl Fn(f64) -> String) -> Self {
        let more = scale.more_is_better();
        // The bar ends at twice the good limit, or slightly above the bad limit.
        let span = if more { 2.0 * scale.good } else { 1.25 * scale.bad };
        let at = |v: f64| {
            let share = if span > 0.0 && v.is_finite() { (v / span).clamp(0.0, 1.0) } else { 1.0 };
            (if more { share } else { 1.0 - share }) as f32
        };
        let tone = match scale.judge(figure) {
            estimate::Verdict::Reliable => Tone::Good,
            estimate::Verdict::Doubtful => Tone::Caution,
            estimate::Verdict::Unreliable | estimate::Verdict::DifferentScenes => Tone::Bad,
        };
        let (good, bad) = (text(scale.good), text(scale.bad));
        let words = if more {
            format!("Good from {good} on, bad below {bad}.")
        } else {
            format!("Good up to {good}, bad above {bad}.")
        };
        Self { place: at(figure), limits: Some([at(scale.bad), at(scale.good)]), tone: Some(tone), words }
    }

    /// Creates the bar of a figure without a rule, from the worst to the best hypothesis.
    fn among(worst: f64, best: f64, figure: f64, text: impl Fn(f64) -> String) -> Self {
        let range = best - worst;
        let place = if range.abs() > 0.0 { ((figure - worst) / range).clamp(0.0, 1.0) } else { 0.5 };
        let words = format!(
            "No limits are known for this figure. The worst hypothesis has {}, the best {}.",
            text(worst),
            text(best)
        );
        Self { place: place as f32, limits: None, tone: None, words }
    }

    /// Creates the bar of a clicked pair with the limits of the verdict, for the displayed distance of the pair.
    ///
    /// The verdict judges the Sampson distance. Near its line, every distance of a pair is a multiple of the
    /// Sampson distance, and so are the limits in that measure.
    pub fn of_click(f: &FundamentalMatrix, pair: &PointPair, sigma: f64, displayed: f64) -> Self {
        let judged = sampson_distance(f, pair);
        let factor = if judged > 0.0 { displayed / judged } else { 1.0 };
        Self::judged(Scale::click(sigma), judged, |limit| format!("{:.1} px", limit * factor))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HypothesisFigure {
    /// Support by matching corners.
    Support,
    /// Matching cost of its lines.
    LineScore,
    /// Distance between a line and its image after a round trip.
    RoundTrip,
    /// Ratio of κ in the two maps between the pencils.
    ThereBack,
}

impl HypothesisFigure {
    const ALL: [Self; 4] = [Self::Support, Self::LineScore, Self::RoundTrip, Self::ThereBack];

    /// Returns the figure of a hypothesis; NaN if it has none.
    pub fn of(self, hypothesis: &Estimate) -> f64 {
        let lines = hypothesis.assessment.lines.as_ref();
        let figure = match self {
            Self::Support => hypothesis.support_score(),
            Self::LineScore => hypothesis.line_score(),
            Self::RoundTrip => lines.and_then(|lines| lines.round_trip_area),
            Self::ThereBack => lines.and_then(|lines| ratio(&lines.construction)),
        };
        figure.unwrap_or(f64::NAN)
    }

    /// Converts a figure so that larger is worse.
    fn badness(self, figure: f64) -> f64 {
        match self {
            Self::Support => -figure,
            Self::LineScore | Self::RoundTrip => figure,
            Self::ThereBack => figure.ln().abs(),
        }
    }

    fn text(self, figure: f64, kind: LineScore) -> String {
        match self {
            Self::Support => format!("{figure:.1}"),
            Self::LineScore => line_score_text(kind, figure),
            Self::RoundTrip => format!("{figure:.2} px"),
            Self::ThereBack => format!("{figure:.3}"),
        }
    }
}

fn ratio(construction: &Construction) -> Option<f64> {
    Some(construction.kappa_line2_from_line1() / construction.kappa_line1_from_line2()?)
}

/// Formats a line score in its unit, which depends on the kind of score.
pub fn line_score_text(kind: LineScore, score: f64) -> String {
    match kind {
        LineScore::AgainstMismatched => format!("{:.1} %", score * 100.0),
        LineScore::Cost => format!("{score:.1}"),
    }
}

/// Returns the rival: the hypothesis that sets the margin, by its place in the list.
pub fn rival(estimate: &Estimate) -> Option<usize> {
    estimate.assessment.apart.as_ref()?.rival()
}

/// Ranges of good and bad for the hypotheses of one search.
#[derive(Debug, Clone)]
pub struct HypothesisScales {
    /// Worst and best value of each figure.
    ends: [Option<[f64; 2]>; 4],
    support: Option<Scale>,
    line_score: Option<Scale>,
    kind: LineScore,
}

impl HypothesisScales {
    /// Creates the scales for the hypotheses of a result with line scores of this kind.
    pub fn new(result: &Estimate, kind: LineScore) -> Self {
        let ends = HypothesisFigure::ALL.map(|figure| {
            let order = |a: &f64, b: &f64| figure.badness(*a).total_cmp(&figure.badness(*b));
            let values = || result.hypotheses().iter().map(|own| figure.of(own)).filter(|v| v.is_finite());
            Some([values().max_by(order)?, values().min_by(order)?])
        });
        // The margin after refinement replaces these limits.
        let rival = rival(result).filter(|_| result.assessment.refined_margin.is_none());
        let rival = rival.and_then(|place| result.hypotheses().get(place));
        let support = rival.and_then(Estimate::support_score).map(Scale::support_beside);
        let line_score =
            rival.filter(|_| support.is_none()).and_then(Estimate::line_score).map(Scale::line_score_beside);
        Self { ends, support, line_score, kind }
    }

    pub fn gauge(&self, figure: HypothesisFigure, value: f64) -> Option<Gauge> {
        let scale = match figure {
            HypothesisFigure::Support => self.support,
            HypothesisFigure::LineScore => self.line_score,
            HypothesisFigure::RoundTrip | HypothesisFigure::ThereBack => None,
        };
        let Some(scale) = scale.filter(|_| value.is_finite()) else { return self.of_result(figure, value) };
        let gauge = Gauge::judged(scale, value, |v| figure.text(v, self.kind));
        let words = format!("Compared with the rival: {}", gauge.words.to_lowercase());
        Some(Gauge { words, ..gauge })
    }

    /// Returns the bar of a figure of the refined result. It has no limits, as the margin belongs
    /// to the unrefined hypothesis.
    pub fn of_result(&self, figure: HypothesisFigure, value: f64) -> Option<Gauge> {
        if !value.is_finite() {
            return None;
        }
        let text = |v: f64| figure.text(v, self.kind);
        let [worst, best] = self.ends[figure as usize]?;
        let gauge = Gauge::among(figure.badness(worst), figure.badness(best), figure.badness(value), |_| {
            String::new()
        });
        let words = Gauge::among(worst, best, value, text).words;
        Some(Gauge { words, ..gauge })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_is_on_the_left_and_good_on_the_right_for_every_scale() {
        let matches = |count: f64| Gauge::judged(Scale::MATCHES, count, |v| format!("{v:.0}"));
        let click = |distance: f64| Gauge::judged(Scale::click(1.0), distance, |v| format!("{v:.1} px"));
        for (worse, better) in [(matches(10.0), matches(50.0)), (click(9.0), click(1.0))] {
            assert!(worse.place < better.place);
            let [bad, good] = better.limits.unwrap();
            assert!(0.0 < bad && bad < good && good < 1.0, "{bad} {good}");
        }
        assert_eq!(matches(1e9).place.to_bits(), 1.0_f32.to_bits());
        assert_eq!(click(f64::INFINITY).place.to_bits(), 0.0_f32.to_bits());
        assert_eq!((matches(80.0).tone, click(5.0).tone), (Some(Tone::Good), Some(Tone::Caution)));
        assert_eq!(matches(80.0).words, "Good from 60 on, bad below 25.");
        assert_eq!(click(5.0).words, "Good up to 4.0 px, bad above 12.0 px.");
    }
}
