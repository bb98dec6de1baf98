//! The list of point pairs: names, and copying and pasting as spreadsheets do it.

mod command;
#[cfg(test)]
mod tests;

use std::fmt::Write as _;

pub use command::PointsCommand;

use super::Model;
use super::document::{counted, pair_name};
use super::history::EditKey;
use crate::geometry::{PointPair, symmetric_epipolar_distance};
use crate::io::{PairOrigin, parse_table};

impl Model {
    /// Returns the symmetric distance of a pair from the shown geometry, px.
    pub fn pair_distance(&self, pair: usize) -> Option<f64> {
        let distance = symmetric_epipolar_distance(self.shown()?.fundamental, self.document.pairs.get(pair)?);
        distance.is_finite().then_some(distance)
    }

    /// Names a pair. The letters of one name are one step.
    pub fn rename_pair(&mut self, pair: usize, name: &str) {
        self.edit_run(EditKey::Name(pair), |document| document.rename(pair, name));
    }

    /// Returns all pairs as a table for spreadsheets.
    pub fn copied_pairs(&self) -> String {
        let document = &self.document;
        let mut text = String::from("name\tx1\ty1\tx2\ty2\n");
        for (pair, PointPair { point1, point2 }) in self.pairs_in_pictures().into_iter().enumerate() {
            let name = document.name(pair);
            let _ = writeln!(text, "{name}\t{}\t{}\t{}\t{}", point1.x, point1.y, point2.x, point2.y);
        }
        text
    }

    /// Adds the pairs of a table in one step, and reports the result.
    pub fn paste_pairs(&mut self, text: &str) {
        let rows = match parse_table(text) {
            Ok(rows) => rows,
            Err(problem) => return self.messages.tell(problem),
        };
        let Some(frames) = self.document.frames() else { return };
        let total = rows.len();
        // Rows are places in the pictures.
        let points = |(name, pair): (_, PointPair)| Some((name, self.open.points_of(&pair)?));
        let mut inside: Vec<_> = rows.into_iter().filter_map(points).collect();
        inside.retain(|(_, pair)| pair.is_inside(frames));
        let (count, outside) = (inside.len(), total - inside.len());
        if outside > 0 {
            let were = if outside == 1 { "lies" } else { "lie" };
            self.messages.tell(format!(
                "{outside} of the {total} pasted point pairs {were} outside the images and cannot \
                 be added. Check that x comes before y, and the left image before the right one."
            ));
        }
        if count == 0 {
            return;
        }
        self.edit(|document| {
            let first = document.pairs.len();
            document.half = None;
            document.selection = None;
            for (number, (name, pair)) in inside.into_iter().enumerate() {
                document.pairs.push(pair);
                document.set_origin(first + number, PairOrigin::Pasted);
                // Automatic names are not kept, as the pair may have another place here.
                if let Some(name) = name.filter(|name| !is_name_of_a_place(name)) {
                    document.rename(first + number, &name);
                }
            }
        });
        self.open.done.tell(format!("Pasted {}", counted(count)));
    }
}

/// Returns whether a name is the automatic name of a place in the list.
fn is_name_of_a_place(name: &str) -> bool {
    (0..3).any(|pair| pair_name(pair) == name) || name.parse::<usize>().is_ok()
}
