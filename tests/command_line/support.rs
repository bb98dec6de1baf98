//! Programs as they are started by their tests, and folders of small pictures.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use epiline::synthetic::{BallScene, ThrownBalls};

/// Returns the program with arguments.
pub fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(crate::PROGRAM);
    command.args(arguments).env_remove("RUST_BACKTRACE").stdin(Stdio::null());
    command
}

pub fn run(arguments: &[&str]) -> Output {
    program(arguments).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Asserts the exit status, an error of one line containing `words`, and no other output.
#[track_caller]
pub fn fails(arguments: &[&str], status: i32, words: &str) {
    let output = run(arguments);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {complaint}");
    let errors: Vec<_> = complaint.lines().filter(|l| l.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{arguments:?}: {complaint}");
    assert!(errors[0].contains(words), "{arguments:?}: expected {words:?} in {complaint}");
    assert!(!complaint.contains("panicked") && !complaint.contains("RUST_BACKTRACE"), "{complaint}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed {}", text(&output.stdout));
}

/// Folder with small pictures, some of them damaged.
pub struct Pictures(pub tempfile::TempDir);

impl Pictures {
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, seed) in [("left.png", 1), ("right.png", 2)] {
            textured(160, 120, seed).save(folder.path(name)).unwrap();
        }
        textured(1, 1, 1).save(folder.path("dot.png")).unwrap();
        image::GrayImage::from_pixel(160, 120, image::Luma([90])).save(folder.path("flat.png")).unwrap();
        let whole = std::fs::read(folder.path("left.png")).unwrap();
        std::fs::write(folder.path("cut.png"), &whole[..whole.len() / 2]).unwrap();
        std::fs::write(folder.path("zero.png"), "").unwrap();
        for name in ["words.txt", "words.png"] {
            std::fs::write(folder.path(name), "This is not a picture.\n").unwrap();
        }
        std::fs::write(folder.path("none.pgm"), "P5\n0 0\n255\n").unwrap();
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    pub fn write(&self, name: &str, content: &str) {
        std::fs::write(self.path(name), content).unwrap();
    }
}

/// Draws smooth blobs without repetition.
pub fn textured(width: u32, height: u32, seed: u32) -> image::GrayImage {
    image::GrayImage::from_fn(width, height, |x, y| {
        let (x, y, s) = (f64::from(x), f64::from(y), f64::from(seed));
        let value = (x * 0.31 + s).sin() + (y * 0.23 - s).cos() + (x * 0.07 * s + y * 0.11).sin();
        image::Luma([(127.0 + 40.0 * value) as u8])
    })
}

/// Creates a pair `p` in the folder, with twelve matches of an arbitrary geometry.
pub fn small_pairs(pictures: &Pictures) {
    std::fs::copy(pictures.path("left.png"), pictures.path("pA.png")).unwrap();
    std::fs::copy(pictures.path("right.png"), pictures.path("pB.png")).unwrap();
    let rows = (0..12).map(|k| {
        let t = f64::from(k);
        let (x, y) = (80.0 + 70.0 * (t * 1.9).sin(), 60.0 + 50.0 * (t * 2.7).cos());
        format!("{x} {y} {} {}\n", x * 0.9 + 5.0 + 4.0 * (t * 1.3).sin(), y * 0.95 + 3.0 * (t * 0.7).cos())
    });
    pictures.write("p.txt", &rows.collect::<String>());
}

/// Writes the frames of both cameras, each to its own folder.
pub fn recorded_as(folder: &Path, thrown: ThrownBalls) -> [String; 2] {
    let sequences = BallScene::new(thrown).unwrap().sequences().unwrap();
    let mut names = sequences.iter().zip(["left", "right"]).map(|(sequence, name)| {
        let own = folder.join(name);
        std::fs::create_dir(&own).unwrap();
        let (width, height) = (sequence.size().width as u32, sequence.size().height as u32);
        for number in 0..sequence.len() {
            let pixels = image::GrayImage::from_raw(width, height, sequence.frame(number).to_vec()).unwrap();
            pixels.save(own.join(format!("frame{number:03}.png"))).unwrap();
        }
        own.display().to_string()
    });
    [names.next().unwrap(), names.next().unwrap()]
}
