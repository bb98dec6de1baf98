//! Independent streams of random numbers, one for each purpose and task of an estimate.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Purpose of a stream. Two purposes never share random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) enum Purpose {
    /// Pairs of candidate lines, one of each click.
    CandidatePairs = 1,
    /// Steps of the refinement on lines.
    LineRefinement,
    /// Candidate lines of a search without clicks.
    LineConsensus,
    /// Minimal samples of feature matches.
    FeatureSamples,
    /// Local optimisation of geometries from feature matches.
    FeatureOptimisation,
    /// Minimal samples of patch matches around the leading geometries.
    PatchSamples,
    /// Matches from which a homography is made.
    PlaneSamples,
    /// Putative matches that replace clicks.
    PutativePairs,
    /// Minimal samples of the final fit.
    MatchSamples,
    /// Random lines of the search by barcodes.
    BarcodeLines,
    /// Steps of the refinement by barcodes.
    BarcodeRefinement,
}

/// Returns the stream of one task of one purpose. Tasks that run in parallel take one stream each,
/// so that the result is the same on any number of threads.
pub(in crate::estimate) fn stream(seed: u64, purpose: Purpose, index: u64) -> Pcg64Mcg {
    // With a sum or XOR, seed 1 and task 0 would share a stream with seed 0 and task 1.
    Pcg64Mcg::seed_from_u64(mixed(mixed(mixed(seed) ^ purpose as u64) ^ index))
}

/// The finaliser of `SplitMix64` (Steele, Lea & Flood 2014): a bijection in which every bit of the
/// input changes half of the output.
fn mixed(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use rand::RngExt;

    use super::*;

    #[test]
    fn neighbouring_seeds_purposes_and_tasks_share_no_stream() {
        let mut firsts = HashSet::new();
        for seed in 0..40 {
            for purpose in [Purpose::CandidatePairs, Purpose::MatchSamples, Purpose::BarcodeRefinement] {
                for index in (0..40).chain([1 << 32, u64::MAX]) {
                    assert!(firsts.insert(stream(seed, purpose, index).random::<u64>()));
                }
            }
        }
    }

    #[test]
    fn a_stream_is_the_same_each_time() {
        let draw = || stream(7, Purpose::PlaneSamples, 3).random::<u64>();
        assert_eq!(draw(), draw());
    }
}
