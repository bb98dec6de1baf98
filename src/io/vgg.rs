//! Layout of the Oxford VGG multi-view sets.
//!
//! Each view has files `PREFIX.NNN.EXT`: an image, a 3×4 camera `.P` in three rows, and `.corners`
//! with one point per row. The tracks are in `PREFIX.nview-corners`, one per row and with one
//! column per view. A cell is an index from 0 into the corners of the view, or `*` if the point was
//! not visible. Coordinates count from the centre of the top-left pixel.

use std::path::{Path, PathBuf};

use nalgebra::Matrix3x4;

use super::number::{cells, finite_numbers, rows};
use super::read::{ReadError, has_image_extension, read_folder, read_text};
use crate::foreign::excerpt;
use crate::geometry::{Camera, Point, PointPair};

/// Views with cameras and tracks. Images are not loaded.
#[derive(Debug, Clone)]
pub struct VggFolder {
    /// Common prefix of the file names.
    pub prefix: String,
    /// Paths of the images, one per view.
    pub images: Vec<PathBuf>,
    /// Cameras, one per view.
    pub cameras: Vec<Camera>,
    /// Tracks with one entry per view.
    tracks: Vec<Vec<Option<Point>>>,
}

impl VggFolder {
    /// Reads the cameras, corners and tracks of all views.
    pub fn open(folder: &Path) -> Result<Self, ReadError> {
        let entries = read_folder(folder)?;
        let tracks_file = tracks_file(folder, &entries)?;
        let prefix = tracks_file
            .file_stem()
            .and_then(|s| s.to_str())
            .ok_or_else(|| ReadError::content(&tracks_file, "the name is not text"))?
            .to_owned();
        let indices = read_tracks(&tracks_file)?;
        let views = indices.first().map_or(0, |(_, row)| row.len());
        if views < 2 {
            return Err(ReadError::content(&tracks_file, "no tracks over two or more views found"));
        }
        let file = |view: usize, end: &str| folder.join(format!("{prefix}.{view:03}.{end}"));
        let cameras = (0..views).map(|v| read_camera(&file(v, "P"))).collect::<Result<_, _>>()?;
        let corners: Vec<_> =
            (0..views).map(|v| read_corners(&file(v, "corners"))).collect::<Result<_, _>>()?;
        let images = (0..views)
            .map(|v| {
                let stem = format!("{prefix}.{v:03}");
                let is_view = |p: &&PathBuf| {
                    p.file_stem().is_some_and(|s| s == stem.as_str()) && has_image_extension(p)
                };
                let missing = || ReadError::content(folder, format!("the image {stem}.* is missing"));
                entries.iter().find(is_view).cloned().ok_or_else(missing)
            })
            .collect::<Result<_, _>>()?;
        let tracks = indices
            .into_iter()
            .map(|(line, row)| {
                let point = |(view, index): (usize, Option<usize>)| match index {
                    None => Ok(None),
                    Some(index) => corners[view].get(index).copied().map(Some).ok_or_else(|| {
                        let found = corners[view].len();
                        let problem =
                            format!("corner {index} of view {view} does not exist ({found} corners)");
                        ReadError::line(&tracks_file, line, problem)
                    }),
                };
                row.into_iter().enumerate().map(point).collect()
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { prefix, images, cameras, tracks })
    }

    /// Returns the points visible in both views.
    pub fn matches(&self, view1: usize, view2: usize) -> Vec<PointPair> {
        self.tracks
            .iter()
            .filter_map(|track| {
                let (point1, point2) = ((*track.get(view1)?)?, (*track.get(view2)?)?);
                Some(PointPair { point1, point2 })
            })
            .collect()
    }
}

/// Returns the only `.nview-corners` file.
fn tracks_file(folder: &Path, entries: &[PathBuf]) -> Result<PathBuf, ReadError> {
    let mut found = entries.iter().filter(|p| p.extension().is_some_and(|e| e == "nview-corners"));
    match (found.next(), found.next()) {
        (Some(file), None) => Ok(file.clone()),
        (None, _) => Err(ReadError::content(
            folder,
            "not a VGG folder, which has one file PREFIX.nview-corners, and PREFIX.NNN.P and PREFIX.NNN.corners of each view",
        )),
        _ => Err(ReadError::content(folder, "there is more than one .nview-corners file")),
    }
}

/// Line number and one index into the corners per view.
type TrackRow = (usize, Vec<Option<usize>>);

/// Reads the rows of the tracks, all of equal length.
fn read_tracks(path: &Path) -> Result<Vec<TrackRow>, ReadError> {
    let text = read_text(path)?;
    let mut tracks: Vec<TrackRow> = Vec::new();
    for (line, row) in rows(&text) {
        let index = |cell: &str| match cell {
            "*" => Ok(None),
            number => number.parse().map(Some).map_err(|_| {
                ReadError::line(
                    path,
                    line,
                    format!("expected a corner's index or *, found \"{}\"", excerpt(cell)),
                )
            }),
        };
        let track = cells(row).map(index).collect::<Result<Vec<_>, _>>()?;
        if let Some((_, first)) = tracks.first()
            && first.len() != track.len()
        {
            let problem = format!("expected {} columns, one per view, found {}", first.len(), track.len());
            return Err(ReadError::line(path, line, problem));
        }
        tracks.push((line, track));
    }
    Ok(tracks)
}

/// Reads a camera from a `.P` file: three rows of four numbers.
pub fn read_camera(path: &Path) -> Result<Camera, ReadError> {
    let text = read_text(path)?;
    let mut values = Vec::new();
    for (line, row) in rows(&text) {
        let numbers = finite_numbers(row).map_err(|e| ReadError::line(path, line, e))?;
        if numbers.len() != 4 {
            let problem = format!("expected four numbers of a 3×4 camera matrix, found {}", numbers.len());
            return Err(ReadError::line(path, line, problem));
        }
        values.extend(numbers);
    }
    if values.len() != 12 {
        let problem = format!("expected a camera matrix of three rows, found {}", values.len() / 4);
        return Err(ReadError::content(path, problem));
    }
    Camera::from_matrix(Matrix3x4::from_row_slice(&values))
        .ok_or_else(|| ReadError::content(path, "this matrix is not a camera (its rank is below 3)"))
}

/// Reads corners, one per row.
fn read_corners(path: &Path) -> Result<Vec<Point>, ReadError> {
    let text = read_text(path)?;
    rows(&text)
        .map(|(line, row)| {
            let numbers = finite_numbers(row).map_err(|e| ReadError::line(path, line, e))?;
            let [x, y, ..] = numbers[..] else {
                let problem = format!("expected a corner x y, found {} number(s)", numbers.len());
                return Err(ReadError::line(path, line, problem));
            };
            Ok(Point::new(x, y))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a folder with two views and three tracks, one of them visible in one view only.
    fn example() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [
            ("set.000.P", "1 0 0 0\n0 1 0 0\n0 0 1 0\n"),
            ("set.001.P", "1 0 0 -1\n0 1 0 0\n0 0 1 0\n"),
            ("set.000.corners", "10 20\n30 40\n50 60\n"),
            ("set.001.corners", "11 20\n31 40\n"),
            ("set.nview-corners", "0 1\n2 0\n1 *\n"),
            ("set.000.pgm", ""),
            ("set.001.pgm", ""),
        ] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    fn problem_with(name: &str, text: Option<&str>) -> String {
        let folder = example();
        let path = folder.path().join(name);
        match text {
            Some(text) => std::fs::write(path, text).unwrap(),
            None => std::fs::remove_file(path).unwrap(),
        }
        VggFolder::open(folder.path()).unwrap_err().to_string()
    }

    #[test]
    fn reads_views_and_matches() {
        let folder = example();
        let set = VggFolder::open(folder.path()).unwrap();
        assert_eq!((&set.prefix[..], set.images.len(), set.cameras.len()), ("set", 2, 2));
        assert_eq!(
            set.matches(0, 1),
            [PointPair::new(10.0, 20.0, 31.0, 40.0), PointPair::new(50.0, 60.0, 11.0, 20.0)]
        );
        assert_eq!(set.matches(1, 0).len(), 2);
        assert!(set.matches(0, 7).is_empty());
    }

    #[test]
    fn names_file_and_line_of_malformed_rows() {
        for (name, text, expected) in [
            ("set.001.P", Some("1 0 0 0\n0 1 0\n0 0 1 0\n"), "set.001.P, line 2: expected four numbers"),
            ("set.001.P", Some("1 0 0 0\n0 1 0 x\n0 0 1 0\n"), "set.001.P, line 2: \"x\" is not"),
            ("set.001.P", Some("1 0 0 0\n0 1 0 0\n"), "set.001.P: expected a camera matrix of three rows"),
            ("set.001.P", Some("1 0 0 0\n1 0 0 0\n1 0 0 0\n"), "not a camera"),
            ("set.001.P", Some("nan 0 0 0\n0 1 0 0\n0 0 1 0\n"), "line 1: \"nan\" is not a finite"),
            ("set.000.corners", Some("10 20\n30\n50 60\n"), "set.000.corners, line 2: expected a corner"),
            ("set.nview-corners", Some("0 1\n2 9\n"), "set.nview-corners, line 2: corner 9 of view 1"),
            ("set.nview-corners", Some("0 1\n2\n"), "line 2: expected 2 columns"),
            ("set.nview-corners", Some("0 1\n-1 0\n"), "line 2: expected a corner's index"),
            ("set.nview-corners", Some(""), "no tracks"),
            ("set.001.P", None, "set.001.P: there is no such file"),
            ("set.000.pgm", None, "the image set.000.* is missing"),
            ("set.nview-corners", None, "not a VGG folder"),
        ] {
            let message = problem_with(name, text);
            assert!(message.contains(expected), "{message}");
        }
    }
}
