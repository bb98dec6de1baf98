//! Motion barcodes of lines: the frames in which moving objects cross a line.

/// Frames per word, one bit each.
pub(super) const WORD: usize = 64;
/// Minimum number of zeros and of ones in a barcode. A barcode with fewer is nearly constant and
/// resembles every other.
const FEWEST_CHANGES: usize = 4;

/// Number of standard deviations from the correlation to its lower bound, for a one-sided
/// confidence of 95 %.
const BELOW: f64 = 1.64;
/// Minimum number of events for a confidence interval.
const FEWEST_EVENTS: usize = 4;

/// A bit per frame, set when a moving object crosses the line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Barcode {
    words: Vec<u64>,
    frames: usize,
    ones: usize,
    changes: usize,
}

impl Barcode {
    /// Creates a barcode from its bits, 64 frames per word, the first frame in the lowest bit. Bits
    /// beyond `frames` must be 0.
    pub(super) fn new(words: Vec<u64>, frames: usize) -> Self {
        let ones = words.iter().map(|word| word.count_ones() as usize).sum();
        // Each bit is compared with the next, which may be the first of the next word.
        let after = |k: usize| words[k] >> 1 | words.get(k + 1).map_or(0, |next| next << (WORD - 1));
        let differing: usize = (0..words.len()).map(|k| (words[k] ^ after(k)).count_ones() as usize).sum();
        // The bit behind the last is not part of the barcode.
        let last = frames.checked_sub(1).is_some_and(|last| words[last / WORD] >> (last % WORD) & 1 == 1);
        let changes = differing - usize::from(last);
        Self { words, frames, ones, changes }
    }

    /// Returns the number of frames.
    pub fn len(&self) -> usize {
        self.frames
    }

    /// Returns whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames == 0
    }

    /// Returns the number of frames in which the line is crossed.
    pub fn ones(&self) -> usize {
        self.ones
    }

    /// Returns whether the line is crossed in a frame.
    pub fn is_set(&self, time: usize) -> bool {
        self.words[time / WORD] >> (time % WORD) & 1 == 1
    }

    /// Returns the variance of the bits, 0 to 1/4; 0 for a nearly constant barcode.
    pub fn variance(&self) -> f64 {
        if self.ones.min(self.frames - self.ones) < FEWEST_CHANGES {
            return 0.0;
        }
        let share = self.ones as f64 / self.frames as f64;
        share * (1.0 - share)
    }

    /// Returns the normalised cross-correlation with a barcode of equal length, −1 to 1. Returns
    /// `None` when either barcode is nearly constant.
    pub fn correlation(&self, other: &Self) -> Option<f64> {
        let spread = self.variance() * other.variance();
        if spread <= 0.0 {
            return None;
        }
        let both: u32 = self.words.iter().zip(&other.words).map(|(a, b)| (a & b).count_ones()).sum();
        let n = self.frames as f64;
        let covariance = f64::from(both) / n - self.ones as f64 * other.ones as f64 / (n * n);
        Some(covariance / spread.sqrt())
    }

    /// Returns a lower bound for the correlation: the lower end of its confidence interval (Fisher
    /// 1915).
    ///
    /// Each start or end of a crossing counts as one observation. Barcodes with few events, which
    /// are similar by chance, thus rank below those with many. Returns `None` when either barcode
    /// is nearly constant or has too few events.
    pub fn least_correlation(&self, other: &Self) -> Option<f64> {
        let events = self.changes.min(other.changes);
        let correlation = self.correlation(other).filter(|_| events >= FEWEST_EVENTS)?;
        let n = events as f64;
        // The correlation of equal barcodes is limited, because its inverse hyperbolic tangent is
        // infinite: equal barcodes could differ by half an event.
        let most = 1.0 - 0.5 / n;
        Some((correlation.clamp(-most, most).atanh() - BELOW / (n - 3.0).sqrt()).tanh())
    }

    /// Returns the number of changes between 0 and 1.
    pub fn changes(&self) -> usize {
        self.changes
    }

    /// Returns the barcode rotated in time: its first `by` frames move to the end.
    #[must_use]
    pub fn turned(&self, by: usize) -> Self {
        let mut words = vec![0u64; self.words.len()];
        for time in (0..self.frames).filter(|time| self.is_set((time + by) % self.frames)) {
            words[time / WORD] |= 1 << (time % WORD);
        }
        Self::new(words, self.frames)
    }

    /// Returns `count` frames of the barcode, starting at `first`.
    #[must_use]
    pub fn part(&self, first: usize, count: usize) -> Self {
        let (skipped, shift) = (first / WORD, first % WORD);
        let word = |k: usize| {
            let low = self.words.get(skipped + k).map_or(0, |w| w >> shift);
            let high = if shift == 0 {
                0
            } else {
                self.words.get(skipped + k + 1).map_or(0, |w| w << (WORD - shift))
            };
            low | high
        };
        let mut words: Vec<u64> = (0..count.div_ceil(WORD)).map(word).collect();
        if let Some(last) = words.last_mut()
            && !count.is_multiple_of(WORD)
        {
            *last &= (1 << (count % WORD)) - 1;
        }
        Self::new(words, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn barcode(bits: impl Iterator<Item = bool>) -> Barcode {
        let bits: Vec<bool> = bits.collect();
        let word =
            |few: &[bool]| few.iter().enumerate().fold(0, |word, (k, bit)| word | u64::from(*bit) << k);
        Barcode::new(bits.chunks(WORD).map(word).collect(), bits.len())
    }

    #[test]
    fn correlation_is_that_of_the_bits() {
        let a: Vec<f64> = (0..150).map(|k| f64::from(u8::from(k * k % 7 < 3))).collect();
        let b: Vec<f64> = (0..150).map(|k| f64::from(u8::from(k * k % 11 < 6))).collect();
        let of = |v: &[f64]| barcode(v.iter().map(|x| *x > 0.5));
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let (ma, mb) = (mean(&a), mean(&b));
        let covariance = a.iter().zip(&b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>();
        let variance = |v: &[f64], m: f64| v.iter().map(|x| (x - m).powi(2)).sum::<f64>();
        let expected = covariance / (variance(&a, ma) * variance(&b, mb)).sqrt();
        assert!((of(&a).correlation(&of(&b)).unwrap() - expected).abs() < 1e-12);
        assert!((of(&a).correlation(&of(&a)).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(of(&[0.0; 70]).correlation(&of(&a[..70])), None, "a constant one is like any other");
    }

    #[test]
    fn a_part_has_the_bits_of_its_frames() {
        let all = barcode((0..200).map(|k| k * k % 5 == 1));
        for (first, count) in [(0, 200), (1, 64), (63, 70), (64, 64), (130, 70), (7, 1)] {
            let part = all.part(first, count);
            assert_eq!(part.len(), count);
            assert!((0..count).all(|k| part.is_set(k) == all.is_set(first + k)));
            assert_eq!(part.changes(), (1..count).filter(|k| part.is_set(*k) != part.is_set(k - 1)).count());
            assert_eq!(part.ones(), (first..first + count).filter(|k| all.is_set(*k)).count());
        }
    }
}
