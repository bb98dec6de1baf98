//! Focal lengths in the EXIF data of photographs.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exif::{Exif, In, Tag, Value};

use crate::camera::FocalLength;
use crate::geometry::Frame;

/// Relative standard deviation of a focal length from EXIF data. Written focal lengths are rounded to
/// 1 mm of some 30, and focusing changes them by a few percent. A chosen value.
const EXIF_DEVIATION: f64 = 0.05;
/// Diagonal of 35 mm film, mm: equivalent focal lengths have equal diagonal fields of view (CIPA
/// DCG-001).
const FILM_DIAGONAL: f64 = 43.267;
/// Largest relative difference between the side ratios of a photograph and of a picture that shows all
/// of it: rounding of a thumbnail.
const SAME_RATIO: f64 = 0.02;

/// Guesses the focal length of a photograph of this size from its EXIF data. `None` without a focal
/// length, without the size of the sensor, and for a picture that was cut out of a photograph.
pub fn focal_length_from_exif(path: &Path, frame: Frame) -> Option<FocalLength> {
    let mut file = BufReader::new(File::open(path).ok()?);
    let exif = exif::Reader::new().read_from_container(&mut file).ok()?;
    Some(FocalLength { pixels: focal_length(&exif, frame)?, deviation: EXIF_DEVIATION })
}

/// Returns the focal length in pixels of the picture.
fn focal_length(exif: &Exif, frame: Frame) -> Option<f64> {
    let longer = |[a, b]: [f64; 2]| [a.max(b), a.min(b)];
    let [width, height] = longer([frame.width as f64, frame.height as f64]);
    let written = number(exif, Tag::PixelXDimension).zip(number(exif, Tag::PixelYDimension));
    let written = written.map(|(width, height)| longer([width, height]));
    if written.is_some_and(|[a, b]| (width / height / (a / b) - 1.0).abs() > SAME_RATIO) {
        return None;
    }
    if let Some(equivalent) = number(exif, Tag::FocalLengthIn35mmFilm) {
        return Some(equivalent / FILM_DIAGONAL * width.hypot(height));
    }
    let millimetres = match number(exif, Tag::FocalPlaneResolutionUnit) {
        Some(3.0) => 10.0,
        _ => 25.4,
    };
    let pixels = number(exif, Tag::FocalLength)? / millimetres * number(exif, Tag::FocalPlaneXResolution)?;
    Some(pixels * width / written?[0])
}

/// Returns a positive number of the EXIF data.
fn number(exif: &Exif, tag: Tag) -> Option<f64> {
    let value = &exif.get_field(tag, In::PRIMARY)?.value;
    let number = match value {
        Value::Rational(all) => all.first()?.to_f64(),
        _ => f64::from(value.get_uint(0)?),
    };
    (number.is_finite() && number > 0.0).then_some(number)
}

#[cfg(test)]
mod tests {
    use exif::{Field, Rational};

    use super::*;

    fn photograph(fields: &[(Tag, Value)]) -> Exif {
        let fields: Vec<Field> = fields
            .iter()
            .map(|(tag, value)| Field { tag: *tag, ifd_num: In::PRIMARY, value: value.clone() })
            .collect();
        let mut writer = exif::experimental::Writer::new();
        for field in &fields {
            writer.push_field(field);
        }
        let mut written = std::io::Cursor::new(Vec::new());
        writer.write(&mut written, false).unwrap();
        exif::Reader::new().read_raw(written.into_inner()).unwrap()
    }

    fn rational(num: u32, denom: u32) -> Value {
        Value::Rational(vec![Rational { num, denom }])
    }

    #[test]
    fn focal_lengths_are_in_pixels_of_the_picture() {
        let size = |width: u32, height: u32| {
            [
                (Tag::PixelXDimension, Value::Long(vec![width])),
                (Tag::PixelYDimension, Value::Long(vec![height])),
            ]
        };
        let phone = photograph(
            &[&size(4000, 3000)[..], &[(Tag::FocalLengthIn35mmFilm, Value::Short(vec![26]))]].concat(),
        );
        let found = |exif: &Exif, width, height| focal_length(exif, Frame::new(width, height));
        assert!((found(&phone, 4000, 3000).unwrap() - 3004.6).abs() < 0.1);
        assert!((found(&phone, 750, 1000).unwrap() - 751.15).abs() < 0.1, "a smaller copy, turned");
        assert_eq!(found(&phone, 3000, 3000), None, "a part of the photograph");
        let sensor =
            [(Tag::FocalLength, rational(173, 32)), (Tag::FocalPlaneXResolution, rational(640_000, 206))];
        let camera = photograph(&[&size(640, 480)[..], &sensor].concat());
        assert!((found(&camera, 640, 480).unwrap() - 661.3).abs() < 0.1);
        assert!((found(&camera, 320, 240).unwrap() - 330.6).abs() < 0.1);
        assert_eq!(found(&photograph(&sensor), 640, 480), None, "pixels of unknown size");
        assert_eq!(found(&photograph(&sensor[..1]), 640, 480), None);
        let nonsense = [(Tag::FocalLength, rational(5, 0)), (Tag::FocalPlaneXResolution, rational(0, 0))];
        assert_eq!(found(&photograph(&[&size(640, 480)[..], &nonsense].concat()), 640, 480), None);
    }
}
