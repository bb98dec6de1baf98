//! Memory of pictures: at most twelve bytes per pixel besides the decoder. A single test, because
//! tests running in parallel would be counted too.

mod counting;

use std::io::Cursor;

use counting::most_held;
use epiline::features::{FeatureParameters, find_features};
use epiline::image::{LoadOptions, Picture, PyramidPair, find_corners};
use image::ImageFormat;

/// Memory independent of the picture size, bytes.
const SLACK: usize = 24 << 20;

#[test]
fn a_picture_takes_at_most_twelve_bytes_a_pixel() {
    let (width, height) = (4000, 3000);
    let pixels = (width * height) as usize;
    let colours = image::RgbImage::from_fn(width, height, |x, y| {
        let v = (x / 9 * 37 + y / 11 * 101 + x * y / 700) % 253;
        image::Rgb([v as u8, (v / 2 + x % 5) as u8, 90])
    });
    let mut file = Cursor::new(Vec::new());
    colours.write_to(&mut file, ImageFormat::Png).unwrap();
    drop(colours);
    let file = file.into_inner();
    let (opening, picture) = most_held(|| Picture::from_bytes("large", &file).unwrap());
    assert!(opening < 12 * pixels + SLACK, "opening: {:.1} bytes a pixel", opening as f64 / pixels as f64);
    // The pixels, the grey plane and its smaller levels exist once, however many handles there are.
    let (pyramids, pair) = most_held(|| PyramidPair::new(&picture.gray, &picture.gray.clone(), 48.0));
    assert!(
        pyramids < 2 * 2 * pixels + SLACK,
        "pyramids: {:.1} bytes a pixel",
        pyramids as f64 / pixels as f64
    );
    let (corners, found) = most_held(|| find_corners(pair.level(f64::INFINITY).planes[0], 4000, 8));
    assert!(!found.is_empty());
    assert!(corners < 3 * pixels + SLACK, "corners: {:.1} bytes a pixel", corners as f64 / pixels as f64);
    let (features, _) = most_held(|| find_features(&picture.gray, &FeatureParameters::default()));
    let (claimed, ()) = most_held(|| {
        let options = LoadOptions { most_pixels: 100_000 };
        for file in [webp_with_metadata(0x7fff_ff00), webp_with_frame([16_000, 8_000])] {
            // The file may be read or refused, without allocating gigabytes.
            let _ = Picture::from_bytes_with("claims", &file, options);
        }
    });
    assert!(claimed < SLACK, "{claimed} bytes for what a WebP file claims");
    println!("opening {opening}, pyramids {pyramids}, corners {corners}, features {features} bytes");
}

/// Returns a chunk of a WebP file.
fn chunk(name: [u8; 4], length: u32, content: &[u8]) -> Vec<u8> {
    [&name[..], &length.to_le_bytes(), content].concat()
}

/// Returns a WebP file of 32×24 px with flags and chunks.
fn webp(flags: u8, chunks: &[u8]) -> Vec<u8> {
    let header = chunk(*b"VP8X", 10, &[flags, 0, 0, 0, 31, 0, 0, 23, 0, 0]);
    let content = [b"WEBP".to_vec(), header, chunks.to_vec()].concat();
    chunk(*b"RIFF", content.len() as u32, &content)
}

/// Returns a small picture whose EXIF chunk claims `length` bytes.
fn webp_with_metadata(length: u32) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image::GrayImage::new(32, 24).write_to(&mut file, ImageFormat::WebP).unwrap();
    webp(0x08, &[&file.into_inner()[12..], &chunk(*b"EXIF", length, b"Exif")].concat())
}

/// Returns a small animation whose first frame is coded at another size.
fn webp_with_frame([width, height]: [u16; 2]) -> Vec<u8> {
    let mut coded = vec![0x10, 0, 0, 0x9d, 1, 0x2a];
    coded.extend([width.to_le_bytes(), height.to_le_bytes()].concat());
    coded.extend([0x55; 60]);
    let coded = chunk(*b"VP8 ", coded.len() as u32, &coded);
    let place = [0, 0, 0, 0, 0, 0, 31, 0, 0, 23, 0, 0, 40, 0, 0, 0];
    let frame = chunk(*b"ANMF", (place.len() + coded.len()) as u32, &[&place[..], &coded].concat());
    webp(0x02, &[chunk(*b"ANIM", 6, &[0; 6]), frame].concat())
}
