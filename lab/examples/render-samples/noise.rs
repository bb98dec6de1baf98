//! Repeatable noise: integer hashes, gradient noise in octaves and random cells.
//!
//! Gradient noise after Perlin, *Improving noise*, SIGGRAPH 2002; cells after Worley, *A cellular texture
//! basis function*, SIGGRAPH 1996.
//!
//! # Pitfalls
//! Octaves shorter than two samples would alias differently in the two images of a pair, so every sum of
//! octaves takes the distance between neighbouring samples and stops there.

use nalgebra::Vector2;

/// A well mixed 32-bit value of a lattice point.
pub fn hash(x: i32, y: i32, seed: u32) -> u32 {
    let mut h = seed
        ^ (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77).rotate_left(15).wrapping_add(0x27D4_EB2F);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7FEB_352D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846C_A68B);
    h ^ (h >> 16)
}

/// A hash as a number in `0 .. 1`.
pub fn unit(h: u32) -> f64 {
    f64::from(h) / 4_294_967_296.0
}

/// Hermite step from 0 at `a` to 1 at `b`.
pub fn smoothstep(a: f64, b: f64, x: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Gradient noise with unit lattice, about −1 ..= 1, mean 0.
pub fn gradient_noise(p: Vector2<f64>, seed: u32) -> f64 {
    let (x0, y0) = (p.x.floor(), p.y.floor());
    let (fx, fy) = (p.x - x0, p.y - y0);
    let (ix, iy) = (x0 as i32, y0 as i32);
    let corner = |dx: i32, dy: i32| {
        let h = hash(ix.wrapping_add(dx), iy.wrapping_add(dy), seed);
        let (x, y) = (fx - f64::from(dx), fy - f64::from(dy));
        // Eight directions, length √2: cheap and without visible axes.
        match h & 7 {
            0 => x + y,
            1 => x - y,
            2 => -x + y,
            3 => -x - y,
            4 => 1.414 * x,
            5 => -1.414 * x,
            6 => 1.414 * y,
            _ => -1.414 * y,
        }
    };
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (fade(fx), fade(fy));
    let top = corner(0, 0) * (1.0 - u) + corner(1, 0) * u;
    let bottom = corner(0, 1) * (1.0 - u) + corner(1, 1) * u;
    top * (1.0 - v) + bottom * v
}

/// Gradient noise in octaves from `wavelength` down to two samples, each `gain` times the one before;
/// about −1 ..= 1.
pub fn fractal(p: Vector2<f64>, wavelength: f64, gain: f64, sample: f64, seed: u32) -> f64 {
    let (mut sum, mut amplitude, mut length) = (0.0, 1.0, wavelength);
    for octave in 0..9 {
        let weight = smoothstep(1.5 * sample, 3.0 * sample, length);
        if weight == 0.0 {
            break;
        }
        sum += weight * amplitude * gradient_noise(p / length, seed.wrapping_add(octave * 101));
        amplitude *= gain;
        // Not exactly one half, so that lattice lines of the octaves do not coincide.
        length *= 0.47;
    }
    sum
}

/// The random cell around a point.
pub struct Cell {
    /// A hash that names it.
    pub id: u32,
    /// Difference of the distances to the second nearest and the nearest centre: 0 on the border.
    pub border: f64,
    /// Distance to the nearest centre.
    pub centre: f64,
}

/// Cells of about unit size with random centres.
pub fn cell(p: Vector2<f64>, seed: u32) -> Cell {
    let (ix, iy) = (p.x.floor() as i32, p.y.floor() as i32);
    let (mut nearest, mut second, mut id) = (f64::INFINITY, f64::INFINITY, 0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (cx, cy) = (ix.wrapping_add(dx), iy.wrapping_add(dy));
            let h = hash(cx, cy, seed);
            let centre = Vector2::new(
                f64::from(cx) + 0.12 + 0.76 * unit(h),
                f64::from(cy) + 0.12 + 0.76 * unit(hash(cx, cy, seed ^ 0x51ED)),
            );
            let d = (p - centre).norm();
            if d < nearest {
                (second, nearest, id) = (nearest, d, h);
            } else if d < second {
                second = d;
            }
        }
    }
    Cell { id, border: second - nearest, centre: nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_repeatable_centred_and_continuous() {
        let mut sum = 0.0;
        for k in 0..4000 {
            let p = Vector2::new(f64::from(k) * 0.137, f64::from(k % 61) * 0.731);
            let v = fractal(p, 1.0, 0.5, 0.01, 7);
            assert!(v.to_bits() == fractal(p, 1.0, 0.5, 0.01, 7).to_bits());
            let near = fractal(p + Vector2::new(1e-7, 0.0), 1.0, 0.5, 0.01, 7);
            assert!((v - near).abs() < 1e-4);
            sum += v;
        }
        assert!((sum / 4000.0).abs() < 0.05);
    }

    #[test]
    fn octaves_below_the_sample_distance_are_left_out() {
        let p = Vector2::new(0.3, 0.4);
        assert!(fractal(p, 1.0, 0.5, 2.0, 1).abs() < f64::MIN_POSITIVE);
    }
}
