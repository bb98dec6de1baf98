//! Sequences of frames: folders of numbered pictures, and videos through an `ffmpeg` found on the machine.

mod folder;
mod video;

use std::path::Path;

use thiserror::Error;

use super::ReadError;
use super::hash::{sha256_of_bytes, sha256_of_file};
use super::read::has_image_extension;
use crate::cancel::CancelFlag;
use crate::foreign::{open_input, shown_path};
use crate::geometry::Frame;
use crate::image::{GrayPlane, LoadError, Picture};
use crate::motion::{FrameSequence, MotionError};

/// Most frames that are read: at 640×480 px they take 0.6 GB.
pub const MOST_FRAMES: usize = 2000;

/// A sequence that was read.
#[derive(Debug, Clone)]
pub struct SequenceFile {
    /// The frames.
    pub sequence: FrameSequence,
    /// The first frame as it was recorded.
    pub first: Picture,
    /// What the user should know: frames that are missing, say. Sentences.
    pub notes: Vec<String>,
}

impl SequenceFile {
    /// A sequence that was made and not read; the grey levels of its first frame are the picture.
    ///
    /// # Panics
    /// When the sequence has no frames: a programming error.
    pub fn made(sequence: FrameSequence) -> Result<Self, LoadError> {
        let Frame { width, height } = sequence.size();
        let pixels = image::GrayImage::from_raw(width as u32, height as u32, sequence.frame(0).to_vec());
        let pixels = pixels.expect("a frame has as many grey levels as pixels");
        let first = Picture::from_pixels(sequence.name().to_owned(), None, pixels.into())?;
        Ok(Self { sequence, first, notes: Vec::new() })
    }
}

/// Why a sequence could not be read. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum SequenceError {
    /// A frame could not be read.
    #[error(transparent)]
    Frame(#[from] LoadError),
    /// The folder could not be read, or holds no frames.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The frames do not go together.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// More frames than are read.
    #[error(
        "{path} has more than {MOST_FRAMES} frames, more than are read: take a part of it, or every second one"
    )]
    TooLong {
        /// The file or folder.
        path: String,
    },
    /// A folder or video with one frame.
    #[error("{path} has a single frame: a sequence is a folder of numbered frames or a video")]
    OneFrame {
        /// The file.
        path: String,
    },
    /// A picture file, animated or not.
    #[error(
        "{path} is a picture, and sequences are not read from pictures, animated or not: give a video, or a folder with the frames as numbered pictures"
    )]
    Picture {
        /// The file.
        path: String,
    },
    /// A video without a program that reads it.
    #[error(
        "cannot read {path}: the program ffmpeg, which reads videos, is not on this machine; install it, or give a folder of frames"
    )]
    NoFfmpeg {
        /// The file.
        path: String,
    },
    /// The program that reads videos does not read this one.
    #[error("ffmpeg cannot read {path} as a video: {reason}")]
    Ffmpeg {
        /// The file.
        path: String,
        /// The program's own words.
        reason: String,
    },
}

/// How the names of videos end; others are read as well, when they are given as sequences.
pub const VIDEO_EXTENSIONS: [&str; 10] =
    ["mp4", "m4v", "mov", "avi", "mkv", "webm", "mpg", "mpeg", "wmv", "ogv"];

/// Returns whether the path is a sequence and not a picture: a folder, or by its name a video.
pub fn is_sequence(path: &Path) -> bool {
    let is_video = path
        .extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| VIDEO_EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)));
    is_video || path.is_dir()
}

/// SHA-256 of the numbered frames of a folder, with their names: other frames have another one.
pub(super) fn folder_sha256(path: &Path) -> Result<String, ReadError> {
    let mut listing = String::new();
    for (_, file) in folder::numbered(path)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        listing.extend([&*name, "/", &sha256_of_file(&file)?, "/"]);
    }
    Ok(sha256_of_bytes(listing.as_bytes()))
}

/// The first frame of a folder of frames, as it was recorded.
pub fn first_frame(folder: &Path) -> Result<Picture, SequenceError> {
    match folder::numbered(folder)?.first() {
        Some((_, file)) => Ok(Picture::open(file)?),
        None => Err(SequenceError::OneFrame { path: shown_path(folder) }),
    }
}

/// Reads a sequence. `each` hears of the frames read so far.
pub fn read_sequence(
    path: &Path,
    cancel: &CancelFlag,
    each: &dyn Fn(usize),
) -> Result<SequenceFile, SequenceError> {
    if path.is_dir() {
        return folder::read(path, cancel, each);
    }
    let path_is_gif = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"));
    if path_is_gif || has_image_extension(path) {
        return Err(SequenceError::Picture { path: shown_path(path) });
    }
    open_input(path).map_err(|reason| LoadError::Open { path: shown_path(path), reason })?;
    video::read(path, "ffmpeg", cancel, each)
}

/// Frames as they come in.
struct Gathered<'a> {
    path: &'a Path,
    sequence: FrameSequence,
    first: Option<Picture>,
    notes: Vec<String>,
    cancel: &'a CancelFlag,
    each: &'a dyn Fn(usize),
}

impl<'a> Gathered<'a> {
    fn new(path: &'a Path, cancel: &'a CancelFlag, each: &'a dyn Fn(usize)) -> Self {
        let sequence = FrameSequence::new(name_of(path));
        Self { path, sequence, first: None, notes: Vec::new(), cancel, each }
    }

    fn push(&mut self, gray: &GrayPlane) -> Result<(), SequenceError> {
        self.cancel.check().map_err(MotionError::from)?;
        if self.sequence.len() >= MOST_FRAMES {
            return Err(SequenceError::TooLong { path: shown_path(self.path) });
        }
        self.sequence.push(gray)?;
        (self.each)(self.sequence.len());
        Ok(())
    }

    fn push_picture(&mut self, picture: Picture) -> Result<(), SequenceError> {
        self.push(&picture.gray)?;
        self.first.get_or_insert(picture);
        Ok(())
    }

    fn finish(self) -> Result<SequenceFile, SequenceError> {
        let Self { path, sequence, first, notes, .. } = self;
        match first {
            Some(first) if sequence.len() > 1 => {
                let first = Picture { name: name_of(path), path: Some(path.to_owned()), ..first };
                Ok(SequenceFile { sequence, first, notes })
            }
            _ => Err(SequenceError::OneFrame { path: shown_path(path) }),
        }
    }
}

/// The last part of a path, fit to be shown.
fn name_of(path: &Path) -> String {
    let name = path.canonicalize().ok().and_then(|full| full.file_name().map(ToOwned::to_owned));
    let name = name.or_else(|| path.file_name().map(ToOwned::to_owned));
    name.map_or_else(|| shown_path(path), |name| crate::foreign::escaped(&name.to_string_lossy()))
}

#[cfg(test)]
mod tests;
