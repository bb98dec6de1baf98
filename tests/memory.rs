//! What pictures cost: at most twelve bytes a pixel beside the decoder, whatever is done with them. One test, because
//! tests beside it would be counted, too.

mod counting;

use std::io::Cursor;

use counting::most_held;
use epiline::features::{FeatureParameters, find_features};
use epiline::image::{Picture, PyramidPair, find_corners};
use image::ImageFormat;

/// Rows and tables that do not grow with the picture, bytes.
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
    // The pixels, the grey plane and its smaller sizes, once whoever has copies of them.
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
    println!("opening {opening}, pyramids {pyramids}, corners {corners}, features {features} bytes");
}
