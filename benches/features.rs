//! Time of detecting, describing and matching covariant features at several image sizes, and the
//! effect of the limit on the number of features. Run with `cargo bench --bench features`.

use std::hint::black_box;
use std::time::Instant;

use epiline::features::{FeatureParameters, find_features, match_features};
use epiline::geometry::{Frame, Point};
use epiline::image::GrayPlane;
use epiline::internals::comparison::median;
use epiline::synthetic::Sample;

/// Resizes the picture by bilinear interpolation. Aliasing does not affect the time.
fn resized(plane: &GrayPlane, width: usize) -> GrayPlane {
    let scale = plane.frame().width as f64 / width as f64;
    let frame = Frame::new(width, (plane.frame().height as f64 / scale) as usize);
    GrayPlane::from_fn(frame, |x, y| plane.sample(Point::new(x as f64 * scale, y as f64 * scale)))
}

/// Returns the median seconds of several runs.
fn seconds(mut run: impl FnMut()) -> f64 {
    run();
    let times: Vec<f64> = (0..7)
        .map(|_| {
            let begun = Instant::now();
            run();
            begun.elapsed().as_secs_f64()
        })
        .collect();
    median(&times)
}

fn main() {
    let sample = Sample::default().load();
    println!("Covariant features, courtyard, {} threads", rayon::current_num_threads());
    println!(
        "{:>11} {:>9} {:>9} {:>9} {:>12} {:>12}",
        "image px", "features", "", "matches", "find s", "match s"
    );
    for width in [384, 768, 1536, 3072] {
        let planes = sample.pictures.each_ref().map(|p| resized(&p.gray, width));
        // A low contrast threshold gives enough features for the limit to take effect.
        for most in [2500, 8000] {
            let parameters = FeatureParameters { most, contrast: 1.0, ..FeatureParameters::default() };
            let sets = planes.each_ref().map(|p| find_features(p, &parameters));
            let matches = match_features(&sets[0], &sets[1]);
            let finding = seconds(|| drop(black_box(find_features(black_box(&planes[0]), &parameters))));
            let matching = seconds(|| drop(black_box(match_features(&sets[0], black_box(&sets[1])))));
            println!(
                "{:>11} {:>9} {:>9} {:>9} {finding:>12.4} {matching:>12.4}",
                format!("{}×{}", planes[0].frame().width, planes[0].frame().height),
                sets[0].len(),
                sets[1].len(),
                matches.len(),
            );
        }
    }
}
