use image::{DynamicImage, GenericImageView, GrayImage, Luma, LumaA, Rgb, Rgba};
use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::cancel::CancelFlag;
use crate::geometry::{Camera, FundamentalMatrix, Point, PointPair};
use crate::synthetic::Motion;

/// Returns F and exact matches in the part of a scene that both cameras see.
fn exact_pair(motion: Motion, frame: Frame) -> (FundamentalMatrix, Vec<PointPair>) {
    let cameras = motion.cameras(frame).unwrap();
    let f = Camera::fundamental(&cameras[0], &cameras[1]).unwrap();
    let mut matches = Vec::new();
    for k in 0..2000 {
        let t = f64::from(k);
        let x =
            Point3::new((t * 0.91).sin() * 5.0, 7.0 + (t * 0.37).cos() * 4.0, 1.5 + (t * 1.71).sin() * 3.0);
        let (Some(point1), Some(point2)) = (cameras[0].project(&x), cameras[1].project(&x)) else { continue };
        if frame.contains(point1) && frame.contains(point2) {
            matches.push(PointPair { point1, point2 });
        }
    }
    assert!(matches.len() > 100, "{motion:?}: {} matches", matches.len());
    (f, matches)
}

const FRAME: Frame = Frame { width: 640, height: 480 };

fn rectified(motion: Motion, method: RectifyMethod) -> Result<(Rectification, Vec<PointPair>), RectifyError> {
    let (f, matches) = exact_pair(motion, FRAME);
    rectify(&f, [FRAME; 2], &matches, method, &Limits::default()).map(|r| (r, matches))
}

#[test]
fn exact_matches_come_into_the_same_row() {
    for motion in Motion::ALL {
        for method in [RectifyMethod::Planar, RectifyMethod::Polar] {
            let (r, matches) = match rectified(motion, method) {
                Err(RectifyError::EpipoleInside { .. }) if motion == Motion::Forward => continue,
                other => other.unwrap(),
            };
            let rows = r.measures.rows.unwrap();
            // Planar rows are exact. Polar rows are straight between neighbours a pixel apart.
            let tolerance = if method == RectifyMethod::Planar { 1e-6 } else { 0.02 };
            assert!(rows.max < tolerance, "{motion:?} {method:?}: {rows:?}");
            assert!(rows.outside * 50 <= matches.len(), "{motion:?} {method:?}: {rows:?}");
        }
    }
}

#[test]
fn maps_undo_each_other() {
    for motion in Motion::ALL {
        let (r, matches) = rectified(motion, RectifyMethod::Auto).unwrap();
        for m in matches {
            for (map, p) in r.maps.iter().zip([m.point1, m.point2]) {
                let Some(q) = map.rectified_from_original(p) else { continue };
                let back = map.original_from_rectified(q).unwrap();
                assert!((back - p).norm() < 1e-3, "{motion:?}: {p} {q} {back}");
            }
        }
    }
}

#[test]
fn nothing_is_mirrored_and_pictures_stand_upright() {
    for motion in Motion::ALL {
        for method in [RectifyMethod::Planar, RectifyMethod::Polar] {
            let Ok((r, _)) = rectified(motion, method) else { continue };
            for map in &r.maps {
                let c = FRAME.centre();
                let at = |x: f64, y: f64| map.rectified_from_original(Point::new(c.x + x, c.y + y)).unwrap();
                // Half way between the centre and a corner, away from an epipole inside.
                let (o, x, y) = (at(150.0, 110.0), at(151.0, 110.0), at(150.0, 111.0));
                let area = (x - o).perp(&(y - o));
                assert!(area > 0.0, "{motion:?} {method:?}: mirrored");
                if motion != Motion::Forward {
                    assert!((x - o).x > 0.5 && (y - o).y > 0.5, "{motion:?} {method:?}: {o} {x} {y}");
                }
            }
        }
    }
}

