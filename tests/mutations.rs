//! Mutated files of every kind: the program reads them or refuses them with a message, without a
//! panic and within a memory limit.
//!
//! The harness runs on stable Rust; the usual fuzzers need a nightly compiler or instrumented
//! builds. It ignores coverage, but starts from a file of every format and from files that broke
//! something. A run is repeatable by its seed. `EPILINE_MUTATIONS` sets the number of mutations,
//! `EPILINE_SEED` the seed:
//!
//! ```sh
//! EPILINE_MUTATIONS=10000000 cargo test --test mutations -- --ignored --nocapture
//! ```

mod counting;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use epiline::camera::{PicturesOf, UndistortedView};
use epiline::geometry::{Frame, FundamentalMatrix, Point, PointPair};
use epiline::image::{LoadOptions, Picture};
use epiline::io::{
    Calibration, Format, GeometryFile, ImageNote, ImageReference, ImageSource, OutputFile, SessionFile,
    focal_length_from_exif, parse_point_pairs, read_camera, read_matches,
};
use image::{DynamicImage, ImageFormat};

/// Pixel limit for pictures.
const MOST_PIXELS: u64 = 100_000;
/// Memory limit per file, bytes: the pictures, and the decoders' profiles and texts.
const MOST_MEMORY: usize = 96 << 20;
/// Time limit per file, s: a hundred times the slowest.
const LONGEST: f64 = 20.0;
/// Largest file that is mutated, bytes.
const LONGEST_FILE: u64 = 20_000;
/// Size of the images of the geometry.
const FRAME: Frame = Frame { width: 640, height: 480 };
/// Maximum length of a message, characters.
const LONGEST_MESSAGE: usize = 900;

/// A calibration of each kind.
const CALIBRATIONS: [(&str, &str); 6] = [
    (
        "opencv.yml",
        "%YAML:1.0\n---\nK1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 505., \
         240., 0., 0., 1. ]\nD1: [ -0.3, 0.1, 0., 0. ]\nK2: [ 500., 0., 320., 0., 505., 240., 0., 0., 1. ]\nD2: [ 0., 0., \
         0., 0. ]\nR: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT: [ -1., 0., 0. ]\n",
    ),
    (
        "kalibr.yaml",
        "cam0:\n  camera_model: pinhole\n  intrinsics: [458.6, 457.3, 367.2, 248.4]\n  distortion_model: equidistant\n  \
         distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]\n  resolution: [752, 480]\n",
    ),
    (
        "cameras.toml",
        "[cameras.0]\nsize = [64, 48]\nmatrix = [[89.0, 0.0, 32.0], [0.0, 89.0, 24.0], [0.0, 0.0, 1.0]]\ndistortions = \
         [-0.33, 0.09, 0.0, 0.0, 0.0]\nrotation = [0.0, 0.0, 0.0]\ntranslation = [0.0, 0.0, 0.0]\n",
    ),
    (
        "kitti.txt",
        "K_00: 984 0 690 0 981 233 0 0 1\nD_00: -0.37 0.2 0.002 0.001 -0.07\nP1: 7 0 6 -3 0 7 1 0 0 0 1 0\n",
    ),
    (
        "middlebury.txt",
        "cam0=[39 0 11; 0 39 10; 0 0 1]\ncam1=[39 0 13; 0 39 10; 0 0 1]\nbaseline=193.001\nwidth=29\n",
    ),
    (
        "colmap.txt",
        "1 THIN_PRISM_FISHEYE 64 48 30 30 32 24 0.1 0 0 0 0.1 0 0 0\n2 FOV 64 48 30 30 32 24 0.9\n",
    ),
];

/// The generator `SplitMix64`, equal on all platforms.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number below `end`, which is not 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// Reader of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reader {
    Picture,
    Text,
    Calibration,
    Matches,
    Database,
    Session,
}

struct Sample {
    name: String,
    bytes: Vec<u8>,
    reader: Reader,
}

