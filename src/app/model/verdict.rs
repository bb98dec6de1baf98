//! The result in words: a headline, the figures behind it, and what to know about it.

use std::f64::consts::PI;

use super::computation::{Computation, EstimateFailure, Freshness};
use super::document::{Document, Imported, Role, pair_name};
use crate::estimate::{
    self, CLEAR_MARGIN, CLICK_DEVIATIONS, ENOUGH_MATCHES, Estimate, FAR_TOO_FEW, LineScore, Reason,
};
use crate::geometry::{
    Frame, FundamentalMatrix, HomogeneousPoint, finite_point, sampson_distance, symmetric_epipolar_distance,
};

/// How the news is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// There is nothing yet.
    Idle,
    /// Work is under way.
    Busy,
    /// A result to rely on.
    Good,
    /// A result with something to know about it.
    Caution,
    /// No result.
    Bad,
}

/// A figure with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// What it is.
    pub name: &'static str,
    /// The figure with its unit.
    pub value: String,
    /// What it means, and what is good and bad.
    pub tooltip: &'static str,
    /// Whether it speaks for the result, where there is a measure for that.
    pub tone: Option<Tone>,
}

impl Fact {
    /// A figure without a measure of good and bad.
    pub fn new(name: &'static str, value: impl Into<String>, tooltip: &'static str) -> Self {
        Self { name, value: value.into(), tooltip, tone: None }
    }
}

/// Below this margin a result is a guess.
const GUESS: f64 = 0.05;

/// What to say about the state of the estimate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerdictInWords {
    /// How the news is.
    pub tone: Tone,
    /// One sentence.
    pub headline: String,
    /// The figures behind it.
    pub facts: Vec<Fact>,
    /// What to know about it, a sentence each.
    pub warnings: Vec<String>,
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

/// What to beware of with a geometry from a file.
pub fn import_warning(imported: &Imported) -> Option<&'static str> {
    match &imported.check {
        None => Some(
            "Unchecked: nobody knows whether it is meant as its file says. Import it again when there are 8 matches.",
        ),
        Some(check) if !check.fits => {
            Some("It does not fit the matches it was checked with: it may belong to other images.")
        }
        Some(_) => None,
    }
}

/// Puts the state into words.
pub fn verdict(document: &Document, computation: &Computation) -> VerdictInWords {
    let bare =
        |tone, headline: String| VerdictInWords { tone, headline, facts: Vec::new(), warnings: Vec::new() };
    let Some((estimate, freshness)) = computation.result() else {
        if computation.is_running() {
            let stage = computation.stage().map_or(String::new(), |stage| format!(": {}", stage.label()));
            return bare(Tone::Busy, format!("Estimating{stage}"));
        }
        return match computation.failure() {
            Some(EstimateFailure::Estimate(error)) => {
                bare(Tone::Bad, format!("No result: {}.", in_names(&error.to_string(), document)))
            }
            Some(EstimateFailure::Panic(text)) => bare(
                Tone::Bad,
                format!(
                    "The computation stopped unexpectedly ({text}). This is a fault of the program; \
                     the points are kept. Move a point or press F5 to try again."
                ),
            ),
            None if computation.was_stopped() => bare(Tone::Idle, "Stopped. F5 computes again.".into()),
            None => bare(Tone::Idle, waiting(document)),
        };
    };
    let assessment = &estimate.assessment;
    let reasons = assessment.trust.iter().flat_map(|trust| &trust.reasons);
    let reasons = reasons.map(|reason| in_units(reason, document, estimate.fundamental()));
    // A geometry that is not final may still come nearer to them, and a stale one is not that of these points.
    let is_final = freshness == Freshness::Final;
    let checked = is_final.then(|| contradicting_check(document, estimate.fundamental())).flatten();
    let warnings: Vec<_> = reasons
        .chain(assessment.warnings.iter().map(ToString::to_string))
        .map(|sentence| format!("{}.", capitalised(&in_names(&sentence, document))))
        .chain(checked)
        .collect();
    let unreliable =
        assessment.trust.as_ref().is_some_and(|trust| trust.verdict == estimate::Verdict::Unreliable);
    let (tone, headline) = match freshness {
        Freshness::Stale => (Tone::Busy, "Updating; the lines still belong to the points before.".to_owned()),
        Freshness::Followed => (
            Tone::Busy,
            "The latest geometry, adjusted to the points; the search for the best one goes on.".into(),
        ),
        Freshness::Preliminary => (
            Tone::Busy,
            format!(
                "First result, being refined{}",
                computation.stage().map_or(String::new(), |stage| format!(": {}", stage.label()))
            ),
        ),
        Freshness::Stopped => (Tone::Caution, "First result; stopped before it was refined.".into()),
        Freshness::Final if unreliable => {
            (Tone::Bad, format!("The geometry from {} is unreliable:", used(document)))
        }
        Freshness::Final if warnings.is_empty() => {
            let checked = if assessment.trust.is_some() { "; nothing speaks against it" } else { "" };
            (Tone::Good, format!("Epipolar geometry found from {}{checked}.", used(document)))
        }
        Freshness::Final => {
            (Tone::Caution, format!("Epipolar geometry found from {}, with doubts:", used(document)))
        }
    };
    VerdictInWords { tone, headline, facts: facts(document, estimate, freshness), warnings }
}

