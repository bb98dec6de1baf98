//! Words for the position of an epipole and its uncertainty.

use crate::estimate::{Determined, EpipoleBearing, EpipoleCertainty};

/// Phrase for an epipole that the matches do not determine.
pub const NOT_DETERMINED: &str = "not determined";

/// Share of the distance up to which the interval is written as plus or minus. Wider intervals are
/// far from symmetric.
const SYMMETRIC: f64 = 0.2;

/// Describes what the matches determine of an epipole; `None` if that is unknown.
pub fn epipole_in_words(bearing: Option<&EpipoleBearing>, determined: Option<Determined>) -> Option<String> {
    let is_open = determined == Some(Determined::Lines);
    bearing.map(interval_in_words).or_else(|| is_open.then(|| NOT_DETERMINED.to_owned()))
}

/// Describes the 95 % interval of an epipole's distance or direction, seen from the middle of its
/// image.
pub fn interval_in_words(bearing: &EpipoleBearing) -> String {
    let EpipoleBearing { direction_error, distance, nearest, farthest, .. } = *bearing;
    match (bearing.certainty(), farthest) {
        (EpipoleCertainty::Position, Some(farthest)) => {
            let half = 0.5 * (farthest - nearest);
            if half <= SYMMETRIC * distance {
                format!("{} ± {} px away", length_in_words(distance, half), length_in_words(half, half))
            } else {
                // Two digits of each end: the far one may be hundreds of times the near one.
                let end = |end: f64| length_in_words(end, 0.1 * if end > 0.0 { end } else { farthest });
                format!("{} to {} px away", end(nearest), end(farthest))
            }
        }
        (EpipoleCertainty::Direction, _) => {
            format!("far away, direction ± {:.1}°", direction_error.to_degrees())
        }
        _ => NOT_DETERMINED.to_owned(),
    }
}

/// Writes a length whose error is `error` px: no more digits than that has.
pub fn length_in_words(length: f64, error: f64) -> String {
    let decimals = (-error.max(f64::MIN_POSITIVE).log10().floor()).clamp(-9.0, 1.0);
    let step = 10_f64.powf(-decimals);
    format!("{:.*}", decimals.max(0.0) as usize, (length / step).round() * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(distance: f64, nearest: f64, farthest: Option<f64>, direction_error: f64) -> String {
        let direction = 0.3;
        interval_in_words(&EpipoleBearing { direction, direction_error, distance, nearest, farthest })
    }

    #[test]
    fn intervals_have_no_more_digits_than_they_deserve() {
        assert_eq!(words(4954.0, 4252.0, Some(5671.0), 0.01), "5000 ± 700 px away");
        assert_eq!(words(83.27, 82.15, Some(84.43), 0.01), "83 ± 1 px away");
        assert_eq!(words(83.27, 83.15, Some(83.43), 0.01), "83.3 ± 0.1 px away");
        assert_eq!(words(6000.0, 3120.0, Some(12_100.0), 0.01), "3100 to 12000 px away");
        assert_eq!(words(5300.0, 2640.0, Some(773_000.0), 0.01), "2600 to 770000 px away");
        assert_eq!(words(50.0, 0.0, Some(121.0), 0.01), "0 to 120 px away");
        assert_eq!(words(6000.0, 3120.0, None, 0.02), "far away, direction ± 1.1°");
        assert_eq!(words(f64::INFINITY, 400.0, None, 1.5), "not determined");
        assert_eq!(epipole_in_words(None, Some(Determined::Lines)).unwrap(), "not determined");
        assert_eq!(epipole_in_words(None, None), None);
    }
}
