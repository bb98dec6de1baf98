//! Commands with a calibration, on the built-in pair seen through a lens.

use epiline::camera::{CameraModel, Lens, UndistortedView};
use epiline::geometry::{FundamentalMatrix, Point, PointPair, finite_point, sampson_distance};
use epiline::io::GeometryFile;
use epiline::synthetic::Sample;
use nalgebra::{Matrix3, Rotation3};

use super::*;

/// The built-in pair through a lens, in a folder.
struct LensPair {
    pictures: Pictures,
    camera: CameraModel,
    clicks: Vec<PointPair>,
    matches: Vec<PointPair>,
}

const FOCAL: f64 = 700.0;
const DISTORTION: f64 = -0.15;

impl LensPair {
    fn new() -> Self {
        let pictures = Pictures::new();
        let sample = Sample::default().load();
        let frame = sample.pictures[0].frame();
        let (x, y) = (frame.centre().x, frame.centre().y);
        // The centre of the top-left pixel is (0.5, 0.5) in COLMAP.
        let parameters = [FOCAL, x + 0.5, y + 0.5, DISTORTION];
        let camera = CameraModel::from_colmap("SIMPLE_RADIAL", &parameters).unwrap();
        let pinhole = CameraModel::new(&camera.calibration(), Lens::IDEAL).unwrap();
        for (name, picture) in ["near.png", "far.png"].iter().zip(&sample.pictures) {
            let drawn = picture.redrawn(frame, |p| pinhole.image_from_ray(&camera.ray_from_image(p)?));
            drawn.pixels.save(pictures.path(name)).unwrap();
        }
        let (width, height) = (frame.width, frame.height);
        let text = format!("1 SIMPLE_RADIAL {width} {height} {FOCAL} {} {} {DISTORTION}\n", x + 0.5, y + 0.5);
        pictures.write("cameras.txt", &text);
        let bent = |p: Point| camera.image_from_ray(&pinhole.ray_from_image(p)?);
        let pair = |m: &PointPair| Some(PointPair { point1: bent(m.point1)?, point2: bent(m.point2)? });
        let clicks = sample.show_me.iter().filter_map(pair).collect();
        let matches = sample.matches.iter().filter_map(pair).collect();
        Self { pictures, camera, clicks, matches }
    }

    fn command<'a>(&self, name: &'a str, rest: &[&'a str]) -> Output {
        let [near, far, cameras] =
            ["near.png", "far.png", "cameras.txt"].map(|name| self.pictures.text(name));
        let start = [name, &near, &far, "--calibration", &cameras];
        run(&[&start[..], rest].concat())
    }

