//! Searches in sequences of two stationary cameras.

use std::path::PathBuf;
use std::sync::Arc;

use epiline::estimate::{EstimateError, Monitor};
use epiline::io::{MOST_FRAMES, SequenceError, SequenceFile, read_sequence};
use epiline::motion::{
    BackgroundParameters, FEWEST_FRAMES, FrameSequence, MOST_OFFSET, MotionError, Silhouettes, clear_offset,
    find_offset,
};
use epiline::study::{Question, Study, barcode_parameters};
use pyo3::prelude::*;

use crate::arrays::{Rows, pairs_of, picture_of};
use crate::errors::{input, of_estimate};
use crate::estimate::{Estimate, Source, parameters_of};
use crate::search::{Threads, watched};

/// Reason why two sequences give no geometry.
enum Failure {
    Motion(MotionError),
    TooShort,
    Search(EstimateError),
}

impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        Self::Motion(error)
    }
}

impl Failure {
    fn raised(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Motion(error) => input(py, error.to_string()),
            Self::TooShort => input(py, "the sequences are too short to find their offset. Give it (offset)"),
            Self::Search(error) => of_estimate(py, error),
        }
    }
}

/// Reads a sequence from a folder or a video, or takes it from an iterator over paths and arrays. Messages have its
/// name.
fn sequence_of(frames: &Bound<'_, PyAny>, name: &str, threads: &Threads) -> PyResult<SequenceFile> {
    let py = frames.py();
    let told = |error: SequenceError| input(py, error.to_string());
    if let Ok(path) = frames.extract::<PathBuf>() {
        let read = |monitor: &Monitor| read_sequence(&path, monitor.cancel(), &|_| ());
        return watched(py, threads, None, read)?.map_err(told);
    }
    let mut sequence = FrameSequence::new(name);
    let mut first = None;
    for (number, frame) in frames.try_iter()?.enumerate() {
        py.check_signals()?;
        if number >= MOST_FRAMES {
            return Err(told(SequenceError::TooLong(name.to_owned())));
        }
        let picture = picture_of(&frame?, &format!("frame {number} of {name}"), threads)?;
        // Equal numbers are equally bright in all frames.
        let picture = match &first {
            Some(first) => picture.in_range_of(first),
            None => picture,
        };
        sequence.push(&picture.gray).map_err(|error| told(error.into()))?;
        first.get_or_insert(picture);
    }
    let few = || MotionError::TooFewFrames { name: name.to_owned(), found: 0, least: FEWEST_FRAMES };
    let mut first = first.ok_or_else(|| told(few().into()))?;
    // The file of one frame is not that of the sequence.
    first.path = None;
    Ok(SequenceFile { sequence, first, notes: Vec::new() })
}

/// Returns the clear offset of two sequences, or 0 with a remark.
fn offset_of(both: [&Silhouettes; 2], monitor: &Monitor) -> Result<(i32, Option<String>), Failure> {
    let found = find_offset(both, MOST_OFFSET, monitor.cancel())?;
    if found.is_empty() {
        return Err(Failure::TooShort);
    }
    Ok(match clear_offset(&found) {
        Some(best) => (best.offset, None),
        None => (0, Some("no offset is clear, so the sequences are compared at offset 0".to_owned())),
    })
}

/// Searches for the geometry of two sequences.
#[pyfunction]
#[pyo3(signature = (frames1, frames2, pairs, offset, preset, seed, threads, changes, progress))]
pub fn barcode(
    py: Python<'_>,
    frames1: &Bound<'_, PyAny>,
    frames2: &Bound<'_, PyAny>,
    pairs: Option<Rows>,
    offset: Option<i32>,
    preset: &str,
    seed: u64,
    threads: Option<usize>,
    changes: Vec<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Estimate> {
    let threads = Threads::given(py, threads)?;
    let clicks = pairs.map(|rows| pairs_of(py, &rows)).transpose()?.unwrap_or_default();
    let mut parameters = barcode_parameters(parameters_of(py, preset, &changes)?, clicks.len());
    parameters.seed = seed;
    let files = [sequence_of(frames1, "frames1", &threads)?, sequence_of(frames2, "frames2", &threads)?];
    let mut remarks: Vec<String> = files.iter().flat_map(|file| file.notes.clone()).collect();
    let [count1, count2] = files.each_ref().map(|file| file.sequence.len());
    if count1 != count2 {
        remarks.push(format!(
            "the sequences have {count1} and {count2} frames, and only frames in both at this offset are compared"
        ));
    }
    let search = |monitor: &Monitor| -> Result<_, Failure> {
        let silhouettes = |file: &SequenceFile| {
            Silhouettes::new(&file.sequence, &BackgroundParameters::default(), monitor.cancel())
        };
        let both = [silhouettes(&files[0])?, silhouettes(&files[1])?];
        let (offset, remark) = match offset {
            Some(offset) => (offset, None),
            None => offset_of(both.each_ref(), monitor)?,
        };
        let together = Silhouettes::overlapping(both.each_ref(), offset)?.map(Arc::new);
        let originals = files.map(|file| Arc::new(file.first));
        let study = Study::of_pictures(originals.clone()).with_silhouettes(together);
        let question = Question { clicks: &clicks, given: None, parameters: &parameters };
        let found = study.solve(&question, monitor).map_err(Failure::Search)?;
        Ok((study, originals, found, offset, remark))
    };
    let (study, originals, found, offset, remark) =
        watched(py, &threads, progress, search)?.map_err(|failure| failure.raised(py))?;
    remarks.extend(remark);
    let source = Source::Pictures {
        study: Box::new(study),
        originals,
        clicks,
        given: Vec::new(),
        parameters: Box::new(parameters),
        offset: Some(offset),
    };
    Ok(Estimate::new(found, source, None, remarks))
}
