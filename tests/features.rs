//! Covariant features compared with OpenCV's SIFT on real pairs with ground truth.
//!
//! The test needs the pictures in `../shared/data` and Python with `cv2` (the program named by
//! `EPILINE_PYTHON`, or `python3`). It prints "skipped" if either is missing.

mod skipping;

use std::path::{Path, PathBuf};
use std::process::Command;

use epiline::features::{FeatureParameters, find_features, match_features};
use epiline::geometry::{FundamentalMatrix, PointPair, eight_point, symmetric_epipolar_distance};
use epiline::image::Picture;
use nalgebra::Matrix3;
use skipping::{shared, skipped};

/// Maximum number of features per picture, for both programs.
const MOST: usize = 5000;
/// Longer side of the largest pictures used, px. Larger pictures take a minute and add no
/// information.
const LARGEST_SIDE: f64 = 1100.0;
/// Largest distance of a correct match from the true epipolar lines, px.
const RIGHT: f64 = 3.0;

fn python() -> Option<PathBuf> {
    let python = std::env::var_os("EPILINE_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from);
    let found = Command::new(&python).args(["-c", "import cv2"]).output().is_ok_and(|o| o.status.success());
    if !found {
        skipped(&format!("{} has no module cv2", python.display()));
    }
    found.then_some(python)
}

/// Returns the names of all pairs in a folder, without the `A` and `B` of the pictures.
fn pairs(folder: &str) -> Vec<PathBuf> {
    let Some(path) = shared(&format!("data/{folder}")) else { return Vec::new() };
    let mut names: Vec<PathBuf> = path
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "txt"))
        .map(|p| p.with_extension(""))
        .filter(|p| picture(p, "A").is_some())
        .collect();
    names.sort();
    names
}

fn picture(name: &Path, side: &str) -> Option<PathBuf> {
    ["png", "jpg"].iter().map(|e| PathBuf::from(format!("{}{side}.{e}", name.display()))).find(|p| p.exists())
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|v| v.parse().unwrap()).collect()
}

fn point_pairs(rows: &[f64]) -> Vec<PointPair> {
    rows.chunks_exact(4).map(|r| PointPair::new(r[0], r[1], r[2], r[3])).collect()
}

/// Returns the true F, or the F fitted to the true matches.
fn truth(name: &Path) -> FundamentalMatrix {
    let with = |suffix: &str| std::fs::read_to_string(format!("{}{suffix}.txt", name.display()));
    if let Ok(text) = with("_F") {
        return FundamentalMatrix::nearest_rank_two(Matrix3::from_row_slice(&numbers(&text))).unwrap();
    }
    eight_point(&point_pairs(&numbers(&with("").unwrap()))).unwrap()
}

#[test]
fn right_matches_are_as_many_as_those_of_opencv() {
    let Some(python) = python() else { return };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/features/opencv.py");
    let (mut ours, mut theirs) = (0, 0);
    println!("{:<28} {:>22} {:>22}", "right of matches", "ours", "OpenCV");
    for name in [pairs("pairs"), pairs("wide")].concat() {
        let paths = ["A", "B"].map(|side| picture(&name, side).unwrap());
        let pictures = paths.each_ref().map(|p| Picture::open(p).unwrap());
        if pictures.iter().any(|p| p.gray.frame().longer_side() > LARGEST_SIDE) {
            continue;
        }
        // OpenCV doubles every picture and uses a threshold of 0.04 / 3 of the range of
        // intensities.
        let parameters = FeatureParameters {
            most: MOST,
            contrast: 3.4,
            largest_octave: usize::MAX,
            ..FeatureParameters::default()
        };
        let sets = pictures.each_ref().map(|p| find_features(&p.gray, &parameters));
        let found: Vec<PointPair> = match_features(&sets[0], &sets[1]).iter().map(|m| m.pair).collect();
        let output = Command::new(&python).arg(&script).arg(MOST.to_string()).args(&paths).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let rows: Vec<Vec<f64>> = serde_json::from_slice(&output.stdout).unwrap();
        let reference = point_pairs(&rows.concat());
        let f = truth(&name);
        let right =
            |pairs: &[PointPair]| pairs.iter().filter(|p| symmetric_epipolar_distance(&f, p) < RIGHT).count();
        let of = |pairs: &[PointPair]| format!("{} of {}", right(pairs), pairs.len());
        println!("{:<28} {:>22} {:>22}", name.file_name().unwrap().display(), of(&found), of(&reference));
        ours += right(&found);
        theirs += right(&reference);
    }
    println!("{:<28} {ours:>22} {theirs:>22}", "together");
    assert!(ours as f64 >= 0.95 * theirs as f64, "{ours} right matches, OpenCV has {theirs}");
}
