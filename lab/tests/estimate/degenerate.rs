//! Degenerate input: an error or a warning, never a panic.

use epiline::camera::PicturesOf;
use epiline::estimate::{
    Estimate, EstimateError, Method, Monitor, Parameters, Preset, Verdict, Warning, estimate,
};
use epiline::geometry::{Frame, Point, PointPair, Vector};
use epiline::image::{GrayPlane, Picture, Pyramid};
use epiline::io::{GeometryFile, ImageNote, ResultFile, result_in_words};
use epiline::synthetic::{Motion, TestPair, test_pair};
use image::imageops::{FilterType, resize};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma};
use nalgebra::Matrix3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::{COURTYARD, mean_distance, paper};

type Outcome = Result<Estimate, EstimateError>;

fn run(images: [&GrayPlane; 2], clicks: &[PointPair], parameters: &Parameters) -> Outcome {
    estimate(images[0], images[1], clicks, parameters, &Monitor::silent())
}

/// Asserts an error, or a result without NaN.
#[track_caller]
fn is_sound(outcome: &Outcome) {
    match outcome {
        Ok(found) => {
            let f = found.fundamental();
            assert!(f.matrix().iter().all(|v| v.is_finite()), "{f:?}");
            assert!((f.matrix().norm() - 1.0).abs() < 1e-9, "{f:?}");
        }
        Err(error) => assert!(!error.to_string().is_empty() && *error != EstimateError::Cancelled),
    }
}

/// Returns whether the outcome is an error, or a result that is not called reliable.
fn is_doubted(outcome: &Outcome) -> bool {
    outcome.as_ref().map_or(true, |found| {
        let trust = found.assessment.trust.as_ref().expect("a final result has a verdict");
        trust.verdict != Verdict::Reliable || !found.assessment.warnings.is_empty()
    })
}

/// Describes the evidence for a result, for messages.
fn told(outcome: &Outcome) -> String {
    format!(
        "{:?}",
        outcome.as_ref().map(|e| (
            &e.assessment.trust,
            &e.assessment.warnings,
            e.assessment.margin,
            &e.assessment.support,
            e.fundamental()
        ))
    )
}

fn both_presets() -> [Parameters; 2] {
    Preset::ALL.map(Parameters::from)
}

/// Returns a small pair with texture everywhere.
fn small(width: usize, height: usize) -> TestPair {
    test_pair(Frame::new(width, height), Motion::Converging, 4).unwrap()
}

/// Returns two matches far from each other.
fn spread(pair: &TestPair) -> [PointPair; 2] {
    let distance =
        |a: &PointPair, b: &PointPair| (a.point1 - b.point1).norm().min((a.point2 - b.point2).norm());
    let all = || pair.matches.iter().flat_map(|a| pair.matches.iter().map(move |b| [*a, *b]));
    all().max_by(|[a, b], [c, d]| distance(a, b).total_cmp(&distance(c, d))).unwrap()
}

fn planes(pair: &TestPair) -> [&GrayPlane; 2] {
    [&pair.pictures[0].gray, &pair.pictures[1].gray]
}

fn noise(frame: Frame, seed: u64) -> GrayPlane {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let values = (0..frame.width * frame.height).map(|_| random.random_range(0.0..255.0)).collect();
    GrayPlane::new(frame, values)
}

#[test]
fn flat_images_are_refused() {
    let [textured, _] = &COURTYARD.scene.images;
    let flat = GrayPlane::from_fn(textured.frame(), |_, _| 128.0);
    for parameters in both_presets() {
        for (images, image) in [([&flat, &**textured], 1), ([textured, &flat], 2), ([&flat, &flat], 1)] {
            let outcome = run(images, &COURTYARD.show_me, &parameters);
            assert_eq!(outcome.map(|_| ()), Err(EstimateError::Flat(image)));
        }
    }
}

