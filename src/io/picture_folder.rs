//! A folder whose images are offered as pairs: with known geometry, or just two images or more.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::read::{has_extension, has_image_extension};
use super::truth_folder::TruthFolder;

/// A folder of images, with or without ground truth.
#[derive(Debug, Clone)]
pub struct PictureFolder {
    path: PathBuf,
    images: Vec<PathBuf>,
    names: Vec<String>,
    /// Whether only neighbours are a pair. Without ground truth, all images are then named `NAMEA` or
    /// `NAMEB`.
    is_paired: bool,
    truth: Option<TruthFolder>,
}

impl From<TruthFolder> for PictureFolder {
    fn from(truth: TruthFolder) -> Self {
        Self {
            path: truth.path().to_owned(),
            images: (0..truth.names().len()).map(|view| truth.image(view).to_owned()).collect(),
            names: truth.names().to_vec(),
            is_paired: !truth.pairs_freely(),
            truth: Some(truth),
        }
    }
}

/// Folder of the pictures in the projects of most programs.
const PICTURES: &str = "images";

impl PictureFolder {
    /// Opens a folder, or the folder `images` in it if it has no images itself. The error is text for the
    /// middle of a sentence.
    pub fn open(path: &Path) -> Result<Self, String> {
        let problem = match TruthFolder::open(path) {
            Ok(truth) => return Ok(truth.into()),
            Err(problem) => problem.to_string(),
        };
        let entries: Vec<PathBuf> = match std::fs::read_dir(path) {
            Ok(entries) => entries.filter_map(Result::ok).map(|entry| entry.path()).collect(),
            Err(_) => return Err(problem),
        };
        if claims_truth(&entries) {
            return Err(problem);
        }
        let folder = Self::of_images(path, entries);
        match folder.images.len() {
            0 if path.join(PICTURES).is_dir() => Self::open(&path.join(PICTURES)),
            0 => Err(format!("{} has no images in it", path.display())),
            1 => Err(format!("{} has only one image in it, and it takes two", path.display())),
            _ => Ok(folder),
        }
    }

    /// Takes the images of a folder about which nothing is known.
    fn of_images(path: &Path, entries: Vec<PathBuf>) -> Self {
        let mut images: Vec<PathBuf> = entries.into_iter().filter(|path| is_image(path)).collect();
        images.sort_by_cached_key(|path| natural_key(&file_name(path)));
        let stem = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let stems: HashSet<String> = images.iter().map(stem).collect();
        // The ending belongs to the name if only the ending tells two images apart.
        let names = if stems.len() == images.len() {
            images.iter().map(stem).collect()
        } else {
            images.iter().map(|path| file_name(path)).collect()
        };
        let is_paired = images.len().is_multiple_of(2)
            && images.chunks(2).all(|pair| {
                match (stem(&pair[0]).strip_suffix('A'), stem(&pair[1]).strip_suffix('B')) {
                    (Some(left), Some(right)) => left == right,
                    _ => false,
                }
            });
        Self { path: path.to_owned(), images, names, is_paired, truth: None }
    }

