use nalgebra::Matrix3;

use super::*;
use crate::app::fake;
use crate::app::model::computation::EstimateNews;
use crate::app::model::document::{PictureIdentity, Role};
use crate::estimate::{BarcodeFigures, Estimate, EstimateError, Reason, Suspect, Trust, Verdict, Warning};
use crate::geometry::{Frame, PointPair};

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
    assert_eq!((good.word, good.sentence.as_str()), ("Estimated", "Found from p and q"));
    assert!(good.facts.iter().any(|fact| fact.name == "Lead over rival" && fact.value == "40 %"));
    assert!(good.facts.iter().all(|fact| fact.name != "Left out"));
    let (document, computation) = computed(|e| {
        let trace = e.trace.as_mut().and_then(std::sync::Arc::get_mut).unwrap();
        trace.counts.left_out = 40;
    });
    let with_caption = verdict(&document, &computation);
    assert_eq!(with_caption.tone, Tone::Good, "fixed corners do not change the verdict");
    assert!(with_caption.facts.iter().any(|fact| fact.name == "Left out" && fact.value.starts_with("40")));
    let (document, computation) =
        computed(|e| e.assessment.warnings.push(Warning::CloseClicks { distance: 9.0 }));
    let doubtful = verdict(&document, &computation);
    assert_eq!(doubtful.tone, Tone::Caution);
    assert_eq!(doubtful.word, "Doubtful");
    assert!(doubtful.sentence.starts_with("Two point pairs are only 9 px apart"));
    // Matches that make a result reliable need no clicks.
    let (document, computation) = computed(|e| {
        e.assessment.warnings.push(Warning::CloseClicks { distance: 9.0 });
        e.assessment.trust = Some(Trust { verdict: estimate::Verdict::Reliable, reasons: Vec::new() });
    });
    let reliable = verdict(&document, &computation);
    assert_eq!((reliable.tone, reliable.word), (Tone::Good, "Reliable"));
    assert!(reliable.warnings.is_empty());
}

#[test]
fn margins_are_in_percent_and_the_one_after_refinement_decides() {
    let (document, computation) = computed(|e| {
        e.assessment.margin = Some(0.054);
        let reasons = vec![Reason::Ambiguous { margin: 0.054 }];
        e.assessment.trust = Some(Trust { verdict: estimate::Verdict::Doubtful, reasons });
    });
    let margin = |told: &VerdictInWords| {
        let margin = told.facts.iter().find(|fact| fact.name == "Lead over rival").unwrap();
        margin.value.clone()
    };
    let doubtful = verdict(&document, &computation);
    assert!(doubtful.sentence.contains("(lead of the result 5 %)"), "{}", doubtful.sentence);
    assert_eq!(margin(&doubtful), "5 %");
    let (document, computation) = computed(|e| {
        e.assessment.margin = Some(0.054);
        e.assessment.refined_margin = Some(0.62);
    });
    assert_eq!(margin(&verdict(&document, &computation)), "62 %");
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
        document.set_role(2, Role::Check);
        let told = verdict(&document, &computation);
        assert_eq!(told.tone, tone, "{off} px: {:?}", told.warnings);
        let named = told.sentence.starts_with("Pair r, which is only checked, is ");
        assert_eq!(named, off > 0.0);
    }
    // An estimate for other points says nothing about these.
    computation.begin(2, false);
    assert!(!verdict(&document, &computation).sentence.contains("only checked"));
}

#[test]
fn where_most_pairs_are_misplaced_they_are_counted_and_the_worst_is_named_first() {
    let told = |distances: &[f64]| {
        let reasons = (1..).zip(distances).map(|(pair, distance)| Reason::ClickOff {
            pair,
            distance: *distance,
            suspect: Suspect::Click,
        });
        let reasons: Vec<Reason> = reasons.collect();
        let (mut document, computation) = computed(|e| {
            e.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons: reasons.clone() });
        });
        document.pairs = vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 5];
        verdict(&document, &computation).warnings
    };
    let few = told(&[20.0, 90.0]);
    assert!(few[0].starts_with("Point pair q is ") && few[1].starts_with("Point pair p is "), "{few:?}");
    let most = told(&[20.0, 90.0, 40.0]);
    assert!(most[0].starts_with("3 of 5 point pairs are off their epipolar lines."), "{most:?}");
    assert!(most[1].starts_with("Point pair q is ") && most.len() == 4, "{most:?}");
}

#[test]
fn sentences_use_the_names_of_pairs() {
    let pairs = vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 14];
    let mut document = Document { pairs, ..Document::default() };
    document.set_role(1, Role::Check);
    let f =
        FundamentalMatrix::from_rank_two(Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)).unwrap();
    let names = WindowNames { document: &document, fundamental: Some(&f) };
    assert_eq!([1, 2, 12, 99].map(|pair| names.name(pair)), ["p", "r", "13", "99"]);
    let close = EstimateError::TooClose { first: 2, second: 10, image: 2, distance: 2.0 };
    let told = named_error_in_words(&close, &names);
    assert!(told.starts_with("point pairs r and 11 are only 2.0 px apart in the right image."), "{told}");
    let off = Reason::ClickOff { pair: 2, distance: 1.4, suspect: Suspect::Click };
    let told = named_reason_in_words(&off, &names);
    assert!(told.starts_with("Point pair r is 2.0 px (symmetric distance) off its epipolar line."), "{told}");
    assert_eq!(used(&document), "13 pairs");
}

#[test]
fn where_only_a_plane_is_certain_no_epipole_is_told() {
    let epipoles_of = |reasons: Vec<Reason>| -> Vec<String> {
        let (mut document, computation) = computed(|estimate| {
            let trust = Trust { verdict: Verdict::Doubtful, reasons: reasons.clone() };
            estimate.assessment.trust = Some(trust);
        });
        let picture = PictureIdentity { name: "a".into(), path: None, frame: Frame::new(100, 100) };
        document.pictures = Some([picture.clone(), picture]);
        let (estimate, _) = computation.result().unwrap();
        let places = epipole_places(&document, estimate.fundamental(), Some(estimate)).unwrap();
        places.map(|place| place.value).to_vec()
    };
    let plane = Reason::OnePlane { percent: 97, groups: 0, agreeing: 0, is_still: false };
    assert_eq!(epipoles_of(vec![plane]), ["not determined"; 2]);
    assert!(epipoles_of(vec![Reason::NotRefined]).iter().all(|text| text != "not determined"));
}

#[test]
fn independent_lines_are_counted_like_those_of_the_verdict() {
    let figures =
        BarcodeFigures { correlation: 0.9, by_chance: 0.2, lines: 4.7, deviation: None, frames: 200 };
    let (document, computation) = computed(|estimate| estimate.assessment.barcodes = Some(figures));
    let facts = verdict(&document, &computation).facts;
    let lines = facts.iter().find(|fact| fact.name == "Distinct lines").unwrap();
    assert_eq!(lines.value, "4, in 200 frames");
}

#[test]
fn lines_without_a_verdict_are_not_those_of_a_checked_result() {
    assert_eq!(crate::app::model::Model::default().line_look(), LineLook::Other);
}
