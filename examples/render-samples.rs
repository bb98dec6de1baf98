//! Renders the built-in sample pairs into `assets/` (or the folder given), the same bytes every time.
//!
//! Minutes of work: `cargo run --release --example render-samples [FOLDER]`.

use std::error::Error;
use std::fs;
use std::path::Path;

use epiline::synthetic::{Quality, Sample};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbImage};

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
        let (pictures, file) =
            sample.make(&Quality::default()).ok_or("the scene has no separated landmarks")?;
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
