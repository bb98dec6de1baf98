//! Matches from other programs, with their weights.
//!
//! Text and JSON are those of geometry files. NumPy archives (`.npz`) have the names of matchers:
//!
//! - `keypoints0`, `keypoints1` and `matches`, or `mkpts0` and `mkpts1`;
//! - scores: `matching_scores`, `match_confidence`, `scores` or `mconf`;
//! - covariances of the points in image 2: `covariances`, N×2×2.

use std::io::{Cursor, Read};
use std::path::Path;

use zip::ZipArchive;

use super::geometry_file::{GeometryFile, point_pairs};
use super::npy::Array;
use super::read::{ReadError, read_bytes};
use crate::estimate::Match;
use crate::geometry::{Point, PointPair};

/// Largest array of an archive that is read, bytes.
const MOST_BYTES: u64 = 256 << 20;
/// Smallest prior of a match: a score of zero does not exclude it.
const LEAST_PRIOR: f64 = 0.01;

/// Reads matches, in the pictures as they are. Scores become prior probabilities, covariances become
/// scales of the noise.
pub fn read_matches(path: &Path) -> Result<Vec<Match>, ReadError> {
    let bytes = read_bytes(path)?;
    if bytes.starts_with(b"PK") {
        return archive(bytes).map_err(|problem| ReadError::content(path, problem));
    }
    let pairs = point_pairs(path, bytes, GeometryFile::original_matches)?;
    Ok(pairs.into_iter().map(Match::from).collect())
}

/// Reads the matches of an archive.
fn archive(bytes: Vec<u8>) -> Result<Vec<Match>, String> {
    let damaged = |e: zip::result::ZipError| format!("the archive is damaged: {e}");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut array = |names: &[&str]| -> Result<Option<Array>, String> {
        for name in names {
            let Ok(file) = archive.by_name(&format!("{name}.npy")) else { continue };
            let mut content = Vec::new();
            let read = file.take(MOST_BYTES + 1).read_to_end(&mut content);
            read.map_err(|e| format!("{name} cannot be unpacked: {e}"))?;
            if content.len() as u64 > MOST_BYTES {
                return Err(format!("{name} is larger than {} MiB, the limit", MOST_BYTES >> 20));
            }
            return Array::parse(&content).map(Some).map_err(|e| format!("{name}: {e}"));
        }
        Ok(None)
    };
    let scores = array(&["matching_scores", "match_confidence", "mconf", "scores", "confidence"])?;
    let covariances = array(&["covariances", "covariance"])?;
    let (pairs, scores) = if let Some(first) = array(&["mkpts0", "mkpts_0", "points0"])? {
        let second = array(&["mkpts1", "mkpts_1", "points1"])?.ok_or("there is mkpts0, but no mkpts1")?;
        let (first, second) = (points(&first, "mkpts0")?, points(&second, "mkpts1")?);
        if first.len() != second.len() {
            return Err(format!("mkpts0 has {} points and mkpts1 {}", first.len(), second.len()));
        }
        let pairs = first.into_iter().zip(second).map(|(point1, point2)| PointPair { point1, point2 });
        (pairs.collect(), scores.map(|scores| scores.numbers))
    } else {
        let expected = "expected mkpts0 and mkpts1, or keypoints0, keypoints1 and matches";
        let missing = || format!("there are no matches in it: {expected}");
        let first = points(&array(&["keypoints0"])?.ok_or_else(missing)?, "keypoints0")?;
        let second = points(&array(&["keypoints1"])?.ok_or_else(missing)?, "keypoints1")?;
        let matches = array(&["matches", "matches0"])?.ok_or_else(missing)?;
        indexed(&first, &second, &matches, scores)?
    };
    let deviations = covariances.map(|c| deviations(&c, pairs.len())).transpose()?;
    if scores.as_ref().is_some_and(|scores| scores.len() != pairs.len()) {
        return Err(format!(
            "there are {} scores for {} matches",
            scores.map_or(0, |s| s.len()),
            pairs.len()
        ));
    }
    let matches = pairs.iter().enumerate().map(|(k, pair)| Match {
        pair: *pair,
        sigma: deviations.as_ref().map_or(1.0, |d| d[k]),
        prior: scores
            .as_ref()
            .map_or(1.0, |s| if s[k].is_finite() { s[k].clamp(LEAST_PRIOR, 1.0) } else { 1.0 }),
    });
    let matches: Vec<Match> = matches.collect();
    if matches.is_empty() { Err("there are no matches in it".into()) } else { Ok(matches) }
}

