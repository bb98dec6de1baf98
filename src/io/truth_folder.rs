//! Folder of images with ground truth, in any layout: its views, its pairs, and the ground truth of
//! each pair.

use std::path::{Path, PathBuf};

use super::camera_rig::CameraRig;
use super::ground_truth::{GroundTruth, TruthError};
use super::pair_folder::{PairFiles, find_pairs};
use super::read::{ReadError, read_folder};
use super::vgg::VggFolder;

/// Folder in the VGG layout, of pairs, or of sequences with cameras. Images are not loaded.
///
/// Views are counted from 0. In a VGG folder any two views form a pair, as do any two sequences. In
/// a folder of pairs, views 0 and 1, 2 and 3, and so on form pairs.
#[derive(Debug, Clone)]
pub struct TruthFolder {
    path: PathBuf,
    names: Vec<String>,
    images: Vec<PathBuf>,
    layout: FolderLayout,
}

#[derive(Debug, Clone)]
enum FolderLayout {
    Views(VggFolder),
    Pairs(Vec<PairFiles>),
    Sequences(CameraRig),
}

impl TruthFolder {
    /// Reads the folder without its images. Matches of a folder of pairs are not read either.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let entries = read_folder(path)?;
        let is_vgg = entries.iter().any(|entry| entry.extension().is_some_and(|e| e == "nview-corners"));
        let layout = if is_vgg {
            FolderLayout::Views(VggFolder::open(path)?)
        } else if let Some(rig) = CameraRig::find(path)? {
            FolderLayout::Sequences(rig)
        } else {
            FolderLayout::Pairs(find_pairs(path)?)
        };
        let images: Vec<PathBuf> = match &layout {
            FolderLayout::Views(set) => set.images.clone(),
            FolderLayout::Pairs(pairs) => pairs.iter().flat_map(|files| files.images.clone()).collect(),
            FolderLayout::Sequences(rig) => rig.sequences.clone(),
        };
        if images.is_empty() {
            let problem = "no image pairs with ground truth found. Give a VGG folder (PREFIX.NNN.P, \
                           PREFIX.NNN.corners and PREFIX.nview-corners beside the images), pairs (NAMEA.*, NAMEB.* \
                           and NAME.txt) or sequences (folders of frames NAME with NAME.P)";
            return Err(ReadError::content(path, problem));
        }
        let name = |image: &PathBuf| image.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let names = match &layout {
            // The name of a folder has no extension to remove.
            FolderLayout::Sequences(rig) => rig.names.clone(),
            _ => images.iter().map(name).collect(),
        };
        Ok(Self { path: path.to_owned(), names, images, layout })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the names of the views: their image names without extension.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns whether any two views form a pair.
    pub fn pairs_freely(&self) -> bool {
        !matches!(self.layout, FolderLayout::Pairs(_))
    }

    /// Returns the name of a pair.
    pub fn pair_name(&self, [view1, view2]: [usize; 2]) -> String {
        match &self.layout {
            FolderLayout::Views(_) | FolderLayout::Sequences(_) => {
                format!("{} and {}", self.names[view1], self.names[view2])
            }
            FolderLayout::Pairs(pairs) => pairs[view1 / 2].name.clone(),
        }
    }

    /// Returns the path of the image or the sequence of a view.
    ///
    /// # Panics
    /// When the view does not exist.
    pub fn image(&self, view: usize) -> &Path {
        &self.images[view]
    }

    /// Returns the views of two files or folders, by their names, if they form a pair in this order.
    pub fn views_of(&self, files: [&Path; 2]) -> Option<[usize; 2]> {
        let view = |file: &Path| self.images.iter().position(|image| image.file_name() == file.file_name());
        let [first, second] = [view(files[0])?, view(files[1])?];
        let is_pair = self.pairs_freely() || first % 2 == 0 && second == first + 1;
        (is_pair && first != second).then_some([first, second])
    }

