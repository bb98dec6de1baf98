//! The stereo cost of two profiles by dynamic programming: the scalar reference, and the optimal
//! disparities.
//!
//! ```text
//!     S(i, d) = φ(i, d) + min over allowed d' of [ S(i − 1, d') + ψ(d − d') ] − min over d' of S(i − 1, d')
//! ```
//!
//! The minimum of each row is subtracted and summed separately, so that `S` fits into 16 bits,
//! saturating at 65,535. A saturated state is lost, but it could win only if the best state ran
//! into 26 or more fully mismatched samples in a row. The vectorised kernel computes the same
//! numbers, bit for bit; tests compare the two.
//!
//! [`match_cost`] is the plain definition with a loop over every jump, the reference for the
//! kernel. [`match_profiles`] also returns the disparities. The function examines the few jumps
//! cheaper than α one by one and all others together; tests compare the two.

use super::{DisparityRange, Ordering, StereoParameters};
use crate::image::Profile;

/// The best matching of a profile with another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StereoMatch {
    /// Total cost C*, squared grey levels.
    pub cost: u64,
    /// Disparity of each sample of the first profile: sample `i` matches `i + d`.
    pub disparities: Vec<i32>,
    /// Cost of each sample (φ and the preceding disparity change), squared grey levels.
    pub sample_costs: Vec<u32>,
}

/// Returns C* without the disparities; zero for an empty first profile.
pub fn match_cost(a: &Profile, b: &Profile, range: DisparityRange, parameters: &StereoParameters) -> u64 {
    forward(a, b, range, parameters, reach_plainly, |_| ())
}

/// Returns C* and the optimal disparities, by backtracking. Ties go to the smallest change.
pub fn match_profiles(
    a: &Profile,
    b: &Profile,
    range: DisparityRange,
    parameters: &StereoParameters,
) -> StereoMatch {
    let mut rows: Vec<Vec<u16>> = Vec::with_capacity(a.len());
    let cost = forward(a, b, range, parameters, reach_quickly, |row| rows.push(row.to_vec()));
    let mut disparities = vec![0; a.len()];
    let mut sample_costs = vec![0; a.len()];
    let mut state = rows.last().map_or(0, |row| argmin(row.iter().copied()));
    for i in (0..rows.len()).rev() {
        let d = range.min + state as i32;
        disparities[i] = d;
        let index = a.first + i as i32;
        sample_costs[i] = u32::from(parameters.sample_cost(a.values[i], b.get(index + d)));
        if i > 0 {
            let reach = |from: usize| {
                let change = state as i32 - from as i32;
                parameters.change_cost(change).map_or(u16::MAX, |c| rows[i - 1][from].saturating_add(c))
            };
            // Ties go to the smallest change, so that disparities do not wander in flat stretches.
            let from =
                (0..range.len()).min_by_key(|from| (reach(*from), from.abs_diff(state))).unwrap_or(state);
            let change = state as i32 - from as i32;
            sample_costs[i] += u32::from(parameters.change_cost(change).unwrap_or(parameters.alpha));
            state = from;
        }
    }
    StereoMatch { cost, disparities, sample_costs }
}

/// Computes the cost of reaching each state from the previous row, by a loop over every jump.
fn reach_plainly(row: &[u16], parameters: &StereoParameters, reached: &mut [u16]) {
    for (d, reached) in reached.iter_mut().enumerate() {
        let jumps = row.iter().enumerate().filter_map(|(from, state)| {
            Some(state.saturating_add(parameters.change_cost(d as i32 - from as i32)?))
        });
        *reached = jumps.min().unwrap_or(u16::MAX);
    }
}

/// Computes the cost of reaching each state from the previous row, quickly. Every allowed jump
/// costs at most `jump_cost`, so a running minimum covers all; only cheaper jumps are examined one
/// by one.
fn reach_quickly(row: &[u16], parameters: &StereoParameters, reached: &mut [u16]) {
    let near = parameters.explicit_changes(DisparityRange { min: 0, max: row.len() as i32 - 1 }) as i32;
    // Number of states by which a predecessor may lie behind a state.
    let lead = match parameters.ordering {
        Ordering::Positions => 1,
        Ordering::Free => row.len(),
        Ordering::Disparities => 0,
    };
    let (mut seen, mut least) = (0, u16::MAX);
    for (d, reached) in reached.iter_mut().enumerate() {
        let end = (d + lead + 1).min(row.len());
        least = row[seen..end].iter().copied().fold(least, u16::min);
        seen = end;
        let jumps = (-near..=near).filter_map(|change| {
            let from = usize::try_from(d as i32 - change).ok()?;
            Some(row.get(from)?.saturating_add(parameters.change_cost(change)?))
        });
        *reached = jumps.min().unwrap_or(u16::MAX).min(least.saturating_add(parameters.jump_cost()));
    }
}