#[test]
fn a_sideways_pair_stays_as_it_is() {
    let (r, _) = rectified(Motion::Sideways, RectifyMethod::Auto).unwrap();
    assert_eq!((r.method, r.size), (RectifyMethod::Planar, FRAME));
    assert!(r.warnings.is_empty(), "{:?}", r.warnings);
    for (map, distortion) in r.maps.iter().zip(r.measures.distortion) {
        let h = map.homography().unwrap();
        assert!((h - nalgebra::Matrix3::identity()).norm() < 1e-6, "{h}");
        assert!((distortion.orthogonality.unwrap() - 90.0).abs() < 1e-6);
        assert!((distortion.aspect_ratio.unwrap() - 1.0).abs() < 1e-9);
        assert!(distortion.cut + distortion.shrunk + distortion.stretched == 0.0, "{distortion:?}");
    }
    // The polar picture agrees with it.
    let (polar, _) = rectified(Motion::Sideways, RectifyMethod::Polar).unwrap();

    assert!(polar.size.width.abs_diff(FRAME.width) <= 1 && polar.size.height.abs_diff(FRAME.height) <= 1);
}

#[test]
fn planar_keeps_angles_and_proportions_where_it_can() {
    for motion in [Motion::Converging, Motion::Roll, Motion::Scale] {
        let (r, _) = rectified(motion, RectifyMethod::Planar).unwrap();
        for d in r.measures.distortion {
            assert!((d.orthogonality.unwrap() - 90.0).abs() < 2.0, "{motion:?}: {d:?}");
            assert!((d.aspect_ratio.unwrap() - 1.0).abs() < 0.2, "{motion:?}: {d:?}");
            assert!(d.stretched + d.shrunk < 0.05, "{motion:?}: {d:?}");
        }
    }
}

#[test]
fn an_epipole_inside_takes_polar_and_is_named() {
    let (r, _) = rectified(Motion::Forward, RectifyMethod::Auto).unwrap();
    assert_eq!(r.method, RectifyMethod::Polar);
    assert!(r.reason.contains("epipole lies inside the left image"), "{}", r.reason);
    // Polar has rows for the full turn and keeps both images whole.
    assert!(r.size.height > 2 * FRAME.height);
    assert!(r.measures.distortion.iter().all(|d| d.orthogonality.is_none() && d.cut < 0.05));
    let error = rectified(Motion::Forward, RectifyMethod::Planar).unwrap_err();
    assert_eq!(error, RectifyError::EpipoleInside(1));
    assert!(error.to_string().contains("use the polar method"));
}

#[test]
fn a_match_at_the_seam_of_a_whole_turn_is_in_neighbouring_rows() {
    let (f, mut matches) = exact_pair(Motion::Forward, FRAME);
    let rectified = |matches: &[PointPair]| {
        rectify(&f, [FRAME; 2], matches, RectifyMethod::Polar, &Limits::default()).unwrap()
    };
    let r = rectified(&matches);
    let last = (r.size.height - 1) as f64;
    let at = |x: usize| {
        let (point1, point2) = (r.maps[0].row(0.0).at(x as f64)?, r.maps[1].row(last).at(x as f64)?);
        (FRAME.contains(point1) && FRAME.contains(point2)).then_some(PointPair { point1, point2 })
    };
    matches.extend((0..r.size.width).filter_map(at).nth(60));
    let rows = rectified(&matches).measures.rows.unwrap();
    assert!(rows.matches == matches.len() && rows.max < 2.0 && rows.outside == 0, "{rows:?}");
}

