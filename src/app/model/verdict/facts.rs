//! Figures of a result, with the ranges of good and bad values.

use std::f64::consts::PI;

use super::gauge::{Gauge, HypothesisFigure, HypothesisScales, line_score_text};
use super::tone::Tone;
use crate::app::model::computation::Freshness;
use crate::app::model::document::{Document, GIVEN_FIT, Given, Imported};
use crate::camera::{PoseFit, PoseUncertainty};
use crate::comparison::median;
use crate::estimate::{
    DivisionFit, EpipoleBearing, EpipoleCertainty, Estimate, LineBands, LineScore, Reason, RefinedMatch,
};
use crate::geometry::{
    Frame, FundamentalMatrix, HomogeneousPoint, Point, Vector, finite_point, symmetric_epipolar_distance,
};
use crate::presentation::{Scale, epipole_in_words, interval_in_words, origin_in_words};

/// A figure with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    pub name: &'static str,
    pub value: String,
    pub tooltip: &'static str,
    /// Quality of the value, if there is a rule for it.
    pub tone: Option<Tone>,
    /// Place of the value between bad and good.
    pub gauge: Option<Gauge>,
}

impl Fact {
    /// Creates a figure without a rule for good and bad.
    pub fn new(name: &'static str, value: impl Into<String>, tooltip: &'static str) -> Self {
        Self { name, value: value.into(), tooltip, tone: None, gauge: None }
    }

    /// Adds the place between bad and good.
    #[must_use]
    fn on(self, gauge: Option<Gauge>) -> Self {
        Self { tone: gauge.as_ref().and_then(|gauge| gauge.tone), gauge, ..self }
    }

    /// Returns the explanation with the limits of good and bad.
    pub fn explained(&self) -> String {
        self.gauge
            .as_ref()
            .map_or_else(|| self.tooltip.to_owned(), |gauge| format!("{}\n{}", self.tooltip, gauge.words))
    }
}

pub fn import_facts(imported: &Imported) -> Vec<Fact> {
    let check = imported.check.as_ref();
    let median =
        check.map_or_else(|| "unchecked".to_owned(), |check| format!("median {:.2} px", check.median));
    let of = check.map(|check| {
        let tooltip = "Point pairs that the geometry was checked with at the time of the import.";
        Fact::new("Checked on", format!("{} {}", check.matches, check.of), tooltip)
    });
    let facts = [
        Fact::new("From", imported.file.clone(), "File that the geometry was imported from."),
        Fact::new(
            "Convention",
            if imported.is_as_read() { "as in the file".to_owned() } else { imported.reading.clone() },
            "Convention in which the numbers of the file were read. As in the file: they were taken without a change.",
        ),
        Fact::new("Checked", median, "Median symmetric distance of these pairs at the time of the import."),
    ];
    facts.into_iter().chain(of).collect()
}

/// Returns the probability of the lines.
fn lines_right(estimate: &Estimate) -> Option<Fact> {
    let probability = estimate.assessment.probability_within_one_percent()?;
    let gauge = Gauge::judged(Scale::LINES, probability, |v| format!("{:.0} %", 100.0 * v));
    let fact = Fact::new(
        "Right lines",
        format!("{:.0} % likely", 100.0 * probability),
        "How likely the lines are within 1 % of the longer side near the matches. It follows from the matches that were \
         found without the lines, and from the likeliest other geometry.",
    );
    Some(fact.on(Some(gauge)))
}

fn lines_anywhere(bands: LineBands) -> Fact {
    Fact::new(
        "Lines anywhere",
        format!("± {:.2} px, worst ± {:.1} px", bands.typical, bands.worst),
        "Half width of the 95 % band of an epipolar line, for lines all over both pictures: half of them, and nineteen \
         in twenty, are not wider. Far from all matches lines are less precise.",
    )
}

/// Returns how many given matches fit a result.
fn given_fact(given: &Given, estimate: &Estimate) -> Fact {
    Fact::new(
        "Given matches",
        format!("{} of {} fit to {GIVEN_FIT} px", given.fitting(estimate.fundamental()), given.matches.len()),
        "Imported matches near their epipolar lines (Sampson distance). The robust search weighs them by their \
         own noise; the verdict rests on the images.",
    )
}

