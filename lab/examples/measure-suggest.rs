//! Measures suggested second clicks on the true matches of real pairs, in both directions, with and
//! without the true F.
//!
//! `cargo run --release -p epiline-lab --example measure-suggest [VGG-FOLDER] [PAIRS-FOLDER] [EVERY]`
//!
//! Prints the fraction of clear suggestions. Among these it prints the fractions within 2 px, and
//! within 1 % of the longer side, of the true match.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use epiline::estimate::PreparedPair;
use epiline::suggest::{ClickedImage, Known, SuggestParameters, suggest};
use epiline_lab::{KnownScene, pair_scenes, vgg_scenes};

#[derive(Default)]
struct Tally {
    clicks: usize,
    best_right: usize,
    clear: usize,
    within_pixels: usize,
    within_share: usize,
    milliseconds: Vec<f64>,
}

fn measure(scene: &KnownScene, every: usize, with_f: bool, tally: &mut Tally) {
    let prepared = PreparedPair::new(&scene.images[0], &scene.images[1]);
    for m in scene.matches.iter().step_by(every) {
        for (clicked, point, truth) in
            [(ClickedImage::First, m.point1, m.point2), (ClickedImage::Second, m.point2, m.point1)]
        {
            let f = with_f.then_some(&scene.truth);
            let begun = Instant::now();
            let found = suggest(
                &prepared,
                point,
                clicked,
                &Known { fundamental: f.copied(), ..Known::default() },
                &SuggestParameters::default(),
            );
            tally.milliseconds.push(begun.elapsed().as_secs_f64() * 1e3);
            tally.clicks += 1;
            let Ok(found) = found else { continue };
            let error = (found.candidates[0].position - truth).norm();
            let right = usize::from(error <= 0.01 * scene.longer_side());
            tally.best_right += right;
            if found.clear().is_some() {
                tally.clear += 1;
                tally.within_share += right;
                tally.within_pixels += usize::from(error <= 2.0);
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |k: usize, default: &'static str| arguments.get(k).map_or(default, String::as_str);
    let every: usize = argument(2, "1").parse()?;
    let mut sets = Vec::new();
    for step in 1..=3 {
        let scenes = vgg_scenes(Path::new(argument(0, "../shared/data/house")), step, &[])?;
        sets.push((format!("views {step} apart"), every * step, scenes));
    }
    for scene in pair_scenes(Path::new(argument(1, "../shared/data/pairs")), &[])? {
        sets.push((scene.name.clone(), 1, vec![scene]));
    }
    println!(
        "pair             F      clicks  best right  clear   of clear: <2 px   <1 %    median ms  max ms"
    );
    for with_f in [false, true] {
        for (name, every, scenes) in &sets {
            let mut tally = Tally::default();
            for scene in scenes {
                measure(scene, *every, with_f, &mut tally);
            }
            tally.milliseconds.sort_by(f64::total_cmp);
            let share = |n: usize, of: usize| 100.0 * n as f64 / of.max(1) as f64;
            println!(
                "{name:<15}  {:<5} {:>7}  {:>8.1} %  {:>4.1} %  {:>13.1} % {:>6.1} %  {:>9.1}  {:>6.1}",
                if with_f { "known" } else { "none" },
                tally.clicks,
                share(tally.best_right, tally.clicks),
                share(tally.clear, tally.clicks),
                share(tally.within_pixels, tally.clear),
                share(tally.within_share, tally.clear),
                tally.milliseconds[tally.milliseconds.len() / 2],
                tally.milliseconds[tally.milliseconds.len() - 1],
            );
        }
    }
    Ok(())
}
