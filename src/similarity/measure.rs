//! The interface of line similarities, and the stereo similarity.

use rayon::prelude::*;

use super::{DisparityRange, Kernel, LANES, LaneBlock, StereoParameters};
use crate::geometry::AnchoredLine;
use crate::image::{GrayPlane, Profile};

/// Costs of the lines of one pencil against the lines of another.
#[derive(Debug, Clone, PartialEq)]
pub struct CostMatrix {
    rows: usize,
    columns: usize,
    costs: Vec<f32>,
}

impl CostMatrix {
    /// Creates a matrix of `rows × columns` costs, row by row. The cost is infinite for lines that
    /// were not compared.
    ///
    /// # Panics
    /// Panics if the number of costs is not `rows × columns`.
    pub fn new(rows: usize, columns: usize, costs: Vec<f32>) -> Self {
        assert_eq!(costs.len(), rows * columns, "one cost for each pair of lines");
        Self { rows, columns, costs }
    }

    /// Returns the number of lines of image 1.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the number of lines of image 2.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the cost of line `row` of image 1 against line `column` of image 2.
    pub fn at(&self, row: usize, column: usize) -> f32 {
        self.costs[row * self.columns + column]
    }

    /// Returns all costs of one line of image 1.
    pub fn row(&self, row: usize) -> &[f32] {
        &self.costs[row * self.columns..(row + 1) * self.columns]
    }

    /// Divides each cost by the geometric mean of the medians of its row and its column. Lines
    /// without texture, which match every line cheaply, are then no longer preferred.
    #[must_use]
    pub fn normalised(&self) -> Self {
        let row_medians: Vec<f32> =
            (0..self.rows).map(|r| finite_median(self.row(r).iter().copied())).collect();
        let column_medians: Vec<f32> =
            (0..self.columns).map(|c| finite_median((0..self.rows).map(|r| self.at(r, c)))).collect();
        let costs = (0..self.costs.len())
            .map(|k| {
                let scale = (row_medians[k / self.columns] * column_medians[k % self.columns]).sqrt();
                self.costs[k] / scale.max(f32::MIN_POSITIVE)
            })
            .collect();
        Self { costs, ..*self }
    }
}

/// Returns the median of the finite values; 1 if there are none.
fn finite_median(values: impl Iterator<Item = f32>) -> f32 {
    let mut finite: Vec<f32> = values.filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return 1.0;
    }
    let middle = finite.len() / 2;
    *finite.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// A measure of how well lines of two images match; lower costs are better.
///
/// The unit of the cost is up to the implementation, since costs of different implementations are
/// never compared.
pub trait LineSimilarity: Sync {
    /// Returns the costs of many line pairs, computed in parallel. The cost is infinite when a line
    /// misses its image. The cost of a pair does not depend on the other pairs.
    fn pair_costs(&self, pairs: &[(AnchoredLine, AnchoredLine)]) -> Vec<f32>;

    /// Returns the costs of every line of one pencil against every allowed line of the other,
    /// computed in parallel. `stop` is called between rows; once it returns true, the remaining
    /// costs stay infinite.
    fn cost_matrix(
        &self,
        lines1: &[AnchoredLine],
        lines2: &[AnchoredLine],
        allowed: &(dyn Fn(usize, usize) -> bool + Sync),
        stop: &(dyn Fn() -> bool + Sync),
    ) -> CostMatrix;

    /// Returns how informative each line of image `image` (0 or 1) is. Lines near 0 match every
    /// line.
    fn information(&self, image: usize, lines: &[AnchoredLine]) -> Vec<f64>;

    /// Returns the cost of a line pair in which one line misses its image.
    fn outside_cost(&self) -> f32;
}

/// A similarity by the stereo cost C* per sample, mean of both directions (paper, section 3), in
/// squared grey levels.
pub struct StereoSimilarity<'a> {
    /// The two images at the size of the comparison.
    pub planes: [&'a GrayPlane; 2],
    /// Disparities tried, in samples of 1 px.
    pub range: DisparityRange,
    /// Parameters of the stereo cost.
    pub parameters: StereoParameters,
}

/// Approximate ratio of the cost of matching a block to the cost of making it.
const PACKING: usize = 8;

