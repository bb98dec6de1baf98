//! Recognises files to import by their names.

use std::path::{Path, PathBuf};

use super::geometry_file::Format;
use super::read::has_extension;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ImportSource {
    /// A file of any format.
    File(PathBuf),
    /// The cameras of the two images, 3×4 each.
    Cameras([PathBuf; 2]),
    /// A camera without the camera of the other image.
    LoneCamera(PathBuf),
}

impl ImportSource {
    /// Returns the name of the files for messages.
    pub fn name(&self) -> String {
        let name = |path: &PathBuf| {
            path.file_name()
                .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
        };
        match self {
            Self::File(path) | Self::LoneCamera(path) => name(path),
            Self::Cameras([left, right]) => format!("{} and {}", name(left), name(right)),
        }
    }
}

/// Returns whether a file is imported rather than opened as an image. Sessions have such names,
/// too.
pub fn is_importable(path: &Path) -> bool {
    // The import of MATLAB's own files tells how MATLAB saves them for others.
    const OTHERS: [&str; 8] = ["csv", "tsv", "dat", "npy", "xml", "toml", "conf", "mat"];
    Format::of_path(path).is_some() || is_camera(path) || is_archive(path) || has_extension(path, &OTHERS)
}

/// Returns whether a file is a NumPy archive, by its name.
pub fn is_archive(path: &Path) -> bool {
    has_extension(path, &["npz"])
}

fn is_camera(path: &Path) -> bool {
    has_extension(path, &["p"])
}

/// Groups files into imports. Two cameras in a row belong together.
pub fn sources(paths: Vec<PathBuf>) -> Vec<ImportSource> {
    let mut sources = Vec::new();
    for path in paths {
        if !is_camera(&path) {
            sources.push(ImportSource::File(path));
        } else if let Some(ImportSource::LoneCamera(left)) = sources.last() {
            let both = ImportSource::Cameras([left.clone(), path]);
            sources.pop();
            sources.push(both);
        } else {
            sources.push(ImportSource::LoneCamera(path));
        }
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_are_recognised_by_name() {
        for name in ["F.txt", "m.CSV", "a.yml", "a.yaml", "a.xml", "a.m", "a.json", "house.000.P", "m.npz"] {
            assert!(is_importable(Path::new(name)), "{name}");
        }
        for name in ["a.png", "a.pgm", "folder", ".json", "a.ppm"] {
            assert!(!is_importable(Path::new(name)), "{name}");
        }
    }

    #[test]
    fn two_cameras_in_a_row_belong_together() {
        let paths = ["a.P", "b.P", "m.csv", "c.P"].map(PathBuf::from).to_vec();
        let found = sources(paths);
        assert_eq!(
            found,
            [
                ImportSource::Cameras(["a.P".into(), "b.P".into()]),
                ImportSource::File("m.csv".into()),
                ImportSource::LoneCamera("c.P".into())
            ]
        );
        assert_eq!(found[0].name(), "a.P and b.P");
    }
}
