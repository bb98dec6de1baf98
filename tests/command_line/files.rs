//! `epiline convert`, `epiline check` and `epiline estimate --export`.

use std::fmt::Write;

use super::*;

/// Names and extensions of the formats that are read and written.
const FORMATS: [(&str, &str); 3] = [("json", "json"), ("text", "txt"), ("opencv-yaml", "yml")];

/// Writes the cameras of a motion with rotation and exact matches to `p1.P`, `p2.P` and
/// `matches.csv`.
fn scene() -> Pictures {
    let pictures = Pictures::new();
    let first = [[700.0, 0.0, 320.0, 0.0], [0.0, 700.0, 240.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    // Rotation by 0.4 about the viewing axis, translation by (−1, 0.2, 0.3).
    let (sin, cos) = 0.4f64.sin_cos();
    let motion = [[cos, -sin, 0.0, -1.0], [sin, cos, 0.0, 0.2], [0.0, 0.0, 1.0, 0.3]];
    let second: [[f64; 4]; 3] =
        std::array::from_fn(|r| std::array::from_fn(|c| (0..3).map(|k| first[r][k] * motion[k][c]).sum()));
    let project = |p: &[[f64; 4]; 3], x: [f64; 4]| {
        let h: [f64; 3] = std::array::from_fn(|r| (0..4).map(|c| p[r][c] * x[c]).sum());
        [h[0] / h[2], h[1] / h[2]]
    };
    let mut matches = String::from("x1,y1,x2,y2\n");
    for k in 0..40 {
        let k = f64::from(k);
        let x = [(k * 0.7).sin() * 2.0, (k * 1.3).cos() * 1.5, 5.0 + 2.0 * (k * 0.31).sin(), 1.0];
        let (a, b) = (project(&first, x), project(&second, x));
        writeln!(matches, "{},{},{},{}", a[0], a[1], b[0], b[1]).unwrap();
    }
    pictures.write("matches.csv", &matches);
    let text = |p: &[[f64; 4]; 3]| {
        p.iter().map(|r| format!("{} {} {} {}", r[0], r[1], r[2], r[3])).collect::<Vec<_>>().join("\n")
    };
    pictures.write("p1.P", &text(&first));
    pictures.write("p2.P", &text(&second));
    pictures
}

#[track_caller]
fn succeeds(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Returns the largest difference between the numbers of two JSON values of equal structure.
fn difference(a: &Value, b: &Value) -> f64 {
    match (a, b) {
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter().zip(b).map(|(a, b)| difference(a, b)).fold(0.0, f64::max)
        }
        (Value::Number(a), Value::Number(b)) => (a.as_f64().unwrap() - b.as_f64().unwrap()).abs(),
        _ => f64::INFINITY,
    }
}

#[test]
fn every_format_leads_to_every_other_and_back() {
    let scene = scene();
    let (p1, p2, matches) = (scene.text("p1.P"), scene.text("p2.P"), scene.text("matches.csv"));
    let (left, right) = (scene.text("left.png"), scene.text("right.png"));
    let first = scene.text("first.json");
    let said = succeeds(&[
        "convert",
        &p1,
        &p2,
        "--matches",
        &matches,
        "--images",
        &left,
        &right,
        "--output",
        &first,
    ]);
    assert!(said.contains("F, two cameras, 40 point pairs") && said.contains("(JSON)"), "{said}");
    let start = json(&scene.path("first.json"));
    assert_eq!(start["images"][1], serde_json::json!({"name": "right.png", "width": 160, "height": 120}));
    assert!(start["self_check"]["max_distance"].as_f64().unwrap() < 1e-9);

    let mut last = first;
    for (name, extension) in FORMATS.into_iter().chain([("json", "again.json")]) {
        let next = scene.text(&format!("next.{extension}"));
        let said = succeeds(&["convert", &last, "-o", &next]);
        assert!(said.contains("40 point pairs"), "{name}: {said}");
        last = next;
    }
    let end = json(&scene.path("next.again.json"));
    assert!(difference(&start["fundamental"], &end["fundamental"]) < 1e-13, "{start} {end}");
    assert!(difference(&start["pairs"], &end["pairs"]) < 1e-10);
    assert_eq!(start["images"], end["images"]);
    // Every command that reads F reads every format.
    for (_, extension) in FORMATS {
        let f = scene.text(&format!("next.{extension}"));
        let output = run(&["suggest", &left, &right, "--at", "80,60", "--fundamental", &f]);
        assert_ne!(output.status.code(), Some(2), "{}", text(&output.stderr));
    }
}

#[test]
fn convert_prints_to_standard_output() {
    let scene = scene();
    let matches = scene.text("matches.csv");
    let output = run(&["convert", &matches, "--output", "-", "--format", "matlab"]);
    assert!(output.status.success());
    assert!(text(&output.stdout).contains("points1 = ["), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("40 point pairs"));
}

#[test]
fn check_says_as_read_and_finds_a_transposed_matrix() {
    let scene = scene();
    let (p1, p2, matches) = (scene.text("p1.P"), scene.text("p2.P"), scene.text("matches.csv"));
    let said = succeeds(&["check", &p1, &p2, "--matches", &matches]);
    assert!(said.contains("The geometry fits as read.") && said.contains("told apart"), "{said}");

    // The exchanged cameras are detected and corrected.
    let (fixed, found) = (scene.text("fixed.json"), scene.text("check.json"));
    let said = succeeds(&["check", &p2, &p1, "--matches", &matches, "--output", &fixed, "--json", &found]);
    assert!(
        said.contains("does not fit as read") && said.contains("left and right image exchanged"),
        "{said}"
    );
    let found = json(&scene.path("check.json"));
    assert_eq!((&found["fits"], &found["reading"]["transposed"]), (&true.into(), &true.into()));
    assert!(found["readings"].as_array().unwrap().len() > 10);
    let right = scene.text("right.json");
    succeeds(&["convert", &p1, &p2, "-o", &right]);
    let right = json(&scene.path("right.json"));
    assert!(difference(&json(&scene.path("fixed.json"))["fundamental"], &right["fundamental"]) < 1e-9);
    assert!(difference(&found["fundamental"], &right["fundamental"]) < 1e-9);
    // The file now contains its matches.
    assert!(succeeds(&["check", &fixed]).contains("fits as read"));
}

#[test]
fn check_knows_the_origin_of_the_format() {
    let scene = scene();
    let (p1, p2, matches) = (scene.text("p1.P"), scene.text("p2.P"), scene.text("matches.csv"));
    for (_, extension) in FORMATS {
        let file = scene.text(&format!("f.{extension}"));
        succeeds(&["convert", &p1, &p2, "--matches", &matches, "-o", &file]);
        assert!(succeeds(&["check", &file]).contains("The geometry fits as read."), "{extension}");
    }
    // Exact matches reveal numbers that count from 1 in a file that counts from 0.
    succeeds(&["convert", &p1, &p2, "-o", &scene.text("f.m")]);
    let array = scene.text("F.npy");
    let said = succeeds(&["convert", &p1, &p2, "-o", &array]);
    assert!(said.contains("(NumPy array of F)"), "{said}");
    let array = std::fs::read(array).unwrap();
    assert!(array.starts_with(b"\x93NUMPY") && array.len() == 128 + 72, "{} bytes", array.len());
    fails(&["check", &scene.text("f.m")], 2, "this is a MATLAB script, which is written but not read");
    let script = std::fs::read_to_string(scene.path("f.m")).unwrap();
    let f = script.lines().skip_while(|l| !l.starts_with("F = [")).take(5).collect::<Vec<_>>().join("\n");
    let text_file =
        f.replace("F = [", "").replace("];", "").replace([',', ';'], " ").replace("F_vgg = F'", "");
    scene.write("ones.txt", &text_file);
    let said = succeeds(&["check", &scene.text("ones.txt"), "--matches", &matches, "--all"]);
    assert!(said.contains("pixels counted from (1, 1). Half"), "{said}");
}

#[test]
fn check_reads_the_matches_of_matchers_and_tells_how() {
    let scene = scene();
    let (p1, p2) = (scene.text("p1.P"), scene.text("p2.P"));
    let matches = std::fs::read_to_string(scene.path("matches.csv")).unwrap();
    let numbers =
        |line: &str| line.split(',').map(|cell| cell.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    let rows: Vec<Vec<f64>> = matches.lines().filter_map(numbers).collect();
    let points = |k: usize| rows.iter().map(|row| row[k..k + 2].to_vec()).collect::<Vec<_>>();
    let (first, second) = (points(0), points(2));
    let arrays = format!(
        "{{\"inlier_kpts0\": {first:?}, \"inlier_kpts1\": {second:?}, \"mkpts0_f\": {first:?}, \"mkpts1_f\": {second:?}}}"
    );
    scene.write("arrays.json", &arrays);
    let table = |row: &Vec<f64>| format!("{} {} {} {} 1.0\n", row[0], row[1], row[2], row[3]);
    scene.write("table.txt", &rows.iter().map(table).collect::<String>());
    for (name, told) in [
        ("arrays.json", "mkpts0_f and mkpts1_f were read, inlier_kpts0 not"),
        ("table.txt", "of 5 columns the first four were read as x1 y1 x2 y2"),
    ] {
        let output = run(&["check", &p1, &p2, "--matches", &scene.text(name)]);
        let said = text(&output.stderr);
        assert!(output.status.success() && said.contains(told), "{said}");
    }
}

#[test]
fn check_has_a_status_for_nothing_fits_and_sentences_for_bad_input() {
    let scene = scene();
    let (p1, p2) = (scene.text("p1.P"), scene.text("p2.P"));
    let rows = |count: u64| {
        let number = |k: u64| (k.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) % 600;
        let row = |k: u64| (4 * k..4 * k + 4).map(|k| number(k).to_string()).collect::<Vec<_>>().join(" ");
        (0..count).map(row).collect::<Vec<_>>().join("\n")
    };
    scene.write("wrong.txt", &rows(50));
    scene.write("few.txt", &rows(7));
    let output =
        run(&["check", &p1, &p2, "--matches", &scene.text("wrong.txt"), "-o", &scene.text("never.json")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("error: No reading fits"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("median, px"));
    assert!(!scene.path("never.json").exists());

    let few = scene.text("few.txt");
    fails(&["check", &p1, &p2, "--matches", &few], 2, "at least 8 matches, 7 were given");
    fails(&["check", &p1, &p2], 2, "at least 8 matches, 0 were given");
    fails(&["check", &few], 2, "no fundamental matrix in it, nor two cameras");
    fails(&["check", &p1, &p1, "--matches", &scene.text("wrong.txt")], 2, "same centre");
    fails(&["convert", &few, "-o", &scene.text("out.png")], 2, "Add --format with one of json");
    fails(&["convert", &few, "-o", "-"], 2, "Add --format");
    fails(&["convert", &few, "-o", &scene.text("no/such/out.json")], 2, "there is no folder");
    fails(
        &["convert", &scene.text("words.txt"), "-o", &scene.text("out.json")],
        2,
        "words.txt: no fundamental matrix, cameras or point pairs found",
    );
    fails(&["convert", "no/such/file", "-o", &scene.text("out.json")], 2, "no such file");
    fails(&["convert", &few, "--images", &scene.text("left.png"), "-o", "x.json"], 2, "--images");
    assert!(!scene.path("out.json").exists());
}

#[test]
fn names_that_matlab_cannot_run_are_told() {
    let scene = scene();
    for (name, words) in [
        ("3d.m", "MATLAB cannot run a script called 3d"),
        ("left-view.m", "MATLAB cannot run a script called left-view"),
        ("F.m", "hides the variable F"),
        ("result_2.m", ""),
        ("3d.json", ""),
    ] {
        let output = run(&["convert", &scene.text("p1.P"), &scene.text("p2.P"), "-o", &scene.text(name)]);
        let told = text(&output.stderr);
        assert!(
            output.status.success() && told.contains(words) && told.is_empty() == words.is_empty(),
            "{told}"
        );
    }
}

#[test]
fn estimate_exports_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    let (result, export) = (folder.path().join("result.json"), folder.path().join("export.yml"));
    let (result_name, export_name) = (result.to_str().unwrap(), export.to_str().unwrap());
    succeeds(&["estimate", "--sample", "--json", result_name, "--export", export_name]);
    let back = folder.path().join("back.json");
    succeeds(&["convert", export_name, "-o", back.to_str().unwrap()]);
    let (result, back) = (json(&result), json(&back));
    assert_eq!(result["fundamental"], back["fundamental"]);
    let matches = result["matches"].as_array().unwrap().len();
    assert_eq!(back["pairs"].as_array().unwrap().len(), 2 + matches);
    assert_eq!(back["pairs"][1], result["pairs"][1]);
    assert_eq!(result["images"], back["images"]);
    assert!(succeeds(&["check", export_name]).contains("fits as read"));
    fails(&["estimate", "--sample", "--export", "f.unknown"], 2, "Add --format");
    fails(&["estimate", "--sample", "--format", "matlab"], 2, "required arguments");
    let both = ["estimate", "--sample", "--json", "-", "--export", "-", "--format", "text"];
    fails(&both, 2, "--json and --export cannot both be -");
}
