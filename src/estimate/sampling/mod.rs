//! Parts of a search by random samples.
//!
//! | role | here | of the caller |
//! |---|---|---|
//! | sampler | [`Weighted`], [`different`] | data to draw from |
//! | minimal solver | | [`Draws::collect`] calls it for each sample |
//! | consensus | [`best`] | score of a model |
//! | local optimisation | [`refitted`] | fit to what agrees with a model |
//!
//! The roles are those of RANSAC with local optimisation (Fischler & Bolles 1981; Chum, Matas &
//! Kittler 2003).

mod stream;

pub(super) use stream::{Purpose, stream};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Samples that run in parallel tasks, each with a stream of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draws {
    pub seed: u64,
    pub purpose: Purpose,
    /// Index of the stream of the first task. The next tasks take the next indices.
    pub first: u64,
    /// Number of samples, rounded up to whole tasks.
    pub count: usize,
    pub task: usize,
}

impl Draws {
    /// Returns the models of all samples, in the order of the samples on any number of threads.
    /// `solve` draws one sample and returns its models.
    pub fn collect<M, I>(&self, solve: impl Fn(&mut Pcg64Mcg) -> I + Sync) -> Vec<M>
    where
        M: Send,
        I: IntoIterator<Item = M>,
    {
        let task = |index: usize| {
            let mut random = stream(self.seed, self.purpose, self.first + index as u64);
            let mut models = Vec::new();
            (0..self.task).for_each(|_| models.extend(solve(&mut random)));
            models
        };
        (0..self.count.div_ceil(self.task)).into_par_iter().flat_map_iter(task).collect()
    }
}

/// Sampler that draws indices by weight.
#[derive(Debug, Clone)]
pub(super) struct Weighted {
    /// Sums of the weights up to each index.
    sums: Vec<f64>,
}

impl Weighted {
    pub fn new(weights: impl Iterator<Item = f64>) -> Self {
        let running = |sum: &mut f64, weight: f64| {
            *sum += weight;
            Some(*sum)
        };
        Self { sums: weights.scan(0.0, running).collect() }
    }

    /// Draws an index. Returns `None` when all weights are zero.
    pub fn draw(&self, random: &mut Pcg64Mcg) -> Option<usize> {
        let total = self.sums.last().copied().filter(|total| *total > 0.0)?;
        // Drawn once: a number for each comparison would give another distribution.
        let at = random.random_range(0.0..total);
        Some(self.sums.partition_point(|sum| *sum <= at).min(self.sums.len() - 1))
    }
}

/// Draws `N` different indices below `count`, all equally likely. `count` must be at least `N`.
pub(super) fn different<const N: usize>(count: usize, random: &mut Pcg64Mcg) -> [usize; N] {
    let mut drawn = [0; N];
    for n in 0..N {
        loop {
            drawn[n] = random.random_range(0..count);
            if !drawn[..n].contains(&drawn[n]) {
                break;
            }
        }
    }
    drawn
}

/// Returns the `count` models with the highest scores, best first. Of equals, the first drawn wins.
pub(super) fn best<M>(mut scored: Vec<(f64, M)>, count: usize) -> Vec<(f64, M)> {
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.truncate(count);
    scored
}

/// Refits a model up to `rounds` times and returns the best of all, with its score. `refit` gets
/// the last model and the number of the round. It returns `None` to end.
///
/// A refit may lower the score for a round and raise it later, so it goes on from the last model.
pub(super) fn refitted<S: PartialOrd, M>(
    start: (S, M),
    rounds: usize,
    refit: impl Fn(&(S, M), usize) -> Option<(S, M)>,
) -> (S, M) {
    let mut best = start;
    let mut worse: Option<(S, M)> = None;
    for round in 0..rounds {
        let Some(next) = refit(worse.as_ref().unwrap_or(&best), round) else { break };
        if next.0 > best.0 {
            (best, worse) = (next, None);
        } else {
            worse = Some(next);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn samples_come_in_the_same_order_on_any_number_of_threads() {
        let draws = Draws { seed: 4, purpose: Purpose::MatchSamples, first: 7, count: 95, task: 10 };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draws.collect(|random| Some(random.random::<u64>())))
        };
        let one = on(1);
        assert_eq!(one.len(), 100, "whole tasks");
        assert_eq!(one, on(5));
        assert_eq!(one[10], stream(4, Purpose::MatchSamples, 8).random::<u64>(), "a stream for each task");
    }

    #[test]
    fn weights_decide_how_often_an_index_is_drawn() {
        let mut random = Pcg64Mcg::seed_from_u64(2);
        let weights = [0.0, 1.0, 0.0, 3.0];
        let sampler = Weighted::new(weights.into_iter());
        let mut times = [0; 4];
        (0..4000).for_each(|_| times[sampler.draw(&mut random).unwrap()] += 1);
        assert_eq!([times[0], times[2]], [0, 0]);
        // Three standard deviations of a binomial distribution.
        assert!((1000 - 82..=1000 + 82).contains(&times[1]), "{times:?}");
        for none in [&[][..], &[0.0, 0.0]] {
            assert_eq!(Weighted::new(none.iter().copied()).draw(&mut random), None);
        }
    }

    #[test]
    fn different_indices_are_different() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        for _ in 0..50 {
            let mut drawn = different::<7>(7, &mut random);
            drawn.sort_unstable();
            assert_eq!(drawn, [0, 1, 2, 3, 4, 5, 6]);
        }
    }

    #[test]
    fn the_first_of_equals_comes_first() {
        assert_eq!(best(vec![(1.0, 'a'), (2.0, 'b'), (2.0, 'c')], 2), [(2.0, 'b'), (2.0, 'c')]);
    }

    #[test]
    fn a_refit_passes_over_a_worse_model() {
        let path = [(3, 'a'), (2, 'b'), (5, 'c'), (4, 'd')];
        let next = |_: &(i32, char), round: usize| path.get(round).copied();
        assert_eq!(refitted((1, 'z'), 10, next), (5, 'c'));
        assert_eq!(refitted((1, 'z'), 2, next), (3, 'a'));
        assert_eq!(refitted((9, 'z'), 10, next), (9, 'z'));
    }
}
