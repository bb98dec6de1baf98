//! The program killed at any moment: every file is the old one or the new one, and temporary files
//! are removed later.
//!
//! `EPILINE_KILLS` sets the number of kills; the default is small.

#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use epiline::camera::PicturesOf;
use epiline::geometry::Frame;
use epiline::io::{ImageReference, ImageSource, OutputFile, SessionFile};

/// Environment variable for the child that writes sessions until it is killed.
const CHILD: &str = "EPILINE_TEST_SAVES_TO";

/// Files of a rectified pair, the description last.
const NAMES: [&str; 6] =
    ["left.png", "right.png", "side-by-side.png", "left-map.npy", "right-map.npy", "rectification.json"];

fn kills() -> u64 {
    std::env::var("EPILINE_KILLS").ok().and_then(|value| value.parse().ok()).unwrap_or(12)
}

/// Returns a pause that differs between kills but not between runs.
fn pause(kill: u64, longest: u64) -> Duration {
    let mixed = (kill + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    Duration::from_micros((mixed >> 32) % longest)
}

fn parts(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    entries.filter(|entry| entry.file_name().to_string_lossy().ends_with(".part")).count()
}

fn session(number: u64) -> SessionFile<Vec<u64>> {
    let image = || ImageReference {
        source: ImageSource::File { path: "image.png".into(), sha256: "00".repeat(32) },
        frame: Frame::new(640, 480),
    };
    // Long enough to be interrupted in the middle.
    SessionFile {
        images: [image(), image()],
        fundamental: None,
        pictures: PicturesOf::Untold,
        trust: None,
        content: vec![number; 40_000],
    }
}

/// Body of the child process; as a test it does nothing.
#[test]
fn child_that_saves() {
    let Ok(path) = std::env::var(CHILD) else { return };
    for number in 1.. {
        session(number).write(Path::new(&path)).unwrap();
        println!("saved {number}");
    }
}

#[test]
fn a_session_is_never_half_and_never_older_than_what_was_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work.json");
    for kill in 0..kills() {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child_that_saves", "--nocapture", "--test-threads=1"])
            .env(CHILD, &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut saved = 0;
        let mut hear = |line: Option<std::io::Result<String>>| {
            let line = line?.ok()?;
            // The test harness writes into the first line, too.
            let number = line.rsplit_once("saved ").and_then(|(_, number)| number.parse().ok());
            saved = number.unwrap_or(saved);
            Some(saved)
        };
        while hear(lines.next()).is_some_and(|saved| saved < 2) {}
        std::thread::sleep(pause(kill, 20_000));
        child.kill().unwrap();
        while hear(lines.next()).is_some() {}
        child.wait().unwrap();
        let found = SessionFile::<Vec<u64>>::read(&path).unwrap_or_else(|e| panic!("kill {kill}: {e}"));
        assert!(found.content.len() == 40_000 && found.content[0] >= saved, "kill {kill}: after {saved}");
        assert_eq!(found, session(found.content[0]), "kill {kill}");
    }
    // The next file written in the folder removes the temporary files of killed programs.
    OutputFile::prepare(&folder.path().join("other.json")).unwrap();
    assert_eq!(parts(folder.path()), 0);
}

#[test]
fn a_rectified_pair_is_never_mixed_under_its_description() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    for (name, seed) in [("left.png", 3), ("right.png", 5)] {
        let picture = image::GrayImage::from_fn(160, 120, |x, y| image::Luma([(x * seed + y * y) as u8]));
        picture.save(file(name)).unwrap();
    }
    // Two matrices make the new pair differ from the old one in every file.
    std::fs::write(file("f0.txt"), "0 0 0\n0 0 -1\n0 1 0\n").unwrap();
    std::fs::write(file("f1.txt"), "0 0 0\n0 0 -1\n0 1 -9\n").unwrap();
    let rectify = |which: u64, output: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_epiline"));
        command.arg("rectify").args([file("left.png"), file("right.png")]);
        command.arg("--fundamental").arg(file(&format!("f{which}.txt"))).arg("--output").arg(file(output));
        command.arg("--maps").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    };
    let content = |output: &str| NAMES.map(|name| std::fs::read(file(output).join(name)).ok());
    let started = std::time::Instant::now();
    for which in [0, 1] {
        assert!(rectify(which, &format!("whole{which}")).status().unwrap().success());
    }
    let takes = started.elapsed().as_micros() as u64 / 2;
    let whole = [content("whole0"), content("whole1")];
    assert!((0..NAMES.len()).all(|k| whole[0][k] != whole[1][k] && whole[0][k].is_some()));
    for kill in 0..kills() {
        let mut child = rectify(kill % 2, "out").spawn().unwrap();
        std::thread::sleep(pause(kill, takes * 5 / 4));
        let _ = child.kill();
        child.wait().unwrap();
        if !file("out").is_dir() {
            continue;
        }
        let found = content("out");
        for (k, name) in NAMES.iter().enumerate() {
            let known = found[k].is_none() || whole.iter().any(|whole| whole[k] == found[k]);
            assert!(known, "kill {kill}: half of {name}");
        }
        if found[NAMES.len() - 1].is_some() {
            assert!(whole.contains(&found), "kill {kill}: old and new files under one description");
        }
    }
    assert!(rectify(0, "out").status().unwrap().success());
    assert!(content("out") == whole[0]);
    assert_eq!(parts(&file("out")), 0);
}