#[test]
fn half_lines_follow_the_matches() {
    let (f, matches) = exact_pair(Motion::Forward, FRAME);
    // The camera is turned upside down: the right half of image 1 is on the left of image 2.
    let turned = |p: Point| Point::new(FRAME.right() - p.x, FRAME.bottom() - p.y);
    let half_turn =
        nalgebra::Matrix3::new(-1.0, 0.0, FRAME.right(), 0.0, -1.0, FRAME.bottom(), 0.0, 0.0, 1.0);
    let f = FundamentalMatrix::from_rank_two(half_turn.transpose() * f.matrix()).unwrap();
    let matches: Vec<_> =
        matches.iter().map(|m| PointPair { point1: m.point1, point2: turned(m.point2) }).collect();
    let told = rectify(&f, [FRAME; 2], &matches, RectifyMethod::Polar, &Limits::default()).unwrap();
    assert!(told.measures.rows.unwrap().max < 0.02);
    assert!(told.warnings.is_empty(), "{:?}", told.warnings);
    // Without a match the camera is assumed to be upright, with a warning.
    let untold = rectify(&f, [FRAME; 2], &[], RectifyMethod::Polar, &Limits::default()).unwrap();
    assert!(untold.warnings.contains(&RectifyWarning::OrientationAssumed), "{:?}", untold.warnings);
    assert_eq!(untold.measures.rows, None);
}

#[test]
fn the_limit_makes_pictures_smaller_and_says_so() {
    for motion in [Motion::Forward, Motion::Converging] {
        let (f, matches) = exact_pair(motion, FRAME);
        let full = rectify(&f, [FRAME; 2], &matches, RectifyMethod::Auto, &Limits::default()).unwrap();
        let limits = Limits { pixels: 60_000 };
        let small = rectify(&f, [FRAME; 2], &matches, RectifyMethod::Auto, &limits).unwrap();
        let pixels = small.size.width * small.size.height;
        assert!(pixels <= limits.pixels && pixels > limits.pixels * 9 / 10, "{motion:?}: {pixels}");
        assert!(
            small.scale < 1.0 && matches!(small.warnings[..], [RectifyWarning::Reduced { .. }]),
            "{small:?}"
        );
        assert!(small.measures.rows.unwrap().max < 0.02);
        let ratio = |r: &Rectification| r.size.width as f64 / r.size.height as f64;
        assert!(
            (ratio(&small) / ratio(&full) - 1.0).abs() < 0.02,
            "{motion:?}: {:?} {:?}",
            small.size,
            full.size
        );
        let error = rectify(&f, [FRAME; 2], &[], RectifyMethod::Auto, &Limits { pixels: 3 }).unwrap_err();
        assert_eq!(error, RectifyError::Limit(3));
    }
    // An epipole a pixel outside the border would make the planar picture huge.
    let near =
        FundamentalMatrix::from_rank_two(nalgebra::Vector3::new(640.5, 240.0, 1.0).cross_matrix()).unwrap();
    if let Ok(r) = rectify(&near, [FRAME; 2], &[], RectifyMethod::Planar, &Limits::default()) {
        assert!(r.size.width * r.size.height <= Limits::default().pixels);
        assert!(r.warnings.iter().any(|w| matches!(w, RectifyWarning::Bent { .. })), "{:?}", r.warnings);
    }
}

#[test]
fn tiny_images_and_foreign_geometry_are_refused() {
    let (f, _) = exact_pair(Motion::Sideways, FRAME);
    let tiny = [FRAME, Frame::new(1, 480)];
    let refused = rectify(&f, tiny, &[], RectifyMethod::Auto, &Limits::default()).unwrap_err();
    assert_eq!(refused, RectifyError::TooSmall(2));
    // Image 2 lies outside everything that image 1 sees.
    let shift = nalgebra::Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, -5000.0, 0.0, 0.0, 1.0);
    let beyond = FundamentalMatrix::from_rank_two(shift.transpose() * f.matrix()).unwrap();
    for method in RectifyMethod::ALL {
        let refused = rectify(&beyond, [FRAME; 2], &[], method, &Limits::default()).unwrap_err();
        assert_eq!(refused, RectifyError::NoCommonLines, "{method:?}");
    }
}

