//! The program as a user runs it: results, exit statuses and invalid input.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

// Cargo would build files in `tests` as separate test programs.
#[path = "command_line/barcode.rs"]
mod barcode;
#[path = "command_line/calibrated.rs"]
mod calibrated;
#[path = "command_line/colmap.rs"]
mod colmap;
#[path = "command_line/files.rs"]
mod files;
#[path = "command_line/hostile.rs"]
mod hostile;
#[path = "command_line/judge.rs"]
mod judge;
#[path = "command_line/points.rs"]
mod points;
#[path = "command_line/rectify.rs"]
mod rectify;
mod skipping;
#[path = "command_line/suggest.rs"]
mod suggest;
#[path = "command_line/support.rs"]
mod support;

use support::{Pictures, fails, program, run, small_pairs, text, textured};

/// Program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_epiline");

impl Pictures {
    /// Returns the arguments of `estimate` on two of the pictures.
    fn estimate(&self, left: &str, right: &str, rest: &[&str]) -> Vec<String> {
        let words = ["estimate".to_owned(), self.text(left), self.text(right)];
        words.into_iter().chain(rest.iter().map(|s| (*s).to_owned())).collect()
    }

    #[track_caller]
    fn estimate_fails(&self, left: &str, right: &str, rest: &[&str], status: i32, words: &str) {
        let arguments = self.estimate(left, right, rest);
        fails(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), status, words);
    }
}

const GOOD: [&str; 4] = ["--pair", "20,30,25,30", "--pair", "120,90,118,91"];

#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_written_is_an_error() {
    for argument in ["--help", "--version"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(&[argument]).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{argument}");
        assert!(text(&output.stderr).contains("cannot write to standard output"), "{argument}");
    }
}

