//! Things to open, and reading of pictures, sequences, built-in pairs and pairs of a folder.

use std::path::{Path, PathBuf, absolute};
use std::sync::Arc;

use crate::app::model::document::Side;
use crate::app::model::history::LensChange;
use crate::app::model::open_pair::OpenFolder;
use crate::app::model::picture::Opened;
use crate::app::model::recording::Recording;
use crate::app::model::sample::{FIRST, OpenedSample, sample_pair, sample_recordings};
use crate::app::model::session::{OpenSession, Relocation, Restored};
use crate::app::model::truth::KnownTruth;
use crate::camera::CameraModel;
use crate::cancel::CancelFlag;
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{PictureFolder, TruthError, TruthFolder, is_sequence, read_sequence};
use crate::presentation::sentence;
use crate::study::plan_views;
use crate::synthetic::Sample;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Opening {
    Sample(Sample),
    SampleSequences,
    /// Two files, left and right, or two folders of frames.
    Files(PathBuf, PathBuf),
    Folder(PathBuf),
    Session(OpenSession),
}

impl Default for Opening {
    fn default() -> Self {
        Self::Sample(FIRST)
    }
}

pub struct LoadedPair {
    pub pictures: [Opened; 2],
    /// Point pairs for "Show me", if the pictures have any.
    pub show_me: Option<[PointPair; 2]>,
    pub known: Option<KnownTruth>,
    pub folder: Option<OpenFolder>,
    /// Whether to use the ground truth from the start.
    pub uses_truth: bool,
    /// Contents of a session besides its pictures.
    pub restored: Option<Box<Restored>>,
    /// Remarks about the pictures, one or two sentences each.
    pub notes: Vec<String>,
    /// The change of the lens, if the pictures were open before and only that is new. Point pairs stay.
    pub lens: Option<LensChange>,
}

/// Reason why nothing was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OpeningFailure {
    /// Message with the fact and the action.
    Text(String),
    NoSession {
        path: PathBuf,
        /// Message that the file is not a session.
        problem: String,
    },
    /// The user must find the images of a session.
    Relocate(Box<Relocation>),
}

impl LoadedPair {
    /// Creates the result of opening two pictures without anything else.
    pub fn of(pictures: [Opened; 2]) -> Self {
        Self {
            pictures,
            show_me: None,
            known: None,
            folder: None,
            uses_truth: false,
            restored: None,
            notes: Vec::new(),
            lens: None,
        }
    }
}

/// Gives open pictures their calibrated cameras, or none.
pub fn calibrated(
    pictures: [Opened; 2],
    cameras: Option<&[CameraModel; 2]>,
) -> Result<[Opened; 2], OpeningFailure> {
    let pictures = pictures.map(Opened::without_calibration);
    let Some(cameras) = cameras else { return Ok(pictures) };
    let frames = pictures.each_ref().map(|opened| opened.picture.frame());
    let views = plan_views(cameras.each_ref(), frames).map_err(|error| {
        let problem = sentence(&error.to_string());
        OpeningFailure::Text(format!("{problem}. Nothing was changed. Correct the calibration."))
    })?;
    let [left, right] = pictures;
    Ok([left.drawn_in(views.views[0]), right.drawn_in(views.views[1])])
}

/// State of one opening while it reads pictures.
pub struct PairReading {
    /// Cancelled when other pictures are opened instead.
    pub cancel: CancelFlag,
    /// Open pictures that need not be read again.
    pub open: Vec<Opened>,
    /// Remarks about the pictures.
    pub notes: Vec<String>,
}

impl PairReading {
    /// Reads two files or two folders, as pictures or as sequences.
    pub fn pair(&mut self, paths: [&Path; 2]) -> Result<[Opened; 2], OpeningFailure> {
        let [left, right] = paths;
        match paths.map(is_sequence) {
            [false, false] => Ok([self.picture(left, Side::Left)?, self.picture(right, Side::Right)?]),
            [true, true] => self.sequences(paths),
            [left, _] => {
                let (one, other) = if left { ("left", "right") } else { ("right", "left") };
                Err(OpeningFailure::Text(format!(
                    "The {one} side is a sequence of frames, the {other} side a single picture. \
                     Nothing was changed. Open two pictures, or two sequences."
                )))
            }
        }
    }

    fn sequences(&mut self, [left, right]: [&Path; 2]) -> Result<[Opened; 2], OpeningFailure> {
        let pair = [self.sequence(left, Side::Left)?, self.sequence(right, Side::Right)?];
        let counts = pair.each_ref().map(|opened| opened.recording.as_ref().map_or(0, |r| r.sequence.len()));
        if counts[0] != counts[1] {
            self.notes.push(format!(
                "The sequences have {} and {} frames. Only the frames that both have are compared. \
                 If the sequences did not begin together, set the offset below the images, or let \
                 it be found.",
                counts[0], counts[1]
            ));
        }
        Ok(pair)
    }