/// Returns a picture whose grey level encodes x.
fn ramp(frame: Frame) -> GrayImage {
    GrayImage::from_fn(frame.width as u32, frame.height as u32, |x, _| Luma([(x / 4) as u8]))
}

#[test]
fn every_kind_of_picture_keeps_its_depth_and_colours() {
    let (r, _) = rectified(Motion::Sideways, RectifyMethod::Planar).unwrap();
    let gray = ramp(FRAME);
    let never = CancelFlag::default();
    let drawn = |original: DynamicImage| r.warp(0, &original, &never).unwrap();
    let kinds = [
        (DynamicImage::ImageLuma8(gray.clone()), image::ColorType::La8),
        (DynamicImage::ImageRgb8(DynamicImage::from(gray.clone()).to_rgb8()), image::ColorType::Rgba8),
        (DynamicImage::ImageRgba8(DynamicImage::from(gray.clone()).to_rgba8()), image::ColorType::Rgba8),
        (DynamicImage::ImageLuma16(DynamicImage::from(gray.clone()).to_luma16()), image::ColorType::La16),
        (DynamicImage::ImageRgb16(DynamicImage::from(gray.clone()).to_rgb16()), image::ColorType::Rgba16),
        (DynamicImage::ImageRgb32F(DynamicImage::from(gray.clone()).to_rgb32f()), image::ColorType::Rgba32F),
    ];
    for (original, colour) in kinds {
        let picture = drawn(original.clone());
        assert_eq!((picture.color(), picture.dimensions()), (colour, original.dimensions()));
        // The map is the identity, up to rounding far below a grey level.
        let (a, b) = (original.to_luma16(), picture.to_luma16());
        let worst = a.pixels().zip(b.pixels()).map(|(p, q)| p.0[0].abs_diff(q.0[0])).max().unwrap();
        assert!(worst <= 2, "{colour:?}: {worst}");
    }
}

#[test]
fn what_the_image_does_not_reach_is_transparent() {
    let (r, matches) = rectified(Motion::Forward, RectifyMethod::Polar).unwrap();
    let gray = ramp(FRAME);
    let picture = r.warp(0, &gray.clone().into(), &CancelFlag::default()).unwrap().to_luma_alpha8();
    let transparent = picture.pixels().filter(|p| p.0[1] == 0).count();
    assert!(transparent > 1000, "the half lines are of different lengths");
    for m in matches {
        let q = r.maps[0].rectified_from_original(m.point1).unwrap();
        let LumaA([value, alpha]) = *picture.get_pixel(q.x.round() as u32, q.y.round() as u32);
        assert_eq!(alpha, 255);
        // Half a grey level for up to a pixel of displacement, and rounding.
        assert!((f64::from(value) - m.point1.x / 4.0).abs() < 1.6, "{q} {value} {}", m.point1);
    }
}

#[test]
fn invisible_colours_do_not_leak() {
    let (r, _) = rectified(Motion::Roll, RectifyMethod::Planar).unwrap();
    // Invisible green pixels next to opaque red ones.
    let original = image::RgbaImage::from_fn(640, 480, |x, _| {
        if x % 2 == 0 { Rgba([200, 0, 0, 255]) } else { Rgba([0, 255, 0, 0]) }
    });
    let drawn = r.warp(1, &original.into(), &CancelFlag::default()).unwrap().to_rgba8();
    assert!(drawn.pixels().all(|p| p.0[1] == 0));
    assert!(drawn.pixels().any(|p| p.0[3] > 0 && p.0[3] < 255));
}

#[test]
fn a_cancelled_picture_is_none() {
    let (r, _) = rectified(Motion::Roll, RectifyMethod::Planar).unwrap();
    let cancel = CancelFlag::default();
    cancel.cancel();
    assert!(r.warp(0, &ramp(FRAME).into(), &cancel).is_none());
}

