//! Patch support: the evidence of small patches for a geometry.
//!
//! Intensities along a line can be matched wrongly; patches much less often. Corners of both images
//! and the correlations of their patches are computed once for an image pair. The support of any
//! `F` is then the set of mutual best matches among corners within a few pixels of each other's
//! epipolar lines. Each match counts by the excess of its correlation over a threshold.

use rayon::prelude::*;

use super::corner_patches::{CornerPatches, Likeness};
use super::feature_support::{FLOOR, FeatureMatches};
use super::level_corners::CORRELATION_NOISE;
use super::look_alikes::{LookAlikes, Putative};
use super::matches::RefinedMatch;
use super::near_lines::is_within;
use crate::geometry::{FundamentalMatrix, Point, PointPair};
use serde::Serialize;

/// Largest distance of a supporting corner from the epipolar line of its partner, px of the level.
/// Corners are found to a pixel in each image, and the geometry is not yet refined.
pub(in crate::estimate) const BAND: f64 = 2.0;

/// Number of equal parts of the evidence in the course of a support.
pub const CHECKPOINTS: usize = 16;

/// Patches that agree with a geometry.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PatchSupport {
    /// Number of mutual best matches along the epipolar lines.
    pub matches: usize,
    /// Sum of their correlations in excess of 0.6.
    pub score: f64,
}

/// Patch support at one size of the images.
#[derive(Debug)]
pub(in crate::estimate) struct SupportLevel {
    /// Size of each image over its full size.
    pub scales: [f64; 2],
    /// Corners and look-alikes, in pixels of this size.
    pub support: Support,
}

/// Corners of two images and the pairs of them that look alike.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Support {
    corners: [Vec<Point>; 2],
    /// Pairs of look-alike corners, with correlations above [`FLOOR`], grouped by corner of image
    /// 1, best first.
    pub pairs: Vec<Putative>,
    /// The same pairs, laid out for the vector units.
    look_alikes: LookAlikes,
    /// Matches of covariant features, which support beside corners.
    features: FeatureMatches,
}

/// Least correlation of a distinctive match: half-way between the floor of support and equal
/// patches.
pub(super) const DISTINCTIVE: f32 = 0.8;
/// Least lead of a distinctive match over the next look-alike: twice the noise of the correlation
/// of a right match.
const DISTINCTIVE_BY: f32 = 2.0 * CORRELATION_NOISE;
/// Number of look-alikes kept for a corner, best first. In repeated structure there are more; they
/// would take memory and time without telling geometries apart.
const PER_CORNER: usize = 16;

impl Support {
    /// Compares all corners of image 1 with all of image 2.
    pub fn new(patches: &CornerPatches) -> Self {
        let corners = [patches.points1.clone(), patches.points2.clone()];
        let pairs = best_look_alikes(patches.look_alikes(), corners[0].len());
        Self::of_look_alikes(corners, pairs)
    }

    /// Returns support of corners and the pairs that look alike.
    pub(super) fn of_look_alikes(corners: [Vec<Point>; 2], pairs: Vec<Putative>) -> Self {
        let look_alikes = LookAlikes::new(&corners, &pairs);
        Self { corners, pairs, look_alikes, features: FeatureMatches::default() }
    }

    /// Returns this support with matches of covariant features added.
    #[must_use]
    pub fn with_features(self, features: Vec<RefinedMatch>) -> Self {
        Self { features: FeatureMatches::new(features), ..self }
    }

    /// Returns the distinctive matches, found without a geometry: each corner looks like the other,
    /// and like no third by nearly as much.
    pub fn distinctive(&self) -> Vec<PointPair> {
        let stands_out = |group: &&Vec<Putative>| {
            let next = group.get(1).map_or(FLOOR, |m| m.correlation);
            group[0].correlation > DISTINCTIVE && group[0].correlation > next + DISTINCTIVE_BY
        };
        self.mutual_best(|_| true).iter().filter(stands_out).map(|group| self.pair(&group[0])).collect()
    }

