//! Random choice of further true matches, for methods that need more than the clicked ones.

use rand::RngExt;

use super::random::{Purpose, generator};
use crate::geometry::{Frame, FundamentalMatrix, PointPair};

/// Minimum distance of clicked points in both images, px, as in the published experiment.
pub const SPACING: f64 = 30.0;

/// Ground truth that determines the clicks: everything about an image pair except its pixels.
#[derive(Debug, Clone, Copy)]
pub struct KnownPair<'a> {
    /// Name of the pair.
    pub name: &'a str,
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// True F.
    pub truth: &'a FundamentalMatrix,
    /// All true matches.
    pub matches: &'a [PointPair],
}

impl KnownPair<'_> {
    /// Adds random true matches to clicked pairs until there are `count`. Each is at least 30 px
    /// from all earlier ones in both images. Returns the indices of the added matches, or `None` if
    /// there are not enough. The result depends only on `seed` and `trial`.
    pub fn further(
        &self,
        clicked: &[PointPair],
        count: usize,
        seed: u64,
        trial: usize,
    ) -> Option<Vec<usize>> {
        let mut random = generator(seed, self.name, Purpose::Further, trial);
        let mut all = clicked.to_vec();
        let mut added = Vec::new();
        while all.len() < count {
            let free: Vec<_> = (0..self.matches.len())
                .filter(|k| self.matches[*k].is_inside(self.frames))
                .filter(|k| all.iter().all(|other| apart(other, &self.matches[*k])))
                .collect();
            if free.is_empty() {
                return None;
            }
            let chosen = free[random.random_range(0..free.len())];
            added.push(chosen);
            all.push(self.matches[chosen]);
        }
        Some(added)
    }
}

/// Returns whether two matches are far enough apart in both images.
pub fn apart(p: &PointPair, q: &PointPair) -> bool {
    (p.point1 - q.point1).norm() >= SPACING && (p.point2 - q.point2).norm() >= SPACING
}
