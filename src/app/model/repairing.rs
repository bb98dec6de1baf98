//! Repair of a placed pair: the request, and the reaction to the answer.

use super::Model;
use super::document::{PointRef, Side, pair_name};
use super::messages::MessageKind;
use super::suggesting::{Repair, RepairQuestion, Repaired, Slid, SlidQuestion};
use crate::estimate::Verdict;
use crate::geometry::PointPair;
use crate::io::PairOrigin;

/// A point that would move by less than this, px, stays.
const IN_PLACE: f64 = 0.01;

impl Model {
    /// Returns the request to repair a pair. `None` for an unfinished pair, for sequences compared
    /// by barcodes, and for a rematch without a reliable geometry.
    pub fn repair_question(&self, pair: usize, how: Repair) -> Option<RepairQuestion> {
        let found = self.trusted_result();
        if self.compares_barcodes() || how == Repair::Rematch && found.is_none() {
            return None;
        }
        let points = *self.document.pairs.get(pair)?;
        Some(RepairQuestion { pictures: self.open.pictures()?, pair, points, how, found })
    }

    /// Returns the request to check the places of the pairs along their lines, for a reliable result.
    pub fn slid_question(&self) -> Option<SlidQuestion> {
        let found = self.trusted_result()?;
        let is_reliable =
            found.assessment.trust.as_ref().is_some_and(|trust| trust.verdict == Verdict::Reliable);
        let pairs: Vec<PointPair> = self.document.included().collect();
        if !is_reliable || self.compares_barcodes() || pairs.is_empty() {
            return None;
        }
        Some(SlidQuestion { pictures: self.open.pictures()?, found, pairs })
    }

    /// Returns how far the match of a pair lies from its right point, px, if it clearly lies elsewhere on the
    /// epipolar line.
    pub fn slid(&self, pair: usize) -> Option<f64> {
        let place = self.unconfirmed(pair)?.place?;
        Some((place - self.document.pairs[pair].point2).norm())
    }

    /// Returns what the images tell about a pair whose place along the line they do not confirm.
    pub fn unconfirmed(&self, pair: usize) -> Option<&Slid> {
        let points = self.document.pairs.get(pair)?;
        let (question, unconfirmed) = self.open.slid.as_ref()?;
        let is_of_these = self.trusted_result().is_some_and(|found| found == question.found)
            && self.open.pictures().is_some_and(|pictures| pictures == question.pictures);
        unconfirmed.iter().find(|slid| is_of_these && slid.pair == *points)
    }

    /// Returns whether no clear match of a pair was found.
    pub fn has_no_match(&self, pair: usize) -> bool {
        self.open.unmatched.is_some() && self.open.unmatched == self.document.pairs.get(pair).copied()
    }

    /// Moves the point of a repaired pair and reports it, unless the pair changed meanwhile.
    pub fn take_repair(&mut self, repaired: Repaired) {
        let Repaired { question: RepairQuestion { pictures, pair, points, how, .. }, outcome } = repaired;
        if self.document.pairs.get(pair) != Some(&points) || self.open.pictures() != Some(pictures) {
            return;
        }
        let name = pair_name(pair);
        match outcome {
            Ok(position) => {
                let moved = (position - points.point2).norm();
                if moved < IN_PLACE {
                    self.open.done.tell(format!(
                        "Pair {name} needs no repair: its right point is already in the best place."
                    ));
                    return;
                }
                let what = match how {
                    Repair::Refine => "refined",
                    Repair::Rematch => "moved to its match",
                };
                self.open.done.tell(format!("Pair {name} {what}: its right point moved by {moved:.2} px."));
                let at = PointRef { pair, side: Side::Right };
                let origin = match how {
                    Repair::Refine => PairOrigin::Refined,
                    Repair::Rematch => PairOrigin::MovedToMatch,
                };
                self.edit(|document| {
                    document.move_to(at, position);
                    document.set_origin(pair, origin);
                });
            }
            Err(why) => {
                self.open.unmatched = Some(points).filter(|_| how == Repair::Rematch);
                let text = format!(
                    "Pair {name} was not changed. {why}. Drag its right point to the match yourself, \
                     or leave the pair out."
                );
                self.messages.say(MessageKind::OfPair, text, Vec::new());
            }
        }
    }
}
