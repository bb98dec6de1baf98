//! Accuracy on the built-in pairs, whose true matches are exact.

use epiline::estimate::{Parameters, Verdict};
use epiline::geometry::PointPair;

use crate::support::{Known, both, disturbed, mean_distance, paper, three_point};

/// Largest error from exact clicks, px. Hundreds of matched patches are accurate to about 0.3 px
/// each. On planar parts of the scene their errors are correlated.
const EXACT: f64 = 0.7;
/// Largest error from clicks up to 0.5 px off, px. The refined `F` rests on hundreds of
/// observations, so errors of the clicks must be damped.
const NOISY: f64 = 1.5;

/// Asserts all errors at once, so that a failure shows whether one trial or all trials are off.
#[track_caller]
fn all_below(known: &Known, clicks: &[Vec<PointPair>], parameters: &Parameters, limit: f64) {
    let errors: Vec<f64> = clicks.iter().map(|c| known.error(c, parameters)).collect();
    println!("{}: {errors:.3?} px, at most {limit}", known.name);
    assert!(errors.iter().all(|e| *e <= limit), "{}: {errors:.3?} px, at most {limit}", known.name);
}

#[test]
fn other_true_clicks_are_accurate() {
    for known in both() {
        all_below(known, &known.well_posed(2, 2), &Parameters::default(), EXACT);
    }
}

#[test]
fn clicks_half_a_pixel_off_are_forgiven() {
    for known in both() {
        let clicks: Vec<_> = (0..2).map(|seed| disturbed(&known.show_me, seed)).collect();
        all_below(known, &clicks, &Parameters::default(), NOISY);
    }
}

#[test]
fn three_clicks_are_as_accurate() {
    for known in both() {
        let [p, q] = known.show_me;
        let shown = [p, q, known.third];
        all_below(known, &known.well_posed(1, 3), &three_point(), EXACT);
        all_below(known, &[disturbed(&shown, 10)], &three_point(), NOISY);
    }
}

/// The published method uses lines only and does not refine all seven parameters of F. The bound
/// only excludes wrong geometries: a random geometry through the two clicks is off by a hundred
/// pixels or more.
#[test]
fn the_paper_preset_finds_the_geometry_roughly() {
    for known in both() {
        all_below(known, &[known.show_me.to_vec()], &paper(), 25.0);
    }
}

/// The result must agree with matches that were never clicked, and be called reliable.
#[test]
fn the_shown_clicks_are_accurate_and_the_result_is_sure_of_itself() {
    for known in both() {
        let found = known.estimate(&known.show_me, &Parameters::default()).unwrap();
        let error = mean_distance(found.fundamental(), &known.scene.matches);
        println!("{}: {error:.3} px on {} patches", known.name, found.matches().len());
        assert!(error <= EXACT, "{}: {error} px", known.name);
        // About 1,500 corners per image should give a few hundred matches. A wrong geometry has a
        // few dozen by chance.
        assert!(
            found.is_refined() && found.matches().len() >= 100,
            "{}: {}",
            known.name,
            found.matches().len()
        );
        let trust = found.assessment.trust.as_ref().expect("a final result has a verdict");
        assert_eq!(trust.verdict, Verdict::Reliable, "{}: {:?}", known.name, trust.reasons);
        assert!(found.assessment.warnings.is_empty(), "{}: {:?}", known.name, found.assessment.warnings);
        // Null vectors of a matrix of norm 1, up to rounding.
        assert!((found.fundamental().matrix() * found.fundamental().epipole1()).norm() < 1e-12);
        assert!(found.fundamental().matrix().tr_mul(&found.fundamental().epipole2()).norm() < 1e-12);
    }
}
