//! Wood, paint, cloth, glass, tiles and print.

use nalgebra::Vector2;

use super::{Look, Rgb, Spot, mix, pick, srgb};
use crate::noise::{fractal, hash, smoothstep, unit};

/// Boards along the first coordinate (or the second, if upright).
#[derive(Debug, Clone)]
pub struct Planks {
    /// Colours between which the boards vary.
    pub palette: [Rgb; 3],
    /// Mean width of a board, m.
    pub width: f64,
    /// Boards run along the second coordinate.
    pub upright: bool,
}

impl Planks {
    pub(super) fn look(&self, spot: &Spot) -> Look {
        let p = if self.upright { Vector2::new(spot.uv.y, spot.uv.x) } else { spot.uv };
        let row = (p.y / self.width).floor();
        let t = p.y / self.width - row;
        let id = hash(row as i32, 1, spot.seed);
        let r = |salt: i32| unit(hash(id as i32, salt, spot.seed));
        let own = Vector2::new(p.x + 11.0 * r(1), p.y + 7.0 * r(2));
        let noise = |along: f64, over: f64, salt: u32| {
            let q = Vector2::new(own.x / along, own.y / over);
            fractal(q, 1.0, 0.6, spot.sample / over, spot.seed ^ salt)
        };
        // Growth rings: a sine of a slowly bent coordinate.
        let bend = noise(0.5, 0.08, 131);
        let ring = ((own.y / 0.011 + 5.0 * bend) * 1.0).sin() * smoothstep(0.01, 0.004, spot.sample);
        let fibre = noise(0.12, 0.006, 132);
        let knot_at =
            Vector2::new((own.x / 0.55).rem_euclid(1.0) - 0.5, (t - 0.3 - 0.4 * r(5)) * self.width / 0.55);
        let knot = if r(6) > 0.4 { smoothstep(0.05, 0.025, knot_at.norm()) } else { 0.0 };
        let tone = 0.85 + 0.3 * r(3) + 0.08 * ring + 0.16 * fibre + 0.12 * noise(0.6, 0.1, 133) - 0.45 * knot;
        let grey = 0.35 * smoothstep(0.0, 0.7, spot.fractal(0.35, 134));
        let colour = mix(pick(&self.palette, r(4)), srgb(0x9A_948A), grey);
        let margin = t.min(1.0 - t) * self.width;
        let gap = smoothstep(0.0015, 0.005, margin);
        Look {
            albedo: colour * (tone * (0.18 + 0.82 * gap)).max(0.05),
            height: 0.008 * gap + 0.0008 * ring + 0.001 * fibre,
            gloss: 0.05,
        }
    }
}

/// Painted wood: shutters with slats, or flat boards.
#[derive(Debug, Clone)]
pub struct Painted {
    /// Colour of the paint.
    pub colour: Rgb,
    /// Distance of the slats, m; 0 for none.
    pub slats: f64,
}

impl Painted {
    pub(super) fn look(&self, spot: &Spot) -> Look {
        let peel =
            spot.fractal(0.18, 141) + 0.4 * spot.stretched(0.02, 0.09, 142) + 0.25 * spot.fractal(0.9, 143);
        let bare = smoothstep(0.42, 0.5, peel);
        let fade = 0.35 * smoothstep(-0.2, 0.8, spot.fractal(0.5, 144));
        let paint = mix(self.colour, srgb(0xD5_D2C4), fade) * (1.0 + 0.12 * spot.fractal(0.05, 145));
        let wood = srgb(0x8E_7A62) * (0.85 + 0.4 * spot.stretched(0.01, 0.15, 146));
        let mut albedo = mix(paint, wood, bare);
        let mut height = 0.001 * spot.stretched(0.008, 0.2, 147) - 0.001 * bare;
        if self.slats > 0.0 {
            let y = spot.uv.y / self.slats + 0.12 * spot.stretched(0.5, 0.04, 148);
            let t = y - y.floor();
            let own = unit(hash(y.floor() as i32, 2, spot.seed));
            albedo *= (0.4 + 0.6 * smoothstep(0.0, 0.3, t)) * (0.8 + 0.35 * own);
            height += 0.014 * (1.0 - t);
        }
        Look { albedo, height, gloss: 0.08 * (1.0 - bare) }
    }
}

