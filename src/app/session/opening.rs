//! Opening a session: its images are found, checked against their hashes, and read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Work;
use crate::app::document::{Side, TruthSource};
use crate::app::loader::{Failure, Opened, Pair, failure, sample};
use crate::app::truth::Known;
use crate::image::Picture;
use crate::io::{ImageReference, ImageSource, Located, SessionError, SessionFile, TruthFolder, sha256_of};
use crate::synthetic::Sample;

/// A session to open.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OpenSession {
    /// The file.
    pub path: PathBuf,
    /// Images in place of those that the session names.
    pub images: [Option<PathBuf>; 2],
    /// Whether images that have changed are taken as they are.
    pub accepts_changed: bool,
    /// Whether the file is the program's own copy of unsaved work.
    pub recovers: bool,
}

/// What is wrong with an image of a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lost {
    /// There is no such file.
    Missing(PathBuf),
    /// There is a file, but it is not the one that the session was made with.
    Changed(PathBuf),
}

/// A session whose images have to be found first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Relocation {
    /// What was to be opened.
    pub session: OpenSession,
    /// What is wrong with each image.
    pub lost: [Option<Lost>; 2],
}

/// What a session brings besides its pictures.
#[derive(Debug, Clone)]
pub struct Restored {
    /// What was opened.
    pub session: OpenSession,
    /// What was set.
    pub work: Work,
    /// What could not be had, a sentence each.
    pub notes: Vec<String>,
}

/// Opens a session with its pictures.
pub fn open(session: OpenSession) -> Result<Pair, Failure> {
    let path = session.path.clone();
    let unchanged = |text: &str| {
        Failure::Text(format!(
            "The session could not be opened: {text}. Nothing was changed; try another one."
        ))
    };
    let file = SessionFile::<Work>::read(&path).map_err(|error| match error {
        SessionError::Foreign { .. } => Failure::NoSession { path: path.clone(), problem: error.to_string() },
        _ => unchanged(&error.to_string()),
    })?;
    let from_sample = file.images.iter().all(|image| matches!(image.source, ImageSource::Sample { .. }));
    let mut pair = if from_sample {
        if file.images.iter().any(|image| !is_known_sample(image)) {
            return Err(unchanged("it is about a built-in sample that this program does not have"));
        }
        sample()
    } else {
        let mut found = [None, None];
        let mut lost = [None, None];
        for (k, image) in file.images.iter().enumerate() {
            match place(image, &session, k) {
                Some(Located::Same(path)) => found[k] = Some(path),
                Some(Located::Changed(path)) if session.accepts_changed => found[k] = Some(path),
                Some(Located::Changed(path)) => lost[k] = Some(Lost::Changed(path)),
                Some(Located::Missing(path)) => lost[k] = Some(Lost::Missing(path)),
                None => return Err(unchanged("only one of its images is of a built-in sample")),
            }
        }
        let [Some(left), Some(right)] = found else {
            return Err(Failure::Relocate(Box::new(Relocation { session, lost })));
        };
        let picture = |path: &Path, side: Side| {
            Picture::open(path).map(Opened::new).map_err(|error| failure(side, &error))
        };
        let pictures = [picture(&left, Side::Left)?, picture(&right, Side::Right)?];
        Pair { pictures, show_me: None, known: None, uses_truth: false, restored: None }
    };
    let frames = pair.pictures.each_ref().map(|opened| opened.picture.frame());
    let mut notes = Vec::new();
    if frames != file.images.map(|image| image.frame) {
        notes.push("An image has another size than when the session was saved: check the points.".to_owned());
    }
    let pairs = file.content.document.pairs.len();
    let mut work = file.content.made_valid(frames, &path);
    if work.document.pairs.len() < pairs {
        notes.push(format!(
            "Of the {pairs} point pairs of the session the first {} that are on the images are shown.",
            work.document.pairs.len()
        ));
    }
    if let Some(TruthSource::Folder { folder, views }) = &work.document.truth {
        match known(folder, views) {
            Ok(known) => pair.known = Some(known),
            Err(problem) => {
                notes.push(format!("The ground truth of the session is left out: {problem}."));
                work.document.truth = None;
            }
        }
    }
    pair.uses_truth = work.document.truth.is_some();
    pair.restored = Some(Box::new(Restored { session, work, notes }));
    Ok(pair)
}

/// Where image `k` is: where a person says, else where the session says.
fn place(image: &ImageReference, session: &OpenSession, k: usize) -> Option<Located> {
    let Some(given) = &session.images[k] else { return image.locate(&session.path) };
    let ImageSource::File { sha256, .. } = &image.source else { return None };
    Some(match sha256_of(given) {
        Ok(found) if found.eq_ignore_ascii_case(sha256) => Located::Same(given.clone()),
        Ok(_) => Located::Changed(given.clone()),
        Err(_) => Located::Missing(given.clone()),
    })
}

fn is_known_sample(image: &ImageReference) -> bool {
    matches!(&image.source, ImageSource::Sample { sample } if sample == Sample::default().name())
}

/// The ground truth of two views of a folder.
fn known(folder: &Path, views: &[String; 2]) -> Result<Known, String> {
    let truths = TruthFolder::open(folder).map_err(|error| error.to_string())?;
    let number = |view: &String| {
        let position = truths.names().iter().position(|name| name == view);
        position.ok_or_else(|| format!("{} has no view {view}", folder.display()))
    };
    let pair = [number(&views[0])?, number(&views[1])?];
    let truth = truths.truth(pair).map_err(|error| error.to_string())?;
    let source = TruthSource::Folder { folder: folder.to_owned(), views: views.clone() };
    Ok(Known { truth: Arc::new(truth), source, folder: Some((Arc::new(truths), pair)) })
}