    fn result(&self, name: &str, rest: &[&str]) -> Value {
        let json = self.pictures.text(name);
        let output = self.command("estimate", &[rest, &["--json", &json]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap()
    }

    /// Median distance of the true matches from the lines of a result between views, px.
    fn error(&self, result: &Value) -> f64 {
        self.error_through(&self.camera, result)
    }

    /// The same for the views of another camera.
    fn error_through(&self, camera: &CameraModel, result: &Value) -> f64 {
        let frame = epiline::image::Picture::open(&self.pictures.path("near.png")).unwrap().frame();
        let view = UndistortedView::new(camera, frame).unwrap();
        let entry = |r: usize, c: usize| result["fundamental"][r][c].as_f64().unwrap();
        let f = FundamentalMatrix::from_rank_two(Matrix3::from_fn(entry)).unwrap();
        let flat = |p: Point| view.undistorted_from_original(p).unwrap();
        let mut distances: Vec<f64> = self
            .matches
            .iter()
            .map(|m| sampson_distance(&f, &PointPair { point1: flat(m.point1), point2: flat(m.point2) }))
            .collect();
        distances.sort_by(f64::total_cmp);
        distances[distances.len() / 2]
    }
}

#[test]
fn clicks_in_bent_pictures_give_the_geometry_of_straight_ones_and_a_pose() {
    let lens = LensPair::new();
    let words: Vec<String> = lens
        .clicks
        .iter()
        .flat_map(|m| {
            let PointPair { point1: p, point2: q } = m;
            ["--pair".to_owned(), format!("{},{},{},{}", p.x, p.y, q.x, q.y)]
        })
        .collect();
    let clicks: Vec<&str> = words.iter().map(String::as_str).collect();
    for rest in [&clicks[..], &[]] {
        let result = lens.result("result.json", rest);
        let error = lens.error(&result);
        assert!(error < 0.2, "{error} px");
        assert_eq!(result["verdict"], "reliable");
        let pose = &result["calibrated"]["pose"];
        // One match in a thousand may be wrong.
        let [in_front, all] = ["in_front", "matches"].map(|name| pose[name].as_u64().unwrap());
        assert!(1000 * in_front >= 999 * all, "{in_front} of {all}");
        let view = &result["calibrated"]["views"][0];
        assert_eq!((&view["is_original"], &view["original_matrix"][0][0]), (&false.into(), &FOCAL.into()));
        let distances = result["calibrated"]["curve_distances"].as_array().unwrap();
        let mut distances: Vec<f64> = distances.iter().map(|d| d.as_f64().unwrap()).collect();
        distances.sort_by(f64::total_cmp);
        assert!(distances[distances.len() / 2] < 0.2);
    }
    // The matches of the result, given as matches, are those of the pictures with distortion.
    let output = lens.command("estimate", &["--matches", &lens.pictures.text("result.json")]);
    let words = text(&output.stdout);
    let given = words.split("Given matches: ").nth(1).unwrap();
    let counts: Vec<usize> = given.split(' ').filter_map(|word| word.parse().ok()).take(2).collect();
    assert!(counts[0] * 20 > counts[1] * 19, "{given}");
    // The covariances of F and of the pose leave together.
    let (result, archive) = (lens.pictures.text("result.json"), lens.pictures.text("result.npz"));
    assert!(run(&["convert", &result, "--output", &archive]).status.success());
    let archive = std::fs::read(archive).unwrap();
    for name in ["fundamental", "covariance", "rotation", "translation", "pose_covariance"] {
        let entry = format!("{name}.npy");
        assert!(archive.windows(entry.len()).any(|part| part == entry.as_bytes()), "{name}");
    }
    // Without the calibration the lines bend away.
    let [near, far] = ["near.png", "far.png"].map(|name| lens.pictures.text(name));
    let output = run(&["estimate", &near, &far]);
    let summary = text(&output.stdout);
    assert!(!summary.contains("Relative pose"), "{summary}");
    // A focal length alone gives a pose.
    let typed = run(&["estimate", &near, &far, "--focal-length", "700"]);
    let typed = text(&typed.stdout);
    assert!(typed.contains("Relative pose") && !typed.contains("guessed"), "{typed}");
    fails(&["estimate", &near, &far, "--focal-length", "exif"], 2, "do not tell its focal length");
    fails(&["estimate", &near, &far, "--focal-length", "0"], 2, "a positive number of pixels, or exif");
    // The result says that it belongs to other pictures.
    let result = lens.pictures.text("result.json");
    let folder = lens.pictures.text("rectified");
    fails(&["rectify", &near, &far, "--fundamental", &result, "--output", &folder], 2, "--calibration");
    let output = lens.command("rectify", &["--fundamental", &result, "--output", &folder, "--maps"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("Row error of"), "{}", text(&output.stdout));
    let described = std::fs::read(Path::new(&folder).join("rectification.json")).unwrap();
    let described: Value = serde_json::from_slice(&described).unwrap();
    assert_eq!(described["pictures"], "undistorted");
    assert_eq!(described["views"][1]["coefficients"][0], DISTORTION);
}

#[test]
fn a_geometry_of_a_lens_goes_nowhere_without_the_lens() {
    let lens = LensPair::new();
    let [near, far, json, yaml, array, flat] =
        ["near.png", "far.png", "result.json", "result.yml", "F.npy", "flat"]
            .map(|name| lens.pictures.text(name));
    let result = lens.result("result.json", &["--export", &yaml, "--undistorted", &flat]);
    assert_eq!((&result["pictures"], &result["geometry"]), (&"undistorted".into(), &"result".into()));
    // Other formats carry the lens on, and an array is refused.
    let (exported, _) = GeometryFile::read(Path::new(&yaml)).unwrap();
    let again = lens.pictures.text("again.txt");
    assert!(run(&["convert", &yaml, "--output", &again]).status.success());
    let (converted, _) = GeometryFile::read(Path::new(&again)).unwrap();
    assert_eq!(converted.pictures, exported.pictures);
    let (views, f) = (converted.pictures.views().unwrap(), converted.fundamental.unwrap());
    let placed = lens.matches.iter().map(|pair| views.undistorted_from_original(pair).unwrap());
    let mut distances: Vec<f64> = placed.map(|pair| sampson_distance(&f, &pair)).collect();
    distances.sort_by(f64::total_cmp);
    assert!(distances[distances.len() / 2] < 0.2, "{distances:?}");
    fails(&["convert", &json, "--output", &array], 2, "no room for their lens");
    // Pictures with distortion refuse it, and name the lens.
    let named = "lens model opencv k1 -0.15";
    fails(&["judge", &near, &far, "--fundamental", &yaml], 2, named);
    fails(&["suggest", &near, &far, "--at", "100,100", "--fundamental", &json], 2, named);
    let folder = lens.pictures.text("rectified");
    fails(&["rectify", &near, &far, "--fundamental", &yaml, "--output", &folder], 2, named);
    let other = std::fs::read_to_string(lens.pictures.path("cameras.txt")).unwrap();
    lens.pictures.write("other.txt", &other.replace("-0.15", "-0.1"));
    let other = lens.pictures.text("other.txt");
    let rectify = ["rectify", &near, &far, "--output", &folder, "--calibration"];
    fails(&[&rectify[..], &[&other, "--fundamental", &json]].concat(), 2, "made with another lens");
    let changed =
        std::fs::read_to_string(&yaml).unwrap().replace("pictures: undistorted", "pictures: original");
    lens.pictures.write("original.yml", &changed);
    let (original, cameras) = (lens.pictures.text("original.yml"), lens.pictures.text("cameras.txt"));
    fails(
        &[&rectify[..], &[&cameras, "--fundamental", &original]].concat(),
        2,
        "belongs to the pictures as they are",
    );
    // The drawn pictures take their geometry as it is.
    let [left, right, geometry] =
        ["left.png", "right.png", "geometry.json"].map(|name| format!("{flat}/{name}"));
    let output = run(&["judge", &left, &right, "--fundamental", &geometry]);
    assert!(output.status.success(), "{}", text_of(&output));
    fails(&["estimate", &near, &far, "--undistorted", &flat], 2, "no distortion to remove");
}

fn text_of(output: &Output) -> String {
    format!("{}{}", text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_stereo_calibration_is_judged_and_a_wrong_lens_is_found() {
    let lens = LensPair::new();
    let result = lens.result("result.json", &[]);
    let pose = &result["calibrated"]["pose"];
    let k = &result["calibrated"]["views"][0]["original_matrix"];
    let stereo = |distortion: f64| {
        serde_json::json!({
            "K1": k, "K2": k, "D1": [distortion, 0, 0, 0], "D2": [DISTORTION, 0, 0, 0],
            "R": pose["rotation"], "T": pose["translation"],
        })
    };
    lens.pictures.write("right.json", &stereo(DISTORTION).to_string());
    lens.pictures.write("wrong.json", &stereo(-DISTORTION).to_string());
    let [near, far] = ["near.png", "far.png"].map(|name| lens.pictures.text(name));
    for (name, status) in [("right.json", 0), ("wrong.json", 1)] {
        let output = run(&["judge", &near, &far, "--calibration", &lens.pictures.text(name)]);
        assert_eq!(output.status.code(), Some(status), "{name}: {}", text(&output.stdout));
        if status == 0 {
            assert!(text(&output.stdout).contains("which may be chance"), "{}", text(&output.stdout));
        }
    }
    let right = lens.pictures.text("right.json");
    let exchanged = run(&["judge", &far, &near, "--calibration", &right]);
    assert_eq!(exchanged.status.code(), Some(1), "{}", text(&exchanged.stdout));
    let mut negated = stereo(DISTORTION);
    for k in 0..3 {
        negated["T"][k] = (-negated["T"][k].as_f64().unwrap()).into();
    }
    lens.pictures.write("negated.json", &negated.to_string());
    let output = run(&["judge", &near, &far, "--calibration", &lens.pictures.text("negated.json")]);
    let words = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("behind both cameras") && words.contains("F stays the same"), "{words}");
    let single = lens.pictures.text("cameras.txt");
    fails(&["judge", &near, &far, "--calibration", &single], 2, "does not tell where the second camera is");
    let small = lens.pictures.text("left.png");
    fails(&["estimate", &small, &far, "--calibration", &single], 2, "is for images of");
    let right = lens.pictures.text("right.json");
    fails(
        &["estimate", &near, &far, "--calibration", &right, "--camera-names", "a", "b"],
        2,
        "there is no camera a",
    );
    fails(&["estimate", &near, &far, "--calibration", &near], 2, "not a text file");
}

#[test]
fn a_turned_camera_has_no_pose_to_judge_or_to_export() {
    let pictures = Pictures::new();
    let sample = Sample::default().load();
    let frame = sample.pictures[0].frame();
    let k = Matrix3::new(FOCAL, 0.0, frame.centre().x, 0.0, FOCAL, frame.centre().y, 0.0, 0.0, 1.0);
    let turn = Rotation3::from_euler_angles(0.0, 0.06, 0.01);
    let back = k * turn.inverse() * k.try_inverse().unwrap();
    let turned = sample.pictures[0].redrawn(frame, |p| finite_point(&(back * p.to_homogeneous())));
    sample.pictures[0].pixels.save(pictures.path("near.png")).unwrap();
    turned.pixels.save(pictures.path("far.png")).unwrap();
    let rows = |m: &Matrix3<f64>| [0, 1, 2].map(|r| [m[(r, 0)], m[(r, 1)], m[(r, 2)]]);
    let (k, turn) = (rows(&k), rows(turn.matrix()));
    let stereo = serde_json::json!({ "K1": k, "K2": k, "D1": [0, 0, 0, 0], "D2": [0, 0, 0, 0], "R": turn, "T": [1.0, 0.0, 0.0] });
    pictures.write("stereo.json", &stereo.to_string());
    let [near, far, calibration, cloud, json] =
        ["near.png", "far.png", "stereo.json", "cloud.ply", "f.json"].map(|name| pictures.text(name));
    let judged = run(&["judge", &near, &far, "--calibration", &calibration]);
    let words = text(&judged.stdout);
    assert!(words.contains("The pose cannot be judged. The epipole is not determined"), "{words}");
    let estimate = ["estimate", &near, &far, "--calibration", &calibration, "--export"];
    let output = run(&[&estimate[..], &[&cloud]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("Verdict: "), "the result is printed");
    assert!(text(&output.stderr).contains("Export F instead"), "{}", text(&output.stderr));
    assert!(!Path::new(&cloud).exists());
    assert!(run(&[&estimate[..], &[&json]].concat()).status.success());
    let exported: Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
    assert!(exported["fundamental"].is_array() && exported["camera1"].is_null(), "{exported}");
}

#[test]
fn pairs_for_stereo_programs_have_their_calibration() {
    let lens = LensPair::new();
    lens.result("result.json", &[]);
    let result = lens.pictures.text("result.json");
    for (program, file) in
        [("opencv", "stereo.yml"), ("raft-stereo", "calib.txt"), ("foundation-stereo", "K.txt")]
    {
        let folder = lens.pictures.text(program);
        let output =
            lens.command("rectify", &["--fundamental", &result, "--for", program, "--output", &folder]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let written = std::fs::read_to_string(Path::new(&folder).join(file)).unwrap();
        let left = if program == "raft-stereo" { "im0.png" } else { "left.png" };
        let left = image::open(Path::new(&folder).join(left)).unwrap();
        assert_eq!(left.color(), image::ColorType::Rgb8);
        match program {
            "opencv" => assert!(written.contains("Q: !!opencv-matrix"), "{written}"),
            "raft-stereo" => assert!(written.contains(&format!("width={}", left.width())), "{written}"),
            _ => {
                let numbers: Vec<f64> = written.split_whitespace().map(|n| n.parse().unwrap()).collect();
                assert_eq!(numbers.len(), 10);
                // The focal length is kept.
                assert!((numbers[0] - FOCAL).abs() < 1e-6 && numbers[9].to_bits() == 1.0f64.to_bits());
            }
        }
    }
    let cameras = lens.pictures.text("cameras.txt");
    let [near, far] = ["near.png", "far.png"].map(|name| lens.pictures.text(name));
    let folder = lens.pictures.text("none");
    fails(
        &["rectify", &near, &far, "--calibration", &cameras, "--for", "opencv", "--output", &folder],
        2,
        "does not tell where the second camera is",
    );
}

#[test]
fn matches_of_another_program_are_measured_and_bad_ones_are_not_used() {
    let pictures = Pictures::new();
    let sample = Sample::default().load();
    let rows: Vec<String> = sample
        .matches
        .iter()
        .map(|m| format!("{} {} {} {}", m.point1.x, m.point1.y, m.point2.x, m.point2.y))
        .collect();
    pictures.write("true.txt", &rows.join("\n"));
    let given = pictures.text("true.txt");
    let output = run(&["estimate", "--sample", "courtyard", "--matches", &given]);
    let words = text(&output.stdout);
    assert!(output.status.success() && words.contains("Given matches: "), "{words}");
    let options = ["--set", "seed=7", "--json", "-"];
    let json = run(&[&["estimate", "--sample", "courtyard", "--matches", &given][..], &options].concat());
    let result: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(result["seed"], 7);
    assert_eq!(result["given_matches"].as_array().unwrap().len(), sample.matches.len());
    pictures.write("few.txt", "1 2 3 4\n5 6 7 8\n");
    let output = run(&["estimate", "--sample", "courtyard", "--matches", &pictures.text("few.txt")]);
    assert!(output.status.success() && text(&output.stderr).contains("the matches are not used"));
}

#[test]
fn a_lens_without_a_calibration_is_fitted_to_the_matches() {
    let lens = LensPair::new();
    let [near, far, json] = ["near.png", "far.png", "fitted.json"].map(|name| lens.pictures.text(name));
    let output = run(&["estimate", &near, &far, "--division", "auto", "--json", &json]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("it moves the corners by"));
    let result: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let view = &result["calibrated"]["views"][0];
    let lambda = view["lens"]["radial"]["division"]["lambda"].as_f64().unwrap();
    let frame = epiline::image::Picture::open(&lens.pictures.path("near.png")).unwrap().frame();
    let fitted = CameraModel::of_division(lambda, frame).unwrap();
    let error = lens.error_through(&fitted, &result);
    assert!(error < 0.3, "λ {lambda}: {error} px");
    // No focal length, no pose.
    assert!(result["calibrated"]["pose"].is_null() && view["focal_deviation"].is_null());
    // The result is rectified with the same coefficient, which cannot be fitted there.
    let folder = lens.pictures.text("rectified");
    let rectify = ["rectify", &near, &far, "--fundamental", &json, "--output", &folder];
    fails(&rectify, 2, "--division");
    fails(&[&rectify[..], &["--division", "auto"]].concat(), 2, "epiline estimate --division auto");
    let coefficient = lambda.to_string();
    for matches in [&[][..], &["--matches", &json]] {
        let output = run(&[&rectify[..], &["--division", &coefficient], matches].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let words = text(&output.stdout);
        let error = words.split(" matches: ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        assert!(error.parse::<f64>().unwrap() < 0.5, "{words}");
    }
    // Its lines do not fit the pictures with distortion.
    let suggested = run(&["suggest", &near, &far, "--at", "300,250", "--fundamental", &json]);
    let told = text(&suggested.stderr);
    assert!(told.contains("fitted.json belongs to pictures without distortion"), "{told}");
    fails(&["estimate", &near, &far, "--division", "7"], 2, "a number from -0.9 to 0.9, or auto");
    // Without distortion there is nothing to fit.
    let straight = run(&["estimate", "--sample", "courtyard", "--division", "auto"]);
    let told = text(&straight.stderr);
    assert!(told.contains("no lens distortion fits the matches clearly better"), "{told}");
    assert!(!text(&straight.stdout).contains("without distortion"));
}
