//! Folders of numbered frames.

use std::path::{Path, PathBuf};

use super::super::ReadError;
use super::super::read::{has_image_extension, read_folder};
use super::{Gathered, MOST_FRAMES, SequenceError, SequenceFile};
use crate::cancel::CancelFlag;
use crate::foreign::shown_path;
use crate::image::Picture;

/// Maximum number of missing frames named in a note.
const NAMED: usize = 5;

pub(super) fn read(
    path: &Path,
    cancel: &CancelFlag,
    each: &dyn Fn(usize),
) -> Result<SequenceFile, SequenceError> {
    let frames = numbered(path)?;
    let Some((first, _)) = frames.first() else {
        let problem = "there are no numbered pictures in it. Number the frames, such as frame0001.png";
        return Err(ReadError::content(path, problem).into());
    };
    let last = frames.last().map_or(*first, |(number, _)| *number);
    if frames.len() > MOST_FRAMES {
        return Err(SequenceError::TooLong(shown_path(path)));
    }
    // Frames may be numbered in steps of ten, for example.
    let step = frames.windows(2).map(|two| two[1].0 - two[0].0).min().unwrap_or(1).max(1);
    if (last - first) / step >= MOST_FRAMES as u64 {
        let problem =
            "more than half of the numbered frames are missing, or the frames belong to several sequences";
        return Err(ReadError::content(path, problem).into());
    }
    let mut gathered = Gathered::new(path, cancel, each);
    let mut missing: Vec<u64> = Vec::new();
    let mut expected = *first;
    for (number, file) in &frames {
        while expected < *number {
            missing.push(expected);
            gathered.sequence.repeat_last();
            expected = expected.saturating_add(step);
        }
        gathered.push_picture(Picture::open(file)?)?;
        // A name may hold the largest number there is.
        expected = number.saturating_add(step);
    }
    if !missing.is_empty() {
        let named: Vec<String> = missing.iter().take(NAMED).map(ToString::to_string).collect();
        let more = missing.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        gathered.notes.push(format!(
            "frames are missing in {}: {}{more}. The frame before replaces each of them",
            shown_path(path),
            named.join(", ")
        ));
    }
    gathered.finish()
}

/// Returns the numbered pictures of a folder, sorted by number, of the most frequent name pattern.
pub(super) fn numbered(path: &Path) -> Result<Vec<(u64, PathBuf)>, ReadError> {
    let mut kinds: Vec<(String, Vec<(u64, PathBuf)>)> = Vec::new();
    for file in read_folder(path)?.into_iter().filter(|file| has_image_extension(file)) {
        let Some((kind, number)) = file.file_name().and_then(|name| number_of(&name.to_string_lossy()))
        else {
            continue;
        };
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, files)) => files.push((number, file)),
            None => kinds.push((kind, vec![(number, file)])),
        }
    }
    kinds.sort_by_key(|(_, files)| std::cmp::Reverse(files.len()));
    let mut frames = kinds.into_iter().next().map(|(_, files)| files).unwrap_or_default();
    frames.sort();
    if let Some(two) = frames.windows(2).find(|two| two[0].0 == two[1].0) {
        let names =
            [&two[0].1, &two[1].1].map(|file| shown_path(Path::new(file.file_name().unwrap_or_default())));
        let problem = format!("{} and {} have the same number", names[0], names[1]);
        return Err(ReadError::content(path, problem));
    }
    Ok(frames)
}

/// Splits a name into its pattern without the last number, and that number.
fn number_of(name: &str) -> Option<(String, u64)> {
    let stem_end = name.rfind('.').unwrap_or(name.len());
    let end = name[..stem_end].rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = name[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |k| k + name[k..].chars().next().map_or(1, char::len_utf8));
    let number = name[start..end].parse().ok()?;
    Some((format!("{}#{}", &name[..start], &name[end..]), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_last_ones_of_a_name() {
        assert_eq!(number_of("frame0012.png"), Some(("frame#.png".into(), 12)));
        assert_eq!(number_of("000.jpg"), Some(("#.jpg".into(), 0)));
        assert_eq!(number_of("ä7.png"), Some(("ä#.png".into(), 7)));
        assert_eq!(number_of("notes.txt"), None);
        assert_eq!(number_of("99999999999999999999999.png"), None);
    }
}