/// Returns a geometry with pairs and images.
fn geometry() -> GeometryFile {
    let rows = [[0.0, -1e-4, 0.02], [1.2e-4, 1e-6, -0.3], [-0.03, 0.29, 1.0]];
    let pair = |t: f64| PointPair::new(t, t * 0.7, t + 3.0, t * 0.69);
    let note = |name: &str| ImageNote::new(name.to_owned(), FRAME);
    GeometryFile {
        fundamental: FundamentalMatrix::nearest_rank_two(nalgebra::Matrix3::from_fn(|r, c| rows[r][c])),
        pairs: (0..6).map(|k| pair(f64::from(k) * 17.25)).collect(),
        images: Some([note("left.png"), note("right é.png")]),
        ..GeometryFile::of(PicturesOf::Untold)
    }
}

/// Returns a small file of every kind, and files that once broke something, if present.
fn corpus() -> Vec<Sample> {
    let mut all = Vec::new();
    let mut add =
        |name: &str, bytes: Vec<u8>, reader| all.push(Sample { name: name.to_owned(), bytes, reader });
    let gray = image::GrayImage::from_fn(37, 29, |x, y| image::Luma([(x * 7 + y * y * 3) as u8]));
    let gray = DynamicImage::from(gray);
    let kinds: [(&str, DynamicImage); 6] = [
        ("gray8", gray.clone()),
        ("rgb8", gray.to_rgb8().into()),
        ("rgba8", gray.to_rgba8().into()),
        ("gray16", gray.to_luma16().into()),
        ("rgb16", gray.to_rgb16().into()),
        ("rgb32f", gray.to_rgb32f().into()),
    ];
    for (kind, picture) in &kinds {
        for format in [
            ImageFormat::Png,
            ImageFormat::Jpeg,
            ImageFormat::Tiff,
            ImageFormat::Bmp,
            ImageFormat::Pnm,
            ImageFormat::WebP,
        ] {
            let mut file = Cursor::new(Vec::new());
            // Formats support different pixel types.
            if picture.write_to(&mut file, format).is_ok() {
                add(&format!("{kind} {format:?}"), file.into_inner(), Reader::Picture);
            }
        }
    }
    add("zstd.tif", include_bytes!("mutations/zstd.tif").to_vec(), Reader::Picture);
    add("BigTIFF with a palette", include_bytes!("mutations/palette.tif").to_vec(), Reader::Picture);
    add("photograph.jpg", include_bytes!("mutations/photograph.jpg").to_vec(), Reader::Picture);
    let file = geometry();
    for format in Format::ALL {
        add(format.name(), file.to_text(format).into_bytes(), Reader::Text);
    }
    add("camera", b"1 0 0 -1\n0 1 0 0.5\n0 0 1 0\n".to_vec(), Reader::Text);
    add("pairs", b"x1,y1,x2,y2\n1,2.5,3e1,-4\n5;6\t7 8\n# a comment\n".to_vec(), Reader::Text);
    for (name, text) in CALIBRATIONS {
        add(name, text.as_bytes().to_vec(), Reader::Calibration);
    }
    add("database.db", include_bytes!("mutations/database.db").to_vec(), Reader::Database);
    add("matches.npz", include_bytes!("mutations/matches.npz").to_vec(), Reader::Matches);
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 4), }\n";
    let mut array =
        [b"\x93NUMPY\x01\x00".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
    array.extend([1.0_f64, 2.5, -3.0, 4.0, 5.0, 6.0, 7.0, 1e-9].map(f64::to_le_bytes).concat());
    add("pairs.npy", array, Reader::Matches);
    let reference = |path: &str| ImageReference {
        source: ImageSource::File { path: path.to_owned(), sha256: "ab".repeat(32) },
        frame: FRAME,
    };
    let content =
        serde_json::json!({"document": {"pairs": [], "excluded": [1, 2]}, "pins": [null, {"a": [1e3]}]});
    let session = SessionFile {
        images: [reference("a.png"), reference("b/ä.jpg")],
        fundamental: file.fundamental,
        pictures: PicturesOf::Original,
        trust: None,
        content,
    };
    add("session", session.to_text().unwrap().into_bytes(), Reader::Session);
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/hostile");
    if !shared.is_dir() {
        eprintln!("without {}, which is not there", shared.display());
    }
    for (folder, reader) in [("pictures", Reader::Picture), ("text", Reader::Text)] {
        let Ok(entries) = std::fs::read_dir(shared.join(folder)) else { continue };
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths.iter().filter(|path| path.metadata().unwrap().len() < LONGEST_FILE) {
            add(&path.file_name().unwrap().to_string_lossy(), std::fs::read(path).unwrap(), reader);
        }
    }
    all
}

