//! Measures geometries proposed by covariant features on pairs of known geometry. Clicks are true
//! matches with noise.
//!
//! `cargo run --release -p epiline-lab --example measure-wide [CLICKS] [TRIALS] [FOLDER …]`
//!
//! Prints the mean symmetric epipolar distance of each pair's true matches in each trial, px. For
//! each bin of the folder's `TABLE.md` it prints the fractions below 1 px and below 1 % of the
//! longer side, then the times.
//!
//! A folder holds pictures `NAMEA.*` and `NAMEB.*`, and the true matches `NAME.txt` as rows of
//! `x1 y1 x2 y2`.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

use epiline::estimate::covariant::{FeatureEvidence, hypotheses_from_features};
use epiline::features::{FeatureParameters, find_features, match_features};
use epiline::geometry::{FundamentalMatrix, PointPair, symmetric_epipolar_distance};
use epiline::image::{GrayPlane, Picture};
use epiline::io::{pair_folder, read_point_pairs};
use epiline_lab::{mean, median};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Minimum distance of two clicks, as a fraction of the longer side.
const APART: f64 = 0.15;
/// Standard deviation of a clicked coordinate, px.
const NOISE: f64 = 1.0;

/// Errors of one bin, in px and as fractions of the longer side.
#[derive(Default)]
struct Bin(Vec<[f64; 2]>);

/// Returns the last column of a pair's row in `TABLE.md`.
fn bin(folder: &Path, name: &str) -> Option<String> {
    let table = std::fs::read_to_string(folder.join("TABLE.md")).ok()?;
    let start = format!("| {name} |");
    let row = table.lines().find(|line| line.starts_with(&start))?;
    Some(row.trim_end_matches('|').rsplit('|').next()?.trim().to_owned())
}

fn gauss(random: &mut Pcg64Mcg) -> f64 {
    let (radius, angle) =
        (random.random_range(1e-12..1.0f64), random.random_range(0.0..std::f64::consts::TAU));
    (-2.0 * radius.ln()).sqrt() * angle.cos()
}

/// Draws noisy true matches, at a minimum distance that shrinks until enough are found.
fn clicks(matches: &[PointPair], sides: [f64; 2], count: usize, random: &mut Pcg64Mcg) -> Vec<PointPair> {
    let mut chosen: Vec<PointPair> = Vec::new();
    let mut apart = APART;
    while chosen.len() < count {
        let one = matches[random.random_range(0..matches.len())];
        let far = |p: &PointPair| {
            (p.point1 - one.point1).norm() > apart * sides[0]
                && (p.point2 - one.point2).norm() > apart * sides[1]
        };
        if chosen.iter().all(far) {
            chosen.push(one);
        }
        apart *= 0.99;
    }
    let mut noisy = |v: f64| v + NOISE * gauss(random);
    let moved = |p: PointPair| {
        PointPair::new(noisy(p.point1.x), noisy(p.point1.y), noisy(p.point2.x), noisy(p.point2.y))
    };
    chosen.into_iter().map(moved).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: usize| arguments.get(k).map_or(Ok(default), |a| a.parse());
    let (count, trials) = (number(0, 2)?, number(1, 10)?);
    let mut folders: Vec<&str> = arguments.iter().skip(2).map(String::as_str).collect();
    if folders.is_empty() {
        folders = vec!["../shared/data/wide", "../shared/data/pairs"];
    }
    let mut bins: BTreeMap<String, Bin> = BTreeMap::new();
    let (mut preparing, mut searching) = (Vec::new(), Vec::new());
    println!("{:<28} {:<10} errors of {trials} trials with {count} clicks, px", "pair", "bin");
    for folder in folders.into_iter().map(Path::new) {
        for files in pair_folder(folder)? {
            let [first, second] = files.images.each_ref().map(|path| Picture::open(path));
            let planes = [first?.gray, second?.gray];
            let matches = read_point_pairs(&files.matches.ok_or("a pair has no matches")?)?;
            let begun = Instant::now();
            let sets = planes.each_ref().map(|p| find_features(p, &FeatureParameters::default()));
            let candidates = match_features(&sets[0], &sets[1]);
            preparing.push(begun.elapsed().as_secs_f64());
            let frames = planes.each_ref().map(GrayPlane::frame);
            let sides = frames.map(|f| f.longer_side());
            let bin = bin(folder, &files.name).unwrap_or_else(|| "other".to_owned());
            let path = folder.join(&files.name);
            print!("{:<28} {bin:<10}", files.name);
            for trial in 0..trials {
                let seed =
                    path.to_string_lossy().bytes().fold(trial as u64, |h, b| h.rotate_left(5) ^ u64::from(b));
                let clicks = clicks(&matches, sides, count, &mut Pcg64Mcg::seed_from_u64(seed));
                let evidence = FeatureEvidence {
                    sets: [&sets[0], &sets[1]],
                    matches: &candidates,
                    frames,
                    clicks: &clicks,
                    click_sigma: NOISE,
                };
                let search = epiline::estimate::FeatureParameters::default();
                let begun = Instant::now();
                let found = hypotheses_from_features(&evidence, &search, trial as u64);
                searching.push(begun.elapsed().as_secs_f64());
                let error = |f: &FundamentalMatrix| {
                    mean(&matches.iter().map(|m| symmetric_epipolar_distance(f, m)).collect::<Vec<_>>())
                };
                let error = found.first().map_or(f64::INFINITY, |h| error(&h.fundamental));
                print!(" {error:.2}");
                let all = bins.entry(bin.clone()).or_default();
                all.0.push([error, error / sides[0].max(sides[1])]);
            }
            println!();
        }
    }
    println!("{:<12} {:>7} {:>8} {:>8}", "bin", "trials", "<1 px", "<1 %");
    for (name, Bin(errors)) in &bins {
        let share = |k: usize, limit: f64| {
            100.0 * errors.iter().filter(|e| e[k] < limit).count() as f64 / errors.len() as f64
        };
        println!("{name:<12} {:>7} {:>6.1} % {:>6.1} %", errors.len(), share(0, 1.0), share(1, 0.01));
    }
    println!(
        "median seconds: features and matches of a pair {:.3}, search {:.3}",
        median(&preparing),
        median(&searching)
    );
    Ok(())
}
