//! Replay of a search: the record drawn slowly, step by step.
//!
//! | module | contents |
//! |---|---|
//! | [`command`] | commands, and the speed |
//! | [`course`] | the steps of a search on the time axis |
//! | [`record`] | what a search left behind, in the form for drawing |
//! | [`kept`] | the hypotheses of the result that its parts belong to |
//! | [`moment`] | the drawing of a moment |
//! | [`sweep`] | lines of the left picture with their motion barcodes |
//! | [`steps`] | draws a moment: a pure function of record and time |
//! | `race` | draws the race of the hypotheses |
//! | `sequences` | draws the steps that only sequences have |
//! | [`strokes`] | shapes and times that several steps share |

pub mod command;
pub mod course;
pub mod kept;
pub mod moment;
mod race;
pub mod record;
mod sequences;
pub mod steps;
pub mod strokes;
pub mod sweep;

use std::sync::Arc;

pub use command::{ReplayCommand, Speed};
use course::Place;
use moment::Moment;
use record::Record;

/// What a record was made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key {
    pub revision: u64,
    pub pencils: u64,
    pub events: usize,
    pub running: bool,
}

/// Replay of the search of the open pictures.
#[derive(Debug, Default)]
pub struct Replay {
    /// The moment that is shown; `None` at the result.
    pub place: Option<Place>,
    pub playing: bool,
    /// Whether to pause at the end of the step.
    pub alone: bool,
    /// Whether the replay begins with the next result.
    pub awaited: bool,
    pub record: Option<(Key, Arc<Record>)>,
    /// The drawing of the shown moment, with what it was made from.
    pub drawn: Option<(Key, Place, Arc<Moment>)>,
}

impl Replay {
    /// Returns to the result.
    pub fn stop(&mut self) {
        *self = Self { record: self.record.take(), ..Self::default() };
    }

    /// Begins with the next result.
    pub fn await_result(&mut self) {
        self.awaited = true;
    }

    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Returns the drawing of the shown moment; `None` at the result.
    pub fn moment(&self) -> Option<&Moment> {
        self.drawn.as_ref().map(|(.., moment)| &**moment)
    }
}