impl StereoSimilarity<'_> {
    fn profiles(&self, image: usize, lines: &[AnchoredLine]) -> Vec<Profile> {
        lines.iter().map(|line| Profile::sample(self.planes[image], line, 1.0)).collect()
    }

    /// Returns the costs of each profile of `firsts` against the allowed profiles of `seconds`.
    fn one_way(
        &self,
        firsts: &[Profile],
        seconds: &[Profile],
        range: DisparityRange,
        allowed: &(dyn Fn(usize, usize) -> bool + Sync),
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Vec<f32> {
        let blocks: Vec<LaneBlock> = seconds.par_chunks(LANES).map(LaneBlock::new).collect();
        let mut costs = vec![f32::INFINITY; firsts.len() * seconds.len()];
        if seconds.is_empty() {
            return costs;
        }
        costs.par_chunks_mut(seconds.len()).enumerate().for_each_init(
            || Kernel::new(range, self.parameters),
            |kernel, (i, row)| {
                if stop() || firsts[i].is_empty() {
                    return;
                }
                let samples = firsts[i].len() as f32;
                let wanted: Vec<usize> =
                    (0..seconds.len()).filter(|j| allowed(i, *j) && !seconds[*j].is_empty()).collect();
                let touched = wanted.chunk_by(|a, b| a / LANES == b / LANES).count();
                // When few lines of each block are wanted, packing them into new blocks saves time.
                if PACKING * wanted.len().div_ceil(LANES) < (PACKING - 1) * touched {
                    for few in wanted.chunks(LANES) {
                        let block = LaneBlock::new(few.iter().map(|j| &seconds[*j]));
                        let totals = kernel.match_one(&firsts[i], &block);
                        for (j, total) in few.iter().zip(totals) {
                            row[*j] = total as f32 / samples;
                        }
                    }
                    return;
                }
                for (b, block) in blocks.iter().enumerate() {
                    let lanes = b * LANES..((b + 1) * LANES).min(seconds.len());
                    if !lanes.clone().any(|j| allowed(i, j)) {
                        continue;
                    }
                    let totals = kernel.match_one(&firsts[i], block);
                    for j in lanes.filter(|j| allowed(i, *j) && !seconds[*j].is_empty()) {
                        row[j] = totals[j % LANES] as f32 / samples;
                    }
                }
            },
        );
        costs
    }
}

