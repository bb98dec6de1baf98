//! `epiline barcode`: folders of frames in, a geometry or an error message out.

use std::path::Path;

use epiline::geometry::{Frame, FundamentalMatrix, symmetric_epipolar_distance};
use epiline::synthetic::{BallScene, ThrownBalls};
use serde_json::Value;

use super::support::recorded_as;
use super::{fails, run, text};

const THROWN: ThrownBalls = ThrownBalls {
    frame: Frame { width: 240, height: 180 },
    frames: 160,
    balls: 8,
    offset: 4,
    noise: 1.5,
    brightening: 0.1,
    seed: 2,
};

/// Writes the frames of both cameras, each to its own folder.
fn recorded(folder: &Path) -> [String; 2] {
    recorded_as(folder, THROWN)
}

fn error_of(result: &Value) -> f64 {
    let rows: [[f64; 3]; 3] = serde_json::from_value(result["fundamental"].clone()).unwrap();
    let f = FundamentalMatrix::from_rows(rows).unwrap();
    let matches = BallScene::new(THROWN).unwrap().matches(200);
    matches.iter().map(|m| symmetric_epipolar_distance(&f, m)).sum::<f64>() / matches.len() as f64
}

#[test]
fn two_folders_of_frames_give_the_geometry_and_their_offset() {
    let folder = tempfile::tempdir().unwrap();
    let [left, right] = recorded(folder.path());
    let output = run(&["barcode", &left, &right, "--find-offset", "--json", "-"]);
    let told = text(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("Best offsets (correlation): 4 ("), "{told}");
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["frame_offset"], 4);
    assert_eq!(result["barcodes"]["frames"], 156);
    let error = error_of(&result);
    // 0.31 px here: silhouettes are as sharp as a pixel.
    assert!(error < 0.5, "{error} px");
    let again = run(&["barcode", &left, &right, "--offset", "4", "--threads", "1", "--json", "-"]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["fundamental"], result["fundamental"], "on any number of threads");
    // Two points visible in both cameras.
    let clicks: Vec<String> = BallScene::new(THROWN)
        .unwrap()
        .matches(2)
        .iter()
        .map(|m| format!("{},{},{},{}", m.point1.x, m.point1.y, m.point2.x, m.point2.y))
        .collect();
    let clicked = run(&[
        "barcode", &left, &right, "--offset", "4", "--pair", &clicks[0], "--pair", &clicks[1], "--json", "-",
    ]);
    let clicked: Value = serde_json::from_slice(&clicked.stdout).unwrap();
    let error = error_of(&clicked);
    assert!(error < 1.0, "{error} px");
    assert_eq!(clicked["pairs"].as_array().map(Vec::len), Some(2));
    // A missing frame is reported, and the sequence remains readable.
    std::fs::remove_file(folder.path().join("left/frame017.png")).unwrap();
    let gap = run(&["barcode", &left, &right, "--offset", "4", "--json", "-"]);
    assert!(text(&gap.stderr).contains("frames are missing in"), "{}", text(&gap.stderr));
    assert!(gap.status.success());
    // Each impossible request gives one error line.
    fails(&["barcode", &left, &right, "--offset", "150"], 2, "at least 16 are needed");
    fails(&["barcode", &left, "nowhere"], 2, "there is no such file");
    fails(&["barcode", &left, &right, "--offset", "4", "--find-offset"], 2, "cannot be used with");
}

#[test]
fn pictures_are_no_sequences_and_barcodes_need_some() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("one.png");
    image::GrayImage::from_fn(64, 64, |x, y| image::Luma([(x * 3 + y) as u8])).save(&file).unwrap();
    let file = file.display().to_string();
    fails(&["barcode", &file, &file], 2, "is a picture. Sequences");
    fails(&["barcode", &folder.path().display().to_string(), &file], 2, "no numbered pictures");
    fails(&["estimate", "--sample", "--set", "measure=barcodes"], 2, "need two sequences of frames");
}
