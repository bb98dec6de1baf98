//! A TIFF file read as if some of its bytes were others, and as if it were longer: for kinds that the
//! decoder does not know but for an entry of the directory, or for the compression.

use std::io::{BufRead, Read, Result, Seek, SeekFrom};

use ruzstd::decoding::StreamingDecoder;

use super::tiff_header::{COMPRESSION, TiffHeader};

/// A reader of a file with replaced and added bytes.
pub(super) struct Overlay<R> {
    inner: R,
    /// Length of the file, bytes.
    length: u64,
    position: u64,
    /// Replaced bytes and their places, of which no two overlap.
    replaced: Vec<(u64, Vec<u8>)>,
    /// Bytes behind the end of the file.
    added: Vec<u8>,
}

/// Sizes of the compressed parts of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunks {
    /// Tags of the places and lengths of the parts: of strips or of tiles.
    pub tags: [u16; 2],
    /// Largest length of a part without compression, bytes.
    pub longest: u64,
    /// Largest length of all parts together without compression, bytes.
    pub most: u64,
}

impl Chunks {
    /// Limits the length of all parts.
    pub fn within(self, most: u64) -> Self {
        Self { most: self.most.min(most), ..self }
    }
}

impl<R: BufRead + Seek> Overlay<R> {
    pub fn new(inner: R, length: u64) -> Self {
        Self { inner, length, position: 0, replaced: Vec::new(), added: Vec::new() }
    }

    /// Replaces a tag by one 16-bit number. Nothing happens without the tag.
    pub fn set_short(&mut self, header: &TiffHeader, tag: u16, value: u16) {
        const SHORT: u64 = 3;
        self.replace(header, tag, SHORT, 1, header.bytes(value.into(), 2));
    }

    fn replace(&mut self, header: &TiffHeader, tag: u16, kind: u64, count: u64, mut value: Vec<u8>) {
        let Some(entry) = header.entry(tag) else { return };
        value.resize(header.width(), 0);
        let bytes =
            [header.bytes(tag.into(), 2), header.bytes(kind, 2), header.bytes(count, header.width()), value];
        self.replaced.push((entry.at, bytes.concat()));
    }

    /// Replaces the compressed parts of a file with Zstandard compression by what they hold. Returns a
    /// description of the fault in a damaged file.
    pub fn decompress(&mut self, header: &TiffHeader, chunks: Chunks) -> Result<Option<&'static str>> {
        const UNCOMPRESSED: u16 = 1;
        /// Memory of the decoder, bytes. Only the highest of the 22 levels of compression may need more.
        const WINDOW: u64 = 64 << 20;
        const BROKEN: &str = "its compressed data is not valid";
        let [place_tag, length_tag] = chunks.tags;
        let places = header.numbers(&mut self.inner, place_tag)?;
        let lengths = header.numbers(&mut self.inner, length_tag)?;
        let (mut found_places, mut found_lengths) = (Vec::new(), Vec::new());
        for (place, length) in places.iter().zip(&lengths) {
            found_places.push(self.length + self.added.len() as u64);
            self.inner.seek(SeekFrom::Start(*place))?;
            let Ok(mut content) =
                StreamingDecoder::new_with_max_window_size((&mut self.inner).take(*length), WINDOW)
            else {
                return Ok(Some(BROKEN));
            };
            let before = self.added.len();
            let room = chunks.most.saturating_sub(before as u64).min(chunks.longest);
            if (&mut content).take(room).read_to_end(&mut self.added).is_err() {
                return Ok(Some(BROKEN));
            }
            found_lengths.push((self.added.len() - before) as u64);
        }
        for (tag, numbers) in [(place_tag, found_places), (length_tag, found_lengths)] {
            // 32 bits, or 64 in BigTIFF.
            let (kind, width) = if header.is_big { (16, 8) } else { (4, 4) };
            let end = self.length + self.added.len() as u64 + (numbers.len() * width) as u64;
            if !header.is_big && end > u64::from(u32::MAX) {
                return Ok(Some("without its compression it is longer than 4 GB"));
            }
            let count = numbers.len() as u64;
            let bytes: Vec<u8> = numbers.iter().flat_map(|number| header.bytes(*number, width)).collect();
            let value = if numbers.len() == 1 {
                bytes
            } else {
                let place = self.length + self.added.len() as u64;
                self.added.extend(bytes);
                header.bytes(place, width)
            };
            self.replace(header, tag, kind, count, value);
        }
        self.set_short(header, COMPRESSION, UNCOMPRESSED);
        self.position = 0;
        Ok(None)
    }
}

impl<R: BufRead + Seek> Read for Overlay<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let from = self.position;
        let count = if from < self.length {
            self.inner.seek(SeekFrom::Start(from))?;
            let most = usize::try_from(self.length - from).unwrap_or(usize::MAX).min(buffer.len());
            self.inner.read(&mut buffer[..most])?
        } else {
            let start = usize::try_from(from - self.length).unwrap_or(usize::MAX).min(self.added.len());
            (&self.added[start..]).read(buffer)?
        };
        for (place, bytes) in &self.replaced {
            let (first, last) = ((*place).max(from), (place + bytes.len() as u64).min(from + count as u64));
            if first < last {
                let own = (first - place) as usize..(last - place) as usize;
                buffer[(first - from) as usize..(last - from) as usize].copy_from_slice(&bytes[own]);
            }
        }
        self.position += count as u64;
        Ok(count)
    }
}

impl<R> Seek for Overlay<R> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let end = self.length + self.added.len() as u64;
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => end.checked_add_signed(by),
        };
        self.position = place.ok_or(std::io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
