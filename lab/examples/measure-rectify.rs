//! Measures rectification with the true F of real pairs and of the built-in samples, by both
//! methods.
//!
//! `cargo run --release -p epiline-lab --example measure-rectify [VGG-FOLDER] [PAIRS-FOLDER] [PICTURE-FOLDER]`
//!
//! Prints the vertical distance of all true matches, shape, size and time of each pair, and the
//! time of a pair of 4000×3000 px. Into a third folder it writes the pictures with guide lines, and
//! the files that `compare-rectify.py` compares with OpenCV.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use epiline::estimate::CancelFlag;
use epiline::geometry::{Camera, Frame};
use epiline::image::GrayPlane;
use epiline::io::{PictureFormat, encode_picture};
use epiline::rectify::{Distortion, Limits, RectifyMethod, rectify, side_by_side};
use epiline::synthetic::{Motion, Sample};
use epiline_lab::{KnownScene, pair_scenes, vgg_scenes};
use image::{DynamicImage, GrayImage, RgbImage};
use serde_json::json;

fn picture(plane: &GrayPlane) -> DynamicImage {
    let values = plane.values().iter().map(|v| v.round() as u8).collect();
    GrayImage::from_raw(plane.frame().width as u32, plane.frame().height as u32, values)
        .map(DynamicImage::from)
        .unwrap_or_default()
}

fn shape(d: &Distortion) -> String {
    let number = |v: Option<f64>, digits: usize| v.map_or("   -".into(), |v| format!("{v:.digits$}"));
    format!(
        "{:>6} {:>6} {:>4.0} {:>4.0} {:>4.0}",
        number(d.orthogonality, 1),
        number(d.aspect_ratio, 3),
        100.0 * d.cut,
        100.0 * d.shrunk,
        100.0 * d.stretched
    )
}

/// Writes the images, F, the matches and the planar homographies of a pair, for
/// `compare-rectify.py`.
fn write_pair(folder: &Path, scene: &KnownScene) -> Result<(), Box<dyn Error>> {
    let frames = [scene.images[0].frame(), scene.images[1].frame()];
    let mut pair = json!({
        "fundamental": scene.truth,
        "sizes": frames.map(|f| [f.width, f.height]),
        "matches": scene.matches.iter().map(|m| [m.point1.x, m.point1.y, m.point2.x, m.point2.y]).collect::<Vec<_>>(),
    });
    match rectify(&scene.truth, frames, &scene.matches, RectifyMethod::Planar, &Limits::default()) {
        Ok(found) => {
            let homographies = found.maps.each_ref().map(|map| {
                let h = map.homography().copied().unwrap_or_default();
                [0, 1, 2].map(|r| [0, 1, 2].map(|c| h[(r, c)]))
            });
            pair["homographies"] = json!(homographies);
            pair["size"] = json!([found.size.width, found.size.height]);
            let [left, right] = found.measures.distortion;
            pair["cut"] = json!(f64::midpoint(left.cut, right.cut));
        }
        Err(error) => pair["reason"] = json!(error.to_string()),
    }
    std::fs::write(folder.join(format!("{}.json", scene.name)), pair.to_string())?;
    for (k, image) in scene.images.iter().enumerate() {
        let file = folder.join(format!("{}-{}.png", scene.name, k + 1));
        std::fs::write(file, encode_picture(&picture(image), PictureFormat::Png)?)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |k: usize, default: &'static str| arguments.get(k).map_or(default, String::as_str);
    let mut scenes = vgg_scenes(Path::new(argument(0, "../shared/data/house")), 1, &[])?;
    scenes.extend(pair_scenes(Path::new(argument(1, "../shared/data/pairs")), &[])?);
    scenes.extend(Sample::ALL.map(|sample| KnownScene::of_sample(sample.name(), sample.load())));
    println!(
        "|dy| in px over the true matches; angle of the middle lines, ratio of the diagonals, % cut, below half, above twice the area"
    );
    println!(
        "{:<10} {:<7} {:>6} {:>6} {:>11}  {:<30} {:<30} {:>6}",
        "pair", "method", "mean", "max", "size", "left", "right", "ms"
    );
    for scene in &scenes {
        let frames = [scene.images[0].frame(), scene.images[1].frame()];
        let pictures = [picture(&scene.images[0]), picture(&scene.images[1])];
        if let Some(folder) = arguments.get(2) {
            write_pair(Path::new(folder), scene)?;
        }
        let auto = rectify(&scene.truth, frames, &scene.matches, RectifyMethod::Auto, &Limits::default())?;
        for method in [RectifyMethod::Planar, RectifyMethod::Polar] {
            let begun = Instant::now();
            let found = match rectify(&scene.truth, frames, &scene.matches, method, &Limits::default()) {
                Ok(found) => found,
                Err(error) => {
                    println!("{:<10} {:<7} {error}", scene.name, method.name());
                    continue;
                }
            };
            let never = CancelFlag::default();
            let drawn = [0, 1].map(|k| found.warp(k, &pictures[k], &never).unwrap_or_default());
            let milliseconds = begun.elapsed().as_secs_f64() * 1e3;
            let rows = found.measures.rows.ok_or("no match is in both pictures")?;
            println!(
                "{:<10} {:<7} {:>6.3} {:>6.3} {:>11}  {:<30} {:<30} {milliseconds:>6.0}{}",
                scene.name,
                method.name(),
                rows.mean,
                rows.max,
                format!("{}x{}", found.size.width, found.size.height),
                shape(&found.measures.distortion[0]),
                shape(&found.measures.distortion[1]),
                if auto.method == method { " (auto)" } else { "" }
            );
            if let Some(folder) = arguments.get(2) {
                let both = DynamicImage::from(side_by_side([&drawn[0], &drawn[1]], 40));
                let file = Path::new(folder).join(format!("{}-{}.png", scene.name, method.name()));
                std::fs::write(file, encode_picture(&both, PictureFormat::Png)?)?;
            }
        }
    }
    let frame = Frame::new(4000, 3000);
    let large = DynamicImage::from(RgbImage::from_fn(4000, 3000, |x, y| {
        image::Rgb([(x / 16) as u8, (y / 12) as u8, (x ^ y) as u8])
    }));
    for motion in Motion::ALL {
        let cameras = motion.cameras(frame).ok_or("no cameras")?;
        let f = Camera::fundamental(&cameras[0], &cameras[1]).ok_or("no F")?;
        let mut seconds = Vec::new();
        let mut what = String::new();
        for _ in 0..3 {
            let begun = Instant::now();
            let found = rectify(&f, [frame; 2], &[], RectifyMethod::Auto, &Limits::default())?;
            let never = CancelFlag::default();
            let drawn = [0, 1].map(|k| found.warp(k, &large, &never));
            seconds.push(begun.elapsed().as_secs_f64());
            what = format!("{} {}x{}", found.method.name(), found.size.width, found.size.height);
            drop(drawn);
        }
        seconds.sort_by(f64::total_cmp);
        println!("4000x3000, colour, {motion:?}: {what}, {:.2} s (median of 3)", seconds[1]);
    }
    Ok(())
}
