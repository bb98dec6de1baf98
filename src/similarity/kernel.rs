//! The vectorised stereo cost: C* of 32 line pairs at once.
//!
//! The results equal those of [`super::match_cost`], bit for bit. The recurrence is sequential both
//! along the samples of a line and along the disparities, so the vector lanes are *line pairs*. The
//! sequential prefix minimum over disparities then costs one operation for all 32 pairs.
//!
//! ```text
//!     best  = min( S[d], S[d−k] + λk² (k < √(α/λ)), S[d+1] + min(λ, α), min over d' ≤ d of S[d'] + α )
//!     S'[d] = best − lowest + φ
//! ```
//!
//! The code is plain loops over fixed-size arrays, without `unsafe`. The `multiversion` crate
//! compiles it once per instruction set and selects a version at run time. The vector ALUs bound
//! the throughput, at about 15 operations per cell (see `cargo bench`). Loads and the 6 KB of state
//! stay in the first-level cache.
//!
//! # Pitfalls
//! Lanes differ in length. A sample missing in a lane of the first block costs 0 and leaves the
//! minimum unchanged, so the lane's total is exact. A sample missing in a lane of the second block
//! counts as outside.

use multiversion::multiversion;

use super::{DisparityRange, Ordering, StereoParameters};
use crate::image::Profile;

/// Line pairs matched at once: two vectors of 16 in 256-bit registers, one of 32 in 512-bit
/// registers.
pub const LANES: usize = 32;

type Row = [u16; LANES];

/// Up to [`LANES`] profiles interleaved sample by sample, with a common index 0.
#[derive(Debug, Clone)]
pub struct LaneBlock {
    /// Sample index of `rows[1]`. The first and the last row are outside every lane.
    first: i32,
    values: Vec<Row>,
    /// All ones where the lane has a sample, zero elsewhere.
    present: Vec<Row>,
}

impl LaneBlock {
    /// Interleaves profiles.
    ///
    /// # Panics
    /// Panics if there are more than [`LANES`] profiles.
    pub fn new<'a>(profiles: impl IntoIterator<Item = &'a Profile>) -> Self {
        let mut lanes = [None; LANES];
        for (count, profile) in profiles.into_iter().enumerate() {
            assert!(count < LANES, "at most {LANES} profiles a block");
            lanes[count] = Some(profile);
        }
        let filled = || lanes.iter().flatten().filter(|p| !p.is_empty());
        let first = filled().map(|p| p.first).min().unwrap_or(0);
        let end = filled().map(|p| p.end()).max().unwrap_or(0);
        let len = (end - first) as usize + 2;
        let mut values = vec![[0; LANES]; len];
        let mut present = vec![[0; LANES]; len];
        for (lane, profile) in lanes.iter().enumerate() {
            let Some(profile) = profile else { continue };
            let offset = (profile.first - first + 1).max(0) as usize;
            for (k, value) in profile.values.iter().enumerate() {
                values[offset + k][lane] = u16::from(*value);
                present[offset + k][lane] = u16::MAX;
            }
        }
        Self { first, values, present }
    }

    fn samples(&self) -> usize {
        self.values.len() - 2
    }
}

/// The matcher of line blocks. A kernel keeps its working memory between calls.
#[derive(Debug, Clone)]
pub struct Kernel {
    range: DisparityRange,
    parameters: StereoParameters,
    states: [Vec<Row>; 2],
}

impl Kernel {
    /// Creates a kernel for one disparity range and one set of parameters.
    pub fn new(range: DisparityRange, parameters: StereoParameters) -> Self {
        let margin = margin(&parameters, range);
        let rows = vec![[u16::MAX; LANES]; range.len() + 2 * margin];
        Self { range, parameters, states: [rows.clone(), rows] }
    }

    /// Returns C* of one profile against each lane of a block.
    pub fn match_one(&mut self, a: &Profile, b: &LaneBlock) -> [u32; LANES] {
        self.run(&First::One(a), b)
    }