    /// Reads the ground truth of a pair.
    ///
    /// # Panics
    /// When a view does not exist.
    pub fn truth(&self, pair: [usize; 2]) -> Result<GroundTruth, TruthError> {
        match &self.layout {
            FolderLayout::Views(set) => GroundTruth::of_views(set, pair),
            FolderLayout::Pairs(pairs) => GroundTruth::of_pair(&pairs[pair[0] / 2]),
            FolderLayout::Sequences(rig) => GroundTruth::of_cameras(rig, pair),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ground_truth::TruthOrigin;
    use super::*;
    use crate::geometry::{PointPair, symmetric_epipolar_distance};

    fn write(folder: &tempfile::TempDir, files: &[(&str, &str)]) {
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
    }

    /// Creates three views, each one step to the right of the previous one.
    fn views() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        write(&folder, &[("set.nview-corners", "0 0 0\n1 * 1\n")]);
        for view in 0..3 {
            let camera = format!("1 0 0 -{view}\n0 1 0 0\n0 0 1 0\n");
            let corners = format!("{} 20\n{} 40\n", 10 - view, 30 - 2 * view);
            for (end, text) in [("P", &camera[..]), ("corners", &corners), ("pgm", "")] {
                write(&folder, &[(&format!("set.{view:03}.{end}"), text)]);
            }
        }
        folder
    }

    #[test]
    fn any_two_views_of_a_sequence_are_a_pair() {
        let folder = views();
        let set = TruthFolder::open(folder.path()).unwrap();
        assert_eq!(set.names(), ["set.000", "set.001", "set.002"]);
        let truth = set.truth([0, 2]).unwrap();
        assert_eq!((&truth.name[..], truth.origin), ("0-2", TruthOrigin::Cameras));
        assert_eq!(
            truth.matches,
            [PointPair::new(10.0, 20.0, 8.0, 20.0), PointPair::new(30.0, 40.0, 26.0, 40.0)]
        );
        for pair in &truth.matches {
            assert!(symmetric_epipolar_distance(&truth.fundamental, pair) < 1e-9);
        }
        assert!(set.image(2).ends_with("set.002.pgm"));
    }

    #[test]
    fn in_a_folder_of_pairs_each_image_has_its_partner() {
        let folder = tempfile::tempdir().unwrap();
        // Rows of a sideways motion at several depths, not on a plane.
        let depth = |k: usize| 5 + (k * k) % 7;
        let row = |k: usize| format!("{} {} {} {}", 13 * k, (29 * k) % 50, 13 * k + depth(k), (29 * k) % 50);
        let rows = (0..9).map(row).collect::<Vec<_>>().join("\n");
        write(&folder, &[("b.txt", &rows), ("bA.png", ""), ("bB.png", ""), ("c.txt", "1 2 3 4\n")]);
        write(&folder, &[("cA.png", ""), ("cB.png", "")]);
        let set = TruthFolder::open(folder.path()).unwrap();
        assert_eq!(set.names(), ["bA", "bB", "cA", "cB"]);
        assert_eq!(set.pair_name([2, 3]), "c");
        let views = |files: [&str; 2]| set.views_of(files.map(Path::new));
        assert_eq!(
            (views(["bA.png", "bB.png"]), views(["x/cA.png", "x/cB.png"])),
            (Some([0, 1]), Some([2, 3]))
        );
        assert_eq!(
            [views(["bB.png", "bA.png"]), views(["bA.png", "cB.png"]), views(["bA.png", "d.png"])],
            [None; 3]
        );
        let truth = set.truth([0, 1]).unwrap();
        assert_eq!((truth.matches.len(), truth.origin), (9, TruthOrigin::Matches));
        let error = set.truth([2, 3]).unwrap_err().to_string();
        assert!(error.contains("c has no true geometry: the eight-point algorithm needs"), "{error}");
    }

    #[test]
    fn a_geometry_needs_no_matches() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder, &[("bA.png", ""), ("bB.png", ""), ("b_F.txt", "0 0 0\n0 0 -1\n0 1 0\n")]);
        write(&folder, &[("cA.png", ""), ("c_F.txt", ""), ("aA.png", ""), ("aB.png", "")]);
        let set = TruthFolder::open(folder.path()).unwrap();
        assert_eq!(set.names(), ["bA", "bB"], "c has one image, and nothing is known about a");
        let truth = set.truth([0, 1]).unwrap();
        assert_eq!((truth.matches.len(), truth.origin), (0, TruthOrigin::File));
    }

    #[test]
    fn a_geometry_beside_the_matches_is_the_true_one_unless_it_is_another_pairs() {
        let folder = tempfile::tempdir().unwrap();
        // Two matches are too few for an F of their own. This F maps rows to rows.
        write(&folder, &[("a.txt", "10 20 40 20\n300 200 310 200\n"), ("aA.png", ""), ("aB.png", "")]);
        write(&folder, &[("a_F.txt", "0 0 0\n0 0 -1\n0 1 0\n")]);
        let set = TruthFolder::open(folder.path()).unwrap();
        let truth = set.truth([0, 1]).unwrap();
        assert_eq!((truth.matches.len(), truth.origin), (2, TruthOrigin::File));
        assert!(symmetric_epipolar_distance(&truth.fundamental, &truth.matches[1]) < 1e-9);
        // This F maps columns to columns, which contradicts the matches.
        write(&folder, &[("a_F.txt", "0 0 -1\n0 0 0\n1 0 0\n")]);
        let error = set.truth([0, 1]).unwrap_err().to_string();
        assert!(
            error.contains("a_F.txt does not fit the matches in a.txt") && error.contains("30 px"),
            "{error}"
        );
        write(&folder, &[("a_F.txt", "nothing\n")]);
        assert!(set.truth([0, 1]).unwrap_err().to_string().contains("a_F.txt"));
    }

    #[test]
    fn other_folders_are_refused_with_what_was_expected() {
        let folder = tempfile::tempdir().unwrap();
        let problem = |folder: &tempfile::TempDir| TruthFolder::open(folder.path()).unwrap_err().to_string();
        assert!(problem(&folder).contains("no image pairs with ground truth"));
        write(&folder, &[("a.txt", ""), ("aA.png", "")]);
        assert!(problem(&folder).contains("the image aB is missing"));
        let folder = views();
        std::fs::remove_file(folder.path().join("set.001.P")).unwrap();
        assert!(problem(&folder).contains("set.001.P: there is no such file"));
        std::fs::write(folder.path().join("set.nview-corners"), "0\n1\n").unwrap();
        assert!(problem(&folder).contains("no tracks over two or more views"));
        assert!(TruthFolder::open(Path::new("no/such")).unwrap_err().to_string().contains("no such"));
    }
}
