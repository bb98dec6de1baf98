//! The program as its user runs it: results, exit statuses and invalid input.

use std::process::{Command, Stdio};

use epiline::geometry::{Frame, PointPair};
use epiline::synthetic::{BallScene, ThrownBalls};
use serde_json::Value;

#[path = "../../tests/skipping/mod.rs"]
mod skipping;
#[path = "../../tests/command_line/support.rs"]
mod support;

use support::{Pictures, fails, program, recorded_as, run, small_pairs, text};

/// Program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_epiline-lab");

#[test]
fn keeps_every_trial_and_pairs_them_between_contenders() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    let ask = |threads: &str| {
        let output = run(&[
            "pairs",
            folder,
            "--trials",
            "2",
            "--protocol",
            "paper",
            "--preset",
            "robust",
            "--methods",
            "two-point,three-point",
            "--noise",
            "0.5",
            "--threads",
            threads,
            "--json",
            "-",
        ]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("pair  "), "the table goes to standard error");
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let report = ask("2");
    let records = report["records"].as_array().unwrap();
    assert_eq!(records.len(), 2);
    let clicks = |record: &Value, trial: usize| record["trials"][trial]["clicks"].as_array().unwrap().clone();
    for record in records {
        assert_eq!(record["trials"].as_array().unwrap().len(), 2);
        for trial in 0..2 {
            assert_eq!(clicks(record, trial)[..2], clicks(&records[0], trial)[..2]);
        }
    }
    assert_eq!(clicks(&records[1], 0).len(), 3);
    let alone = ask("1");
    assert_eq!(alone["records"][1]["trials"][1]["clicks"], records[1]["trials"][1]["clicks"]);
    assert_eq!(report["parameters"]["noise"], 0.5);
}

#[cfg(unix)]
#[test]
fn leaves_a_report_of_what_was_made_when_it_is_interrupted() {
    use std::io::{BufRead, BufReader, Read};

    let pictures = Pictures::new();
    small_pairs(&pictures);
    let (folder, json) = (pictures.0.path().to_str().unwrap(), pictures.text("report.json"));
    // The protocol allows dozens of trials; each takes tenths of a second on one thread.
    let mut child = program(&["pairs", folder, "--trials", "100", "--protocol", "paper"])
        .args(["--methods", "two-point,seven-point", "--threads", "1", "--json", &json])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The first line of progress means that a trial is done.
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    assert!(line.contains(" left; "), "{line}");
    let interrupted = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupted.success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{rest}");
    assert!(rest.contains("error: stopped after ") && !rest.contains("panic"), "{rest}");

    let report: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let number = |name: &str| report[name].as_u64().unwrap();
    assert!((1..number("trials_planned")).contains(&number("trials_made")), "{rest}");
    let made = report["records"].as_array().unwrap().iter().map(|r| r["trials"].as_array().unwrap().len());
    assert_eq!(made.sum::<usize>() as u64, number("trials_made"));
    let table = text(&output.stdout);
    assert!(table.contains("two-point robust") && table.contains("Note: Stopped: "), "{table}");
}

#[test]
fn refuses_folders_that_are_not_what_they_should_be() {
    let pictures = Pictures::new();
    let folder = pictures.0.path().to_str().unwrap();
    // Without a subcommand the program prints help with the status of invalid input.
    assert_eq!(run(&[]).status.code(), Some(2));
    for kind in ["vgg", "pairs"] {
        fails(&[kind, "no/such/folder"], 2, "there is no such file or folder");
        fails(&[kind, &pictures.text("words.txt")], 2, "it is not a folder");
    }
    fails(&["pairs", folder], 2, "no pairs found");
    fails(&["vgg", folder], 2, "not a VGG folder");
}

#[test]
fn names_file_and_line_of_a_bad_match() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    let good = std::fs::read_to_string(pictures.path("p.txt")).unwrap();
    for (content, words) in [
        (good.replacen('\n', "\n1 2 nan 4\n", 1), "p.txt, line 2: \"nan\" is not a finite number"),
        (good.replacen('\n', "\n1 2 3\n", 1), "p.txt, line 2: expected four numbers"),
        ("1 2 3 4\n5 6 7 8\n".into(), "at least 8 point pairs, 2 were given"),
        ("1 2 3 4\n".repeat(12), "do not determine a fundamental matrix"),
        (String::new(), "no point pairs found"),
    ] {
        pictures.write("p.txt", &content);
        fails(&["pairs", folder], 2, words);
    }
}

