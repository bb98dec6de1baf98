//! Trial of all readings, and the verdict in words.

use std::fmt::Write;

use serde::Serialize;
use thiserror::Error;

use super::{FEWEST_MATCHES, Reading};
use crate::geometry::{
    FundamentalMatrix, PointPair, grid_minimum, looks_essential, median, symmetric_epipolar_distance,
};

/// Common reductions of images before matching, and their inverses.
const SCALES: [f64; 9] = [1.0, 0.5, 2.0, 0.25, 4.0, 1.0 / 3.0, 3.0, 0.125, 8.0];
/// Range of the search for other scales, octaves to either side: 1 / 16 to 16.
const SCALE_OCTAVES: f64 = 4.0;
/// Minimum distance of a searched scale from the listed scales, natural logarithm.
const SCALE_STEP: f64 = 0.03;
/// Maximum number of matches used. More matches add no certainty.
const MOST_MATCHES: usize = 4000;
/// Largest median distance that counts as a fit, px.
const FITS: f64 = 2.0;
/// The same limit for large images, as a fraction of the extent of the matches.
const FITS_SHARE: f64 = 0.002;
/// The same limit for a searched scale, as a fraction: a free factor brings most matrices nearer to the matches. A chosen
/// number.
const SEARCHED: f64 = 0.5;
/// Minimum difference between two readings, standard errors. About a hundred readings are compared.
const CLEARLY: f64 = 4.0;
/// Minimum difference between two readings, relative to the mean distance of the better one.
const MATERIAL: f64 = 0.1;
/// Largest coordinate accepted, px. Squares of much larger numbers are infinite.
const FARTHEST: f64 = 1e7;
/// Ratio of medians from which a reading that does not fit is rejected in favour of one that fits,
/// however few the matches.
const FAR: f64 = 4.0;

/// Reason why a convention cannot be checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CheckError {
    /// There are too few matches.
    #[error(
        "checking a convention needs at least {FEWEST_MATCHES} matches, {0} were given. Add matches at different depths"
    )]
    TooFew(usize),
    /// A coordinate is not a finite number.
    #[error("a match has a coordinate that is not a finite number")]
    NotFinite,
    /// A coordinate is beyond any image.
    #[error(
        "a match has a coordinate beyond {FARTHEST:e} px, outside any image. Check the unit and the columns of the \
         matches"
    )]
    TooFar,
}

/// Reading of a matrix, with its fit to the matches.
#[derive(Debug, Clone, Serialize)]
pub struct RankedReading {
    /// Reading under test.
    pub reading: Reading,
    /// Fundamental matrix under this reading, in the convention of this program.
    pub fundamental: FundamentalMatrix,
    /// Median symmetric epipolar distance of the matches, px.
    pub median: f64,
    /// Fraction of the matches within [`ConventionCheck::limit`] of their epipolar lines, 0 to 1.
    pub within: f64,
    /// True if the matches distinguish this reading from the first of the list; false for the first
    /// itself.
    pub told_apart: bool,
    #[serde(skip)]
    distances: Vec<f64>,
}

/// All readings of a matrix, the most credible first.
#[derive(Debug, Clone, Serialize)]
pub struct ConventionCheck {
    /// Readings, at least one. The first is the most credible; the others are sorted by median.
    pub readings: Vec<RankedReading>,
    /// Largest median of a reading that fits, px.
    pub limit: f64,
    /// Number of matches used.
    pub matches: usize,
}

/// Tests all readings of a matrix on matches in the convention of this program. `given` is the
/// matrix as it was read.
pub fn check_convention(
    given: &FundamentalMatrix,
    matches: &[PointPair],
) -> Result<ConventionCheck, CheckError> {
    if matches.len() < FEWEST_MATCHES {
        return Err(CheckError::TooFew(matches.len()));
    }
    if !matches.iter().all(PointPair::is_finite) {
        return Err(CheckError::NotFinite);
    }
    if matches.iter().flat_map(PointPair::numbers).any(|number| number.abs() > FARTHEST) {
        return Err(CheckError::TooFar);
    }
    // An even sample: matches are often listed in some order.
    let stride = matches.len().div_ceil(MOST_MATCHES);
    let matches: Vec<PointPair> = matches.iter().step_by(stride).copied().collect();
    let limit = FITS.max(FITS_SHARE * extent(&matches));

    let mut readings: Vec<RankedReading> = Vec::new();
    for reading in candidates(given, &matches) {
        let Some(ranked) = RankedReading::new(reading, given, &matches, limit) else { continue };
        if !SCALES.contains(&reading.scale) && ranked.median > SEARCHED * limit {
            continue;
        }
        // Simpler readings come first, so the first name of a matrix is the simplest.
        if !readings.iter().any(|other| other.is_same(&ranked)) {
            readings.push(ranked);
        }
    }
    // A stable sort: of equal readings the simpler comes first.
    readings.sort_by(|a, b| a.median.total_cmp(&b.median));
    prefer_simplest(&mut readings, limit);
    Ok(ConventionCheck { readings, limit, matches: matches.len() })
}