/// Runs the recurrence. `reach` is one of the two functions above; `visit` receives each row of
/// states.
fn forward(
    a: &Profile,
    b: &Profile,
    range: DisparityRange,
    parameters: &StereoParameters,
    reach: impl Fn(&[u16], &StereoParameters, &mut [u16]),
    mut visit: impl FnMut(&[u16]),
) -> u64 {
    let mut row = vec![0u16; range.len()];
    let mut next = row.clone();
    let mut total = 0;
    for (i, value) in a.values.iter().enumerate() {
        let lowest = row.iter().copied().min().unwrap_or(0);
        total += u64::from(lowest);
        reach(&row, parameters, &mut next);
        for (d, state) in next.iter_mut().enumerate() {
            let other = b.get(a.first + i as i32 + range.min + d as i32);
            // The first sample has no preceding change; all states are zero, so the jump costs
            // nothing.
            *state = (*state - lowest).saturating_add(parameters.sample_cost(*value, other));
        }
        std::mem::swap(&mut row, &mut next);
        visit(&row);
    }
    total + u64::from(row.iter().copied().min().unwrap_or(0))
}

fn argmin(values: impl Iterator<Item = u16>) -> usize {
    values.enumerate().min_by_key(|(_, v)| *v).map_or(0, |(k, _)| k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn profile(first: i32, values: &[u8]) -> Profile {
        Profile { first, values: values.to_vec() }
    }

    fn textured(n: usize, seed: u32) -> Vec<u8> {
        (0..n as u32)
            .map(|k| ((k.wrapping_mul(2_654_435_761).wrapping_add(seed * 977)) >> 24) as u8)
            .collect()
    }

    #[test]
    fn a_shifted_profile_costs_only_what_leaves_the_image() {
        let values = textured(80, 1);
        let a = profile(0, &values);
        let b = profile(5, &values);
        let m = match_profiles(&a, &b, DisparityRange::symmetric(8), &StereoParameters::PAPER);
        assert_eq!(m.cost, 0);
        assert!(m.disparities.iter().all(|d| *d == 5));
        let narrow = match_cost(&a, &b, DisparityRange::symmetric(3), &StereoParameters::PAPER);
        assert!(narrow > 10_000);
    }

    #[test]
    fn matches_outside_the_other_line_pay_the_fixed_cost() {
        let a = profile(0, &[10; 20]);
        let b = profile(0, &[10; 12]);
        let cost = match_cost(&a, &b, DisparityRange { min: 0, max: 0 }, &StereoParameters::PAPER);
        assert_eq!(cost, 8 * 300);
    }

    #[test]
    fn ordering_forbids_going_back_by_more_than_one() {
        // A block jumps back by 4 while its surroundings stay. Free ordering can follow the jump.
        let base = textured(60, 7);
        let mut other = base.clone();
        other[26..36].copy_from_slice(&base[30..40]);
        let (a, b) = (profile(0, &base), profile(0, &other));
        let range = DisparityRange::symmetric(6);
        let with = |ordering| {
            let parameters = StereoParameters { ordering, ..StereoParameters::PAPER };
            match_profiles(&a, &b, range, &parameters)
        };
        let (free, positions, disparities) =
            (with(Ordering::Free), with(Ordering::Positions), with(Ordering::Disparities));
        assert!(free.cost <= positions.cost && positions.cost <= disparities.cost);
        assert!(free.cost < disparities.cost);
        assert!(positions.disparities.windows(2).all(|w| w[1] >= w[0] - 1));
        assert!(disparities.disparities.windows(2).all(|w| w[1] >= w[0]));
    }

    #[test]
    fn sample_costs_add_up_to_the_total() {
        let (a, b) = (profile(-7, &textured(50, 3)), profile(-12, &textured(70, 4)));
        let m = match_profiles(&a, &b, DisparityRange::symmetric(9), &StereoParameters::PAPER);
        assert_eq!(m.cost, m.sample_costs.iter().map(|c| u64::from(*c)).sum::<u64>());
        assert_eq!(m.cost, match_cost(&a, &b, DisparityRange::symmetric(9), &StereoParameters::PAPER));
    }

    #[test]
    fn empty_profiles_cost_nothing_or_only_the_outside() {
        let (full, empty) = (profile(0, &[1, 2, 3]), profile(0, &[]));
        let range = DisparityRange::symmetric(2);
        assert_eq!(match_cost(&empty, &full, range, &StereoParameters::PAPER), 0);
        assert_eq!(match_cost(&full, &empty, range, &StereoParameters::PAPER), 900);
        assert!(match_profiles(&empty, &full, range, &StereoParameters::PAPER).disparities.is_empty());
    }

    proptest! {
        #[test]
        fn states_are_reached_alike_quickly_and_plainly(
            row in proptest::collection::vec(0..60_000u16, 1..40),
            lambda in prop_oneof![Just(0), 0..900u16],
            alpha in 0..9000u16,
            ordering in 0..3usize,
        ) {
            let ordering = [Ordering::Positions, Ordering::Free, Ordering::Disparities][ordering];
            let parameters = StereoParameters { lambda, alpha, ordering, ..StereoParameters::PAPER };
            let (mut plain, mut quick) = (vec![0; row.len()], vec![0; row.len()]);
            reach_plainly(&row, &parameters, &mut plain);
            reach_quickly(&row, &parameters, &mut quick);
            prop_assert_eq!(plain, quick);
        }
    }
}
