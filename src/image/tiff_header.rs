//! The first directory of a TIFF file, read before decoding.
//!
//! The decoder allocates each list at the length in the header, about 32 bytes per entry, before
//! reading it. [`TiffHeader::lists_fit`] rejects lists longer than the whole file.

use std::io::{BufRead, Read, Seek, SeekFrom};

/// Tag of the compression.
pub(super) const COMPRESSION: u16 = 259;
/// Tag of the meaning of the colours.
pub(super) const PHOTOMETRIC: u16 = 262;

/// Byte order, kind and first directory of a TIFF file.
#[derive(Debug, Clone)]
pub(super) struct TiffHeader {
    pub big_endian: bool,
    /// Whether it is a `BigTIFF` file, with 64-bit offsets.
    pub is_big: bool,
    /// Length of the file, bytes.
    pub length: u64,
    entries: Vec<TiffEntry>,
}

/// An entry of a directory.
#[derive(Debug, Clone, Copy)]
pub(super) struct TiffEntry {
    pub tag: u16,
    kind: u16,
    count: u64,
    /// Place of the entry in the file.
    pub at: u64,
}

impl TiffHeader {
    /// Reads the header. `None` for anything but a TIFF file.
    pub fn read(reader: &mut (impl BufRead + Seek)) -> std::io::Result<Option<Self>> {
        /// Maximum number of entries read. Valid directories have about twenty.
        const MOST_ENTRIES: u64 = 4096;
        let length = reader.seek(SeekFrom::End(0))?;
        reader.seek(SeekFrom::Start(0))?;
        let mut order = [0; 2];
        if reader.read_exact(&mut order).is_err() || ![*b"II", *b"MM"].contains(&order) {
            return Ok(None);
        }
        let big_endian = order == *b"MM";
        let mut numbers = Numbers { reader, big_endian };
        let is_big = match numbers.read(2) {
            Some(42) => false,
            Some(43) => true,
            _ => return Ok(None),
        };
        let mut header = Self { big_endian, is_big, length, entries: Vec::new() };
        // BigTIFF first states the size of its offsets, then two zero bytes.
        let start = if is_big { numbers.read(4).and_then(|_| numbers.read(8)) } else { numbers.read(4) };
        let Some(start) = start else { return Ok(Some(header)) };
        numbers.reader.seek(SeekFrom::Start(start))?;
        let Some(entries) = numbers.read(if is_big { 8 } else { 2 }) else { return Ok(Some(header)) };
        for _ in 0..entries.min(MOST_ENTRIES) {
            let at = numbers.reader.stream_position()?;
            let width = header.width();
            let entry = (numbers.read(2), numbers.read(2), numbers.read(width), numbers.read(width));
            let (Some(tag), Some(kind), Some(count), Some(_)) = entry else { break };
            header.entries.push(TiffEntry { tag: tag as u16, kind: kind as u16, count, at });
        }
        Ok(Some(header))
    }

    /// Returns the width of counts and offsets, bytes.
    pub fn width(&self) -> usize {
        if self.is_big { 8 } else { 4 }
    }

    /// Returns whether all lists fit into the file.
    pub fn lists_fit(&self) -> bool {
        self.entries.iter().all(|entry| entry.count.saturating_mul(entry.size() as u64) <= self.length)
    }

    pub fn entry(&self, tag: u16) -> Option<&TiffEntry> {
        self.entries.iter().find(|entry| entry.tag == tag)
    }

    /// Returns the unsigned numbers of a tag; nothing without the tag, or if it holds anything else.
    pub fn numbers(&self, reader: &mut (impl BufRead + Seek), tag: u16) -> std::io::Result<Vec<u64>> {
        let Some(entry) = self.entry(tag).filter(|entry| [1, 3, 4, 13, 16].contains(&entry.kind)) else {
            return Ok(Vec::new());
        };
        self.seek_to_values(reader, entry)?;
        let mut numbers = Numbers { reader, big_endian: self.big_endian };
        Ok((0..entry.count).map_while(|_| numbers.read(entry.size())).collect())
    }

