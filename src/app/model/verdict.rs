//! The result in words: a headline, the figures behind it, and what to know about it.

use std::f64::consts::PI;

use super::computation::{Computation, EstimateFailure, Freshness};
use super::document::{Document, Imported, pair_name};
use crate::estimate::{self, Estimate};
use crate::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, finite_point};

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
    /// One sentence about what it means.
    pub tooltip: &'static str,
}

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
        Fact { name: "From", value: imported.file.clone(), tooltip: "The file that it was imported from." },
        Fact {
            name: "Taken",
            value: imported.reading.clone(),
            tooltip: "How the numbers of the file were taken, of all the conventions that are in use.",
        },
        Fact {
            name: "Checked",
            value: check,
            tooltip: "Symmetric epipolar distance that half of the matches at the time of the import stay below.",
        },
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
    let reasons = assessment.trust.iter().flat_map(|trust| trust.reasons.iter().map(ToString::to_string));
    let warnings: Vec<_> = reasons
        .chain(assessment.warnings.iter().map(ToString::to_string))
        .map(|sentence| format!("{}.", capitalised(&in_names(&sentence, document))))
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
    let margin = (freshness == Freshness::Final).then(|| Fact {
        name: "Margin",
        value: match estimate.assessment.margin {
            Some(margin) => format!("{:.0} %", margin * 100.0),
            None => "no other geometry came near".into(),
        },
        tooltip: "How much less support the best clearly different hypothesis has; \
                  a few percent means that the result is a guess.",
    });
    facts.extend(margin);
    facts.extend(line_figures(estimate));
    if let Some(support) = &estimate.assessment.support {
        facts.push(Fact {
            name: "Support",
            value: format!("{:.1} from {} patches", support.score, support.matches),
            tooltip: "Image patches that find their match along their epipolar line, weighted by how alike they are; \
                      more is better.",
        });
    }
    if let Some(trace) = &estimate.trace {
        facts.push(Fact {
            name: "Time",
            value: format!("{:.2} s, the first after {:.2} s", trace.seconds, trace.first_seconds),
            tooltip: "How long the computation took.",
        });
    }
    facts
}

/// The figures of a hypothesis that is shown in place of the result.
pub fn hypothesis_facts(document: &Document, hypothesis: &Estimate) -> Vec<Fact> {
    let mut facts = epipoles(document, hypothesis.fundamental());
    facts.extend(line_figures(hypothesis));
    if let Some(support) = hypothesis.support_score() {
        facts.push(Fact {
            name: "Support",
            value: format!("{support:.1}"),
            tooltip: "How strongly matching image patches agree with it; higher is better.",
        });
    }
    facts
}

/// Where the epipoles of a geometry are.
pub fn epipoles(document: &Document, f: &FundamentalMatrix) -> Vec<Fact> {
    let frame = |k: usize| document.pictures.as_ref().map(|pictures| pictures[k].frame);
    vec![
        Fact {
            name: "Left epipole",
            value: epipole_text(&f.epipole1(), frame(0)),
            tooltip: "Where the left image sees the other camera; all its epipolar lines meet there.",
        },
        Fact {
            name: "Right epipole",
            value: epipole_text(&f.epipole2(), frame(1)),
            tooltip: "Where the right image sees the other camera; all its epipolar lines meet there.",
        },
    ]
}

/// What the lines say; the first result of a computation has neither figure yet.
fn line_figures(estimate: &Estimate) -> impl Iterator<Item = Fact> {
    let score = estimate.line_score().map(|score| Fact {
        name: "Line score",
        value: format!("{score:.3}"),
        tooltip: "How unlike corresponding epipolar lines are; lower is better.",
    });
    let area = estimate.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area);
    let round_trip = area.map(|area| Fact {
        name: "Round trip",
        value: format!("{area:.2} px"),
        tooltip: "How far a line ends from where it began when it is carried to the other image and back; \
                  small means that both directions agree.",
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
    use crate::estimate::{Reason, Suspect, Trust, Warning};
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
        assert!(bad.warnings[0].starts_with("Point pair q is 40.0 px off"));
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
