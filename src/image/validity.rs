//! Pixels that are no picture: missing data, the corners around a rotated image, transparent areas.
//!
//! Such pixels are filled smoothly from their surroundings, so that no false edge arises, and nothing
//! is detected or compared near them. Holes of one or two pixels, such as dead pixels, are filled and
//! not kept away from: the pixels around a hole tell its value.

use crate::geometry::{Frame, Point};

/// Distances of the pixels of an image from the nearest pixel that is no picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Validity {
    frame: Frame,
    /// Distance of each pixel, the larger of its two coordinates, px; at most [`FAR`]. Zero is no
    /// picture.
    distances: Vec<u8>,
}

/// The largest distance that is told apart, px.
const FAR: u8 = u8::MAX;

impl Validity {
    /// Computes the distances. `valid` tells row by row which pixels are picture.
    #[cfg_attr(not(feature = "pictures"), expect(dead_code, reason = "the decoders mark missing pixels"))]
    pub fn new(frame: Frame, valid: &[bool]) -> Self {
        let mut distances = vec![FAR; valid.len()];
        // Regions are squares of 3×3 pixels and their unions.
        let Frame { width, height } = frame;
        for y in 1..height.saturating_sub(1) {
            for x in 1..width.saturating_sub(1) {
                let rows = [y - 1, y, y + 1].map(|v| v * width + x - 1);
                if rows.iter().all(|first| valid[*first..first + 3].iter().all(|valid| !valid)) {
                    for first in rows {
                        distances[first..first + 3].fill(0);
                    }
                }
            }
        }
        spread(frame, &mut distances);
        for (distance, _) in distances.iter_mut().zip(valid).filter(|(_, valid)| !**valid) {
            *distance = 0;
        }
        Self { frame, distances }
    }

    /// Returns whether all pixels are picture within a distance of a point, px. Places outside the image
    /// count like its border.
    pub fn is_clear(&self, point: Point, reach: f64) -> bool {
        let at = |v: f64, end: usize| v.round().clamp(0.0, end.saturating_sub(1) as f64) as usize;
        let (x, y) = (at(point.x, self.frame.width), at(point.y, self.frame.height));
        f64::from(self.distances[y * self.frame.width + x]) > reach.min(f64::from(FAR) - 1.0)
    }

    /// Returns whether the pixel of this index, counted row by row, is picture.
    pub fn is_picture(&self, k: usize) -> bool {
        self.distances[k] > 0
    }

    /// Returns the distances in the picture of half the size.
    pub fn halved(&self) -> Self {
        let Frame { width, .. } = self.frame;
        let frame = Frame::new(width / 2, self.frame.height / 2);
        let distance = |k: usize| {
            let first = k / frame.width * 2 * width + k % frame.width * 2;
            let four = [first, first + 1, first + width, first + width + 1].map(|k| self.distances[k]);
            // A single pixel is a hole.
            let masked = four.into_iter().map(|distance| usize::from(distance == 0)).sum::<usize>();
            let nearest = four.into_iter().filter(|distance| *distance > 0).min();
            match nearest {
                Some(FAR) => FAR,
                Some(nearest) if masked < 2 => nearest.div_ceil(2),
                _ => 0,
            }
        };
        Self { frame, distances: (0..frame.width * frame.height).map(distance).collect() }
    }
}

/// Spreads distances from the pixels of distance zero.
fn spread(frame: Frame, distances: &mut [u8]) {
    let Frame { width, height } = frame;
    let mut visit = |x: usize, y: usize, back: bool| {
        let neighbours =
            if back { [(1, 0), (1, 1), (0, 1), (-1, 1)] } else { [(-1, 0), (-1, -1), (0, -1), (1, -1)] };
        let k = y * width + x;
        for (dx, dy) in neighbours {
            let (u, v) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
            if u < width && v < height {
                distances[k] = distances[k].min(distances[v * width + u].saturating_add(1));
            }
        }
    };
    for y in 0..height {
        (0..width).for_each(|x| visit(x, y, false));
    }
    for y in (0..height).rev() {
        (0..width).rev().for_each(|x| visit(x, y, true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { width: 64, height: 48 };

    /// Marks a rectangle and a single pixel.
    fn flags() -> Vec<bool> {
        let is_valid = |x: usize, y: usize| !((10..30).contains(&x) && y < 12 || (x, y) == (50, 40));
        (0..FRAME.height).flat_map(|y| (0..FRAME.width).map(move |x| is_valid(x, y))).collect()
    }

    #[test]
    fn a_region_is_kept_away_from_and_a_hole_is_not() {
        let validity = Validity::new(FRAME, &flags());
        let clear = |x: f64, y: f64, reach: f64| validity.is_clear(Point::new(x, y), reach);
        assert!(!clear(10.0, 0.0, 0.0) && !clear(29.0, 11.0, 0.0) && !clear(50.0, 40.0, 0.0));
        assert!(clear(35.0, 6.0, 5.0) && !clear(35.0, 6.0, 6.0));
        assert!(clear(33.0, 15.0, 3.0) && !clear(33.0, 15.0, 4.0));
        assert!(clear(51.0, 40.0, 10.0), "beside a hole");
        assert!(clear(60.0, 47.0, 20.0) && !clear(-3.0, -3.0, 10.0) && clear(-3.0, -3.0, 9.0));
        let half = validity.halved();
        let clear = |x: f64, y: f64, reach: f64| half.is_clear(Point::new(x, y), reach);
        assert!(!clear(5.0, 5.0, 0.0) && !clear(14.0, 5.0, 0.0) && clear(15.0, 5.0, 0.0));
        assert!(!clear(17.0, 3.0, 3.0) && clear(18.0, 3.0, 2.0) && clear(25.0, 20.0, 5.0));
        let all = Validity::new(FRAME, &[true; 64 * 48]);
        assert!(all.is_clear(Point::new(3.0, 3.0), 1e9) && (0..64 * 48).all(|k| all.is_picture(k)));
    }
}
