//! Things to put into a scene: crates, barrels, plants, windows, doors.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::build::{Axes, Builder, MaterialId};
use super::shape::{Opening, Outline, Shape, across};
use super::texture::{Cloth, Painted, Pattern, Planks, srgb};

/// Materials that most things share.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    /// Weathered boards.
    pub wood: MaterialId,
    /// Darker upright boards.
    pub door: MaterialId,
    /// Pale limestone.
    pub stone: MaterialId,
    /// Fired clay.
    pub clay: MaterialId,
    /// Iron.
    pub iron: MaterialId,
    /// Soil in pots.
    pub soil: MaterialId,
    /// Bark and stems.
    pub bark: MaterialId,
    /// Window panes.
    pub glass: MaterialId,
    /// White paint.
    pub white: MaterialId,
    /// Leaves from dark to bright, and blossoms.
    pub leaves: [MaterialId; 3],
    /// Blossoms.
    pub blossoms: [MaterialId; 3],
    /// Oranges, apples, lemons.
    pub fruit: [MaterialId; 3],
}

impl Palette {
    /// Adds them to a scene.
    pub fn new(b: &mut Builder) -> Self {
        let planks = |codes: [u32; 3], width, upright| {
            Pattern::Planks(Planks { palette: codes.map(srgb), width, upright })
        };
        Self {
            wood: b.material(planks([0x8A_6642, 0xB0_8A5C, 0x9C_7850], 0.11, false)),
            door: b.material(planks([0x5E_4230, 0x7A_5638, 0x6A_4A30], 0.14, true)),
            stone: b.material(Pattern::Stone(srgb(0xCB_BFA4))),
            clay: b.material(Pattern::Terracotta(srgb(0xB8_6A42))),
            iron: b.material(Pattern::Metal(srgb(0x3A_3A3C))),
            soil: b.material(Pattern::Soil(srgb(0x50_3E2C))),
            bark: b.material(Pattern::Bark(srgb(0x7A_6650))),
            glass: b.material(Pattern::Glass(srgb(0x2C_3640))),
            white: b.material(Pattern::Painted(Painted { colour: srgb(0xE2_DDCE), slats: 0.0 })),
            leaves: [0x3C_6A2E, 0x58_8A38, 0x7F_A048].map(|c| b.material(Pattern::Leaf(srgb(c)))),
            blossoms: [0xC8_3048, 0xD8_5C9A, 0xE8_C040].map(|c| b.material(Pattern::Leaf(srgb(c)))),
            fruit: [0xE8_8A20, 0xC0_3A28, 0xE8_CC40].map(|c| b.material(Pattern::Fruit(srgb(c)))),
        }
    }

    /// Returns the share of red, pink and yellow blossoms on a bush, with their colours.
    pub fn flowers(&self) -> [Option<(f64, MaterialId)>; 3] {
        let [red, pink, yellow] = self.blossoms;
        [(0.45, red), (0.4, pink), (0.35, yellow)].map(Some)
    }
}

/// A unit vector, even over the sphere.
fn random_direction(rng: &mut Pcg32) -> Vector3<f64> {
    let z = rng.random_range(-1.0..1.0f64);
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    Vector3::new(r * cos, r * sin, z)
}

/// A leaf from its stalk along a direction, facing about `normal`.
pub fn leaf(
    b: &mut Builder,
    stalk: Point3<f64>,
    along: Vector3<f64>,
    normal: Vector3<f64>,
    size: [f64; 2],
    material: MaterialId,
) {
    let Some(u) = along.try_normalize(1e-9) else { return };
    let v = normal.cross(&u).try_normalize(1e-9).unwrap_or_else(|| across(&u)[0]);
    let [width, height] = size;
    let corner = stalk - v * (height / 2.0);
    b.add(Shape::Patch { corner, u, v, width, height, outline: Outline::Leaf }, material);
}

/// What a cloud of leaves looks like.
#[derive(Debug, Clone, Copy)]
pub struct Foliage {
    /// Half extents of the ellipsoid it fills, m.
    pub extent: [f64; 3],
    /// Number of leaves.
    pub leaves: usize,
    /// Length and width of a leaf, m.
    pub leaf: [f64; 2],
    /// Share of blossoms, and their colour.
    pub blossoms: Option<(f64, MaterialId)>,
    /// Repeatable randomness.
    pub seed: u64,
}

