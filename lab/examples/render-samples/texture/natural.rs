//! Stone, clay, iron, plants, soil and water.

use nalgebra::Vector2;

use super::{Look, Rgb, Spot, mix, srgb};
use crate::noise::{cell, smoothstep, unit};

/// Limestone: mottled, pitted, with grey and orange lichen.
pub fn stone(spot: &Spot, colour: Rgb) -> Look {
    let clouds = 1.0 + 0.2 * spot.fractal(0.5, 61) + 0.14 * spot.fractal(0.06, 62);
    let pit = smoothstep(0.42, 0.62, spot.fractal(0.03, 63)) * 0.45;
    let streak = 0.3 * smoothstep(0.1, 0.8, spot.stretched(0.07, 0.8, 64));
    let spots = spot.fractal(0.12, 65) + 0.5 * spot.fractal(0.7, 66);
    let lichen = smoothstep(0.5, 0.62, spots);
    let orange = smoothstep(0.62, 0.75, spot.fractal(0.08, 67) + 0.3 * spot.fractal(0.9, 68));
    let base = colour * (clouds - pit - streak).max(0.15);
    let albedo = mix(mix(base, srgb(0xA9_A999), 0.6 * lichen), srgb(0xB8_8A3C), 0.55 * orange);
    Look { albedo, height: 0.004 * spot.fractal(0.08, 69) - 0.003 * pit, gloss: 0.03 }
}

/// Fired clay with turning marks and bloom.
pub fn terracotta(spot: &Spot, colour: Rgb) -> Look {
    let rings = 0.08 * spot.stretched(0.6, 0.012, 71);
    let clouds = 0.16 * spot.fractal(0.15, 72) + 0.08 * spot.fractal(0.02, 73);
    let bloom = 0.45 * smoothstep(0.15, 0.7, spot.fractal(0.25, 74) + 0.25 * spot.fractal(0.03, 75));
    let albedo = mix(colour, srgb(0xD8_C9B2), bloom) * (1.0 + rings + clouds);
    Look { albedo, height: 0.0015 * spot.stretched(0.5, 0.02, 76), gloss: 0.06 }
}

/// Iron with rust.
pub fn metal(spot: &Spot, colour: Rgb) -> Look {
    let rust = smoothstep(0.05, 0.5, spot.fractal(0.09, 81) + 0.4 * spot.fractal(0.015, 82));
    let albedo = mix(colour, srgb(0x6E_4026), 0.7 * rust) * (1.0 + 0.25 * spot.fractal(0.03, 83));
    Look { albedo, height: 0.001 * spot.fractal(0.02, 84), gloss: 0.35 * (1.0 - rust) }
}

/// A leaf of its own shade, with a pale midrib.
pub fn leaf(spot: &Spot, colour: Rgb) -> Look {
    let (r, s) = (unit(spot.seed.wrapping_mul(0x9E37_79B1)), unit(spot.seed.wrapping_mul(0xC2B2_AE35)));
    let own = mix(colour, mix(srgb(0x9C_A83E), srgb(0x2F_5A2C), s), 0.45 * r) * (0.7 + 0.6 * s);
    let mottle = 1.0 + 0.18 * spot.fractal(0.05, 91);
    Look { albedo: own * mottle, height: 0.002 * spot.fractal(0.04, 92), gloss: 0.12 }
}

/// Bark: furrows along the trunk.
pub fn bark(spot: &Spot, colour: Rgb) -> Look {
    let furrow = spot.stretched(0.05, 0.22, 95);
    let tone = 0.95 + 0.45 * furrow + 0.15 * spot.fractal(0.02, 96);
    let moss = 0.4 * smoothstep(0.2, 0.7, spot.fractal(0.3, 97));
    Look::dull(mix(colour, srgb(0x6F_7442), moss) * tone.max(0.2), 0.012 * furrow)
}

/// Dimpled skin, riper on one side.
pub fn fruit(spot: &Spot, colour: Rgb) -> Look {
    let r = unit(spot.seed.wrapping_mul(0x9E37_79B1));
    let own = mix(
        colour,
        Rgb::new(colour.x, colour.y * 0.55, colour.z * 0.5),
        r * 0.7 + 0.3 * spot.fractal(0.06, 101),
    );
    let freckle = 0.35 * smoothstep(0.45, 0.7, spot.fractal(0.012, 102));
    let dimple = 0.0006 * spot.fractal(0.006, 103);
    Look { albedo: own * (0.85 + 0.3 * r - freckle), height: dimple, gloss: 0.22 }
}

/// Soil with small stones.
pub fn soil(spot: &Spot, colour: Rgb) -> Look {
    let pebble = cell(spot.uv / 0.035, spot.seed);
    let stone = unit(pebble.id.rotate_left(9)) > 0.6;
    let tone = 0.8 + 0.4 * spot.fractal(0.2, 111) + 0.25 * spot.fractal(0.02, 112);
    let dry = mix(colour, srgb(0xA8_9A80), 0.4 * smoothstep(0.0, 0.6, spot.fractal(0.7, 113)));
    let albedo = if stone && pebble.border > 0.15 {
        mix(srgb(0x8C_8478), srgb(0xC0_B59F), unit(pebble.id)) * (0.8 + 0.4 * pebble.border)
    } else {
        dry * tone.max(0.2)
    };
    Look::dull(albedo, 0.01 * spot.fractal(0.1, 114) + 0.008 * pebble.border.min(0.4))
}

/// Murky water with floating specks and ripples; nothing is mirrored, mirrored things have another depth.
pub fn water(spot: &Spot, colour: Rgb) -> Look {
    let clouds = 1.0 + 0.3 * spot.fractal(0.5, 121);
    let speck = cell(spot.uv / 0.045, spot.seed);
    let floating = unit(speck.id.rotate_left(7)) > 0.78 && speck.centre < 0.22 + 0.2 * unit(speck.id);
    let scum = smoothstep(0.15, 0.6, spot.fractal(0.35, 122) + 0.3 * spot.fractal(0.04, 123));
    let body = mix(colour * clouds, srgb(0x7D_8A4A), 0.6 * scum);
    let albedo = if floating { mix(srgb(0x9A_9A40), srgb(0x8A_5A2A), unit(speck.id)) } else { body };
    let ripple = spot.uv + Vector2::new(0.0, 0.02 * spot.fractal(0.2, 124));
    let moved = Spot { uv: ripple, ..*spot };
    Look { albedo, height: 0.004 * moved.stretched(0.2, 0.09, 125), gloss: 0.5 }
}
