//! NumPy's format for one array, and archives of arrays.
//!
//! A file of version 1.0 begins with `\x93NUMPY`, the version, and the length of the header as
//! 16 bits, little-endian. The header is a Python dictionary in ASCII, padded with spaces and ended
//! by a line feed. The numbers follow. An archive is a ZIP file of arrays `NAME.npy`. Source:
//! `numpy.lib.format`.

use std::io::{Cursor, Write};

use nalgebra::Matrix3;
use zip::ZipWriter;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;

use crate::camera::PicturesOf;
use crate::geometry::FundamentalMatrix;
use crate::presentation::lenses_in_words;

/// Alignment of the first number, bytes.
const ALIGNMENT: usize = 64;
/// Bytes before the header: the mark, the version and the length.
const BEFORE_HEADER: usize = 10;

/// Returns the file of `F` as a 3×3 array of `float64` in C order.
///
/// # Errors
/// A clause for the user if `F` belongs to views without distortion, which an array cannot tell.
pub fn fundamental_as_npy(fundamental: &FundamentalMatrix, pictures: &PicturesOf) -> Result<Vec<u8>, String> {
    if pictures.is_undistorted() {
        return Err(format!(
            "F belongs to pictures without distortion ({}), and an array has no room for their lens. Export JSON or an \
             archive (.npz)",
            lenses_in_words(pictures)
        ));
    }
    Ok(matrix_as_npy(fundamental.matrix()))
}

/// Returns the file of a 3×3 array of `float64` in C order.
fn matrix_as_npy(matrix: &Matrix3<f64>) -> Vec<u8> {
    // nalgebra stores columns; the transpose has the rows in that order.
    array_as_npy(&[3, 3], matrix.transpose().as_slice())
}

/// Returns an archive of texts, and of arrays of `float64`: names, shapes, and numbers in C order.
pub(super) fn arrays_as_npz(texts: &[(&str, &str)], arrays: &[(&str, &[usize], &[f64])]) -> Vec<u8> {
    let packed = || -> ZipResult<Vec<u8>> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in texts {
            archive.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
            archive.write_all(&text_as_npy(text))?;
        }
        for (name, shape, numbers) in arrays {
            archive.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
            archive.write_all(&array_as_npy(shape, numbers))?;
        }
        Ok(archive.finish()?.into_inner())
    };
    packed().expect("writing to memory does not fail")
}

/// Returns the file of a text: an array without dimensions, four bytes a character.
fn text_as_npy(text: &str) -> Vec<u8> {
    let mut file = header(&format!("<U{}", text.chars().count()), &[]);
    file.extend(text.chars().flat_map(|c| u32::from(c).to_le_bytes()));
    file
}

/// Returns the file of an array of `float64` in C order.
fn array_as_npy(shape: &[usize], numbers: &[f64]) -> Vec<u8> {
    let mut file = header("<f8", shape);
    file.extend(numbers.iter().flat_map(|value| value.to_le_bytes()));
    file
}

/// Returns everything before the numbers of an array of this kind and shape.
pub(super) fn header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    // A tuple of one element needs its comma.
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape = format!("({}{comma})", sides.join(", "));
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let padded = (BEFORE_HEADER + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_HEADER;
    text.push_str(&" ".repeat(padded - text.len() - 1));
    text.push('\n');
    let mut before = b"\x93NUMPY\x01\x00".to_vec();
    before.extend((padded as u16).to_le_bytes());
    before.extend(text.as_bytes());
    before
}

/// Array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub shape: Vec<usize>,
    /// Numbers in C order. Numbers that are not finite stay as they are.
    pub numbers: Vec<f64>,
}

impl Array {
    /// Reads the content of a file.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn parse(file: &[u8]) -> Result<Self, String> {
        let damaged = || "the array is damaged".to_owned();
        let rest = file.strip_prefix(b"\x93NUMPY").ok_or("this is not a NumPy array")?;
        let (version, rest) = rest.split_at_checked(2).ok_or_else(damaged)?;
        let size = if version[0] == 1 { 2 } else { 4 };
        let (length, rest) = rest.split_at_checked(size).ok_or_else(damaged)?;
        let length = length.iter().rev().fold(0, |sum: usize, byte| sum << 8 | usize::from(*byte));
        let (header, data) = rest.split_at_checked(length).ok_or_else(damaged)?;
        let header = std::str::from_utf8(header).map_err(|_| damaged())?;
        let entry = |name: &str| header.split_once(&format!("'{name}':")).map(|(_, rest)| rest.trim_start());
        let kind = entry("descr").and_then(|rest| rest.split('\'').nth(1)).ok_or_else(damaged)?;
        let order = entry("fortran_order").ok_or_else(damaged)?;
        let shape =
            entry("shape").and_then(|rest| rest.strip_prefix('(')?.split_once(')')).ok_or_else(damaged)?.0;
        let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
        let shape: Vec<usize> =
            sides.map(|side| side.parse().map_err(|_| damaged())).collect::<Result<_, _>>()?;
        let count =
            shape.iter().try_fold(1usize, |product, side| product.checked_mul(*side)).ok_or_else(damaged)?;
        let (width, number) = number_of(kind)?;
        if count.checked_mul(width).is_none_or(|bytes| bytes != data.len()) {
            return Err(damaged());
        }
        let is_big = kind.starts_with('>');
        let number = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            if is_big {
                bytes.reverse();
            }
            number(&bytes)
        };
        let numbers: Vec<f64> = data.chunks_exact(width).map(number).collect();
        match order {
            _ if order.starts_with("False") => Ok(Self { shape, numbers }),
            _ if order.starts_with("True") => Ok(Self::from_columns(shape, &numbers)),
            _ => Err(damaged()),
        }
    }

    /// Creates an array from numbers in Fortran order: the first index changes fastest.
    fn from_columns(shape: Vec<usize>, numbers: &[f64]) -> Self {
        let place = |mut at: usize| {
            // The last index changes fastest in C order.
            let (mut place, mut stride) = (0, numbers.len());
            for side in shape.iter().rev() {
                stride /= side;
                place += at % side * stride;
                at /= side;
            }
            place
        };
        let numbers = (0..numbers.len()).map(|at| numbers[place(at)]).collect();
        Self { shape, numbers }
    }

    /// Returns the shape without sides of length 1 in front, down to two sides.
    pub fn batchless(&self) -> &[usize] {
        let mut shape = &self.shape[..];
        while shape.len() > 2 && shape[0] == 1 {
            shape = &shape[1..];
        }
        shape
    }

    /// Returns the rows of an array of two sides.
    pub fn rows(&self, columns: usize) -> std::slice::ChunksExact<'_, f64> {
        self.numbers.chunks_exact(columns.max(1))
    }
}

