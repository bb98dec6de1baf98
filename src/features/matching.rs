//! Mutual nearest neighbours of two sets of features.
//!
//! Descriptor distances are Euclidean and exact integers, so that every machine ranks alike. A
//! match joins two features that are each other's nearest neighbour.
//!
//! The **ratio** of a match is the distance to the nearest neighbour over the distance to the next
//! neighbour *at another place* (Lowe 2004, section 7.1). Mishkin, Matas & Perdoch (2015) call this
//! neighbour "first geometrically inconsistent". The larger ratio of both directions counts. The
//! ratio is near zero for distinctive features and near one for repeated structure. No ratio test
//! is applied: samplers can prefer low ratios, and scores can weight by them.

use std::collections::HashMap;

use rayon::prelude::*;

use super::neighbours::{KEPT, NONE, Neighbours, add, insert, nearest_neighbours, squared_distances};
use super::{Feature, FeatureSet};
use crate::geometry::{Point, PointPair};

/// Two features that are each other's nearest neighbour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureMatch {
    /// Index of the feature in image 1.
    pub feature1: usize,
    /// Index of the feature in image 2.
    pub feature2: usize,
    /// Positions of the two features, px.
    pub pair: PointPair,
    /// Descriptor distance over the distance to the next neighbour at another place, 0 to 1.
    pub ratio: f64,
}

/// Largest distance between two features at the same place, in units of the larger scale.
const SAME_PLACE: f64 = 3.0;
/// Largest distance of repeated matches, px.
const REPEATED: f64 = 8.0;

/// Nearest neighbours of the features of two sets, from which larger sets are matched later.
#[derive(Debug, Clone, Default)]
pub(crate) struct KnownNeighbours {
    /// Neighbours in set 2 of each feature of set 1.
    near2: Vec<Neighbours>,
    /// Neighbours in set 1 of each feature of set 2.
    near1: Vec<Neighbours>,
}

/// Returns all mutual nearest neighbours, lowest ratio first. Keeps the first of several matches at
/// the same two places.
pub fn match_features(set1: &FeatureSet, set2: &FeatureSet) -> Vec<FeatureMatch> {
    KnownNeighbours::default().extended(set1, set2).matches([set1, set2])
}

impl KnownNeighbours {
    /// Returns the neighbours of two sets that begin with the features of the known ones.
    pub fn extended(&self, set1: &FeatureSet, set2: &FeatureSet) -> Self {
        let (known1, known2) = (self.near2.len(), self.near1.len());
        let all2 = set2.descriptors();
        let (old1, new1) = set1.descriptors().split_at(known1);
        let [more2, of_new2] = nearest_neighbours(old1, &all2[known2..]);
        let [of_new1, more1] = nearest_neighbours(new1, all2);
        let Self { mut near2, mut near1 } = self.clone();
        // Neighbours are added in their order, so that the first of equal ones stays first.
        add(&mut near2, &more2, known2);
        near2.extend(of_new1);
        near1.extend(of_new2);
        add(&mut near1, &more1, known1);
        Self { near2, near1 }
    }

    /// Returns the features of these sets that are each other's nearest neighbour, as [`match_features`] does.
    pub fn matches(&self, sets: [&FeatureSet; 2]) -> Vec<FeatureMatch> {
        let mut matches = mutual(sets, &self.near2, &self.near1);
        matches.sort_by(|a, b| a.ratio.total_cmp(&b.ratio).then(a.feature1.cmp(&b.feature1)));
        // A blob with several orientations is matched once for each.
        let mut seen = std::collections::HashSet::new();
        matches.retain(|m| seen.insert(m.pair.numbers().map(f64::to_bits)));
        matches
    }
}

