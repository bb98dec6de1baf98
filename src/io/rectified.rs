//! Files of a rectified pair in a folder.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use image::DynamicImage;
use serde::Serialize;
use thiserror::Error;

use super::geometry_file::TrustNote;
use super::identity::refuse_clashes;
use super::npy::header;
use super::output::{OutputFile, WriteError};
use super::picture_file::{PictureError, PictureFormat, encode_picture};
use crate::camera::PicturesOf;
use crate::foreign::{reason, shown_path};
use crate::geometry::{FundamentalMatrix, Point};
use crate::image::Picture;
use crate::presentation::pictures_in_words;
use crate::rectify::{Description, ImageMap, Rectification, side_by_side};

/// Options of the files written beside the two pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RectifiedOptions {
    /// Format of the pictures.
    pub format: PictureFormat,
    /// Rows between the guide lines of the picture of both; 0 draws none.
    pub guide_spacing: usize,
    /// Whether to write the original position of each rectified pixel, as `npy` arrays.
    pub maps: bool,
}

/// Reason why a rectified pair was not written. The message is shown to the user.
#[derive(Debug, Error)]
pub enum RectifiedError {
    /// The folder cannot be created.
    #[error("cannot make the folder {0}: {1}")]
    Folder(String, String),
    /// Another run writes into the folder.
    #[error(
        "another run of the program is writing into the folder {0}. Wait until it ends, or choose another folder"
    )]
    Busy(String),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A picture cannot be encoded.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Writing was cancelled.
    #[error("stopped; nothing was written")]
    Cancelled,
    /// The description cannot be encoded.
    #[error("the description cannot be encoded: {0}")]
    Encode(String),
}

/// Files of a rectified pair, found writable.
#[derive(Debug)]
pub struct RectifiedFiles {
    pictures: [OutputFile; 2],
    both: OutputFile,
    description: OutputFile,
    maps: Option<[OutputFile; 2]>,
    options: RectifiedOptions,
    trust: Option<TrustNote>,
    /// Locked folder. Two runs at once could leave the pictures of one run with the description of
    /// the other.
    _folder: Option<File>,
}

/// Description of the rectification with the verdict on its geometry.
#[derive(Serialize)]
struct Described<'a> {
    #[serde(flatten)]
    description: Description<'a>,
    /// The pictures that `fundamental` and the maps belong to, in words.
    coordinates: Vec<String>,
    #[serde(flatten)]
    pictures: &'a PicturesOf,
    #[serde(flatten)]
    trust: Option<&'a TrustNote>,
}

impl RectifiedFiles {
    /// Creates the folder if necessary and checks, before the work, that all files can be written:
    /// `left`, `right` and `side-by-side` with the extension of the format, `rectification.json`, and
    /// with [`RectifiedOptions::maps`] `left-map.npy` and `right-map.npy`.
    ///
    /// The folder is locked until the value is dropped, so another run cannot write into it.
    ///
    /// `inputs` are files that are still needed, such as the images; none of them is replaced.
    pub fn prepare(
        folder: &Path,
        options: RectifiedOptions,
        inputs: &[&Path],
    ) -> Result<Self, RectifiedError> {
        create_folder(folder)?;
        // Not every system opens folders, and not every file system has locks.
        let locked = File::open(folder).ok();
        if locked.as_ref().is_some_and(|folder| matches!(folder.try_lock(), Err(TryLockError::WouldBlock))) {
            return Err(RectifiedError::Busy(shown_path(folder)));
        }
        let file = |name: &str| OutputFile::prepare(&folder.join(name));
        let picture = |name: &str| file(&format!("{name}.{}", options.format.extension()));
        let files = Self {
            pictures: [picture("left")?, picture("right")?],
            both: picture("side-by-side")?,
            description: file("rectification.json")?,
            maps: if options.maps { Some([file("left-map.npy")?, file("right-map.npy")?]) } else { None },
            options,
            trust: None,
            _folder: locked,
        };
        refuse_clashes(&files.paths(), inputs)?;
        Ok(files)
    }

    /// Adds the verdict on the geometry to the description.
    #[must_use]
    pub fn with_trust(mut self, trust: Option<TrustNote>) -> Self {
        self.trust = trust;
        self
    }

