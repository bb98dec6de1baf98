//! Time of comparing two pencils line by line, the stage that grows fastest with the image size:
//! lines × lines × samples × disparities. Run with `cargo bench --bench pencils`.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use epiline::estimate::{Parameters, Preset};
use epiline::geometry::{AnchoredLine, Frame, Point, pencil_angles};
use epiline::image::{GrayPlane, Pyramid};
use epiline::internals::comparison::median;
use epiline::similarity::{DisparityRange, LineSimilarity, StereoSimilarity};
use epiline::synthetic::Sample;

/// Returns the lines through a point in one direction or in both.
fn pencil(frame: Frame, point: Point, spacing: f64, both: bool) -> Vec<AnchoredLine> {
    let half = pencil_angles(frame.farthest_corner(point), spacing);
    let reversed = half.iter().map(|a| a + PI).take(if both { half.len() } else { 0 });
    half.iter().copied().chain(reversed).map(|a| AnchoredLine::at_angle(point, a)).collect()
}

fn main() {
    let sample = Sample::default().load();
    let pyramids = sample.pictures.each_ref().map(|p| Pyramid::new(&p.gray, 90.0));
    println!("Pencil against pencil, courtyard, {} threads", rayon::current_num_threads());
    println!(
        "{:<8} {:>11} {:>7} {:>7} {:>12} {:>9} {:>12}",
        "preset", "image px", "lines", "lines", "disparities", "seconds", "pairs a s"
    );
    for preset in [Preset::Robust, Preset::Paper] {
        let parameters = Parameters::from(preset);
        // Full size is omitted: the estimator compares pencils at a coarse level, and full size
        // takes sixteen times as long as half the size.
        for level in (1..pyramids[0].count()).rev() {
            let planes: [&GrayPlane; 2] = [pyramids[0].level(level), pyramids[1].level(level)];
            let frame = planes[0].frame();
            let scale = 0.5f64.powi(level as i32);
            let click = sample.show_me[0].rescaled([scale; 2]);
            let lines1 = pencil(frame, click.point1, parameters.pencils.line_spacing, false);
            let lines2 = pencil(frame, click.point2, parameters.pencils.line_spacing, true);
            let reach = (parameters.similarity.disparity_reach * frame.longer_side()).round() as i32;
            let similarity = StereoSimilarity {
                planes,
                range: DisparityRange::symmetric(reach),
                parameters: parameters.similarity.stereo,
            };
            let allowed = |i: usize, j: usize| {
                let turn = (lines2[j].angle() - lines1[i].angle()).rem_euclid(TAU);
                turn.min(TAU - turn) <= parameters.pencils.rotation + 1e-9
            };
            let pairs: usize =
                (0..lines1.len()).map(|i| (0..lines2.len()).filter(|j| allowed(i, *j)).count()).sum();
            let times: Vec<f64> = (0..5)
                .map(|_| {
                    let begun = Instant::now();
                    black_box(similarity.cost_matrix(&lines1, &lines2, &allowed, &|| false));
                    begun.elapsed().as_secs_f64()
                })
                .collect();
            let seconds = median(&times);
            println!(
                "{:<8} {:>11} {:>7} {:>7} {:>12} {seconds:>9.4} {:>12.0}",
                preset.name(),
                format!("{}×{}", frame.width, frame.height),
                lines1.len(),
                lines2.len(),
                similarity.range.len(),
                pairs as f64 / seconds,
            );
        }
    }
}
