//! The figures behind a result, each with what is good and bad.

use std::f64::consts::PI;

use super::gauge::{Gauge, HypothesisFigure, HypothesisScales, line_score_text, rival};
use super::tone::Tone;
use crate::app::model::computation::Freshness;
use crate::app::model::document::{Document, Imported};
use crate::estimate::{Estimate, LineScore, Reason, Scale};
use crate::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, finite_point};

/// A figure with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    /// What it is.
    pub name: &'static str,
    /// The figure with its unit.
    pub value: String,
    /// What it means.
    pub tooltip: &'static str,
    /// Whether it speaks for the result, where there is a measure for that.
    pub tone: Option<Tone>,
    /// Where it lies between bad and good.
    pub gauge: Option<Gauge>,
}

impl Fact {
    /// A figure without a measure of good and bad.
    pub fn new(name: &'static str, value: impl Into<String>, tooltip: &'static str) -> Self {
        Self { name, value: value.into(), tooltip, tone: None, gauge: None }
    }

    /// With where it lies between bad and good.
    #[must_use]
    fn on(self, gauge: Option<Gauge>) -> Self {
        Self { tone: gauge.as_ref().and_then(|gauge| gauge.tone), gauge, ..self }
    }

    /// What it means, with what is good and bad.
    pub fn explained(&self) -> String {
        self.gauge
            .as_ref()
            .map_or_else(|| self.tooltip.to_owned(), |gauge| format!("{}\n{}", self.tooltip, gauge.words))
    }
}

/// What is known about a geometry from a file.
pub fn import_facts(imported: &Imported) -> Vec<Fact> {
    let check = match &imported.check {
        Some(check) => format!("{:.2} px, median of {} {}", check.median, check.matches, check.of),
        None => "unchecked".to_owned(),
    };
    vec![
        Fact::new("From", imported.file.clone(), "The file that it was imported from."),
        Fact::new(
            "Taken",
            imported.reading.clone(),
            "How the numbers of the file were taken, of all the conventions that are in use.",
        ),
        Fact::new(
            "Checked",
            check,
            "Symmetric distance that half of the matches at the time of the import stay below.",
        ),
    ]
}

/// The figures behind a result.
pub fn facts(document: &Document, estimate: &Estimate, freshness: Freshness) -> Vec<Fact> {
    let mut facts = epipoles(document, estimate.fundamental());
    if matches!(freshness, Freshness::Followed | Freshness::Stale) {
        // The other figures belong to earlier points.
        return facts;
    }
    // Before the end, near-copies of the result are not told from other geometries.
    facts.extend((freshness == Freshness::Final).then(|| margin(estimate)));
    facts.extend(barcodes(estimate));
    if let Some(refinement) = &estimate.assessment.refinement {
        let count = refinement.matches.len();
        let fact = Fact::new(
            "Matches",
            format!("{count} patches at full size"),
            "Image patches that were matched along the epipolar lines at full resolution; the result was fitted to them.",
        );
        let gauge = Gauge::judged(Scale::MATCHES, count as f64, |v| format!("{v:.0}"));
        facts.push(fact.on(Some(gauge).filter(|_| count > 0)));
    }
    // Before the end it is not known which of the hypotheses is the rival.
    let scales = (freshness == Freshness::Final)
        .then(|| HypothesisScales::new(estimate, document.parameters.validation.line_score));
    let gauge = |figure: HypothesisFigure| scales.as_ref()?.of_result(figure, figure.of(estimate));
    facts.extend(line_figures(document, estimate, &gauge));
    if let Some(support) = &estimate.assessment.support {
        let value = format!("{:.1}, over {} corners", support.score, support.matches);
        let gauge =
            scales.as_ref().and_then(|scales| scales.of_result(HypothesisFigure::Support, support.score));
        facts.push(Fact::new("Support", value, SUPPORT).on(gauge));
    }
    if let Some(trace) = estimate.trace.as_ref().filter(|trace| trace.counts.left_out > 0) {
        facts.push(Fact::new(
            "Left out",
            format!("{} corners that stay", trace.counts.left_out),
            "Corners at the very same place in both images while the rest moves, as of captions, a logo or dirt on the \
             sensor: they say nothing of the scene.",
        ));
    }
    if let Some(trace) = &estimate.trace {
        facts.push(Fact::new(
            "Time",
            format!("{:.2} s, first {:.2} s", trace.seconds, trace.first_seconds),
            "How long the computation took, and until its first result.",
        ));
    }
    facts
}

/// What the motion barcodes of corresponding lines say, where sequences were compared.
fn barcodes(estimate: &Estimate) -> Vec<Fact> {
    let Some(figures) = &estimate.assessment.barcodes else { return Vec::new() };
    let reasons = estimate.assessment.trust.iter().flat_map(|trust| &trust.reasons);
    let tone = |speaks: fn(&Reason) -> bool, bad: Tone| {
        Some(if reasons.clone().any(speaks) { bad } else { Tone::Good })
    };
    let agreement = Fact {
        tone: tone(|reason| matches!(reason, Reason::BarcodesByChance { .. }), Tone::Bad),
        ..Fact::new(
            "Agreement",
            format!("{:.2}, by chance {:.2}", figures.correlation, figures.by_chance),
            "How well the motion barcodes of corresponding lines agree over both images, 1 for equal ones; and how well \
             they do at best when one sequence is shifted in time, which is chance.",
        )
    };
    let lines = Fact {
        tone: tone(|reason| matches!(reason, Reason::FewBarcodes { .. }), Tone::Caution),
        ..Fact::new(
            "Telling lines",
            format!("{:.0}, in {} frames", figures.lines, figures.frames),
            "Epipolar lines that are crossed in ways of their own: neighbours are crossed by the same things, and seven \
             numbers are to be found from them.",
        )
    };
    let precision = figures.deviation.map(|deviation| Fact {
        tone: tone(|reason| matches!(reason, Reason::LooseBarcodes { .. }), Tone::Caution),
        ..Fact::new(
            "Precision",
            format!("lines ± {deviation:.1} px"),
            "Standard deviation of the epipolar lines where things move, from leaving out a part of the frames at a time.",
        )
    });
    [agreement, lines].into_iter().chain(precision).collect()
}

