//! Search for the look-alikes of corners that lie near the epipolar lines of a geometry, fast
//! enough for many geometries.

use multiversion::multiversion;

use super::feature_support::FLOOR;
use crate::geometry::{FundamentalMatrix, Point};
use crate::lanes::{LANES, SetLanes};

/// Allowance for rounding to single precision, px. No result depends on it.
const SLACK: f64 = 0.1;

type Lanes = [f32; LANES];

/// Two corners whose patches look alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct Putative {
    pub corner1: u32,
    pub corner2: u32,
    pub correlation: f32,
}

/// Look-alikes of all corners of image 1, laid out for the vector units. For a group of corners,
/// the best look-alike of each comes first, then the second best of each, and so on.
#[derive(Debug, Clone, Default)]
pub(super) struct LookAlikes {
    groups: Vec<CornerGroup>,
    /// Places of all ranks, group by group. Most queries read only these.
    places: Vec<RankPlaces>,
    /// Excess of the correlations over the floor.
    excesses: Vec<Lanes>,
    pairs: Vec<[u32; LANES]>,
}

/// Group of corners of image 1.
#[derive(Debug, Clone, Copy)]
struct CornerGroup {
    x1: Lanes,
    y1: Lanes,
    ranks: usize,
}

/// Places of the look-alikes of one rank; NaN in empty lanes.
#[derive(Debug, Clone, Copy)]
struct RankPlaces {
    x2: Lanes,
    y2: Lanes,
}

impl LookAlikes {
    /// Lays out pairs of look-alike corners, grouped by the corner of image 1, the best of each
    /// first.
    pub fn new(corners: &[Vec<Point>; 2], pairs: &[Putative]) -> Self {
        let mut of_corner: Vec<(usize, &[Putative])> = Vec::new();
        let mut first = 0;
        for group in pairs.chunk_by(|a, b| a.corner1 == b.corner1) {
            of_corner.push((first, group));
            first += group.len();
        }
        let mut all = Self::default();
        for few in of_corner.chunks(LANES) {
            let ranks = few.iter().map(|(_, group)| group.len()).max().unwrap_or(0);
            let [mut x1, mut y1] = [[0.0; LANES]; 2];
            for (lane, (_, group)) in few.iter().enumerate() {
                let point = corners[0][group[0].corner1 as usize];
                (x1[lane], y1[lane]) = (point.x as f32, point.y as f32);
            }
            all.groups.push(CornerGroup { x1, y1, ranks });
            for rank in 0..ranks {
                let [mut x2, mut y2, mut excess] = [[f32::NAN; LANES], [f32::NAN; LANES], [0.0; LANES]];
                let mut pairs = [0; LANES];
                for (lane, (first, group)) in few.iter().enumerate() {
                    let Some(pair) = group.get(rank) else { continue };
                    let point = corners[1][pair.corner2 as usize];
                    (x2[lane], y2[lane]) = (point.x as f32, point.y as f32);
                    excess[lane] = pair.correlation - FLOOR;
                    pairs[lane] = (first + rank) as u32;
                }
                all.places.push(RankPlaces { x2, y2 });
                all.excesses.push(excess);
                all.pairs.push(pairs);
            }
        }
        all
    }

    /// Returns the indices of all pairs whose point in image 2 is within `band` px of its line, and
    /// of some slightly farther off.
    pub fn near(&self, f: &FundamentalMatrix, band: f64) -> Vec<u32> {
        let mut found = Vec::with_capacity(512);
        near(&self.groups, &self.places, &self.pairs, &single(f), (band + SLACK) as f32, &mut found);
        found
    }

    /// Returns an upper bound on the summed excess of the mutual best matches within `band` px. For
    /// each corner of image 1, the bound counts the best look-alike near its line.
    pub fn most_support(&self, f: &FundamentalMatrix, band: f64) -> f32 {
        most_support(&self.groups, &self.places, &self.excesses, &single(f), (band + SLACK) as f32)
    }
}

/// Returns the matrix in single precision, good to some thousandths of a pixel.
fn single(f: &FundamentalMatrix) -> [f32; 9] {
    let scaled = f.matrix() / f.matrix().amax();
    std::array::from_fn(|k| scaled[(k / 3, k % 3)] as f32)
}

/// Returns the lines of a group of corners, and the largest squared product with a point in their band.
#[inline]
fn lines(group: &CornerGroup, f: &[f32; 9], band: f32) -> [Lanes; 4] {
    let [mut a, mut b, mut c, mut limit] = [[0f32; LANES]; 4];
    for k in 0..LANES {
        let (x, y) = (group.x1[k], group.y1[k]);
        a[k] = f[0] * x + f[1] * y + f[2];
        b[k] = f[3] * x + f[4] * y + f[5];
        c[k] = f[6] * x + f[7] * y + f[8];
        limit[k] = band * band * (a[k] * a[k] + b[k] * b[k]);
    }
    [a, b, c, limit]
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near(
    groups: &[CornerGroup],
    mut places: &[RankPlaces],
    mut pairs: &[[u32; LANES]],
    f: &[f32; 9],
    band: f32,
    found: &mut Vec<u32>,
) {
    for group in groups {
        let (own, others) = places.split_at(group.ranks);
        let (of_own, of_others) = pairs.split_at(group.ranks);
        (places, pairs) = (others, of_others);
        let [a, b, c, limit] = lines(group, f, band);
        for (rank, pairs) in own.iter().zip(of_own) {
            let mut is_near = [0u8; LANES];
            for k in 0..LANES {
                let e = a[k] * rank.x2[k] + b[k] * rank.y2[k] + c[k];
                is_near[k] = u8::from(e * e <= limit[k]);
            }
            for lane in SetLanes::of(is_near) {
                found.push(pairs[lane]);
            }
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn most_support(
    groups: &[CornerGroup],
    mut places: &[RankPlaces],
    mut excesses: &[Lanes],
    f: &[f32; 9],
    band: f32,
) -> f32 {
    let mut total = [0f32; LANES];
    for group in groups {
        let (own, others) = places.split_at(group.ranks);
        let (of_own, of_others) = excesses.split_at(group.ranks);
        (places, excesses) = (others, of_others);
        let [a, b, c, limit] = lines(group, f, band);
        let mut best = [0f32; LANES];
        for (rank, excess) in own.iter().zip(of_own) {
            for k in 0..LANES {
                let e = a[k] * rank.x2[k] + b[k] * rank.y2[k] + c[k];
                let own = if e * e <= limit[k] { excess[k] } else { 0.0 };
                best[k] = if own > best[k] { own } else { best[k] };
            }
        }
        for k in 0..LANES {
            total[k] += best[k];
        }
    }
    total.iter().sum()
}