/// Returns the matched keypoints with their scores. Matches are rows of two indices, or one index for
/// each first keypoint, −1 for none.
fn indexed(
    first: &[Point],
    second: &[Point],
    matches: &Array,
    scores: Option<Array>,
) -> Result<(Vec<PointPair>, Option<Vec<f64>>), String> {
    let scores = scores.map(|scores| scores.numbers);
    let indices: Vec<[f64; 2]> = match matches.shape[..] {
        [_, 2] => matches.numbers.chunks_exact(2).map(|row| [row[0], row[1]]).collect(),
        [_] | [1, _] => matches.numbers.iter().enumerate().map(|(k, index)| [k as f64, *index]).collect(),
        _ => return Err(format!("matches has the shape {:?}, expected N×2 or N", matches.shape)),
    };
    // Scores belong to the rows, or to the matches that remain.
    let belongs = scores.as_ref().is_some_and(|scores| scores.len() == indices.len());
    let (mut pairs, mut kept) = (Vec::new(), Vec::new());
    for (k, [i, j]) in indices.iter().enumerate().filter(|(_, [i, j])| *i >= 0.0 && *j >= 0.0) {
        let (Some(point1), Some(point2)) = (first.get(*i as usize), second.get(*j as usize)) else {
            return Err(format!("match {} names keypoints {i} and {j}, which do not exist", k + 1));
        };
        pairs.push(PointPair { point1: *point1, point2: *point2 });
        kept.extend(scores.as_ref().filter(|_| belongs).map(|scores| scores[k]));
    }
    Ok((pairs, if belongs { Some(kept) } else { scores }))
}

/// Returns the points of an N×2 array; a leading 1 of a batch is left out.
fn points(array: &Array, name: &str) -> Result<Vec<Point>, String> {
    let ([_, 2] | [1, _, 2], true) = (&array.shape[..], array.numbers.iter().all(|v| v.is_finite())) else {
        return Err(format!("{name} has the shape {:?}, expected N×2 finite numbers", array.shape));
    };
    Ok(array.numbers.chunks_exact(2).map(|p| Point::new(p[0], p[1])).collect())
}

/// Returns the standard deviations of N×2×2 covariances in units of their median.
fn deviations(array: &Array, count: usize) -> Result<Vec<f64>, String> {
    if array.shape != [count, 2, 2] {
        return Err(format!("covariances has the shape {:?}, expected {count}×2×2", array.shape));
    }
    let deviation = |c: &[f64]| (0.5 * (c[0] + c[3])).sqrt();
    let all: Vec<f64> = array.numbers.chunks_exact(4).map(deviation).collect();
    if !all.iter().all(|d| d.is_finite() && *d > 0.0) {
        return Err("some covariances are not positive".into());
    }
    let typical = crate::geometry::median(all.iter().copied());
    Ok(all.into_iter().map(|d| d / typical).collect())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::super::npy::header;
    use super::*;

    fn npy(kind: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
        [&header(kind, shape)[..], data].concat()
    }

    fn floats(shape: &[usize], values: &[f32]) -> Vec<u8> {
        npy("<f4", shape, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    }

    fn integers(shape: &[usize], values: &[i64]) -> Vec<u8> {
        npy("<i8", shape, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    }

    fn packed(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in files {
            writer.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn archives_of_matchers_are_read() {
        let keypoints = [
            ("keypoints0", floats(&[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
            ("keypoints1", floats(&[1, 2, 2], &[11.0, 12.0, 13.0, 14.0])),
        ];
        let of = |rest: &[(&str, Vec<u8>)]| archive(packed(&[&keypoints[..], rest].concat()));
        let rows =
            of(&[("matches", integers(&[2, 2], &[0, 1, 2, 0])), ("scores", floats(&[2], &[0.9, 0.0]))]);
        let rows = rows.unwrap();
        assert_eq!(rows[0].pair, PointPair::new(1.0, 2.0, 13.0, 14.0));
        assert!((rows[0].prior - 0.9).abs() < 1e-6 && rows[1].prior > 0.0);
        // One index for each keypoint, with a confidence for each keypoint.
        let list = of(&[
            ("matches", integers(&[3], &[-1, 0, -1])),
            ("match_confidence", floats(&[3], &[0.0, 0.5, 0.0])),
        ]);
        assert_eq!(list.unwrap(), [Match { prior: 0.5, ..PointPair::new(3.0, 4.0, 11.0, 12.0).into() }]);
        let direct = archive(packed(&[
            ("mkpts0", floats(&[2, 2], &[1.0, 2.0, 3.0, 4.0])),
            ("mkpts1", floats(&[2, 2], &[5.0, 6.0, 7.0, 8.0])),
            ("covariances", floats(&[2, 2, 2], &[1.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 4.0])),
        ]));
        let sigmas: Vec<f64> = direct.unwrap().iter().map(|m| m.sigma).collect();
        assert!((sigmas[1] / sigmas[0] - 2.0).abs() < 1e-6);
        for (rest, told) in [
            (vec![("matches", integers(&[1, 2], &[0, 7]))], "do not exist"),
            (vec![("matches", integers(&[3, 1], &[0, 1, 0]))], "shape"),
            (vec![], "expected mkpts0"),
            (
                vec![("matches", integers(&[1, 2], &[0, 1])), ("scores", floats(&[3], &[1.0; 3]))],
                "3 scores for 1",
            ),
        ] {
            let problem = of(&rest).unwrap_err();
            assert!(problem.contains(told), "{problem}");
        }
    }

    #[test]
    fn damaged_archives_are_refused() {
        let whole =
            packed(&[("mkpts0", floats(&[1, 2], &[1.0, 2.0])), ("mkpts1", floats(&[1, 2], &[3.0, 4.0]))]);
        assert_eq!(archive(whole.clone()).unwrap().len(), 1);
        for end in (2..whole.len()).step_by(7) {
            assert!(archive(whole[..end].to_vec()).is_err(), "{end}");
        }
    }
}
