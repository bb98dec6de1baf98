//! Folders of image pairs with true matches: `NAMEA.*`, `NAMEB.*` and `NAME.txt` with rows
//! `x1 y1 x2 y2`. A known F is in `NAME_F.txt`, with or without matches.

use std::path::{Path, PathBuf};

use super::read::{ReadError, has_extension, has_image_extension, read_folder};

/// Files of one pair.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairFiles {
    /// Common part of the file names.
    pub name: String,
    /// Paths of both images.
    pub images: [PathBuf; 2],
    /// Path of the true matches; `None` if only F is known.
    pub matches: Option<PathBuf>,
    /// Path of the true F, if there is one.
    pub fundamental: Option<PathBuf>,
}

/// Finds all pairs of a folder with true matches, sorted by name; at least one. Text files without an image are
/// skipped.
pub fn pair_folder(folder: &Path) -> Result<Vec<PairFiles>, ReadError> {
    let mut pairs = find_pairs(folder)?;
    pairs.retain(|pair| pair.matches.is_some());
    if pairs.is_empty() {
        let problem = "no pairs found. A pair has the images NAMEA.* and NAMEB.*, and the matches NAME.txt";
        return Err(ReadError::content(folder, problem));
    }
    Ok(pairs)
}

/// Finds pairs with true matches or a true F, sorted by name, possibly none.
pub(super) fn find_pairs(folder: &Path) -> Result<Vec<PairFiles>, ReadError> {
    let entries = read_folder(folder)?;
    let mut pairs = Vec::new();
    for matches in &entries {
        let Some(name) = matches.file_stem().and_then(|s| s.to_str()) else { continue };
        if !is_text(matches) {
            continue;
        }
        let [a, b] = ["A", "B"].map(|side| images_named(&entries, &format!("{name}{side}")));
        match (&a[..], &b[..]) {
            ([], []) => {}
            ([a], [b]) => pairs.push(PairFiles {
                name: name.to_owned(),
                images: [(*a).clone(), (*b).clone()],
                matches: Some(matches.clone()),
                fundamental: fundamental_of(&entries, name),
            }),
            ([_, _, ..], _) | (_, [_, _, ..]) => {
                let problem = format!("there is more than one image {name}A or {name}B");
                return Err(ReadError::content(folder, problem));
            }
            (found, _) => {
                let side = if found.is_empty() { "A" } else { "B" };
                let problem = format!("the image {name}{side} is missing for {name}.txt");
                return Err(ReadError::content(folder, problem));
            }
        }
    }
    pairs.extend(pairs_without_matches(&entries, &pairs));
    pairs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(pairs)
}

/// Returns the pairs with `NAME_F.txt` that are not among those with matches.
fn pairs_without_matches(entries: &[PathBuf], with: &[PairFiles]) -> Vec<PairFiles> {
    let named = entries.iter().filter_map(|path| path.file_stem()?.to_str()?.strip_suffix("_F"));
    let mut names: Vec<&str> = named.filter(|name| with.iter().all(|pair| pair.name != *name)).collect();
    names.dedup();
    let pairs = names.into_iter().filter_map(|name| {
        let [a, b] = ["A", "B"].map(|side| images_named(entries, &format!("{name}{side}")));
        let ([a], [b]) = (&a[..], &b[..]) else { return None };
        Some(PairFiles {
            name: name.to_owned(),
            images: [(*a).clone(), (*b).clone()],
            matches: None,
            fundamental: Some(fundamental_of(entries, name)?),
        })
    });
    pairs.collect()
}

/// Returns `NAME_F.txt`, unless that file holds the matches of a pair named `NAME_F`.
fn fundamental_of(entries: &[PathBuf], name: &str) -> Option<PathBuf> {
    let name = format!("{name}_F");
    if ["A", "B"].iter().any(|side| !images_named(entries, &format!("{name}{side}")).is_empty()) {
        return None;
    }
    let is_named = |path: &Path| path.file_stem().and_then(|s| s.to_str()) == Some(&name);
    entries.iter().find(|path| is_named(path) && is_text(path)).cloned()
}

fn is_text(path: &Path) -> bool {
    has_extension(path, &["txt"]) && path.is_file()
}

fn images_named<'a>(entries: &'a [PathBuf], stem: &str) -> Vec<&'a PathBuf> {
    entries.iter().filter(|p| p.file_stem().is_some_and(|s| s == stem) && has_image_extension(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        folder
    }

    #[test]
    fn finds_pairs_by_name_and_passes_over_notes() {
        let folder = folder_with(&[
            "towerA.png",
            "towerB.jpg",
            "tower.txt",
            "aA.pgm",
            "aB.pgm",
            "a.txt",
            "a_F.txt",
            "README.txt",
        ]);
        let pairs = pair_folder(folder.path()).unwrap();
        assert_eq!(pairs.iter().map(|p| &p.name[..]).collect::<Vec<_>>(), ["a", "tower"]);
        assert!(pairs[1].images[1].ends_with("towerB.jpg"));
        assert!(pairs[0].fundamental.as_ref().is_some_and(|path| path.ends_with("a_F.txt")));
        assert_eq!(pairs[1].fundamental, None);
        let folder = folder_with(&["aA.png", "aB.png", "a.txt", "a_FA.png", "a_FB.png", "a_F.txt"]);
        let pairs = pair_folder(folder.path()).unwrap();
        assert_eq!(pairs.iter().map(|p| &p.name[..]).collect::<Vec<_>>(), ["a", "a_F"]);
        assert!(pairs.iter().all(|pair| pair.fundamental.is_none()), "matches are no matrix");
    }

    #[test]
    fn says_what_is_missing_or_double() {
        for (names, expected) in [
            (&["towerA.png", "tower.txt"][..], "towerB is missing"),
            (&["towerB.png", "tower.txt"], "towerA is missing"),
            (&["towerA.png", "towerA.jpg", "towerB.png", "tower.txt"], "more than one"),
            (&["towerA.png", "towerB.png"], "no pairs found"),
            (&[], "no pairs found"),
        ] {
            let folder = folder_with(names);
            let message = pair_folder(folder.path()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        assert!(pair_folder(Path::new("no/such/folder")).unwrap_err().to_string().contains("no such"));
    }
}