#[test]
fn identical_images_are_refused() {
    let [image, _] = &COURTYARD.scene.images;
    let clicks = COURTYARD.show_me.map(|c| PointPair { point2: c.point1, ..c });
    for parameters in both_presets() {
        let outcome = run([image, image], &clicks, &parameters);
        assert_eq!(outcome.map(|_| ()), Err(EstimateError::NoParallax));
    }
}

/// The same picture with other noise is nearly identical, so its result must not be called
/// reliable.
#[test]
fn the_same_view_with_other_noise_is_not_trusted() {
    let [image, _] = &COURTYARD.scene.images;
    let grain = noise(image.frame(), 3);
    let noisy = GrayPlane::from_fn(image.frame(), |x, y| {
        (image.at(x, y) + 0.04 * (grain.at(x, y) - 127.5)).clamp(0.0, 255.0)
    });
    let clicks = COURTYARD.show_me.map(|c| PointPair { point2: c.point1, ..c });
    let outcome = run([image, &noisy], &clicks, &Parameters::default());
    assert!(is_doubted(&outcome), "{}", told(&outcome));
}

/// Under other light, patches of the same view fit every geometry whose lines stay in place, so no
/// geometry may be called reliable.
#[test]
fn the_same_view_in_other_light_is_not_trusted() {
    let [image, _] = &COURTYARD.scene.images;
    let brighter = GrayPlane::from_fn(image.frame(), |x, y| 0.8 * image.at(x, y) + 40.0);
    let clicks = COURTYARD.show_me.map(|c| PointPair { point2: c.point1, ..c });
    for parameters in both_presets() {
        let outcome = run([image, &brighter], &clicks, &parameters);
        is_sound(&outcome);
        assert!(is_doubted(&outcome), "{:?}: {}", parameters.preset, told(&outcome));
    }
}

/// For a pure rotation or a planar scene, the second image is a homography of the first. Every
/// epipole then fits all matches, so the geometry must not be called reliable.
#[test]
fn a_turned_camera_is_not_trusted() {
    let [image, _] = &COURTYARD.scene.images;
    let (sin, cos) = 5f64.to_radians().sin_cos();
    let centre = image.frame().centre();
    // In-plane rotation about the centre of the image with a little perspective, and its inverse.
    let there = Matrix3::new(cos, -sin, 4.0, sin, cos, -3.0, 2e-5, -3e-5, 1.0);
    let back = there.try_inverse().unwrap();
    let mapped = |map: &Matrix3<f64>, p: Point| {
        let q = map * (p - centre.coords).to_homogeneous();
        centre + Vector::new(q.x, q.y) / q.z
    };
    let turned =
        GrayPlane::from_fn(image.frame(), |x, y| image.sample(mapped(&back, Point::new(x as f64, y as f64))));
    let clicks = COURTYARD.show_me.map(|c| PointPair { point1: c.point1, point2: mapped(&there, c.point1) });
    let outcome = run([image, &turned], &clicks, &Parameters::default());
    is_sound(&outcome);
    assert!(is_doubted(&outcome), "{}", told(&outcome));
    // The homography, which is certain, replaces F.
    let found = outcome.unwrap();
    let plane = found.assessment.plane.expect("the verdict says one plane");
    assert!(plane.share > 0.9 && plane.residual < 0.3, "{plane:?}");
    assert_eq!(plane.matches, (plane.share * found.matches().len() as f64).round() as usize);
    let h = plane.homography21;
    assert!((h[(2, 2)] - 1.0).abs() < 1e-12, "{h}");
    for (x, y) in [(30.0, 30.0), (700.0, 40.0), (380.0, 290.0), (60.0, 520.0), (700.0, 540.0)] {
        let p = Point::new(x, y);
        let q = h * p.to_homogeneous();
        let off = (Point::new(q.x / q.z, q.y / q.z) - mapped(&there, p)).norm();
        // There are few matches near the corners; the error stays below the inlier limit
        // everywhere.
        assert!(off < 1.0, "{off} px at {p}");
    }
    let images = ["left.png", "right.png"].map(|name| ImageNote::new(name.into(), image.frame()));
    let parameters = Parameters::default();
    let file = ResultFile::new(&found, &clicks, &images, &parameters, &PicturesOf::Original);
    let text = serde_json::to_string(&file).unwrap();
    assert!(text.contains("\"plane\":{\"matches\":"), "{text}");
    assert_eq!(GeometryFile::parse(&text).unwrap().0.homography21, Some(h));
    assert!(
        result_in_words(&found, &images, &PicturesOf::Original)
            .contains("Homography of the plane (x2 ∝ H x1), ")
    );
}

