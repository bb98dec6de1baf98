//! Value parsers, and options shared by several commands.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};

use super::CliError;
use crate::estimate::{Method, Preset};
use crate::geometry::{Frame, Point, PointPair};
use crate::image::Picture;
use crate::io::{Format, PictureFormat, StereoProgram};
use crate::rectify::RectifyMethod;
use crate::suggest::ClickedImage;
use crate::synthetic::{Sample, SamplePair};

/// Parses finite numbers separated by commas.
fn numbers<const N: usize>(text: &str, expected: &str) -> Result<[f64; N], String> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    let cells: [&str; N] = cells
        .try_into()
        .map_err(|cells: Vec<_>| format!("expected {expected} (pixels), found {}", cells.len()))?;
    let values = cells.map(|cell| cell.parse().unwrap_or(f64::NAN));
    match values.iter().position(|value| !value.is_finite()) {
        Some(k) => Err(format!("expected {expected} (pixels), but \"{}\" is not a finite number", cells[k])),
        None => Ok(values),
    }
}

pub(super) fn point_pair(text: &str) -> Result<PointPair, String> {
    let [x1, y1, x2, y2] = numbers(text, "four numbers X1,Y1,X2,Y2")?;
    Ok(PointPair::new(x1, y1, x2, y2))
}

/// Parses the size of an image.
pub(super) fn size(text: &str) -> Result<Frame, String> {
    let side = |side: &str| side.trim().parse::<usize>().ok().filter(|side| (1..=1_000_000).contains(side));
    let sides = text.split_once(['x', 'X', '×']).and_then(|(width, height)| side(width).zip(side(height)));
    let (width, height) = sides.ok_or("expected a size in pixels such as 1920x1080")?;
    Ok(Frame::new(width, height))
}

pub(super) fn point(text: &str) -> Result<Point, String> {
    Ok(numbers::<2>(text, "two numbers X,Y")?.into())
}

/// Two image files, or a built-in pair.
#[derive(Debug, Args)]
pub(super) struct ImagePair {
    /// Left image
    #[arg(required_unless_present = "sample", requires = "right")]
    left: Option<PathBuf>,
    /// Right image
    right: Option<PathBuf>,
    /// Use a built-in pair in place of two files, with its own points or matches where a command
    /// needs them
    #[arg(long, value_name = "NAME", conflicts_with = "left", num_args = 0..=1, default_missing_value = "")]
    sample: Option<String>,
}

impl ImagePair {
    /// Loads both pictures, and the true matches of a built-in pair.
    pub(super) fn load(&self) -> Result<([Picture; 2], Option<Vec<PointPair>>), CliError> {
        if let Some(sample) = self.sample()? {
            return Ok((sample.pictures, Some(sample.matches)));
        }
        let (Some(left), Some(right)) = (&self.left, &self.right) else {
            return Err(CliError::Arguments("two images are needed: LEFT and RIGHT".into()));
        };
        Ok(([Picture::open(left)?, Picture::open(right)?], None))
    }

    /// Returns whether neither images nor a built-in pair are given.
    pub(super) fn is_absent(&self) -> bool {
        self.left.is_none() && self.sample.is_none()
    }

    pub(super) fn is_sample(&self) -> bool {
        self.sample.is_some()
    }

    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.left, &self.right].into_iter().flatten().map(PathBuf::as_path)
    }

    pub(super) fn sample(&self) -> Result<Option<SamplePair>, CliError> {
        self.sample.as_deref().map(|name| Ok(built_in(name)?.load())).transpose()
    }
}

/// Returns the built-in pair of a name; the default pair for an empty name.
fn built_in(name: &str) -> Result<Sample, CliError> {
    let found = if name.is_empty() { Some(Sample::default()) } else { Sample::from_name(name) };
    found.ok_or_else(|| {
        let known = Sample::ALL.map(Sample::name).join(", ");
        CliError::Arguments(format!("there is no built-in sample {name}. Choose one of {known}"))
    })
}