/// Applies one change of a kind that breaks parsers.
fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    const NUMBERS: [&str; 10] =
        ["-1", "0", "1e308", "1e999", "nan", "-inf", "4294967296", "18446744073709551616", "1e-320", "00"];
    const MARKS: [&str; 14] =
        ["[", "{", "<", ">", "\"", "&#x0;", "\0", "\u{feff}", "---", "&a ", "*a", "!!", "<![CDATA[", "\n"];
    let at = random.below(bytes.len() + 1);
    let end = (at + 1 + random.below(16)).min(bytes.len());
    match random.below(11) {
        0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        1 if at < bytes.len() => bytes[at] = *random.of(&[0, 1, 0x7f, 0x80, 0xff, b'0', b'9', b' ', b'-']),
        2 if at + 4 <= bytes.len() => {
            let number: u32 = *random.of(&[0, 1, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 60_000, 256]);
            let both = [number.to_be_bytes(), number.to_le_bytes()];
            bytes[at..at + 4].copy_from_slice(&random.of(&both)[..]);
        }
        3 if at + 2 <= bytes.len() => {
            let number: u16 = *random.of(&[0, 1, 0xff, 0x7fff, 0x8000, 0xffff]);
            let both = [number.to_be_bytes(), number.to_le_bytes()];
            bytes[at..at + 2].copy_from_slice(&random.of(&both)[..]);
        }
        4 => drop(bytes.drain(at..end)),
        5 => {
            let copy = bytes[at..end].to_vec();
            let times = 1 + random.below(40);
            bytes.splice(at..at, copy.repeat(times));
        }
        6 => bytes.truncate(at),
        7 => drop(bytes.splice(at..at, random.of(&NUMBERS).bytes())),
        8 => drop(bytes.splice(at..at, random.of(&MARKS).repeat(1 + random.below(3) * 40).into_bytes())),
        9 if !other.is_empty() => {
            let from = random.below(other.len());
            let to = (from + 1 + random.below(200)).min(other.len());
            bytes.splice(at..end, other[from..to].iter().copied());
        }
        _ => bytes.insert(at, random.next() as u8),
    }
    bytes.truncate(4 * LONGEST_FILE as usize);
}

