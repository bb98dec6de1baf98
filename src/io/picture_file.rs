//! Encoding of picture files.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageFormat};
use thiserror::Error;

named! {
    fn extension;
    /// Format of a picture file, with its extension.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum PictureFormat {
        /// PNG: 8 and 16 bits, with alpha.
        #[default]
        Png = "png",
        /// TIFF: 8 and 16 bits and floating point, with alpha.
        Tiff = "tiff",
    }
}

/// Error in encoding a picture.
#[derive(Debug, Error)]
#[error("the picture cannot be written as {format}: {reason}")]
pub struct PictureError {
    format: &'static str,
    reason: String,
}

/// Encodes a picture. Bit depth and channels are kept if the format supports them. PNG has no
/// floating-point pixels, which become 16 bits. TIFF turns grey with alpha into colour with alpha.
pub fn encode_picture(picture: &DynamicImage, format: PictureFormat) -> Result<Vec<u8>, PictureError> {
    let converted = match (format, picture.color()) {
        (PictureFormat::Png, ColorType::Rgb32F) => Some(picture.to_rgb16().into()),
        (PictureFormat::Tiff, ColorType::La8) => Some(DynamicImage::from(picture.to_rgba8())),
        (PictureFormat::Png, ColorType::Rgba32F) | (PictureFormat::Tiff, ColorType::La16) => {
            Some(picture.to_rgba16().into())
        }
        _ => None,
    };
    let mut content = Cursor::new(Vec::new());
    let (known, name) = match format {
        PictureFormat::Png => (ImageFormat::Png, "PNG"),
        PictureFormat::Tiff => (ImageFormat::Tiff, "TIFF"),
    };
    converted
        .as_ref()
        .unwrap_or(picture)
        .write_to(&mut content, known)
        .map_err(|e| PictureError { format: name, reason: e.to_string() })?;
    Ok(content.into_inner())
}

/// Adds a description to a PNG file, for picture viewers to show.
pub fn described(png: Vec<u8>, words: &str) -> Vec<u8> {
    /// Length of the signature and the first chunk: 13 bytes of data and 12 around them.
    const HEAD: usize = 8 + 12 + 13;
    if png.len() < HEAD {
        return png;
    }
    // Uncompressed, without a language. Zero bytes separate the fields, so the text must have none.
    let words = words.replace('\0', " ");
    let chunk = [b"iTXt", &b"Description\0\0\0\0\0"[..], words.as_bytes()].concat();
    let length = (chunk.len() - 4) as u32;
    let check = chunk_check(&chunk);
    [&png[..HEAD], &length.to_be_bytes(), &chunk, &check.to_be_bytes(), &png[HEAD..]].concat()
}

/// Returns the cyclic redundancy check of a PNG chunk, name included.
fn chunk_check(bytes: &[u8]) -> u32 {
    let next = |check: u32, byte: &u8| {
        (0..8).fold(check ^ u32::from(*byte), |check, _| (check >> 1) ^ (0xedb8_8320 * (check & 1)))
    };
    !bytes.iter().fold(u32::MAX, next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_is_a_chunk_like_any_other() {
        assert_eq!(chunk_check(b"IEND"), 0xae42_6082, "as in every PNG file");
        let picture = DynamicImage::new_rgb8(3, 2);
        let png = encode_picture(&picture, PictureFormat::Png).unwrap();
        let with = described(png.clone(), "The geometry is doubtful: 5 \u{b0}.");
        assert_eq!(image::load_from_memory(&with).unwrap(), picture);
        let reader = image::codecs::png::PngDecoder::new(Cursor::new(&with));
        assert!(reader.is_ok() && with.len() > png.len());
        assert!(with.windows(8).any(|part| part == b"doubtful"));
        assert_eq!(described(vec![1, 2], "x"), [1, 2]);
    }

    #[test]
    fn depth_and_alpha_come_back() {
        let gray = image::GrayImage::from_fn(5, 4, |x, y| image::Luma([(40 * x + y) as u8]));
        let gray = DynamicImage::from(gray);
        let kinds: [DynamicImage; 6] = [
            gray.to_luma_alpha8().into(),
            gray.to_luma_alpha16().into(),
            gray.to_rgba8().into(),
            gray.to_rgba16().into(),
            gray.to_rgba32f().into(),
            gray.to_rgb32f().into(),
        ];
        for picture in kinds {
            for format in PictureFormat::ALL {
                let bytes = encode_picture(&picture, format).unwrap();
                let back = image::load_from_memory(&bytes).unwrap();
                assert_eq!(back.to_rgba16(), picture.to_rgba16(), "{format:?} {:?}", picture.color());
                let (deep, was) =
                    (back.color().bytes_per_pixel() / back.color().channel_count(), picture.color());
                let expected = was.bytes_per_pixel() / was.channel_count();
                assert_eq!(deep, if format == PictureFormat::Png { expected.min(2) } else { expected });
            }
        }
    }
}
