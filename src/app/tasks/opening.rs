//! What can be opened, and how pictures, sequences, the built-in pairs and the pairs of a folder are.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::app::model::document::{Side, TruthSource};
use crate::app::model::open_pair::OpenFolder;
use crate::app::model::pair_folder::PairFolder;
use crate::app::model::picture::Opened;
use crate::app::model::recording::Recording;
use crate::app::model::sample::{SampleRecordings, sample_pair, sample_recordings};
use crate::app::model::session::{Relocation, Restored};
use crate::app::model::shared::Shared;
use crate::app::model::truth::KnownTruth;
use crate::cancel::CancelFlag;
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{is_sequence, read_sequence};

/// What to open.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Opening {
    /// The built-in pair.
    #[default]
    Sample,
    /// The built-in sequences.
    SampleSequences,
    /// Two files, left and right, or two folders of frames.
    Files(PathBuf, PathBuf),
    /// The first pair of a folder.
    Folder(PathBuf),
    /// A session.
    Session(PathBuf),
}

/// What an opening gives.
pub struct LoadedPair {
    /// The two pictures.
    pub pictures: [Opened; 2],
    /// Point pairs for "Show me", when there are any.
    pub show_me: Option<[PointPair; 2]>,
    /// What is known about them, if anything.
    pub known: Option<KnownTruth>,
    /// The folder that the pictures are of.
    pub folder: Option<OpenFolder>,
    /// Whether what is known is to be used from the start.
    pub uses_truth: bool,
    /// What a session brings.
    pub restored: Option<Box<Restored>>,
    /// What a person has to know about the pictures, a sentence or two each.
    pub notes: Vec<String>,
}

/// Why nothing was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OpeningFailure {
    /// What happened and what to do.
    Text(String),
    /// A file that was to be a session is something else.
    NoSession {
        /// The file.
        path: PathBuf,
        /// That it is no session.
        problem: String,
    },
    /// The images of a session have to be found first.
    Relocate(Box<Relocation>),
}

impl LoadedPair {
    /// Two pictures of which nothing else is known.
    pub fn of(pictures: [Opened; 2]) -> Self {
        Self {
            pictures,
            show_me: None,
            known: None,
            folder: None,
            uses_truth: false,
            restored: None,
            notes: Vec::new(),
        }
    }
}

/// How the pictures of one opening are read, and what there is to tell about them.
pub struct PairReading {
    /// Set when others are to be opened instead.
    pub cancel: CancelFlag,
    /// Pictures that are open and not read again.
    pub open: Vec<Opened>,
    /// What a person has to know about the pictures.
    pub notes: Vec<String>,
}

impl PairReading {
    /// What two files are, or two folders: pictures, or sequences.
    pub fn pair(&mut self, paths: [&Path; 2]) -> Result<[Opened; 2], OpeningFailure> {
        let [left, right] = paths;
        match paths.map(is_sequence) {
            [false, false] => Ok([self.picture(left, Side::Left)?, self.picture(right, Side::Right)?]),
            [true, true] => self.sequences(paths),
            [left, _] => {
                let (one, other) = if left { ("left", "right") } else { ("right", "left") };
                Err(OpeningFailure::Text(format!(
                    "The {one} one is a sequence of frames and the {other} one a single picture. Nothing was changed; open two pictures, or two sequences."
                )))
            }
        }
    }

    /// Both sequences of frames.
    fn sequences(&mut self, [left, right]: [&Path; 2]) -> Result<[Opened; 2], OpeningFailure> {
        let pair = [self.sequence(left, Side::Left)?, self.sequence(right, Side::Right)?];
        let counts = pair.each_ref().map(|opened| opened.recording.as_ref().map_or(0, |r| r.sequence.len()));
        if counts[0] != counts[1] {
            self.notes.push(format!(
                "The sequences have {} and {} frames: those that both have are compared. If they did not begin together, set the offset below the images, or let it be found.",
                counts[0], counts[1]
            ));
        }
        Ok(pair)
    }

