//! Time of whole estimates: until the first geometry, and until the final one. Run with
//! `cargo bench --bench estimate`.
//!
//! The built-in courtyard at several sizes, from the images on (nothing is prepared before), from its own two
//! point pairs, on all cores. Sizes other than 768 px are resampled: enlarged images hold no more detail, so
//! they tell the cost of the pixels, not of the corners they would have had.

use std::time::Instant;

use epiline::estimate::{Monitor, Parameters, Preset, estimate};
use epiline::evaluate::{mean, median};
use epiline::geometry::{Frame, Point, PointPair, symmetric_epipolar_distance};
use epiline::image::GrayPlane;
use epiline::synthetic::{Sample, SamplePair};
use image::imageops::{FilterType, resize};
use image::{ImageBuffer, Luma};

/// Image sizes and how often each is timed.
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
    // The resampler takes 1 for white.
    let values = plane.values().iter().map(|v| v / 255.0).collect();
    let buffer: ImageBuffer<Luma<f32>, Vec<f32>> =
        ImageBuffer::from_raw(from.width as u32, from.height as u32, values).expect("one value a pixel");
    let out = resize(&buffer, frame.width as u32, frame.height as u32, FilterType::CatmullRom);
    GrayPlane::new(frame, out.into_raw().iter().map(|v| 255.0 * v).collect())
}

/// Median seconds until the first and the final geometry, and the error of the final one, px.
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

/// Largest memory this process has had, MiB, where the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn main() {
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
                // Once before the clock runs, where that costs little, so that code and pages are in memory.
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