#[test]
fn takes_presets_with_and_without_refinement_when_asked() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    let ask = ["pairs", folder, "--trials", "1", "--protocol", "paper", "--json", "-"];
    let both = ["--preset", "paper,robust", "--methods", "two-point,eight-point", "--compare-refinement"];
    let output = run(&[&ask[..], &both].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let presets: Vec<_> = report["records"].as_array().unwrap().iter().map(|r| &r["preset"]).collect();
    assert_eq!(presets[..4], ["paper", "paper refined", "robust unrefined", "robust"]);
    assert!(presets.len() == 5 && presets[4].is_null(), "the baseline takes part once");
    let contenders = &report["parameters"]["contenders"];
    assert_eq!(contenders[1]["parameters"]["refine"], true);
    assert_eq!(contenders[2]["parameters"]["refine"], false);
    fails(&[&ask[..], &["--compare-refinement", "--refine"]].concat(), 2, "cannot be used with");
}

#[test]
fn names_unknown_pairs_and_bad_numbers() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    for (rest, words) in [
        (["--only", "q"], "there is no pair q. Choose one of p"),
        (["--trials", "0"], "from 1 to 1000000"),
        (["--noise", "-1"], "--noise"),
        (["--noise", "nan"], "expected a number of pixels"),
        (["--methods", "magic"], "invalid value 'magic'"),
        (["--protocol", "magic"], "invalid value 'magic'"),
    ] {
        fails(&[&["pairs", folder][..], &rest].concat(), 2, words);
    }
}

/// Evaluates a set of two views in a folder with one file changed, and asserts the error.
fn vgg_fails(name: &str, content: Option<&str>, words: &str) {
    let pictures = Pictures::new();
    for (name, content) in [
        ("set.000.P", "1 0 0 0\n0 1 0 0\n0 0 1 0\n"),
        ("set.001.P", "1 0 0 -1\n0 1 0 0\n0 0 1 0\n"),
        ("set.000.corners", "10 20\n50 60\n"),
        ("set.001.corners", "11 20\n55 60\n"),
        ("set.nview-corners", "0 0\n1 1\n"),
    ] {
        pictures.write(name, content);
    }
    for view in ["set.000.png", "set.001.png"] {
        std::fs::copy(pictures.path("left.png"), pictures.path(view)).unwrap();
    }
    match content {
        Some(content) => pictures.write(name, content),
        None => std::fs::remove_file(pictures.path(name)).unwrap(),
    }
    fails(&["vgg", pictures.0.path().to_str().unwrap()], 2, words);
}

#[test]
fn names_what_is_wrong_in_a_vgg_folder() {
    vgg_fails("set.001.P", None, "set.001.P: there is no such file");
    vgg_fails("set.001.P", Some("1 0 0 0\n0 1 0\n"), "set.001.P, line 2: expected four numbers");
    vgg_fails("set.001.P", Some("1 0 0 0\n0 1 0 0\n0 0 1 0\n"), "the same centre");
    vgg_fails("set.000.corners", Some("10 20\nten 20\n"), "set.000.corners, line 2: \"ten\"");
    vgg_fails("set.nview-corners", Some("0 0\n1 7\n"), "set.nview-corners, line 2: corner 7");
    vgg_fails("set.001.png", None, "the image set.001.* is missing");
    vgg_fails("set.001.png", Some("no picture"), "set.001.png");
}

#[test]
fn outputs_are_checked_before_the_work() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    let read = pictures.text("p.txt");
    let before = std::fs::read(&read).unwrap();
    let ask = ["pairs", folder, "--trials", "1", "--json", &read];
    fails(&ask, 2, "it is one of the files that are read");
    assert_eq!(std::fs::read(&read).unwrap(), before);
    let json = pictures.text("no/such/report.json");
    fails(&["pairs", "no/such/folder", "--json", &json], 2, "there is no folder");
    assert!(run(&["vgg", "--help"]).status.success());
}

