//! Sizes stated by the chunks of a WebP file. The decoder allocates pictures and metadata of any
//! stated size without a limit.

use std::io::{BufRead, Seek, SeekFrom};

/// Sizes stated by a WebP file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct WebpClaims {
    /// Width and height of each coded picture, px. Frames of an animation may exceed the canvas.
    pub pictures: Vec<[u32; 2]>,
    /// Whether colour profile, EXIF and XMP have their stated lengths.
    pub metadata_is_there: bool,
}

impl WebpClaims {
    /// Reads the headers of all chunks. The position of the reader afterwards is unspecified.
    pub(super) fn read(reader: &mut (impl BufRead + Seek)) -> std::io::Result<Self> {
        let end = reader.seek(SeekFrom::End(0))?;
        let mut claims = Self { pictures: Vec::new(), metadata_is_there: true };
        // The chunks follow `RIFF`, the length, and `WEBP`.
        claims.walk(reader, [12, end], end, false)?;
        Ok(claims)
    }

    /// Reads the chunks in `[from, to]`; `end` is the end of the file.
    fn walk(
        &mut self,
        reader: &mut (impl BufRead + Seek),
        [from, to]: [u64; 2],
        end: u64,
        in_frame: bool,
    ) -> std::io::Result<()> {
        /// Bytes of a chunk's name and length.
        const HEADER: u64 = 8;
        /// Bytes of a frame's position, size and duration, before its own chunks.
        const FRAME: u64 = 16;
        let mut at = from;
        while at + HEADER <= to.min(end) {
            reader.seek(SeekFrom::Start(at))?;
            let mut header = [0; HEADER as usize];
            reader.read_exact(&mut header)?;
            let [name @ .., a, b, c, d] = header;
            let length = u64::from(u32::from_le_bytes([a, b, c, d]));
            let begin = at + HEADER;
            match &name {
                b"VP8 " | b"VP8L" if begin + 10 <= end => {
                    let mut start = [0; 10];
                    reader.read_exact(&mut start)?;
                    self.pictures.extend(coded_size(name, &start));
                }
                b"ICCP" | b"EXIF" | b"XMP " => self.metadata_is_there &= begin + length <= end,
                // Frames contain no frames.
                b"ANMF" if !in_frame => self.walk(reader, [begin + FRAME, begin + length], end, true)?,
                _ => {}
            }
            // Chunks of odd length are padded.
            at = begin + length + length % 2;
        }
        Ok(())
    }
}

/// Returns width and height from the start of a coded picture. Returns `None` without the start
/// code, since the decoder rejects such a picture.
fn coded_size(name: [u8; 4], start: &[u8; 10]) -> Option<[u32; 2]> {
    const SIDE: u32 = 0x3fff;
    if name == *b"VP8L" {
        let bits = u32::from_le_bytes([start[1], start[2], start[3], start[4]]);
        return (start[0] == 0x2f).then_some([(bits & SIDE) + 1, (bits >> 14 & SIDE) + 1]);
    }
    let side = |at: usize| u32::from(u16::from_le_bytes([start[at], start[at + 1]])) & SIDE;
    (start[3..6] == [0x9d, 0x01, 0x2a]).then(|| [side(6), side(8)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn chunk(name: [u8; 4], length: u32, content: &[u8]) -> Vec<u8> {
        [&name[..], &length.to_le_bytes(), content].concat()
    }

    fn claims(chunks: &[Vec<u8>]) -> WebpClaims {
        let file = [b"RIFF\0\0\0\0WEBP".to_vec(), chunks.concat()].concat();
        WebpClaims::read(&mut Cursor::new(file)).unwrap()
    }

    #[test]
    fn coded_pictures_say_their_size_also_within_frames() {
        let lossy = chunk(*b"VP8 ", 10, &[0, 0, 0, 0x9d, 1, 0x2a, 0xc0, 0xfe, 0, 0x90]);
        let frame = [chunk(*b"ANMF", 34, &[0; 16]), lossy.clone()].concat();
        let found = claims(&[chunk(*b"ANIM", 6, &[0; 6]), frame, lossy]);
        assert_eq!(found.pictures, [[16064, 4096]; 2]);
        let mut file = Cursor::new(Vec::new());
        image::GrayImage::new(7, 5).write_to(&mut file, image::ImageFormat::WebP).unwrap();
        assert_eq!(WebpClaims::read(&mut file).unwrap().pictures, [[7, 5]]);
    }

    #[test]
    fn metadata_longer_than_the_file_is_told_and_nothing_runs_beyond_the_end() {
        assert!(claims(&[chunk(*b"EXIF", 4, &[0; 4])]).metadata_is_there);
        assert!(!claims(&[chunk(*b"EXIF", 0xffff_fff0, &[0; 4])]).metadata_is_there);
        assert!(!claims(&[chunk(*b"JUNK", 3, &[0; 4]), chunk(*b"ICCP", 5, &[0; 4])]).metadata_is_there);
        // Frames nested without end.
        let nested: Vec<Vec<u8>> = (0..200).map(|_| chunk(*b"ANMF", u32::MAX, &[0; 16])).collect();
        assert!(claims(&nested).pictures.is_empty());
        assert!(claims(&[vec![0; 3]]).pictures.is_empty());
    }
}
