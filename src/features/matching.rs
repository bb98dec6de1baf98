//! Mutual nearest neighbours of two sets of features.
//!
//! The distance of two descriptors is Euclidean, in integers, so every machine ranks alike. A match joins two features
//! each of which is nearest to the other. Its **ratio** is the distance to the nearest over that to the next one *that
//! lies elsewhere* (Lowe 2004, section 7.1; Mishkin, Matas & Perdoch 2015: "first geometrically inconsistent"), the larger
//! of both directions: near zero for what is unique, near one for what repeats. There is no test of it: who draws
//! matches can prefer low ratios, who counts them can weigh them.

use std::collections::HashMap;

use multiversion::multiversion;
use rayon::prelude::*;

use super::descriptor::{Descriptor, ENTRIES};
use super::{Feature, FeatureSet};
use crate::geometry::{Point, PointPair};
use crate::lanes::{LANES, SetLanes};

/// Two features that are each other's nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureMatch {
    /// Index of the feature in image 1.
    pub feature1: usize,
    /// Index of the feature in image 2.
    pub feature2: usize,
    /// Where they are.
    pub pair: PointPair,
    /// Distance of the descriptors over the distance to the next best elsewhere, 0 to 1.
    pub ratio: f64,
}

/// Neighbours remembered for a feature: the nearest, and enough others that one of them lies elsewhere.
const KEPT: usize = 8;
/// Two features closer than this many times the scale of one are at the same place.
const SAME_PLACE: f64 = 3.0;
/// Farthest that repeated matches are apart, px.
const REPEATED: f64 = 8.0;
/// Features of set 1 that one task matches: each begins anew with the neighbours of set 2.
const CHUNK: usize = 512;

type Neighbours = [(i32, u32); KEPT];
const NONE: Neighbours = [(i32::MAX, u32::MAX); KEPT];
type Wide = [i16; ENTRIES];

/// All mutual nearest neighbours, lowest ratio first; of several at the same two places the first.
pub fn match_features(set1: &FeatureSet, set2: &FeatureSet) -> Vec<FeatureMatch> {
    let [near2, near1] = neighbours(set1.descriptors(), set2.descriptors());
    let (features1, features2) = (set1.features(), set2.features());
    let mut matches: Vec<FeatureMatch> = near2
        .iter()
        .enumerate()
        .filter_map(|(i, to2)| {
            let j = to2[0].1 as usize;
            let to1 = near1.get(j).filter(|to1| to1[0].1 as usize == i)?;
            Some(FeatureMatch {
                feature1: i,
                feature2: j,
                pair: PointPair { point1: features1[i].position, point2: features2[j].position },
                ratio: ratio(to2, features2).max(ratio(to1, features1)),
            })
        })
        .collect();
    matches.sort_by(|a, b| a.ratio.total_cmp(&b.ratio).then(a.feature1.cmp(&b.feature1)));
    // A blob with several orientations is matched once for each.
    let mut seen = std::collections::HashSet::new();
    matches.retain(|m| {
        let p = m.pair;
        seen.insert([p.point1.x, p.point1.y, p.point2.x, p.point2.y].map(f64::to_bits))
    });
    matches
}

/// Leaves out matches that are at both ends within the smaller scale of an earlier one: of a blob that was found under
/// several views the first match stays.
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

/// Mutual nearest neighbours among the candidates in image 2 of each feature of image 1, whose ratio (among the
/// candidates alone, both ways) is at most `largest`.
pub fn match_candidates(
    sets: [&FeatureSet; 2],
    candidates: &[Vec<usize>],
    largest: f64,
) -> Vec<FeatureMatch> {
    let (features1, features2) = (sets[0].features(), sets[1].features());
    let mut near1 = vec![NONE; features2.len()];
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
    near2
        .iter()
        .enumerate()
        .filter_map(|(i, to2)| {
            let j = to2[0].1 as usize;
            let to1 = near1.get(j).filter(|to1| to1[0].1 as usize == i)?;
            let ratio = ratio(to2, features2).max(ratio(to1, features1));
            let pair = PointPair { point1: features1[i].position, point2: features2[j].position };
            (ratio <= largest).then_some(FeatureMatch { feature1: i, feature2: j, pair, ratio })
        })
        .collect()
}

/// Squared distances of a descriptor to some of those of a set.
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

/// Distance to the nearest over the distance to the next that is elsewhere.
fn ratio(neighbours: &Neighbours, features: &[Feature]) -> f64 {
    let nearest = &features[neighbours[0].1 as usize];
    let elsewhere = neighbours[1..].iter().find(|(_, index)| {
        features
            .get(*index as usize)
            .is_none_or(|f| (f.position - nearest.position).norm() > SAME_PLACE * f.scale.max(nearest.scale))
    });
    // With all of them at the same place, the next is at least as far as the last of them.
    let next = elsewhere.unwrap_or(&neighbours[KEPT - 1]).0;
    (f64::from(neighbours[0].0.max(0)) / f64::from(next.max(1))).sqrt().min(1.0)
}

/// The nearest descriptors in the other set to each of set 1 and each of set 2: squared distance and index.
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
    // In the order of set 1, so that of equal ones the first stays first.
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

/// Descriptors of set 2 that stay in the cache while a chunk of set 1 passes by.
const BLOCK: usize = 4 * LANES;

/// The nearest of each other, of a chunk of set 1 from index `first` on and all of set 2.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn nearest(chunk: &[Wide], first: usize, set2: &[Wide], lengths2: &[i32]) -> [Vec<Neighbours>; 2] {
    let mut near2 = vec![NONE; chunk.len()];
    let mut near1 = vec![NONE; set2.len()];
    let lengths1: Vec<i32> = chunk.iter().map(|d| dot(d, d)).collect();
    for (block, (set2, lengths2)) in set2.chunks(BLOCK).zip(lengths2.chunks(BLOCK)).enumerate() {
        let near1 = &mut near1[block * BLOCK..][..set2.len()];
        let mut farthest1 = [i32::MAX; BLOCK];
        for (i, (own, near2)) in chunk.iter().zip(&mut near2).enumerate() {
            // Those that are missing in the last block are nearest to nothing.
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

    /// Descriptors that differ, each at a place of its own.
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
        // The first set in two chunks, the second with a part of a block.
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
    fn few_or_no_features_are_no_trouble() {
        let none = FeatureSet::default();
        assert!(match_features(&none, &none).is_empty());
        assert!(match_features(&set(3, 1), &none).is_empty());
        assert_eq!(match_features(&set(1, 1), &set(1, 1)).len(), 1);
    }

    #[test]
    fn a_twin_at_the_same_place_is_no_rival_but_one_elsewhere_is() {
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
    fn of_what_is_matched_twice_at_one_place_the_first_stays() {
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
        // Near at one end only, farther than the smaller scale at one end, nearer at both.
        let mut matches = vec![of(0, 3), of(1, 2), of(0, 2), of(1, 3), of(3, 3), of(4, 3)];
        without_repeats(&mut matches, [&set, &set]);
        let left: Vec<_> = matches.iter().map(|m| (m.feature1, m.feature2)).collect();
        assert_eq!(left, [(0, 3), (1, 2), (3, 3), (4, 3)]);
    }
}
