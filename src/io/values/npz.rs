//! NumPy archives (`.npz`).

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::match_arrays::NamedArray;
use super::match_names::concerns_matches;
use super::matrix_name::names_matrix;
use crate::camera::PicturesOf;
use crate::foreign::excerpt;
use crate::io::npy::{Array, is_text};

/// Largest array of an archive that is read, bytes, and the largest sum of all.
const MOST_BYTES: u64 = 256 << 20;
/// Largest array of an archive with a name without meaning that is read, bytes.
const MOST_UNNAMED: u64 = 16 << 20;

/// Reads the arrays of an archive whose names have a meaning, and small others.
pub(in crate::io) fn archive(bytes: Vec<u8>) -> Result<Vec<NamedArray>, String> {
    let damaged = |e: zip::result::ZipError| format!("the archive is damaged: {e}");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let (mut arrays, mut total) = (Vec::new(), 0);
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(damaged)?;
        let Some(name) = file.name().map_err(damaged)?.strip_suffix(".npy").map(excerpt) else {
            continue;
        };
        let has_meaning = concerns_matches(&name) || names_matrix(&name);
        let most = (if has_meaning { MOST_BYTES } else { MOST_UNNAMED }).min(MOST_BYTES - total);
        let mut content = Vec::new();
        let read = file.take(most + 1).read_to_end(&mut content);
        read.map_err(|e| format!("{name} cannot be unpacked: {e}"))?;
        if content.len() as u64 <= most {
            total += content.len() as u64;
            if name == "pictures" && is_text(&content, PicturesOf::UNDISTORTED) {
                arrays.push((
                    PicturesOf::UNDISTORTED.to_owned(),
                    Ok(Array { shape: Vec::new(), numbers: vec![1.0] }),
                ));
                continue;
            }
            let array = Array::parse(&content);
            arrays.push((name, array));
        } else if has_meaning {
            return Err(format!("{name} is larger than {} MiB, the limit", most >> 20));
        }
    }
    Ok(arrays)
}
