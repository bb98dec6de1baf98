//! Camera models against pycolmap and OpenCV, and properties of poses.

use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::pose::fit_pose;
use super::*;
use crate::geometry::{Frame, Point, PointPair, sampson_distance};

/// Values printed by `lab/camera_models.py`.
const REFERENCE: &str = include_str!("reference.txt");
const FRAME: Frame = Frame { width: 640, height: 480 };

fn rows() -> impl Iterator<Item = (&'static str, Vec<Vec<f64>>)> {
    REFERENCE.lines().map(|line| {
        let (name, numbers) = line.split_once(" | ").unwrap();
        let parts = numbers.split(" | ").map(|part| part.split(' ').map(|n| n.parse().unwrap()).collect());
        (name, parts.collect())
    })
}

#[test]
fn models_agree_with_pycolmap() {
    let mut count = 0;
    for (name, parts) in rows().filter(|(name, _)| name.chars().all(|c| !c.is_lowercase())) {
        let [parameters, ray, pixel] = &parts[..] else { panic!("{name}") };
        let camera = CameraModel::from_colmap(name, parameters).unwrap();
        let ray = Vector3::from_column_slice(ray);
        let expected = Point::new(pixel[0] - 0.5, pixel[1] - 0.5);
        let found = camera.image_from_ray(&ray).unwrap_or_else(|| panic!("{name} {ray}"));
        assert!((found - expected).norm() < 1e-6, "{name}: {found} and {expected}");
        let back = camera.ray_from_image(expected).unwrap_or_else(|| panic!("{name} {expected}"));
        // pycolmap inverts to about 1e-6; a pixel is at least 1e-3 wide here.
        assert!(back.angle(&ray) < 1e-8 * 1e3, "{name} {expected}: {}", back.angle(&ray));
        let again = camera.image_from_ray(&back).unwrap();
        assert!((again - expected).norm() < 1e-9, "{name}: {again} and {expected}");
        count += 1;
    }
    assert_eq!(count, 180);
}

#[test]
fn lenses_agree_with_opencv() {
    let k = Matrix3::new(690.0, 0.0, 322.0, 0.0, 695.0, 238.0, 0.0, 0.0, 1.0);
    let mut count = 0;
    for (name, parts) in rows().filter(|(name, _)| name.chars().all(char::is_lowercase)) {
        let [coefficients, ray, pixel, _] = &parts[..] else { panic!("{name}") };
        let lens = match name {
            "opencv" => Lens::from_opencv(coefficients).unwrap(),
            _ => Lens::equidistant(coefficients),
        };
        let camera = CameraModel::new(&k, lens).unwrap();
        let ray = Vector3::from_column_slice(ray);
        let found = camera.image_from_ray(&ray).unwrap();
        assert!((found - Point::new(pixel[0], pixel[1])).norm() < 1e-9, "{name} {ray}: {found}");
        count += 1;
    }
    assert_eq!(count, 30);
}

#[test]
fn derivatives_are_those_of_the_distortion() {
    for (name, parts) in rows().filter(|(name, _)| name.chars().all(|c| !c.is_lowercase())) {
        let camera = CameraModel::from_colmap(name, &parts[0]).unwrap();
        let (ray, lens) = (Vector3::from_column_slice(&parts[1]), camera.lens());
        let flat = lens.flat(&ray).unwrap();
        let (_, derivatives) = lens.distorted(&flat);
        for k in 0..2 {
            let step = Vector2::ith(k, 1e-6);
            let [a, b] = [flat + step, flat - step].map(|flat| lens.distorted(&flat).0);
            let numeric = (a - b) / 2e-6;
            assert!((numeric - derivatives.column(k)).norm() < 1e-5 * derivatives.norm(), "{name} {ray}");
        }
    }
}

