//! The time offset between two recordings.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::{Barcode, FEWEST_FRAMES, MotionError, Silhouettes, common_frames};
use crate::cancel::CancelFlag;
use crate::geometry::{AnchoredLine, line_grid, median};

/// Largest offset tried in either direction, frames.
pub const MOST_OFFSET: i32 = 50;
/// Number of lines compared in each image.
const LINES: usize = 500;
/// Fraction of the lines of image 1 that count, best correlation first. Most lines have no
/// counterpart.
const BEST: f64 = 0.2;

/// Largest probability that an offset is called clear by chance: one in 25, as for the agreement of a
/// geometry.
const BY_CHANCE: f64 = 0.04;
/// Standard deviation of normal deviates over the median of their absolute values.
const TO_SIGMA: f64 = 1.4826;

/// Agreement of the barcodes of two sequences at an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetAgreement {
    /// Offset in frames: frame `k` of the first sequence matches frame `k + offset` of the second.
    pub offset: i32,
    /// Mean lower bound of the correlation ([`Barcode::least_correlation`]) over the best line
    /// pairs, −1 to 1.
    pub correlation: f64,
}

/// Returns the best offset if it is clear: the lines agree, better than chance explains, and only at
/// this offset and its neighbours. `found` is the outcome of [`find_offset`], whose other offsets show
/// the agreement by chance.
pub fn clear_offset(found: &[OffsetAgreement]) -> Option<&OffsetAgreement> {
    let best = found.first().filter(|best| best.correlation > 0.0)?;
    let middle = median(found.iter().map(|one| one.correlation));
    let deviation = TO_SIGMA * median(found.iter().map(|one| (one.correlation - middle).abs()));
    let stands_out = |one: &&OffsetAgreement| {
        let height = one.correlation - middle;
        let z = height / deviation;
        // Mills' bound for a normal deviate, one for each offset.
        let chance = found.len() as f64 * (-0.5 * z * z).exp() / (z * TAU.sqrt());
        chance < BY_CHANCE && height > 0.5 * (best.correlation - middle)
    };
    let peak = || found.iter().filter(stands_out).map(|one| one.offset);
    let width = peak().max()? - peak().min()? + 1;
    (width as usize == peak().count()).then_some(best)
}

/// Returns the agreement at every offset from `−reach` to `reach` that leaves enough frames, best
/// first.
pub fn find_offset(
    both: [&Silhouettes; 2],
    reach: i32,
    cancel: &CancelFlag,
) -> Result<Vec<OffsetAgreement>, MotionError> {
    let barcodes = both.map(|silhouettes| {
        let lines = line_grid(silhouettes.size(), LINES);
        let informative = |line: &AnchoredLine| {
            let barcode = silhouettes.barcode(line, 1.0);
            (barcode.variance() > 0.0).then_some(barcode)
        };
        lines.par_iter().filter_map(informative).collect::<Vec<Barcode>>()
    });
    let counts = both.map(Silhouettes::len);
    let agreement = |offset: i32| {
        let ([from1, from2], common) = common_frames(counts, offset);
        // At least half of the frames must stay. With fewer frames, a wrong offset can agree as
        // well by chance.
        if cancel.is_cancelled() || common < FEWEST_FRAMES.max(counts[0].min(counts[1]) / 2) {
            return None;
        }
        let parts =
            |all: &[Barcode], from: usize| all.iter().map(|b| b.part(from, common)).collect::<Vec<_>>();
        let (first, second) = (parts(&barcodes[0], from1), parts(&barcodes[1], from2));
        let best = |a: &Barcode| second.iter().filter_map(|b| a.least_correlation(b)).fold(-1.0, f64::max);
        let mut correlations: Vec<f64> = first.iter().map(best).collect();
        correlations.sort_by(|a, b| b.total_cmp(a));
        correlations.truncate(((correlations.len() as f64 * BEST) as usize).max(1));
        let correlation = correlations.iter().sum::<f64>() / correlations.len().max(1) as f64;
        Some(OffsetAgreement { offset, correlation })
    };
    let mut found: Vec<OffsetAgreement> = (-reach..=reach).into_par_iter().filter_map(agreement).collect();
    cancel.check()?;
    // Ties go to the smaller offset.
    found.sort_by(|a, b| b.correlation.total_cmp(&a.correlation).then(a.offset.abs().cmp(&b.offset.abs())));
    Ok(found)
}

#[cfg(test)]
#[cfg(feature = "pictures")]
mod tests {
    use super::*;
    use crate::geometry::Frame;
    use crate::synthetic::{BallScene, ThrownBalls};

    #[test]
    fn the_offset_of_two_recordings_is_found_either_way() {
        for offset in [0, 7, -23] {
            let thrown = ThrownBalls {
                frame: Frame::new(160, 120),
                frames: 240,
                offset,
                noise: 0.0,
                ..ThrownBalls::default()
            };
            let scene = BallScene::new(thrown).unwrap();
            let [first, second] = [0, 1].map(|camera| {
                let masks: Vec<Vec<bool>> = (0..240).map(|number| scene.mask(camera, number)).collect();
                Silhouettes::from_masks("made", thrown.frame, thrown.frame, masks).unwrap()
            });
            let found = find_offset([&first, &second], 50, &CancelFlag::default()).unwrap();
            assert_eq!(found.len(), 101);
            assert_eq!(clear_offset(&found).map(|best| best.offset), Some(offset), "{:?}", &found[..4]);
        }
    }

    #[test]
    fn only_one_high_peak_of_agreement_is_clear() {
        // Agreements of unrelated recordings, with a peak.
        let found = |peaks: &[(i32, f64)], level: f64| {
            let one = |offset: i32| {
                let by_chance = level + 0.02 * f64::from(offset * offset * 7 % 11 - 5) / 5.0;
                let peak = |&(at, height): &(i32, f64)| height / f64::from(1 + (offset - at).abs());
                let correlation = peaks.iter().map(peak).fold(by_chance, f64::max);
                OffsetAgreement { offset, correlation }
            };
            let mut found: Vec<_> = (-50..=50).map(one).collect();
            found.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
            clear_offset(&found).map(|best| best.offset)
        };
        assert_eq!(found(&[(7, 0.3)], 0.0), Some(7));
        assert_eq!(found(&[], 0.0), None, "nothing stands out");
        assert_eq!(found(&[(7, 0.3), (-20, 0.28)], 0.0), None, "two offsets agree");
        assert_eq!(found(&[(7, -0.3)], -0.9), None, "the lines disagree");
        assert_eq!(clear_offset(&[]), None);
    }
}
