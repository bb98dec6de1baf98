//! Undo and redo by snapshots of the document.
//!
//! The document is small, so each step keeps a whole copy. Edits that belong together carry the
//! same [`EditKey`] and become one step: the moves of one drag, or a run of arrow keys.

use std::collections::VecDeque;

use super::document::{Document, PointRef};
use crate::camera::{CameraModel, RelativePose};

/// Key of edits that are merged into one step of the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EditKey {
    Drag(PointRef),
    Nudge(PointRef),
    /// Letters of the name of a pair.
    Name(usize),
    Parameter(&'static str),
    /// Changes of the time offset of two sequences.
    Offset,
}

/// Maximum number of steps. The oldest is removed first.
const LIMIT: usize = 500;

/// A change of the cameras that the pictures are taken with. All points get other coordinates.
#[derive(Debug, Clone, Default)]
pub struct LensChange {
    /// Name of the calibration; `None` for a lens fitted to the matches, and for none.
    pub name: Option<String>,
    /// The cameras; `None` takes the pictures as they are.
    pub cameras: Option<[CameraModel; 2]>,
    /// Pose of the second camera, if the file tells it.
    pub pose: Option<RelativePose>,
    /// Whether this is a step of the history, and goes back.
    pub travels: Option<bool>,
}

/// The other side of a change of the lens.
#[derive(Debug, Clone)]
pub struct LensStep {
    pub document: Document,
    pub history: History,
    pub cameras: Option<[CameraModel; 2]>,
}

impl LensStep {
    fn swapped(self) -> Self {
        let cameras = self.cameras.map(|[left, right]| [right, left]);
        Self { document: self.document.swapped(), history: self.history.swapped(), cameras }
    }
}

/// States before the current one, and states after it that were undone.
#[derive(Debug, Clone, Default)]
pub struct History {
    undo: VecDeque<Document>,
    redo: VecDeque<Document>,
    open: Option<EditKey>,
    /// State before the latest change of the lens, which came before all states here.
    before_lens: Option<Box<LensStep>>,
    /// State after the undone change of the lens, which came after all states here.
    after_lens: Option<Box<LensStep>>,
}

impl History {
    /// Records an edit from `before` to `after`. It is one step with the neighbouring edits of the
    /// same key. Nothing happens when the two are equal.
    pub fn record(&mut self, before: Document, after: &Document, key: Option<EditKey>) {
        if before == *after {
            return;
        }
        if key.is_none() || key != self.open {
            self.undo.push_back(before);
            if self.undo.len() > LIMIT {
                self.undo.pop_front();
            }
        }
        self.open = key;
        self.forget_undone();
    }

    fn forget_undone(&mut self) {
        self.redo.clear();
        self.after_lens = None;
    }

    /// Returns the change of the lens that undo, or redo, makes next; `None` if a state comes first.
    pub fn next_lens(&self, back: bool) -> Option<LensChange> {
        let (steps, lens) =
            if back { (&self.undo, &self.before_lens) } else { (&self.redo, &self.after_lens) };
        let step = lens.as_ref().filter(|_| steps.is_empty())?;
        Some(LensChange { cameras: step.cameras, travels: Some(back), ..LensChange::default() })
    }

    /// Records a change of the lens. Coordinates differ, so a new history begins.
    pub fn change_lens(&mut self, mut before: LensStep) {
        before.history.forget_undone();
        *self = Self { before_lens: Some(Box::new(before)), ..Self::default() };
    }

    /// Crosses a change of the lens and returns the document of the other side; `None` after edits.
    pub fn cross_lens(&mut self, back: bool, mut here: LensStep) -> Option<Document> {
        self.next_lens(back)?;
        let other = *if back { self.before_lens.take() } else { self.after_lens.take() }?;
        here.history = std::mem::replace(self, other.history);
        let way_back = if back { &mut self.after_lens } else { &mut self.before_lens };
        *way_back = Some(Box::new(here));
        Some(other.document)
    }

    /// Ends a run of merged edits: the next one starts a new step.
    pub fn close_step(&mut self) {
        self.open = None;
    }

