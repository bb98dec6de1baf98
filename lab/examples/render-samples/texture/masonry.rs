//! Brick, stone courses, paving, plaster and roofs.

use nalgebra::Vector2;

use super::{Look, Rgb, Spot, mix, pick, srgb};
use crate::noise::{fractal, gradient_noise, hash, smoothstep, unit};

/// Stones or bricks laid in courses, or cells of random stones.
#[derive(Debug, Clone)]
pub struct Masonry {
    /// Colours between which the stones vary.
    pub palette: [Rgb; 3],
    /// Colour of the joints.
    pub joint_colour: Rgb,
    /// Mean length and height of a stone, m.
    pub size: [f64; 2],
    /// Variation of the sizes, as a fraction of them; below 0.9.
    pub jitter: f64,
    /// Width of the joints, m.
    pub joint: f64,
    /// How far stones stand out of the joints, m.
    pub relief: f64,
    /// Strength of stains and dirt, 0 ..= 1.
    pub weathering: f64,
    /// Moss in the joints, 0 ..= 1.
    pub moss: f64,
}

/// A stone of a course.
struct Stone {
    id: u32,
    /// Distance to the middle of the nearest joint, m.
    edge: f64,
}

impl Masonry {
    /// Old red brick.
    pub fn brick() -> Self {
        Self {
            palette: [srgb(0x7E_3B2B), srgb(0xA8_5A3F), srgb(0xC4_8562)],
            joint_colour: srgb(0xB5_A78F),
            size: [0.235, 0.075],
            jitter: 0.28,
            joint: 0.013,
            relief: 0.007,
            weathering: 0.55,
            moss: 0.1,
        }
    }

    /// Paving of large stone slabs.
    pub fn flagstones() -> Self {
        Self {
            palette: [srgb(0x9C_8F7A), srgb(0xB8_A98E), srgb(0xA9_8C76)],
            joint_colour: srgb(0x5B_5443),
            size: [0.62, 0.44],
            jitter: 0.6,
            joint: 0.018,
            relief: 0.008,
            weathering: 0.5,
            moss: 0.6,
        }
    }

    /// Squared rubble.
    pub fn ashlar() -> Self {
        Self {
            palette: [srgb(0xA2_9274), srgb(0xC2_B08C), srgb(0x8E_8470)],
            joint_colour: srgb(0x80_7660),
            size: [0.42, 0.2],
            jitter: 0.62,
            joint: 0.016,
            relief: 0.016,
            weathering: 0.5,
            moss: 0.2,
        }
    }

    /// Small setts of a street.
    pub fn setts() -> Self {
        Self {
            palette: [srgb(0x75_706A), srgb(0x94_8C80), srgb(0x85_7664)],
            joint_colour: srgb(0x45_4038),
            size: [0.17, 0.12],
            jitter: 0.5,
            joint: 0.02,
            relief: 0.02,
            weathering: 0.45,
            moss: 0.45,
        }
    }

    fn stone(&self, p: Vector2<f64>, seed: u32) -> Stone {
        let [length, height] = self.size;
        // Hand-laid courses are never straight.
        let wave = |q: Vector2<f64>, s: u32| gradient_noise(q, seed ^ s);
        let p = p + Vector2::new(wave(p / 0.9, 11), wave(p / 1.3, 12)) * (0.09 * height);
        let (row, low, high) = interval(p.y / height, self.jitter * 0.6, seed);
        let shift = 0.5 * f64::from(row & 1) + self.jitter * unit(hash(row, 7, seed));
        let x = p.x / length + shift;
        let (column, left, right) = interval(x, self.jitter, hash(row, 3, seed));
        let across = (x - left).min(right - x) * length;
        let upright = (p.y / height - low).min(high - p.y / height) * height;
        // The soft minimum rounds the corners.
        let soft = self.joint * 1.2;
        let edge =
            across.min(upright) - soft * (1.0 - ((across - upright).abs() / soft).min(1.0)).powi(2) * 0.25;
        Stone { id: hash(column, row, seed ^ 0xB41C), edge }
    }

    /// Courses along the first coordinate.
    pub fn look(&self, spot: &Spot) -> Look {
        self.laid(spot, spot.uv, spot.seed)
    }

    /// Wedge stones on a half ring; surface coordinates start at its lower left corner.
    pub fn around(&self, spot: &Spot, radius: f64) -> Look {
        let q = spot.uv - Vector2::new(radius, 0.0);
        let polar = Vector2::new(q.norm(), q.y.atan2(q.x) * radius);
        self.laid(spot, polar, spot.seed)
    }

