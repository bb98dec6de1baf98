//! Nearest neighbours of descriptors by their squared distances, which are exact integers.

use multiversion::multiversion;
use multiversion::target::target_cfg_f;
use rayon::prelude::*;

use super::descriptor::{Descriptor, ENTRIES};
use crate::lanes::{LANES, SetLanes};

/// Neighbours kept per feature: enough that one lies at another place.
pub(super) const KEPT: usize = 8;
/// Features of set 1 matched by one task. Each task starts a new list of neighbours for set 2.
pub(super) const CHUNK: usize = 512;

/// Squared distances and indices of the nearest descriptors of another set, nearest first.
pub(super) type Neighbours = [(i32, u32); KEPT];
pub(super) const NONE: Neighbours = [(i32::MAX, u32::MAX); KEPT];
type Wide = [f32; ENTRIES];

/// Returns the squared distances of a descriptor to some descriptors of a set.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx2", "x86_64+avx2", "aarch64+neon"))]
pub(super) fn squared_distances(own: &Descriptor, set: &[Descriptor], some: &[usize]) -> Vec<i32> {
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

pub(super) fn insert(neighbours: &mut Neighbours, distance: i32, index: u32) {
    if distance < neighbours[KEPT - 1].0 {
        let place = neighbours.iter().position(|n| distance < n.0).unwrap_or(KEPT - 1);
        neighbours[place..].rotate_right(1);
        neighbours[place] = (distance, index);
    }
}

/// Adds neighbours whose numbers count from `first`.
pub(super) fn add(all: &mut [Neighbours], more: &[Neighbours], first: usize) {
    for (all, more) in all.iter_mut().zip(more) {
        for (distance, index) in more {
            insert(all, *distance, index.saturating_add(first as u32));
        }
    }
}

/// Returns the nearest neighbours of each descriptor of set 1 and of set 2: squared distance and
/// index.
pub(super) fn nearest_neighbours(set1: &[Descriptor], set2: &[Descriptor]) -> [Vec<Neighbours>; 2] {
    if set1.is_empty() {
        return [Vec::new(), vec![NONE; set2.len()]];
    }
    let blocks: Vec<DescriptorBlock> = set2.par_chunks(BLOCK).map(DescriptorBlock::new).collect();
    let found: Vec<[Vec<Neighbours>; 2]> = set1
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(k, chunk)| {
            let chunk: Vec<Wide> = chunk.iter().map(|descriptor| descriptor.map(f32::from)).collect();
            nearest(&chunk, k * CHUNK, &blocks)
        })
        .collect();
    let mut near2 = Vec::with_capacity(set1.len());
    let mut near1 = vec![NONE; set2.len()];
    // Merged in the order of set 1, so that the first of equal neighbours stays first.
    for [of_chunk, of_set2] in found {
        near2.extend(of_chunk);
        add(&mut near1, &of_set2, 0);
    }
    [near2, near1]
}

/// Descriptors of a block. The sums of their products with two others stay in registers.
const BLOCK: usize = 2 * LANES;

/// Descriptors of set 2, interleaved entry by entry. A block stays in the cache while a chunk of set 1 is
/// processed.
struct DescriptorBlock {
    entries: [[f32; BLOCK]; ENTRIES],
    /// Squared lengths. Empty lanes are farther than any descriptor.
    lengths: [i32; BLOCK],
    count: usize,
}

impl DescriptorBlock {
    fn new(descriptors: &[Descriptor]) -> Self {
        let mut block =
            Self { entries: [[0.0; BLOCK]; ENTRIES], lengths: [NOWHERE; BLOCK], count: descriptors.len() };
        for (lane, descriptor) in descriptors.iter().enumerate() {
            block.lengths[lane] = descriptor.iter().map(|v| i32::from(*v).pow(2)).sum();
            for (entry, value) in block.entries.iter_mut().zip(descriptor) {
                entry[lane] = f32::from(*value);
            }
        }
        block
    }
}

/// Squared length of an empty lane: beyond the distance of any two descriptors, and far from overflow.
const NOWHERE: i32 = i32::MAX / 2;

/// Returns the nearest neighbours between all of set 2 and a chunk of set 1 that starts at index
/// `first`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2+fma", "x86_64+avx2+fma", "aarch64+neon"))]
fn nearest(chunk: &[Wide], first: usize, blocks: &[DescriptorBlock]) -> [Vec<Neighbours>; 2] {
    // Without the instruction, `mul_add` would be a slow library call.
    let fused = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let mut near2 = vec![NONE; chunk.len()];
    let mut near1 = Vec::new();
    for (number, block) in blocks.iter().enumerate() {
        let mut of_block = [NONE; BLOCK];
        let mut farthest1 = [i32::MAX; BLOCK];
        for (pair, (own, near2)) in chunk.chunks(2).zip(near2.chunks_mut(2)).enumerate() {
            let products = products([&own[0], &own[own.len() - 1]], &block.entries, fused);
            for (i, near2) in near2.iter_mut().enumerate() {
                let length = squared_length(&own[i]);
                let farthest2 = near2[KEPT - 1].0;
                let mut distances = [0i32; BLOCK];
                for lane in 0..BLOCK {
                    distances[lane] = length + block.lengths[lane] - 2 * products[i][lane] as i32;
                }
                for group in (0..BLOCK).step_by(LANES) {
                    let mut is_near = [0u8; LANES];
                    for lane in 0..LANES {
                        let distance = distances[group + lane];
                        is_near[lane] =
                            u8::from(distance < farthest1[group + lane].max(farthest2) && distance < NOWHERE);
                    }
                    for lane in SetLanes::of(is_near) {
                        let k = group + lane;
                        insert(near2, distances[k], (number * BLOCK + k) as u32);
                        insert(&mut of_block[k], distances[k], (first + 2 * pair + i) as u32);
                        farthest1[k] = of_block[k][KEPT - 1].0;
                    }
                }
            }
        }
        near1.extend_from_slice(&of_block[..block.count]);
    }
    [near2, near1]
}

/// Returns the squared length of a descriptor.
#[inline]
fn squared_length(own: &Wide) -> i32 {
    let mut sums = [0f32; LANES];
    for group in 0..ENTRIES / LANES {
        for lane in 0..LANES {
            let value = own[group * LANES + lane];
            sums[lane] += value * value;
        }
    }
    let mut total = 0.0;
    for sum in sums {
        total += sum;
    }
    total as i32
}

/// Returns the products of two descriptors with those of a block. They are exact: the sums are integers
/// below 2²⁴.
#[expect(clippy::inline_always, reason = "it must take on the target features of its caller")]
#[inline(always)]
fn products(own: [&Wide; 2], entries: &[[f32; BLOCK]; ENTRIES], fused: bool) -> [[f32; BLOCK]; 2] {
    let [mut first, mut second] = [[0f32; BLOCK]; 2];
    for ((row, u), v) in entries.iter().zip(own[0]).zip(own[1]) {
        for lane in 0..BLOCK {
            first[lane] = if fused { u.mul_add(row[lane], first[lane]) } else { u * row[lane] + first[lane] };
        }
        for lane in 0..BLOCK {
            second[lane] =
                if fused { v.mul_add(row[lane], second[lane]) } else { v * row[lane] + second[lane] };
        }
    }
    [first, second]
}
