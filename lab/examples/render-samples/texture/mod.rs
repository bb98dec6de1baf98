//! Procedural materials: colour, relief and gloss as functions of metric surface coordinates.
//!
//! No pattern repeats: bricks, tiles, planks and letters take size, place and colour from hashes, so that
//! a point of a texture has one counterpart and not a row of them.

mod made;
mod masonry;
mod natural;

use nalgebra::{Vector2, Vector3};

pub use made::{Cloth, Painted, Planks};
pub use masonry::Masonry;

use super::noise::fractal;

/// A linear colour.
pub type Rgb = Vector3<f64>;

/// A linear colour from an sRGB triple as it is written in a palette, `0xRRGGBB`.
pub fn srgb(code: u32) -> Rgb {
    let channel = |shift: u32| {
        let c = f64::from((code >> shift) & 255) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    Rgb::new(channel(16), channel(8), channel(0))
}

/// Blend of two colours, `t` clamped to 0 ..= 1.
pub fn mix(a: Rgb, b: Rgb, t: f64) -> Rgb {
    a + (b - a) * t.clamp(0.0, 1.0)
}

/// A colour out of three by a number in 0 ..= 1, blended between neighbours.
pub fn pick(palette: &[Rgb; 3], t: f64) -> Rgb {
    if t < 0.5 { mix(palette[0], palette[1], 2.0 * t) } else { mix(palette[1], palette[2], 2.0 * t - 1.0) }
}

/// Where a texture is looked at.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    /// Surface coordinates, m.
    pub uv: Vector2<f64>,
    /// Distance to the neighbouring sample on the surface, m.
    pub sample: f64,
    /// Seed of the object.
    pub seed: u32,
}

impl Spot {
    fn moved(&self, dx: f64, dy: f64) -> Self {
        Self { uv: self.uv + Vector2::new(dx, dy), ..*self }
    }

    /// Octaves of noise at this spot.
    pub fn fractal(&self, wavelength: f64, salt: u32) -> f64 {
        fractal(self.uv, wavelength, 0.55, self.sample, self.seed ^ salt)
    }

    /// Octaves of noise stretched by different wavelengths along the two coordinates.
    pub fn stretched(&self, along_u: f64, along_v: f64, salt: u32) -> f64 {
        let p = Vector2::new(self.uv.x / along_u, self.uv.y / along_v);
        fractal(p, 1.0, 0.55, self.sample / along_u.min(along_v), self.seed ^ salt)
    }
}

/// What a texture says about a spot.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Linear diffuse colour.
    pub albedo: Rgb,
    /// Relief, m.
    pub height: f64,
    /// Strength of highlights.
    pub gloss: f64,
}

impl Look {
    /// A dull spot.
    pub fn dull(albedo: Rgb, height: f64) -> Self {
        Self { albedo, height, gloss: 0.0 }
    }
}

/// The kinds of material.
#[derive(Debug, Clone)]
pub enum Pattern {
    /// Brick, ashlar, flagstones, cobbles.
    Masonry(Masonry),
    /// Wedge stones around a half circle of the given outer radius, m.
    Voussoirs(Masonry, f64),
    /// Roof tiles in rows up the slope.
    RoofTiles([Rgb; 3]),
    /// Lime plaster of a colour, with stains and bare patches; the number is the bare share.
    Plaster(Rgb, f64, Masonry),
    /// Boards.
    Planks(Planks),
    /// Painted wood, worn.
    Painted(Painted),
    /// Limestone.
    Stone(Rgb),
    /// Fired clay.
    Terracotta(Rgb),
    /// Iron.
    Metal(Rgb),
    /// A leaf of a plant.
    Leaf(Rgb),
    /// Bark of a tree.
    Bark(Rgb),
    /// Skin of a fruit.
    Fruit(Rgb),
    /// Soil or gravel.
    Soil(Rgb),
    /// Still, murky water.
    Water(Rgb),
    /// A dim window pane.
    Glass(Rgb),
    /// Woven stripes.
    Cloth(Cloth),
    /// Painted tin-glazed tiles in two colours.
    Azulejo([Rgb; 2]),
    /// A printed sheet: picture, headline and text. Paper, ink and spot colours; its width and height, m.
    Print([Rgb; 3], [f64; 2]),
}

/// A pattern and what the light needs to know beside it.
#[derive(Debug, Clone)]
pub struct Material {
    pattern: Pattern,
    /// Mean diffuse colour, for light thrown on other things.
    pub mean: Rgb,
    /// Share of the sun that comes through from behind.
    pub translucency: f64,
}

impl Material {
    /// Measures the mean colour of a pattern.
    pub fn new(pattern: Pattern) -> Self {
        let translucency = match pattern {
            Pattern::Leaf(_) => 0.55,
            Pattern::Cloth(_) => 0.35,
            _ => 0.0,
        };
        let mut material = Self { pattern, mean: Rgb::zeros(), translucency };
        let spots = (0..100).map(|k| Spot {
            uv: Vector2::new(f64::from(k % 10) * 0.217, f64::from(k / 10) * 0.193),
            sample: 0.02,
            seed: 0,
        });
        material.mean = spots.map(|s| material.look(&s).albedo).sum::<Rgb>() / 100.0;
        material
    }

    /// Colour, relief and gloss.
    pub fn look(&self, spot: &Spot) -> Look {
        match &self.pattern {
            Pattern::Masonry(masonry) => masonry.look(spot),
            Pattern::Voussoirs(masonry, radius) => masonry.around(spot, *radius),
            Pattern::RoofTiles(palette) => masonry::roof(spot, palette),
            Pattern::Plaster(colour, bare, under) => masonry::plaster(spot, *colour, *bare, under),
            Pattern::Planks(planks) => planks.look(spot),
            Pattern::Painted(painted) => painted.look(spot),
            Pattern::Stone(colour) => natural::stone(spot, *colour),
            Pattern::Terracotta(colour) => natural::terracotta(spot, *colour),
            Pattern::Metal(colour) => natural::metal(spot, *colour),
            Pattern::Leaf(colour) => natural::leaf(spot, *colour),
            Pattern::Bark(colour) => natural::bark(spot, *colour),
            Pattern::Fruit(colour) => natural::fruit(spot, *colour),
            Pattern::Soil(colour) => natural::soil(spot, *colour),
            Pattern::Water(colour) => natural::water(spot, *colour),
            Pattern::Glass(colour) => made::glass(spot, *colour),
            Pattern::Cloth(cloth) => cloth.look(spot),
            Pattern::Azulejo(colours) => made::azulejo(spot, colours),
            Pattern::Print(colours, size) => made::print(spot, colours, *size),
        }
    }

    /// The look of a spot and the slope of its relief along the two coordinates.
    pub fn look_and_slope(&self, spot: &Spot) -> (Look, Vector2<f64>) {
        let look = self.look(spot);
        let step = spot.sample.max(0.0012);
        let rise = |dx: f64, dy: f64| (self.look(&spot.moved(dx, dy)).height - look.height) / step;
        let slope = Vector2::new(rise(step, 0.0), rise(0.0, step));
        (look, slope.map(|s| s.clamp(-1.2, 1.2)))
    }
}
