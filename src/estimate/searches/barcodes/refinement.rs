//! Refinement of all seven numbers of `F` on the barcodes of corresponding lines.
//!
//! The cost changes in steps, as lines cross other pixels, so the search uses no derivatives. Steps
//! are drawn from a Gaussian, and the best ones give the next Gaussian (cross-entropy method,
//! Rubinstein 1999). They depend on the seed alone, not on the order of threads.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::agreement::Pencils;
use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::estimate::sampling::{Purpose, stream};
use crate::geometry::{FundamentalMatrix, PointPair, Vector7, sampson_distance};
use crate::motion::Silhouettes;

/// Extent of the search.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    /// Standard deviation of the first steps, as a share of half a diagonal.
    pub first: f64,
    pub rounds: usize,
}

/// Steps of a search that starts at a proposal of lines: a few per cent of the side.
pub(super) const FROM_AFAR: Steps = Steps { first: 0.015, rounds: 8 };
/// Steps of a search that starts at a refined geometry: a fifth of [`FROM_AFAR`].
pub(super) const NEARBY: Steps = Steps { first: 0.003, rounds: 10 };

/// Number of samples in a round: about six for each of seven unknowns.
const POPULATION: usize = 40;
/// Number of best samples of a round that give the next one: a fifth of the samples, and one more
/// than the unknowns.
const ELITE: usize = 8;
/// Share of the previous deviation that is kept, so that the search does not settle too early.
const INERTIA: f64 = 0.3;

/// Objective of the refinement: the disagreement of barcodes, and the distances of clicks.
#[derive(Clone, Copy)]
pub(super) struct Objective<'a> {
    pub silhouettes: [&'a Silhouettes; 2],
    pub clicks: &'a [PointPair],
    pub click_sigma: f64,
    pub events: f64,
}

/// Refined geometry in full-size pixels, and its objective; lower is better.
#[derive(Debug, Clone)]
pub(super) struct RefinedByBarcodes {
    pub fundamental: FundamentalMatrix,
    pub value: f64,
    /// The start, and the best geometry after each round, with their objectives.
    pub course: Vec<(FundamentalMatrix, f64)>,
}

impl RefinedByBarcodes {
    /// Returns the support of the geometry at the start and after each round: the logarithm of its likelihood over
    /// that of unrelated barcodes, at least 0.
    pub fn support(&self) -> impl Iterator<Item = f64> {
        self.course.iter().map(|(_, value)| (-value).max(0.0))
    }
}

impl Objective<'_> {
    /// Returns the negative log-likelihood up to a constant. The time of each event has a
    /// Laplace-distributed error of unknown spread, which gives `events · ln cost`. Clicks have
    /// Gaussian errors, whose influence is bounded at four deviations. `events` are counted once,
    /// at the start of the search.
    fn value(&self, f: &FundamentalMatrix) -> f64 {
        let Some(pencils) = Pencils::new(self.silhouettes, f) else { return f64::INFINITY };
        let off = |pair: &PointPair| (sampson_distance(f, pair) / self.click_sigma).powi(2).min(16.0);
        self.events * pencils.cost().max(1e-9).ln() + 0.5 * self.clicks.iter().map(off).sum::<f64>()
    }
}

/// Returns the best geometry near a start. `None` if the geometries there have no lines.
pub(super) fn refine(
    objective: &Objective,
    start: &FundamentalMatrix,
    search: Steps,
    seed: u64,
    task: u64,
    cancel: &CancelFlag,
) -> Result<Option<RefinedByBarcodes>, EstimateError> {
    let frames = objective.silhouettes.map(Silhouettes::full_size);
    let mut random = stream(seed, Purpose::BarcodeRefinement, task);
    let (mut best, mut value) = (*start, objective.value(start));
    let mut course = vec![(best, value)];
    let (mut mean, mut deviation) = (Vector7::zeros(), Vector7::repeat(search.first));
    for _ in 0..search.rounds {
        let steps: Vec<Vector7> =
            (0..POPULATION).map(|_| mean + deviation.component_mul(&gaussian(&mut random))).collect();
        let mut tried: Vec<(f64, Vector7, FundamentalMatrix)> = steps
            .into_par_iter()
            .filter_map(|step| {
                let moved = start.moved(&step, frames)?;
                Some((objective.value(&moved), step, moved))
            })
            .collect();
        cancel.check()?;
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some((tried_value, _, fundamental)) = tried.first().copied() else { return Ok(None) };
        if tried_value < value {
            (best, value) = (fundamental, tried_value);
        }
        course.push((best, value));
        tried.truncate(ELITE);
        let count = tried.len() as f64;
        mean = tried.iter().map(|t| t.1).sum::<Vector7>() / count;
        let spread = tried.iter().map(|t| (t.1 - mean).map(|v| v * v)).sum::<Vector7>() / count;
        deviation = deviation * INERTIA + spread.map(f64::sqrt) * (1.0 - INERTIA);
    }
    Ok(Some(RefinedByBarcodes { fundamental: best, value, course }))
}

