//! Detection of two paths to one file: through links, hard links and folders with two names.

use std::ffi::OsString;
use std::path::Path;

use super::output::{WriteError, folder_of};

/// Identity of the file at a path.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// File that exists.
    Old(Place),
    /// File that does not exist yet, by its folder and name.
    New(Place, OsString),
}

#[cfg(unix)]
type Place = (u64, u64);
#[cfg(not(unix))]
type Place = std::path::PathBuf;

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere it may fail")]
fn place(_path: &Path, found: &std::fs::Metadata) -> Option<Place> {
    use std::os::unix::fs::MetadataExt;
    Some((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn place(path: &Path, _found: &std::fs::Metadata) -> Option<Place> {
    path.canonicalize().ok()
}

/// Returns the identity of a path. `None` for anything that cannot be overwritten: devices, pipes,
/// and paths without a folder.
fn identity(path: &Path) -> Option<Identity> {
    match path.metadata() {
        Ok(found) if found.is_file() => place(path, &found).map(Identity::Old),
        Ok(_) => None,
        Err(_) => {
            let folder = folder_of(path);
            let found = folder.metadata().ok()?;
            Some(Identity::New(place(folder, &found)?, path.file_name()?.to_owned()))
        }
    }
}

/// Refuses outputs that would overwrite an input or one another.
pub fn refuse_clashes<P: AsRef<Path>>(outputs: &[P], inputs: &[&Path]) -> Result<(), WriteError> {
    let inputs: Vec<Identity> = inputs.iter().filter_map(|path| identity(path)).collect();
    let mut seen = Vec::new();
    for path in outputs.iter().map(AsRef::as_ref) {
        let Some(identity) = identity(path) else { continue };
        if inputs.contains(&identity) {
            let reason = "it is one of the files that are read, which would be lost. Choose another name";
            return Err(WriteError::new(path, reason));
        }
        if seen.contains(&identity) {
            let reason = "another result goes to the same file. Choose another name for one of them";
            return Err(WriteError::new(path, reason));
        }
        seen.push(identity);
    }
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::write(file("image.png"), "image").unwrap();
        std::fs::hard_link(file("image.png"), file("hard.png")).unwrap();
        std::os::unix::fs::symlink("image.png", file("soft.png")).unwrap();
        std::os::unix::fs::symlink(".", file("here")).unwrap();
        let input = file("image.png");
        for name in ["image.png", "hard.png", "soft.png", "here/image.png", "here/here/soft.png"] {
            let message = refuse_clashes(&[&file(name)], &[&input]).unwrap_err().to_string();
            assert!(message.contains("it is one of the files that are read"), "{message}");
        }
        let clash = refuse_clashes(&[&file("new.json"), &file("here/new.json")], &[&input]).unwrap_err();
        assert!(clash.to_string().contains("another result goes to the same file"), "{clash}");
        refuse_clashes(&[&file("new.json"), &file("other.json")], &[&input]).unwrap();
        let null = Path::new("/dev/null");
        refuse_clashes(&[null, null], &[null]).unwrap();
    }
}