    /// Writes all files; `rectified` are the drawn pictures. `F` and the maps of the rectification belong to
    /// `pictures`. `go_on` is called before each file
    /// with its index in [`RectifiedFiles::paths`]; returning `false` stops the writing.
    ///
    /// New files are complete before an older pair is replaced. `rectification.json` is removed
    /// first and replaced last, so it always belongs to the pictures beside it.
    pub fn write(
        &self,
        rectification: &Rectification,
        (fundamental, pictures): (&FundamentalMatrix, &PicturesOf),
        originals: [&Picture; 2],
        rectified: [&DynamicImage; 2],
        go_on: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), RectifiedError> {
        let mut number = 0;
        let mut next = || {
            number += 1;
            if go_on(number - 1) { Ok(()) } else { Err(RectifiedError::Cancelled) }
        };
        let mut staged = Vec::new();
        for (file, picture) in self.pictures.iter().zip(rectified) {
            next()?;
            staged.push(file.stage(&encode_picture(picture, self.options.format)?)?);
        }
        next()?;
        let both = side_by_side(rectified, self.options.guide_spacing).into();
        staged.push(self.both.stage(&encode_picture(&both, self.options.format)?)?);
        drop(both);
        for (file, map) in self.maps.iter().flatten().zip(&rectification.maps) {
            next()?;
            staged.push(file.stage(&map_array(map, rectification))?);
        }
        next()?;
        let description = rectification.description(fundamental, originals.map(Picture::frame));
        let coordinates = pictures_in_words(pictures, 0.0);
        let described = Described { description, coordinates, pictures, trust: self.trust.as_ref() };
        let mut text =
            serde_json::to_string_pretty(&described).map_err(|e| RectifiedError::Encode(e.to_string()))?;
        text.push('\n');
        staged.push(self.description.stage(text.as_bytes())?);
        match std::fs::remove_file(self.description.path()) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(WriteError::new(self.description.path(), reason(&e)).into());
            }
            _ => {}
        }
        // The description must come last.
        for file in staged {
            file.put()?;
        }
        Ok(())
    }

    /// Returns the paths of all files, in the order of writing.
    pub fn paths(&self) -> Vec<PathBuf> {
        let maps = self.maps.iter().flatten();
        self.pictures
            .iter()
            .chain([&self.both])
            .chain(maps)
            .chain([&self.description])
            .map(|f| f.path().to_owned())
            .collect()
    }
}

/// Creates a folder unless it exists.
pub(super) fn create_folder(folder: &Path) -> Result<(), RectifiedError> {
    std::fs::create_dir_all(folder).map_err(|e| {
        let reason = if folder.exists() { "there is a file of that name".into() } else { reason(&e) };
        RectifiedError::Folder(shown_path(folder), reason)
    })
}

/// Returns an array for `cv2.remap`, in the `NumPy` format: rows × columns × (x, y) of `f32`. Entries
/// are the original positions of the rectified pixels, px; (−1, −1) for a pixel outside the original.
fn map_array(map: &ImageMap, rectification: &Rectification) -> Vec<u8> {
    let size = rectification.size;
    let mut content = header("<f4", &[size.height, size.width, 2]);
    content.reserve(size.width * size.height * 8);
    for y in 0..size.height {
        for x in 0..size.width {
            let position = map.original_from_rectified(Point::new(x as f64, y as f64));
            let position = position.map_or([-1.0, -1.0], |p| [p.x as f32, p.y as f32]);
            content.extend(position.into_iter().flat_map(f32::to_le_bytes));
        }
    }
    content
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn two_runs_into_one_folder_are_not_mixed() {
        let folder = tempfile::tempdir().unwrap();
        let options = RectifiedOptions { format: PictureFormat::Png, guide_spacing: 0, maps: false };
        let first = RectifiedFiles::prepare(folder.path(), options, &[]).unwrap();
        let message = RectifiedFiles::prepare(folder.path(), options, &[]).unwrap_err().to_string();
        assert!(message.starts_with("another run of the program is writing into the folder"), "{message}");
        drop(first);
        RectifiedFiles::prepare(folder.path(), options, &[]).unwrap();
    }
}
