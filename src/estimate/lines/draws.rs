//! Combinations of one candidate per click, drawn with a preference for cheap ones.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::Candidate;

/// Draws `count` different pairs of candidates, cheap ones more often; all of them when there are fewer.
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
    // Weighted sampling without replacement (Efraimidis & Spirakis 2006): the smallest −ln(u)/w win.
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let weights = [weights(p), weights(q)];
    let mut keys: Vec<(f64, usize)> = (0..total)
        .map(|k| {
            let weight = weights[0][k / q.len()] * weights[1][k % q.len()];
            let u: f64 = rng.random_range(f64::MIN_POSITIVE..1.0);
            (-u.ln() / weight, k)
        })
        .collect();
    keys.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0));
    keys.truncate(count);
    keys.sort_by_key(|(_, k)| *k);
    keys.into_iter().map(|(_, k)| (p[k / q.len()], q[k % q.len()])).collect()
}

/// Weight of each candidate: inverse square of its cost in units of the cheapest.
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
    fn few_combinations_are_all_taken_and_many_are_drawn_once_each_cheap_ones_more_often() {
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
}
