//! Opens a session: finds its images, checks their hashes and reads them.

use std::path::Path;
use std::sync::Arc;

use super::opening::{LoadedPair, OpeningFailure, PairReading, calibrated, sample, sample_sequences};
use crate::app::model::album::ViewNames;
use crate::app::model::document::TruthSource;
use crate::app::model::open_pair::OpenFolder;
use crate::app::model::sample::SAMPLE_SEQUENCES;
use crate::app::model::session::{Lost, OpenSession, Relocation, Restored, Work};
use crate::app::model::truth::KnownTruth;
use crate::foreign::shown_path;
use crate::io::{ImageReference, ImageSource, Located, PictureFolder, SessionError, SessionFile, sha256_of};
use crate::synthetic::Sample;

pub fn open_session(session: OpenSession, reading: &mut PairReading) -> Result<LoadedPair, OpeningFailure> {
    let path = session.path.clone();
    let unchanged = |text: &str| {
        OpeningFailure::Text(format!(
            "The session could not be opened: {text}. Nothing was changed. Try another one."
        ))
    };
    let file = SessionFile::<Work>::read(&path).map_err(|error| match error {
        SessionError::Foreign { .. } => {
            OpeningFailure::NoSession { path: path.clone(), problem: error.to_string() }
        }
        _ => unchanged(&error.to_string()),
    })?;
    let samples = file.images.each_ref().map(sample_of);
    let mut pair = if let [Some(left), Some(right)] = samples {
        let known = Some(left).filter(|left| *left == right);
        match (known, known.and_then(Sample::from_name)) {
            (_, Some(known)) => sample(known),
            (Some(SAMPLE_SEQUENCES), _) => sample_sequences(reading)?,
            _ => return Err(unchanged("this version of the program does not have its built-in sample")),
        }
    } else {
        let mut found = [None, None];
        let mut lost = [None, None];
        for (k, image) in file.images.iter().enumerate() {
            match place(image, &session, k) {
                Some(Located::Same(path)) => found[k] = Some(path),
                Some(Located::Changed(path)) if session.accepts_changed => found[k] = Some(path),
                Some(Located::Changed(path)) => lost[k] = Some(Lost::Changed(path)),
                Some(Located::Missing(path)) => lost[k] = Some(Lost::Missing(path)),
                None => return Err(unchanged("only one of its images belongs to a built-in sample")),
            }
        }
        let [Some(left), Some(right)] = found else {
            return Err(OpeningFailure::Relocate(Box::new(Relocation { session, lost })));
        };
        super::opening::open_files([&left, &right], reading)?
    };
    let frames = pair.pictures.each_ref().map(|opened| opened.picture.frame());
    let mut notes = Vec::new();
    if frames != file.images.map(|image| image.frame) {
        notes.push(
            "The size of an image has changed since the session was saved. Check the points.".to_owned(),
        );
    }
    if let Some(cameras) = &file.content.cameras {
        pair.pictures = calibrated(pair.pictures, Some(cameras))?;
    }
    let frames = pair.pictures.each_ref().map(|opened| opened.picture.frame());
    let pairs = file.content.document.pairs.len();
    let mut work = file.content.made_valid(frames, &path);
    if work.document.pairs.len() < pairs {
        notes.push(format!(
            "The session has {pairs} point pairs. Only the first {} on the images are shown.",
            work.document.pairs.len()
        ));
    }
    if let Some(TruthSource::Folder { folder, views }) = &work.document.truth {
        match open_folder(folder, views).and_then(|folder| Ok((known(&folder)?, folder))) {
            Ok((known, folder)) => (pair.known, pair.folder) = (Some(known), Some(folder)),
            Err(problem) => {
                notes.push(format!("The ground truth of the session is left out: {problem}."));
                work.document.truth = None;
            }
        }
    }
    if let Some(album) = work.album.as_ref().filter(|_| pair.folder.is_none()) {
        match open_folder(album.folder(), &album.open) {
            Ok(folder) => (pair.known, pair.folder) = (known(&folder).ok(), Some(folder)),
            Err(problem) => notes.push(format!(
                "The other images of the session cannot be shown: {problem}. The work on them \
                 stays in the session."
            )),
        }
    }
    pair.uses_truth = work.document.truth.is_some();
    pair.restored = Some(Box::new(Restored { session, work, notes }));
    Ok(pair)
}

/// Returns the place of image `k`: the file given by the user, or else the one named by the
/// session.
fn place(image: &ImageReference, session: &OpenSession, k: usize) -> Option<Located> {
    let Some(given) = &session.images[k] else { return image.locate(&session.path) };
    let ImageSource::File { sha256, .. } = &image.source else { return None };
    Some(match sha256_of(given) {
        Ok(found) if found.eq_ignore_ascii_case(sha256) => Located::Same(given.clone()),
        Ok(_) => Located::Changed(given.clone()),
        Err(_) => Located::Missing(given.clone()),
    })
}

/// Returns the name of the built-in sample of an image, if it belongs to one.
fn sample_of(image: &ImageReference) -> Option<&str> {
    match &image.source {
        ImageSource::Sample { sample } => Some(sample),
        ImageSource::File { .. } => None,
    }
}

fn open_folder(path: &Path, views: &ViewNames) -> Result<OpenFolder, String> {
    let folder = PictureFolder::open(path)?;
    let missing = || format!("{} does not contain the images that were open", shown_path(path));
    let pair = folder.pair_named(views).ok_or_else(missing)?;
    Ok((Arc::new(folder), pair))
}

/// Returns the ground truth of the open pair of a folder.
fn known((folder, pair): &OpenFolder) -> Result<KnownTruth, String> {
    let truths = folder.known().ok_or_else(|| format!("{} has none", shown_path(folder.path())))?;
    KnownTruth::of_views(truths, *pair).map_err(|error| error.to_string())
}