    fn known(&self, path: &Path) -> Option<Opened> {
        self.open.iter().find(|opened| opened.picture.path.as_deref() == Some(path)).cloned()
    }

    /// A sequence of frames, with what moves in it.
    fn sequence(&mut self, path: &Path, side: Side) -> Result<Opened, OpeningFailure> {
        if let Some(same) = self.known(path) {
            return Ok(same);
        }
        let name = side.name();
        let failed = |error: String| {
            OpeningFailure::Text(format!(
                "The {name} sequence: {error}. Nothing was changed; take other frames, or open another one."
            ))
        };
        let file = read_sequence(path, &self.cancel, &|_| ()).map_err(|error| failed(error.to_string()))?;
        self.notes.extend(file.notes.iter().map(|note| format!("The {name} sequence: {note}.")));
        let recording =
            Recording::new(file.sequence, &self.cancel).map_err(|error| failed(error.to_string()))?;
        Ok(Opened::recorded(file.first, recording))
    }

    /// The picture of a file.
    fn picture(&self, path: &Path, side: Side) -> Result<Opened, OpeningFailure> {
        if let Some(same) = self.known(path) {
            return Ok(same);
        }
        let name = side.name();
        Picture::open(path).map(Opened::new).map_err(|error| {
            OpeningFailure::Text(format!(
                "The {name} image: {error}. Nothing was changed; check the file, or open another one."
            ))
        })
    }
}

/// What happened with a folder and what to do.
fn unchanged(error: &str) -> OpeningFailure {
    OpeningFailure::Text(format!(
        "The folder could not be opened: {error}. Nothing was changed; correct it, or open another one."
    ))
}

/// The built-in pair.
pub fn sample() -> LoadedPair {
    let sample = sample_pair();
    let source = TruthSource::Sample(sample.truth.name.clone());
    let known = Some(KnownTruth { truth: Shared::new(sample.truth), source });
    // Who learns the program is not shown the answer before the question: the truth is not used at once.
    LoadedPair { show_me: Some(sample.show_me), known, ..LoadedPair::of(sample.pictures.map(Opened::new)) }
}

/// The built-in sequences, drawn and told from their background.
pub fn sample_sequences(reading: &PairReading) -> Result<LoadedPair, OpeningFailure> {
    let drawn = sample_recordings(&reading.cancel).map_err(|error| {
        OpeningFailure::Text(format!(
            "The built-in sequences could not be drawn: {error}. Nothing was changed."
        ))
    })?;
    let SampleRecordings { pictures, show_me, truth } = drawn;
    let source = TruthSource::Sample(truth.name.clone());
    let known = KnownTruth { truth: Shared::new(truth), source };
    Ok(LoadedPair { show_me: Some(show_me), known: Some(known), ..LoadedPair::of(pictures) })
}

/// The first pair of a folder.
pub fn open_folder(path: &Path, reading: &mut PairReading) -> Result<LoadedPair, OpeningFailure> {
    let folder = PairFolder::open(path).map_err(|problem| unchanged(&problem))?;
    open_views(&Arc::new(folder), [0, 1], reading)
}

/// Two views of a folder.
pub fn open_views(
    folder: &Arc<PairFolder>,
    pair: [usize; 2],
    reading: &mut PairReading,
) -> Result<LoadedPair, OpeningFailure> {
    let pictures = reading.pair(pair.map(|view| folder.image(view)))?;
    let opened = LoadedPair { folder: Some((Arc::clone(folder), pair)), ..LoadedPair::of(pictures) };
    let Some(known) = folder.known() else { return Ok(opened) };
    let truth = known.truth(pair).map_err(|error| unchanged(&error.to_string()))?;
    let views = pair.map(|view| known.names()[view].clone());
    let source = TruthSource::Folder { folder: known.path().to_owned(), views };
    Ok(LoadedPair {
        known: Some(KnownTruth { truth: Shared::new(truth), source }),
        uses_truth: true,
        ..opened
    })
}