/// Cloth with stripes of uneven width and soft folds.
#[derive(Debug, Clone)]
pub struct Cloth {
    /// Stripe colours.
    pub palette: [Rgb; 3],
    /// Mean width of a stripe, m.
    pub stripe: f64,
}

impl Cloth {
    pub(super) fn look(&self, spot: &Spot) -> Look {
        let x = spot.uv.x / self.stripe + 0.15 * spot.fractal(0.5, 151);
        let k = x.floor() as i32;
        let colour = self.palette[(hash(k, 1, spot.seed) % 3) as usize];
        let thread = 0.1 * spot.stretched(0.003, 0.05, 152) + 0.1 * spot.stretched(0.05, 0.003, 153);
        let tone = 0.95 + thread + 0.12 * spot.fractal(0.2, 154);
        Look::dull(
            colour * tone.max(0.1),
            0.05 * spot.stretched(0.16, 1.2, 155) + 0.01 * spot.fractal(0.1, 156),
        )
    }
}

/// A dusty pane in front of a dim room with a curtain.
pub fn glass(spot: &Spot, colour: Rgb) -> Look {
    let curtain = smoothstep(-0.05, 0.15, spot.fractal(0.7, 161) + 0.3);
    let folds = 0.6 + 0.4 * spot.stretched(0.05, 1.5, 162);
    let dust = 0.5 * smoothstep(0.0, 0.9, spot.fractal(0.3, 163));
    let room = mix(colour, srgb(0xB9_B2A0) * folds, 0.35 * curtain);
    Look { albedo: mix(room, srgb(0x9C_A3A8), 0.35 * dust), height: 0.0, gloss: 0.5 }
}

/// Glazed tiles: on each one of a few motifs, turned at random.
pub fn azulejo(spot: &Spot, colours: &[Rgb; 2]) -> Look {
    let size = 0.14;
    let (i, j) = ((spot.uv.x / size).floor(), (spot.uv.y / size).floor());
    let (i32x, i32y) = (i as i32, j as i32);
    let id = hash(i32x, i32y, spot.seed);
    let mut q = Vector2::new(spot.uv.x / size - i, spot.uv.y / size - j);
    for _ in 0..id & 3 {
        q = Vector2::new(1.0 - q.y, q.x);
    }
    let r = q.norm();
    let back = (Vector2::new(1.0, 1.0) - q).norm();
    let middle = (q - Vector2::new(0.5, 0.5)).norm();
    let ink = match (id >> 4) % 5 {
        0 => (r - 0.5).abs() < 0.1 || (back - 0.5).abs() < 0.1 || middle < 0.1,
        1 => (r - 0.55).abs() < 0.07 || (r - 0.8).abs() < 0.05 || (q.x - q.y).abs() < 0.05 && r < 0.45,
        2 => (middle - 0.3).abs() < 0.06 || middle < 0.14 || (q.x - 0.5).abs().min((q.y - 0.5).abs()) < 0.03,
        3 => q.x + q.y < 0.6 || (q.x + q.y - 1.1).abs() < 0.06,
        _ => (r - 0.35).abs() < 0.05 || back < 0.3 || (back - 0.5).abs() < 0.04,
    };
    let hue = unit(hash(i32x, i32y, spot.seed ^ 0x4D));
    let paint = mix(colours[0], srgb(0x3E_6FA8), hue * 0.7) * (0.8 + 0.3 * spot.fractal(0.03, 171));
    let glaze = colours[1] * (0.88 + 0.14 * hue + 0.08 * spot.fractal(0.2, 172));
    let margin = (0.5 - (q.x - 0.5).abs()).min(0.5 - (q.y - 0.5).abs()) * size;
    let tile = smoothstep(0.001, 0.003, margin);
    // Some tiles are gone and the mortar shows.
    let lost = unit(hash(i32x, i32y, spot.seed ^ 5)) > 0.965;
    let mortar = srgb(0x9F_9684) * (0.9 + 0.3 * spot.fractal(0.04, 173));
    if lost {
        return Look::dull(mortar, 0.0);
    }
    let face = if ink { mix(glaze, paint, 0.93) } else { glaze };
    Look { albedo: mix(mortar * 0.7, face, tile), height: 0.004 * tile, gloss: 0.3 * tile }
}

