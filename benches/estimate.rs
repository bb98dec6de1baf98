//! Time of whole estimates: until the first geometry, until the final geometry, and by stage.
//!
//! Run with `cargo bench --bench estimate`; append `-- stages` for the stages only.
//!
//! - Stages: the built-in courtyard at its own size and at 12 megapixels, and three pairs of
//!   photographs if the folder `../shared/data` exists.
//! - Sizes: the built-in courtyard at several sizes, from unprepared images and its own two point
//!   pairs, on all cores. Sizes other than 768 px are resampled. Enlarged images hold no more
//!   detail, so they measure the cost of pixels, not of additional corners.

use std::path::Path;
use std::time::Instant;

use epiline::estimate::{
    Estimate, Monitor, Parameters, PreparedPair, Preset, Stage, estimate, estimate_prepared,
};
use epiline::geometry::{Frame, Point, PointPair, Vector, symmetric_epipolar_distance};
use epiline::image::{GrayPlane, Picture};
use epiline::internals::comparison::{mean, median};
use epiline::synthetic::{Sample, SamplePair};
use image::imageops::{FilterType, resize};
use image::{ImageBuffer, Luma};

/// Image sizes, each with its number of runs.
const SIZES: [(Frame, usize); 5] = [
    (Frame { width: 192, height: 144 }, 9),
    (Frame { width: 384, height: 288 }, 7),
    (Frame { width: 768, height: 576 }, 7),
    (Frame { width: 1536, height: 1152 }, 3),
    (Frame { width: 4000, height: 3000 }, 3),
];
const NATIVE: usize = 768;

/// The sample at another size, with its clicks and matches.
struct Sized {
    planes: [GrayPlane; 2],
    clicks: Vec<PointPair>,
    matches: Vec<PointPair>,
}

impl Sized {
    fn new(sample: &SamplePair, frame: Frame) -> Self {
        let from = sample.pictures[0].frame();
        let scale = [frame.width as f64 / from.width as f64, frame.height as f64 / from.height as f64];
        let moved = |p: Point| Point::new((p.x + 0.5) * scale[0] - 0.5, (p.y + 0.5) * scale[1] - 0.5);
        let pair = |c: &PointPair| PointPair { point1: moved(c.point1), point2: moved(c.point2) };
        Self {
            planes: [0, 1].map(|k| resized(&sample.pictures[k].gray, frame)),
            clicks: sample.show_me.iter().map(pair).collect(),
            matches: sample.matches.iter().map(pair).collect(),
        }
    }
}

fn resized(plane: &GrayPlane, frame: Frame) -> GrayPlane {
    let from = plane.frame();
    if from == frame {
        return plane.clone();
    }
    // White is 1 for the resampler.
    let values = plane.values().iter().map(|v| v / 255.0).collect();
    let buffer: ImageBuffer<Luma<f32>, Vec<f32>> =
        ImageBuffer::from_raw(from.width as u32, from.height as u32, values).expect("one value a pixel");
    let out = resize(&buffer, frame.width as u32, frame.height as u32, FilterType::CatmullRom);
    GrayPlane::new(frame, out.into_raw().iter().map(|v| 255.0 * v).collect())
}

/// Returns the median seconds until the first and the final geometry, and the final error in px.
fn timed(pair: &Sized, preset: Preset, runs: usize) -> (f64, f64, f64) {
    let parameters = Parameters::from(preset);
    let (mut first, mut last, mut error) = (Vec::new(), Vec::new(), f64::NAN);
    for _ in 0..runs {
        let begun = Instant::now();
        let found = estimate(&pair.planes[0], &pair.planes[1], &pair.clicks, &parameters, &Monitor::silent())
            .expect("the sample has a geometry");
        last.push(begun.elapsed().as_secs_f64());
        first.push(found.trace.as_ref().map_or(f64::NAN, |trace| trace.first_seconds));
        let distance = |m: &PointPair| symmetric_epipolar_distance(found.fundamental(), m);
        error = mean(&pair.matches.iter().map(distance).collect::<Vec<_>>());
    }
    (median(&first), median(&last), error)
}