const SUPPORT: &str = "Corners of the reduced images that find their match along their epipolar line, weighted by how alike \
                       they are. There is no good figure by itself: compare it with those of the other hypotheses.";

/// How clearly the result is ahead, and of which hypothesis.
fn margin(estimate: &Estimate) -> Fact {
    let Some(margin) = estimate.assessment.margin else {
        return Fact {
            tone: Some(Tone::Good),
            ..Fact::new("Margin", "no clearly different geometry", MARGIN)
        };
    };
    let rival = rival(estimate).map_or(String::new(), |rival| format!(" to hypothesis {}", rival + 1));
    // What decides, when it was looked at.
    let refined = estimate.assessment.refined_margin;
    let decides = refined.unwrap_or(margin);
    let after = refined.map_or(String::new(), |refined| format!(", {:.0} % refined", refined * 100.0));
    let gauge = Gauge::judged(Scale::MARGIN, decides, |v| format!("{:.0} %", v * 100.0));
    Fact::new("Margin", format!("{:.0} %{rival}{after}", margin * 100.0), MARGIN).on(Some(gauge))
}

const MARGIN: &str = "How much less support the best clearly different geometry has than hypothesis 1, from which the result was \
                      refined; of the published search, how much worse its line score is. A small one means that the \
                      result is a guess. Where it is not clear, the rivals are refined, too, and \
                      the margin after that decides. The tab Hypotheses marks the rival.";

/// The figures of a hypothesis that is shown in place of the result, which it was found with.
pub fn hypothesis_facts(document: &Document, hypothesis: &Estimate, of: Option<&Estimate>) -> Vec<Fact> {
    let scales = of.map(|of| HypothesisScales::new(of, document.parameters.validation.line_score));
    let mut facts = epipoles(document, hypothesis.fundamental());
    let gauge = |figure: HypothesisFigure| scales.as_ref()?.gauge(figure, figure.of(hypothesis));
    facts.extend(line_figures(document, hypothesis, &gauge));
    if let Some(support) = hypothesis.support_score() {
        let gauge = gauge(HypothesisFigure::Support);
        facts.push(Fact::new("Support", format!("{support:.1}"), SUPPORT).on(gauge));
    }
    facts
}

/// Where the epipoles of a geometry are.
pub fn epipoles(document: &Document, f: &FundamentalMatrix) -> Vec<Fact> {
    let frame = |k: usize| document.pictures.as_ref().map(|pictures| pictures[k].frame);
    vec![
        Fact::new(
            "Left epipole",
            epipole_text(&f.epipole1(), frame(0)),
            "Where the left image sees the other camera; all its epipolar lines meet there.",
        ),
        Fact::new(
            "Right epipole",
            epipole_text(&f.epipole2(), frame(1)),
            "Where the right image sees the other camera; all its epipolar lines meet there.",
        ),
    ]
}

/// What the lines say; the first result of a computation has neither figure yet.
fn line_figures(
    document: &Document,
    estimate: &Estimate,
    gauge: &dyn Fn(HypothesisFigure) -> Option<Gauge>,
) -> impl Iterator<Item = Fact> + use<> {
    let score = estimate.line_score().map(|score| match document.parameters.validation.line_score {
        LineScore::AgainstMismatched => Fact::new(
            "Line score",
            format!("{} of mismatched", line_score_text(LineScore::AgainstMismatched, score)),
            "What corresponding lines cost to match, beside deliberately mismatched lines; lower is better, and 100 % \
             are no better than mismatched.",
        ),
        LineScore::Cost => Fact::new(
            "Line score",
            format!("{} grey² a sample", line_score_text(LineScore::Cost, score)),
            "What corresponding lines cost to match, as published; lower is better. It depends on the contrast of the \
             images: compare it with those of the other hypotheses.",
        ),
    });
    let score = score.map(|fact| fact.on(gauge(HypothesisFigure::LineScore)));
    let area = estimate.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area);
    let round_trip = area.map(|area| {
        Fact::new(
            "Round trip",
            format!("{area:.2} px"),
            "How far a line ends from where it began when the lines matched through the clicks carry it to the other \
             image and back: a figure of the published search, to compare its hypotheses by. The verdict rests on \
             the matches, and a good result may have a large one.",
        )
        .on(gauge(HypothesisFigure::RoundTrip))
    });
    score.into_iter().chain(round_trip)
}

/// Where an epipole is, in words and figures.
pub fn epipole_text(epipole: &HomogeneousPoint, frame: Option<Frame>) -> String {
    // Farther away than this, the lines of an image are parallel to the eye.
    const FAR: f64 = 1e6;
    let Some(p) = finite_point(epipole).filter(|p| p.coords.amax() < FAR) else {
        let degrees = epipole.y.atan2(epipole.x).rem_euclid(PI).to_degrees();
        return format!("at infinity, {degrees:.1}°");
    };
    // Far away, fractions of a pixel mean nothing.
    let decimals = usize::from(p.coords.amax() < 1000.0);
    let inside = if frame.is_some_and(|frame| frame.contains(p)) { " in the image" } else { "" };
    format!("({:.decimals$}, {:.decimals$}){inside}", p.x, p.y)
}