    /// Returns the look-alikes of each corner of image 1 whose best one is mutual, best first. Only
    /// pairs that are `possible` take part.
    pub fn mutual_best(&self, possible: impl Fn(&PointPair) -> bool) -> Vec<Vec<Putative>> {
        let possible: Vec<Putative> =
            self.pairs.iter().filter(|pair| possible(&self.pair(pair))).copied().collect();
        let mut best2 = vec![(0.0, u32::MAX); self.corners[1].len()];
        for pair in &possible {
            let best = &mut best2[pair.corner2 as usize];
            if pair.correlation > best.0 {
                *best = (pair.correlation, pair.corner1);
            }
        }
        possible
            .chunk_by(|a, b| a.corner1 == b.corner1)
            .filter(|group| best2[group[0].corner2 as usize].1 == group[0].corner1)
            .map(<[Putative]>::to_vec)
            .collect()
    }

    pub fn pair(&self, m: &Putative) -> PointPair {
        PointPair { point1: self.corners[0][m.corner1 as usize], point2: self.corners[1][m.corner2 as usize] }
    }

    /// Returns the mutual best matches within `band` px of each other's epipolar lines, of corners
    /// and of features.
    pub fn matches(&self, f: &FundamentalMatrix, band: f64) -> Vec<RefinedMatch> {
        let mut found = Vec::new();
        self.for_each_mutual(f, band, |m| {
            found.push(RefinedMatch { pair: self.pair(m), correlation: m.correlation });
        });
        found.extend(self.features.within(f, band));
        found
    }

    /// Returns the score of [`Self::measure`] counted so far after each of [`CHECKPOINTS`] equal parts of the
    /// corners of image 1 and of the matches of features.
    pub fn course(&self, f: &FundamentalMatrix) -> Vec<f64> {
        let mut course = vec![0.0; CHECKPOINTS];
        let mut count = |k: usize, of: usize, correlation: f32| {
            course[k * CHECKPOINTS / of] += f64::from(correlation - FLOOR);
        };
        self.for_each_mutual(f, BAND, |m| count(m.corner1 as usize, self.corners[0].len(), m.correlation));
        let features = self.features.len();
        self.features.numbered_within(f, BAND).for_each(|(k, m)| count(k, features, m.correlation));
        let mut sum = 0.0;
        for score in &mut course {
            sum += *score;
            *score = sum;
        }
        course
    }

    /// Calls `found` with each mutual best match of corners, in the order of the corners of image
    /// 1.
    fn for_each_mutual(&self, f: &FundamentalMatrix, band: f64, mut found: impl FnMut(&Putative)) {
        const NONE: u32 = u32::MAX;
        // Indices of the best pair of each corner of either image.
        let [mut best1, mut best2] = self.corners.each_ref().map(|corners| vec![NONE; corners.len()]);
        for k in self.look_alikes.near(f, band) {
            let pair = &self.pairs[k as usize];
            if !is_within(f, &self.pair(pair), band) {
                continue;
            }
            for best in [&mut best1[pair.corner1 as usize], &mut best2[pair.corner2 as usize]] {
                if *best == NONE || pair.correlation > self.pairs[*best as usize].correlation {
                    *best = k;
                }
            }
        }
        for k in best1 {
            if k != NONE && best2[self.pairs[k as usize].corner2 as usize] == k {
                found(&self.pairs[k as usize]);
            }
        }
    }

    /// Returns an upper bound on the score of [`Self::measure`], in a fraction of its time.
    pub fn most(&self, f: &FundamentalMatrix) -> f64 {
        let sum = self.look_alikes.most_support(f, BAND) + self.features.most_support(f, BAND);
        // The margin exceeds the rounding of a few thousand single-precision terms.
        f64::from(sum) * 1.001
    }

    /// Returns the number of matches that agree with a geometry, and their summed excess over the
    /// floor.
    pub fn measure(&self, f: &FundamentalMatrix) -> PatchSupport {
        let mut support = PatchSupport::default();
        let mut count = |correlation: f32| {
            support.matches += 1;
            support.score += f64::from(correlation - FLOOR);
        };
        self.for_each_mutual(f, BAND, |m| count(m.correlation));
        self.features.within(f, BAND).for_each(|m| count(m.correlation));
        support
    }
}