#[test]
fn where_a_lens_folds_back_there_is_no_pixel_and_no_ray() {
    let k = calibration([500.0, 500.0], [320.0, 240.0]);
    // r (1 − 0.3 r²) has its largest value 0.7027 at r = 1.054.
    let lens = Lens::perspective(Radial::polynomial(&[-0.3]));
    let camera = CameraModel::new(&k, lens).unwrap();
    assert!(camera.image_from_ray(&Vector3::new(1.05, 0.0, 1.0)).is_some());
    assert!(camera.image_from_ray(&Vector3::new(1.06, 0.0, 1.0)).is_none());
    assert!(camera.ray_from_image(Point::new(320.0 + 500.0 * 0.702, 240.0)).is_some());
    assert!(camera.ray_from_image(Point::new(320.0 + 500.0 * 0.704, 240.0)).is_none());
    assert!(camera.image_from_ray(&Vector3::new(0.1, 0.0, -1.0)).is_none(), "behind the camera");
    assert!(camera.ray_from_image(Point::new(f64::NAN, 0.0)).is_none());
    // A fisheye lens sees behind itself.
    let fisheye = CameraModel::new(&k, Lens::equidistant(&[])).unwrap();
    let behind = Vector3::new(1.0, 0.0, -0.2).normalize();
    let pixel = fisheye.image_from_ray(&behind).unwrap();
    assert!(fisheye.ray_from_image(pixel).unwrap().angle(&behind) < 1e-9);
}

#[test]
fn impossible_calibrations_are_refused_in_words() {
    let refused = |name: &str, parameters: &[f64]| CameraModel::from_colmap(name, parameters).unwrap_err();
    assert!(refused("MAGIC", &[1.0]).contains("SIMPLE_RADIAL"));
    assert!(refused("OPENCV", &[1.0; 3]).contains("8 parameters"));
    assert!(refused("PINHOLE", &[-1.0, 1.0, 0.0, 0.0]).contains("positive"));
    assert!(refused("RADIAL", &[500.0, 1.0, 1.0, f64::NAN, 0.0]).contains("finite"));
    assert!(Lens::from_opencv(&[0.0; 7]).unwrap_err().contains("found 7"));
    assert!(Lens::from_opencv(&[0.1; 14]).unwrap_err().contains("tilted"));
}

#[test]
fn a_view_without_distortion_has_straight_lines_and_the_scale_of_the_middle() {
    for (name, parameters) in [
        ("SIMPLE_RADIAL", vec![690.0, 320.0, 240.0, -0.127]),
        ("OPENCV", vec![480.0, 480.0, 316.0, 226.0, 0.2, -0.3, 1e-3, -1e-3]),
        ("OPENCV_FISHEYE", vec![290.0, 290.0, 320.0, 240.0, 0.003, 0.0007, -0.002, 0.0002]),
    ] {
        let camera = CameraModel::from_colmap(name, &parameters).unwrap();
        let view = UndistortedView::new(&camera, FRAME).unwrap();
        let Frame { width, height } = view.frame();
        assert!(
            width > 400 && height > 300 && width * height <= 2 * 640 * 480 + 2 * 1400,
            "{name}: {width}×{height}"
        );
        let mut inside = 0;
        for (x, y) in [(5.0, 7.0), (320.0, 240.0), (600.0, 80.0), (100.0, 470.0)] {
            let original = Point::new(x, y);
            let place = view.undistorted_from_original(original).unwrap();
            let back = view.original_from_undistorted(place).unwrap();
            assert!((back - original).norm() < 1e-7, "{name}: {back}");
            inside += usize::from(view.frame().contains(place));
        }
        assert!(inside >= 1, "{name}: {inside}");
        let [a, b] =
            [0.0, 1.0].map(|x| view.undistorted_from_original(Point::new(319.5 + x, 239.5)).unwrap());
        assert!(((b - a).norm() - 1.0).abs() < 0.02, "{name}: {}", (b - a).norm());
        // Images of three points of a line in space lie on a line.
        let [p, q, r] = [-0.2, 0.1, 0.4].map(|t| {
            let pixel = camera.image_from_ray(&Vector3::new(t, 0.3 + 0.1 * t, 1.0)).unwrap();
            view.undistorted_from_original(pixel).unwrap().to_homogeneous()
        });
        assert!(p.cross(&q).normalize().dot(&r).abs() < 1e-7, "{name}");
    }
    let ideal = CameraModel::from_colmap("PINHOLE", &[500.0, 510.0, 320.0, 240.0]).unwrap();
    let view = UndistortedView::new(&ideal, FRAME).unwrap();
    assert!(view.is_original() && view.frame() == FRAME);
}