/// Returns the distortion of a lens that explains the matches better, for images of these sizes.
pub fn lens_fact(lens: &DivisionFit, frames: [Frame; 2]) -> Fact {
    let coefficient = |k: usize| format!("{:.3} ± {:.3}", lens.lambdas[k], lens.deviations[k]);
    let coefficients =
        if lens.is_same { coefficient(0) } else { format!("{} and {}", coefficient(0), coefficient(1)) };
    Fact::new(
        "Lens",
        format!("λ {coefficients}, corners move by {:.0} px", lens.corner_shift(frames)),
        "Radial distortion that explains the matches clearly better: coefficient of the division model with its \
         standard deviation, for radii in half diagonals from the middle. Negative for barrel distortion. \
         \"Correct the lens distortion\" uses it.",
    )
}

pub fn corrected_fact([left, right]: [f64; 2]) -> Fact {
    let same = (left - right).abs() < 1e-9;
    let coefficients = if same { format!("{left:.3}") } else { format!("{left:.3} and {right:.3}") };
    Fact::new(
        "Lens",
        format!("λ {coefficients}, corrected"),
        "Radial distortion of the pictures that is corrected before the search: coefficient of the division model, \
         for radii in half diagonals from the middle.",
    )
}

pub fn facts(document: &Document, estimate: &Estimate, freshness: Freshness) -> Vec<Fact> {
    if matches!(freshness, Freshness::Followed | Freshness::Stale) {
        // The other figures belong to earlier points.
        return epipoles(document, estimate.fundamental(), None);
    }
    let mut facts = epipoles(document, estimate.fundamental(), Some(estimate));
    facts.extend(lines_right(estimate));
    facts.extend(document.frames().and_then(|frames| estimate.line_bands(frames)).map(lines_anywhere));
    facts.extend(origin_fact(estimate));
    // Near-copies of the result are told from other geometries only at the end.
    facts.extend((freshness == Freshness::Final).then(|| margin(estimate)));
    facts.extend(barcodes(estimate));
    if let Some(refinement) = &estimate.assessment.refinement {
        let count = refinement.matches.len();
        let fact = Fact::new(
            "Matches",
            match median_distance(estimate) {
                Some(median) => format!("{count}, median {median:.2} px"),
                None => count.to_string(),
            },
            "Image patches matched along the epipolar lines at full resolution, and the median of their \
             symmetric distances from the lines. The result is fitted to them. A clear result ends the search \
             early, so a better one may have fewer. The reasons of the verdict count only distinctive matches: \
             image features that were paired before any lines were known.",
        );
        let gauge = Gauge::judged(Scale::MATCHES, count as f64, |v| format!("{v:.0}"));
        facts.push(fact.on(Some(gauge).filter(|_| count > 0 && !estimate.is_judged_by_lines())));
    }
    facts.extend(document.given.as_ref().map(|given| given_fact(given, estimate)));
    // The rival is known only at the end.
    let scales = (freshness == Freshness::Final)
        .then(|| HypothesisScales::new(estimate, document.parameters.validation.line_score));
    let gauge = |figure: HypothesisFigure| scales.as_ref()?.of_result(figure, figure.of(estimate));
    // The figures of a search do not judge a result that is fitted to matches. The steps of the method show
    // them.
    let is_fitted = estimate.is_refined();
    if !is_fitted {
        facts.extend(line_figures(document, estimate, &gauge));
    }
    if let Some(support) = estimate.assessment.support.as_ref().filter(|_| !is_fitted) {
        let value = format!("{:.1}, over {} corners", support.score, support.matches);
        let gauge =
            scales.as_ref().and_then(|scales| scales.of_result(HypothesisFigure::Support, support.score));
        facts.push(Fact::new("Support", value, SUPPORT).on(gauge));
    }
    if let Some(trace) = estimate.trace.as_ref().filter(|trace| trace.counts.left_out > 0) {
        facts.push(Fact::new(
            "Left out",
            format!("{} fixed corners", trace.counts.left_out),
            "Corners at the same position in both images while the rest moves: captions, a logo or \
             dirt on the sensor. They say nothing about the scene.",
        ));
    }
    facts
}

