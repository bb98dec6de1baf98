//! The same seed gives the same bits on any number of threads.

use epiline::estimate::{Estimate, Monitor, Parameters, SearchCounts, estimate};
use epiline::geometry::PointPair;
use epiline::image::{GrayPlane, Pyramid};

use crate::support::{ALLEY, COURTYARD, paper};

fn on_threads(
    threads: usize,
    images: [&GrayPlane; 2],
    clicks: &[PointPair],
    parameters: &Parameters,
) -> Estimate {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let [a, b] = images;
    // The preparation of the images is parallel too.
    pool.install(|| estimate(a, b, clicks, parameters, &Monitor::silent())).unwrap()
}

fn counts(found: &Estimate) -> &SearchCounts {
    &found.trace.as_ref().expect("a search leaves a trace").counts
}

/// Asserts equal bits in everything except the times.
#[track_caller]
fn assert_same_bits(a: &Estimate, b: &Estimate) {
    let bits = |e: &Estimate| e.fundamental().rows().map(|row| row.map(f64::to_bits));
    assert_eq!(bits(a), bits(b), "{:?} and {:?}", a.fundamental(), b.fundamental());
    let figures =
        |e: &Estimate| [e.line_score(), e.support_score(), e.assessment.margin].map(|v| v.map(f64::to_bits));
    assert_eq!(figures(a), figures(b));
    let found = |e: &Estimate| (e.assessment.warnings.clone(), e.matches().to_vec(), counts(e).clone());
    assert_eq!(found(a), found(b));
    assert_eq!(a.hypotheses().len(), b.hypotheses().len());
    for (g, h) in a.hypotheses().iter().zip(b.hypotheses()) {
        assert_eq!((bits(g), figures(g)), (bits(h), figures(h)));
    }
}

#[test]
fn the_robust_preset_on_one_and_two_threads() {
    let [a, b] = &COURTYARD.scene.images;
    let run = |threads| on_threads(threads, [a, b], &COURTYARD.show_me, &Parameters::default());
    assert_same_bits(&run(1), &run(2));
}

#[test]
fn the_paper_preset_on_one_and_two_threads() {
    let [a, b] = &ALLEY.scene.images;
    let run = |threads| on_threads(threads, [a, b], &ALLEY.show_me, &paper());
    assert_same_bits(&run(1), &run(2));
}

/// The tests above are meaningless if the seed has no effect.
#[test]
fn another_seed_draws_other_hypotheses() {
    let half = |k: usize| Pyramid::new(&COURTYARD.scene.images[k], 300.0).level(1).clone();
    let planes = [half(0), half(1)];
    let scaled = |c: &PointPair| {
        let s = |v: f64| v * 0.5 - 0.25;
        PointPair::new(s(c.point1.x), s(c.point1.y), s(c.point2.x), s(c.point2.y))
    };
    let clicks: Vec<_> = COURTYARD.show_me.iter().map(scaled).collect();
    // Few enough combinations that two draws must differ.
    let with = |seed| Parameters { seed, hypotheses: 300, ..paper() };
    let run = |seed| on_threads(2, [&planes[0], &planes[1]], &clicks, &with(seed));
    let (a, b) = (run(1), run(2));
    assert!(counts(&a).candidates.iter().product::<usize>() > 600, "{:?}", counts(&a));
    let drawn =
        |e: &Estimate| e.hypotheses().iter().map(|h| h.line_score().map(f64::to_bits)).collect::<Vec<_>>();
    assert_ne!(drawn(&a), drawn(&b));
    assert_same_bits(&a, &run(1));
}
