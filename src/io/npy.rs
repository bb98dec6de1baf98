//! NumPy's format for one array: `numpy.load` reads it.
//!
//! A file of version 1.0 begins with `\x93NUMPY`, the version, and the length of the header as
//! 16 bits, little-endian. The header is a Python dictionary in ASCII, padded with spaces and ended
//! by a line feed. The numbers follow. Source: `numpy.lib.format`.

use nalgebra::Matrix3;

/// Alignment of the first number, bytes.
const ALIGNMENT: usize = 64;
/// Bytes before the header: the mark, the version and the length.
const BEFORE_HEADER: usize = 10;

/// Returns the file of a 3×3 array of `float64` in C order.
pub fn matrix_as_npy(matrix: &Matrix3<f64>) -> Vec<u8> {
    let mut header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }".to_owned();
    let padded = (BEFORE_HEADER + header.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_HEADER;
    header.push_str(&" ".repeat(padded - header.len() - 1));
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((padded as u16).to_le_bytes());
    file.extend(header.as_bytes());
    // nalgebra stores columns; the transpose has the rows in that order.
    file.extend(matrix.transpose().iter().flat_map(|value| value.to_le_bytes()));
    file
}

#[cfg(test)]
mod tests {
    use super::*;

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
