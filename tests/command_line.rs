//! The program as a user runs it: results, exit statuses and invalid input.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

// Cargo would build files in `tests` as separate test programs.
#[path = "command_line/barcode.rs"]
mod barcode;
#[path = "command_line/files.rs"]
mod files;
#[path = "command_line/hostile.rs"]
mod hostile;
#[path = "command_line/rectify.rs"]
mod rectify;
#[path = "command_line/report.rs"]
mod report;
#[path = "command_line/suggest.rs"]
mod suggest;

/// Returns the program with arguments.
fn epiline(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_epiline"));
    command.args(arguments).env_remove("RUST_BACKTRACE").stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Output {
    epiline(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Asserts the exit status, an error of one line containing `words`, and no other output.
#[track_caller]
fn fails(arguments: &[&str], status: i32, words: &str) {
    let output = run(arguments);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {complaint}");
    let errors: Vec<_> = complaint.lines().filter(|l| l.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{arguments:?}: {complaint}");
    assert!(errors[0].contains(words), "{arguments:?}: expected {words:?} in {complaint}");
    assert!(!complaint.contains("panicked") && !complaint.contains("RUST_BACKTRACE"), "{complaint}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed {}", text(&output.stdout));
}

/// Folder with small pictures, some of them damaged.
struct Pictures(tempfile::TempDir);

impl Pictures {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, seed) in [("left.png", 1), ("right.png", 2)] {
            textured(160, 120, seed).save(folder.path(name)).unwrap();
        }
        textured(1, 1, 1).save(folder.path("dot.png")).unwrap();
        image::GrayImage::from_pixel(160, 120, image::Luma([90])).save(folder.path("flat.png")).unwrap();
        let whole = std::fs::read(folder.path("left.png")).unwrap();
        std::fs::write(folder.path("cut.png"), &whole[..whole.len() / 2]).unwrap();
        std::fs::write(folder.path("zero.png"), "").unwrap();
        for name in ["words.txt", "words.png"] {
            std::fs::write(folder.path(name), "This is not a picture.\n").unwrap();
        }
        std::fs::write(folder.path("none.pgm"), "P5\n0 0\n255\n").unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, content: &str) {
        std::fs::write(self.path(name), content).unwrap();
    }

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

/// Draws smooth blobs without repetition.
fn textured(width: u32, height: u32, seed: u32) -> image::GrayImage {
    image::GrayImage::from_fn(width, height, |x, y| {
        let (x, y, s) = (f64::from(x), f64::from(y), f64::from(seed));
        let value = (x * 0.31 + s).sin() + (y * 0.23 - s).cos() + (x * 0.07 * s + y * 0.11).sin();
        image::Luma([(127.0 + 40.0 * value) as u8])
    })
}

/// Returns a folder of real pairs with ground truth, or `None` with a note that the test is
/// skipped.
fn real_data(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}

const GOOD: [&str; 4] = ["--pair", "20,30,25,30", "--pair", "120,90,118,91"];

#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_written_is_an_error() {
    for argument in ["--help", "--version"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = epiline(&[argument]).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{argument}");
        assert!(text(&output.stderr).contains("cannot write to standard output"), "{argument}");
    }
}

#[test]
fn odd_settings_are_refused_or_quick() {
    fails(&["estimate", "--sample", "--threads", "1000"], 2, "from 1 to 256");
    // Took more than a minute when changes of disparity without a cost were tried one by one.
    let begun = std::time::Instant::now();
    let output = run(&["estimate", "--sample", "--preset", "paper", "--set", "stereo.lambda=0"]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", text(&output.stderr));
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

#[test]
fn help_and_version_succeed() {
    for arguments in
        [&["--help"][..], &["--version"], &["estimate", "--help"], &["evaluate", "vgg", "--help"]]
    {
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
    fn that_claim_to_be_enormous_are_refused() {
        let pictures = Pictures::new();
        // A header of twelve bytes claims 4 thousand million pixels.
        pictures.write("bomb.pgm", "P5\n65535 65535\n255\n");
        pictures.estimate_fails("bomb.pgm", "right.png", &GOOD, 2, "bomb.pgm");
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
            fails(&["evaluate", "pairs", "no/such/folder", "--json", &json], 2, words);
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
        let pictures = Pictures::new();
        small_pairs(&pictures);
        let folder = pictures.0.path().to_str().unwrap();
        let mut child = epiline(&["evaluate", "pairs", folder, "--trials", "1"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert!(!text(&output.stderr).contains("panic"), "{}", text(&output.stderr));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn that_is_full_is_an_error() {
        let pictures = Pictures::new();
        small_pairs(&pictures);
        let folder = pictures.0.path().to_str().unwrap();
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = epiline(&["evaluate", "pairs", folder, "--trials", "1"]).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("cannot write to standard output"));
        fails(&["evaluate", "pairs", folder, "--trials", "1", "--json", "/dev/full"], 2, "cannot write");
    }
}

/// Creates a pair `p` in the folder, with twelve matches of an arbitrary geometry.
fn small_pairs(pictures: &Pictures) {
    std::fs::copy(pictures.path("left.png"), pictures.path("pA.png")).unwrap();
    std::fs::copy(pictures.path("right.png"), pictures.path("pB.png")).unwrap();
    let rows = (0..12).map(|k| {
        let t = f64::from(k);
        let (x, y) = (80.0 + 70.0 * (t * 1.9).sin(), 60.0 + 50.0 * (t * 2.7).cos());
        format!("{x} {y} {} {}\n", x * 0.9 + 5.0 + 4.0 * (t * 1.3).sin(), y * 0.95 + 3.0 * (t * 0.7).cos())
    });
    pictures.write("p.txt", &rows.collect::<String>());
}

mod evaluate {
    use super::*;

    #[test]
    fn keeps_every_trial_and_pairs_them_between_contenders() {
        let pictures = Pictures::new();
        small_pairs(&pictures);
        let folder = pictures.0.path().to_str().unwrap();
        let ask = |threads: &str| {
            let output = run(&[
                "evaluate",
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
        let clicks =
            |record: &Value, trial: usize| record["trials"][trial]["clicks"].as_array().unwrap().clone();
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
        let drawn = pictures.text("drawn");
        // The protocol allows dozens of trials; each takes tenths of a second on one thread.
        let mut child = epiline(&["evaluate", "pairs", folder, "--trials", "100", "--protocol", "paper"])
            .args([
                "--methods",
                "two-point,seven-point",
                "--threads",
                "1",
                "--json",
                &json,
                "--report",
                &drawn,
            ])
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
        let made =
            report["records"].as_array().unwrap().iter().map(|r| r["trials"].as_array().unwrap().len());
        assert_eq!(made.sum::<usize>() as u64, number("trials_made"));
        let table = text(&output.stdout);
        assert!(table.contains("two-point robust") && table.contains("Note: Stopped: "), "{table}");
        for file in ["report.html", "report.md"] {
            let page = std::fs::read_to_string(Path::new(&drawn).join(file)).unwrap();
            assert!(page.contains("Stopped: ") && page.contains("Figure 1"), "{file}");
        }
    }

    #[test]
    fn refuses_folders_that_are_not_what_they_should_be() {
        let pictures = Pictures::new();
        let folder = pictures.0.path().to_str().unwrap();
        // Without a subcommand the program prints help with the status of invalid input.
        assert_eq!(run(&["evaluate"]).status.code(), Some(2));
        for kind in ["vgg", "pairs"] {
            fails(&["evaluate", kind, "no/such/folder"], 2, "there is no such file or folder");
            fails(&["evaluate", kind, &pictures.text("words.txt")], 2, "it is not a folder");
        }
        fails(&["evaluate", "pairs", folder], 2, "no pairs found");
        fails(&["evaluate", "vgg", folder], 2, "not a VGG folder");
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
            fails(&["evaluate", "pairs", folder], 2, words);
        }
    }

    #[test]
    fn takes_presets_with_and_without_refinement_when_asked() {
        let pictures = Pictures::new();
        small_pairs(&pictures);
        let folder = pictures.0.path().to_str().unwrap();
        let ask = ["evaluate", "pairs", folder, "--trials", "1", "--protocol", "paper", "--json", "-"];
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
            fails(&[&["evaluate", "pairs", folder][..], &rest].concat(), 2, words);
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
        fails(&["evaluate", "vgg", pictures.0.path().to_str().unwrap()], 2, words);
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
}

#[cfg(all(feature = "inspector", target_os = "linux"))]
#[test]
fn without_a_display_the_window_says_so() {
    let output = epiline(&[]).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap();
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
        let folder = real_data("house")?;
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
        for words in ["Fundamental matrix", "Epipole in image 2", "Score", "Round trip", "Margin", "Time"] {
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
    fn of_the_house_is_evaluated() {
        let Some(folder) = real_data("house") else { return };
        let folder = folder.to_str().unwrap();
        let output = run(&["evaluate", "vgg", folder, "--only", "0-1", "--trials", "2", "--json", "-"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let record = &report["records"][0];
        assert_eq!(record["matches"], 298);
        assert!((record["truth_error"].as_f64().unwrap() - 0.26).abs() < 0.01);
        assert_eq!(record["failures"], 0);
        // Far above the accuracy of the estimator: this tests the command.
        assert!(record["median"].as_f64().unwrap() < 20.0, "{}", record["median"]);
    }

    #[test]
    fn of_the_house_from_seven_and_eight_points_stands_beside_what_is_printed() {
        let Some(folder) = real_data("house") else { return };
        let folder = folder.to_str().unwrap();
        let ask = |rest: &[&str]| {
            let baselines = ["--methods", "seven-point,eight-point", "--protocol", "paper", "--json", "-"];
            let output = run(&[&["evaluate", "vgg", folder][..], &baselines, rest].concat());
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
        estimate("left.png", "right.png", ["20,30,25,300", GOOD[3]], "outside image 2, which is 160×120");
        estimate("left.png", "right.png", ["-20,30,25,30", GOOD[3]], "outside image 1");
        estimate("left.png", "right.png", [GOOD[1]; 2], "farther from each other");
        estimate("dot.png", "right.png", ["0,0,25,30", "0,0,118,91"], "image 1 is 1×1 pixels, too small");
        estimate("left.png", "dot.png", ["20,30,0,0", "120,90,0,0"], "image 2 is 1×1 pixels, too small");
        estimate("flat.png", "right.png", good, "image 1 is (nearly) uniform");
        estimate("left.png", "flat.png", good, "image 2 is (nearly) uniform");
    }
}