/// Returns the median symmetric distance of the matches, px.
fn median_distance(estimate: &Estimate) -> Option<f64> {
    let distance = |m: &RefinedMatch| symmetric_epipolar_distance(estimate.fundamental(), &m.pair);
    let distances: Vec<f64> = estimate.matches().iter().map(distance).filter(|d| d.is_finite()).collect();
    (!distances.is_empty()).then(|| median(&distances))
}

/// Returns the figures of motion barcodes, if sequences were compared.
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
            "Agreement of the motion barcodes of corresponding lines over both images; 1 for equal \
             barcodes. The second number is the best agreement with one sequence shifted in time, \
             which is chance.",
        )
    };
    let lines = Fact {
        tone: tone(|reason| matches!(reason, Reason::FewBarcodes { .. }), Tone::Caution),
        ..Fact::new(
            "Distinct lines",
            format!("{}, in {} frames", figures.whole_lines(), figures.frames),
            "Number of epipolar lines with a barcode of their own. Neighbouring lines are crossed \
             by the same objects and count less. The geometry has seven unknowns, so it needs more lines than that.",
        )
    };
    let precision = figures.deviation.map(|deviation| Fact {
        tone: tone(|reason| matches!(reason, Reason::LooseBarcodes { .. }), Tone::Caution),
        ..Fact::new(
            "Precision",
            format!("lines ± {deviation:.1} px"),
            "Standard deviation of the epipolar lines where things move, found by leaving out a \
             part of the frames at a time.",
        )
    });
    [agreement, lines].into_iter().chain(precision).collect()
}

const SUPPORT: &str = "Image corners that find a match along their epipolar line, weighted by similarity. \
                       Higher is better; compare hypotheses.";

/// Returns the margin of the result, and the hypothesis to which it is measured.
fn margin(estimate: &Estimate) -> Fact {
    let Some(margin) = estimate.assessment.margin else {
        return Fact { tone: Some(Tone::Good), ..Fact::new(MARGIN, "no rival", MARGIN_TOOLTIP) };
    };
    // The margin after refinement decides, if it was measured.
    let decides = estimate.assessment.refined_margin.unwrap_or(margin);
    let gauge = Gauge::judged(Scale::MARGIN, decides, |v| format!("{:.0} %", v * 100.0));
    // Where the images show the lines, their probability decides.
    let gauge = Some(gauge).filter(|_| !estimate.is_judged_by_lines());
    Fact::new(MARGIN, format!("{:.0} %", decides * 100.0), MARGIN_TOOLTIP).on(gauge)
}

const MARGIN: &str = "Lead over rival";
const MARGIN_TOOLTIP: &str = "How far the support of the result is ahead of that of the rival, the best clearly \
                              different geometry.";

/// Returns the figures of a hypothesis shown in place of its result `of`.
pub fn hypothesis_facts(document: &Document, hypothesis: &Estimate, of: Option<&Estimate>) -> Vec<Fact> {
    let scales = of.map(|of| HypothesisScales::new(of, document.parameters.validation.line_score));
    let mut facts = epipoles(document, hypothesis.fundamental(), None);
    let gauge = |figure: HypothesisFigure| scales.as_ref()?.gauge(figure, figure.of(hypothesis));
    facts.extend(line_figures(document, hypothesis, &gauge));
    if let Some(support) = hypothesis.support_score() {
        let gauge = gauge(HypothesisFigure::Support);
        facts.push(Fact::new("Support", format!("{support:.1}"), SUPPORT).on(gauge));
    }
    facts.extend(origin_fact(hypothesis));
    facts
}

