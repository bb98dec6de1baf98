//! Repair of a placed pair: the requests, and the reaction to the answers.

use super::Model;
use super::document::{PointRef, Role, Side, pair_name};
use super::messages::MessageKind;
use super::suggesting::{PairsQuestion, RepairQuestion, Repaired};
use crate::estimate::Verdict;
use crate::geometry::Point;
use crate::io::PairOrigin;
use crate::study::PlaceFound;

/// A point that would move by less than this, px, stays.
const IN_PLACE: f64 = 0.01;

impl Model {
    /// Returns the request to refine a pair. `None` for an unfinished pair and for sequences compared by
    /// barcodes.
    pub fn repair_question(&self, pair: usize) -> Option<RepairQuestion> {
        let points = *self.document.pairs.get(pair).filter(|_| !self.compares_barcodes())?;
        Some(RepairQuestion { pictures: self.open.pictures()?, pair, points, found: self.trusted_result() })
    }

    /// Returns the request to look for the matches of the pairs, for a result that is not unreliable.
    pub fn places_question(&self) -> Option<PairsQuestion> {
        let (found, pairs) = (self.trusted_result()?, self.document.pairs.clone());
        if self.compares_barcodes() || pairs.is_empty() {
            return None;
        }
        Some(PairsQuestion { pictures: self.open.pictures()?, found, pairs })
    }

    /// Returns how far the match of a pair lies from its right point, px, if it clearly lies elsewhere on the
    /// epipolar line.
    pub fn slid(&self, pair: usize) -> Option<f64> {
        let place = self.unconfirmed(pair)?.place?;
        Some((place - self.document.pairs[pair].point2).norm())
    }

    /// Returns what the images tell about a pair whose place along the line they do not confirm, although the
    /// result is reliable.
    pub fn unconfirmed(&self, pair: usize) -> Option<&PlaceFound> {
        let found = self.trusted_result()?;
        let trust = found.assessment.trust.as_ref()?;
        let counts = trust.verdict == Verdict::Reliable && self.document.role(pair) != Role::Excluded;
        self.place_found(pair).filter(|found| counts && !found.is_confirmed)
    }

    /// Returns the place of the match of a pair in the right image, px, if the images show it clearly and the
    /// right point is not there yet.
    pub fn better_place(&self, pair: usize) -> Option<Point> {
        let found = self.place_found(pair)?;
        found.place.filter(|place| (place - found.pair.point2).norm() >= IN_PLACE)
    }

    fn place_found(&self, pair: usize) -> Option<&PlaceFound> {
        let points = self.document.pairs.get(pair)?;
        let (question, places) = self.open.places.as_ref()?;
        let is_of_these = self.trusted_result().is_some_and(|found| found == question.found)
            && self.open.pictures().is_some_and(|pictures| pictures == question.pictures);
        places.iter().find(|found| is_of_these && found.pair == *points)
    }

    /// Moves the right point of a pair to its match on the epipolar line, if the match is clear.
    pub fn move_to_match(&mut self, pair: usize) {
        if let Some(place) = self.better_place(pair) {
            self.repair(pair, place, PairOrigin::MovedToMatch, "moved to its match");
        }
    }

    /// Moves the point of a refined pair and reports it, unless the pair changed meanwhile.
    pub fn take_repair(&mut self, (question, outcome): Repaired) {
        let RepairQuestion { pictures, pair, points, .. } = question;
        if self.document.pairs.get(pair) != Some(&points) || self.open.pictures() != Some(pictures) {
            return;
        }
        let name = pair_name(pair);
        match outcome {
            Ok(place) if (place - points.point2).norm() < IN_PLACE => self
                .open
                .done
                .tell(format!("Pair {name} needs no repair: its right point is already in the best place.")),
            Ok(place) => self.repair(pair, place, PairOrigin::Refined, "refined"),
            Err(why) => {
                let text = format!(
                    "Pair {name} was not changed. {why}. Drag its right point to the match yourself, \
                     or leave the pair out."
                );
                self.messages.say(MessageKind::OfPair, text, Vec::new());
            }
        }
    }

    fn repair(&mut self, pair: usize, place: Point, origin: PairOrigin, what: &str) {
        let moved = (place - self.document.pairs[pair].point2).norm();
        let name = pair_name(pair);
        self.open.done.tell(format!("Pair {name} {what}: its right point moved by {moved:.2} px."));
        self.edit(|document| {
            document.move_to(PointRef { pair, side: Side::Right }, place);
            document.set_origin(pair, origin);
        });
    }
}
