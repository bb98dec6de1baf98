//! Seeded random numbers, one sequence per purpose.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Purpose of random numbers; each has its own sequence.
#[derive(Debug, Clone, Copy)]
pub enum Purpose {
    /// Choice of the first two clicked matches.
    Combinations,
    /// Choice of further matches.
    Further,
    /// Noise of the clicks.
    Noise,
    /// Position of a wrong click.
    Mistake,
    /// Trials of a resampled median.
    Bootstrap,
    /// Samples of a robust fit.
    Samples,
}

/// Creates the generator of one purpose of one trial on one pair. FNV-1a is written out because the
/// hash of the standard library may change between releases.
pub fn generator(seed: u64, name: &str, purpose: Purpose, trial: usize) -> Pcg64Mcg {
    let trial = (trial as u64).to_le_bytes();
    let bytes = seed.to_le_bytes().into_iter().chain(name.bytes()).chain([purpose as u8]).chain(trial);
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    Pcg64Mcg::seed_from_u64(hash)
}
