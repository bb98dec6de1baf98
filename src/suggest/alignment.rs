//! How well a patch of the clicked image fits a place in the other one.
//!
//! Samples that fall outside either image do not count, so patches at borders work with what is there.

use crate::geometry::Point;
use crate::image::{Alignment, GrayPlane, LEAST_INSIDE, Placement, align, offsets};

/// A patch in the clicked plane and a plane to find it in.
#[derive(Clone, Copy)]
pub(super) struct Aligner<'a> {
    pub from: &'a GrayPlane,
    pub to: &'a GrayPlane,
    pub at: Point,
}

impl Aligner<'_> {
    /// The best placement near `start`; `None` when it runs away or too little of the patch is inside.
    pub fn align(&self, start: Placement) -> Option<Placement> {
        align([self.from, self.to], self.at, start, &Alignment::LENIENT)
    }

    /// Correlation of the patch with what lies there, −1 to 1; 0 where it is flat or mostly outside.
    pub fn correlation(&self, placed: &Placement) -> f64 {
        let (mut n, mut a, mut b, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for x in offsets() {
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
        if n < LEAST_INSIDE * offsets().count() as f64 {
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