    /// Returns C* of each lane of `a` against the same lane of `b`.
    pub fn match_lanes(&mut self, a: &LaneBlock, b: &LaneBlock) -> [u32; LANES] {
        self.run(&First::Lanes(a), b)
    }

    fn run(&mut self, a: &First, b: &LaneBlock) -> [u32; LANES] {
        let margin = margin(&self.parameters, self.range);
        for states in &mut self.states {
            states[margin..margin + self.range.len()].fill([0; LANES]);
        }
        let [old, new] = &mut self.states;
        run_block(&self.parameters, self.range, a, b, old, new)
    }
}

/// Returns the number of rows of `u16::MAX` on each side of the states, for jumps from beyond the
/// range.
fn margin(parameters: &StereoParameters, range: DisparityRange) -> usize {
    parameters.explicit_changes(range).max(1)
}

enum First<'a> {
    One(&'a Profile),
    Lanes(&'a LaneBlock),
}

/// Costs of a step of the recurrence.
struct Recurrence<'a> {
    truncation: u16,
    outside: u16,
    /// Cost of the largest disparity changes.
    jump: u16,
    /// Cost of a disparity change by `k` in `changes[k − 1]`.
    changes: &'a [u16],
    /// Cost of a disparity change by −1.
    back: u16,
    ordering: Ordering,
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn run_block(
    parameters: &StereoParameters,
    range: DisparityRange,
    a: &First,
    b: &LaneBlock,
    old: &mut Vec<Row>,
    new: &mut Vec<Row>,
) -> [u32; LANES] {
    let changes: Vec<u16> = (1..=margin(parameters, range))
        .map(|k| parameters.change_cost(k as i32).unwrap_or(u16::MAX))
        .collect();
    let step = Recurrence {
        truncation: parameters.truncation,
        outside: parameters.outside,
        jump: parameters.jump_cost(),
        changes: &changes,
        back: parameters.change_cost(-1).unwrap_or(u16::MAX),
        ordering: parameters.ordering,
    };
    // The two presets have specialised code; other parameters use the general loop.
    match (parameters.ordering, changes.len(), a) {
        (Ordering::Positions, 1, First::One(_)) => sweep::<1, true>(&step, range, a, b, old, new),
        (Ordering::Positions, 2, First::One(_)) => sweep::<2, true>(&step, range, a, b, old, new),
        (Ordering::Positions, 1, First::Lanes(_)) => sweep::<1, false>(&step, range, a, b, old, new),
        (Ordering::Positions, 2, First::Lanes(_)) => sweep::<2, false>(&step, range, a, b, old, new),
        (_, _, First::One(_)) => sweep::<0, true>(&step, range, a, b, old, new),
        (_, _, First::Lanes(_)) => sweep::<0, false>(&step, range, a, b, old, new),
    }
}

/// Processes all samples of the first lines. `K` is the number of explicit changes, 0 for the
/// general loop; `ONE` means a single first profile.
#[inline(always)]
#[expect(clippy::inline_always, reason = "must be compiled once per instruction set, inside `run_block`")]
fn sweep<const K: usize, const ONE: bool>(
    step: &Recurrence,
    range: DisparityRange,
    a: &First,
    b: &LaneBlock,
    old: &mut Vec<Row>,
    new: &mut Vec<Row>,
) -> [u32; LANES] {
    let mut totals = [0u32; LANES];
    let mut lowest = [0u16; LANES];
    let (first, count) = match a {
        First::One(profile) => (profile.first, profile.len()),
        First::Lanes(block) => (block.first, block.samples()),
    };
    for i in 0..count {
        for (total, low) in totals.iter_mut().zip(&lowest) {
            *total += u32::from(*low);
        }
        let (value, has) = match a {
            First::One(profile) => ([u16::from(profile.values[i]); LANES], [u16::MAX; LANES]),
            First::Lanes(block) => (block.values[i + 1], block.present[i + 1]),
        };
        // Row of the second block at disparity `range.min`.
        let offset = first + i as i32 + range.min - b.first + 1;
        lowest = advance::<K, ONE>(step, &value, &has, &lowest, offset, b, old, new);
        std::mem::swap(old, new);
    }
    for (total, low) in totals.iter_mut().zip(&lowest) {
        *total += u32::from(*low);
    }
    totals
}

/// Advances all disparities by one sample along the lines.
#[inline(always)]
#[expect(clippy::inline_always, reason = "must be compiled once per instruction set, inside `run_block`")]
#[expect(clippy::too_many_arguments, reason = "the hot loop's registers, named")]
fn advance<const K: usize, const ONE: bool>(
    step: &Recurrence,
    value: &Row,
    has: &Row,
    lowest: &Row,
    offset: i32,
    b: &LaneBlock,
    old: &[Row],
    new: &mut [Row],
) -> Row {
    let margin = step.changes.len();
    let last = b.values.len() as i32 - 1;
    let mut prefix = [u16::MAX; LANES];
    let mut next_lowest = [u16::MAX; LANES];
    let count = old.len() - 2 * margin;
    for d in 0..count {
        let row = (offset + d as i32).clamp(0, last) as usize;
        let (other, present) = (&b.values[row], &b.present[row]);
        let at = d + margin;
        let mut best = old[at];
        for (prefix, state) in prefix.iter_mut().zip(&best) {
            *prefix = (*prefix).min(*state);
        }
        if K == 0 {
            let is_free = step.ordering == Ordering::Free;
            let least = if is_free { lowest } else { &prefix };
            for (k, cost) in step.changes.iter().enumerate() {
                // Costs grow with k, and no state is below the least. Checked at every fourth
                // change, as a check costs as much as a change.
                if k % 4 == 0 && !any_below(least, *cost, &best) {
                    break;
                }
                relax(&mut best, &old[at - k - 1], *cost);
                if is_free {
                    relax(&mut best, &old[at + k + 1], *cost);
                }
            }
            if step.ordering == Ordering::Positions {
                relax(&mut best, &old[at + 1], step.back);
            }
        } else {
            for k in 0..K {
                relax(&mut best, &old[at - k - 1], step.changes[k]);
            }
            relax(&mut best, &old[at + 1], step.back);
        }
        let target = &mut new[at];
        for l in 0..LANES {
            let jump = if K == 0 && step.ordering == Ordering::Free { lowest[l] } else { prefix[l] };
            let reached = best[l].min(jump.saturating_add(step.jump)) - lowest[l];
            let difference = value[l].wrapping_sub(other[l]);
            let inside = difference.wrapping_mul(difference).min(step.truncation);
            let mut cost = (inside & present[l]) | (step.outside & !present[l]);
            if !ONE {
                cost &= has[l];
            }
            let state = reached.saturating_add(cost);
            next_lowest[l] = next_lowest[l].min(state);
            target[l] = state;
        }
    }
    next_lowest
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "must be compiled once per instruction set, inside `run_block`")]
fn relax(best: &mut Row, from: &Row, cost: u16) {
    for l in 0..LANES {
        best[l] = best[l].min(from[l].saturating_add(cost));
    }
}

