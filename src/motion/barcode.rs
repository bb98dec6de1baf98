//! Motion barcodes of lines: in which frames a line is crossed by something that moves.

/// Frames of a word, one bit each.
pub(super) const WORD: usize = 64;
/// A barcode that is 0, or 1, in fewer frames than this is nearly constant and is like any other.
pub const FEWEST_CHANGES: usize = 4;

/// Standard deviations below the correlation: nineteen of twenty are higher.
const BELOW: f64 = 1.64;
/// Events without which there is no interval.
const FEWEST_EVENTS: usize = 4;

/// One bit a frame, set when something that moves crosses the line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Barcode {
    words: Vec<u64>,
    frames: usize,
    ones: usize,
    changes: usize,
}

impl Barcode {
    /// A barcode from its bits, 64 frames a word, the first in the lowest bit. Bits beyond `frames` must be 0.
    pub(super) fn new(words: Vec<u64>, frames: usize) -> Self {
        let ones = words.iter().map(|word| word.count_ones() as usize).sum();
        // Each bit against the one after it, which may be the first of the next word.
        let after = |k: usize| words[k] >> 1 | words.get(k + 1).map_or(0, |next| next << (WORD - 1));
        let differing: usize = (0..words.len()).map(|k| (words[k] ^ after(k)).count_ones() as usize).sum();
        // What follows the last bit is no bit of the barcode.
        let last = frames.checked_sub(1).is_some_and(|last| words[last / WORD] >> (last % WORD) & 1 == 1);
        let changes = differing - usize::from(last);
        Self { words, frames, ones, changes }
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames == 0
    }

    /// Frames in which the line is crossed.
    pub fn ones(&self) -> usize {
        self.ones
    }

    /// Whether the line is crossed in a frame.
    pub fn is_set(&self, time: usize) -> bool {
        self.words[time / WORD] >> (time % WORD) & 1 == 1
    }

    /// Variance of its bits, 0 to 1/4; 0 where it is nearly constant.
    pub fn variance(&self) -> f64 {
        if self.ones.min(self.frames - self.ones) < FEWEST_CHANGES {
            return 0.0;
        }
        let share = self.ones as f64 / self.frames as f64;
        share * (1.0 - share)
    }

    /// Normalised cross-correlation with another barcode of as many frames, −1 to 1; `None` where one of them is nearly
    /// constant.
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

    /// What the correlation with another barcode is at least: the lower end of its confidence interval (Fisher 1915), in
    /// which each time that something begins or ends to cross a line is one observation. Barcodes of few events, which are
    /// alike by chance, are no match for those of many. `None` where one of them is nearly constant.
    pub fn least_correlation(&self, other: &Self) -> Option<f64> {
        let events = self.changes.min(other.changes);
        let correlation = self.correlation(other).filter(|_| events >= FEWEST_EVENTS)?;
        let n = events as f64;
        // Equal barcodes could differ by half an event.
        let most = 1.0 - 0.5 / n;
        Some((correlation.clamp(-most, most).atanh() - BELOW / (n - 3.0).sqrt()).tanh())
    }

    /// How often it changes between 0 and 1.
    pub fn changes(&self) -> usize {
        self.changes
    }

    /// The same with the first `by` frames moved to the end.
    #[must_use]
    pub fn turned(&self, by: usize) -> Self {
        let mut words = vec![0u64; self.words.len()];
        for time in (0..self.frames).filter(|time| self.is_set((time + by) % self.frames)) {
            words[time / WORD] |= 1 << (time % WORD);
        }
        Self::new(words, self.frames)
    }

    /// The frames from `first` on, `count` of them.
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
