//! A search of another program, handed over to the window as a session.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::app::model::session::Work;
use crate::camera::PicturesOf;
use crate::image::Picture;
use crate::io::{
    ImageReference, ImageSource, PictureError, PictureFormat, ReadError, SessionFile, WriteError,
    encode_picture, relative, sha256_of,
};

/// Reason why a search cannot be handed over, one sentence.
#[derive(Debug, Error)]
pub enum HandOverError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error("cannot write {0}: {1}")]
    File(PathBuf, std::io::Error),
}

/// Writes work as a session into a folder, beside those of its pictures that are not files. Returns the session.
pub fn hand_over(pictures: [&Picture; 2], work: Work, folder: &Path) -> Result<PathBuf, HandOverError> {
    let path = folder.join("session.json");
    let reference = |k: usize| -> Result<ImageReference, HandOverError> {
        let picture = pictures[k];
        let file = if let Some(file) = &picture.path {
            file.clone()
        } else {
            let file = folder.join(["left.png", "right.png"][k]);
            let png = encode_picture(&picture.pixels, PictureFormat::Png)?;
            std::fs::write(&file, png).map_err(|error| HandOverError::File(file.clone(), error))?;
            file
        };
        let source = ImageSource::File { sha256: sha256_of(&file)?, path: relative(&file, &path) };
        Ok(ImageReference { source, frame: picture.frame() })
    };
    let images = [reference(0)?, reference(1)?];
    let session =
        SessionFile { images, fundamental: None, pictures: PicturesOf::Untold, trust: None, content: work };
    session.write_private(&path)?;
    Ok(path)
}