/// Returns whether a file is this text.
pub(super) fn is_text(file: &[u8], text: &str) -> bool {
    file == text_as_npy(text)
}

/// Returns whether a file is a NumPy array.
pub(super) fn is_npy(file: &[u8]) -> bool {
    file.starts_with(b"\x93NUMPY")
}

type Conversion = fn(&[u8]) -> f64;

/// Returns the width in bytes of a kind of number, and its conversion.
fn number_of(kind: &str) -> Result<(usize, Conversion), String> {
    macro_rules! of {
        ($t:ty, $convert:expr) => {
            Ok((size_of::<$t>(), |bytes| $convert(<$t>::from_le_bytes(bytes.try_into().unwrap_or_default()))))
        };
    }
    match &*kind.replace(['>', '='], "<") {
        "<f8" => of!(f64, |v: f64| v),
        "<f4" => of!(f32, f64::from),
        "<f2" => of!(u16, half),
        "<i8" => of!(i64, |v: i64| v as f64),
        "<u8" => of!(u64, |v: u64| v as f64),
        "<i4" => of!(i32, f64::from),
        "<u4" => of!(u32, f64::from),
        "<i2" => of!(i16, f64::from),
        "<u2" => of!(u16, f64::from),
        "|i1" => of!(i8, f64::from),
        "|u1" | "|b1" => of!(u8, f64::from),
        other if other.contains('O') => {
            Err("it holds Python objects (a pickle), which are not read. Save arrays of numbers".into())
        }
        other => {
            let other = crate::foreign::excerpt(other);
            Err(format!("arrays of {other} are not read. Save it as float64"))
        }
    }
}

/// Returns a number of half precision.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    sign * match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_orders_and_widths_give_the_same_numbers() {
        let plain = array_as_npy(&[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let mut columns = array_as_npy(&[2, 3], &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        let at = columns.windows(5).position(|part| part == b"False").unwrap();
        columns.splice(at..at + 5, *b"True ");
        assert_eq!(Array::parse(&columns), Array::parse(&plain));
        let of = |kind: &str, data: &[u8]| Array::parse(&[&header(kind, &[2])[..], data].concat());
        assert_eq!(
            of(">f4", &[&1.5f32.to_be_bytes()[..], &(-2f32).to_be_bytes()].concat()).unwrap().numbers,
            [1.5, -2.0]
        );
        assert_eq!(of("<f2", &[0x00, 0x3e, 0x01, 0x80]).unwrap().numbers, [1.5, -(2f64.powi(-24))]);
        assert!(of("|O", &[0; 16]).unwrap_err().contains("pickle"));
        let batch = Array { shape: vec![1, 1, 4, 2], numbers: vec![0.0; 8] };
        assert_eq!(batch.batchless(), [4, 2]);
    }

    #[test]
    fn arrays_come_back_and_damaged_ones_are_refused() {
        let file = matrix_as_npy(&Matrix3::new(1.0, -2.5, 3.0, 4.0, 5e-300, 6.0, 7.0, 8.0, 9.0));
        let array = Array::parse(&file).unwrap();
        assert_eq!((array.shape, array.numbers[1]), (vec![3, 3], -2.5));
        for end in 0..file.len() {
            assert!(Array::parse(&file[..end]).is_err(), "{end}");
        }
        let text = |from: &str, to: &str| {
            let at = file.windows(from.len()).position(|part| part == from.as_bytes()).unwrap();
            let mut changed = file.clone();
            changed[at..at + from.len()].copy_from_slice(to.as_bytes());
            Array::parse(&changed).unwrap_err()
        };
        assert!(text("<f8", "<c8").contains("float64"));
        assert!(text("False", "Flase").contains("damaged"));
        assert!(text("(3, 3)", "(3, 4)").contains("damaged"));
    }

    #[test]
    fn the_file_has_the_header_of_version_1_and_the_rows_in_order() {
        let file = matrix_as_npy(&Matrix3::new(1.0, -2.5, 3.0, 4.0, 5e-300, 6.0, 7.0, 8.0, 9.0));
        assert_eq!(file[..8], *b"\x93NUMPY\x01\x00");
        let length = usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!((10 + length) % 64, 0, "the numbers are aligned");
        let header = std::str::from_utf8(&file[10..10 + length]).unwrap();
        assert_eq!(header.trim_end(), "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }");
        assert!(header.ends_with(" \n"));
        let numbers: Vec<f64> = file[10 + length..]
            .chunks(8)
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
            .collect();
        assert_eq!(numbers, [1.0, -2.5, 3.0, 4.0, 5e-300, 6.0, 7.0, 8.0, 9.0]);
    }
}