/// Two views of random points, with noise in image 2.
fn scene(seed: u64, noise: f64) -> (RelativePose, [Matrix3<f64>; 2], Vec<PointPair>) {
    let calibrations = [calibration([600.0; 2], [320.0, 240.0]), calibration([650.0, 640.0], [310.0, 250.0])];
    let (pose, matches) = seen_by(&calibrations, seed, noise);
    (pose, calibrations, matches)
}

/// A pose, and matches in pictures with these calibration matrices.
fn seen_by(calibrations: &[Matrix3<f64>; 2], seed: u64, noise: f64) -> (RelativePose, Vec<PointPair>) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut number = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    let rotation = Rotation3::from_euler_angles(number(-0.2, 0.2), number(-0.3, 0.3), number(-0.5, 0.5));
    let translation = Vector3::new(number(-1.0, 1.0), number(-0.5, 0.5), number(-0.5, 0.5)).normalize();
    let pose = RelativePose { rotation, translation };
    let mut matches = Vec::new();
    while matches.len() < 300 {
        let x = Vector3::new(number(-4.0, 4.0), number(-3.0, 3.0), number(4.0, 9.0));
        let pixels = [calibrations[0] * x, calibrations[1] * (rotation * x + translation)];
        let [p, q] = pixels.map(|h| Point::new(h.x / h.z, h.y / h.z));
        if pixels[1].z > 0.0 && FRAME.contains(p) && FRAME.contains(q) {
            // Sum of uniform numbers: standard deviation 1.
            let mut gauss = || (0..12).map(|_| number(0.0, 1.0)).sum::<f64>() - 6.0;
            matches.push(PointPair::new(p.x, p.y, q.x + noise * gauss(), q.y + noise * gauss()));
        }
    }
    (pose, matches)
}

#[test]
fn a_pose_by_guessed_focal_lengths_is_as_uncertain_as_they_are() {
    let camera =
        |pixels, deviation| CameraModel::of_focal_length(FocalLength { pixels, deviation }, FRAME).unwrap();
    let trials = 40;
    let (mut guessed, mut exact) = (0, 0);
    for seed in 0..trials {
        let truth = [camera(600.0, 0.0), camera(500.0, 0.0)];
        let (pose, matches) = seen_by(&truth.each_ref().map(CameraModel::calibration), 200 + seed, 0.3);
        let views = |cameras: [CameraModel; 2]| ViewPair::new(cameras.each_ref(), [FRAME; 2]).unwrap();
        let f = pose.fundamental(&views(truth).calibrations()).unwrap();
        let significant = |cameras| {
            let fit = views(cameras).fit_pose(&f, &matches).unwrap();
            usize::from(fit.difference(&pose).unwrap().is_significant)
        };
        // Both are off by one deviation.
        guessed += significant([camera(630.0, 0.05), camera(475.0, 0.05)]);
        exact += significant([camera(630.0, 0.0), camera(475.0, 0.0)]);
    }
    assert!(guessed == 0 && exact > trials as usize / 2, "{guessed} {exact}");
    // Equal guesses are off alike, so their effects add up.
    let (pose, matches) = seen_by(&[camera(600.0, 0.0).calibration(); 2], 1, 0.3);
    let rotation = |cameras: [CameraModel; 2]| {
        let views = ViewPair::new(cameras.each_ref(), [FRAME; 2]).unwrap();
        let f = pose.fundamental(&views.calibrations()).unwrap();
        views.fit_pose(&f, &matches).unwrap().uncertainty.unwrap().rotation
    };
    let [same, known] = [0.05, 0.0].map(|deviation| rotation([camera(600.0, deviation); 2]));
    assert!(same > known, "{same} {known}");
    assert!(CameraModel::of_focal_length(FocalLength { pixels: 600.0, deviation: 1.0 }, FRAME).is_none());
    assert!(CameraModel::of_focal_length(FocalLength { pixels: -1.0, deviation: 0.0 }, FRAME).is_none());
}

