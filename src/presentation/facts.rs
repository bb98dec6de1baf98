//! Figures of a result, with the ranges of good and bad values.

use std::f64::consts::PI;

use super::figures::line_score_text;
use super::origin::origin_in_words;
use super::tone::Tone;
use crate::camera::{PoseFit, PoseUncertainty};
use crate::comparison::median;
use crate::estimate::{DivisionFit, Estimate, LineBands, LineScore, Reason, RefinedMatch};
use crate::geometry::{Frame, HomogeneousPoint, Point, finite_point, symmetric_epipolar_distance};
use crate::judge::LIMIT;

/// A figure with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    pub name: &'static str,
    pub value: String,
    pub tooltip: &'static str,
    /// Quality of the value, if there is a rule for it.
    pub tone: Option<Tone>,
}

impl Fact {
    /// Creates a figure without a rule for good and bad.
    pub fn new(name: &'static str, value: impl Into<String>, tooltip: &'static str) -> Self {
        Self { name, value: value.into(), tooltip, tone: None }
    }
}

fn uncertainty(bands: LineBands) -> Fact {
    Fact::new(
        "Uncertainty",
        format!("± {:.2} px, worst ± {:.1} px", bands.typical, bands.worst),
        "How far a line may be off, with 95 % probability: half of the lines all over both pictures, and nineteen in \
         twenty of them, are not worse. Far from all matches lines are less precise.",
    )
}

/// Returns how many given matches fit a result, of all of them.
fn given_fact([fit, all]: [usize; 2]) -> Fact {
    Fact::new(
        "Given matches",
        format!("{fit} of {all} fit to {LIMIT} px"),
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

/// Returns the distortion that is corrected before the search.
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

/// Circumstances of a result.
#[derive(Debug, Clone, Copy)]
pub struct ResultContext {
    /// Sizes of the images, if they are known.
    pub frames: Option<[Frame; 2]>,
    /// Kind of the line scores.
    pub score: LineScore,
    /// Number of given matches that fit the result, and of all given matches.
    pub given: Option<[usize; 2]>,
    /// Whether the search has ended. Near-copies of the result are told from other geometries only then.
    pub is_final: bool,
}

/// Returns the figures of a result.
pub fn facts(estimate: &Estimate, context: &ResultContext) -> Vec<Fact> {
    let mut facts = Vec::new();
    facts.extend(context.frames.and_then(|frames| estimate.line_bands(frames)).map(uncertainty));
    facts.extend(origin_fact(estimate));
    facts.extend(context.is_final.then(|| margin(estimate)));
    facts.extend(barcodes(estimate));
    if let Some(refinement) = &estimate.assessment.refinement {
        let count = refinement.matches.len();
        facts.push(Fact::new(
            "Matches",
            match median_distance(estimate) {
                Some(median) => format!("{count}, residual {median:.2} px"),
                None => count.to_string(),
            },
            "Image patches matched along the epipolar lines at full resolution, and their median residual: the \
             symmetric distance from the lines. The result is fitted to them. A clear result ends the search \
             early, so a better one may have fewer. The reasons of the verdict count only distinctive matches: \
             image features that were paired before any lines were known.",
        ));
    }
    facts.extend(context.given.map(given_fact));
    // The figures of a search do not judge a result that is fitted to matches. The steps of the method show
    // them.
    let is_fitted = estimate.is_refined();
    if !is_fitted {
        facts.extend(line_figures(estimate, context.score));
    }
    if let Some(support) = estimate.assessment.support.as_ref().filter(|_| !is_fitted) {
        let value = format!("{:.1}, over {} corners", support.score, support.matches);
        facts.push(Fact::new("Support", value, SUPPORT));
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
pub(super) fn median_distance(estimate: &Estimate) -> Option<f64> {
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
        return Fact::new(MARGIN, "no rival", MARGIN_TOOLTIP);
    };
    // The margin after refinement counts, if it was measured.
    let margin = estimate.assessment.refined_margin.unwrap_or(margin);
    Fact::new(MARGIN, format!("{:.0} %", margin * 100.0), MARGIN_TOOLTIP)
}

const MARGIN: &str = "Lead over rival";
const MARGIN_TOOLTIP: &str = "How far the support of the result is ahead of that of the rival, the best clearly \
                              different geometry.";

/// Returns the figures of a hypothesis.
pub fn hypothesis_facts(hypothesis: &Estimate, score: LineScore) -> Vec<Fact> {
    let support = hypothesis.support_score();
    line_figures(hypothesis, score)
        .chain(support.map(|support| Fact::new("Support", format!("{support:.1}"), SUPPORT)))
        .chain(origin_fact(hypothesis))
        .collect()
}

/// Returns from what a geometry was proposed.
fn origin_fact(estimate: &Estimate) -> Option<Fact> {
    let origin = estimate.origin.as_ref()?;
    Some(Fact::new(
        "Proposed by",
        origin_in_words(origin),
        "Data from which the geometry was proposed. Fits to more matches followed. Of two candidates, the first is one \
         of the lines through p, the second of those through q, numbered as in the step Candidates.",
    ))
}

/// Returns the figures of a relative pose.
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

/// Returns line cost and round trip. The first result of a computation has neither yet.
fn line_figures(estimate: &Estimate, kind: LineScore) -> impl Iterator<Item = Fact> + use<> {
    let score = estimate.line_score().map(|score| match kind {
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
    let area = estimate.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area);
    let round_trip = area.map(|area| {
        Fact::new(
            "Round trip",
            format!("{area:.2} px"),
            "Distance between a line and itself after mapping it to the other image and back. A good result \
             may have a large value: the verdict rests on the matches.",
        )
    });
    score.into_iter().chain(round_trip)
}

/// Distance of an epipole that counts as infinite, px. The lines in an image of 1,000 px turn by less than 0.6°.
pub(super) const FAR: f64 = 1e5;

/// Describes the position of an epipole.
pub fn epipole_text(epipole: &HomogeneousPoint) -> String {
    let Some(p) = finite_point(epipole).filter(|p| p.coords.amax() < FAR) else {
        return format!("at infinity, {:.1}°", far_direction(epipole));
    };
    // Far away, fractions of a pixel mean nothing.
    in_parentheses(p, usize::from(p.coords.amax() < 1000.0))
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
pub(super) fn far_direction(epipole: &HomogeneousPoint) -> f64 {
    epipole.y.atan2(epipole.x).rem_euclid(PI).to_degrees()
}

/// Returns the side of an image on which a point outside lies.
pub(super) fn direction(p: Point, frame: Frame) -> &'static str {
    let away = p - frame.centre();
    let [x, y] = [away.x / frame.width as f64, away.y / frame.height as f64];
    match (x.abs() >= y.abs(), x > 0.0, y > 0.0) {
        (true, true, _) => "right",
        (true, false, _) => "left",
        (false, _, true) => "below",
        (false, _, false) => "above",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn epipoles_are_described_near_and_at_infinity() {
        let text = |x, y, z| epipole_text(&HomogeneousPoint::new(x, y, z));
        assert_eq!(text(50.0, 20.0, 1.0), "(50.0, 20.0)");
        assert_eq!(text(-5000.0, 20.0, 1.0), "(-5000, 20)");
        assert_eq!(text(-1.0, -1.0, 0.0), "at infinity, 45.0°");
        assert_eq!(text(1.0, 0.0, 1e-10), "at infinity, 0.0°");
    }
}
