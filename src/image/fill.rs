//! Values for pixels that are no picture: smooth, so that no false edge arises.

use super::GrayPlane;
use crate::geometry::{Frame, Point};

/// Fills the pixels that are no picture from their surroundings: with the mean of the picture in the
/// smallest squares, doubled in size step by step, that hold a part of it.
pub(super) fn fill(frame: Frame, values: &mut [f32], valid: &[bool]) {
    let Frame { width, height } = frame;
    if valid.iter().all(|valid| *valid) || !valid.contains(&true) {
        return;
    }
    let half = Frame::new(width.div_ceil(2), height.div_ceil(2));
    let (mut means, mut known) =
        (vec![0f32; half.width * half.height], vec![false; half.width * half.height]);
    for (k, mean) in means.iter_mut().enumerate() {
        let (x, y) = (2 * (k % half.width), 2 * (k / half.width));
        let (mut sum, mut count) = (0f32, 0f32);
        for k in (y..height.min(y + 2)).flat_map(|v| (x..width.min(x + 2)).map(move |u| v * width + u)) {
            if valid[k] {
                sum += values[k];
                count += 1.0;
            }
        }
        (*mean, known[k]) = (sum / count.max(1.0), count > 0.0);
    }
    fill(half, &mut means, &known);
    let coarse = GrayPlane::new(half, means);
    for k in (0..values.len()).filter(|k| !valid[*k]) {
        // Bilinear, so that the squares do not show.
        let at = |v: usize| 0.5 * (v as f64 - 0.5);
        values[k] = coarse.sample(Point::new(at(k % width), at(k / width)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { width: 64, height: 48 };
    const HOLE: usize = 40 * FRAME.width + 50;

    #[test]
    fn filled_pixels_continue_their_surroundings() {
        let valid: Vec<bool> = (0..FRAME.width * FRAME.height)
            .map(|k| !((10..30).contains(&(k % FRAME.width)) && k / FRAME.width < 12 || k == HOLE))
            .collect();
        let ramp = |k: usize| (2 * (k % FRAME.width) + 3 * (k / FRAME.width)) as f32;
        let mut values: Vec<f32> = (0..valid.len()).map(ramp).collect();
        for (value, _) in values.iter_mut().zip(&valid).filter(|(_, valid)| !**valid) {
            *value = -9999.0;
        }
        fill(FRAME, &mut values, &valid);
        for (k, value) in values.iter().enumerate() {
            if valid[k] {
                assert!((value - ramp(k)).abs() < 1e-6);
            } else {
                assert!((0.0..300.0).contains(value), "{value}");
            }
        }
        assert!((values[HOLE] - ramp(HOLE)).abs() < 4.0);
        let edge = 6 * FRAME.width + 30;
        assert!((values[edge] - values[edge - 1]).abs() < 8.0, "no edge");
        let mut nothing = [1.0; 4];
        fill(Frame::new(2, 2), &mut nothing, &[false; 4]);
        assert!(nothing.iter().all(|v| (v - 1.0).abs() < 1e-6));
    }
}