/// Leaves in an ellipsoid, denser in clumps, most of them turned outwards and up.
pub fn foliage(b: &mut Builder, p: &Palette, centre: Point3<f64>, f: &Foliage) {
    let mut rng = Pcg32::seed_from_u64(f.seed);
    let scale = Vector3::from(f.extent);
    let clumps: Vec<Vector3<f64>> =
        (0..14).map(|_| random_direction(&mut rng) * rng.random_range(0.35..0.85f64)).collect();
    for _ in 0..f.leaves {
        let clump = clumps[rng.random_range(0..clumps.len())];
        let local = clump + random_direction(&mut rng) * (0.42 * rng.random_range(0.1..1.0f64).sqrt());
        let position = centre + local.component_mul(&scale);
        let outward = (local + random_direction(&mut rng) * 0.5 + Vector3::z() * 0.25).normalize();
        let normal = (outward * 0.6 + random_direction(&mut rng) * 0.6 + Vector3::z() * 0.5).normalize();
        let size = rng.random_range(0.7..1.25);
        let material = match f.blossoms {
            Some((share, blossom)) if local.norm() > 0.6 && rng.random_bool(share) => blossom,
            _ => p.leaves[rng.random_range(0..3)],
        };
        leaf(b, position, outward, normal, f.leaf.map(|l| l * size), material);
    }
}

/// A turned clay pot with a rim and soil; returns the centre of the soil.
pub fn pot(b: &mut Builder, p: &Palette, base: Point3<f64>, radius: f64, height: f64) -> Point3<f64> {
    let h = height;
    let rim = 0.17 * h;
    b.lathe(
        base,
        &[
            (0.62 * radius, 0.0),
            (0.74 * radius, 0.3 * h),
            (0.86 * radius, 0.62 * h),
            (0.9 * radius, h - rim),
            (radius, h - rim),
            (1.02 * radius, h),
            (0.86 * radius, h),
            (0.82 * radius, h - rim),
        ],
        p.clay,
    );
    let top = base + Vector3::z() * (h - 0.6 * rim);
    b.disc(top, 0.86 * radius, p.soil);
    top
}

/// A pot with a bush.
pub fn potted_plant(b: &mut Builder, p: &Palette, base: Point3<f64>, size: f64, f: &Foliage) {
    let soil = pot(b, p, base, 0.26 * size, 0.42 * size);
    let centre = soil + Vector3::z() * (f.extent[2] * 0.8);
    for k in 0..5 {
        let turn = Vector3::new((f64::from(k) * 1.9).cos(), (f64::from(k) * 1.9).sin(), 0.0);
        b.rod(soil, centre + turn * (0.5 * f.extent[0]), [0.012 * size, 0.004], p.bark);
    }
    foliage(b, p, centre, f);
}

/// A tree: a bent trunk, boughs and a crown.
pub fn tree(b: &mut Builder, p: &Palette, base: Point3<f64>, height: f64, f: &Foliage) {
    let fork = base + Vector3::new(0.06 * height, -0.02 * height, 0.42 * height);
    let knee = base + Vector3::new(-0.01 * height, 0.0, 0.2 * height);
    b.rod(base, knee, [0.05 * height, 0.036 * height], p.bark);
    b.rod(knee, fork, [0.036 * height, 0.026 * height], p.bark);
    let crown = base + Vector3::z() * (height - f.extent[2]);
    for k in 0..7 {
        let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
        let reach = Vector3::new(cos * f.extent[0] * 0.65, sin * f.extent[1] * 0.65, 0.12 * f64::from(k % 3));
        b.rod(fork, crown + reach, [0.018 * height, 0.005 * height], p.bark);
    }
    foliage(b, p, crown, f);
}

/// A box of boards with corner posts; `size` along right, up and out.
pub fn wooden_crate(b: &mut Builder, p: &Palette, axes: &Axes, size: [f64; 3]) {
    let [w, h, d] = size;
    let post = 0.05;
    b.block(&axes.moved(0.015, 0.015, 0.015), [w - 0.03, h - 0.03, d - 0.03], p.wood);
    for (x, z) in [(0.0, 0.0), (w - post, 0.0), (0.0, d - post), (w - post, d - post)] {
        b.block(&axes.moved(x, 0.0, z), [post, h, post], p.wood);
    }
    for y in [0.0, h - post * 1.4] {
        b.block(&axes.moved(0.0, y, d - 0.012), [w, post * 1.4, 0.022], p.wood);
        b.block(&axes.moved(-0.01, y, 0.0), [0.022, post * 1.4, d], p.wood);
        b.block(&axes.moved(w - 0.012, y, 0.0), [0.022, post * 1.4, d], p.wood);
    }
}