#[test]
fn a_pose_is_found_from_its_fundamental_matrix_with_the_right_sign() {
    for seed in 0..20 {
        let (pose, calibrations, matches) = scene(seed, 0.0);
        let f = pose.fundamental(&calibrations).unwrap();
        assert!(matches.iter().all(|pair| sampson_distance(&f, pair) < 1e-9));
        let found = RelativePose::from_fundamental(&f, &calibrations, &matches).unwrap();
        assert!((found.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-7, "{seed}");
        assert!((found.translation - pose.translation).norm() < 1e-7, "{seed}");
        let inverses = calibrations.map(|k| k.try_inverse().unwrap());
        let PointPair { point1, point2 } = matches[0];
        let rays = [inverses[0] * point1.to_homogeneous(), inverses[1] * point2.to_homogeneous()];
        let x = found.triangulated(&rays).unwrap();
        let pixel = calibrations[0] * x;
        assert!(x.z > 0.0 && (Point::new(pixel.x / pixel.z, pixel.y / pixel.z) - point1).norm() < 1e-6);
    }
}

#[test]
fn the_fit_is_at_least_as_precise_as_its_deviations_say() {
    let (mut rotation_inside, mut translation_inside, mut significant) = (0, 0, 0);
    let trials = 60;
    for seed in 0..trials {
        let (pose, calibrations, matches) = scene(100 + seed, 0.5);
        // The start is a perturbed pose.
        let turned = Rotation3::from_scaled_axis(Vector3::new(0.01, -0.01, 0.02)) * pose.rotation;
        let start = RelativePose { rotation: turned, ..pose }.fundamental(&calibrations).unwrap();
        let fit = fit_pose(&start, &calibrations, &matches, FRAME).unwrap();
        assert!(fit.in_front >= 299 && fit.noise > 0.1 && fit.noise < 0.4, "{fit:?}");
        assert!(fit.parallax > 0.02 && fit.parallax < 0.4, "{}", fit.parallax.to_degrees());
        let uncertainty = fit.uncertainty.unwrap();
        let off = fit.pose.rotation.angle_to(&pose.rotation);
        assert!(off < 0.01, "{seed}: {off}");
        // 95 % of one direction are within 2 deviations; here three and two directions count.
        rotation_inside += usize::from(off < 2.0 * 3.0_f64.sqrt() * uncertainty.rotation);
        let off = fit.pose.translation.angle(&pose.translation);
        translation_inside += usize::from(off < 2.0 * 2.0_f64.sqrt() * uncertainty.translation);
        significant += usize::from(fit.difference(&pose).unwrap().is_significant);
    }
    // The noise is independent here, and is taken as shared within regions.
    assert!(rotation_inside >= 58 && translation_inside >= 58, "{rotation_inside} {translation_inside}");
    assert!(significant <= 3, "{significant} of {trials}");
    let (pose, calibrations, matches) = scene(3, 0.5);
    let fit = fit_pose(&pose.fundamental(&calibrations).unwrap(), &calibrations, &matches, FRAME).unwrap();
    // The covariance of the entries has the deviations, and t keeps its length.
    let (covariance, uncertainty) = (fit.covariance().unwrap(), fit.uncertainty.unwrap());
    let across: Matrix3<f64> = covariance.fixed_view::<3, 3>(3, 3).into();
    assert!((covariance.columns(3, 3) * fit.pose.translation).norm() < 1e-12 * covariance.norm());
    assert!((across.symmetric_eigenvalues().max().sqrt() / uncertainty.translation - 1.0).abs() < 1e-9);
    let turned = Rotation3::from_scaled_axis(Vector3::new(0.0, 0.1, 0.0)) * pose.rotation;
    let difference = fit.difference(&RelativePose { rotation: turned, ..pose }).unwrap();
    assert!(difference.is_significant && (difference.rotation - 0.1).abs() < 0.01, "{difference:?}");
}

#[test]
fn outliers_do_not_move_a_pose_and_few_matches_give_none() {
    let (pose, calibrations, mut matches) = scene(7, 0.2);
    for (k, pair) in matches.iter_mut().take(40).enumerate() {
        pair.point2.y += 20.0 + k as f64;
    }
    let start = pose.fundamental(&calibrations).unwrap();
    let fit = fit_pose(&start, &calibrations, &matches, FRAME).unwrap();
    assert!(fit.pose.rotation.angle_to(&pose.rotation) < 2e-3);
    assert!(fit.pose.translation.angle(&pose.translation) < 2e-2);
    assert!(fit_pose(&start, &calibrations, &matches[..9], FRAME).is_none());
    let rows = crate::geometry::random_scene::rows(0.0);
    assert!(fit_pose(&rows, &calibrations, &matches, FRAME).is_some(), "a poor start is no panic");
}

#[test]
fn distortion_without_a_focal_length_takes_one_later_and_leaves_the_view() {
    let bent = CameraModel::of_division(-0.2, FRAME).unwrap();
    assert_eq!(bent.focal_deviation(), None);
    let view = UndistortedView::new(&bent, FRAME).unwrap();
    // λ belongs to half diagonals: a corner lies at 1 / (1 − 0.2) of its distance from the middle.
    let corner = Point::new(FRAME.right(), FRAME.bottom());
    let middle = view.undistorted_from_original(FRAME.centre()).unwrap();
    let moved = view.undistorted_from_original(corner).unwrap() - middle;
    let expected = (corner - FRAME.centre()).norm()
        / (1.0 - 0.2 * ((corner - FRAME.centre()).norm() / (0.5 * FRAME.diagonal())).powi(2));
    assert!((moved.norm() - expected).abs() < 1e-6, "{} {expected}", moved.norm());
    let focal = FocalLength { pixels: 700.0, deviation: 0.05 };
    let known = view.with_focal_length(focal).unwrap();
    assert!((known.camera().calibration()[(0, 0)] - 700.0).abs() < 1e-9);
    assert_eq!((known.camera().focal_deviation(), known.frame()), (Some(0.05), view.frame()));
    assert!((known.camera().division(FRAME).unwrap() + 0.2).abs() < 1e-12);
    for pixel in [corner, Point::new(30.0, 400.0), Point::new(500.0, 20.0)] {
        let [before, after] = [&view, &known].map(|view| view.undistorted_from_original(pixel).unwrap());
        assert!((before - after).norm() < 1e-8, "{before} {after}");
    }
    // A pose needs the focal lengths.
    let (_, _, matches) = scene(1, 0.1);
    let pair = |view: UndistortedView| ViewPair { views: [view; 2] };
    let f = crate::geometry::eight_point(&matches).unwrap();
    assert!(!pair(view).has_focal_lengths() && pair(view).fit_pose(&f, &matches).is_none());
    assert!(pair(known).has_focal_lengths());
    for impossible in [f64::NAN, -1.5] {
        assert!(CameraModel::of_division(impossible, FRAME).is_none());
    }
    let calibrated = CameraModel::from_colmap("SIMPLE_RADIAL", &[500.0, 320.0, 240.0, -0.1]).unwrap();
    assert!(calibrated.with_focal_length(focal).is_none(), "its calibration tells the focal length");
    for camera in [bent, *known.camera()] {
        let written = serde_json::to_string(&camera).unwrap();
        assert_eq!(serde_json::from_str::<CameraModel>(&written).unwrap(), camera, "{written}");
    }
}