    fn laid(&self, spot: &Spot, p: Vector2<f64>, seed: u32) -> Look {
        let stone = self.stone(p, seed);
        let r = |salt| unit(hash(stone.id as i32, salt, seed));
        // Each stone has its own cut of the noise.
        let own = p + Vector2::new(r(1), r(2)) * 37.0;
        let grain = |length: f64, salt: u32| fractal(own, length, 0.6, spot.sample, seed ^ salt);
        let chip = 0.35 * self.joint * grain(0.05, 5);
        let solid = smoothstep(0.3 * self.joint, 0.75 * self.joint, stone.edge + chip);
        let face = pick(&self.palette, (r(3) * 1.2 - 0.1 + 0.22 * grain(0.3, 6)).clamp(0.0, 1.0));
        let tone = 0.84 + 0.32 * r(4) + 0.16 * grain(0.09, 7) + 0.1 * grain(0.02, 8);
        // A few burnt or pale ones.
        let odd = if r(9) > 0.93 { 0.6 } else { 1.0 };
        let rim = 0.86 + 0.14 * smoothstep(0.0, 3.0 * self.joint, stone.edge);
        let face = face * (tone * odd * rim);
        let green = smoothstep(0.05, 0.6, spot.fractal(0.9, 21) + 0.25 * spot.fractal(0.08, 22)) * self.moss;
        let joint = mix(self.joint_colour, srgb(0x55_5E2E), green) * (0.92 + 0.3 * spot.fractal(0.03, 23));
        let dirt = 1.0 - self.weathering * 0.6 * smoothstep(-0.1, 0.9, spot.fractal(2.3, 24));
        let pale = self.weathering * 0.35 * smoothstep(0.25, 0.8, spot.fractal(1.1, 25));
        let colour = mix(joint, face, solid) * dirt;
        let albedo = mix(colour, srgb(0xC8_BCA4), pale);
        let height = self.relief * solid * (0.8 + 0.4 * r(5))
            + 0.2 * self.relief * grain(0.07, 26)
            + 0.0015 * grain(0.02, 27);
        Look { albedo, height, gloss: 0.04 * solid }
    }
}

/// The interval around `x` of a line cut near each whole number: its number and ends.
fn interval(x: f64, jitter: f64, seed: u32) -> (i32, f64, f64) {
    let cut = |k: i32| f64::from(k) + jitter * (unit(hash(k, 0, seed)) - 0.5);
    let k = x.floor() as i32;
    let k = if x < cut(k) { k - 1 } else { k + i32::from(x >= cut(k + 1)) };
    (k, cut(k), cut(k + 1))
}

/// Lime plaster over masonry: clouds of colour, streaks below, cracks, and patches fallen off.
pub fn plaster(spot: &Spot, colour: Rgb, bare: f64, under: &Masonry) -> Look {
    // Damp rises, so that more has fallen off near the ground.
    let low = smoothstep(1.1, 0.0, spot.uv.y) * 0.35;
    let hold = spot.fractal(1.7, 31) + 0.22 * spot.fractal(0.12, 32) + 0.55 - bare * 0.9 - low * bare * 2.0;
    let on = smoothstep(-0.015, 0.015, hold);
    let crack_line = (spot.fractal(0.9, 33) + 0.15 * spot.fractal(0.07, 34)).abs();
    let crack = smoothstep(0.016, 0.006, crack_line) * smoothstep(0.0, 0.35, spot.fractal(1.9, 35));
    let clouds = 1.0 + 0.16 * spot.fractal(1.3, 36) + 0.09 * spot.fractal(0.25, 37);
    let trowel = 0.05 * spot.stretched(0.22, 0.06, 38) + 0.06 * spot.fractal(0.03, 39);
    let streak = 0.22 * smoothstep(0.1, 0.9, spot.stretched(0.16, 2.6, 40));
    let damp = 0.3 * smoothstep(0.75, 0.0, spot.uv.y + 0.3 * spot.fractal(0.6, 41));
    let tone = clouds + trowel - streak - damp - 0.4 * crack;
    let worn = mix(colour, srgb(0xD9_CDB4), 0.5 * smoothstep(0.15, 0.8, spot.fractal(0.8, 42)));
    let coat = Look::dull(worn * tone.max(0.1), 0.012 + 0.003 * spot.fractal(0.3, 43) - 0.004 * crack);
    if on >= 1.0 {
        return coat;
    }
    let wall = under.look(spot);
    // The broken rim of the coat is paler than its face.
    let rim = smoothstep(0.05, 0.0, hold.abs()) * 0.35;
    Look {
        albedo: mix(wall.albedo * 0.8, mix(coat.albedo, srgb(0xDD_D4C2), rim), on),
        height: wall.height * 0.5 + (coat.height - wall.height * 0.5) * on,
        gloss: 0.0,
    }
}

/// Half-round tiles; the first coordinate runs along the eaves, the second up the slope.
pub fn roof(spot: &Spot, palette: &[Rgb; 3]) -> Look {
    let (column, left, right) = interval(spot.uv.x / 0.21, 0.25, spot.seed);
    let s = (spot.uv.x / 0.21 - left) / (right - left);
    let slip = unit(hash(column, 5, spot.seed));
    let (row, low, high) = interval(spot.uv.y / 0.34 + slip, 0.35, spot.seed ^ column as u32);
    let t = (spot.uv.y / 0.34 + slip - low) / (high - low);
    let r = |salt| unit(hash(column, row, spot.seed ^ salt));
    let colour = pick(palette, (r(1) + 0.25 * spot.fractal(0.4, 51)).clamp(0.0, 1.0));
    let lichen = 0.6 * smoothstep(0.35, 0.6, spot.fractal(0.2, 52) + 0.3 * spot.fractal(1.4, 53));
    let arch = (4.0 * s * (1.0 - s)).max(0.0).sqrt();
    // The upper end lies under the next tile.
    let shade = (0.45 + 0.55 * arch.powf(0.7)) * (0.62 + 0.38 * smoothstep(1.0, 0.82, t));
    let tone = shade * (0.8 + 0.4 * r(2) + 0.15 * spot.fractal(0.05, 54));
    let albedo = mix(colour, srgb(0xB5_B093), lichen) * tone;
    Look::dull(albedo, 0.05 * arch + 0.012 * (1.0 - t))
}
