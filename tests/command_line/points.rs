//! Matches without images, geometries of calibrations, essential matrices, and sizes of calibrations.

use epiline::geometry::{FundamentalMatrix, PointPair, sampson_distance};
use epiline::synthetic::Sample;
use nalgebra::Matrix3;

use super::*;

/// Writes every k-th true match of the built-in pair.
fn matches(pictures: &Pictures, every: usize) -> Vec<PointPair> {
    let pairs: Vec<PointPair> = Sample::default().load().matches.into_iter().step_by(every).collect();
    write(pictures, &pairs);
    pairs
}

fn write(pictures: &Pictures, pairs: &[PointPair]) {
    let row = |pair: &PointPair| pair.numbers().map(|v| format!("{v:.3}")).join(" ");
    pictures.write("matches.txt", &pairs.iter().map(row).collect::<Vec<_>>().join("\n"));
}

fn found(pictures: &Pictures, rest: &[&str]) -> Value {
    let file = pictures.text("matches.txt");
    let output = run(&[&["estimate", "--matches", &file, "--json", "-"], rest].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn fundamental(value: &Value) -> FundamentalMatrix {
    serde_json::from_value(value["fundamental"].clone()).unwrap()
}

#[test]
fn matches_alone_give_f_with_its_precision_and_the_limits_of_the_claim() {
    let pictures = Pictures::new();
    let pairs = matches(&pictures, 10);
    let result = found(&pictures, &[]);
    let f = fundamental(&result);
    assert!(pairs.iter().all(|pair| sampson_distance(&f, pair) < 0.5));
    assert_eq!(
        (&result["verdict"], &result["failed_tests"][0]["kind"]),
        (&"doubtful".into(), &"points-alone".into())
    );
    assert!(result["covariance"].is_array() && result["extents"].is_array() && result["images"].is_null());
    assert_eq!(result["given_probabilities"].as_array().unwrap().len(), pairs.len());
    let sized = found(&pictures, &["--sizes", "768x576"]);
    assert_eq!((&sized["images"][1]["width"], &sized["extents"]), (&768.into(), &Value::Null));
    // The result is a geometry file.
    pictures.write("result.json", &sized.to_string());
    let output = run(&["convert", &pictures.text("result.json"), "--output", "-", "--format", "text"]);
    assert!(output.status.success() && text(&output.stdout).contains("\nF\n"), "{}", text(&output.stderr));
}

#[test]
fn eleven_matches_are_enough_and_seven_are_not() {
    let pictures = Pictures::new();
    let all = Sample::default().load().matches;
    let some = |count: usize| {
        let pairs: Vec<PointPair> = all.iter().step_by(all.len() / count).take(count).copied().collect();
        write(&pictures, &pairs);
    };
    some(11);
    assert_eq!(found(&pictures, &[])["verdict"], "doubtful");
    let file = pictures.text("matches.txt");
    some(7);
    fails(&["estimate", "--matches", &file], 2, "at least 8 different matches are needed, and there are 7");
    write(&pictures, &[all[0]; 12]);
    fails(&["estimate", "--matches", &file], 2, "there are 1");
    let on_line: Vec<PointPair> =
        (0..12).map(|k| PointPair::new(40.0 * f64::from(k), 10.0, 30.0 * f64::from(k), 9.0)).collect();
    write(&pictures, &on_line);
    fails(&["estimate", "--matches", &file], 2, "lie on one line");
}

#[test]
fn options_that_need_images_are_refused_without_them() {
    let pictures = Pictures::new();
    matches(&pictures, 20);
    let file = pictures.text("matches.txt");
    for (rest, told) in [
        (&["--pair", "1,2,3,4"][..], "--pair"),
        (&["--set", "seed=3"], "--set"),
        (&["--method", "lines"], "error"),
        (&["--division", "auto", "--sizes", "768x576"], "--division auto"),
        (&["--focal-length", "exif", "--sizes", "768x576"], "--focal-length exif"),
        (&["--focal-length", "800"], "--sizes WIDTHxHEIGHT"),
        (&["--sizes", "100x100"], "lies outside the left image"),
    ] {
        let words = [&["estimate", "--matches", &file], rest].concat();
        if told == "error" {
            assert_eq!(run(&words).status.code(), Some(2));
        } else {
            fails(&words, 2, told);
        }
    }
    let pair = [pictures.text("left.png"), pictures.text("right.png")];
    let sized = ["estimate", &pair[0], &pair[1], "--matches", &file, "--sizes", "160x120"];
    assert_eq!(run(&sized).status.code(), Some(2), "the images tell their sizes");
    assert_eq!(run(&["estimate"]).status.code(), Some(2));
}

/// A rig of two cameras with a pose, and a lens if `k1` is not 0.
fn rig(k1: f64) -> String {
    format!(
        "%YAML:1.0\n---\nK1: [[700, 0, 380], [0, 705, 290], [0, 0, 1]]\nD1: [{k1}, 0, 0, 0, 0]\n\
         K2: [[690, 0, 390], [0, 695, 280], [0, 0, 1]]\nD2: [{k1}, 0, 0, 0, 0]\n\
         R: [[0.9999500004166653, -0.009999833334166664, 0], [0.009999833334166664, 0.9999500004166653, 0], [0, 0, 1]]\n\
         T: [-0.12, 0.01, 0.005]\n"
    )
}

fn expected() -> FundamentalMatrix {
    let (c, s) = (0.01_f64.cos(), 0.01_f64.sin());
    let t = nalgebra::Vector3::new(-0.12, 0.01, 0.005);
    let essential = t.cross_matrix() * Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let k1 = Matrix3::new(700.0, 0.0, 380.0, 0.0, 705.0, 290.0, 0.0, 0.0, 1.0);
    let k2 = Matrix3::new(690.0, 0.0, 390.0, 0.0, 695.0, 280.0, 0.0, 0.0, 1.0);
    let f = k2.try_inverse().unwrap().transpose() * essential * k1.try_inverse().unwrap();
    FundamentalMatrix::from_rank_two(f).unwrap()
}

fn converted(pictures: &Pictures, files: &[&str]) -> (Value, String) {
    let output = run(&[&["convert"], files, &["--output", "-", "--format", "json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let _ = pictures;
    (serde_json::from_slice(&output.stdout).unwrap(), text(&output.stderr))
}

#[test]
fn a_calibration_with_a_pose_is_a_geometry() {
    let pictures = Pictures::new();
    let path = pictures.text("rig.yml");
    for (k1, undistorted) in [(0.0, false), (-0.2, true)] {
        pictures.write("rig.yml", &rig(k1));
        let (file, told) = converted(&pictures, &[&path]);
        assert!((fundamental(&file).matrix() - expected().matrix()).norm() < 1e-9);
        assert_eq!(file["pictures"] == "undistorted", undistorted);
        assert_eq!(told.contains("undistorted pictures"), undistorted, "{told}");
    }
    // Rectified cameras beside the calibration are not those of the pair.
    let rectified = "P1: [[690, 0, 385, 0], [0, 690, 285, 0], [0, 0, 1, 0]]\n\
                     P2: [[690, 0, 385, -83], [0, 690, 285, 0], [0, 0, 1, 0]]\n";
    pictures.write("rig.yml", &format!("{}{rectified}", rig(0.0)));
    let (file, told) = converted(&pictures, &[&path]);
    assert!((fundamental(&file).matrix() - expected().matrix()).norm() < 1e-9);
    assert!(told.contains("left out"), "{told}");
    pictures.write("rectified.yml", &format!("%YAML:1.0\n---\n{rectified}"));
    let (_, told) = converted(&pictures, &[&pictures.text("rectified.yml")]);
    assert!(told.contains("rectified pictures"), "{told}");
    // A matrix that contradicts the calibration.
    pictures.write("rig.yml", &format!("{}F: [[0, 0, 0], [0, 0, -1], [0, 1, 3]]\n", rig(0.0)));
    let (file, told) = converted(&pictures, &[&path]);
    assert!(told.contains("contradicts") && fundamental(&file).matrix()[(0, 0)].abs() < 1e-12, "{told}");
    let alone = rig(0.0).lines().filter(|line| !line.starts_with(['R', 'T'])).collect::<Vec<_>>().join("\n");
    pictures.write("rig.yml", &alone);
    fails(
        &["convert", &path, "--output", "-", "--format", "json"],
        2,
        "without the pose of the second camera",
    );
}

#[test]
fn an_essential_matrix_is_named_and_made_fundamental_by_a_calibration() {
    let pictures = Pictures::new();
    pictures.write("rig.yml", &rig(0.0));
    let (c, s) = (0.01_f64.cos(), 0.01_f64.sin());
    let t = nalgebra::Vector3::new(-0.12, 0.01, 0.005);
    let e = t.cross_matrix() * Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let rows = (0..3).map(|r| format!("{:e} {:e} {:e}", e[(r, 0)], e[(r, 1)], e[(r, 2)]));
    pictures.write("E.txt", &rows.collect::<Vec<_>>().join("\n"));
    let [e, calibration] = ["E.txt", "rig.yml"].map(|name| pictures.text(name));
    let (_, told) = converted(&pictures, &[&e]);
    assert!(told.contains("looks like an essential matrix"), "{told}");
    let (file, _) = converted(&pictures, &[&e, "--calibration", &calibration]);
    assert!((fundamental(&file).matrix() - expected().matrix()).norm() < 1e-9);
    let output = run(&["judge", "--sample", "--fundamental", &e]);
    assert!(text(&output.stderr).contains("essential"), "{}", text(&output.stderr));
}

#[test]
fn a_calibration_of_another_size_is_scaled_on_request() {
    let pictures = Pictures::new();
    matches(&pictures, 10);
    let of = |size: &str, focal: f64, cx: f64, cy: f64| {
        pictures.write("k.yml", &format!("%YAML:1.0\n---\n{size}K: [[{focal}, 0, {cx}], [0, {focal}, {cy}], [0, 0, 1]]\nD: [0, 0, 0, 0]\n"));
    };
    let [file, calibration] = ["matches.txt", "k.yml"].map(|name| pictures.text(name));
    let words = ["estimate", "--matches", &file, "--sizes", "768x576", "--calibration", &calibration];
    of("image_width: 1536\nimage_height: 1152\n", 1280.0, 767.5, 575.5);
    fails(&words, 2, "If the image was resized, use --scale-calibration");
    let pose = |rest: &[&str]| {
        let output = run(&[&words, rest, &["--json", "-"]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let scaled = pose(&["--scale-calibration"]);
    assert_eq!(scaled["warnings"], Value::Array(Vec::new()));
    of("", 1280.0, 767.5, 575.5);
    let told = pose(&[]);
    let warnings = told["warnings"].as_array().unwrap();
    let doubt = warnings.iter().find(|warning| warning["kind"] == "principal-point").unwrap();
    assert!((doubt["larger"].as_f64().unwrap() - 2.0).abs() < 1e-9);
    let again = pose(&["--scale-calibration=1536x1152"]);
    assert_eq!(again["calibrated"]["pose"]["rotation"], scaled["calibrated"]["pose"]["rotation"]);
    fails(&[&words[..], &["--scale-calibration"]].concat(), 2, "does not tell the size");
    of("image_width: 1000\nimage_height: 1000\n", 1280.0, 500.0, 500.0);
    fails(&[&words[..], &["--scale-calibration"]].concat(), 2, "differ in shape");
}