/// Parses a length in pixels, at least zero.
pub fn pixels(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("expected a number of pixels, zero or more".into()),
    }
}

/// Parses a whole number, at least one.
pub fn whole(text: &str, most: usize) -> Result<usize, String> {
    let value = text.parse().ok().filter(|value| (1..=most).contains(value));
    value.ok_or_else(|| format!("expected a whole number from 1 to {most}"))
}

/// Parses a number of megapixels and returns pixels.
pub(super) fn megapixels(text: &str) -> Result<usize, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0001..=4000.0).contains(&value) => Ok((value * 1e6) as usize),
        _ => Err("expected millions of pixels, from 0.0001 to 4000".into()),
    }
}

/// Parses a number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    // Too many threads on a few cores hinder each other: with a thousand, one second of work takes
    // half a minute.
    whole(text, 256)
}

/// Runs `work` in a thread pool of the given size, by default on all cores.
pub(super) fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, CliError> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| CliError::Arguments(format!("cannot start {threads} threads: {e}")))?;
    Ok(pool.install(work))
}

/// Implements clap's `ValueEnum` for a type of another module. Those modules do not depend on clap.
macro_rules! value_enum {
    ($kind:ty, $all:expr, $value:ident => $described:expr) => {
        impl ValueEnum for $kind {
            fn value_variants<'a>() -> &'a [Self] {
                &$all
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                let $value = self;
                Some($described)
            }
        }
    };
}

value_enum!(Preset, Self::ALL, value => PossibleValue::new(value.name()).help(match value {
    Self::Paper => "as published",
    Self::Robust => "best results on real images",
}));
value_enum!(Method, Self::ALL, value => PossibleValue::new(value.name()).help(match value {
    Self::TwoPoint => "two point pairs",
    Self::ThreePoint => "three point pairs, faster",
    Self::LinesAlone => "no point pairs: compares all lines of both images",
}));
value_enum!(Format, Self::ALL, value => {
    PossibleValue::new(value.name()).help(format!("{}, .{}", value.label(), value.extension()))
});
value_enum!(StereoProgram, Self::ALL, value => PossibleValue::new(value.name()).help(match value {
    Self::OpenCv => "left.png, right.png, stereo.yml",
    Self::RaftStereo => "im0.png, im1.png, calib.txt, as in the Middlebury sets",
    Self::FoundationStereo => "left.png, right.png, K.txt",
}));
value_enum!(RectifyMethod, Self::ALL, value => PossibleValue::new(value.name()).help(match value {
    Self::Auto => "planar if the distortion is small, otherwise polar",
    Self::Planar => "one homography per image; epipoles outside both images",
    Self::Polar => "one row per pair of half epipolar lines; epipoles anywhere",
}));
value_enum!(ClickedImage, [Self::First, Self::Second], value => match value {
    Self::First => PossibleValue::new("left").help("First image"),
    Self::Second => PossibleValue::new("right").help("Second image"),
});
value_enum!(PictureFormat, Self::ALL, value => PossibleValue::new(value.extension()));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_have_spaces_and_exponents_and_have_a_range() {
        assert_eq!(point_pair("1,2.5, -3 ,4e1"), Ok(PointPair::new(1.0, 2.5, -3.0, 40.0)));
        assert_eq!((whole("10", 10), threads("2"), pixels("0.5")), (Ok(10), Ok(2), Ok(0.5)));
        assert!(whole("0", 10).is_err() && whole("-1", 10).is_err() && threads("257").is_err());
        assert_eq!(size("640x480"), Ok(Frame::new(640, 480)));
        assert!(["640", "0x5", "4.5x3", "x", "1e9x4"].iter().all(|text| size(text).is_err()));
        assert!(pixels("-1").is_err() && pixels("nan").is_err() && pixels("inf").is_err());
    }
}
