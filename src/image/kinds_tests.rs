//! Tests of picture kinds, with small files made here.

use image::{DynamicImage, ImageBuffer, Luma};

use super::{LoadError, LoadOptions, Picture};
use crate::geometry::Point;

const WIDTH: usize = 60;
const HEIGHT: usize = 44;

fn texture(x: usize, y: usize) -> usize {
    (x * x * 3 + y * y * 5 + x * y * 7) % 200
}

fn values() -> impl Iterator<Item = usize> {
    (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| texture(x, y)))
}

/// A TIFF file of one strip.
struct Tiff {
    big: bool,
    /// Tag, type and values of each entry, besides size, strip and rows.
    entries: Vec<(u16, u16, Vec<u64>)>,
    strips: Vec<Vec<u8>>,
}

impl Tiff {
    fn new(bits: u64, photometric: u64, strip: Vec<u8>) -> Self {
        let entries = vec![(258, 3, vec![bits]), (262, 3, vec![photometric]), (259, 3, vec![1])];
        Self { big: false, entries, strips: vec![strip] }
    }

    fn with(mut self, tag: u16, kind: u16, values: impl IntoIterator<Item = u64>) -> Self {
        self.entries.retain(|entry| entry.0 != tag);
        self.entries.push((tag, kind, values.into_iter().collect()));
        self
    }

    fn with_text(self, tag: u16, text: &str) -> Self {
        self.with(tag, 2, text.bytes().chain([0]).map(u64::from))
    }

    fn bytes(&self) -> Vec<u8> {
        let width = if self.big { 8 } else { 4 };
        let mut entries = self.entries.clone();
        entries.extend([
            (256, 3, vec![WIDTH as u64]),
            (257, 3, vec![HEIGHT as u64]),
            (278, 3, vec![HEIGHT as u64]),
        ]);
        let header = if self.big { 16 } else { 8 };
        let mut file =
            if self.big { b"II+\0\x08\0\0\0\0\0\0\0\0\0\0\0".to_vec() } else { b"II*\0\0\0\0\0".to_vec() };
        let (mut places, mut lengths) = (Vec::new(), Vec::new());
        for strip in &self.strips {
            places.push(file.len() as u64);
            lengths.push(strip.len() as u64);
            file.extend(strip);
        }
        let kind = if self.big { 16 } else { 4 };
        entries.extend([(273, kind, places), (279, kind, lengths)]);
        entries.sort();
        let mut directory = Vec::new();
        directory.extend(&(entries.len() as u64).to_le_bytes()[..if self.big { 8 } else { 2 }]);
        for (tag, kind, values) in &entries {
            let size = match kind {
                3 => 2,
                4 => 4,
                16 => 8,
                _ => 1,
            };
            let mut content: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()[..size].to_vec()).collect();
            if content.len() > width {
                let place = file.len() as u64;
                file.extend(&content);
                content = place.to_le_bytes()[..width].to_vec();
            }
            content.resize(width, 0);
            directory.extend(tag.to_le_bytes());
            directory.extend(kind.to_le_bytes());
            directory.extend(&(values.len() as u64).to_le_bytes()[..width]);
            directory.extend(content);
        }
        directory.extend([0; 8]);
        let place = file.len() as u64;
        file[header - width..header].copy_from_slice(&place.to_le_bytes()[..width]);
        file.extend(directory);
        file
    }

    fn read(&self) -> Result<Picture, LoadError> {
        Picture::from_bytes_with("made.tif", &self.bytes(), LoadOptions { most_pixels: 100_000 })
    }
}

fn floats(value: impl Fn(usize) -> f32) -> Vec<u8> {
    values().flat_map(|v| value(v).to_le_bytes()).collect()
}

fn float_tiff(strip: Vec<u8>) -> Tiff {
    Tiff::new(32, 1, strip).with(339, 3, [3])
}

