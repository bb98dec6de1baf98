//! Searches on pictures with known matches.

use super::*;
use crate::geometry::{Frame, PointPair};
use crate::image::GrayPlane;
use crate::synthetic::{Motion, test_pair};

const BOTH: [ClickedImage; 2] = [ClickedImage::First, ClickedImage::Second];

/// Returns the clicked point and the true match.
fn click(m: &PointPair, clicked: ClickedImage) -> (Point, Point) {
    match clicked {
        ClickedImage::First => (m.point1, m.point2),
        ClickedImage::Second => (m.point2, m.point1),
    }
}

/// Returns the grey level of irregular smooth blobs, defined everywhere.
fn blobs(x: f64, y: f64) -> f32 {
    let lattice = |i: f64, j: f64| {
        let cell = (i as i64 as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (j as i64 as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
        (cell.wrapping_mul(0x1656_67B1_9E37_79F9) >> 40) as f64 / f64::from(1 << 24)
    };
    let octave = |size: f64| {
        let (i, j) = ((x / size).floor(), (y / size).floor());
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (smooth(x / size - i), smooth(y / size - j));
        let row = |j: f64| lattice(i, j) * (1.0 - u) + lattice(i + 1.0, j) * u;
        row(j) * (1.0 - v) + row(j + 1.0) * v
    };
    (40.0 + 90.0 * octave(23.0) + 60.0 * octave(9.0) + 30.0 * octave(5.0)) as f32
}

/// Returns the blobs, and the blobs rotated and scaled about the middle with other brightness.
fn turned(degrees: f64, scale: f64) -> (PreparedPair, impl Fn(Point) -> Point) {
    let frame = Frame::new(480, 360);
    let middle = frame.centre();
    let pose = Pose { rotation: degrees.to_radians(), scale };
    let (forth, back) = (pose.matrix(), pose.inverse().matrix());
    let image1 = GrayPlane::from_fn(frame, |x, y| blobs(x as f64, y as f64));
    let image2 = GrayPlane::from_fn(frame, |x, y| {
        let p = middle + back * (Point::new(x as f64, y as f64) - middle);
        0.7 * blobs(p.x, p.y) + 25.0
    });
    (PreparedPair::new(&image1, &image2), move |p| middle + forth * (p - middle))
}

fn known(f: Option<&FundamentalMatrix>) -> Known<'static> {
    Known { fundamental: f.copied(), ..Known::default() }
}

fn free(prepared: &PreparedPair, point: Point, clicked: ClickedImage) -> Result<Suggestions, SuggestError> {
    suggest(prepared, point, clicked, &Known::default(), &SuggestParameters::default())
}

#[test]
fn rotated_resized_and_darker_pictures_are_matched_to_subpixel_accuracy() {
    for (degrees, scale) in [(0.0, 1.0), (30.0, 1.0), (-30.0, 1.0), (0.0, 0.7), (0.0, 1.4), (-22.0, 1.2)] {
        let (prepared, there) = turned(degrees, scale);
        for point in [Point::new(240.0, 180.0), Point::new(200.0, 140.0), Point::new(290.0, 225.0)] {
            let found = free(&prepared, point, ClickedImage::First).unwrap();
            let best = found.clear().unwrap_or_else(|| panic!("{degrees}° {scale} {point}: {found:?}"));
            assert!((best.position - there(point)).norm() < 0.3, "{degrees}° {scale} {point}: {found:?}");
            // Search steps are 15° and a factor of 1.19. Alignment must come closer than half a
            // step.
            assert!((best.rotation.to_degrees() - degrees).abs() < 5.0, "{found:?}");
            assert!((best.scale / scale - 1.0).abs() < 0.06, "{found:?}");
        }
    }
}

#[test]
fn large_rotations_and_scales_are_found_by_features_a_view_or_a_placed_pair() {
    for (degrees, scale) in [(90.0, 1.0), (-140.0, 0.8), (180.0, 0.5), (50.0, 2.0)] {
        let (prepared, there) = turned(degrees, scale);
        let point = Point::new(250.0, 170.0);
        let pair = PointPair { point1: Point::new(226.0, 195.0), point2: there(Point::new(226.0, 195.0)) };
        let at_pair = view_at(&prepared, &[pair]).unwrap();
        let exact = RelativeView { scale: Some(scale), rotation: f64::to_radians(degrees) };
        for view in [None, Some(exact), Some(at_pair)] {
            let known = Known { view, ..Known::default() };
            for (clicked, from, to) in
                [(ClickedImage::First, point, there(point)), (ClickedImage::Second, there(point), point)]
            {
                let found = suggest(&prepared, from, clicked, &known, &SuggestParameters::default()).unwrap();
                let best = found.clear().unwrap_or_else(|| panic!("{degrees}° {scale} {view:?}: {found:?}"));
                assert!((best.position - to).norm() < 0.6, "{degrees}° {scale} {view:?}: {found:?}");
            }
        }
    }
}

#[test]
fn refining_moves_a_similar_pair_and_leaves_a_dissimilar_one() {
    for (degrees, scale) in [(0.0, 1.0), (20.0, 0.8), (120.0, 1.0), (-75.0, 0.6)] {
        let (prepared, there) = turned(degrees, scale);
        let point = Point::new(240.0, 190.0);
        let parameters = SuggestParameters::default();
        for off in [(0.0, 0.0), (1.3, -0.8), (-2.0, 1.7)] {
            let point2 = there(point) + crate::geometry::Vector::new(off.0, off.1);
            let found = refine(&prepared, &PointPair { point1: point, point2 }, None, &parameters).unwrap();
            let error = (found.position - there(point)).norm();
            assert!(error < 0.2, "{degrees}° {scale} {off:?}: {error}");
        }
        let elsewhere = PointPair { point1: point, point2: Point::new(330.0, 120.0) };
        assert_eq!(refine(&prepared, &elsewhere, None, &parameters), Err(SuggestError::NotAligned(2)));
    }
}

#[test]
fn points_at_the_border_are_matched() {
    let frame = Frame::new(480, 360);
    let image1 = GrayPlane::from_fn(frame, |x, y| blobs(x as f64, y as f64));
    let image2 = GrayPlane::from_fn(frame, |x, y| blobs(x as f64 - 40.0, y as f64 - 30.0));
    let prepared = PreparedPair::new(&image1, &image2);
    for point in
        [Point::new(0.0, 0.0), Point::new(2.0, 150.0), Point::new(200.0, -0.5), Point::new(425.0, 3.0)]
    {
        let found = free(&prepared, point, ClickedImage::First).unwrap();
        let truth = point + crate::geometry::Vector::new(40.0, 30.0);
        assert!((found.candidates[0].position - truth).norm() < 1.0, "{point}: {found:?}");
    }
}

#[test]
fn clear_suggestions_on_rendered_scenes_are_right() {
    for (motion, least_clear) in
        [(Motion::Sideways, 0.5), (Motion::Roll, 0.3), (Motion::Scale, 0.2), (Motion::Forward, 0.5)]
    {
        let pair = test_pair(Frame::new(512, 384), motion, 4).unwrap();
        let prepared = PreparedPair::new(&pair.pictures[0].gray, &pair.pictures[1].gray);
        let (mut clicks, mut clear, mut right) = (0, 0, 0);
        for m in pair.matches.iter().step_by(3) {
            for (clicked, f) in BOTH.iter().zip([None, Some(&pair.fundamental)]) {
                let (point, truth) = click(m, *clicked);
                clicks += 1;
                let found = suggest(&prepared, point, *clicked, &known(f), &SuggestParameters::default());
                let Ok(found) = found else { continue };
                if let Some(best) = found.clear() {
                    clear += 1;
                    right += usize::from((best.position - truth).norm() < 5.0);
                }
            }
        }
        let (clicks, clear, right) = (f64::from(clicks), f64::from(clear), right as f64);
        assert!(clear >= least_clear * clicks, "{motion:?}: {clear} of {clicks}");
        // At most one or two of a few dozen may be wrong.
        assert!(right >= 0.93 * clear, "{motion:?}: {right} of {clear}");
    }
}

#[test]
fn repeated_and_flat_surroundings_are_reported() {
    let frame = Frame::new(400, 300);
    let tiles = GrayPlane::from_fn(frame, |x, y| blobs((x % 80) as f64, (y % 60) as f64));
    let prepared = PreparedPair::new(&tiles, &tiles);
    let found = free(&prepared, Point::new(200.0, 150.0), ClickedImage::First).unwrap();
    assert_ne!(found.verdict, Clarity::Clear, "{found:?}");
    assert!(found.candidates.len() > 1 && found.ambiguity > 0.9, "{found:?}");

    let half = GrayPlane::from_fn(frame, |x, y| if x < 200 { 90.0 } else { blobs(x as f64, y as f64) });
    let prepared = PreparedPair::new(&half, &tiles);
    let flat = free(&prepared, Point::new(60.0, 150.0), ClickedImage::First);
    assert_eq!(flat, Err(SuggestError::Flat));
    let nowhere = PreparedPair::new(&tiles, &GrayPlane::from_fn(frame, |_, _| 9.0));
    let nothing = free(&nowhere, Point::new(60.0, 150.0), ClickedImage::First);
    assert_eq!(nothing, Err(SuggestError::NothingAlike(2)));
}

#[test]
fn impossible_points_are_refused() {
    let frame = Frame::new(200, 150);
    let plane = GrayPlane::from_fn(frame, |x, y| blobs(x as f64, y as f64));
    let small = GrayPlane::from_fn(Frame::new(12, 150), |x, y| blobs(x as f64, y as f64));
    let prepared = PreparedPair::new(&plane, &plane);
    let at = |x, y| free(&prepared, Point::new(x, y), ClickedImage::Second).unwrap_err();
    assert_eq!(at(f64::NAN, 3.0), SuggestError::NotFinite);
    assert!(matches!(at(200.0, 3.0), SuggestError::Outside { image: 2, .. }));
    let tiny = free(&PreparedPair::new(&plane, &small), Point::new(9.0, 9.0), ClickedImage::First);
    assert!(matches!(tiny, Err(SuggestError::TooSmall { image: 2, .. })));
    for size in [24, 25, 33] {
        let plane = GrayPlane::from_fn(Frame::new(size, 24), |x, y| blobs(x as f64, y as f64));
        let _ = free(&PreparedPair::new(&plane, &plane), Point::new(3.0, 20.0), ClickedImage::First);
    }
}

#[test]
fn matches_around_a_point_decide_between_places_that_look_alike() {
    // A pattern that repeats after 60 px, moved by 14 px.
    let frame = Frame::new(480, 360);
    let pattern = |x: f64, y: f64| blobs(x.rem_euclid(60.0), y);
    let [image1, image2] =
        [0.0, 14.0].map(|shift| GrayPlane::from_fn(frame, |x, y| pattern(x as f64 - shift, y as f64)));
    let prepared = PreparedPair::new(&image1, &image2);
    let pair = |x: f64, y: f64| PointPair::new(x, y, x + 14.0, y);
    let around: Vec<PointPair> =
        [(200.0, 150.0), (230.0, 210.0), (270.0, 160.0), (220.0, 130.0), (260.0, 215.0)]
            .map(|(x, y)| pair(x, y))
            .to_vec();
    let fundamental = Some(crate::geometry::random_scene::rows(0.0));
    let view = Some(RelativeView::UPRIGHT);
    let at = pair(240.0, 180.0);
    let run = |matches: &[PointPair], clicked: ClickedImage| {
        let known = Known { fundamental, view, matches };
        suggest(&prepared, click(&at, clicked).0, clicked, &known, &SuggestParameters::default()).unwrap()
    };
    for clicked in BOTH {
        assert_eq!(run(&[], clicked).verdict, Clarity::Ambiguous);
        let found = run(&around, clicked);
        let place = found.clear().unwrap().position;
        assert!((place - click(&at, clicked).1).norm() < 0.3, "{found:?}");
    }
    // Neighbours that do not agree decide nothing.
    let mut apart = around.clone();
    apart[0].point2.x += 90.0;
    assert_eq!(run(&apart, ClickedImage::First).verdict, Clarity::Ambiguous);
}
