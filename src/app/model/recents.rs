//! Recently opened files, kept between runs.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Maximum number of entries.
const KEPT: usize = 8;

/// Entries, latest first. Each is two images, a folder or a session.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Recents(Vec<Vec<PathBuf>>);

impl Recents {
    /// Adds an entry in front.
    pub fn note(&mut self, paths: &[&Path]) {
        // The next run of the program may start in another folder.
        let paths: Vec<_> = paths
            .iter()
            .map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()))
            .collect();
        self.0.retain(|other| *other != paths && !other.is_empty());
        self.0.insert(0, paths);
        self.0.truncate(KEPT);
    }

    /// Returns the entries, latest first.
    pub fn list(&self) -> impl Iterator<Item = &[PathBuf]> {
        self.0.iter().map(Vec::as_slice).filter(|paths| !paths.is_empty()).take(KEPT)
    }
}

/// Returns the name of an entry: its files, and their folder.
pub fn recent_name(paths: &[PathBuf]) -> String {
    let name =
        |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let names: Vec<String> = paths.iter().map(|path| name(path)).collect();
    let folder = paths.first().and_then(|path| path.parent()).map_or_else(String::new, name);
    let names = names.join(" and ");
    if folder.is_empty() { names } else { format!("{names}, in {folder}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_comes_first_and_once() {
        let mut recents = Recents::default();
        for name in ["/a", "/b", "/a", "/c"] {
            recents.note(&[Path::new(name)]);
        }
        let names: Vec<_> = recents.list().map(recent_name).collect();
        assert_eq!(names, ["c", "a", "b"]);
        for number in 0..20 {
            recents.note(&[Path::new(&format!("/x/l{number}.png")), Path::new("/x/r.png")]);
        }
        assert_eq!(recents.list().count(), KEPT);
        assert_eq!(recents.list().next().map(recent_name), Some("l19.png and r.png, in x".to_owned()));
        let text = serde_json::to_string(&recents).unwrap();
        assert_eq!(serde_json::from_str::<Recents>(&text).unwrap(), recents);
    }
}