/// Returns the best look-alikes of each corner of image 1, best first.
fn best_look_alikes(of_corners2: &[Vec<(u32, Likeness)>], corners1: usize) -> Vec<Putative> {
    let mut alike: Vec<Vec<Putative>> = vec![Vec::new(); corners1];
    for (found, corner2) in of_corners2.iter().zip(0..) {
        for (corner1, Likeness { correlation, .. }) in found {
            if *correlation > FLOOR {
                let pair = Putative { corner1: *corner1, corner2, correlation: *correlation };
                alike[*corner1 as usize].push(pair);
            }
        }
    }
    alike.par_iter_mut().for_each(|group| {
        group.sort_by(|a, b| b.correlation.total_cmp(&a.correlation).then(a.corner2.cmp(&b.corner2)));
        group.truncate(PER_CORNER);
    });
    alike.concat()
}

#[cfg(test)]
impl Support {
    /// Returns support of corners with one look-alike each.
    pub fn of_matches(matches: &[(PointPair, f32)]) -> Self {
        let corners = [
            matches.iter().map(|(m, _)| m.point1).collect(),
            matches.iter().map(|(m, _)| m.point2).collect(),
        ];
        let putative = |(k, (_, correlation)): (usize, &(PointPair, f32))| Putative {
            corner1: k as u32,
            corner2: k as u32,
            correlation: *correlation,
        };
        Self::of_look_alikes(corners, matches.iter().enumerate().map(putative).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::rows as rows_below;
    use crate::estimate::exact::rows;
    use crate::geometry::Frame;
    use crate::image::{GrayPlane, PyramidPair, Warp};

    /// Returns two views of one texture, the second shifted along the rows by 6 px.
    fn planes() -> [GrayPlane; 2] {
        let texture = |x: usize, y: usize| {
            let cell =
                ((x / 5) as u64).wrapping_mul(0x9E37_79B9) ^ ((y / 6) as u64).wrapping_mul(0x85EB_CA6B);
            (cell.wrapping_mul(0xC2B2_AE35_85EB_CA77) >> 56) as f32
        };
        let frame = Frame::new(160, 120);
        [GrayPlane::from_fn(frame, texture), GrayPlane::from_fn(frame, |x, y| texture(x + 6, y))]
    }

    #[test]
    fn the_right_geometry_has_most_support() {
        let [a, b] = planes();
        let pair = PyramidPair::new(&a, &b, 48.0);
        let support =
            Support::new(&CornerPatches::new(&pair.level(f64::INFINITY), 200, vec![Warp::identity()]));
        let right = support.measure(&rows(0.0)).score;
        for wrong in [rows(7.0), rows(-15.0)] {
            let other = support.measure(&wrong).score;
            assert!(right > 1.5 * other, "{right} against {other}");
        }
        let course = support.course(&rows(0.0));
        assert!(course.len() == CHECKPOINTS && course.is_sorted() && course[3] > 0.0);
        assert!((course[CHECKPOINTS - 1] - right).abs() < 1e-9 * right, "the course ends at the support");
        let matches = support.matches(&rows(0.0), 2.0);
        let true_matches =
            matches.iter().filter(|m| (m.pair.point1.x - m.pair.point2.x - 6.0).abs() < 0.5).count();
        assert!(true_matches * 10 > matches.len() * 8, "{true_matches} of {}", matches.len());
    }

    #[test]
    fn images_without_corners_have_no_support() {
        let flat = GrayPlane::from_fn(Frame::new(60, 60), |_, _| 9.0);
        let pair = PyramidPair::new(&flat, &flat, 48.0);
        let support =
            Support::new(&CornerPatches::new(&pair.level(f64::INFINITY), 50, vec![Warp::identity()]));
        assert!(support.matches(&rows(0.0), 3.0).is_empty());
    }

    /// Returns look-alikes by the heights of their corners: index in both images, correlation.
    fn at_heights(y1: &[f64], y2: &[f64], alike: &[(u32, u32, f32)]) -> Support {
        let corners = [y1, y2].map(|all| all.iter().map(|y| Point::new(90.0 + 0.1 * y, *y)).collect());
        let putative = |(corner1, corner2, correlation): &(u32, u32, f32)| Putative {
            corner1: *corner1,
            corner2: *corner2,
            correlation: *correlation,
        };
        Support::of_look_alikes(corners, alike.iter().map(putative).collect())
    }

    #[test]
    fn a_match_counts_up_to_the_band_and_no_farther() {
        // Positions are compared in 32 bits, whose rounding is far below a thousandth of a pixel.
        for (offset, expected) in
            [(0.0, 1), (BAND - 1e-3, 1), (BAND + 1e-3, 0), (1e-3 - BAND, 1), (-1e-3 - BAND, 0)]
        {
            let support = at_heights(&[140.0], &[140.0 + 5.0 + offset], &[(0, 0, 0.85)]);
            let found = support.measure(&rows_below(5.0));
            assert_eq!(found.matches, expected, "{offset} px off");
            let score = expected as f64 * f64::from(0.85 - FLOOR);
            assert!((found.score - score).abs() < 1e-12);
            assert_eq!(support.matches(&rows_below(5.0), BAND + 1.0).len(), 1, "a wider band holds it");
        }
    }

    #[test]
    fn the_band_holds_in_both_images() {
        // y1 = 2 y2: an error of 1.5 px in image 2 is 3 px in image 1.
        let zoomed = nalgebra::Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0, 1.0, 0.0);
        let f = FundamentalMatrix::from_rank_two(zoomed).unwrap();
        for (y2, expected) in [(20.9, 1), (21.5, 0)] {
            let support = at_heights(&[40.0], &[y2], &[(0, 0, 0.9)]);
            assert_eq!(support.matches(&f, BAND).len(), expected);
            let swapped = at_heights(&[y2], &[40.0], &[(0, 0, 0.9)]);
            assert_eq!(swapped.matches(&f.swapped(), BAND).len(), expected);
        }
    }

    #[test]
    fn matches_are_the_best_of_both_their_corners() {
        let heights = [100.0, 101.0, 200.0];
        // The first corner's best partner prefers the second corner. The first corner then has no
        // match.
        let alike = [(0, 0, 0.9), (0, 1, 0.95), (1, 1, 0.97), (2, 2, 0.7)];
        let support = at_heights(&heights, &heights, &alike);
        let found = support.measure(&rows_below(0.0));
        assert_eq!(found.matches, 2);
        assert!((found.score - f64::from(0.97 - FLOOR) - f64::from(0.7 - FLOOR)).abs() < 1e-12);
        // Where the better look-alike is off the line, the next one counts.
        let support = at_heights(&heights, &[100.0, 150.0, 200.0], &alike);
        let pairs: Vec<PointPair> = support.matches(&rows_below(0.0), BAND).iter().map(|m| m.pair).collect();
        assert_eq!(pairs.iter().map(|m| m.point2.y as i32).collect::<Vec<_>>(), [100, 200]);
    }

    #[test]
    fn every_look_alike_of_a_corner_counts() {
        // More look-alikes than the vector units take at once; only the last lies on the line.
        let count = 2 * 16 + 3;
        let heights: Vec<f64> = (0..count).map(|k| 200.0 - 10.0 * f64::from(k)).collect();
        let alike: Vec<_> = (0..count).map(|k| (0, k, 0.9 - 0.01 * k as f32)).collect();
        let support = at_heights(&[heights[count as usize - 1]], &heights, &alike);
        let found = support.matches(&rows_below(0.0), BAND);
        assert_eq!(found.len(), 1);
        assert!((found[0].correlation - (0.9 - 0.01 * (count - 1) as f32)).abs() < 1e-6);
    }

    #[test]
    fn a_corner_keeps_its_best_look_alikes_in_order() {
        let alike = |corner1: u32, corner2: u32| Putative {
            corner1,
            corner2,
            correlation: 0.61 + 0.01 * (corner2 % 7) as f32,
        };
        let likeness = |pair: Putative| Likeness { correlation: pair.correlation, warp: 0 };
        let mut found: Vec<Vec<(u32, Likeness)>> =
            (0..PER_CORNER as u32 + 6).map(|corner2| vec![(2, likeness(alike(2, corner2)))]).collect();
        found[3].push((0, likeness(alike(0, 3))));
        // At the floor.
        found[4].push((1, Likeness { correlation: FLOOR, warp: 0 }));
        let best = best_look_alikes(&found, 3);
        assert_eq!(best.len(), 1 + PER_CORNER);
        assert_eq!(best[0], alike(0, 3));
        let key = |m: &Putative| (-m.correlation, m.corner2);
        assert!(best[1..].is_sorted_by(|a, b| a.corner1 == 2 && key(a) < key(b)));
        assert_eq!(best[1].corner2, 6);
    }
}