/// An open crate heaped with fruit.
pub fn fruit_crate(b: &mut Builder, p: &Palette, axes: &Axes, size: [f64; 3], fruit: MaterialId, seed: u64) {
    let [w, h, d] = size;
    let board = 0.016;
    b.block(axes, [w, board, d], p.wood);
    for z in [0.0, d - board] {
        for k in 0..3 {
            let y = h * (0.04 + 0.34 * f64::from(k));
            b.block(&axes.moved(0.0, y, z), [w, h * 0.27, board], p.wood);
        }
    }
    for x in [0.0, w - board] {
        b.block(&axes.moved(x, 0.0, 0.0), [board, h * 1.02, d], p.wood);
    }
    let mut rng = Pcg32::seed_from_u64(seed);
    let r = 0.042;
    let layers = (h / (1.5 * r)) as usize + 1;
    for layer in 0..layers {
        let inset = 0.5 * r * layer as f64 * f64::from(u8::from(layer + 1 == layers));
        let y = r + layer as f64 * 1.5 * r;
        let mut x = board + r + inset + 0.5 * r * (layer % 2) as f64;
        while x < w - board - r - inset {
            let mut z = board + r + inset;
            while z < d - board - r - inset {
                let mut shake = || rng.random_range(-0.25..0.25) * r;
                let centre = axes.at(x + shake(), y + shake(), z + shake());
                let radius = r * rng.random_range(0.9..1.12);
                b.add(Shape::Sphere { centre, radius }, fruit);
                z += 2.1 * r;
            }
            x += 2.05 * r;
        }
    }
}

/// A barrel with hoops.
pub fn barrel(b: &mut Builder, p: &Palette, base: Point3<f64>, radius: f64, height: f64) {
    let bulge = |t: f64| radius * (0.8 + 0.2 * (1.0 - (2.0 * t - 1.0).powi(2)));
    let profile: Vec<_> = (0..=12).map(|k| f64::from(k) / 12.0).map(|t| (bulge(t), t * height)).collect();
    b.lathe(base, &profile, p.door);
    b.disc(base + Vector3::z() * (0.97 * height), bulge(0.97), p.wood);
    for t in [0.06, 0.24, 0.72, 0.9] {
        let (low, high) = (t * height, (t + 0.05) * height);
        b.lathe(base, &[(bulge(t) + 0.008, low), (bulge(t + 0.05) + 0.008, high)], p.iron);
    }
}

/// A column: plinth, base, shaft with swelling, capital; total height as given.
pub fn column(b: &mut Builder, p: &Palette, base: Point3<f64>, radius: f64, height: f64) {
    let r = radius;
    let side = 2.9 * r;
    let square = |z: f64| Axes::facing(base.x - side / 2.0, base.y + side / 2.0, base.z + z, 0.0);
    b.block(&square(0.0), [side, 0.5 * r, side], p.stone);
    let mut profile =
        vec![(1.4 * r, 0.5 * r), (1.46 * r, 0.75 * r), (1.3 * r, 0.95 * r), (1.08 * r, 1.1 * r)];
    for k in 0..=5 {
        let t = f64::from(k) / 5.0;
        profile.push((r * (1.0 + 0.04 * (3.1 * t).sin() - 0.16 * t), 1.1 * r + t * (height - 3.1 * r)));
    }
    for (radius, below) in [(1.0, 1.95), (1.02, 1.75), (0.9, 1.7), (1.0, 1.4), (1.2, 0.9), (1.42, 0.6)] {
        profile.push((radius * r, height - below * r));
    }
    b.lathe(base, &profile, p.stone);
    b.block(&square(height - 0.6 * r), [side, 0.6 * r, side], p.stone);
}

/// Fills an opening of a wall with a window: frame, bars and panes; `shutters` beside it if given.
pub fn window(b: &mut Builder, p: &Palette, wall: &Axes, o: &Opening, shutters: Option<MaterialId>) {
    let inner = wall.moved(o.left, o.bottom, -0.16);
    let (w, h) = (o.width, o.height);
    b.patch(&inner, [w, h], Outline::Rectangle, p.glass);
    let bar = 0.05;
    for x in [0.0, (w - bar) / 2.0, w - bar] {
        b.block(&inner.moved(x, 0.0, 0.0), [bar, h, 0.04], p.white);
    }
    for t in [0.0, 0.36, 0.68, 1.0] {
        b.block(&inner.moved(0.0, t * (h - bar), 0.0), [w, bar, 0.035], p.white);
    }
    let surround = wall.moved(o.left, o.bottom, 0.0);
    b.block(&surround.moved(-0.12, -0.1, 0.0), [w + 0.24, 0.1, 0.12], p.stone);
    b.block(&surround.moved(-0.1, h, 0.0), [w + 0.2, 0.14, 0.04], p.stone);
    if let Some(paint) = shutters {
        let leaf_width = w / 2.0 + 0.02;
        for x in [-leaf_width - 0.02, w + 0.02] {
            b.block(&surround.moved(x, 0.0, 0.02), [leaf_width, h, 0.035], paint);
        }
    }
}