#[test]
fn a_scene_with_depth_has_no_homography_to_offer() {
    let found = COURTYARD.estimate(&COURTYARD.show_me, &Parameters::default()).unwrap();
    assert_eq!(found.assessment.trust.as_ref().unwrap().verdict, Verdict::Reliable);
    assert_eq!(found.assessment.plane, None);
}

/// Two distant matches on one true epipolar line determine the line but not the epipole on it.
#[test]
fn clicks_on_one_epipolar_line_are_told() {
    let known = &COURTYARD;
    let truth = known.scene.truth;
    let off = |a: &PointPair, b: &PointPair| {
        let line2 = truth.line2_from_point1(a.point1).unwrap().distance(b.point2);
        let line1 = truth.line1_from_point2(a.point2).unwrap().distance(b.point1);
        line1.max(line2)
    };
    let all = &known.scene.matches;
    let far = |a: &PointPair, b: &PointPair| {
        (a.point1 - b.point1).norm() > 150.0 && (a.point2 - b.point2).norm() > 150.0
    };
    let mut pairs: Vec<[PointPair; 2]> = all
        .iter()
        .enumerate()
        .flat_map(|(k, a)| all[k + 1..].iter().map(move |b| [*a, *b]))
        .filter(|[a, b]| far(a, b))
        .collect();
    pairs.sort_by(|[a, b], [c, d]| off(a, b).total_cmp(&off(c, d)));
    let clicks = &pairs[0];
    let apart = off(&clicks[0], &clicks[1]);
    assert!(apart < 4.0, "the sample has matches this nearly on one line: {apart} px");
    let outcome = known.estimate(clicks, &Parameters::default());
    is_sound(&outcome);
    let warned = outcome.as_ref().map_or(true, |found| {
        found.assessment.warnings.iter().any(|w| matches!(w, Warning::SameEpipolarLine { .. }))
    });
    assert!(warned, "{apart:.1} px off: {}", told(&outcome));
    // The published method discards hypotheses with nearly coincident lines, including the right
    // one, so it cannot name the problem. It must still not be certain of another geometry.
    let outcome = known.estimate(clicks, &paper());
    is_sound(&outcome);
    assert!(is_doubted(&outcome), "{apart:.1} px off: {}", told(&outcome));
}

/// With one image at half size pixels no longer correspond one to one; the geometry is the same.
#[test]
fn images_of_different_size_give_the_right_geometry() {
    let known = &COURTYARD;
    let [a, b] = &known.scene.images;
    let half = |plane: &GrayPlane| Pyramid::new(plane, 300.0).level(1).clone();
    let (half_a, half_b) = (half(a), half(b));
    for (images, scales) in [([&**a, &half_b], [1.0, 0.5]), ([&half_a, b], [0.5, 1.0])] {
        let resized = |c: &PointPair| c.rescaled(scales);
        let clicks: Vec<_> = known.show_me.iter().map(resized).collect();
        let matches: Vec<_> = known.scene.matches.iter().map(resized).collect();
        let found = run(images, &clicks, &Parameters::default()).unwrap();
        let error = mean_distance(found.fundamental(), &matches);
        println!("scales {scales:?}: {error:.3} px");
        // The bound for images of equal size is 0.7 px. A pixel of the small image is two of the
        // other.
        assert!(error < 1.0, "scales {scales:?}: {error}");
    }
}

