//! Names and origins of pairs, and removal of several pairs.

use super::{Document, PairNote, pair_name};
use crate::io::{PairLabel, PairOrigin};

/// Maximum length of a name, characters.
const LONGEST_NAME: usize = 60;

impl Document {
    pub fn given_name(&self, pair: usize) -> Option<&str> {
        self.notes.get(&pair)?.name.as_deref()
    }

    /// Returns the given name of a pair, or the name of its place.
    pub fn name(&self, pair: usize) -> String {
        self.given_name(pair).map_or_else(|| pair_name(pair), str::to_owned)
    }

    pub fn origin(&self, pair: usize) -> PairOrigin {
        self.notes.get(&pair).map_or(PairOrigin::Clicked, |note| note.origin)
    }

    pub fn set_origin(&mut self, pair: usize, origin: PairOrigin) {
        self.note(pair, |note| note.origin = origin);
    }

    /// Names a pair. An empty name, or the name of its place, removes the given name.
    pub fn rename(&mut self, pair: usize, name: &str) {
        let name: String = name.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
        let is_given = !name.trim().is_empty() && name != pair_name(pair);
        self.note(pair, |note| note.name = is_given.then_some(name));
    }

    fn note(&mut self, pair: usize, change: impl FnOnce(&mut PairNote)) {
        if pair < self.pairs.len() {
            let mut note = self.notes.remove(&pair).unwrap_or_default();
            change(&mut note);
            if note != PairNote::default() {
                self.notes.insert(pair, note);
            }
        }
    }

    /// Returns names and origins of the pairs that are not excluded.
    pub fn labels(&self) -> impl Iterator<Item = PairLabel> + '_ {
        let included = (0..self.pairs.len()).filter(|pair| !self.excluded.contains(pair));
        included.map(|pair| PairLabel { name: self.name(pair), origin: self.origin(pair) })
    }

    pub fn remove_all(&mut self, pairs: impl IntoIterator<Item = usize>) {
        let mut pairs: Vec<_> = pairs.into_iter().collect();
        pairs.sort_unstable();
        for pair in pairs.into_iter().rev() {
            self.remove(pair);
        }
    }
}