fn waiting(document: &Document) -> String {
    let needed = document.pairs_needed();
    if document.pictures.is_none() {
        return "Nothing to estimate from yet.".into();
    }
    let more = needed.saturating_sub(document.used().count());
    let pairs = if more == 1 { "One more point pair gives" } else { "Two point pairs give" };
    let pairs = if more == 3 { "Three point pairs give" } else { pairs };
    format!("{pairs} the epipolar lines, the epipoles and how far to trust them.")
}

/// More names than this are only counted.
const MOST_NAMES: usize = 4;

/// `pairs p and q`, or `12 pairs`.
fn used(document: &Document) -> String {
    let names: Vec<_> = document.used().map(pair_name).collect();
    match names.split_last() {
        _ if names.len() > MOST_NAMES => format!("{} pairs", names.len()),
        Some((last, rest)) if !rest.is_empty() => format!("pairs {} and {last}", rest.join(", ")),
        _ => "the pairs".into(),
    }
}

fn facts(document: &Document, estimate: &Estimate, freshness: Freshness) -> Vec<Fact> {
    let mut facts = epipoles(document, estimate.fundamental());
    if matches!(freshness, Freshness::Followed | Freshness::Stale) {
        // The other figures belong to earlier points.
        return facts;
    }
    // Before the end, near-copies of the result are not told from other geometries.
    facts.extend((freshness == Freshness::Final).then(|| margin(estimate)));
    if let Some(refinement) = &estimate.assessment.refinement {
        let count = refinement.matches.len();
        let tone = grade(count >= ENOUGH_MATCHES, count >= FAR_TOO_FEW);
        facts.push(Fact {
            tone: Some(tone).filter(|_| count > 0),
            ..Fact::new(
                "Matches",
                format!("{count} patches at full size"),
                "Image patches that were matched along the epipolar lines at full resolution; the result was fitted to \
                 them. 60 or more are enough, fewer than 25 far too few.",
            )
        });
    }
    facts.extend(line_figures(document, estimate));
    if let Some(support) = &estimate.assessment.support {
        facts.push(Fact::new(
            "Support",
            format!("{:.1}, over {} corners", support.score, support.matches),
            SUPPORT,
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

const SUPPORT: &str = "Corners of the reduced images that find their match along their epipolar line, weighted by how alike \
                       they are. There is no good figure by itself: compare it with those of the other hypotheses.";

/// How clearly the result is ahead, and of which hypothesis.
fn margin(estimate: &Estimate) -> Fact {
    let Some(margin) = estimate.assessment.margin else {
        return Fact { tone: Some(Tone::Good), ..Fact::new("Margin", "no other geometry came near", MARGIN) };
    };
    let rival = rival(estimate).map_or(String::new(), |rival| format!(" to hypothesis {}", rival + 1));
    // What decides, when it was looked at.
    let refined = estimate.assessment.refined_margin;
    let decides = refined.unwrap_or(margin);
    let after = refined.map_or(String::new(), |refined| format!(", {:.0} % refined", refined * 100.0));
    Fact {
        tone: Some(grade(decides >= CLEAR_MARGIN, decides >= GUESS)),
        ..Fact::new("Margin", format!("{:.0} %{rival}{after}", margin * 100.0), MARGIN)
    }
}

const MARGIN: &str = "How much less support the best clearly different geometry has than hypothesis 1, from which the result was \
                      refined; of the published search, how much worse its line score is. 20 % or more is clear, a few \
                      percent mean that the result is a guess. Where it is not clear, the rivals are refined, too, and \
                      the margin after that decides. The tab Hypotheses marks the rival.";

/// The hypothesis whose figure beside that of the first one makes the margin, by its place in the list.
pub fn rival(estimate: &Estimate) -> Option<usize> {
    let margin = estimate.assessment.margin?;
    let (best, others) = estimate.hypotheses().split_first()?;
    let is_it = |other: &Estimate| {
        let by_support = best.support_score().zip(other.support_score());
        let by_support = by_support.map(|(best, other)| (best - other) / best.max(1e-9));
        let by_lines = best.line_score().zip(other.line_score());
        let by_lines = by_lines.map(|(best, other)| (other - best) / other.max(1e-9));
        by_support.or(by_lines).is_some_and(|own| (own - margin).abs() < 1e-9)
    };
    others.iter().position(is_it).map(|place| place + 1)
}

fn grade(is_good: bool, is_fair: bool) -> Tone {
    match (is_good, is_fair) {
        (true, _) => Tone::Good,
        (false, true) => Tone::Caution,
        (false, false) => Tone::Bad,
    }
}

/// What the pairs that are only checked have against a geometry, if a person would see it.
fn contradicting_check(document: &Document, f: &FundamentalMatrix) -> Option<String> {
    let off = document.parameters.click_sigma * CLICK_DEVIATIONS;
    let checks = (0..document.pairs.len()).filter(|pair| document.role(*pair) == Role::Check);
    let contradicting: Vec<(usize, f64)> = checks
        .filter(|pair| sampson_distance(f, &document.pairs[*pair]) > off)
        .map(|pair| (pair, symmetric_epipolar_distance(f, &document.pairs[pair])))
        .collect();
    let (pair, distance) = contradicting.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = match contradicting.len() - 1 {
        0 => String::new(),
        1 => ", and one more is off, too".to_owned(),
        more => format!(", and {more} more are off, too"),
    };
    Some(format!(
        "Pair {}, which is only checked, is {distance:.1} px (symmetric distance) off its epipolar line{others}: use it, or \
         check that it shows the same scene point.",
        pair_name(pair)
    ))
}

/// A reason with its figures as the rest of the window has them: the symmetric distance for how far a pair is off, the
/// margin in percent.
fn in_units(reason: &Reason, document: &Document, f: &FundamentalMatrix) -> String {
    let sentence = reason.to_string();
    match reason {
        Reason::ClickOff { pair, distance, .. } => {
            let clicked = pair.checked_sub(1).and_then(|pair| document.used().nth(pair));
            let clicked = clicked.and_then(|pair| document.pairs.get(pair));
            let Some(clicked) = clicked else { return sentence };
            let symmetric = symmetric_epipolar_distance(f, clicked);
            sentence.replacen(
                &format!("{distance:.1} px"),
                &format!("{symmetric:.1} px (symmetric distance)"),
                1,
            )
        }
        Reason::Ambiguous { margin } => {
            sentence.replacen(&format!("margin {margin:.2}"), &format!("margin {:.0} %", margin * 100.0), 1)
        }
        _ => sentence,
    }
}

/// The figures of a hypothesis that is shown in place of the result.
pub fn hypothesis_facts(document: &Document, hypothesis: &Estimate) -> Vec<Fact> {
    let mut facts = epipoles(document, hypothesis.fundamental());
    facts.extend(line_figures(document, hypothesis));
    if let Some(support) = hypothesis.support_score() {
        facts.push(Fact::new("Support", format!("{support:.1}"), SUPPORT));
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
fn line_figures(document: &Document, estimate: &Estimate) -> impl Iterator<Item = Fact> {
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
    let area = estimate.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area);
    let round_trip = area.map(|area| {
        Fact::new(
            "Round trip",
            format!("{area:.2} px"),
            "How far a line ends from where it began when the lines matched through the clicks carry it to the other \
             image and back: a figure of the published search, to compare its hypotheses by. The verdict rests on \
             the matches, and a good result may have a large one.",
        )
    });
    score.into_iter().chain(round_trip)
}

/// A line score in its unit, which depends on what is measured.
pub fn line_score_text(kind: LineScore, score: f64) -> String {
    match kind {
        LineScore::AgainstMismatched => format!("{:.1} %", score * 100.0),
        LineScore::Cost => format!("{score:.1}"),
    }
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

/// A sentence of the estimator, which counts the pairs it was given, with the names they have in the window.
fn in_names(sentence: &str, document: &Document) -> String {
    let used: Vec<usize> = document.used().collect();
    let (mut expected, mut after) = (false, false);
    let words = sentence.split(' ').map(|word| {
        let is_number = expected;
        // `pair 3`, `pairs 1 and 2`.
        expected = matches!(word, "pair" | "pairs") || after && word == "and";
        after = is_number;
        let digits = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
        let number = word[..digits].parse::<usize>().ok().filter(|_| is_number);
        let name = number.and_then(|number| Some(pair_name(*used.get(number.checked_sub(1)?)?)));
        name.map_or_else(|| word.to_owned(), |name| name + &word[digits..])
    });
    words.collect::<Vec<_>>().join(" ")
}

/// The text with a capital first letter.
pub fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use crate::app::model::computation::EstimateNews;
    use crate::estimate::{Suspect, Trust, Warning};
    use crate::geometry::PointPair;

    fn computed(change: impl Fn(&mut Estimate)) -> (Document, Computation) {
        let request = fake::request(1.0);
        let mut estimate = fake::result(&request.pairs, &request.parameters).unwrap();
        change(&mut estimate);
        ended(Ok(Box::new(estimate)))
    }

    fn ended(result: Result<Box<Estimate>, EstimateFailure>) -> (Document, Computation) {
        let mut computation = Computation::default();
        let request = fake::request(1.0);
        computation.adopt(Some(&request));
        computation.begin(1, false);
        computation.take(1, EstimateNews::Finished(result));
        (Document { pairs: request.pairs, ..Document::default() }, computation)
    }

    #[test]
    fn a_clean_result_is_good_and_one_with_warnings_is_not() {
        let (document, computation) = computed(|_| ());
        let good = verdict(&document, &computation);
        assert_eq!(good.tone, Tone::Good);
        assert_eq!(good.headline, "Epipolar geometry found from pairs p and q.");
        assert!(good.facts.iter().any(|fact| fact.name == "Margin" && fact.value == "40 %"));
        let (document, computation) =
            computed(|e| e.assessment.warnings.push(Warning::CloseClicks { distance: 9.0 }));
        let doubtful = verdict(&document, &computation);
        assert_eq!(doubtful.tone, Tone::Caution);
        assert!(doubtful.warnings[0].starts_with("The two clicks are only 9 px apart"));
    }

    #[test]
    fn a_result_called_wrong_is_bad_news_with_its_reasons() {
        let (document, computation) = computed(|e| {
            let reasons = vec![Reason::ClickOff { pair: 2, distance: 40.0, suspect: Suspect::Click }];
            e.assessment.trust = Some(Trust { verdict: estimate::Verdict::Unreliable, reasons });
        });
        let bad = verdict(&document, &computation);
        assert_eq!(bad.tone, Tone::Bad);
        assert!(bad.headline.ends_with("is unreliable:"));
        let (estimate, _) = computation.result().unwrap();
        let own = symmetric_epipolar_distance(estimate.fundamental(), &document.pairs[1]);
        let told = format!("Point pair q is {own:.1} px (symmetric distance) off");
        assert!(bad.warnings[0].starts_with(&told), "{}", bad.warnings[0]);
    }

    #[test]
    fn a_margin_is_in_percent_wherever_it_is_told() {
        let (document, computation) = computed(|e| {
            e.assessment.margin = Some(0.054);
            let reasons = vec![Reason::Ambiguous { margin: 0.054 }];
            e.assessment.trust = Some(Trust { verdict: estimate::Verdict::Doubtful, reasons });
        });
        let doubtful = verdict(&document, &computation);
        assert!(doubtful.warnings[0].contains("(margin 5 %)"), "{}", doubtful.warnings[0]);
        let margin = doubtful.facts.iter().find(|fact| fact.name == "Margin").unwrap();
        assert_eq!((margin.value.as_str(), margin.tone), ("5 %", Some(Tone::Caution)));
    }

    #[test]
    fn the_margin_after_refinement_decides() {
        let (document, computation) = computed(|e| {
            e.assessment.margin = Some(0.054);
            e.assessment.refined_margin = Some(0.62);
        });
        let good = verdict(&document, &computation);
        let margin = good.facts.iter().find(|fact| fact.name == "Margin").unwrap();
        assert_eq!((margin.value.as_str(), margin.tone), ("5 %, 62 % refined", Some(Tone::Good)));
    }

    #[test]
    fn a_checked_pair_far_off_speaks_against_the_result() {
        let (mut document, mut computation) = computed(|_| ());
        let f = *computation.result().unwrap().0.fundamental();
        let point1 = crate::geometry::Point::new(40.0, 40.0);
        let line = f.line2_from_point1(point1).unwrap();
        let [a, b, c] = [0, 1, 2].map(|k| line.coefficients()[k]);
        let at = |off: f64| crate::geometry::Point::new(a * (off - c), b * (off - c));
        for (off, tone) in [(0.0, Tone::Good), (90.0, Tone::Caution)] {
            document.pairs.truncate(2);
            document.pairs.push(PointPair { point1, point2: at(off) });
            document.check_only(2, true);
            let told = verdict(&document, &computation);
            assert_eq!(told.tone, tone, "{off} px: {:?}", told.warnings);
            let named = told.warnings.iter().any(|w| w.starts_with("Pair r, which is only checked, is "));
            assert_eq!(named, off > 0.0);
        }
        // What is computed for other points says nothing of these.
        computation.begin(2, false);
        assert!(verdict(&document, &computation).warnings.iter().all(|w| !w.contains("only checked")));
    }

    #[test]
    fn sentences_name_pairs_as_the_window_does() {
        let pairs = vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 14];
        let mut document = Document { pairs, ..Document::default() };
        document.check_only(1, true);
        let named = |sentence: &str| in_names(sentence, &document);
        assert_eq!(named("point pair 1 is 3 px off"), "point pair p is 3 px off");
        assert_eq!(named("through point pair 12: choose"), "through point pair 13: choose");
        assert_eq!(named("point pairs 2 and 10 are only 2 px"), "point pairs r and 11 are only 2 px");
        assert_eq!(named("3 point pairs are needed, 2 given"), "3 point pairs are needed, 2 given");
        assert_eq!(used(&document), "13 pairs");
    }

    #[test]
    fn a_panic_is_told_without_losing_the_points() {
        let (document, computation) = ended(Err(EstimateFailure::Panic("boom".into())));
        let bad = verdict(&document, &computation);
        assert_eq!(bad.tone, Tone::Bad);
        assert!(bad.headline.contains("boom") && bad.headline.contains("points are kept"));
    }

    #[test]
    fn epipoles_are_told_near_far_and_at_infinity() {
        let frame = Some(Frame::new(100, 100));
        let text = |x, y, z| epipole_text(&HomogeneousPoint::new(x, y, z), frame);
        assert_eq!(text(50.0, 20.0, 1.0), "(50.0, 20.0) in the image");
        assert_eq!(text(-50.0, 20.0, 0.5), "(-100.0, 40.0)");
        assert_eq!(text(-1.0, -1.0, 0.0), "at infinity, 45.0°");
        assert_eq!(text(1.0, 0.0, 1e-8), "at infinity, 0.0°");
    }
}