#[test]
fn a_pair_that_cannot_be_evaluated_is_told_and_the_others_are_made() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    for (name, matches) in [("few", "1 2 3 4\n"), ("none", "no numbers\n")] {
        for side in ["A", "B"] {
            std::fs::copy(pictures.path("left.png"), pictures.path(&format!("{name}{side}.png"))).unwrap();
        }
        pictures.write(&format!("{name}.txt"), matches);
    }
    let folder = pictures.0.path().to_str().unwrap();
    let output = run(&["pairs", folder, "--trials", "1", "--protocol", "paper"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for told in [text(&output.stdout), text(&output.stderr)] {
        assert!(told.contains("few was left out: ") && told.contains("none was left out: "), "{told}");
    }
    // Without any usable pair the evaluation fails.
    fails(&["pairs", folder, "--trials", "1", "--only", "few"], 2, "eight-point");
}

#[test]
fn of_the_house_is_evaluated() {
    let Some(folder) = skipping::shared("data/house") else { return };
    let folder = folder.to_str().unwrap();
    let output = run(&["vgg", folder, "--only", "0-1", "--trials", "2", "--json", "-"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let record = &report["records"][0];
    assert_eq!(record["matches"], 298);
    assert!((record["truth_error"].as_f64().unwrap() - 0.26).abs() < 0.01);
    assert_eq!(record["failures"], 0);
    // 0.27 px in each of 20 trials. The true matrix fits its own matches to 0.26 px.
    assert!(record["median"].as_f64().unwrap() < 0.4, "{}", record["median"]);
}

#[test]
fn of_the_house_from_seven_and_eight_points_stands_beside_what_is_printed() {
    let Some(folder) = skipping::shared("data/house") else { return };
    let folder = folder.to_str().unwrap();
    let ask = |rest: &[&str]| {
        let baselines = ["--methods", "seven-point,eight-point", "--protocol", "paper", "--json", "-"];
        let output = run(&[&["vgg", folder][..], &baselines, rest].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, text(&output.stderr))
    };
    let (report, table) = ask(&["--trials", "8"]);
    let [seven, eight] = &report["overall"].as_array().unwrap()[..] else { panic!("two methods") };
    assert_eq!((&seven["pairs"], &seven["trials"]), (&9.into(), &72.into()));
    assert_eq!((&seven["printed"], &eight["printed"]), (&25.8.into(), &2.77.into()));
    for overall in [seven, eight] {
        let median = overall["median_of_medians"].as_f64().unwrap();
        let end = |name: &str| overall["median_of_medians_interval"][name].as_f64().unwrap();
        // The few corners are accurate to about 0.1 px, so errors of some pixels are expected.
        assert!((0.5..10.0).contains(&median), "{median}");
        assert!(end("low") <= median && median <= end("high"));
    }
    assert_eq!(report["records"][0]["printed"], 27.11);
    assert_eq!(report["records"][0]["trials"][0]["clicks"].as_array().unwrap().len(), 7);
    assert!(table.contains("printed") && table.contains("Fig. 8"), "{table}");

    let (wide, table) = ask(&["--trials", "2", "--step", "2", "--only", "0-2"]);
    assert!(wide["records"][0]["printed"].is_null() && !table.contains("printed"), "{table}");
    assert!(wide["records"][0]["median_interval"].is_null(), "two trials say nothing about firmness");
}

#[test]
fn sequences_with_known_cameras_are_evaluated() {
    let folder = tempfile::tempdir().unwrap();
    let thrown = ThrownBalls {
        frame: Frame { width: 240, height: 180 },
        frames: 160,
        balls: 8,
        offset: 0,
        noise: 1.5,
        brightening: 0.1,
        seed: 2,
    };
    recorded_as(folder.path(), thrown);
    let scene = BallScene::new(thrown).unwrap();
    let given = folder.path().display().to_string();
    let ask = ["sequences", &given, "--methods", "no-clicks,two-point", "--trials", "1", "--json", "-"];
    fails(&ask, 2, "no sequences with cameras found");
    for (name, camera) in ["left.P", "right.P"].iter().zip(scene.cameras()) {
        let row =
            |r: usize| (0..4).map(|c| camera.matrix()[(r, c)].to_string()).collect::<Vec<_>>().join(" ");
        std::fs::write(folder.path().join(name), [row(0), row(1), row(2)].join("\n")).unwrap();
    }
    fails(&ask, 2, "the true matches of left and right are missing");
    let row = |m: &PointPair| format!("{} {} {} {}", m.point1.x, m.point1.y, m.point2.x, m.point2.y);
    let matches: Vec<String> = scene.matches(100).iter().map(row).collect();
    std::fs::write(folder.path().join("truth-left-right.txt"), matches.join("\n")).unwrap();
    let output = run(&ask);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let records = report["records"].as_array().unwrap();
    assert_eq!(records.len(), 2);
    for record in records {
        assert_eq!(record["pair"], "left-right");
        let error = record["trials"][0]["mean"].as_f64().unwrap();
        // 0.30 and 0.31 px.
        assert!(error < 0.5, "{error} px: {}", record["method"]);
    }
}
