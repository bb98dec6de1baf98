//! Mutual nearest neighbours of two sets of features.
//!
//! Descriptor distances are Euclidean, computed in integers so that every machine ranks alike. A
//! match joins two features that are each other's nearest neighbour.
//!
//! The **ratio** of a match is the distance to the nearest neighbour over the distance to the next
//! neighbour *at another place* (Lowe 2004, section 7.1). Mishkin, Matas & Perdoch (2015) call this
//! neighbour "first geometrically inconsistent". The larger ratio of both directions counts. The
//! ratio is near zero for distinctive features and near one for repeated structure. No ratio test
//! is applied: samplers can prefer low ratios, and scores can weight by them.

use std::collections::HashMap;

use multiversion::multiversion;
use rayon::prelude::*;

use super::descriptor::{Descriptor, ENTRIES};
use super::{Feature, FeatureSet};
use crate::geometry::{Point, PointPair};
use crate::lanes::{LANES, SetLanes};

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

/// Neighbours kept per feature: enough that one lies at another place.
const KEPT: usize = 8;
/// Largest distance between two features at the same place, in units of the larger scale.
const SAME_PLACE: f64 = 3.0;
/// Largest distance of repeated matches, px.
const REPEATED: f64 = 8.0;
/// Features of set 1 matched by one task. Each task starts a new list of neighbours for set 2.
const CHUNK: usize = 512;

type Neighbours = [(i32, u32); KEPT];
const NONE: Neighbours = [(i32::MAX, u32::MAX); KEPT];
type Wide = [i16; ENTRIES];

/// Returns all mutual nearest neighbours, lowest ratio first. Keeps the first of several matches at
/// the same two places.
pub fn match_features(set1: &FeatureSet, set2: &FeatureSet) -> Vec<FeatureMatch> {
    let [near2, near1] = neighbours(set1.descriptors(), set2.descriptors());
    let mut matches = mutual([set1, set2], &near2, &near1);
    matches.sort_by(|a, b| a.ratio.total_cmp(&b.ratio).then(a.feature1.cmp(&b.feature1)));
    // A blob with several orientations is matched once for each.
    let mut seen = std::collections::HashSet::new();
    matches.retain(|m| seen.insert(m.pair.numbers().map(f64::to_bits)));
    matches
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

/// Returns the squared distances of a descriptor to some descriptors of a set.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx2", "x86_64+avx2", "aarch64+neon"))]
fn squared_distances(own: &Descriptor, set: &[Descriptor], some: &[usize]) -> Vec<i32> {
    let mut distances = Vec::with_capacity(some.len());
    for &j in some {
        let other = &set[j];
        let mut sum = 0;
        for k in 0..ENTRIES {
            let apart = i32::from(i16::from(own[k]) - i16::from(other[k]));
            sum += apart * apart;
        }
        distances.push(sum);
    }
    distances
}

fn insert(neighbours: &mut Neighbours, distance: i32, index: u32) {
    if distance < neighbours[KEPT - 1].0 {
        let place = neighbours.iter().position(|n| distance < n.0).unwrap_or(KEPT - 1);
        neighbours[place..].rotate_right(1);
        neighbours[place] = (distance, index);
    }
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

/// Returns the nearest neighbours of each descriptor of set 1 and of set 2: squared distance and
/// index.
fn neighbours(set1: &[Descriptor], set2: &[Descriptor]) -> [Vec<Neighbours>; 2] {
    let wide = |set: &[Descriptor]| -> Vec<Wide> { set.iter().map(|d| d.map(i16::from)).collect() };
    let set2 = wide(set2);
    let lengths2: Vec<i32> = set2.iter().map(|d| dot(d, d)).collect();
    let found: Vec<[Vec<Neighbours>; 2]> = set1
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(k, chunk)| nearest(&wide(chunk), k * CHUNK, &set2, &lengths2))
        .collect();
    let mut near2 = Vec::with_capacity(set1.len());
    let mut near1 = vec![NONE; set2.len()];
    // Merged in the order of set 1, so that the first of equal neighbours stays first.
    for [of_chunk, of_set2] in found {
        near2.extend(of_chunk);
        for (all, more) in near1.iter_mut().zip(of_set2) {
            for (distance, index) in more {
                insert(all, distance, index);
            }
        }
    }
    [near2, near1]
}

#[inline]
fn dot(a: &Wide, b: &Wide) -> i32 {
    a.iter().zip(b).map(|(x, y)| i32::from(*x) * i32::from(*y)).sum()
}

/// Descriptors of set 2 that stay in the cache while a chunk of set 1 is processed.
const BLOCK: usize = 4 * LANES;

/// Returns the nearest neighbours between all of set 2 and a chunk of set 1 that starts at index
/// `first`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn nearest(chunk: &[Wide], first: usize, set2: &[Wide], lengths2: &[i32]) -> [Vec<Neighbours>; 2] {
    let mut near2 = vec![NONE; chunk.len()];
    let mut near1 = vec![NONE; set2.len()];
    let lengths1: Vec<i32> = chunk.iter().map(|d| dot(d, d)).collect();
    for (block, (set2, lengths2)) in set2.chunks(BLOCK).zip(lengths2.chunks(BLOCK)).enumerate() {
        let near1 = &mut near1[block * BLOCK..][..set2.len()];
        let mut farthest1 = [i32::MAX; BLOCK];
        for (i, (own, near2)) in chunk.iter().zip(&mut near2).enumerate() {
            // Missing descriptors of the last block are infinitely far.
            let mut distances = [i32::MAX; BLOCK];
            for (distance, (other, length2)) in distances.iter_mut().zip(set2.iter().zip(lengths2)) {
                *distance = lengths1[i] + length2 - 2 * dot(own, other);
            }
            let farthest2 = near2[KEPT - 1].0;
            for group in (0..BLOCK).step_by(LANES) {
                let mut is_near = [0u8; LANES];
                for lane in 0..LANES {
                    is_near[lane] =
                        u8::from(distances[group + lane] < farthest1[group + lane].max(farthest2));
                }
                for lane in SetLanes::of(is_near) {
                    let k = group + lane;
                    insert(near2, distances[k], (block * BLOCK + k) as u32);
                    insert(&mut near1[k], distances[k], (first + i) as u32);
                    farthest1[k] = near1[k][KEPT - 1].0;
                }
            }
        }
    }
    [near2, near1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

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
    fn finds_the_same_neighbours_as_the_definition() {
        // The first set takes two chunks, the second a partial block.
        let (a, b) = (set(CHUNK + 61, 1), set(131, 60));
        let distance = |x: &Descriptor, y: &Descriptor| -> i32 {
            x.iter().zip(y).map(|(a, b)| (i32::from(*a) - i32::from(*b)).pow(2)).sum()
        };
        let [near2, near1] = neighbours(a.descriptors(), b.descriptors());
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