/// Reads a file with all applicable readers and returns their messages.
fn read(bytes: &[u8], reader: Reader, file: &Path) -> Vec<String> {
    let mut said = Vec::new();
    let mut hear = |error: Option<String>| said.extend(error);
    match reader {
        Reader::Picture => {
            let options = LoadOptions { most_pixels: MOST_PIXELS };
            hear(Picture::from_bytes_with("picture", bytes, options).err().map(|e| e.to_string()));
            std::fs::write(file, bytes).unwrap();
            let focal = focal_length_from_exif(file, FRAME);
            assert!(focal.is_none_or(|focal| focal.pixels.is_finite() && focal.pixels > 0.0));
        }
        Reader::Text => {
            if let Ok(text) = std::str::from_utf8(bytes) {
                match GeometryFile::parse(text) {
                    Ok((found, _)) => {
                        // Every geometry that was read can be written in every format.
                        for format in Format::ALL {
                            let _ = found.to_text(format);
                        }
                    }
                    Err(problem) => hear(Some(problem.to_string())),
                }
                let _ = parse_point_pairs(text);
            }
            std::fs::write(file, bytes).unwrap();
            hear(read_camera(file).err().map(|e| e.to_string()));
        }
        Reader::Calibration => {
            std::fs::write(file, bytes).unwrap();
            match Calibration::read(file) {
                Ok(found) => {
                    for camera in found.cameras {
                        // Every lens that was read can be undone, or not.
                        let view = UndistortedView::new(&camera.model, Frame::new(640, 480));
                        let _ = view.map(|view| view.source_of(Point::new(3.0, 400.0)));
                    }
                }
                Err(error) => hear(Some(error.to_string())),
            }
        }
        Reader::Matches => {
            std::fs::write(file, bytes).unwrap();
            hear(read_matches(file).err().map(|e| e.to_string()));
        }
        Reader::Database => {
            std::fs::write(file, bytes).unwrap();
            let output = OutputFile::prepare(&file.with_extension("db")).unwrap();
            hear(geometry().add_to_colmap(None, file, &output).err().map(|e| e.to_string()));
        }
        Reader::Session => {
            std::fs::write(file, bytes).unwrap();
            hear(SessionFile::<serde_json::Value>::read(file).err().map(|e| e.to_string()));
        }
    }
    said
}

/// Runs `count` mutations and reports each that breaks a rule.
fn run(count: usize, seed: u64) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mutant");
    let corpus = corpus();
    let mut random = Random(seed);
    let mut slowest = (0.0, String::new());
    let mut largest = (0, String::new());
    let mut complaints = Vec::new();
    for number in 0..count {
        let sample = random.of(&corpus);
        let mut bytes = sample.bytes.clone();
        let other = &random.of(&corpus).bytes;
        for _ in 0..=random.below(6) {
            mutate(&mut bytes, other, &mut random);
        }
        let started = Instant::now();
        let (memory, said) =
            counting::most_held(|| catch_unwind(AssertUnwindSafe(|| read(&bytes, sample.reader, &file))));
        let seconds = started.elapsed().as_secs_f64();
        let long = said.as_ref().is_ok_and(|said| {
            said.iter().any(|s| s.chars().count() > LONGEST_MESSAGE || s.contains(char::is_control))
        });
        for (broken, what) in [
            (said.is_err(), "a panic"),
            (memory > MOST_MEMORY, "too much memory"),
            (seconds > LONGEST, "too long"),
            (long, "a message that is too long or has control characters"),
        ] {
            if broken {
                let kept = std::env::temp_dir().join(format!("epiline-mutant-{seed}-{number}"));
                std::fs::write(&kept, &bytes).unwrap();
                let name = &sample.name;
                complaints.push(format!("{what}: mutation {number} of {name}, kept as {}", kept.display()));
            }
        }
        if seconds > slowest.0 {
            slowest = (seconds, sample.name.clone());
        }
        if memory > largest.0 {
            largest = (memory, sample.name.clone());
        }
    }
    println!(
        "{count} mutations of {} files with seed {seed}: slowest {:.3} s ({}), largest {} MB ({})",
        corpus.len(),
        slowest.0,
        slowest.1,
        largest.0 >> 20,
        largest.1
    );
    assert!(complaints.is_empty(), "seed {seed}:\n{}", complaints.join("\n"));
}

#[test]
fn mutated_files_are_read_or_refused() {
    run(2000, 1);
}

#[test]
#[ignore = "long; .ci/run makes 100 000 mutations of it with a seed of the day"]
fn many_mutated_files_are_read_or_refused() {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse().ok());
    run(number("EPILINE_MUTATIONS").unwrap_or(100_000), number("EPILINE_SEED").unwrap_or(0) as u64);
}