/// Removes repeated matches, those within the smaller scale of an earlier match at both ends. A
/// blob detected in several views keeps its first match.
pub fn without_repeats(matches: &mut Vec<FeatureMatch>, sets: [&FeatureSet; 2]) {
    let mut kept: HashMap<[i64; 2], Vec<(PointPair, f64)>> = HashMap::new();
    let cell = |p: Point| [p.x, p.y].map(|v| (v / REPEATED).floor() as i64);
    matches.retain(|m| {
        let scales = [sets[0].features()[m.feature1].scale, sets[1].features()[m.feature2].scale];
        let [x, y] = cell(m.pair.point1);
        let scale = scales[0].min(scales[1]);
        let is_repeated = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy])).any(|near| {
            kept.get(&near).is_some_and(|there| {
                there.iter().any(|(other, size)| {
                    let near = size.min(scale).min(REPEATED);
                    (other.point1 - m.pair.point1).norm() < near
                        && (other.point2 - m.pair.point2).norm() < near
                })
            })
        });
        if !is_repeated {
            kept.entry([x, y]).or_default().push((m.pair, scale));
        }
        !is_repeated
    });
}

/// Returns the mutual nearest neighbours among given candidates: for each feature of image 1,
/// indices of features of image 2. The ratio, computed among the candidates in both directions, is
/// at most `largest`.
pub fn match_candidates(
    sets: [&FeatureSet; 2],
    candidates: &[Vec<usize>],
    largest: f64,
) -> Vec<FeatureMatch> {
    let mut near1 = vec![NONE; sets[1].len()];
    let distances: Vec<Vec<i32>> = candidates
        .par_iter()
        .enumerate()
        .map(|(i, candidates)| {
            squared_distances(&sets[0].descriptors()[i], sets[1].descriptors(), candidates)
        })
        .collect();
    let near2: Vec<Neighbours> = candidates
        .iter()
        .zip(distances)
        .enumerate()
        .map(|(i, (candidates, distances))| {
            let mut nearest = NONE;
            for (&j, distance) in candidates.iter().zip(distances) {
                insert(&mut nearest, distance, j as u32);
                insert(&mut near1[j], distance, i as u32);
            }
            nearest
        })
        .collect();
    let mut matches = mutual(sets, &near2, &near1);
    matches.retain(|m| m.ratio <= largest);
    matches
}

/// Returns the features that are each other's nearest neighbour.
fn mutual(sets: [&FeatureSet; 2], near2: &[Neighbours], near1: &[Neighbours]) -> Vec<FeatureMatch> {
    let [features1, features2] = sets.map(FeatureSet::features);
    let found = near2.iter().enumerate().filter_map(|(i, to2)| {
        let j = to2[0].1 as usize;
        let to1 = near1.get(j).filter(|to1| to1[0].1 as usize == i)?;
        let ratio = ratio(to2, features2).max(ratio(to1, features1));
        let pair = PointPair { point1: features1[i].position, point2: features2[j].position };
        Some(FeatureMatch { feature1: i, feature2: j, pair, ratio })
    });
    found.collect()
}