/// Moves the simplest of the readings that are indistinguishable from the best one to the front.
fn prefer_simplest(readings: &mut Vec<RankedReading>, limit: f64) {
    let Some(best) = readings.first().cloned() else { return };
    let credible = |r: &RankedReading| !r.is_told_from(&best, limit);
    let simplest = (0..readings.len())
        .filter(|k| credible(&readings[*k]))
        .min_by_key(|k| readings[*k].reading.changes())
        .unwrap_or(0);
    let first = readings.remove(simplest);
    for reading in readings.iter_mut() {
        reading.told_apart = reading.is_told_from(&first, limit);
    }
    readings.insert(0, first);
}

/// Returns all readings to test, simpler ones first.
fn candidates(given: &FundamentalMatrix, matches: &[PointPair]) -> Vec<Reading> {
    let mut readings = Vec::new();
    for turned in Reading::of_same_size() {
        let near = |a: f64, b: f64| (a / b).ln().abs() < SCALE_STEP;
        let found = estimated_scale(given, turned, matches);
        let found = Some(found).filter(|s| !SCALES.iter().any(|known| near(*s, *known)));
        readings.extend(SCALES.into_iter().chain(found).map(|scale| Reading { scale, ..turned }));
    }
    readings.sort_by_key(Reading::changes);
    readings
}

/// Returns the scale with the smallest median, by a grid of eighths of octaves and a golden section
/// search.
fn estimated_scale(given: &FundamentalMatrix, turned: Reading, matches: &[PointPair]) -> f64 {
    const STEPS_PER_OCTAVE: f64 = 8.0;
    let few: Vec<PointPair> = matches.iter().step_by(matches.len().div_ceil(500)).copied().collect();
    let cost = |octaves: f64| {
        let reading = Reading { scale: octaves.exp2(), ..turned };
        reading.apply(given).map_or(f64::INFINITY, |f| median(distances(&f, &few)))
    };
    grid_minimum(cost, (-SCALE_OCTAVES, SCALE_OCTAVES), 1.0 / STEPS_PER_OCTAVE).exp2()
}

impl RankedReading {
    fn new(reading: Reading, given: &FundamentalMatrix, matches: &[PointPair], limit: f64) -> Option<Self> {
        let fundamental = reading.apply(given)?;
        let distances = distances(&fundamental, matches);
        let near = distances.iter().filter(|d| **d <= limit).count();
        Some(Self {
            reading,
            fundamental,
            median: median(distances.iter().copied()),
            within: near as f64 / distances.len() as f64,
            told_apart: false,
            distances,
        })
    }

    /// Returns whether both readings give every match the same distance, up to rounding.
    fn is_same(&self, other: &Self) -> bool {
        self.distances.iter().zip(&other.distances).all(|(a, b)| (a - b).abs() <= 1e-6 * (1.0 + a.abs()))
    }

    /// Returns whether the matches are clearly farther from their lines than under `better`.
    fn is_told_from(&self, better: &Self, limit: f64) -> bool {
        // With few matches, a single match that happens to fit the wrong reading inflates the
        // variance.
        if better.median <= limit && self.median > limit && self.median > FAR * better.median {
            return true;
        }
        // Beyond a few times the median a match is an outlier under both readings.
        let cap = (4.0 * better.median).max(0.5);
        let count = self.distances.len() as f64;
        let differences =
            || self.distances.iter().zip(&better.distances).map(|(own, other)| own.min(cap) - other.min(cap));
        let mean = differences().sum::<f64>() / count;
        let variance = differences().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let left = better.distances.iter().map(|d| d.min(cap)).sum::<f64>() / count;
        mean > CLEARLY * (variance / count).sqrt() && mean > (MATERIAL * left).max(1e-3)
    }
}

impl ConventionCheck {
    /// Returns the most credible reading.
    pub fn best(&self) -> &RankedReading {
        &self.readings[0]
    }

    /// Returns whether any reading fits the matches.
    pub fn fits(&self) -> bool {
        self.best().median <= self.limit
    }

