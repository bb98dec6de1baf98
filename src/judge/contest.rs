//! Which of two explanations the matches prefer: an exact sign test over places.
//!
//! Neighbouring matches share their errors, and may lie on one thing that moves. So each place of image 1
//! has one vote. If two explanations are equally good, a place that prefers one of them prefers either with
//! probability ½ (`McNemar` 1947).

use std::collections::HashMap;

use serde::Serialize;

use crate::geometry::{Frame, Point};

/// Side of a place, as a share of the longer side: things that move by themselves are smaller.
const PLACE: f64 = 0.1;
/// Probability of a decision by chance: one in a thousand.
const BY_CHANCE: f64 = 1e-3;

/// Numbers of places that prefer either of two explanations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Contest {
    /// Places that prefer the first explanation.
    pub first: usize,
    /// Places that prefer the second explanation.
    pub second: usize,
}

impl Contest {
    /// Counts the places, from the votes at points of image 1: positive for the first explanation, negative
    /// for the second, 0 for neither. The majority of the votes at a place decides.
    pub(super) fn of(votes: impl Iterator<Item = (Point, i32)>, frame: Frame) -> Self {
        let side = PLACE * frame.longer_side();
        let mut places: HashMap<[i64; 2], i32> = HashMap::new();
        for (at, vote) in votes {
            *places.entry([at.x, at.y].map(|v| (v / side).floor() as i64)).or_default() += vote.signum();
        }
        Self {
            first: places.values().filter(|sum| **sum > 0).count(),
            second: places.values().filter(|sum| **sum < 0).count(),
        }
    }

    /// Returns whether the first explanation is better than chance explains. Of the places that prefer it,
    /// `fitted` may do so because it was fitted to them: one for each fitted number.
    pub(super) fn first_wins(&self, fitted: usize) -> bool {
        let first = self.first.saturating_sub(fitted);
        at_least(first, first + self.second) <= BY_CHANCE
    }
}

/// Returns the probability of at least `some` of `all` events with probability ½ each.
fn at_least(some: usize, all: usize) -> f64 {
    let mut term = 0.5f64.powi(all.min(1000) as i32);
    let mut sum = 0.0;
    for k in 0..=all.min(1000) {
        if k >= some {
            sum += term;
        }
        term *= (all - k) as f64 / (k + 1) as f64;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_places_decide_and_neighbours_count_once() {
        let frame = Frame::new(1000, 800);
        let at = |k: usize| Point::new(50.0 + 100.0 * (k % 10) as f64, 50.0 + 100.0 * (k / 10) as f64);
        let votes = |first: usize, second: usize| {
            let all = (0..first + second).map(move |k| (at(k), if k < first { 1 } else { -1 }));
            Contest::of(all, frame)
        };
        assert_eq!(votes(9, 2), Contest { first: 9, second: 2 });
        assert!(votes(10, 0).first_wins(0) && !votes(9, 0).first_wins(0));
        assert!(votes(17, 0).first_wins(7) && !votes(16, 0).first_wins(7));
        assert!(!votes(17, 1).first_wins(7) && votes(30, 3).first_wins(7));
        assert!(!Contest::default().first_wins(0));
        let one_place = Contest::of((0..500).map(|_| (Point::new(7.0, 8.0), 1)), frame);
        assert_eq!(one_place, Contest { first: 1, second: 0 });
        let divided = Contest::of([1, -1, 0].into_iter().map(|vote| (Point::new(7.0, 8.0), vote)), frame);
        assert_eq!(divided, Contest::default());
    }

    #[test]
    fn the_tail_of_the_binomial_distribution_is_right() {
        assert!((at_least(0, 5) - 1.0).abs() < 1e-12);
        assert!((at_least(5, 5) - 1.0 / 32.0).abs() < 1e-12);
        assert!((at_least(3, 4) - 5.0 / 16.0).abs() < 1e-12);
    }
}