#[test]
fn pictures_side_by_side() {
    let left = DynamicImage::from(image::RgbImage::from_pixel(4, 6, Rgb([200, 200, 200])));
    let right = DynamicImage::from(image::RgbImage::from_pixel(4, 6, Rgb([100, 100, 100])));
    let both = side_by_side([&left, &right], 4);
    assert_eq!(both.dimensions(), (8, 6));
    assert_eq!(
        (both.get_pixel(3, 0).0, both.get_pixel(4, 0).0),
        ([200, 200, 200, 255], [100, 100, 100, 255])
    );
    assert!((0..8).all(|x| both.get_pixel(x, 2) == both.get_pixel(0, 2)));
}

/// Half lines that leave the image immediately still have a line in the other image.
#[test]
fn an_epipole_on_the_border_keeps_its_lines() {
    let f = FundamentalMatrix::nearest_rank_two(nalgebra::Matrix3::new(
        0.0,
        0.0,
        6.421_382_018_367_434e-8,
        -6.228_070_931_161_787,
        5.035_892_884_284_909e-9,
        -9.357_127_918_368_904e-9,
        -7.028_983_503_556_255,
        -1.365_579_038_254_935_4e-9,
        -8.777_637_226_655_178e-8,
    ))
    .unwrap();
    let frames = [Frame::new(2, 33), FRAME];
    assert!(f.epipole1().x.abs() < 1e-20);
    let r = rectify(&f, frames, &[], RectifyMethod::Polar, &Limits::default()).unwrap();
    let mut compared = 0;
    for y in 0..r.size.height {
        let q = Point::new(r.size.width as f64 / 2.0, y as f64);
        let (a, b) =
            (r.maps[0].original_from_rectified(q).unwrap(), r.maps[1].original_from_rectified(q).unwrap());
        let line2 = f.line2_from_point1(a).unwrap();
        assert!(line2.distance(b) < 0.5, "{a} {b} {}", line2.distance(b));
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Every matrix gives a picture within the limit or an error message, without a panic.
    #[test]
    fn any_matrix_is_answered(
        entries in proptest::array::uniform9(-1.0f64..1.0),
        scales in proptest::array::uniform3(-8i32..3),
        width in 2usize..900,
        height in 2usize..900,
    ) {
        let scaled = |k: usize| entries[k] * 10f64.powi(scales[k % 3]);
        let Some(f) = FundamentalMatrix::nearest_rank_two(nalgebra::Matrix3::from_fn(|r, c| scaled(3 * r + c)))
        else { return Ok(()) };
        let frames = [Frame::new(width, height), FRAME];
        let limits = Limits { pixels: 4_000_000 };
        for method in RectifyMethod::ALL {
            match rectify(&f, frames, &[], method, &limits) {
                Ok(r) => {
                    prop_assert!(r.size.width * r.size.height <= limits.pixels);
                    prop_assert!(r.size.width >= 2 && r.size.height >= 2);
                    // Both maps give the same row to points on corresponding lines, and interpolate
                    // between rows.
                    let q = Point::new(r.size.width as f64 / 2.0, (r.size.height / 2) as f64);
                    let (Some(a), Some(b)) =
                        (r.maps[0].original_from_rectified(q), r.maps[1].original_from_rectified(q))
                    else { continue };
                    prop_assert!(a.x.is_finite() && b.y.is_finite());
                    if frames[0].contains(a) && frames[1].contains(b) {
                        // A matrix may squeeze a whole pencil into a millionth of a pixel of one
                        // image. The row is then accurate in the pixels of the other image.
                        let (line2, line1) = (f.line2_from_point1(a), f.line1_from_point2(b));
                        let is_on = line2.is_none_or(|l| l.distance(b) < 0.5)
                            || line1.is_none_or(|l| l.distance(a) < 1e-4);
                        prop_assert!(is_on, "{method:?} {a} {b}");
                    }
                }
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }
}