/// Returns seven nearly Gaussian numbers, each a sum of twelve uniform ones.
fn gaussian(random: &mut Pcg64Mcg) -> Vector7 {
    Vector7::from_fn(|_, _| (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0)
}

#[cfg(test)]
mod tests {
    use super::super::exact::{FRAME, bands, by_itself};
    use rand::SeedableRng;

    use super::*;
    use crate::estimate::exact::rows;

    #[test]
    fn clicks_count_up_to_four_deviations_and_barcodes_by_their_events() {
        let seen = bands(100, by_itself);
        let value = |clicks: &[PointPair], events: f64, shift: f64| {
            Objective { silhouettes: [&seen, &seen], clicks, click_sigma: 2.0, events }.value(&rows(shift))
        };
        // A click 3 px off its row has the Sampson distance 3/√2.
        let off = |by: f64| PointPair::new(10.0, 10.0, 20.0, 10.0 + by);
        assert!((value(&[off(3.0)], 0.0, 0.0) - 0.5 * 4.5 / 4.0).abs() < 1e-9);
        assert!((value(&[off(0.0), off(30.0)], 0.0, 0.0) - 8.0).abs() < 1e-9, "bounded");
        let cost = Pencils::new([&seen, &seen], &rows(9.0)).unwrap().cost();
        assert!((value(&[], 7.0, 9.0) - 7.0 * cost.ln()).abs() < 1e-9);
        assert!(value(&[], 7.0, 0.0).is_finite(), "equal barcodes");
    }

    #[test]
    fn a_start_a_few_pixels_off_is_refined_until_barcodes_agree() {
        let seen = bands(200, by_itself);
        let objective =
            Objective { silhouettes: [&seen, &seen], clicks: &[], click_sigma: 1.0, events: 50.0 };
        let search = |seed: u64| {
            let far = Steps { first: 0.05, ..FROM_AFAR };
            refine(&objective, &rows(2.0), far, seed, 0, &CancelFlag::default()).unwrap().unwrap()
        };
        let found = search(1);
        assert!(found.value < objective.value(&rows(2.0)) - 50.0, "{}", found.value);
        for x in [0.0, FRAME.right()] {
            for y in [2.0, 22.0, 42.0] {
                let off = sampson_distance(&found.fundamental, &PointPair::new(x, y, 32.0, y));
                assert!(off < 1.5, "{off} px at {x}, {y}");
            }
        }
        assert_eq!(found.fundamental, search(1).fundamental, "the seed decides");
        let course = &found.course;
        assert_eq!((course.len(), course[0].0), (FROM_AFAR.rounds + 1, rows(2.0)));
        assert!(course.is_sorted_by(|a, b| a.1 >= b.1));
        assert_eq!(course.last(), Some(&(found.fundamental, found.value)));
        assert!(found.support().all(|support| support >= 0.0));
        let stopped = CancelFlag::default();
        stopped.cancel();
        let stopped = refine(&objective, &rows(2.0), NEARBY, 1, 0, &stopped);
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }

    #[test]
    fn drawn_steps_have_unit_deviation() {
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let drawn: Vec<f64> =
            (0..1000).flat_map(|_| gaussian(&mut random).iter().copied().collect::<Vec<_>>()).collect();
        let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
        let variance = drawn.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / drawn.len() as f64;
        // Four deviations: those of mean and variance of 7000 numbers are 1/84 and √2/84.
        assert!(mean.abs() < 0.05 && (variance - 1.0).abs() < 0.07, "{mean} {variance}");
    }
}