/// Fills openings with windows that have shutters of one colour.
pub fn windows(b: &mut Builder, p: &Palette, wall: &Axes, openings: &[Opening], code: u32) {
    let paint = shutter(b, code);
    for o in openings {
        window(b, p, wall, o, Some(paint));
    }
}

/// A rectangular opening of a wall.
pub fn opening(left: f64, bottom: f64, width: f64, height: f64) -> Opening {
    Opening { left, bottom, width, height, arched: false }
}

/// Paint of a colour for slatted shutters.
pub fn shutter(b: &mut Builder, code: u32) -> MaterialId {
    b.material(Pattern::Painted(Painted { colour: srgb(code), slats: 0.055 }))
}

/// A striped cloth.
pub fn cloth(b: &mut Builder, codes: [u32; 3], stripe: f64) -> MaterialId {
    b.material(Pattern::Cloth(Cloth { palette: codes.map(srgb), stripe }))
}

/// A poster.
pub fn poster(b: &mut Builder, axes: &Axes, size: [f64; 2], codes: [u32; 3]) {
    let material = b.material(Pattern::Print(codes.map(srgb), size));
    b.block(&axes.moved(0.0, 0.0, 0.0), [size[0], size[1], 0.012], material);
}

/// Ivy on a wall: leaves within wandering tendrils that start at the ground.
pub fn ivy(b: &mut Builder, p: &Palette, wall: &Axes, reach: [f64; 2], tendrils: usize, seed: u64) {
    let mut rng = Pcg32::seed_from_u64(seed);
    for _ in 0..tendrils {
        let (mut x, mut y) = (rng.random_range(0.25..0.75) * reach[0], 0.0);
        let mut heading = rng.random_range(-0.5..0.5f64);
        let goal = reach[1] * rng.random_range(0.35..1.0);
        while y < goal {
            heading = (heading + rng.random_range(-0.35..0.35)).clamp(-1.1, 1.1);
            x += 0.05 * heading.sin();
            y += 0.05 * heading.cos();
            for _ in 0..2 {
                let (dx, dy) = (rng.random_range(-0.13..0.13), rng.random_range(-0.1..0.1));
                let stalk = wall.at(x + dx, (y + dy).max(0.02), rng.random_range(0.02..0.1));
                let down = wall.right * rng.random_range(-0.8..0.8) - wall.up * 0.8 + wall.out * 0.35;
                let normal = wall.out + random_direction(&mut rng) * 0.45;
                let length = rng.random_range(0.07..0.13);
                leaf(b, stalk, down, normal, [length, 0.85 * length], p.leaves[rng.random_range(0..3)]);
            }
        }
    }
}

/// A string with pennants between two points, sagging.
pub fn bunting(b: &mut Builder, p: &Palette, from: Point3<f64>, to: Point3<f64>, colours: &[MaterialId]) {
    let count = ((to - from).norm() / 0.34) as usize;
    let place = |t: f64| from + (to - from) * t - Vector3::z() * (0.42 * 4.0 * t * (1.0 - t));
    for k in 0..count {
        let (a, c) = (place(k as f64 / count as f64), place((k + 1) as f64 / count as f64));
        b.rod(a, c, [0.006, 0.006], p.iron);
        let along = (c - a).normalize();
        let out = along.cross(&Vector3::z()).normalize();
        let (sin, cos) = (0.35 * (k as f64 * 1.7).sin()).sin_cos();
        let up = (Vector3::z() * cos + out * sin).normalize();
        let up = (up - along * up.dot(&along)).normalize();
        let corner = a + along * 0.04 - up * 0.3;
        let outline = Outline::Pennant;
        let material = colours[(k * 7 + k / 3) % colours.len()];
        b.add(Shape::Patch { corner, u: along, v: up, width: 0.25, height: 0.3, outline }, material);
    }
}
