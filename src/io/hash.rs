//! SHA-256 of files.

use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::read::ReadError;
use crate::foreign::{open_input, reason};

/// Returns the SHA-256 of a file's bytes, hexadecimal.
pub(super) fn sha256_of_file(path: &Path) -> Result<String, ReadError> {
    let input = open_input(path).map_err(|reason| ReadError::open(path, &reason))?;
    if input.size.is_none() {
        return Err(ReadError::content(path, "this is not a file"));
    }
    let mut file = input.file;
    let mut hash = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match file.read(&mut block).map_err(|e| ReadError::open(path, &reason(&e)))? {
            0 => return Ok(hexadecimal(hash)),
            count => hash.update(&block[..count]),
        }
    }
}

pub(super) fn sha256_of_bytes(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
