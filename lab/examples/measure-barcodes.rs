//! Measures geometry from motion barcodes on synthetic sequences, with two clicks and without.
//! Prints the error against the number of frames, the number of moving objects, and the noise in
//! the masks, as a table in Markdown.
//!
//! `cargo run --release -p epiline-lab --example measure-barcodes [SEEDS [PART OF A NAME]]`

use std::sync::Arc;

use epiline::estimate::{CancelFlag, Monitor, Parameters, PreparedPair, estimate_prepared};
use epiline::geometry::{PointPair, symmetric_epipolar_distance};
use epiline::image::GrayPlane;
use epiline::motion::{BackgroundParameters, Silhouettes, find_offset};
use epiline::similarity::LineMeasure;
use epiline::synthetic::{BallScene, ThrownBalls};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// A synthetic recording and the source of its masks.
struct Case {
    name: String,
    thrown: ThrownBalls,
    /// Fraction of the pixels flipped in the exact masks; `None` computes the masks from the
    /// pictures.
    mask_noise: Option<f64>,
}

fn main() {
    let seeds: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(3);
    let usual = ThrownBalls::default();
    let case = |name: &str, thrown, mask_noise| Case { name: name.into(), thrown, mask_noise };
    let mut cases = vec![case("as it is", usual, None)];
    for frames in [75, 150, 600] {
        cases.push(case(&format!("{frames} frames"), ThrownBalls { frames, ..usual }, None));
    }
    for balls in [1, 2, 4, 16] {
        cases.push(case(&format!("{balls} balls"), ThrownBalls { balls, ..usual }, None));
    }
    for percent in [0, 2, 5, 10] {
        let name = format!("exact masks, {percent} % of the pixels flipped");
        cases.push(case(&name, usual, Some(f64::from(percent) / 100.0)));
    }
    let half = ThrownBalls { frames: 150, offset: 7, ..usual };
    cases.push(case("150 frames, 2 % of the pixels flipped, offset 7", half, Some(0.02)));
    println!("| recording | offset found | no clicks, px | verdict | two clicks, px | verdict | seconds |");
    println!("|---|---|---|---|---|---|---|");
    let part = std::env::args().nth(2).unwrap_or_default();
    for case in cases.iter().filter(|case| case.name.contains(&part)) {
        for seed in 1..=seeds {
            println!(
                "{}",
                row(case, seed).unwrap_or_else(|problem| format!("| {} | {problem} |", case.name))
            );
        }
    }
}

fn row(case: &Case, seed: u64) -> Result<String, String> {
    let cancel = CancelFlag::default();
    let scene = BallScene::new(ThrownBalls { seed, ..case.thrown }).ok_or("no frame")?;
    let begun = std::time::Instant::now();
    let silhouettes = match case.mask_noise {
        None => {
            let sequences = scene.sequences().ok_or("no frame")?;
            let of = |s| Silhouettes::new(s, &BackgroundParameters::default(), &cancel);
            [of(&sequences[0]), of(&sequences[1])]
        }
        Some(noise) => [0, 1].map(|camera| {
            let mut random = Pcg32::seed_from_u64(seed * 2 + camera as u64);
            let masks: Vec<Vec<bool>> = (0..case.thrown.frames)
                .map(|number| {
                    let flip = |pixel: bool| pixel != (random.random::<f64>() < noise);
                    scene.mask(camera, number).into_iter().map(flip).collect()
                })
                .collect();
            Silhouettes::from_masks("made", case.thrown.frame, case.thrown.frame, masks)
        }),
    };
    let [first, second] = silhouettes.map(|s| s.map_err(|e| e.to_string()));
    let (first, second) = (first?, second?);
    let offsets = find_offset([&first, &second], 50, &cancel).map_err(|e| e.to_string())?;
    let offset = offsets.first().ok_or("no offset")?.offset;
    let both = Silhouettes::overlapping([&first, &second], offset).map_err(|e| e.to_string())?;
    let flat = GrayPlane::from_fn(case.thrown.frame, |x, y| ((x * 7 + y * 13) % 97) as f32);
    let other = GrayPlane::from_fn(case.thrown.frame, |x, y| ((x * 11 + y * 5) % 89) as f32);
    let prepared = PreparedPair::new(&flat, &other).with_silhouettes(both.map(Arc::new));
    let matches = scene.matches(200);
    let clicks: Vec<PointPair> = vec![matches[0], matches[1]];
    let mut parameters = Parameters { seed, ..Parameters::default() };
    parameters.similarity.measure = LineMeasure::Barcodes;
    let measured =
        |clicks: &[PointPair]| match estimate_prepared(&prepared, clicks, &parameters, &Monitor::silent()) {
            Ok(found) => {
                let f = found.fundamental();
                let sum: f64 = matches.iter().map(|m| symmetric_epipolar_distance(f, m)).sum();
                let trust = found.assessment.trust.as_ref().map_or("", |t| t.verdict.label());
                let figures = found.assessment.barcodes.map_or(String::new(), |b| {
                    format!(
                        "{:.2}/{:.2} {:.0} lines dev {:.2} m {:.2}",
                        b.correlation,
                        b.by_chance,
                        b.lines,
                        b.deviation.unwrap_or(-1.0),
                        found.assessment.margin.unwrap_or(-1.0)
                    )
                });
                format!("{:.2} | {trust} {figures}", sum / matches.len() as f64)
            }
            Err(error) => format!("– | {error}"),
        };
    let (none, two) = (measured(&[]), measured(&clicks));
    let seconds = begun.elapsed().as_secs_f64();
    Ok(format!("| {} | {offset} | {none} | {two} | {seconds:.1} |", case.name))
}
