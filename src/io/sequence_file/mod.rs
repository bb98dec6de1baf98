//! Sequences of frames: folders of numbered pictures, and videos through an installed `ffmpeg`.

mod folder;
mod video;

use std::path::Path;

use thiserror::Error;

use super::ReadError;
use super::hash::{sha256_of_bytes, sha256_of_file};
use super::read::{has_extension, has_image_extension};
use crate::cancel::CancelFlag;
use crate::foreign::{open_input, shown_path};
use crate::geometry::Frame;
use crate::image::{GrayPlane, LoadError, Picture};
use crate::motion::{FrameSequence, MotionError};

/// Maximum number of frames. At 640×480 px they take 0.6 GB.
pub const MOST_FRAMES: usize = 2000;

/// Sequence read from files.
#[derive(Debug, Clone)]
pub struct SequenceFile {
    /// Grey levels of all frames.
    pub sequence: FrameSequence,
    /// First frame as recorded.
    pub first: Picture,
    /// Notes for the user, about missing frames for example. Sentences.
    pub notes: Vec<String>,
}

impl SequenceFile {
    /// Wraps a synthetic sequence. The grey levels of its first frame become the picture.
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

/// Reason why a sequence cannot be read. The message is shown to the user.
#[derive(Debug, Error)]
pub enum SequenceError {
    /// A frame cannot be read.
    #[error(transparent)]
    Frame(#[from] LoadError),
    /// The folder cannot be read or has no frames.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The frames do not form a sequence.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// There are too many frames.
    #[error("{0} has more than {MOST_FRAMES} frames, the limit. Use a part of it, or every second frame")]
    TooLong(String),
    /// The folder or the video has one frame.
    #[error("{0} has a single frame. A sequence is a folder of numbered frames or a video")]
    OneFrame(String),
    /// The file is a picture, animated or not.
    #[error(
        "{0} is a picture. Sequences are not read from pictures, animated or not. Give a video, or a folder with the frames as numbered pictures"
    )]
    Picture(String),
    /// The program ffmpeg, which reads videos, is not installed.
    #[error(
        "cannot read {0}: the program ffmpeg, which reads videos, is not on this machine. Install ffmpeg, or give a folder of frames"
    )]
    NoFfmpeg(String),
    /// The program ffmpeg cannot read the file. The reason is its last message.
    #[error("ffmpeg cannot read {path} as a video: {reason}")]
    Ffmpeg { path: String, reason: String },
}

/// Common extensions of videos. Any other extension is accepted if the file is given as a sequence.
pub const VIDEO_EXTENSIONS: [&str; 10] =
    ["mp4", "m4v", "mov", "avi", "mkv", "webm", "mpg", "mpeg", "wmv", "ogv"];

/// Returns whether a path is a sequence: a folder, or a video by its extension.
pub fn is_sequence(path: &Path) -> bool {
    has_extension(path, &VIDEO_EXTENSIONS) || path.is_dir()
}

/// Returns a SHA-256 over the names and bytes of the numbered frames of a folder.
pub(super) fn folder_sha256(path: &Path) -> Result<String, ReadError> {
    let mut listing = String::new();
    for (_, file) in folder::numbered(path)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        listing.extend([&*name, "/", &sha256_of_file(&file)?, "/"]);
    }
    Ok(sha256_of_bytes(listing.as_bytes()))
}

/// Reads a sequence. `each` receives the number of frames read so far.
pub fn read_sequence(
    path: &Path,
    cancel: &CancelFlag,
    each: &dyn Fn(usize),
) -> Result<SequenceFile, SequenceError> {
    if path.is_dir() {
        return folder::read(path, cancel, each);
    }
    if has_extension(path, &["gif"]) || has_image_extension(path) {
        return Err(SequenceError::Picture(shown_path(path)));
    }
    open_input(path).map_err(|reason| LoadError::Open(shown_path(path), reason))?;
    video::read(path, "ffmpeg", cancel, each)
}

/// Frames read so far.
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
            return Err(SequenceError::TooLong(shown_path(self.path)));
        }
        self.sequence.push(gray)?;
        (self.each)(self.sequence.len());
        Ok(())
    }

    fn push_picture(&mut self, picture: Picture) -> Result<(), SequenceError> {
        // Equal numbers are equally bright in all frames.
        let picture = match &self.first {
            Some(first) => picture.in_range_of(first),
            None => picture,
        };
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
            _ => Err(SequenceError::OneFrame(shown_path(path))),
        }
    }
}

/// Returns the last part of a path, escaped for display.
fn name_of(path: &Path) -> String {
    let name = path.canonicalize().ok().and_then(|full| full.file_name().map(ToOwned::to_owned));
    let name = name.or_else(|| path.file_name().map(ToOwned::to_owned));
    name.map_or_else(|| shown_path(path), |name| crate::foreign::escaped(&name.to_string_lossy()))
}

#[cfg(test)]
mod tests;
