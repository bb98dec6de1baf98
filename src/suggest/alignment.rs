//! Affine alignment of a patch of the clicked image to a place in the other image.
//!
//! Samples outside either image are ignored, so patches at borders use the visible part.

use crate::geometry::Point;
use crate::image::{Alignment, GrayPlane, HALF, LEAST_INSIDE, Placement, align, offsets};

/// Patch of the clicked plane around `at`, and the plane to align it in.
#[derive(Clone, Copy)]
pub(super) struct Aligner<'a> {
    pub from: &'a GrayPlane,
    pub to: &'a GrayPlane,
    pub at: Point,
}

impl Aligner<'_> {
    /// Returns the best placement near `start`; `None` when the alignment diverges or too little of
    /// the patch is inside.
    pub fn align(&self, start: Placement) -> Option<Placement> {
        align([self.from, self.to], self.at, start, &Alignment::LENIENT)
    }

    /// Returns the normalised correlation of the patch at a placement, −1 to 1; 0 where it is flat
    /// or mostly outside.
    pub fn correlation(&self, placed: &Placement) -> f64 {
        let (mut n, mut a, mut b, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for x in offsets(HALF) {
            let (p, q) = (self.at + x, placed.at + placed.affine * x);
            if !self.from.frame().contains(p) || !self.to.frame().contains(q) {
                continue;
            }
            let (u, v) = (f64::from(self.from.sample(p)), f64::from(self.to.sample(q)));
            n += 1.0;
            a += u;
            b += v;
            aa += u * u;
            bb += v * v;
            ab += u * v;
        }
        if n < LEAST_INSIDE * offsets(HALF).count() as f64 {
            return 0.0;
        }
        let variances = [aa - a * a / n, bb - b * b / n];
        let least = f64::from(super::template::LEAST_CONTRAST).powi(2) * n;
        if variances.iter().any(|v| *v < least) {
            return 0.0;
        }
        (ab - a * b / n) / (variances[0] * variances[1]).sqrt()
    }
}