    fn known(&self, path: &Path) -> Option<Opened> {
        self.open.iter().find(|opened| opened.picture.path.as_deref() == Some(path)).cloned()
    }

    /// Reads a sequence of frames and finds its silhouettes.
    fn sequence(&mut self, path: &Path, side: Side) -> Result<Opened, OpeningFailure> {
        if let Some(same) = self.known(path) {
            return Ok(same);
        }
        let name = side.name();
        let failed = |error: String| {
            OpeningFailure::Text(format!(
                "The {name} sequence: {error}. Nothing was changed. Use other frames, or open another sequence."
            ))
        };
        let file = read_sequence(path, &self.cancel, &|_| ()).map_err(|error| failed(error.to_string()))?;
        self.notes.extend(file.notes.iter().map(|note| format!("The {name} sequence: {note}.")));
        let recording =
            Recording::new(file.sequence, &self.cancel).map_err(|error| failed(error.to_string()))?;
        Ok(Opened::recorded(file.first, recording))
    }

    fn picture(&self, path: &Path, side: Side) -> Result<Opened, OpeningFailure> {
        if let Some(same) = self.known(path) {
            return Ok(same);
        }
        let name = side.name();
        Picture::open(path).map(Opened::new).map_err(|error| {
            OpeningFailure::Text(format!(
                "The {name} image: {error}. Nothing was changed. Check the file, or open another image."
            ))
        })
    }
}

/// Returns a message about a folder that could not be opened.
fn unchanged(error: &str) -> OpeningFailure {
    OpeningFailure::Text(format!(
        "The folder could not be opened: {error}. Nothing was changed. Correct the folder, or open another one."
    ))
}

impl From<OpenedSample> for LoadedPair {
    /// Beginners should try before they see the answer, so the truth is not used at once.
    fn from(OpenedSample { pictures, show_me, truth }: OpenedSample) -> Self {
        let known = Some(KnownTruth::of_sample(truth));
        Self { show_me: Some(show_me), known, ..Self::of(pictures) }
    }
}

pub fn sample(sample: Sample) -> LoadedPair {
    sample_pair(sample).into()
}

/// Draws the built-in sequences and finds their silhouettes.
pub fn sample_sequences(reading: &PairReading) -> Result<LoadedPair, OpeningFailure> {
    sample_recordings(&reading.cancel).map(LoadedPair::from).map_err(|error| {
        OpeningFailure::Text(format!(
            "The built-in sequences could not be drawn: {error}. Nothing was changed."
        ))
    })
}

/// Opens two files or folders. A ground truth beside them is known, and a key uses it.
pub fn open_files(paths: [&Path; 2], reading: &mut PairReading) -> Result<LoadedPair, OpeningFailure> {
    let opened = LoadedPair::of(reading.pair(paths)?);
    Ok(LoadedPair { known: truth_beside(paths), ..opened })
}

fn truth_beside(paths: [&Path; 2]) -> Option<KnownTruth> {
    let [left, right] = paths.map(|path| absolute(path).ok());
    let (folder, other) = (left.as_ref()?.parent()?, right.as_ref()?.parent()?);
    let folder = TruthFolder::open(folder).ok().filter(|_| folder == other)?;
    KnownTruth::of_views(&folder, folder.views_of(paths)?).ok()
}

pub fn open_folder(path: &Path, reading: &mut PairReading) -> Result<LoadedPair, OpeningFailure> {
    let folder = PictureFolder::open(path).map_err(|problem| unchanged(&problem))?;
    open_views(&Arc::new(folder), [0, 1], reading)
}

pub fn open_views(
    folder: &Arc<PictureFolder>,
    pair: [usize; 2],
    reading: &mut PairReading,
) -> Result<LoadedPair, OpeningFailure> {
    let pictures = reading.pair(pair.map(|view| folder.image(view)))?;
    let opened = LoadedPair { folder: Some((Arc::clone(folder), pair)), ..LoadedPair::of(pictures) };
    let Some(known) = folder.known() else { return Ok(opened) };
    match KnownTruth::of_views(known, pair) {
        Ok(known) => Ok(LoadedPair { known: Some(known), uses_truth: true, ..opened }),
        // A few true matches are no reason to refuse the images.
        Err(error @ TruthError::Matches { .. }) => {
            reading.notes.push(format!("The pair has no ground truth: {error}."));
            Ok(opened)
        }
        Err(error) => Err(unchanged(&error.to_string())),
    }
}