impl LineSimilarity for StereoSimilarity<'_> {
    fn pair_costs(&self, pairs: &[(AnchoredLine, AnchoredLine)]) -> Vec<f32> {
        let kernels = || [self.range, self.range.reversed()].map(|range| Kernel::new(range, self.parameters));
        let costs = |[forward, backward]: &mut [Kernel; 2], chunk: &[(AnchoredLine, AnchoredLine)]| {
            let profile = |image: usize, line: &AnchoredLine| Profile::sample(self.planes[image], line, 1.0);
            let first: Vec<Profile> = chunk.iter().map(|(line1, _)| profile(0, line1)).collect();
            let second: Vec<Profile> = chunk.iter().map(|(_, line2)| profile(1, line2)).collect();
            let (block1, block2) = (LaneBlock::new(&first), LaneBlock::new(&second));
            let there = forward.match_lanes(&block1, &block2);
            let back = backward.match_lanes(&block2, &block1);
            let cost = |k: usize| {
                if first[k].is_empty() || second[k].is_empty() {
                    return f32::INFINITY;
                }
                0.5 * (there[k] as f32 / first[k].len() as f32 + back[k] as f32 / second[k].len() as f32)
            };
            (0..chunk.len()).map(cost).collect::<Vec<f32>>()
        };
        pairs.par_chunks(LANES).map_init(kernels, costs).flatten_iter().collect()
    }

    fn cost_matrix(
        &self,
        lines1: &[AnchoredLine],
        lines2: &[AnchoredLine],
        allowed: &(dyn Fn(usize, usize) -> bool + Sync),
        stop: &(dyn Fn() -> bool + Sync),
    ) -> CostMatrix {
        let (profiles1, profiles2) = (self.profiles(0, lines1), self.profiles(1, lines2));
        let there = self.one_way(&profiles1, &profiles2, self.range, allowed, stop);
        let back = self.one_way(&profiles2, &profiles1, self.range.reversed(), &|j, i| allowed(i, j), stop);
        let (rows, columns) = (lines1.len(), lines2.len());
        let costs = (0..rows * columns)
            .map(|k| 0.5 * (there[k] + back[(k % columns) * rows + k / columns]))
            .collect();
        CostMatrix::new(rows, columns, costs)
    }

    fn information(&self, image: usize, lines: &[AnchoredLine]) -> Vec<f64> {
        self.profiles(image, lines).iter().map(Profile::texture).collect()
    }

    fn outside_cost(&self) -> f32 {
        f32::from(self.parameters.outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Frame, Point};
    use crate::similarity::match_cost;

    fn planes() -> [GrayPlane; 2] {
        let texture = |x: usize, y: usize| ((x * x * 3 + y * y * 7 + x * y) % 253) as f32;
        let frame = Frame::new(64, 48);
        [GrayPlane::from_fn(frame, texture), GrayPlane::from_fn(frame, |x, y| texture(x + 3, y))]
    }

    fn pencil(count: usize) -> Vec<AnchoredLine> {
        (0..count).map(|k| AnchoredLine::at_angle(Point::new(30.0, 20.0), 0.13 * k as f64)).collect()
    }

    #[test]
    fn matrix_and_pairs_agree_with_the_reference() {
        let [plane1, plane2] = planes();
        let similarity = StereoSimilarity {
            planes: [&plane1, &plane2],
            range: DisparityRange { min: -6, max: 4 },
            parameters: StereoParameters::PAPER,
        };
        let (lines1, lines2) = (pencil(9), pencil(47));
        let matrix = similarity.cost_matrix(&lines1, &lines2, &|i, j| (i + j) % 5 != 0, &|| false);
        // Few lines of each block are wanted, so they are packed into new blocks.
        let sparse = similarity.cost_matrix(&lines1, &lines2, &|i, j| (i + j) % 9 == 0, &|| false);
        let all: Vec<_> = lines1.iter().flat_map(|a| lines2.iter().map(move |b| (*a, *b))).collect();
        let costs = similarity.pair_costs(&all);
        for i in 0..9 {
            for j in 0..47 {
                let (a, b) =
                    (Profile::sample(&plane1, &lines1[i], 1.0), Profile::sample(&plane2, &lines2[j], 1.0));
                let parameters = StereoParameters::PAPER;
                let there = match_cost(&a, &b, similarity.range, &parameters) as f32 / a.len() as f32;
                let back =
                    match_cost(&b, &a, similarity.range.reversed(), &parameters) as f32 / b.len() as f32;
                let expected = 0.5 * (there + back);
                assert!((costs[i * 47 + j] - expected).abs() < 1e-3);
                if (i + j) % 9 == 0 {
                    assert!((sparse.at(i, j) - expected).abs() < 1e-3);
                } else {
                    assert!(sparse.at(i, j).is_infinite());
                }
                if (i + j) % 5 == 0 {
                    assert!(matrix.at(i, j).is_infinite());
                } else {
                    assert!((matrix.at(i, j) - expected).abs() < 1e-3);
                }
            }
        }
    }

    #[test]
    fn normalising_takes_out_a_factor_of_a_line() {
        let costs: Vec<f32> = (0..12).map(|k| 1.0 + ((k * 7) % 5) as f32).collect();
        let mut scaled = costs.clone();
        for value in &mut scaled[4..8] {
            *value *= 10.0;
        }
        let (a, b) = (CostMatrix::new(3, 4, costs).normalised(), CostMatrix::new(3, 4, scaled));
        // The row medians scale with the row. The order within the row must stay.
        let b = b.normalised();
        let order = |m: &CostMatrix| {
            let mut order = [0, 1, 2, 3];
            order.sort_by(|x, y| m.at(1, *x).total_cmp(&m.at(1, *y)));
            order
        };
        assert_eq!(order(&a), order(&b));
        assert!(b.at(1, 0) < 3.2 * a.at(1, 0), "a dear row is no longer ten times dearer");
    }

    #[test]
    fn a_stopped_matrix_stays_infinite() {
        let [plane1, plane2] = planes();
        let similarity = StereoSimilarity {
            planes: [&plane1, &plane2],
            range: DisparityRange::symmetric(4),
            parameters: StereoParameters::PAPER,
        };
        let matrix = similarity.cost_matrix(&pencil(4), &pencil(4), &|_, _| true, &|| true);
        assert!(matrix.row(2).iter().all(|c| c.is_infinite()));
    }
}
