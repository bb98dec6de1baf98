//! Image pyramids: one picture at successively smaller sizes.

use super::GrayPlane;
use super::validity::Validity;
use crate::geometry::Frame;

/// A picture halved repeatedly, finest level first.
///
/// Each level is the 2×2 box average of the previous level. Pixel centres map as
/// `x_fine = 2·x_coarse + ½`, in general as `x' = (x + ½)·scale − ½`. An odd last row or column is
/// dropped.
#[derive(Debug, Clone)]
pub struct Pyramid {
    levels: Vec<GrayPlane>,
}

impl Pyramid {
    /// Builds all levels down to a longer side of at least `smallest` px.
    pub fn new(plane: &GrayPlane, smallest: f64) -> Self {
        let mut levels = vec![plane.clone()];
        while let Some(last) = levels.last()
            && last.frame().longer_side() / 2.0 >= smallest
            && last.frame().width >= 2
            && last.frame().height >= 2
        {
            let next = halved(last);
            levels.push(next);
        }
        Self { levels }
    }

    /// Returns level `k`, the picture at scale `2⁻ᵏ`, or the coarsest level if there are fewer.
    pub fn level(&self, k: usize) -> &GrayPlane {
        &self.levels[k.min(self.levels.len() - 1)]
    }

    /// Returns the number of levels, at least one.
    pub fn count(&self) -> usize {
        self.levels.len()
    }
}

/// Returns the 2×2 box average of a plane.
fn halved(plane: &GrayPlane) -> GrayPlane {
    let frame = Frame::new(plane.frame().width / 2, plane.frame().height / 2);
    let half = GrayPlane::from_strips(frame, 1, |y, out| {
        let (top, bottom) = (plane.row(2 * y), plane.row(2 * y + 1));
        for (x, value) in out.iter_mut().enumerate() {
            *value = 0.25 * (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1]);
        }
    });
    half.with_validity(plane.validity().map(Validity::halved))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_stays_the_same_ramp_under_the_stated_mapping() {
        let plane = GrayPlane::from_fn(Frame::new(33, 17), |x, y| (3 * x + 5 * y) as f32);
        let pyramid = Pyramid::new(&plane, 4.0);
        assert_eq!(pyramid.count(), 4);
        for k in 1..pyramid.count() {
            let scale = 0.5f64.powi(k as i32);
            let level = pyramid.level(k);
            let fine = |v: usize| (v as f64 + 0.5) / scale - 0.5;
            let expected = 3.0 * fine(1) + 5.0 * fine(1);
            assert!((f64::from(level.at(1, 1)) - expected).abs() < 1e-3);
        }
    }

    #[test]
    fn tiny_pictures_have_one_level() {
        let plane = GrayPlane::from_fn(Frame::new(1, 1), |_, _| 7.0);
        assert_eq!(Pyramid::new(&plane, 16.0).count(), 1);
    }
}