/// The second image is enlarged twice, as by a camera of twice the resolution.
#[test]
fn an_enlarged_image_gives_the_right_geometry() {
    let known = &COURTYARD;
    let [a, b] = &known.scene.images;
    let frame = b.frame();
    // The resampler takes 1 for white.
    let values: Vec<f32> = b.values().iter().map(|v| v / 255.0).collect();
    let buffer: ImageBuffer<Luma<f32>, _> =
        ImageBuffer::from_raw(frame.width as u32, frame.height as u32, values).unwrap();
    let doubled = Frame::new(2 * frame.width, 2 * frame.height);
    let large = resize(&buffer, doubled.width as u32, doubled.height as u32, FilterType::CatmullRom);
    let large = GrayPlane::new(doubled, large.into_raw().iter().map(|v| 255.0 * v).collect());
    let resized = |c: &PointPair| {
        let p = c.point2;
        PointPair { point2: Point::new(2.0 * p.x + 0.5, 2.0 * p.y + 0.5), ..*c }
    };
    let clicks: Vec<_> = known.show_me.iter().map(resized).collect();
    let matches: Vec<_> = known.scene.matches.iter().map(resized).collect();
    let found = run([a, &large], &clicks, &Parameters::default()).unwrap();
    let error = mean_distance(found.fundamental(), &matches);
    println!("enlarged: {error:.3} px");
    // Half of the distance is measured in the enlarged image: 0.7 px becomes 0.7 · (1 + 2) / 2 px.
    assert!(error < 1.05, "{error}");
}

#[test]
fn tiny_images_do_not_panic() {
    for (width, height) in [(32, 32), (33, 47), (64, 48)] {
        let pair = small(width, height);
        for parameters in both_presets() {
            let outcome = run(planes(&pair), &spread(&pair), &parameters);
            is_sound(&outcome);
            assert!(!matches!(outcome, Err(EstimateError::TooSmall { .. })), "{width}×{height}");
        }
    }
    let pair = small(40, 31);
    let outcome = run(planes(&pair), &spread(&pair), &Parameters::default());
    assert!(matches!(outcome, Err(EstimateError::TooSmall { image: 1, height: 31, .. })), "{outcome:?}");
}

#[test]
fn long_thin_images_do_not_panic() {
    for (width, height) in [(600, 40), (40, 600)] {
        let pair = small(width, height);
        for parameters in both_presets() {
            is_sound(&run(planes(&pair), &spread(&pair), &parameters));
        }
    }
}

#[test]
fn clicks_on_the_border_do_not_panic() {
    let pair = small(160, 120);
    let [right, bottom] = [159.5, 119.5];
    // The outer edges of the outer pixels belong to the image.
    let edges = [
        [PointPair::new(-0.5, -0.5, -0.5, -0.5), PointPair::new(right, bottom, right, bottom)],
        [PointPair::new(-0.5, 60.0, -0.5, 60.0), PointPair::new(right, 60.0, right, 60.0)],
        [PointPair::new(0.0, bottom, 0.0, bottom), PointPair::new(right, -0.5, 159.0, 0.0)],
    ];
    for clicks in edges {
        for parameters in both_presets() {
            is_sound(&run(planes(&pair), &clicks, &parameters));
        }
    }
    let beyond = [PointPair::new(-0.6, 0.0, 0.0, 0.0), PointPair::new(90.0, 80.0, 90.0, 80.0)];
    let outcome = run(planes(&pair), &beyond, &Parameters::default());
    assert!(matches!(outcome, Err(EstimateError::Outside { pair: 1, image: 1, .. })), "{outcome:?}");
}

