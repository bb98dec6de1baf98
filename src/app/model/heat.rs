//! Colour map of figures, dark for low and bright for high.

/// Stops of viridis (van der Walt and Smith, public domain). Equal steps look equal, also in grey
/// and with any common colour vision.
const STOPS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Returns red, green and blue for a value from 0 (dark) to 1 (bright).
pub fn rgb(share: f32) -> [u8; 3] {
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = share * (STOPS.len() - 1) as f32;
    let first = (place as usize).min(STOPS.len() - 2);
    let (a, b) = (STOPS[first], STOPS[first + 1]);
    let part = place - first as f32;
    let mixed = |k: usize| (f32::from(a[k]) + (f32::from(b[k]) - f32::from(a[k])) * part).round() as u8;
    [mixed(0), mixed(1), mixed(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_increases_with_the_value() {
        let luminance = |share: f32| {
            let [r, g, b] = rgb(share);
            0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
        };
        for k in 0..40 {
            assert!(luminance((k + 1) as f32 / 40.0) > luminance(k as f32 / 40.0), "{k}");
        }
        assert_eq!(rgb(f32::NAN), rgb(0.0));
    }
}