/// Returns the peak memory of this process in MiB, if the system reports it.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// A pair of photographs.
struct Photographs {
    name: &'static str,
    files: [&'static str; 2],
    /// Two clicks, accurate to a pixel.
    clicks: [[f64; 4]; 2],
}

const PHOTOGRAPHS: [Photographs; 3] = [
    Photographs {
        name: "house, 768 px",
        files: ["house/house.000.pgm", "house/house.001.pgm"],
        clicks: [[192.3, 363.7, 154.9, 345.8], [540.9, 172.9, 554.8, 180.7]],
    },
    Photographs {
        name: "head, 1408 px",
        files: ["pairs/headA.jpg", "pairs/headB.jpg"],
        clicks: [[1205.4, 849.2, 1241.2, 899.3], [612.5, 455.7, 693.6, 470.5]],
    },
    Photographs {
        name: "booksh, turned by 92°, 2.9 times larger",
        files: ["pairs/bookshA.png", "pairs/bookshB.png"],
        clicks: [[219.4, 376.3, 696.9, 521.7], [293.8, 149.0, 33.8, 331.9]],
    },
];
const DATA: &str = "../shared/data";
const RUNS: usize = 5;

/// Returns the seconds of each stage, and until the first and the final geometry.
fn stages(found: &Estimate) -> Vec<f64> {
    let Some(trace) = &found.trace else { return vec![f64::NAN; Stage::ALL.len() + 2] };
    let seconds =
        |stage: Stage| trace.timings.iter().filter(|t| t.stage == stage).fold(0.0, |sum, t| sum + t.seconds);
    Stage::ALL.into_iter().map(seconds).chain([trace.first_seconds, trace.seconds]).collect()
}

/// Prints one row of times: medians over the runs, milliseconds.
fn print_stages(name: &str, runs: &[Estimate]) {
    let times: Vec<Vec<f64>> = runs.iter().map(stages).collect();
    print!("{name:<42}");
    for k in 0..Stage::ALL.len() + 2 {
        print!(" {:>8.0}", 1e3 * median(&times.iter().map(|run| run[k]).collect::<Vec<_>>()));
    }
    let verdict = runs.last().and_then(|run| run.assessment.trust.as_ref()).map_or("", |t| t.verdict.label());
    println!("  {verdict}");
}

/// Times estimates from unprepared images, and with the images prepared after both clicks moved
/// slightly.
fn time_stages(name: &str, planes: &[GrayPlane; 2], clicks: &[PointPair]) {
    let (parameters, silent) = (Parameters::from(Preset::Robust), Monitor::silent());
    let moved = |by: f64| -> Vec<PointPair> {
        clicks.iter().map(|c| PointPair { point1: c.point1 + Vector::new(by, 0.0), ..*c }).collect()
    };
    let found: Result<Vec<Estimate>, _> =
        (0..RUNS).map(|_| estimate(&planes[0], &planes[1], clicks, &parameters, &silent)).collect();
    match found {
        Ok(found) => print_stages(name, &found),
        Err(error) => return println!("{name:<42} failed: {error}"),
    }
    let prepared: Result<Vec<Estimate>, _> = (0..RUNS)
        .map(|_| {
            let prepared = PreparedPair::new(&planes[0], &planes[1]);
            estimate_prepared(&prepared, &moved(1.0), &parameters, &silent)?;
            estimate_prepared(&prepared, clicks, &parameters, &silent)
        })
        .collect();
    if let Ok(found) = prepared {
        print_stages("  the same after a click was moved", &found);
    }
}

fn all_stages() {
    println!(
        "Stages of an estimate, robust, two pairs, {} threads; ms, medians",
        rayon::current_num_threads()
    );
    let words = ["pyramid", "pencils", "hypoth.", "validat.", "refine", "features", "first F", "final F"];
    println!("{:<42} {}", "", words.map(|word| format!("{word:>8}")).join(" "));
    let sample = Sample::default().load();
    for (name, frame) in [("courtyard, 768 px", SIZES[2].0), ("courtyard, 12 megapixels", SIZES[4].0)] {
        let pair = Sized::new(&sample, frame);
        time_stages(name, &pair.planes, &pair.clicks);
    }
    for Photographs { name, files, clicks } in PHOTOGRAPHS {
        let paths = files.map(|file| Path::new(DATA).join(file));
        if !paths.iter().all(|path| path.exists()) {
            println!("{name:<42} skipped: there is no {}", paths[0].display());
            continue;
        }
        let planes = paths.each_ref().map(|path| Picture::open(path).expect("a picture").gray);
        let clicks = clicks.map(|[x1, y1, x2, y2]| PointPair::new(x1, y1, x2, y2));
        time_stages(name, &planes, &clicks);
    }
}

fn main() {
    all_stages();
    // `cargo bench` adds an argument of its own.
    if !std::env::args().any(|argument| argument == "stages") {
        sizes();
    }
}

fn sizes() {
    let sample = Sample::default().load();
    println!(
        "Whole estimate, courtyard, two pairs, {} threads; medians; ratios to {NATIVE} px",
        rayon::current_num_threads()
    );
    println!(
        "{:<8} {:>11} {:>5} {:>9} {:>9} {:>7} {:>7} {:>9}",
        "preset", "image px", "runs", "first s", "final s", "first", "final", "error px"
    );
    for preset in [Preset::Robust, Preset::Paper] {
        let rows: Vec<_> = SIZES
            .iter()
            .map(|(frame, runs)| {
                // An untimed run at small sizes loads code and pages into memory.
                let pair = Sized::new(&sample, *frame);
                if frame.width <= NATIVE {
                    timed(&pair, preset, 1);
                }
                (*frame, *runs, timed(&pair, preset, *runs))
            })
            .collect();
        let native =
            rows.iter().find(|(frame, ..)| frame.width == NATIVE).map_or((1.0, 1.0), |r| (r.2.0, r.2.1));
        for (frame, runs, (first, last, error)) in rows {
            println!(
                "{:<8} {:>11} {runs:>5} {first:>9.3} {last:>9.3} {:>7.2} {:>7.2} {error:>9.3}",
                preset.name(),
                format!("{}×{}", frame.width, frame.height),
                first / native.0,
                last / native.1,
            );
        }
    }
    if let Some(peak) = peak_memory() {
        println!("Largest memory of this process, images and resampling included: {peak:.0} MiB");
    }
}
