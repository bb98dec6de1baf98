//! Images with other differences than the camera position: roll, scale, light.

use epiline::estimate::{Monitor, Parameters, Verdict, estimate};
use epiline::geometry::{Frame, PointPair};
use epiline::image::GrayPlane;
use epiline::synthetic::{Motion, test_pair};

use crate::support::{COURTYARD, mean_distance};

/// Returns two matches near opposite corners of image 1.
fn far_apart(matches: &[PointPair]) -> [PointPair; 2] {
    let along = |m: &&PointPair| m.point1.x + m.point1.y;
    let first = matches.iter().min_by(|a, b| along(a).total_cmp(&along(b))).unwrap();
    let last = matches.iter().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap();
    [*first, *last]
}

#[test]
fn a_rolled_camera_and_a_longer_lens_are_found() {
    for (motion, seed) in [(Motion::Roll, 3), (Motion::Scale, 3)] {
        let pair = test_pair(Frame::new(384, 288), motion, seed).unwrap();
        let [a, b] = &pair.pictures;
        let clicks = far_apart(&pair.matches);
        let found = estimate(&a.gray, &b.gray, &clicks, &Parameters::default(), &Monitor::silent()).unwrap();
        let error = mean_distance(found.fundamental(), &pair.matches);
        println!("{motion:?}: {error:.3} px, {} matches", found.matches().len());
        assert!(error < 1.0, "{motion:?}: {error} px");
    }
}

#[test]
fn other_light_changes_nothing() {
    let known = &COURTYARD;
    let [a, b] = &known.scene.images;
    let frame = b.frame();
    // Darker, with less contrast, and fading towards the right.
    let faded = GrayPlane::from_fn(frame, |x, y| {
        let value = b.values()[y * frame.width + x];
        value * (0.75 - 0.25 * x as f32 / frame.width as f32) + 20.0
    });
    let found = estimate(a, &faded, &known.show_me, &Parameters::default(), &Monitor::silent()).unwrap();
    let error = mean_distance(found.fundamental(), &known.scene.matches);
    assert!(error < 0.7, "{error} px");
    assert_eq!(found.assessment.trust.unwrap().verdict, Verdict::Reliable);
}