/// Returns from what a geometry was proposed.
fn origin_fact(estimate: &Estimate) -> Option<Fact> {
    let origin = estimate.origin.as_ref()?;
    Some(Fact::new(
        "Proposed by",
        origin_in_words(origin),
        "Data from which the geometry was proposed. Fits to more matches followed. Line pairs are numbered as in the \
         step Candidates, the best first.",
    ))
}

/// Returns the positions of the epipoles of a geometry, and their 95 % intervals if it is that of
/// `estimate`.
pub fn epipoles(document: &Document, f: &FundamentalMatrix, estimate: Option<&Estimate>) -> Vec<Fact> {
    let frames = document.frames();
    let bearings = estimate.zip(frames).and_then(|(estimate, frames)| estimate.epipole_bearings(frames));
    let determined = estimate.zip(frames).and_then(|(estimate, frames)| estimate.determined(frames));
    let value = |k: usize, epipole: &HomogeneousPoint| match (frames, bearings) {
        (Some(frames), Some(bearings)) => bearing_text(epipole, frames[k], &bearings[k]),
        _ => epipole_in_words(None, determined)
            .unwrap_or_else(|| epipole_text(epipole, frames.map(|frames| frames[k]))),
    };
    vec![
        Fact::new("Left epipole", value(0, &f.epipole1()), EPIPOLE),
        Fact::new("Right epipole", value(1, &f.epipole2()), EPIPOLE),
    ]
}

const EPIPOLE: &str = "Image of the other camera, where all epipolar lines of this image meet. Outside the image: its \
                       side, and its distance from the middle of the image. The 95 % interval, if there is one, follows \
                       from the matches.";

pub fn pose_facts(fit: &PoseFit) -> Vec<Fact> {
    let deviation = |of: fn(&PoseUncertainty) -> f64| {
        fit.uncertainty.as_ref().map_or_else(String::new, |u| format!(" ± {:.2}°", of(u).to_degrees()))
    };
    let place = fit.pose.position2();
    let turn = fit.pose.angle().to_degrees();
    vec![
        Fact::new(
            "Rotation",
            format!("{turn:.2}°{}", deviation(|u| u.rotation)),
            "Angle by which the right camera is turned against the left one, with its standard deviation.",
        ),
        Fact::new(
            "Baseline",
            format!("({:.2}, {:.2}, {:.2}){}", place.x, place.y, place.z, deviation(|u| u.translation)),
            "Direction from the left to the right camera, with its standard deviation: x right, y down, z \
             forwards. The distance is unknown.",
        ),
        Fact::new(
            "Parallax",
            format!("{:.2}°", fit.parallax.to_degrees()),
            "Median angle between the rays of a match. With a small angle, depths are uncertain.",
        ),
    ]
}

/// Describes an epipole outside the image by its side and its interval, and one inside by its place.
pub(super) fn bearing_text(epipole: &HomogeneousPoint, frame: Frame, bearing: &EpipoleBearing) -> String {
    if finite_point(epipole).is_some_and(|p| frame.contains(p)) {
        return epipole_text(epipole, Some(frame));
    }
    let (sin, cos) = bearing.direction.sin_cos();
    let side = direction(frame.centre() + Vector::new(cos, sin) * (2.0 * frame.longer_side()), frame);
    let interval = interval_in_words(bearing);
    // The tooltip says from where.
    let interval = interval.strip_suffix(" away").unwrap_or(&interval);
    if bearing.certainty() == EpipoleCertainty::Open {
        interval.to_owned()
    } else {
        format!("{side}, {interval}")
    }
}

