//! Words for the meaning of the numbers of a picture file.

use crate::image::Interpretation;

/// Ranges that the numbers of pictures have as a rule: of floating point, 8 bits and 16 bits.
const USUAL: [[f64; 2]; 3] = [[0.0, 1.0], [0.0, 255.0], [0.0, 65535.0]];

/// Tells the range of the numbers, masked pixels and bands that are not used; `None` for a usual picture.
pub fn interpretation_in_words(interpretation: &Interpretation) -> Option<String> {
    let Interpretation { range, masked, bands } = interpretation;
    let range = range.filter(|range| !USUAL.contains(range)).map(range_in_words);
    let masked = masked.map(|share| {
        let percent = 100.0 * share;
        if percent < 1.0 { "under 1 % masked".to_owned() } else { format!("{percent:.0} % masked") }
    });
    let bands = bands.map(|bands| format!("band 1 of {bands}"));
    let parts: Vec<String> = [range, masked, bands].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// Names the ends of a range with the digits that tell them apart.
fn range_in_words([low, high]: [f64; 2]) -> String {
    let size = high.abs().max(low.abs());
    // Three digits of the width of the range.
    let digits = 2.0 - (high - low).log10().floor();
    if !(1e-4..1e9).contains(&size) || !digits.is_finite() {
        return format!("range {low:.3e} to {high:.3e}");
    }
    let digits = digits.clamp(0.0, 9.0) as usize;
    format!("range {low:.digits$} to {high:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusual_numbers_are_told() {
        let told = |range, masked, bands| interpretation_in_words(&Interpretation { range, masked, bands });
        assert_eq!(told(None, None, None), None);
        assert_eq!(told(Some([0.0, 65535.0]), None, None), None);
        assert_eq!(told(Some([29000.0, 30020.0]), None, None).unwrap(), "range 29000 to 30020");
        assert_eq!(
            told(Some([15.25, 24.75]), Some(0.123), None).unwrap(),
            "range 15.25 to 24.75, 12 % masked"
        );
        assert_eq!(told(Some([0.0, 3e12]), None, None).unwrap(), "range 0.000e0 to 3.000e12");
        assert_eq!(
            told(Some([5.0, 5.0]), Some(1e-5), Some(8)).unwrap(),
            "range 5.000e0 to 5.000e0, under 1 % masked, band 1 of 8"
        );
    }
}