    /// Returns the folder with ground truth, if there is any.
    pub fn known(&self) -> Option<&TruthFolder> {
        self.truth.as_ref()
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the names of the views: their image files, usually without the ending.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the numbers of the two views with these names, if they are a pair.
    pub fn pair_named(&self, names: &[String; 2]) -> Option<[usize; 2]> {
        let view = |name: &String| self.names.iter().position(|other| other == name);
        Some([view(&names[0])?, view(&names[1])?]).filter(|pair| self.is_pair(*pair))
    }

    /// Returns whether any two views are a pair.
    pub fn pairs_freely(&self) -> bool {
        !self.is_paired
    }

    /// Returns whether two views are a pair.
    pub fn is_pair(&self, [first, second]: [usize; 2]) -> bool {
        let fits =
            if self.is_paired { first.is_multiple_of(2) && second == first + 1 } else { first != second };
        fits && first.max(second) < self.images.len()
    }

    /// Returns the next or the previous pair: both views move by one if any two are a pair, and else
    /// by two.
    pub fn neighbour(&self, pair: [usize; 2], forward: bool) -> Option<[usize; 2]> {
        let step = if self.is_paired { 2 } else { 1 };
        let moved = |view: usize| if forward { view.checked_add(step) } else { view.checked_sub(step) };
        Some([moved(pair[0])?, moved(pair[1])?]).filter(|pair| self.is_pair(*pair))
    }

    pub fn pair_name(&self, pair: [usize; 2]) -> String {
        let names = || format!("{} and {}", self.names[pair[0]], self.names[pair[1]]);
        self.truth.as_ref().map_or_else(names, |truth| truth.pair_name(pair))
    }

    pub fn image(&self, view: usize) -> &Path {
        &self.images[view]
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn is_image(path: &Path) -> bool {
    let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    has_image_extension(path) && !hidden && path.is_file()
}

/// Returns whether a folder seems to have ground truth. Its errors should be reported then.
fn claims_truth(entries: &[PathBuf]) -> bool {
    let stems: HashSet<&OsStr> =
        entries.iter().filter(|path| is_image(path)).filter_map(|path| path.file_stem()).collect();
    entries.iter().any(|path| {
        let stem = path.file_stem().unwrap_or_default();
        let is_half = |side: &str| {
            let mut name = stem.to_owned();
            name.push(side);
            stems.contains(name.as_os_str())
        };
        has_extension(path, &["nview-corners"])
            || has_extension(path, &["txt"]) && (is_half("A") || is_half("B"))
    })
}

/// Returns a sort key that orders names as people do: `shot2` before `shot10`.
fn natural_key(name: &str) -> Vec<(u64, String)> {
    let mut parts = Vec::new();
    let mut rest = name.to_lowercase();
    while !rest.is_empty() {
        let words = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let digits = rest[words..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |end| words + end);
        // Longer numbers are not counters.
        let number = rest[words..digits].parse().unwrap_or(0);
        parts.push((0, rest[..words].to_owned()));
        parts.push((number, rest[words..digits].to_owned()));
        rest = rest.split_off(digits);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        folder
    }

    #[test]
    fn images_are_in_natural_order() {
        let files = folder(&["b10.png", "b9.JPG", "a.png", "a.jpg", "notes.txt", ".hidden.png", "b9x.png"]);
        let folder = PictureFolder::open(files.path()).unwrap();
        assert!(folder.known().is_none() && folder.pairs_freely());
        assert_eq!(folder.names(), ["a.jpg", "a.png", "b9.JPG", "b9x.png", "b10.png"]);
        assert_eq!(folder.neighbour([0, 2], true), Some([1, 3]));
        assert_eq!(folder.neighbour([0, 2], false), None);
        assert_eq!(folder.neighbour([1, 4], true), None);
        assert_eq!(folder.pair_name([0, 1]), "a.jpg and a.png");
    }

    #[test]
    fn images_named_in_pairs_are_stepped_through_in_pairs() {
        let files = folder(&["0711A.png", "0711B.png", "0713A.png", "0713B.png"]);
        let pairs = PictureFolder::open(files.path()).unwrap();
        assert!(pairs.known().is_none() && !pairs.pairs_freely());
        assert_eq!(pairs.neighbour([0, 1], true), Some([2, 3]));
        assert_eq!(pairs.neighbour([2, 3], false), Some([0, 1]));
        assert!(!pairs.is_pair([1, 2]) && !pairs.is_pair([4, 5]) && pairs.neighbour([2, 3], true).is_none());
        let files = folder(&["0711A.png", "0711B.png", "0713A.png", "0714B.png"]);
        assert!(PictureFolder::open(files.path()).unwrap().pairs_freely(), "not all have a partner");
    }

    #[test]
    fn the_pictures_of_a_project_are_in_its_folder_of_images() {
        let files = folder(&["images/b.png", "images/a.png", "database.db"]);
        assert_eq!(PictureFolder::open(files.path()).unwrap().names, ["a", "b"]);
    }

    #[test]
    fn errors_name_too_few_images_or_broken_truth() {
        for (names, words) in [
            (&["notes.txt"][..], "has no images in it"),
            (&["a.png"], "only one image"),
            (&["houseA.png", "x.png", "house.txt"], "houseB is missing"),
        ] {
            let files = folder(names);
            let problem = PictureFolder::open(files.path()).unwrap_err();
            assert!(problem.contains(words), "{problem}");
        }
        assert!(PictureFolder::open(Path::new("/nowhere/at/all")).unwrap_err().contains("/nowhere/at/all"));
    }
}