/// Returns line cost and round trip. The first result of a computation has neither yet.
fn line_figures(
    document: &Document,
    estimate: &Estimate,
    gauge: &dyn Fn(HypothesisFigure) -> Option<Gauge>,
) -> impl Iterator<Item = Fact> + use<> {
    let score = estimate.line_score().map(|score| match document.parameters.validation.line_score {
        LineScore::AgainstMismatched => Fact::new(
            "Line cost",
            format!("{} of mismatched", line_score_text(LineScore::AgainstMismatched, score)),
            "How unlike corresponding lines are, relative to deliberately mismatched lines. Lower is better.",
        ),
        LineScore::Cost => Fact::new(
            "Line cost",
            format!("{} grey² per sample", line_score_text(LineScore::Cost, score)),
            "How unlike corresponding lines are, as published. Lower is better; compare hypotheses.",
        ),
    });
    let score = score.map(|fact| fact.on(gauge(HypothesisFigure::LineScore)));
    let area = estimate.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area);
    let round_trip = area.map(|area| {
        Fact::new(
            "Round trip",
            format!("{area:.2} px"),
            "Distance between a line and itself after mapping it to the other image and back. A good result \
             may have a large value: the verdict rests on the matches.",
        )
        .on(gauge(HypothesisFigure::RoundTrip))
    });
    score.into_iter().chain(round_trip)
}

/// Returns the figures of the card: at most four, the most telling ones first.
pub fn card_facts(facts: &[Fact]) -> impl Iterator<Item = &Fact> {
    const ORDER: [&str; 8] = [
        "True error",
        "Agreement",
        "Distinct lines",
        "Matches",
        MARGIN,
        "Left epipole",
        "Right epipole",
        "Checked",
    ];
    let named = |name: &&str| facts.iter().find(|fact| fact.name == *name);
    let all: Vec<&Fact> = ORDER.iter().filter_map(named).collect();
    // The epipoles are always among them.
    let most = 4 - all.iter().filter(|fact| fact.name.ends_with("epipole")).count();
    let (epipoles, others): (Vec<&Fact>, Vec<&Fact>) =
        all.into_iter().partition(|fact| fact.name.ends_with("epipole"));
    others.into_iter().take(most).chain(epipoles)
}

/// Distance of an epipole that counts as infinite, px. The lines in an image of 1,000 px turn by less than 0.6°.
const FAR: f64 = 1e5;

/// Describes the position of an epipole.
pub fn epipole_text(epipole: &HomogeneousPoint, frame: Option<Frame>) -> String {
    let near = finite_point(epipole).filter(|p| p.coords.amax() < FAR || frame.is_some());
    let Some(p) = near else {
        return format!("at infinity, {:.1}°", far_direction(epipole));
    };
    // Far away, fractions of a pixel mean nothing.
    let decimals = usize::from(p.coords.amax() < 1000.0);
    let place = in_parentheses(p, decimals);
    match frame {
        Some(frame) if frame.contains(p) => format!("{place} inside the image"),
        Some(frame) if p.coords.amax() < FAR => {
            format!("{}, {:.0} px away", direction(p, frame), (p - frame.centre()).norm())
        }
        Some(frame) => format!("{}, far away", direction(p, frame)),
        None => place,
    }
}

/// Writes a position; −0 is written as 0.
fn in_parentheses(p: Point, decimals: usize) -> String {
    let [x, y] = [p.x, p.y].map(|v| format!("{v:.decimals$}"));
    let [x, y] =
        [&x, &y].map(|text| if text.trim_start_matches(['-', '0', '.']).is_empty() { "0" } else { text });
    format!("({x}, {y})")
}

/// Describes the position of an epipole in few letters.
pub fn short_epipole_text(epipole: &HomogeneousPoint) -> String {
    match finite_point(epipole).filter(|p| p.coords.amax() < FAR) {
        Some(p) => in_parentheses(p, 0),
        None => format!("far, {:.0}°", far_direction(epipole)),
    }
}

/// Returns the direction of a far epipole, degrees in `[0, 180)`.
fn far_direction(epipole: &HomogeneousPoint) -> f64 {
    epipole.y.atan2(epipole.x).rem_euclid(PI).to_degrees()
}

/// Returns the side of an image on which a point outside lies.
fn direction(p: Point, frame: Frame) -> &'static str {
    let away = p - frame.centre();
    let [x, y] = [away.x / frame.width as f64, away.y / frame.height as f64];
    match (x.abs() >= y.abs(), x > 0.0, y > 0.0) {
        (true, true, _) => "right",
        (true, false, _) => "left",
        (false, _, true) => "below",
        (false, _, false) => "above",
    }
}
