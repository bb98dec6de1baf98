//! Detection of truncated picture files, for the formats whose decoders silently fill in missing
//! data.
//!
//! A JPEG file is a chain of segments, each with its length. The coded pixels have no length: in
//! them, a byte 255 starts the next segment unless a zero or a restart mark follows. An end mark
//! (EOI) closes the file. Data behind the end mark is ignored, since cameras append films and
//! second pictures. A WebP file states its length in its header.

use std::io::{BufRead, Seek, SeekFrom};

use image::ImageFormat;

/// Returns a description of the missing part of a file, if any is detected. The position of the
/// reader afterwards is unspecified.
pub(super) fn what_is_missing(
    format: ImageFormat,
    reader: &mut (impl BufRead + Seek),
) -> std::io::Result<Option<&'static str>> {
    match format {
        ImageFormat::Jpeg => Ok((!jpeg_ends(reader)?).then_some("it ends before its last mark")),
        ImageFormat::WebP => Ok((!webp_has_its_length(reader)?).then_some("it is shorter than it says")),
        _ => Ok(None),
    }
}

fn jpeg_ends(reader: &mut (impl BufRead + Seek)) -> std::io::Result<bool> {
    const START_OF_IMAGE: u8 = 0xd8;
    const END_OF_IMAGE: u8 = 0xd9;
    let end = reader.seek(SeekFrom::End(0))?;
    reader.seek(SeekFrom::Start(0))?;
    loop {
        let Some(mark) = next_mark(reader)? else { return Ok(false) };
        match mark {
            END_OF_IMAGE => return Ok(true),
            // Marks without a length: restarts, the zero that makes 255 a value, and an unused
            // mark.
            START_OF_IMAGE | 0x00 | 0x01 | 0xd0..=0xd7 => {}
            _ => {
                let mut length = [0; 2];
                if reader.read_exact(&mut length).is_err() {
                    return Ok(false);
                }
                let behind = i64::from(u16::from_be_bytes(length)) - 2;
                reader.seek_relative(behind.max(0))?;
                if reader.stream_position()? > end {
                    return Ok(false);
                }
            }
        }
    }
}

/// Returns the byte behind the next 255.
fn next_mark(reader: &mut impl BufRead) -> std::io::Result<Option<u8>> {
    let mut after = false;
    loop {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            return Ok(None);
        }
        let (used, found) = if after {
            // Any number of bytes 255 may precede a mark.
            (1, (buffer[0] != 0xff).then_some(buffer[0]))
        } else {
            match buffer.iter().position(|byte| *byte == 0xff) {
                Some(at) => {
                    after = true;
                    (at + 1, None)
                }
                None => (buffer.len(), None),
            }
        };
        reader.consume(used);
        if found.is_some() {
            return Ok(found);
        }
    }
}

fn webp_has_its_length(reader: &mut (impl BufRead + Seek)) -> std::io::Result<bool> {
    let end = reader.seek(SeekFrom::End(0))?;
    reader.seek(SeekFrom::Start(4))?;
    let mut length = [0; 4];
    if reader.read_exact(&mut length).is_err() {
        return Ok(false);
    }
    // The stated length excludes the header of eight bytes.
    Ok(u64::from(u32::from_le_bytes(length)) + 8 <= end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn is_whole(format: ImageFormat, bytes: &[u8]) -> bool {
        what_is_missing(format, &mut Cursor::new(bytes)).unwrap().is_none()
    }

    #[test]
    fn every_cut_of_a_file_is_told() {
        let picture = image::GrayImage::from_fn(40, 30, |x, y| image::Luma([(x * y * 7 % 256) as u8]));
        for format in [ImageFormat::Jpeg, ImageFormat::WebP] {
            let mut file = Cursor::new(Vec::new());
            // The lossless encoder accepts only colour.
            image::DynamicImage::from(picture.clone()).to_rgb8().write_to(&mut file, format).unwrap();
            let bytes = file.into_inner();
            assert!(is_whole(format, &bytes), "{format:?}");
            for length in 0..bytes.len() {
                assert!(!is_whole(format, &bytes[..length]), "{format:?} {length}");
            }
            let more = [&bytes[..], b"what a camera puts behind"].concat();
            assert!(is_whole(format, &more));
        }
    }
}
