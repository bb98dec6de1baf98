//! A check of a TIFF header before decoding.
//!
//! The decoder allocates each list at the length in the header, about 32 bytes per entry, before
//! reading it. This check rejects lists longer than the whole file.

use std::io::{BufRead, Read, Seek, SeekFrom};

/// Returns whether all lists of the first directory fit into the file. Anything but a TIFF header
/// passes.
pub(super) fn lists_fit(reader: &mut (impl BufRead + Seek)) -> std::io::Result<bool> {
    let length = reader.seek(SeekFrom::End(0))?;
    Ok(longest_list(reader)?.is_none_or(|longest| longest <= length))
}

/// Returns the length in bytes of the longest list, if there is a readable directory.
fn longest_list(reader: &mut (impl BufRead + Seek)) -> std::io::Result<Option<u64>> {
    /// Maximum number of entries read. Valid directories have about twenty.
    const MOST_ENTRIES: u64 = 4096;
    reader.seek(SeekFrom::Start(0))?;
    let mut order = [0; 2];
    if reader.read_exact(&mut order).is_err() || ![*b"II", *b"MM"].contains(&order) {
        return Ok(None);
    }
    let mut numbers = Numbers { reader, big_endian: order == *b"MM" };
    let is_big = match numbers.read(2) {
        Some(42) => false,
        Some(43) => true,
        _ => return Ok(None),
    };
    // BigTIFF first states the size of its offsets, then two zero bytes.
    let start = if is_big { numbers.read(4).and_then(|_| numbers.read(8)) } else { numbers.read(4) };
    let Some(start) = start else { return Ok(None) };
    numbers.reader.seek(SeekFrom::Start(start))?;
    let (count_bytes, value_bytes) = if is_big { (8, 8) } else { (2, 4) };
    let Some(entries) = numbers.read(count_bytes) else { return Ok(None) };
    let mut longest = 0;
    for _ in 0..entries.min(MOST_ENTRIES) {
        let entry = (numbers.read(2), numbers.read(2), numbers.read(value_bytes), numbers.read(value_bytes));
        let (_, Some(kind), Some(count), Some(_)) = entry else { break };
        let size = match kind {
            3 | 8 => 2,
            4 | 9 | 11 | 13 => 4,
            5 | 10 | 12 | 16..=18 => 8,
            _ => 1,
        };
        longest = longest.max(count.saturating_mul(size));
    }
    Ok(Some(longest))
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
        lists_fit(&mut Cursor::new(bytes)).unwrap()
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
    }
}