#[test]
fn repeated_clicks_are_refused() {
    let known = &COURTYARD;
    let [p, q] = known.show_me;
    let too_close_for = |preset, clicks: &[PointPair], method| {
        let parameters = Parameters { method, ..Parameters::from(preset) };
        let outcome = known.estimate(clicks, &parameters);
        assert!(
            matches!(outcome, Err(EstimateError::TooClose { .. })),
            "{:?}",
            outcome.map(|e| e.assessment.warnings)
        );
    };
    let too_close = |clicks: &[PointPair], method| too_close_for(Preset::Robust, clicks, method);
    too_close(&[p, p], Method::TwoPoint);
    // The points coincide in one image only.
    too_close(&[p, PointPair { point1: p.point1, ..q }], Method::TwoPoint);
    too_close(&[p, PointPair { point2: p.point2, ..q }], Method::TwoPoint);
    // The published search uses the third pair for κ; the patch search treats it as one more
    // observation.
    too_close_for(Preset::Paper, &[p, q, p], Method::ThreePoint);
    let once_more = known.estimate(&[p, p, q], &Parameters::default()).unwrap();
    assert_eq!(once_more.assessment.trust.map(|trust| trust.verdict), Some(Verdict::Reliable));
    let few = known.estimate(&[p, q], &Parameters { method: Method::ThreePoint, ..Parameters::default() });
    assert_eq!(few.map(|_| ()), Err(EstimateError::TooFewPairs { found: 2, needed: 3 }));
}

#[test]
fn noise_gives_no_trusted_geometry() {
    let frame = Frame::new(320, 240);
    let clicks = [PointPair::new(60.0, 50.0, 70.0, 60.0), PointPair::new(250.0, 190.0, 240.0, 200.0)];
    let (a, b) = (noise(frame, 1), noise(frame, 2));
    for parameters in both_presets() {
        let outcome = run([&a, &b], &clicks, &parameters);
        is_sound(&outcome);
        assert!(is_doubted(&outcome), "{:?}: {}", parameters.preset, told(&outcome));
    }
}

/// Contradictory clicks: no result may be called reliable.
#[test]
fn exchanged_clicks_are_not_trusted() {
    let known = &COURTYARD;
    let [p, q] = known.show_me;
    let exchanged = [PointPair { point2: q.point2, ..p }, PointPair { point2: p.point2, ..q }];
    let outcome = known.estimate(&exchanged, &Parameters::default());
    is_sound(&outcome);
    assert!(is_doubted(&outcome), "{}", told(&outcome));
}

/// Tests 16 bits through the encoder, the decoder and the grey plane.
#[test]
fn sixteen_bit_images_give_the_right_geometry() {
    let known = &COURTYARD;
    let pictures = known.scene.images.each_ref().map(|plane| {
        let frame = plane.frame();
        let values: Vec<u16> = plane.values().iter().map(|v| (v * 257.0).round() as u16).collect();
        let deep: ImageBuffer<Luma<u16>, _> =
            ImageBuffer::from_raw(frame.width as u32, frame.height as u32, values).unwrap();
        let mut bytes = std::io::Cursor::new(Vec::new());
        DynamicImage::ImageLuma16(deep).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        Picture::from_bytes("deep.png", bytes.get_ref()).unwrap()
    });
    // The grey values are the numbers of the file, stretched from the stated range to 0 to 255. Numbers were rounded.
    for (picture, plane) in pictures.iter().zip(&known.scene.images) {
        let [black, white] = picture.interpretation.range.expect("deep pictures state their range");
        let level = 255.0 / (white - black);
        let expected = |v: f32| ((f64::from(v) * 257.0 - black) * level).clamp(0.0, 255.0);
        let mut pairs = picture.gray.values().iter().zip(plane.values());
        assert!(pairs.all(|(a, b)| (f64::from(*a) - expected(*b)).abs() < 0.51 * level + 1e-3));
    }
    let found = run([&pictures[0].gray, &pictures[1].gray], &known.show_me, &Parameters::default()).unwrap();
    let error = mean_distance(found.fundamental(), &known.scene.matches);
    // The bound for the 8-bit files.
    assert!(error < 0.7, "{error}");
    // 8 bits of the same picture agree with 16 bits.
    let shallow = GrayImage::from_fn(40, 30, |x, y| Luma([(3 * x + 2 * y) as u8]));
    let picture = Picture::from_pixels("small".into(), None, DynamicImage::ImageLuma8(shallow)).unwrap();
    assert!((picture.gray.at(7, 5) - 31.0).abs() < 1e-6);
}