#[test]
fn odd_settings_are_refused_or_quick() {
    fails(&["estimate", "--sample", "--threads", "1000"], 2, "from 1 to 256");
    let lines = ["estimate", "--sample", "--method", "lines"];
    let costs = ["--set", "stereo.lambda=1", "--set", "stereo.alpha=20000"];
    fails(&[&lines[..], &costs].concat(), 2, "would take minutes. Raise lambda or lower alpha");
    // Took more than a minute when changes of disparity without a cost were tried one by one.
    let begun = std::time::Instant::now();
    let output = run(&["estimate", "--sample", "--preset", "paper", "--set", "stereo.lambda=0"]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", text(&output.stderr));
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

#[test]
fn help_and_version_succeed() {
    for arguments in [&["--help"][..], &["--version"], &["estimate", "--help"]] {
        let output = run(arguments);
        assert!(output.status.success() && !output.stdout.is_empty(), "{arguments:?}");
    }
}

mod pictures {
    use super::*;

    #[test]
    fn that_cannot_be_read_are_named() {
        let pictures = Pictures::new();
        for (name, words) in [
            ("missing.png", "missing.png: there is no such file"),
            ("zero.png", "zero.png"),
            ("cut.png", "cut.png is damaged or incomplete"),
            ("words.txt", "words.txt is not an image"),
            ("words.png", "words.png is not an image"),
            ("none.pgm", "none.pgm"),
            ("", "it is a folder"),
        ] {
            pictures.estimate_fails(name, "right.png", &GOOD, 2, words);
            pictures.estimate_fails("left.png", name, &GOOD, 2, words);
        }
    }

    #[test]
    fn must_be_two() {
        let pictures = Pictures::new();
        let left = pictures.text("left.png");
        fails(&["estimate", &left, "--pair", "1,2,3,4"], 2, "required");
        fails(&["estimate", "--pair", "1,2,3,4"], 2, "required");
        fails(&["estimate", "--sample", "no-such-sample"], 2, "no-such-sample");
        fails(&[&left], 2, "Give two images LEFT and RIGHT");
    }
}

mod pairs {
    use super::*;

    #[test]
    fn that_are_malformed_say_what_was_expected() {
        let pictures = Pictures::new();
        for (pair, words) in [
            ("1,2,3", "expected four numbers X1,Y1,X2,Y2 (pixels), found 3"),
            ("1,2,3,4,5", "found 5"),
            ("nan,2,3,4", "\"nan\" is not a finite number"),
            ("1,inf,3,4", "\"inf\" is not a finite number"),
            ("1,2,x,4", "\"x\" is not a finite number"),
            ("1,,3,4", "\"\" is not a finite number"),
            ("", "expected four numbers"),
            ("--json", "expected four numbers"),
        ] {
            pictures.estimate_fails("left.png", "right.png", &["--pair", pair], 2, words);
        }
    }

    #[test]
    fn must_be_as_many_as_the_published_method_takes() {
        let pictures = Pictures::new();
        let two = "2 point pairs are needed";
        let two_point = ["--preset", "paper", "--method", "two-point"];
        pictures.estimate_fails("left.png", "right.png", &two_point, 2, two);
        pictures.estimate_fails("left.png", "right.png", &[&GOOD[..2], &two_point].concat(), 2, two);
        let three = [&GOOD[..], &["--method", "three-point"]].concat();
        pictures.estimate_fails("left.png", "right.png", &three, 2, "3 point pairs are needed, 2 given");
    }
}

mod options {
    use super::*;

    #[test]
    fn that_make_no_sense_are_refused() {
        let pictures = Pictures::new();
        for (rest, words) in [
            (["--preset", "magic"], "invalid value 'magic'"),
            (["--method", "magic"], "invalid value 'magic'"),
            (["--seed", "-1"], "--seed"),
            (["--threads", "0"], "from 1 to 256"),
            (["--set", "nonsense=1"], "there is no parameter nonsense"),
            (["--set", "seed=-1"], "--set seed=-1"),
        ] {
            pictures.estimate_fails("left.png", "right.png", &[&GOOD[..], &rest].concat(), 2, words);
        }
    }
}

mod output {
    use super::*;

    #[test]
    fn that_cannot_be_written_is_found_out_first() {
        let pictures = Pictures::new();
        for (name, words) in [
            ("no/such/result.json", "there is no folder"),
            ("", "it is a folder"),
            ("left.png/result.json", "is not a folder"),
        ] {
            let json = pictures.text(name);
            let rest = [&GOOD[..], &["--json", &json]].concat();
            pictures.estimate_fails("left.png", "right.png", &rest, 2, words);
            // The output is checked before the images are read.
            pictures.estimate_fails("missing.png", "right.png", &rest, 2, words);
        }
        if cfg!(target_os = "linux") {
            let rest = [&GOOD[..], &["--json", "/proc/result.json"]].concat();
            pictures.estimate_fails("left.png", "right.png", &rest, 2, "/proc is not writable");
        }
    }

    #[test]
    fn stays_as_it_was_after_a_failure() {
        let pictures = Pictures::new();
        pictures.write("result.json", "an older result");
        let json = pictures.text("result.json");
        let before = std::fs::read_dir(pictures.0.path()).unwrap().count();
        let rest = [&GOOD[..], &["--json", &json]].concat();
        pictures.estimate_fails("cut.png", "right.png", &rest, 2, "damaged");
        assert_eq!(std::fs::read_to_string(&json).unwrap(), "an older result");
        assert_eq!(std::fs::read_dir(pictures.0.path()).unwrap().count(), before);
    }

    #[test]
    fn may_be_closed_by_its_reader() {
        let mut child =
            program(&["estimate", "--sample"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert!(!text(&output.stderr).contains("panic"), "{}", text(&output.stderr));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn that_is_full_is_an_error() {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(&["estimate", "--sample"]).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("cannot write to standard output"));
        fails(&["estimate", "--sample", "--json", "/dev/full"], 2, "cannot write");
    }
}

#[cfg(all(feature = "inspector", target_os = "linux"))]
#[test]
fn without_a_display_the_window_says_so() {
    let output = program(&[]).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap();
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{complaint}");
    assert_eq!(complaint.lines().filter(|l| l.starts_with("error: ")).count(), 1, "{complaint}");
    assert!(!complaint.contains("panic"), "{complaint}");
}

/// Tests with the real estimator.
mod geometry {
    use super::*;

    /// Runs `estimate` on the first two views of the house with two of their true matches.
    fn house(rest: &[&str]) -> Option<Output> {
        let folder = skipping::shared("data/house")?;
        let view = |k: usize| folder.join(format!("house.{k:03}.pgm")).to_str().unwrap().to_owned();
        let corners =
            |k: usize| std::fs::read_to_string(folder.join(format!("house.{k:03}.corners"))).unwrap();
        let (corners1, corners2) = (corners(0), corners(1));
        let place = |corners: &str, k: usize| -> [f64; 2] {
            let row = corners.lines().nth(k).unwrap();
            let numbers: Vec<f64> = row.split_whitespace().map(|v| v.parse().unwrap()).collect();
            [numbers[0], numbers[1]]
        };
        let tracks = std::fs::read_to_string(folder.join("house.nview-corners")).unwrap();
        let matches: Vec<([f64; 2], [f64; 2])> = tracks
            .lines()
            .filter_map(|row| {
                let cells: Vec<_> = row.split_whitespace().collect();
                let (a, b) = (cells[0].parse().ok()?, cells[1].parse().ok()?);
                Some((place(&corners1, a), place(&corners2, b)))
            })
            .collect();
        // The highest and the lowest match are far apart, and the epipolar lines of the set are
        // nearly horizontal.
        let by_height = |a: &&([f64; 2], [f64; 2]), b: &&([f64; 2], [f64; 2])| a.0[1].total_cmp(&b.0[1]);
        let pair = |m: &([f64; 2], [f64; 2])| format!("{},{},{},{}", m.0[0], m.0[1], m.1[0], m.1[1]);
        let p = pair(matches.iter().min_by(by_height).unwrap());
        let q = pair(matches.iter().max_by(by_height).unwrap());
        let (left, right) = (view(0), view(1));
        Some(run(&[&["estimate", &left, &right, "--pair", &p, "--pair", &q][..], rest].concat()))
    }

    #[test]
    fn of_a_real_pair_is_found_printed_and_written() {
        let folder = tempfile::tempdir().unwrap();
        let json = folder.path().join("result.json");
        let Some(output) = house(&["--seed", "5", "--json", json.to_str().unwrap()]) else { return };
        assert!(output.status.success(), "{}", text(&output.stderr));
        let progress = text(&output.stderr);
        assert!(progress.contains("Line pencils") && progress.contains("First F"), "{progress}");
        let summary = text(&output.stdout);
        for words in
            ["Fundamental matrix", "Epipole in image 2", "Score", "Round trip", "Lead over the rival", "Time"]
        {
            assert!(summary.contains(words), "{words} in {summary}");
        }
        let result: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(result["fundamental"].as_array().unwrap().len(), 3);
        assert_eq!(result["fundamental"][2].as_array().unwrap().len(), 3);
        assert_eq!(result["epipole1"].as_array().unwrap().len(), 3);
        assert!(result["epipole2"][2].is_number());
        for field in ["score", "seconds", "first_seconds", "round_trip_area"] {
            assert!(result[field].is_number(), "{field}");
        }
        for field in ["timings", "warnings", "pairs", "images"] {
            assert!(result[field].is_array(), "{field}");
        }
        assert_eq!((&result["method"], &result["preset"]), (&"two-point".into(), &"robust".into()));
        assert_eq!((&result["seed"], &result["images"][0]["width"]), (&5.into(), &768.into()));
        assert!(["everything", "epipole-directions"].contains(&result["determined"].as_str().unwrap()));
        for bearing in result["epipole_bearings"].as_array().unwrap() {
            let [nearest, farthest] = ["nearest", "farthest"].map(|end| bearing[end].as_f64());
            assert!(nearest.unwrap() > 0.0 && farthest.is_none_or(|farthest| farthest > nearest.unwrap()));
            assert!(bearing["direction_error"].as_f64().unwrap() > 0.0);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "one file and no leftovers");
    }

    #[test]
    fn is_the_same_to_the_last_bit_on_one_and_on_two_threads() {
        let found = |threads: &str| {
            let output = house(&["--threads", threads, "--json", "-"])?;
            assert!(output.status.success(), "{}", text(&output.stderr));
            let result: Value = serde_json::from_slice(&output.stdout).unwrap();
            Some(result["fundamental"].to_string())
        };
        assert_eq!(found("1"), found("2"));
    }

    #[test]
    fn of_the_built_in_sample_needs_no_files() {
        let output = run(&["estimate", "--sample", "--json", "-"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(result["pairs"].as_array().unwrap().len(), 2);
    }

    #[test]
    fn cannot_be_found_from_impossible_input() {
        let pictures = Pictures::new();
        let estimate = |left: &str, right: &str, pairs: [&str; 2], words: &str| {
            let rest = ["--pair", pairs[0], "--pair", pairs[1]];
            pictures.estimate_fails(left, right, &rest, 2, words);
        };
        let good = [GOOD[1], GOOD[3]];
        estimate(
            "left.png",
            "right.png",
            ["20,30,25,300", GOOD[3]],
            "outside the right image, which is 160×120",
        );
        estimate("left.png", "right.png", ["-20,30,25,30", GOOD[3]], "outside the left image");
        estimate("left.png", "right.png", [GOOD[1]; 2], "farther from each other");
        estimate(
            "dot.png",
            "right.png",
            ["0,0,25,30", "0,0,118,91"],
            "the left image is 1×1 pixels, too small",
        );
        estimate(
            "left.png",
            "dot.png",
            ["20,30,0,0", "120,90,0,0"],
            "the right image is 1×1 pixels, too small",
        );
        estimate("flat.png", "right.png", good, "the left image is (nearly) uniform");
        estimate("left.png", "flat.png", good, "the right image is (nearly) uniform");
    }
}
