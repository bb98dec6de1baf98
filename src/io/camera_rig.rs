//! Folders of sequences recorded together by calibrated cameras.
//!
//! `NAME` is a folder of numbered frames, or `NAME.EXT` a video. `NAME.P` is its camera, 3×4 in
//! three rows. The true matches of cameras A and B are in `truth-A-B.txt`, rows `x1 y1 x2 y2`. A and
//! B are the names of the cameras or the numbers at the end of the names.

use std::path::{Path, PathBuf};

use super::geometry_file::read_point_pairs;
use super::read::{ReadError, read_folder};
use super::sequence_file::is_sequence;
use super::vgg::read_camera;
use crate::geometry::{Camera, PointPair};

/// Cameras with the paths of their sequences. The frames are not loaded.
#[derive(Debug, Clone)]
pub struct CameraRig {
    path: PathBuf,
    /// Names, one per camera.
    pub names: Vec<String>,
    /// Paths of the sequences, one per camera.
    pub sequences: Vec<PathBuf>,
    /// Cameras in the order of `names`.
    pub cameras: Vec<Camera>,
}

impl CameraRig {
    /// Reads the cameras of a folder that have a sequence. Returns `None` for fewer than two.
    pub fn find(folder: &Path) -> Result<Option<Self>, ReadError> {
        let entries = read_folder(folder)?;
        let cameras = entries.iter().filter(|file| file.extension().is_some_and(|e| e == "P"));
        let mut found: Vec<(String, PathBuf, PathBuf)> = Vec::new();
        for camera in cameras {
            let Some(name) = camera.file_stem().map(|stem| stem.to_string_lossy().into_owned()) else {
                continue;
            };
            let is_its = |path: &&PathBuf| {
                let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
                *path != camera && stem.is_some_and(|stem| stem == name.as_str()) && is_sequence(path)
            };
            if let Some(sequence) = entries.iter().find(is_its) {
                found.push((name, sequence.clone(), camera.clone()));
            }
        }
        if found.len() < 2 {
            return Ok(None);
        }
        found.sort();
        let cameras = found.iter().map(|(_, _, camera)| read_camera(camera)).collect::<Result<_, _>>()?;
        let (names, sequences) = found.into_iter().map(|(name, sequence, _)| (name, sequence)).unzip();
        Ok(Some(Self { path: folder.to_owned(), names, sequences, cameras }))
    }

    /// Reads a folder like [`CameraRig::find`], with an error for fewer than two cameras.
    pub fn open(folder: &Path) -> Result<Self, ReadError> {
        let missing = "no sequences with cameras found. Each sequence is a folder of frames or a video NAME, with a camera NAME.P";
        Self::find(folder)?.ok_or_else(|| ReadError::content(folder, missing))
    }

    /// Returns the name of a pair of cameras.
    pub fn pair_name(&self, [first, second]: [usize; 2]) -> String {
        format!("{}-{}", self.names[first], self.names[second])
    }

    /// Reads the true matches of two cameras. The file may name the cameras in either order.
    pub fn matches(&self, [first, second]: [usize; 2]) -> Result<Vec<PointPair>, ReadError> {
        let file = |a: &str, b: &str| self.path.join(format!("truth-{a}-{b}.txt"));
        let (a, b) = (&self.names[first], &self.names[second]);
        for (a, b) in [(a.as_str(), b.as_str()), (number_of(a), number_of(b))] {
            if file(a, b).is_file() {
                return read_point_pairs(&file(a, b));
            }
            if file(b, a).is_file() {
                return Ok(read_point_pairs(&file(b, a))?.into_iter().map(PointPair::swapped).collect());
            }
        }
        let problem = format!(
            "the true matches of {a} and {b} are missing. Add a file truth-{a}-{b}.txt with rows x1 y1 x2 y2"
        );
        Err(ReadError::content(&self.path, problem))
    }
}

/// Returns the digits at the end of a name.
fn number_of(name: &str) -> &str {
    let start = name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    &name[start..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sequences_with_cameras_are_a_rig_and_matches_are_found_either_way_round() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let rig = || CameraRig::find(folder.path()).unwrap();
        write("cam02.P", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
        std::fs::create_dir(folder.path().join("cam02")).unwrap();
        write("other.P", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
        assert!(rig().is_none(), "one sequence is no pair");
        write("cam01.P", "1 0 0 1\n0 1 0 0\n0 0 1 0\n");
        write("cam01.mp4", "");
        let found = rig().unwrap();
        assert_eq!(found.names, ["cam01", "cam02"]);
        assert!(found.sequences[0].ends_with("cam01.mp4") && found.sequences[1].ends_with("cam02"));
        let told = found.matches([0, 1]).unwrap_err().to_string();
        assert!(told.contains("a file truth-cam01-cam02.txt"), "{told}");
        write("truth-02-01.txt", "1 2 3 4\n");
        assert_eq!(found.matches([0, 1]).unwrap(), [PointPair::new(3.0, 4.0, 1.0, 2.0)]);
        write("truth-cam01-cam02.txt", "5 6 7 8\n");
        assert_eq!(found.matches([0, 1]).unwrap(), [PointPair::new(5.0, 6.0, 7.0, 8.0)]);
        assert_eq!(found.pair_name([0, 1]), "cam01-cam02");
    }
}
