//! Random combinations of one candidate per click, cheap ones more often.

use rand::RngExt;

use super::{Candidate, PencilAngles};
use crate::estimate::sampling::{Purpose, stream};
use crate::estimate::{Origin, ProposedBy};

/// Draws `count` different pairs of candidates, cheap ones more often. Returns all pairs when there
/// are fewer.
pub(in crate::estimate) fn draw_pairs(
    candidates: [&[Candidate]; 2],
    count: usize,
    seed: u64,
) -> Vec<(Candidate, Candidate)> {
    let [p, q] = candidates;
    let total = p.len() * q.len();
    if total <= count {
        return p.iter().flat_map(|a| q.iter().map(move |b| (*a, *b))).collect();
    }
    // Weighted sampling without replacement (Efraimidis & Spirakis 2006): the smallest −ln(u)/w
    // win.
    let mut keys = smallest_keys(count, &[weights(p), weights(q)], seed);
    keys.sort_by_key(|(_, k)| *k);
    keys.into_iter().map(|(_, k)| (p[k / q.len()], q[k % q.len()])).collect()
}

/// Returns the origin of a geometry from a candidate of each anchor.
pub(in crate::estimate) fn of_line_pairs(angles: &PencilAngles, candidates: [&[Candidate]; 2]) -> Origin {
    let rank = |candidates: &[Candidate], angles: [f64; 2]| {
        let is_same = |one: &Candidate| one.angles.map(f64::to_bits) == angles.map(f64::to_bits);
        1 + candidates.iter().position(is_same).unwrap_or(candidates.len())
    };
    let ranks = [rank(candidates[0], angles.p), rank(candidates[1], angles.q)];
    ProposedBy::LinePairs { ranks }.into()
}

/// Returns the smallest `count` keys, with the indices of their pairs.
fn smallest_keys(count: usize, weights: &[Vec<f64>; 2], seed: u64) -> Vec<(f64, usize)> {
    let mut rng = stream(seed, Purpose::CandidatePairs, 0);
    let mut keys: Vec<(f64, usize)> = Vec::new();
    // No larger key is among the smallest.
    let mut limit = f64::INFINITY;
    for (row, own) in weights[0].iter().enumerate() {
        for (column, other) in weights[1].iter().enumerate() {
            let (weight, u) = (own * other, rng.random_range(f64::MIN_POSITIVE..1.0));
            // −ln u is at least 1 − u: few logarithms are needed.
            if 1.0 - u < limit * weight {
                keys.push((-u.ln() / weight, row * weights[1].len() + column));
            }
            if keys.len() >= 2 * count {
                limit = keys.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0)).1.0;
                keys.truncate(count);
            }
        }
    }
    keys.sort_by(|a, b| a.0.total_cmp(&b.0));
    keys.truncate(count);
    keys
}

/// Returns the weight of each candidate: the inverse square of its cost in units of the cheapest.
fn weights(candidates: &[Candidate]) -> Vec<f64> {
    let cheapest = candidates.iter().map(|c| f64::from(c.cost)).fold(f64::INFINITY, f64::min).max(1e-9);
    candidates.iter().map(|c| (cheapest / f64::from(c.cost).max(1e-9)).powi(2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidates(costs: &[f32]) -> Vec<Candidate> {
        costs
            .iter()
            .enumerate()
            .map(|(k, cost)| Candidate { angles: [k as f64, k as f64], cost: *cost })
            .collect()
    }

    #[test]
    fn draws_do_not_repeat_and_prefer_cheap_candidates() {
        let (p, q) = (candidates(&[1.0, 2.0, 4.0]), candidates(&[1.0; 40]));
        assert_eq!(draw_pairs([&p, &q], 120, 5).len(), 120);
        let mut of_each = [0; 3];
        for seed in 0..50 {
            let drawn = draw_pairs([&p, &q], 30, seed);
            assert_eq!(drawn, draw_pairs([&p, &q], 30, seed), "the seed decides");
            let mut numbers: Vec<[u64; 2]> =
                drawn.iter().map(|(a, b)| [a.angles[0].to_bits(), b.angles[0].to_bits()]).collect();
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers.len(), 30, "without replacement");
            for (a, _) in &drawn {
                of_each[a.angles[0] as usize] += 1;
            }
        }
        assert!(of_each[0] > 2 * of_each[1] && of_each[1] > 2 * of_each[2], "{of_each:?}");
    }

    #[test]
    fn the_smallest_keys_win() {
        let costs =
            |turn: f32| -> Vec<f32> { (0..70).map(|k| 1.0 + (k as f32 * turn).sin().abs() * 3.0).collect() };
        let (p, q) = (candidates(&costs(0.7)), candidates(&costs(1.1)));
        let (all_weights, seed) = ([weights(&p), weights(&q)], 11);
        let all = smallest_keys(70 * 70, &all_weights, seed);
        assert_eq!(all.len(), 70 * 70);
        for count in [1, 50, 1000, 4899] {
            let mut expected: Vec<usize> = all[..count].iter().map(|(_, k)| *k).collect();
            expected.sort_unstable();
            let drawn = draw_pairs([&p, &q], count, seed);
            let number = |(a, b): &(Candidate, Candidate)| a.angles[0] as usize * 70 + b.angles[0] as usize;
            assert_eq!(drawn.iter().map(number).collect::<Vec<_>>(), expected);
        }
    }
}