/// Returns the largest difference of the grey levels from the texture from black to white.
fn off(picture: &Picture) -> f32 {
    let plain = values().map(|v| v as f32 * 255.0 / 199.0);
    picture.gray.values().iter().zip(plain).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn every_kind_of_numbers_gives_the_same_plane() {
    let deep = |number: fn(usize) -> u16| {
        let values = values().map(number).collect();
        let pixels: ImageBuffer<Luma<u16>, _> =
            ImageBuffer::from_raw(WIDTH as u32, HEIGHT as u32, values).unwrap();
        Picture::from_pixels("deep".into(), None, DynamicImage::ImageLuma16(pixels)).unwrap()
    };
    for picture in [deep(|v| v as u16), deep(|v| 29_000 + 5 * v as u16), deep(|v| 300 * v as u16)] {
        assert!(off(&picture) < 1e-3, "{}", off(&picture));
        assert!(picture.interpretation.range.is_some() && picture.interpretation.masked.is_none());
        let shown = picture.displayed(&picture.pixels).to_luma16();
        assert!(shown.contains(&0) && shown.contains(&u16::MAX));
    }
    let files = [
        float_tiff(floats(|v| 15.0 + v as f32 / 20.0)),
        float_tiff(floats(|v| v as f32 / 199.0)),
        float_tiff(floats(|v| 1e12 * v as f32)),
        Tiff::new(32, 1, values().flat_map(|v| (v as u32 + 70_000).to_le_bytes()).collect()),
        Tiff::new(16, 1, values().flat_map(|v| (7 * v as i16 - 500).to_le_bytes()).collect()).with(
            339,
            3,
            [2],
        ),
        Tiff::new(64, 1, values().flat_map(|v| (v as f64 * 1e-6).to_le_bytes()).collect()).with(339, 3, [3]),
    ];
    for file in files {
        let picture = file.read().unwrap();
        // 16 bits.
        assert!(off(&picture) < 0.01, "{} {:?}", off(&picture), picture.interpretation);
    }
}

#[test]
fn missing_data_is_masked_and_filled() {
    let is_missing = |k: usize| k % WIDTH < 20 && k / WIDTH < 15;
    let numbers = |missing: f32| {
        let at = |(k, v): (usize, usize)| if is_missing(k) { missing } else { 15.0 + v as f32 / 20.0 };
        values().enumerate().map(at).flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
    };
    let files = [
        float_tiff(numbers(f32::NAN)),
        float_tiff(numbers(f32::NEG_INFINITY)),
        float_tiff(numbers(-9999.0)),
        float_tiff(numbers(0.0)),
        float_tiff(numbers(18.0)).with_text(42113, "18"),
        float_tiff(numbers(f32::MIN)).with_text(42113, "-3.4028234663852886e+38"),
    ];
    for file in files {
        let picture = file.read().unwrap();
        let share = picture.interpretation.masked.unwrap();
        assert!((share - 300.0 / (WIDTH * HEIGHT) as f64).abs() < 0.01, "{share}");
        let gray = &picture.gray;
        assert!(!gray.is_clear(Point::new(5.0, 5.0), 0.0) && gray.is_clear(Point::new(40.0, 30.0), 5.0));
        // The filled region is smooth, and nothing is black as −9999 would be.
        let inside: Vec<f32> = (2..12).flat_map(|y| (2..17).map(move |x| gray.at(x, y))).collect();
        assert!(inside.iter().all(|v| (40.0..220.0).contains(v)), "{inside:?}");
        let corners = super::find_corners(gray, 500, 5);
        assert!(!corners.is_empty() && corners.iter().all(|c| c.x > 24.0 || c.y > 19.0), "{corners:?}");
    }
    let nothing = float_tiff(floats(|_| f32::NAN)).read().unwrap_err();
    assert!(matches!(nothing, LoadError::NotFinite(_)), "{nothing}");
    // 8 bits have a mask where the file declares one, or a transparent area.
    let bytes = Tiff::new(8, 1, values().map(|v| v as u8).collect()).with_text(42113, "7");
    let picture = bytes.read().unwrap();
    let expected = values().filter(|v| *v == 7).count() as f64 / (WIDTH * HEIGHT) as f64;
    assert!((picture.interpretation.masked.unwrap() - expected).abs() < 1e-9);
    assert_eq!(picture.interpretation.range, None);
}

#[test]
fn kinds_of_tiff_files_are_the_same_picture() {
    let gray: Vec<u8> = values().map(|v| v as u8).collect();
    let plain = Tiff::new(8, 1, gray.clone()).read().unwrap().gray;
    let same = |file: &Tiff| {
        let picture = file.read().unwrap();
        let off =
            picture.gray.values().iter().zip(plain.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 0.01, "{off} {:?}", picture.pixels.color());
        picture
    };
    let mut big = Tiff::new(8, 1, gray.clone());
    big.big = true;
    same(&big);
    // A palette that reverses the grey levels, with indices that do so too.
    let reversed = gray.iter().map(|v| 255 - v).collect();
    let palette = (0..3).flat_map(|_| (0..256).map(|k| 257 * (255 - k)));
    let mut file = Tiff::new(8, 3, reversed).with(320, 3, palette);
    same(&file);
    file.big = true;
    same(&file);
    // Bands, next to each other and one after another.
    let bands = |samples: usize| {
        gray.iter().flat_map(move |v| (0..samples).map(move |k| v.wrapping_add(k as u8 * 60))).collect()
    };
    let many = same(&Tiff::new(8, 1, bands(6)).with(277, 3, [6]));
    assert_eq!(many.interpretation.bands, Some(6));
    let mut planar = Tiff::new(8, 1, gray.clone()).with(277, 3, [2]).with(284, 3, [2]).with(338, 3, [0]);
    planar.strips.push(vec![9; gray.len()]);
    assert_eq!(same(&planar).interpretation.bands, Some(2));
    let mut alpha = Tiff::new(8, 1, gray.iter().flat_map(|v| [*v, 255]).collect());
    alpha = alpha.with(277, 3, [2]).with(338, 3, [2]);
    assert_eq!(same(&alpha).interpretation, super::Interpretation::default());
    // A fourth sample of unknown meaning is no alpha.
    let open = Tiff::new(8, 2, gray.iter().flat_map(|v| [*v, *v, *v, 0]).collect()).with(277, 3, [4]);
    assert_eq!(same(&open).interpretation.masked, None);
    // Sixteen levels of four bits.
    let packed = gray.as_chunks::<2>().0.iter().map(|[a, b]| ((a / 16) << 4) | (b / 16)).collect();
    let four = Tiff::new(4, 1, packed).read().unwrap();
    assert!(
        four.gray
            .values()
            .iter()
            .zip(&gray)
            .all(|(v, expected)| (v - f32::from(expected / 16 * 17)).abs() < 0.01)
    );
    // Two strips with Zstandard compression; one block without any.
    let frame = |bytes: &[u8]| {
        let block = ((bytes.len() as u32) << 3 | 1).to_le_bytes();
        [&b"\x28\xb5\x2f\xfd\x60"[..], &((bytes.len() - 256) as u16).to_le_bytes(), &block[..3], bytes]
            .concat()
    };
    let half = HEIGHT / 2 * WIDTH;
    for big in [false, true] {
        let mut zstd = Tiff::new(8, 1, frame(&gray[..half])).with(259, 3, [50000]);
        zstd.strips.push(frame(&gray[half..]));
        zstd.big = big;
        let mut bytes = zstd.bytes();
        // Half as many rows in a strip.
        let rows =
            bytes.windows(4).rposition(|part| part == [0x16, 0x01, 3, 0]).unwrap() + if big { 12 } else { 8 };
        bytes[rows] = (HEIGHT / 2) as u8;
        let picture = Picture::from_bytes("zstd.tif", &bytes).unwrap();
        assert_eq!(picture.gray, plain);
        let broken = zstd.strips[0].len() - 100;
        bytes.truncate(bytes.len());
        bytes[8..8 + broken].fill(0x55);
        let error = Picture::from_bytes("zstd.tif", &bytes).unwrap_err().to_string();
        assert!(error.contains("damaged"), "{error}");
    }
}

#[test]
fn what_is_not_read_is_named_with_a_way_around() {
    let gray: Vec<u8> = values().map(|v| v as u8).collect();
    let tiff = |tag: u16, value: u64| Tiff::new(8, 1, gray.clone()).with(tag, 3, [value]).bytes();
    let preview = Tiff::new(8, 1, gray.clone()).with(254, 4, [1]).with(330, 4, [8]).bytes();
    let dicom = [&[0; 128][..], b"DICM"].concat();
    let files: [(&[u8], &[&str]); 15] = [
        (&tiff(259, 34887), &["LERC", "gdal_translate"]),
        (&tiff(259, 6), &["old-style JPEG", "gdal_translate"]),
        (&tiff(259, 61234), &["unknown (61234)"]),
        (&tiff(50706, 1), &["DNG", "Develop"]),
        (&tiff(262, 32803), &["camera raw", "Develop"]),
        (&preview, &["camera raw", "Develop"]),
        (b"II*\0\x10\0\0\0CR\x02\0", &["CR2", "Develop"]),
        (b"\0\0\0\x18ftypheic", &["HEIC", "heif-convert"]),
        (b"\0\0\0\x0cjP  \r\n\x87\n", &["JPEG 2000", "gdal_translate"]),
        (b"SIMPLE  =                    T", &["FITS"]),
        (b"\x93NUMPY\x01\0", &["NumPy", "TIFF"]),
        (b"\x76\x2f\x31\x01\x02\0\0\0", &["EXR", "Convert it to TIFF or PNG"]),
        (b"GIF89a\x01\0\x01\0", &["GIF", "an animation to a video"]),
        (b"%PDF-1.4", &["PDF", "pdftoppm"]),
        (&dicom, &["DICOM"]),
    ];
    for (bytes, words) in files {
        let error = Picture::from_bytes("file", bytes).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

#[test]
fn equal_numbers_are_equally_bright_in_the_range_of_another_picture() {
    let of = |offset: f32| float_tiff(floats(|v| v as f32 + offset)).read().unwrap();
    let (first, second) = (of(0.0), of(50.0));
    let moved = second.clone().in_range_of(&first);
    assert_eq!(moved.interpretation.range, first.interpretation.range);
    let expected = |v: usize| ((v as f32 + 50.0) * 255.0 / 199.0).min(255.0);
    assert!(moved.gray.values().iter().zip(values()).all(|(a, v)| (a - expected(v)).abs() < 0.02));
    assert!(off(&second) < 0.01);
}
