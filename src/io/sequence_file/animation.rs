//! Animated GIF, PNG and WebP pictures.

use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;

use image::codecs::{gif::GifDecoder, png::PngDecoder, webp::WebPDecoder};
use image::{
    AnimationDecoder, DynamicImage, Frames, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
};

use super::{Gathered, SequenceError, SequenceFile};
use crate::cancel::CancelFlag;
use crate::foreign::{excerpt, open_input, shown_path};
use crate::image::{LoadError, LoadOptions, Picture, WebpClaims};

/// Bytes of an animation that are read, at most.
const MOST_BYTES: u64 = 1 << 30;
/// Beside the pixels of a frame a decoder may take this much, bytes.
const SLACK: u64 = 64 << 20;

/// Whether a file is a picture with more frames than one.
pub(super) fn is_animated(path: &Path) -> bool {
    open(path).ok().flatten().is_some_and(|frames| frames.take(2).flatten().count() == 2)
}

/// The frames of an animated picture; `None` for what is none.
pub(super) fn read(
    path: &Path,
    cancel: &CancelFlag,
    each: &dyn Fn(usize),
) -> Result<Option<SequenceFile>, SequenceError> {
    let Some(frames) = open(path)? else { return Ok(None) };
    let shown = shown_path(path);
    let mut gathered = Gathered::new(path, cancel, each);
    for frame in frames {
        match frame {
            Ok(frame) => {
                let pixels = DynamicImage::from(frame.into_buffer());
                gathered.push_picture(Picture::from_pixels(String::new(), None, pixels)?)?;
            }
            Err(error) if gathered.sequence.len() > 1 => {
                let read = gathered.sequence.len();
                let reason = excerpt(&error.to_string());
                gathered.notes.push(format!("{shown} is damaged after frame {}: {reason}", read - 1));
                break;
            }
            Err(error) => return Err(damaged(&shown, &error).into()),
        }
    }
    gathered.finish().map(Some)
}

fn damaged(shown: &str, error: &ImageError) -> LoadError {
    LoadError::Damaged { path: shown.to_owned(), reason: excerpt(&error.to_string()), in_part: false }
}

/// A decoder at the first frame; `None` for what is no animated picture.
fn open(path: &Path) -> Result<Option<Frames<'static>>, LoadError> {
    let shown = shown_path(path);
    let failed = |reason: String| LoadError::Open { path: shown.clone(), reason };
    let input = open_input(path).map_err(failed)?;
    if input.size.is_some_and(|size| size > MOST_BYTES) {
        // Videos may be of any size.
        return Ok(None);
    }
    let mut reader: Box<dyn BufReadSeek> = if input.size.is_some() {
        Box::new(BufReader::new(input.file))
    } else {
        let mut bytes = Vec::new();
        let read = input.file.take(MOST_BYTES).read_to_end(&mut bytes);
        read.map_err(|e| LoadError::Open { path: shown.clone(), reason: crate::foreign::reason(&e) })?;
        Box::new(Cursor::new(bytes))
    };
    let guessed = ImageReader::new(&mut reader).with_guessed_format().ok().and_then(|reader| reader.format());
    let rewound = reader.rewind();
    rewound.map_err(|e| LoadError::Open { path: shown.clone(), reason: crate::foreign::reason(&e) })?;
    let options = LoadOptions::from_environment()?;
    let damaged = |error: &ImageError| damaged(&shown, error);
    let checked = |decoder: &mut dyn Limited| -> Result<(), LoadError> {
        let (width, height) = decoder.size();
        options.check(&shown, width, height, 4)?;
        // A canvas and the frame before it.
        let bytes = u64::from(width) * u64::from(height) * 4;
        decoder.limit(bytes.saturating_mul(4).saturating_add(SLACK)).map_err(|e| damaged(&e))
    };
    let frames = match guessed {
        Some(ImageFormat::Gif) => {
            let mut decoder = GifDecoder::new(reader).map_err(|e| damaged(&e))?;
            checked(&mut decoder)?;
            decoder.into_frames()
        }
        Some(ImageFormat::Png) => {
            let mut decoder = PngDecoder::new(reader).map_err(|e| damaged(&e))?;
            if !decoder.is_apng().map_err(|e| damaged(&e))? {
                return Ok(None);
            }
            checked(&mut decoder)?;
            decoder.apng().map_err(|e| damaged(&e))?.into_frames()
        }
        Some(ImageFormat::WebP) => {
            let claims = WebpClaims::read(&mut reader).map_err(|e| damaged(&e.into()))?;
            claims
                .pictures
                .iter()
                .try_for_each(|[width, height]| options.check(&shown, *width, *height, 4))?;
            reader.rewind().map_err(|e| damaged(&e.into()))?;
            let mut decoder = WebPDecoder::new(reader).map_err(|e| damaged(&e))?;
            if !decoder.has_animation() {
                return Ok(None);
            }
            checked(&mut decoder)?;
            decoder.into_frames()
        }
        _ => return Ok(None),
    };
    Ok(Some(frames))
}

trait BufReadSeek: BufRead + Seek {}

impl<T: BufRead + Seek> BufReadSeek for T {}

/// A decoder that can be held to a limit.
trait Limited {
    fn size(&self) -> (u32, u32);
    fn limit(&mut self, bytes: u64) -> Result<(), ImageError>;
}

impl<D: ImageDecoder> Limited for D {
    fn size(&self) -> (u32, u32) {
        self.dimensions()
    }

    fn limit(&mut self, bytes: u64) -> Result<(), ImageError> {
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(bytes);
        self.set_limits(limits)
    }
}