/// Returns the distance to the nearest neighbour over the distance to the next neighbour at another
/// place.
fn ratio(neighbours: &Neighbours, features: &[Feature]) -> f64 {
    let nearest = &features[neighbours[0].1 as usize];
    let elsewhere = neighbours[1..].iter().find(|(_, index)| {
        features
            .get(*index as usize)
            .is_none_or(|f| (f.position - nearest.position).norm() > SAME_PLACE * f.scale.max(nearest.scale))
    });
    // If all neighbours are at the same place, the next is at least as far as the last of them.
    let next = elsewhere.unwrap_or(&neighbours[KEPT - 1]).0;
    (f64::from(neighbours[0].0.max(0)) / f64::from(next.max(1))).sqrt().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::descriptor::{Descriptor, ENTRIES};
    use super::super::neighbours::CHUNK;
    use super::*;

    /// Returns distinct descriptors, each at its own place.
    fn set(count: usize, seed: usize) -> FeatureSet {
        let mut set = FeatureSet::default();
        for k in 0..count {
            let descriptor = std::array::from_fn(|i| ((i * (k + seed) * 7919 + i * i * 31) % 97) as u8);
            let feature = Feature {
                position: Point::new(40.0 * k as f64, 0.0),
                scale: 2.0,
                orientation: 0.0,
                shape: nalgebra::Matrix2::identity(),
                response: 9.0,
            };
            set.push(feature, descriptor);
        }
        set
    }

    #[test]
    fn larger_sets_are_matched_like_at_once() {
        let (a, b) = (set(CHUNK + 61, 1), set(131, 60));
        let first = |all: &FeatureSet, count: usize| FeatureSet {
            features: all.features[..count].to_vec(),
            descriptors: all.descriptors[..count].to_vec(),
        };
        let all = match_features(&a, &b);
        assert!(!all.is_empty());
        for [few, some] in [[0, 0], [0, 40], [300, 0], [300, 40], [a.len(), b.len()]] {
            let known = KnownNeighbours::default().extended(&first(&a, few), &first(&b, some));
            assert_eq!(known.extended(&a, &b).matches([&a, &b]), all, "{few} and {some} known");
        }
    }

    #[test]
    fn finds_the_same_neighbours_as_the_definition() {
        // The first set takes two chunks, the second a partial block.
        let (a, b) = (set(CHUNK + 61, 1), set(131, 60));
        let distance = |x: &Descriptor, y: &Descriptor| -> i32 {
            x.iter().zip(y).map(|(a, b)| (i32::from(*a) - i32::from(*b)).pow(2)).sum()
        };
        let [near2, near1] = nearest_neighbours(a.descriptors(), b.descriptors());
        for (from, to, near) in [(&a, &b, near2), (&b, &a, near1)] {
            assert_eq!(near.len(), from.len());
            for (from, found) in from.descriptors().iter().zip(near) {
                let to = to.descriptors().iter().enumerate();
                let mut all: Vec<(i32, u32)> = to.map(|(j, to)| (distance(from, to), j as u32)).collect();
                all.sort_unstable();
                assert_eq!(found[..], all[..KEPT]);
            }
        }
    }

    #[test]
    fn equal_sets_match_one_to_one_with_ratio_zero() {
        let a = set(60, 3);
        let matches = match_features(&a, &a);
        assert_eq!(matches.len(), 60);
        assert!(matches.iter().all(|m| m.feature1 == m.feature2 && m.ratio == 0.0));
    }

    #[test]
    fn few_or_no_features_are_handled() {
        let none = FeatureSet::default();
        assert!(match_features(&none, &none).is_empty());
        assert!(match_features(&set(3, 1), &none).is_empty());
        assert_eq!(match_features(&set(1, 1), &set(1, 1)).len(), 1);
    }

    #[test]
    fn only_neighbours_at_another_place_affect_the_ratio() {
        let one = set(1, 5);
        let (feature, descriptor) = (one.features()[0], one.descriptors()[0]);
        let mut nearly = descriptor;
        nearly[5] += 3;
        let mut far = descriptor;
        far.rotate_right(8);
        let with_twin = |offset: f64| {
            let mut set = FeatureSet::default();
            let mut shifted = descriptor;
            shifted[0] += 2;
            set.push(feature, shifted);
            set.push(Feature { position: Point::new(offset, 0.0), ..feature }, nearly);
            set.push(Feature { position: Point::new(900.0, 0.0), ..feature }, far);
            match_features(&one, &set)[0].ratio
        };
        assert!((with_twin(100.0) - 2.0 / 3.0).abs() < 1e-9);
        assert!(with_twin(1.0) < 0.2);
    }

    #[test]
    fn the_first_of_repeated_matches_is_kept() {
        let (descriptor, mut set) = ([0; ENTRIES], FeatureSet::default());
        for (x, scale) in [(10.0, 2.0), (11.0, 3.0), (13.0, 2.0), (60.0, 2.0), (60.5, 0.4)] {
            let feature = Feature {
                position: Point::new(x, 5.0),
                scale,
                orientation: 0.0,
                shape: nalgebra::Matrix2::identity(),
                response: 9.0,
            };
            set.push(feature, descriptor);
        }
        let of = |feature1: usize, feature2: usize| {
            let pair = PointPair {
                point1: set.features()[feature1].position,
                point2: set.features()[feature2].position,
            };
            FeatureMatch { feature1, feature2, pair, ratio: 0.5 }
        };
        // Close at one end only; farther than the smaller scale at one end; close at both ends.
        let mut matches = vec![of(0, 3), of(1, 2), of(0, 2), of(1, 3), of(3, 3), of(4, 3)];
        without_repeats(&mut matches, [&set, &set]);
        let left: Vec<_> = matches.iter().map(|m| (m.feature1, m.feature2)).collect();
        assert_eq!(left, [(0, 3), (1, 2), (3, 3), (4, 3)]);
    }
}