    /// Returns the text of a tag, up to a zero byte; at most 64 bytes.
    pub fn text(&self, reader: &mut (impl BufRead + Seek), tag: u16) -> std::io::Result<Option<String>> {
        let Some(entry) = self.entry(tag).filter(|entry| entry.kind == 2) else { return Ok(None) };
        self.seek_to_values(reader, entry)?;
        let mut bytes = Vec::new();
        reader.take(entry.count.min(64)).read_to_end(&mut bytes)?;
        let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(Some(String::from_utf8_lossy(text).into_owned()))
    }

    /// Goes to the values of an entry: in the entry itself if they fit there.
    fn seek_to_values(&self, reader: &mut (impl BufRead + Seek), entry: &TiffEntry) -> std::io::Result<()> {
        let width = self.width();
        let inline = entry.at + 4 + width as u64;
        reader.seek(SeekFrom::Start(inline))?;
        if entry.count.saturating_mul(entry.size() as u64) > width as u64 {
            let place = Numbers { reader: &mut *reader, big_endian: self.big_endian }.read(width);
            reader.seek(SeekFrom::Start(place.unwrap_or(self.length)))?;
        }
        Ok(())
    }

    /// Returns a number as `bytes` bytes in the order of the file.
    pub fn bytes(&self, number: u64, bytes: usize) -> Vec<u8> {
        if self.big_endian {
            number.to_be_bytes()[8 - bytes..].to_vec()
        } else {
            number.to_le_bytes()[..bytes].to_vec()
        }
    }
}

impl TiffEntry {
    /// Returns the size of a value, bytes.
    fn size(&self) -> usize {
        match self.kind {
            3 | 8 => 2,
            4 | 9 | 11 | 13 => 4,
            5 | 10 | 12 | 16..=18 => 8,
            _ => 1,
        }
    }
}

struct Numbers<'a, R> {
    reader: &'a mut R,
    big_endian: bool,
}

impl<R: Read> Numbers<'_, R> {
    /// Reads a number of the given size in bytes, or `None` at the end of the file.
    fn read(&mut self, bytes: usize) -> Option<u64> {
        let mut buffer = [0; 8];
        let buffer = &mut buffer[..bytes];
        self.reader.read_exact(buffer).ok()?;
        let add = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        Some(if self.big_endian { buffer.iter().fold(0, add) } else { buffer.iter().rev().fold(0, add) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn fit(bytes: &[u8]) -> bool {
        TiffHeader::read(&mut Cursor::new(bytes)).unwrap().is_none_or(|header| header.lists_fit())
    }

    #[test]
    fn lists_longer_than_the_file_are_found() {
        let picture = image::RgbImage::new(20, 10);
        let mut file = Cursor::new(Vec::new());
        picture.write_to(&mut file, image::ImageFormat::Tiff).unwrap();
        let good = file.into_inner();
        assert!(fit(&good) && fit(b"") && fit(b"II") && fit(b"II*\0\xff\xff\xff\xff"));
        // The first entry lists bits per sample, eight million of them.
        let little = b"II*\0\x08\0\0\0\x01\0\x02\x01\x03\0\x01\xff\x7f\0\x08\0\0\0\0\0\0\0";
        let big = b"MM\0+\0\x08\0\0\0\0\0\0\0\0\0\x10\0\0\0\0\0\0\0\x01\x01\x02\0\x03\0\0\0\xff\0\0\0\0\0\0\0\0\0\0\0\0";
        assert!(!fit(little) && !fit(big));
        let mut file = Cursor::new(good);
        let header = TiffHeader::read(&mut file).unwrap().unwrap();
        assert_eq!(header.numbers(&mut file, 256).unwrap(), [20]);
        assert_eq!(header.numbers(&mut file, 258).unwrap(), [8, 8, 8]);
        assert!(header.numbers(&mut file, 42113).unwrap().is_empty());
        assert_eq!(header.text(&mut file, 42113).unwrap(), None);
    }
}
