//! Random combinations of one candidate per click, cheap ones more often.

use rand::RngExt;

use super::Candidate;
use crate::estimate::sampling::{Purpose, stream};

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
    let weights = [weights(p), weights(q)];
    let mut limit = limit(&weights, count);
    let mut keys = keys_below(limit, &weights, seed);
    while keys.len() < count && limit.is_finite() {
        limit *= 2.0;
        keys = keys_below(limit, &weights, seed);
    }
    if keys.len() > count {
        keys.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0));
        keys.truncate(count);
    }
    keys.sort_by_key(|(_, k)| *k);
    keys.into_iter().map(|(_, k)| (p[k / q.len()], q[k % q.len()])).collect()
}

/// Returns the keys below a limit, with the indices of their pairs.
fn keys_below(limit: f64, weights: &[Vec<f64>; 2], seed: u64) -> Vec<(f64, usize)> {
    let mut rng = stream(seed, Purpose::CandidatePairs, 0);
    let mut keys = Vec::new();
    for (row, own) in weights[0].iter().enumerate() {
        for (column, other) in weights[1].iter().enumerate() {
            let (weight, u) = (own * other, rng.random_range(f64::MIN_POSITIVE..1.0));
            // −ln u is at least 1 − u: few logarithms are needed.
            if 1.0 - u < limit * weight {
                let key = -u.ln() / weight;
                if key < limit {
                    keys.push((key, row * weights[1].len() + column));
                }
            }
        }
    }
    keys
}

/// Number of weights of each click from which a limit is estimated. It affects the time only.
const LOOKED_AT: usize = 24;
/// Expected number of keys below the limit, for each key wanted. It affects the time only.
const SPARE: f64 = 1.3;
/// Largest expected share of keys below the limit. No finite limit has all keys below it.
const LARGEST_SHARE: f64 = 0.99;
/// Smallest and largest limit tried, far enough apart for any number of candidates. The cheapest
/// pairs weigh 1, so their keys are about 1.
const LIMITS: [f64; 2] = [1e-6, 1e12];
/// Factor from one limit to the next. It affects the time only.
const NEXT_LIMIT: f64 = 1.25;

/// Returns a limit with slightly more keys below it than wanted, in expectation. A key of weight w
/// is below t with probability `1 − exp(−w t)`.
fn limit(weights: &[Vec<f64>; 2], count: usize) -> f64 {
    let [few_p, few_q] = weights
        .each_ref()
        .map(|all| -> Vec<f64> { all.iter().step_by(all.len().div_ceil(LOOKED_AT)).copied().collect() });
    let total = weights[0].len() as f64 * weights[1].len() as f64;
    let share = (SPARE * count as f64 / total).min(LARGEST_SHARE);
    let wanted = share * (few_p.len() * few_q.len()) as f64;
    let below = |limit: f64| -> f64 {
        few_p.iter().flat_map(|a| few_q.iter().map(move |b| 1.0 - (-a * b * limit).exp())).sum()
    };
    let mut limit = LIMITS[0];
    while below(limit) < wanted && limit < LIMITS[1] {
        limit *= NEXT_LIMIT;
    }
    limit
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
        let mut all = keys_below(f64::INFINITY, &all_weights, seed);
        assert_eq!(all.len(), 70 * 70);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        for count in [1, 50, 1000, 4899] {
            let mut expected: Vec<usize> = all[..count].iter().map(|(_, k)| *k).collect();
            expected.sort_unstable();
            let drawn = draw_pairs([&p, &q], count, seed);
            let number = |(a, b): &(Candidate, Candidate)| a.angles[0] as usize * 70 + b.angles[0] as usize;
            assert_eq!(drawn.iter().map(number).collect::<Vec<_>>(), expected);
        }
    }
}