/// A poster: a picture of hills and a disc above, a headline, then lines of words.
pub fn print(spot: &Spot, colours: &[Rgb; 3], size: [f64; 2]) -> Look {
    let [paper, ink, accent] = *colours;
    let (s, t) = (spot.uv.x / size[0], 1.0 - spot.uv.y / size[1]);
    let seed = spot.seed;
    let aged = paper * (0.93 + 0.1 * spot.fractal(0.2, 181) + 0.05 * spot.fractal(0.02, 182));
    let margin = s.min(1.0 - s).min(t * 1.4).min((1.0 - t) * 1.4);
    let colour = if margin < 0.06 {
        aged
    } else if t < 0.52 {
        landscape(s, t / 0.52, seed, &[accent, ink, paper])
    } else if t < 0.66 {
        let headline = word(s, (t - 0.545) / 0.085, 0.085, seed ^ 3);
        if headline { ink } else { aged }
    } else {
        let line = ((t - 0.68) / 0.035).floor();
        let within = ((t - 0.68) / 0.035 - line) / 0.62;
        if t < 0.93 && word(s, within, 0.022, seed ^ hash(line as i32, 9, seed)) {
            mix(ink, aged, 0.25)
        } else {
            aged
        }
    };
    let crease = 0.06 * spot.fractal(0.15, 183);
    Look::dull(colour * (1.0 + crease), 0.0015 * spot.fractal(0.12, 184))
}

/// Whether letters of pitch `pitch` cover the place `s` of a line; `t` runs from its top to its bottom.
fn word(s: f64, t: f64, pitch: f64, seed: u32) -> bool {
    if !(0.0..1.0).contains(&t) || !(0.1..0.9).contains(&s) {
        return false;
    }
    let k = ((s - 0.1) / pitch).floor();
    let x = (s - 0.1) / pitch - k;
    let h = hash(k as i32, 0, seed);
    // One in six is a gap between words; letters are two strokes of a 3 × 3 grid.
    if h.is_multiple_of(6) || !(0.08..0.88).contains(&x) {
        return false;
    }
    let (column, row) = (((x - 0.08) / 0.27) as u32, (t * 3.0) as u32);
    (h >> (4 + column + 3 * row)) & 1 == 1 || column == (h >> 20) % 3
}

/// Flat layers of hills under a sky with a disc.
fn landscape(s: f64, t: f64, seed: u32, colours: &[Rgb; 3]) -> Rgb {
    let [accent, ink, paper] = *colours;
    let r = |k: i32| unit(hash(k, 4, seed));
    let disc = (s - 0.3 - 0.4 * r(1)).hypot((t - 0.34) * 0.75);
    let mut colour = mix(mix(accent, paper, 0.55), accent, t);
    if disc < 0.1 + 0.06 * r(2) {
        colour = mix(paper, srgb(0xE8_B04A), 0.5);
    }
    for layer in 0..4 {
        let x = Vector2::new(s * (2.0 + r(layer)), f64::from(layer) * 9.7);
        let ridge = 0.42 + 0.14 * f64::from(layer) + 0.16 * fractal(x, 1.0, 0.5, 0.01, seed);
        if t > ridge {
            colour = mix(accent, ink, 0.25 + 0.23 * f64::from(layer));
        }
    }
    colour
}