    /// Returns the matrix as it was read, wherever it ranks.
    pub fn as_read(&self) -> Option<&RankedReading> {
        self.readings.iter().find(|r| r.reading.changes() == 0)
    }

    /// Returns the readings that are indistinguishable from the best.
    pub fn alike(&self) -> impl Iterator<Item = &RankedReading> {
        self.readings.iter().skip(1).filter(|r| !r.told_apart)
    }

    /// Returns the first reading that differs clearly from the best.
    pub fn next(&self) -> Option<&RankedReading> {
        self.readings.iter().find(|r| r.told_apart)
    }

    /// Returns the verdict in words.
    pub fn sentence(&self) -> String {
        let best = self.best();
        if !self.fits() {
            if self.as_read().is_some_and(|own| looks_essential(own.fundamental.matrix())) {
                return format!(
                    "No reading fits. The matrix looks like an essential matrix E, which is for rays and not for pixels. \
                     F of the pictures is K2^-T E K1^-1, with the calibration matrices of both cameras. As F, it leaves half \
                     of the {} matches more than {} px from their epipolar lines; the limit is {} px.",
                    self.matches,
                    pixels(best.median),
                    pixels(self.limit)
                );
            }
            // The least distance of a hundred readings tells nothing far beyond the limit.
            let is_near = best.median <= FAR * self.limit;
            let which =
                if is_near { format!("the best one ({})", best.reading) } else { "each of them".to_owned() };
            return format!(
                "No reading fits. Under {which}, half of the {} matches lie more than {} px from their epipolar lines; the limit is {} px. The matrix may belong to other images, most matches may be wrong, or the convention may be one that is not tried: y pointing up, or only one of the images resized.",
                self.matches,
                pixels(best.median),
                pixels(self.limit)
            );
        }
        let mut text = if best.reading.changes() == 0 {
            "The geometry fits as read".to_owned()
        } else {
            let as_read = self.as_read();
            let median = as_read.map_or(String::new(), |r| format!(" ({} px)", pixels(r.median)));
            if as_read.is_some_and(|r| r.median <= self.limit) {
                format!(
                    "The geometry fits worse as read{median} than under another reading: {}",
                    best.reading
                )
            } else {
                format!(
                    "The geometry does not fit as read{median}. It fits under another reading: {}",
                    best.reading
                )
            }
        };
        let _ = write!(
            text,
            ". Half of the {} matches lie within {} px of their epipolar lines",
            self.matches,
            pixels(best.median)
        );
        if let Some(next) = self.next() {
            let _ = write!(
                text,
                ". Under the next different reading ({}) they lie within {} px",
                next.reading,
                pixels(next.median)
            );
        }
        text.push('.');
        let alike: Vec<_> = self.alike().map(|r| r.reading).collect();
        if alike.is_empty() {
            return text;
        }
        if alike.iter().all(|r| r.differs_in_origin_only(&best.reading)) {
            let origins =
                alike.iter().map(|r| format!("({0}, {0})", r.origin)).collect::<Vec<_>>().join(" or ");
            let _ = write!(
                text,
                " These matches cannot tell whether pixels are counted from ({0}, {0}) or {origins}. The difference is small here.",
                best.reading.origin
            );
        } else {
            let others = alike.iter().take(NAMED).map(ToString::to_string).collect::<Vec<_>>().join(" / ");
            let _ = write!(text, " These readings fit equally well: {others}");
            if alike.len() > NAMED {
                let _ = write!(text, " / and {} more", alike.len() - NAMED);
            }
            text.push('.');
            if alike.len() > BY_CHANCE {
                text.push_str(" With so many equal readings the fit may be chance. Check with more matches.");
            }
        }
        text
    }
}

/// Maximum number of equal readings named in the verdict.
const NAMED: usize = 3;
/// Number of equal readings beyond which the fit may be chance.
const BY_CHANCE: usize = 12;

/// Formats a distance with its significant digits.
fn pixels(value: f64) -> String {
    if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}

fn distances(f: &FundamentalMatrix, matches: &[PointPair]) -> Vec<f64> {
    matches.iter().map(|pair| symmetric_epipolar_distance(f, pair)).collect()
}

/// Returns the diagonal of the bounding rectangle of the points, of the larger of both images, px.
fn extent(matches: &[PointPair]) -> f64 {
    let side = |coordinate: usize| {
        let all = || matches.iter().map(|pair| pair.numbers()[coordinate]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    side(0).hypot(side(1)).max(side(2).hypot(side(3)))
}
