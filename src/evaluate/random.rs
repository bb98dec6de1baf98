//! Seeded sequences of random numbers, one for each purpose.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// What random numbers are for: each purpose has its own sequence.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    /// Choice of the two matches that are clicked.
    Combinations,
    /// Choice of further matches.
    Further,
    /// How far off.
    Noise,
    /// Choice of where a wrong click goes.
    Mistake,
    /// Choice of the trials that make a resampled median.
    Bootstrap,
}

/// A generator for one purpose of one trial on one pair. The hash (FNV-1a) is spelled out because the one of
/// the standard library may change between releases.
pub(super) fn generator(seed: u64, name: &str, purpose: Purpose, trial: usize) -> Pcg64Mcg {
    let trial = (trial as u64).to_le_bytes();
    let bytes = seed.to_le_bytes().into_iter().chain(name.bytes()).chain([purpose as u8]).chain(trial);
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    Pcg64Mcg::seed_from_u64(hash)
}
