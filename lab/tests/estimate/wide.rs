//! Wide changes between two photographs: rotation, scale, captions, moving objects; and a wrong
//! click.

use std::f64::consts::PI;

use epiline::estimate::{Monitor, Parameters, Reason, Verdict, estimate};
use epiline::geometry::{Frame, Point, PointPair, Vector};
use epiline::image::GrayPlane;
use nalgebra::Rotation2;

use crate::support::{COURTYARD, mean_distance};

/// Rotates image 2 about its centre and scales it, on a canvas that holds all of it. Returns the
/// image and the map of its points.
fn transformed(image: &GrayPlane, angle: f64, scale: f64) -> (GrayPlane, impl Fn(Point) -> Point) {
    let from = image.frame();
    let (turn, side) = (Rotation2::new(angle), (scale * from.diagonal()).ceil() as usize);
    let frame = Frame::new(side, side);
    let forward = move |p: Point| frame.centre() + turn * (p - from.centre()) * scale;
    // Averages the pixels that become one.
    let steps = (1.0 / scale).round().max(1.0) as i32;
    let plane = GrayPlane::from_fn(frame, |x, y| {
        let mut sum = 0.0;
        for k in 0..steps * steps {
            let part = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) - 0.5;
            let p = Point::new(x as f64 + part(k % steps), y as f64 + part(k / steps));
            let source = from.centre() + turn.inverse() * (p - frame.centre()) / scale;
            sum += if from.contains(source) { image.sample(source) } else { 90.0 };
        }
        sum / (steps * steps) as f32
    });
    (plane, forward)
}

#[test]
fn a_turned_and_resized_picture_is_as_good_as_the_untouched_one() {
    let known = &COURTYARD;
    let [a, b] = &known.scene.images;
    let untouched = known.error(&known.show_me, &Parameters::default());
    for (angle, scale) in [(100f64.to_radians(), 0.5), (PI, 1.0)] {
        let (turned, forward) = transformed(b, angle, scale);
        let moved = |m: &PointPair| PointPair { point2: forward(m.point2), ..*m };
        let clicks: Vec<_> = known.show_me.iter().map(moved).collect();
        let found = estimate(a, &turned, &clicks, &Parameters::default(), &Monitor::silent()).unwrap();
        let matches: Vec<_> = known.scene.matches.iter().map(moved).collect();
        let error = mean_distance(found.fundamental(), &matches);
        println!("{:.0}°, {scale}: {error:.3} px, untouched {untouched:.3} px", angle.to_degrees());
        // The picture was resampled again, and at half the size has half the detail.
        assert!(error < untouched + 0.3, "{:.0}°, {scale}: {error} px", angle.to_degrees());
    }
}

#[test]
fn a_caption_in_both_pictures_is_left_out_and_costs_nothing() {
    let known = &COURTYARD;
    // Letter-like cells of ink and paper along the lower edge, and a logo in a corner.
    let captioned = |image: &GrayPlane| {
        let frame = image.frame();
        GrayPlane::from_fn(frame, |x, y| {
            let (up, is_logo) = (frame.height - y, x < 60 && y < 60);
            let cell = (x / 6 * 7919 + y / 6 * 104_729 + (x / 6) * (y / 6) * 31) % 5;
            if (20..56).contains(&up) && x < 420 || is_logo {
                [250.0, 20.0, 20.0, 180.0, 20.0][cell]
            } else {
                image.at(x, y)
            }
        })
    };
    let [a, b] = known.scene.images.each_ref().map(|image| captioned(image));
    let found = estimate(&a, &b, &known.show_me, &Parameters::default(), &Monitor::silent()).unwrap();
    let error = mean_distance(found.fundamental(), &known.scene.matches);
    let left_out = found.trace.as_ref().unwrap().counts.left_out;
    println!("{error:.3} px, {left_out} corners left out");
    assert!(left_out > 30, "{left_out}");
    assert!(error < known.error(&known.show_me, &Parameters::default()) + 0.1, "{error} px");
    assert_eq!(found.assessment.trust.as_ref().map(|trust| trust.verdict), Some(Verdict::Reliable));
    let untouched = known.estimate(&known.show_me, &Parameters::default()).unwrap();
    assert_eq!(untouched.trace.as_ref().unwrap().counts.left_out, 0);
}

#[test]
fn of_three_clicks_a_wrong_one_is_outvoted_and_named() {
    let known = &COURTYARD;
    let [p, q] = known.show_me;
    let wrong = PointPair { point2: known.third.point2 + Vector::new(30.0, -60.0), ..known.third };
    for (clicks, number) in [([p, q, wrong], 3), ([wrong, p, q], 1)] {
        let found = known.estimate(&clicks, &Parameters::default()).unwrap();
        let error = mean_distance(found.fundamental(), &known.scene.matches);
        assert!(error < 1.0, "pair {number} wrong: {error} px");
        let reasons = found.assessment.trust.unwrap().reasons;
        let named = |r: &Reason| matches!(r, Reason::ClickOff { pair, .. } if *pair == number);
        assert!(reasons.iter().any(named), "pair {number}: {reasons:?}");
    }
}

/// With a stationary camera, each moving object has a line through every epipole that fits it.
#[test]
fn without_parallax_no_epipole_is_called_reliable() {
    let image = &COURTYARD.scene.images[0];
    let frame = image.frame();
    // Pieces of the picture at other positions, shifted between the two images.
    let pieces: Vec<[Vector; 3]> = (0..14)
        .map(|k| {
            let angle = f64::from(k) * 2.4;
            let at = Vector::new(90.0 + f64::from(k % 5) * 140.0, 80.0 + f64::from(k / 5) * 180.0);
            let from = Vector::new(600.0 - f64::from(k) * 35.0, 100.0 + f64::from(k * 53 % 350));
            [at, from, Vector::new(angle.cos(), angle.sin()) * (9.0 + f64::from(k))]
        })
        .collect();
    let seen = |moved: f64, noise: u64| {
        GrayPlane::from_fn(frame, |x, y| {
            let p = Vector::new(x as f64, y as f64);
            let piece = pieces.iter().find_map(|[at, from, way]| {
                let d = p - at - way * moved;
                (d.amax() < 32.0).then(|| from + d)
            });
            let hash =
                (x as u64 * 7919 + y as u64 * 104_729 + noise * 31).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            image.sample(Point::from(piece.unwrap_or(p))) + (hash >> 62) as f32
        })
    };
    let (a, b) = (seen(0.0, 1), seen(1.0, 2));
    for clicks in [[[20.0, 30.0], [700.0, 540.0]], [[40.0, 560.0], [740.0, 20.0]]] {
        let clicks = clicks.map(|[x, y]| PointPair::new(x, y, x, y));
        let found = estimate(&a, &b, &clicks, &Parameters::default(), &Monitor::silent());
        if let Ok(found) = found {
            let trust = found.assessment.trust.unwrap();
            assert_ne!(trust.verdict, Verdict::Reliable, "{:?}", trust.reasons);
        }
    }
}
