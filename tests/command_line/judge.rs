use super::*;

/// Runs `judge` on the built-in pair.
fn judged(rest: &[&str]) -> Output {
    run(&[&["judge", "--sample"][..], rest].concat())
}

/// Writes F of the built-in pair, as it is and transposed.
fn geometries(pictures: &Pictures) -> [String; 2] {
    let found = pictures.text("found.json");
    assert!(run(&["estimate", "--sample", "--json", &found]).status.success());
    let result: Value = serde_json::from_slice(&std::fs::read(&found).unwrap()).unwrap();
    let entry = |row: usize, column: usize| result["fundamental"][row][column].to_string();
    let rows = |transposed: bool| {
        let cell =
            |row: usize, column: usize| if transposed { entry(column, row) } else { entry(row, column) };
        let row = |row: usize| (0..3).map(|column| cell(row, column)).collect::<Vec<_>>().join(" ");
        (0..3).map(row).collect::<Vec<_>>().join("\n")
    };
    [("f.txt", false), ("t.txt", true)].map(|(name, transposed)| {
        pictures.write(name, &rows(transposed));
        pictures.text(name)
    })
}

#[test]
fn a_sound_geometry_fits_and_a_transposed_one_is_named() {
    let pictures = Pictures::new();
    let [right, transposed] = geometries(&pictures);
    let output = judged(&["--fundamental", &right, "--json", "-"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["finding"], &found["change"]), (&"fits".into(), &Value::Null));
    assert_eq!(found["reference_verdict"], "reliable");

    let output = judged(&["--fundamental", &transposed]);
    assert_eq!(output.status.code(), Some(1));
    let words = text(&output.stdout);
    assert!(words.starts_with("The geometry does not fit.") && words.contains("transposed"), "{words}");
    assert!(text(&output.stderr).contains("error: the geometry does not fit the images"));
    // With a generous limit it fits all the same.
    assert_eq!(judged(&["--fundamental", &transposed, "--limit", "9999"]).status.code(), Some(0));
}

#[test]
fn given_matches_replace_those_of_the_images() {
    let pictures = Pictures::new();
    let [right, transposed] = geometries(&pictures);
    let matches = pictures.text("found.csv");
    let exported = run(&["estimate", "--sample", "--export", &pictures.text("found.txt")]);
    assert!(exported.status.success());
    std::fs::rename(pictures.path("found.txt"), &matches).unwrap();
    for (file, status) in [(&right, 0), (&transposed, 1)] {
        let output = judged(&["--fundamental", file, "--matches", &matches]);
        assert_eq!(output.status.code(), Some(status), "{}", text(&output.stderr));
    }
    pictures.write("few.txt", "1 2 3 4\n5 6 7 8\n");
    let few = pictures.text("few.txt");
    let output = judged(&["--fundamental", &right, "--matches", &few]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("a fit needs at least 14 matches, 2 were given"));
}

#[test]
fn a_rectified_pair_is_found_rectified_and_the_log_grows() {
    let pictures = Pictures::new();
    let [f, _] = geometries(&pictures);
    let folder = pictures.text("rectified");
    let made = run(&["rectify", "--sample", "--fundamental", &f, "--output", &folder]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let [left, right] = ["left.png", "right.png"].map(|name| format!("{folder}/{name}"));
    let log = pictures.text("log.csv");
    for _ in 0..2 {
        let output = run(&["judge", &left, &right, "--rectified", "--log", &log]);
        assert_eq!(output.status.code(), Some(0), "{} {}", text(&output.stdout), text(&output.stderr));
        assert!(text(&output.stdout).starts_with("The images are rectified"));
    }
    let lines = std::fs::read_to_string(&log).unwrap();
    assert_eq!(lines.lines().count(), 3, "a head and two lines: {lines}");
    // The pictures before were not.
    let output = judged(&["--rectified", "--json", "-"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("error: the images are not rectified"));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["typical"].as_f64().unwrap() > 0.5 && found["is_aligned"] == false, "{found}");
}

#[test]
fn unsuitable_input_is_refused() {
    let pictures = Pictures::new();
    pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 0\n");
    let f = pictures.text("f.txt");
    let (left, flat) = (pictures.text("left.png"), pictures.text("flat.png"));
    fails(&["judge", "--sample", "--cameras", &f], 2, "there are no two cameras in the file");
    fails(&["judge", &left, &pictures.text("none.pgm"), "--fundamental", &f], 2, "none.pgm");
    let output = run(&["judge", "--sample"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--fundamental"));
    // Nothing is added to a file that is no log, and a folder is none.
    pictures.write("notes.txt", "mine\n");
    let notes = pictures.text("notes.txt");
    fails(&["judge", "--sample", "--rectified", "--log", &notes], 2, "is not a log of this command");
    assert_eq!(std::fs::read_to_string(&notes).unwrap(), "mine\n");
    let folder = pictures.0.path().to_str().unwrap().to_owned();
    fails(&["judge", "--sample", "--rectified", "--log", &folder], 2, "cannot read");
    fails(&["judge", "--sample", "--rectified", "--log", &left, "--json", &left], 2, "");
    // Without texture, nothing can be judged.
    assert_ne!(run(&["judge", &left, &flat, "--fundamental", &f]).status.code(), Some(0));
}