    /// Exchanges the current state for the one before the last step, or for the undone state that
    /// follows. Returns the current state if there is none. If the two have the pictures in different
    /// orders, all other states take the order of the returned one.
    pub fn travel(&mut self, back: bool, current: Document) -> Document {
        self.open = None;
        let from = if back { &mut self.undo } else { &mut self.redo };
        let Some(other) = from.pop_back() else { return current };
        if other.is_swapped(&current) {
            *self = std::mem::take(self).swapped();
        }
        let to = if back { &mut self.redo } else { &mut self.undo };
        to.push_back(current);
        other
    }

    /// Removes the last step without keeping it for redo, and returns the state before it.
    pub fn revert(&mut self) -> Option<Document> {
        self.open = None;
        self.undo.pop_back()
    }

    /// Reverts the current run of merged edits. Nothing happens when the latest edit was of another
    /// kind.
    pub fn revert_run(&mut self, is_under_way: impl FnOnce(&EditKey) -> bool) -> Option<Document> {
        self.open.take().filter(is_under_way).and_then(|_| self.revert())
    }

    /// Returns the same steps for the pictures in the other order.
    #[must_use]
    pub fn swapped(self) -> Self {
        let swapped = |steps: VecDeque<Document>| steps.into_iter().map(Document::swapped).collect();
        let [before_lens, after_lens] =
            [self.before_lens, self.after_lens].map(|step| step.map(|step| Box::new(step.swapped())));
        Self { undo: swapped(self.undo), redo: swapped(self.redo), open: None, before_lens, after_lens }
    }

    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty() || self.before_lens.is_some()
    }

    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty() || self.after_lens.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::document::PictureIdentity;
    use crate::geometry::Frame;

    const RUN: Option<EditKey> = Some(EditKey::Offset);

    /// Returns documents that differ in a number.
    fn state(offset: i32) -> Document {
        Document { offset, ..Document::default() }
    }

    /// Returns the history of edits from 0 to these states in turn.
    fn edited(edits: &[(i32, Option<EditKey>)]) -> (History, Document) {
        let (mut history, mut current) = (History::default(), state(0));
        for (to, key) in edits {
            history.record(std::mem::replace(&mut current, state(*to)), &state(*to), *key);
        }
        (history, current)
    }

    #[test]
    fn a_new_edit_clears_redo_and_an_empty_edit_is_no_step() {
        let (mut history, current) = edited(&[(1, None), (1, None)]);
        let current = history.travel(true, current);
        assert!(history.can_redo() && !history.can_undo());
        history.record(current, &state(9), None);
        assert!(!history.can_redo());
    }

    #[test]
    fn a_swap_of_the_pictures_is_a_step_and_states_before_it_have_the_order_of_their_time() {
        let identity =
            |name: &str| PictureIdentity { name: name.into(), path: None, frame: Frame::new(320, 240) };
        let start = Document { pictures: Some(["a", "b"].map(identity)), ..Document::default() };
        let moved = Document { offset: 3, ..start.clone() };
        let mut history = History::default();
        history.record(start.clone(), &moved, None);
        let swapped = moved.clone().swapped();
        let mut history = history.swapped();
        history.record(moved.clone(), &swapped, None);
        let back = history.travel(true, swapped.clone());
        assert_eq!(back, moved);
        assert_eq!(history.travel(true, back), start);
        assert_eq!(history.travel(false, start), moved);
        assert_eq!(history.travel(false, moved), swapped);
    }

    #[test]
    fn reverting_leaves_nothing_to_redo_and_edits_of_another_kind_alone() {
        let (mut history, _) = edited(&[(5, RUN), (6, RUN)]);
        assert_eq!(history.revert_run(|key| *key == EditKey::Offset), Some(state(0)));
        assert!(!history.can_redo() && !history.can_undo());
        let (mut history, _) = edited(&[(5, None)]);
        assert_eq!(history.revert_run(|_| true), None);
        history.record(state(5), &state(6), RUN);
        assert_eq!(history.revert_run(|key| *key == EditKey::Name(0)), None);
        assert_eq!(history.travel(true, state(6)).offset, 5);
    }
}
