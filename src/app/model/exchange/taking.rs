//! Imported points as point pairs or as given matches, and the way from one to the other.

use crate::app::model::Model;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::document::{Document, GIVEN_FIT, Given, counted};
use crate::app::model::messages::{MessageAction, MessageKind};
use crate::estimate::{Match, Search};
use crate::geometry::PointPair;
use crate::io::PairOrigin;

/// Maximum number of given matches that become point pairs. More handles hide the pictures and slow the window.
const MOST_EDITED: usize = 2000;
/// Minimum number of point pairs that become given matches: a fit to matches needs as many.
const LEAST_GIVEN: usize = 14;

impl Document {
    fn imported_pairs(&self) -> Vec<usize> {
        (0..self.pairs.len()).filter(|pair| self.origin(*pair) == PairOrigin::Imported).collect()
    }

    /// Adds matches to search with. With too few point pairs, the search goes on without clicks.
    fn give(&mut self, given: Given) {
        self.unclicked |= self.parameters.search == Search::Patches;
        self.given = Some(given);
    }
}

impl Model {
    /// Replaces the point pairs by those of a file.
    pub fn take_pairs(&mut self, file: &str, pairs: Vec<PointPair>) {
        self.edit(|document| document.set_pairs(pairs, PairOrigin::Imported));
        self.tell_of_pairs(file);
    }

    /// Searches with matches of another program, without clicks if there are too few.
    pub fn take_given(&mut self, given: Given) {
        self.edit(|document| document.give(given));
        self.tell_of_given();
    }

    pub fn can_edit_given(&self) -> bool {
        self.document.given.as_ref().is_some_and(|given| given.matches.len() <= MOST_EDITED)
    }

    /// Turns the given matches into point pairs, after those that are there.
    pub fn edit_given(&mut self) {
        let Some(given) = self.document.given.clone().filter(|_| self.can_edit_given()) else { return };
        self.edit(|document| {
            document.given = None;
            let first = document.pairs.len();
            (document.half, document.selection) = (None, None);
            document.pairs.extend(given.pairs());
            for pair in first..document.pairs.len() {
                document.set_origin(pair, PairOrigin::Imported);
            }
        });
        self.tell_of_pairs(&given.file);
    }

    pub fn can_give_imported(&self) -> bool {
        self.document.imported_pairs().len() >= LEAST_GIVEN
    }

    /// Turns the imported pairs into given matches, beside those that are there. Pairs that were moved stay.
    pub fn give_imported(&mut self, file: &str) {
        if !self.can_give_imported() {
            return;
        }
        let pairs = self.document.imported_pairs();
        let mut matches: Vec<Match> =
            self.document.given.iter().flat_map(|given| given.matches.iter().copied()).collect();
        matches.extend(pairs.iter().map(|pair| Match::from(self.document.pairs[*pair])));
        let given = Given::new(file.to_owned(), matches);
        self.edit(|document| {
            document.remove_all(pairs);
            document.give(given);
        });
        self.tell_of_given();
    }

    /// Tells that imported points are point pairs.
    pub fn tell_of_pairs(&mut self, file: &str) {
        let count = counted(self.document.imported_pairs().len());
        let other = ExchangeCommand::GiveImported(file.to_owned());
        let action = self.can_give_imported().then_some(("Make given matches", other));
        self.tell_of_taken(format!("{count} from {file}, each can be dragged."), action);
    }

    /// Tells that imported points are given matches.
    fn tell_of_given(&mut self) {
        let Some(given) = &self.document.given else { return };
        let (count, file) = (given.matches.len(), &given.file);
        let can_edit = self.can_edit_given();
        let limit =
            if can_edit { String::new() } else { format!(" More than {MOST_EDITED} cannot be point pairs.") };
        let text = format!(
            "{count} given matches from {file} take part in the search as they are: violet rings fit to {GIVEN_FIT} px, red ones do not.{limit}"
        );
        self.tell_of_taken(text, can_edit.then_some(("Make point pairs", ExchangeCommand::EditGiven)));
    }

    fn tell_of_taken(&mut self, text: String, action: Option<(&'static str, ExchangeCommand)>) {
        self.messages.settle(MessageKind::Taken);
        let action = action.map(|(label, command)| MessageAction { label, command: command.into() });
        self.messages.say(MessageKind::Taken, text, action.into_iter().collect());
    }
}
