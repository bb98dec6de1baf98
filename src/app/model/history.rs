//! Undo and redo by snapshots of the document.
//!
//! The document is small, so each step keeps a whole copy. Edits that belong together carry the
//! same [`Step`] and become one step: the moves of one drag, or a run of arrow keys.

use std::collections::VecDeque;

/// Maximum number of steps. The oldest is removed first.
const LIMIT: usize = 500;

/// Grouping of an edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step<K> {
    /// A step of its own.
    Single,
    /// One step with the neighbouring edits that carry the same key.
    Merged(K),
}

/// States before the current one, and states after it that were undone.
#[derive(Debug, Clone)]
pub struct History<T, K> {
    undo: VecDeque<T>,
    redo: Vec<T>,
    open: Option<K>,
}

impl<T, K> Default for History<T, K> {
    fn default() -> Self {
        Self { undo: VecDeque::new(), redo: Vec::new(), open: None }
    }
}

impl<T: PartialEq, K: PartialEq + Copy> History<T, K> {
    /// Records an edit from `before` to `after`. Nothing happens when the two are equal.
    pub fn record(&mut self, before: T, after: &T, step: Step<K>) {
        if before == *after {
            return;
        }
        let key = match step {
            Step::Single => None,
            Step::Merged(key) => Some(key),
        };
        if key.is_none() || key != self.open {
            self.undo.push_back(before);
            if self.undo.len() > LIMIT {
                self.undo.pop_front();
            }
        }
        self.open = key;
        self.redo.clear();
    }

    /// Ends a run of merged edits: the next one starts a new step.
    pub fn close_step(&mut self) {
        self.open = None;
    }

    /// Returns the state before the last step and keeps the current one for redo.
    pub fn undo(&mut self, current: T) -> Result<T, T> {
        self.open = None;
        match self.undo.pop_back() {
            Some(previous) => {
                self.redo.push(current);
                Ok(previous)
            }
            None => Err(current),
        }
    }

    /// Returns the undone state that follows the current one.
    pub fn redo(&mut self, current: T) -> Result<T, T> {
        self.open = None;
        match self.redo.pop() {
            Some(next) => {
                self.undo.push_back(current);
                Ok(next)
            }
            None => Err(current),
        }
    }

    /// Removes the last step without keeping it for redo, and returns the state before it.
    pub fn revert(&mut self) -> Option<T> {
        self.open = None;
        self.undo.pop_back()
    }

    /// Reverts the current run of merged edits. Nothing happens when the latest edit was of another
    /// kind.
    pub fn revert_run(&mut self, is_under_way: impl FnOnce(&K) -> bool) -> Option<T> {
        self.open.take().filter(is_under_way).and_then(|_| self.revert())
    }

    /// Returns whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Returns whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edit(history: &mut History<i32, u8>, state: &mut i32, to: i32, step: Step<u8>) {
        let before = std::mem::replace(state, to);
        history.record(before, state, step);
    }

    #[test]
    fn undo_and_redo_walk_the_same_states() {
        let (mut history, mut state) = (History::<i32, u8>::default(), 0);
        for to in 1..=3 {
            edit(&mut history, &mut state, to, Step::Single);
        }
        for expected in [2, 1, 0] {
            state = history.undo(state).unwrap();
            assert_eq!(state, expected);
        }
        assert_eq!(history.undo(state), Err(0));
        for expected in [1, 2, 3] {
            state = history.redo(state).unwrap();
            assert_eq!(state, expected);
        }
        assert_eq!(history.redo(state), Err(3));
    }

    #[test]
    fn a_drag_is_one_step_and_two_drags_are_two() {
        let (mut history, mut state) = (History::default(), 0);
        for to in [1, 2, 3] {
            edit(&mut history, &mut state, to, Step::Merged(7));
        }
        history.close_step();
        edit(&mut history, &mut state, 4, Step::Merged(7));
        state = history.undo(state).unwrap();
        assert_eq!(state, 3);
        assert_eq!(history.undo(state), Ok(0));
    }

    #[test]
    fn a_new_edit_clears_redo_and_an_empty_edit_is_no_step() {
        let (mut history, mut state) = (History::default(), 0);
        edit(&mut history, &mut state, 1, Step::Single);
        edit(&mut history, &mut state, 1, Step::Single);
        state = history.undo(state).unwrap();
        assert!(history.can_redo() && !history.can_undo());
        edit(&mut history, &mut state, 9, Step::Single);
        assert!(!history.can_redo());
    }

    #[test]
    fn reverting_leaves_nothing_to_redo() {
        let (mut history, mut state) = (History::default(), 0);
        edit(&mut history, &mut state, 5, Step::Merged(7));
        edit(&mut history, &mut state, 6, Step::Merged(7));
        assert_eq!(history.revert_run(|key| *key == 7), Some(0));
        assert!(!history.can_redo() && !history.can_undo());
    }

    #[test]
    fn reverting_leaves_edits_of_another_kind_alone() {
        let (mut history, mut state) = (History::default(), 0);
        edit(&mut history, &mut state, 5, Step::Single);
        assert_eq!(history.revert_run(|_| true), None);
        edit(&mut history, &mut state, 6, Step::Merged(7));
        assert_eq!(history.revert_run(|key| *key == 8), None);
        assert_eq!(history.undo(state), Ok(5));
    }
}
