//! Renders the built-in sample pairs into `assets/` (or the folder given), the same bytes every time.
//!
//! Minutes of work: `cargo run --release -p epiline-lab --example render-samples [FOLDER]`.
//!
//! A small ray-caster of scenes with exact cameras: everything a picture shows follows from a `scene::Scene` and a
//! camera, so the fundamental matrix and the matches of a pair are known to rounding. `render` casts a grid of rays
//! through every pixel and shades what they meet; `matches` casts one ray in image 1, projects what it meets into
//! image 2 and casts a second ray back to see that nothing hides it; `landmarks` chooses the matches that are shipped.
//!
//! Source: textbook ray casting (Pharr, Jakob & Humphreys, *Physically Based Rendering*) and the pinhole camera of
//! Hartley & Zisserman, chapter 6.
//!
//! # Pitfalls
//! Mirrors and glass would show things that obey another geometry; surfaces here are diffuse with slight highlights.

mod alley;
mod build;
mod courtyard;
mod furnish;
mod landmarks;
mod light;
mod matches;
mod noise;
mod ray;
mod render;
mod scene;
mod shading;
mod shape;
#[cfg(test)]
mod tests;
mod texture;

use std::error::Error;
use std::fs;
use std::path::Path;

use epiline::geometry::{Camera, Frame, Point, PointPair};
use epiline::image::GrayPlane;
use epiline::synthetic::{SAMPLE_FRAME, Sample, SampleFile};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbImage};

use crate::scene::Scene;

/// A sample's scene, its cameras for a picture size, its name for people and a sentence about it.
fn setting(sample: Sample, frame: Frame) -> Option<(Scene, [Camera; 2], [&'static str; 2])> {
    Some(match sample {
        Sample::Courtyard => (
            courtyard::scene(),
            courtyard::cameras(frame)?,
            [
                "Courtyard",
                "A fountain in a courtyard, seen from two places side by side: the epipoles lie far outside \
                 the pictures.",
            ],
        ),
        Sample::Alley => (
            alley::scene(),
            alley::cameras(frame)?,
            [
                "Alley",
                "An alley with an archway, seen before and after a step forward: both epipoles lie inside \
                 the pictures.",
            ],
        ),
    })
}

/// Places in picture 1 of the pairs that "Show me" clicks. Those of the alley have their true epipolar lines among the
/// first candidates, so that the replay of the search can show them.
fn first_shown(sample: Sample) -> Option<[Point; 2]> {
    match sample {
        Sample::Courtyard => None,
        Sample::Alley => Some([Point::new(248.0, 510.0), Point::new(612.0, 453.0)]),
    }
}

/// Renders a pair and finds its landmarks. `None` when no three of them are separated.
fn make(sample: Sample) -> Option<([RgbImage; 2], SampleFile)> {
    let frame = SAMPLE_FRAME;
    let (scene, cameras, [title, description]) = setting(sample, frame)?;
    let picture = |k: usize| render::render(&scene, &cameras[k], frame, 1 + k as u64);
    let pictures = [picture(0)?, picture(1)?];
    let [plane1, plane2] = pictures.each_ref().map(|p| {
        GrayPlane::from_fn(frame, |x, y| {
            let [r, g, b] = p.get_pixel(x as u32, y as u32).0.map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        })
    });
    let found = landmarks::landmarks(&scene, &cameras, frame, [&plane1, &plane2], first_shown(sample))?;
    let rows = |c: &Camera| c.matrix().transpose().data.0;
    let row = |pair: &PointPair| [pair.point1.x, pair.point1.y, pair.point2.x, pair.point2.y];
    let file = SampleFile {
        name: sample.name().to_owned(),
        title: title.to_owned(),
        description: description.to_owned(),
        fundamental: Camera::fundamental(&cameras[0], &cameras[1])?,
        camera1: rows(&cameras[0]),
        camera2: rows(&cameras[1]),
        matches: found.matches.iter().map(row).collect(),
        show_me: found.show_me.each_ref().map(row),
        third: row(&found.third),
    };
    Some((pictures, file))
}

fn png(picture: &RgbImage) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    DynamicImage::ImageRgb8(picture.clone()).write_with_encoder(encoder)?;
    Ok(bytes)
}

/// Writes beside the target first, so that an interrupted run leaves the old file whole.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let fresh = path.with_extension("new");
    fs::write(&fresh, bytes)?;
    fs::rename(fresh, path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "assets".to_owned());
    let folder = Path::new(&folder);
    for sample in Sample::ALL {
        let (pictures, file) = make(sample).ok_or("the scene has no separated landmarks")?;
        for (k, picture) in pictures.iter().enumerate() {
            let bytes = png(picture)?;
            let path = folder.join(format!("{}-{}.png", sample.name(), k + 1));
            println!("{}: {} bytes", path.display(), bytes.len());
            replace(&path, &bytes)?;
        }
        let mut text = serde_json::to_string_pretty(&file)?;
        text.push('\n');
        println!("{}: {} matches", sample.name(), file.matches.len());
        replace(&folder.join(format!("{}.json", sample.name())), text.as_bytes())?;
    }
    Ok(())
}