/// Returns whether `least` and a cost are below `best` in any lane. It looks at all lanes, since a
/// search for the first one would not be vectorised.
#[inline(always)]
#[expect(clippy::inline_always, reason = "must be compiled once per instruction set, inside `run_block`")]
fn any_below(least: &Row, cost: u16, best: &Row) -> bool {
    let mut below = 0u16;
    for l in 0..LANES {
        below |= best[l].saturating_sub(least[l].saturating_add(cost));
    }
    below != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::similarity::match_cost;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn parameter_sets() -> Vec<StereoParameters> {
        let base = StereoParameters::PAPER;
        let mut sets = Vec::new();
        for ordering in [Ordering::Positions, Ordering::Free, Ordering::Disparities] {
            for (lambda, alpha) in [
                (2, 3),
                (400, 2000),
                (50, 200),
                (7, 5),
                (0, 0),
                (0, 2000),
                (1, 20_000),
                (3, 1000),
                (65_535, 65_535),
            ] {
                sets.push(StereoParameters { lambda, alpha, ordering, ..base });
            }
        }
        sets.push(StereoParameters { truncation: 65_025, outside: 40_000, ..base });
        sets.push(StereoParameters { truncation: 0, outside: 0, ..base });
        sets
    }

    fn check(a: &[Profile], b: &[Profile], range: DisparityRange, parameters: StereoParameters) {
        let mut kernel = Kernel::new(range, parameters);
        let (block_a, block_b) = (LaneBlock::new(a), LaneBlock::new(b));
        let lanes = kernel.match_lanes(&block_a, &block_b);
        for (k, (x, y)) in a.iter().zip(b).enumerate() {
            let expected = match_cost(x, y, range, &parameters);
            assert_eq!(u64::from(lanes[k]), expected, "lane {k} {range:?} {parameters:?}");
        }
        let one = kernel.match_one(&a[0], &block_b);
        for (k, y) in b.iter().enumerate() {
            let expected = match_cost(&a[0], y, range, &parameters);
            assert_eq!(u64::from(one[k]), expected, "one, lane {k} {range:?} {parameters:?}");
        }
    }

    fn random(rng: &mut Pcg64Mcg, length: usize, contrast: f64) -> Profile {
        let values =
            (0..length).map(|_| (127.5 + (rng.random::<f64>() - 0.5) * 255.0 * contrast) as u8).collect();
        Profile { first: rng.random_range(-(length as i32) - 5..=5), values }
    }

    #[test]
    fn equals_the_reference_on_random_lines() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for parameters in parameter_sets() {
            for contrast in [0.0, 0.2, 1.0] {
                let mut lines = |n| -> Vec<Profile> {
                    (0..n)
                        .map(|_| {
                            let length = rng.random_range(1..60);
                            random(&mut rng, length, contrast)
                        })
                        .collect()
                };
                let (a, b) = (lines(LANES), lines(LANES));
                check(&a, &b, DisparityRange { min: -7, max: 9 }, parameters);
                check(&a[..3], &b[..3], DisparityRange { min: -90, max: 120 }, parameters);
                check(&a[..5], &b[..5], DisparityRange { min: 2, max: 2 }, parameters);
            }
        }
    }

    #[test]
    fn equals_the_reference_at_extreme_contrast() {
        // Black against white and alternating lines drive every state into saturation.
        let solid = |v: u8, n: usize| Profile { first: -(n as i32) / 3, values: vec![v; n] };
        let striped = |n: usize, period: usize| Profile {
            first: 0,
            values: (0..n).map(|k| if (k / period).is_multiple_of(2) { 0 } else { 255 }).collect(),
        };
        let a = [solid(0, 200), striped(200, 1), striped(180, 30), solid(255, 1), solid(7, 90)];
        let b = [solid(255, 200), striped(150, 2), striped(190, 31), solid(0, 60), solid(7, 90)];
        for parameters in parameter_sets() {
            check(&a, &b, DisparityRange::symmetric(40), parameters);
        }
    }

    #[test]
    fn equals_the_reference_from_one_to_five_thousand_samples() {
        let mut rng = Pcg64Mcg::seed_from_u64(2);
        for length in [1, 2, 3, 31, 32, 33, 1000, 5000] {
            let a = [random(&mut rng, length, 0.6)];
            let b = [random(&mut rng, length, 0.6)];
            check(&a, &b, DisparityRange::symmetric(12), StereoParameters::PAPER);
        }
    }

    #[test]
    fn empty_lines_and_blocks_are_allowed() {
        let empty = Profile { first: 0, values: Vec::new() };
        let full = Profile { first: -2, values: vec![9; 10] };
        check(
            &[empty.clone(), full.clone()],
            &[full, empty.clone()],
            DisparityRange::symmetric(3),
            StereoParameters::PAPER,
        );
        let mut kernel = Kernel::new(DisparityRange::symmetric(3), StereoParameters::PAPER);
        assert_eq!(kernel.match_one(&empty, &LaneBlock::new([])), [0; LANES]);
    }
}
