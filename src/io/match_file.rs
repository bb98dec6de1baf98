//! Matches from other programs, with their weights.
//!
//! Any geometry file with point pairs has matches. NumPy archives (`.npz`) and JSON may have arrays with the names
//! of matchers.

use std::path::Path;

use super::geometry_file::read_pairs;
use super::npy::Array;
use super::read::ReadError;
use super::values::{FoundMatches, NamedArray, matches_of};
use crate::estimate::Match;

/// Matches of a file, in the pictures as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchFile {
    /// At least one. Scores became prior probabilities, covariances scales of the noise.
    pub matches: Vec<Match>,
    /// Clauses about what was read and what was left out.
    pub remarks: Vec<String>,
}

impl MatchFile {
    /// Reads the matches of a geometry file, a result or a matcher.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let mut file = read_pairs(path)?;
        let remarks = std::mem::take(&mut file.remarks);
        let weighted = std::mem::take(&mut file.weighted);
        if !weighted.is_empty() {
            return Ok(Self { matches: weighted, remarks });
        }
        let pairs = file.original_matches().map_err(|problem| ReadError::content(path, problem))?;
        let matches: Vec<Match> = pairs.into_iter().map(Match::from).collect();
        if matches.is_empty() {
            return Err(ReadError::content(path, "none of its matches lies within the range of the lenses"));
        }
        Ok(Self { matches, remarks })
    }

    /// Reads the matches of named arrays, as a NumPy archive has them: name, shape, and numbers in C order.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn of_arrays(
        arrays: impl IntoIterator<Item = (String, Vec<usize>, Vec<f64>)>,
    ) -> Result<Self, String> {
        let named = arrays.into_iter().map(|(name, shape, numbers)| {
            let is_whole = shape.iter().product::<usize>() == numbers.len();
            (
                name,
                if is_whole { Ok(Array { shape, numbers }) } else { Err("the array is damaged".to_owned()) },
            )
        });
        let named: Vec<NamedArray> = named.collect();
        let names = || named.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        let found = matches_of(&named)?.filter(|found| !found.matches.is_empty());
        let FoundMatches { matches, notes } =
            found.ok_or_else(|| format!("there are no matches among the arrays {}", names()))?;
        Ok(Self { matches, remarks: notes })
    }
}

/// Reads the matches of a file, without notes on how they were read.
pub fn read_matches(path: &Path) -> Result<Vec<Match>, ReadError> {
    Ok(MatchFile::read(path)?.matches)
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::super::npy::header;
    use super::*;
    use crate::geometry::PointPair;

    fn npy(kind: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
        [&header(kind, shape)[..], data].concat()
    }

    fn floats(shape: &[usize], values: &[f32]) -> Vec<u8> {
        npy("<f4", shape, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    }

    fn packed(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in files {
            writer.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn read(bytes: &[u8]) -> Result<MatchFile, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("matches.npz");
        std::fs::write(&path, bytes).unwrap();
        MatchFile::read(&path).map_err(|e| e.to_string())
    }

    #[test]
    fn archives_of_matchers_are_read() {
        let direct = packed(&[
            ("mkpts0", floats(&[2, 2], &[1.0, 2.0, 3.0, 4.0])),
            ("mkpts1", floats(&[2, 2], &[5.0, 6.0, 7.0, 8.0])),
            ("covariances", floats(&[2, 2, 2], &[1.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 4.0])),
        ]);
        let sigmas: Vec<f64> = read(&direct).unwrap().matches.iter().map(|m| m.sigma).collect();
        assert!((sigmas[1] / sigmas[0] - 2.0).abs() < 1e-6);
        // An array alone, and the same numbers as text, JSON and an archive.
        let four = [1.0, 2.0, 30.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let expected: Vec<Match> = [PointPair::new(1.0, 2.0, 30.0, 4.0), PointPair::new(5.0, 6.0, 7.0, 8.0)]
            .map(Match::from)
            .to_vec();
        for bytes in [
            floats(&[2, 4], &four),
            floats(&[2, 2, 2], &four),
            b"1 2 30 4\n5 6 7 8".to_vec(),
            b"{\"mkpts0\": [[1, 2], [5, 6]], \"mkpts1\": [[30, 4], [7, 8]]}".to_vec(),
            b"{\"keypoints0\": [[5, 6], [1, 2]], \"keypoints1\": [[30, 4], [7, 8]], \"matches\": [[1, 0], [0, 1]]}".to_vec(),
            packed(&[("arr_0", floats(&[2, 4], &four))]),
        ] {
            assert_eq!(read(&bytes).unwrap().matches, expected);
        }
    }

    #[test]
    fn arrays_in_memory_are_read_like_an_archive() {
        let points = |name: &str, numbers: [f64; 4]| (name.to_owned(), vec![2, 2], numbers.to_vec());
        let both = [points("keypoints0", [1.0, 2.0, 5.0, 6.0]), points("keypoints1", [30.0, 4.0, 7.0, 8.0])];
        let found = MatchFile::of_arrays(both.clone()).unwrap();
        assert_eq!(found.matches[0].pair, PointPair::new(1.0, 2.0, 30.0, 4.0));
        assert_eq!(found.remarks, ["row k of keypoints0 was matched with row k of keypoints1"]);
        let [first, (name, _, numbers)] = both;
        let told = |arrays: Vec<_>| MatchFile::of_arrays(arrays).unwrap_err();
        assert!(told(vec![first.clone()]).contains("keypoints0, but no array of the same name"));
        assert_eq!(told(vec![first, (name, vec![3, 2], numbers)]), "keypoints1: the array is damaged");
        assert_eq!(told(vec![("x".into(), vec![1], vec![0.0])]), "there are no matches among the arrays x");
    }

    #[test]
    fn other_files_are_named() {
        let no_matches = packed(&[("x", floats(&[1], &[1.0])), ("y", floats(&[1], &[1.0]))]);
        for (bytes, told) in [
            (no_matches, "among its arrays x, y"),
            (packed(&[]), "no arrays"),
            (
                packed(&[("mkpts0", npy("|O", &[2], &[0; 16])), ("mkpts1", npy("|O", &[2], &[0; 16]))]),
                "pickle",
            ),
            (b"\x89HDF\r\n\x1a\n rest".to_vec(), "HDF5"),
            (b"MATLAB 5.0 MAT-file, Platform: GLNXA64".to_vec(), "writematrix"),
            ([[0u32, 3, 3, 0, 2].map(u32::to_le_bytes).concat(), b"F\0".to_vec()].concat(), "MATLAB"),
            (floats(&[3, 3, 3], &[1.0; 27]), "shape 3×3×3"),
        ] {
            let problem = read(&bytes).unwrap_err();
            assert!(problem.contains(told), "{problem}");
        }
    }

    #[test]
    fn damaged_archives_are_refused() {
        let whole =
            packed(&[("mkpts0", floats(&[1, 2], &[1.0, 2.0])), ("mkpts1", floats(&[1, 2], &[3.0, 4.0]))]);
        assert_eq!(read(&whole).unwrap().matches.len(), 1);
        for end in (2..whole.len()).step_by(7) {
            assert!(read(&whole[..end]).is_err(), "{end}");
        }
    }
}
