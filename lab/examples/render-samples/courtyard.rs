//! The courtyard: a fountain between an arcade, a plastered house and an overgrown garden wall. The
//! cameras move sideways.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point3, Vector3};

use super::build::{Axes, Builder, MaterialId};
use super::furnish::{
    Foliage, Palette, barrel, bunting, cloth, column, foliage, fruit_crate, ivy, leaf, opening, poster, pot,
    potted_plant, shutter, tree, window, windows, wooden_crate,
};
use super::light::Light;
use super::scene::Scene;
use super::shape::{Opening, Outline, Shape};
use super::texture::{Masonry, Pattern, srgb};
use epiline::geometry::{Camera, Frame};

/// The two cameras: 42 cm apart, a little toed in, the second slightly raised and rolled.
pub fn cameras(frame: Frame) -> Option<[Camera; 2]> {
    let focal = 640.0 / 768.0 * frame.width as f64;
    let camera = |x: f64, y: f64, z: f64, target: Point3<f64>, roll: f64| {
        let up = Vector3::new(roll, 0.0, 1.0);
        Camera::looking_at(Point3::new(x, y, z), target, up, focal, frame.centre())
    };
    Some([
        camera(-0.21, 0.0, 1.68, Point3::new(-0.12, 9.0, 1.98), 0.0)?,
        camera(0.21, 0.06, 1.72, Point3::new(0.07, 9.0, 2.02), 0.018)?,
    ])
}

/// The scene. x is right, y away, z up, metres; the first camera stands near the origin.
pub fn scene() -> Scene {
    let mut b = Builder::new(20);
    let p = Palette::new(&mut b);
    let paving = b.material(Pattern::Masonry(Masonry::flagstones()));
    b.floor(Point3::new(-12.0, -6.0, 0.0), [24.0, 24.0], paving);
    arcade(&mut b, &p);
    house(&mut b, &p);
    garden_wall(&mut b, &p);
    fountain(&mut b, &p, Point3::new(-0.75, 7.1, 0.0));
    goods(&mut b, &p);
    plants(&mut b, &p);
    let flags =
        [0xB8_3A30, 0xE0_C8_90, 0x2E_6A80, 0xD8_9030, 0x5A_7A40].map(|code| cloth(&mut b, [code; 3], 0.09));
    bunting(&mut b, &p, Point3::new(-3.6, 6.3, 3.25), Point3::new(3.4, 7.6, 3.9), &flags);
    b.finish(Light::day(Vector3::new(-0.62, -0.5, 0.72)))
}

/// Three arches on columns, a storey with windows above, the walk behind, and the roof.
fn arcade(b: &mut Builder, p: &Palette) {
    const PITCH: f64 = 2.333;
    const SPRING: f64 = 2.15;
    let mut brick = Masonry::brick();
    brick.weathering = 0.7;
    let wall = b.material(Pattern::Masonry(brick.clone()));
    let ring = b
        .material(Pattern::Voussoirs(Masonry { size: [0.2, 0.19], joint: 0.012, ..Masonry::ashlar() }, 1.22));
    let front = Axes::facing(-3.6, 10.5, SPRING, 0.0);
    let arch = |k: usize| Opening {
        left: 0.142 + PITCH * k as f64,
        bottom: 0.0,
        width: 2.05,
        height: 0.0,
        arched: true,
    };
    let lights =
        [opening(0.7, 1.75, 0.85, 1.1), opening(3.05, 1.75, 0.85, 1.1), opening(5.4, 1.75, 0.85, 1.1)];
    let openings: Vec<_> = (0..3).map(arch).chain(lights).collect();
    b.wall(&front, [7.0, 3.2], &openings, 0.45, wall);
    let paints = [0x3E_6B62, 0x3E_6B62, 0x4A_7A6E].map(|code| shutter(b, code));
    for (o, paint) in lights.iter().zip(paints) {
        window(b, p, &front, o, Some(paint));
    }
    for k in 0..3 {
        let o = arch(k);
        let corner = front.moved(o.left + 1.025 - 1.22, 0.0, 0.03);
        b.patch(&corner, [2.44, 1.22], Outline::Arch(0.84), ring);
    }
    for k in 0..4 {
        let x = -3.6 + PITCH * f64::from(k);
        column(b, p, Point3::new(x, 10.72, 0.0), 0.15, SPRING);
    }
    b.block(&front.moved(0.0, 1.38, 0.0), [7.0, 0.13, 0.09], p.stone);
    b.block(&front.moved(0.0, 3.08, 0.0), [7.0, 0.16, 0.16], p.stone);
    let tiles = b.material(Pattern::RoofTiles([0x9A_4E34, 0xC0_7048, 0xB0_8060].map(srgb)));
    let eaves = front.moved(-0.5, 3.2, 0.4);
    b.patch(&eaves.leaning(1.12), [8.5, 5.0], Outline::Rectangle, tiles);
    walk_behind(b, p, &brick);
}

/// The walk behind the arches: a painted wall with doors, a beamed ceiling.
fn walk_behind(b: &mut Builder, p: &Palette, under: &Masonry) {
    let plaster = b.material(Pattern::Plaster(srgb(0xD8_B890), 0.45, under.clone()));
    let inner = Axes::facing(-5.0, 13.0, 0.0, 0.0);
    b.patch(&inner, [10.0, 3.4], Outline::Rectangle, plaster);
    b.floor(Point3::new(-5.0, 10.5, 3.35), [10.0, 2.6], p.wood);
    for k in 0..5 {
        b.block(&inner.moved(1.3 + 1.7 * f64::from(k), 3.1, 0.0), [0.16, 0.22, 2.4], p.door);
    }
    for (x, width) in [(1.9, 1.0), (6.9, 1.1)] {
        b.block(&inner.moved(x, 0.0, 0.0), [width, 2.2, 0.06], p.door);
        b.frame(&inner.moved(x, 0.0, 0.0), [width, 2.2], 0.13, 0.1, p.stone);
    }
    poster(b, &inner.moved(4.25, 0.95, 0.02), [0.8, 1.15], [0xE6_DCC0, 0x28_303A, 0x3C_7C8C]);
    poster(b, &inner.moved(3.35, 1.05, 0.02), [0.62, 0.9], [0xEA_E0CC, 0x3A_2020, 0xC0_5038]);
    poster(b, &inner.moved(5.35, 0.9, 0.02), [0.7, 1.05], [0xE4_E0D0, 0x20_3820, 0x7A_9A4A]);
    for x in [-3.6, 3.4] {
        let side = Axes::facing(x, 10.5, 0.0, FRAC_PI_2);
        b.patch(&side, [2.5, 3.4], Outline::Rectangle, plaster);
    }
}

/// The plastered house on the right, lit by the sun.
fn house(b: &mut Builder, p: &Palette) {
    let under = Masonry { weathering: 0.3, ..Masonry::brick() };
    let plaster = b.material(Pattern::Plaster(srgb(0xDD_AE68), 0.42, under));
    let wall = Axes::facing(3.4, 10.5, 0.0, -FRAC_PI_2);
    let (door, upper) =
        (opening(1.0, 0.0, 0.95, 2.1), [opening(1.0, 3.3, 0.8, 1.2), opening(3.0, 3.3, 0.8, 1.2)]);
    let low = opening(2.95, 1.05, 0.8, 1.15);
    b.wall(&wall, [11.0, 5.35], &[door, low, upper[0], upper[1]], 0.3, plaster);
    let inner = wall.moved(door.left, 0.0, -0.22);
    b.block(&inner, [door.width, door.height, 0.05], p.door);
    b.frame(&wall.moved(door.left, 0.0, 0.0), [door.width, door.height], 0.14, 0.05, p.stone);
    windows(b, p, &wall, &[upper[0], upper[1], low], 0x5C_7F8E);
    let tiles = b.material(Pattern::Azulejo([srgb(0x24_4A8C), srgb(0xE6_E4DA)]));
    b.block(&wall.moved(2.15, 0.06, 0.0), [2.6, 0.82, 0.02], tiles);
    b.frame(&wall.moved(2.15, 0.06, 0.0), [2.6, 0.82], 0.05, 0.035, p.stone);
    b.block(&wall.moved(0.0, 2.85, 0.0), [11.0, 0.1, 0.06], p.stone);
    let roof = b.material(Pattern::RoofTiles([0xA0_5236, 0xC4_7A50, 0xA8_7A5C].map(srgb)));
    b.patch(&wall.moved(-0.5, 5.3, 0.45).leaning(1.15), [12.0, 4.0], Outline::Rectangle, roof);
    b.block(&wall.moved(0.0, 5.18, 0.0), [11.0, 0.14, 0.2], p.stone);
    // An awning over the door, and a lantern.
    let stripes = cloth(b, [0xC4_4A38, 0xE8_DEC8, 0xD8_8A48], 0.17);
    b.patch(&wall.moved(0.6, 2.35, 0.95).leaning(1.05), [1.75, 1.1], Outline::Rectangle, stripes);
    for x in [0.62, 2.33] {
        b.rod(wall.at(x, 2.35, 0.95), wall.at(x, 2.1, 0.02), [0.014, 0.014], p.iron);
    }
}

/// The garden wall on the left, in its own shade, with ivy; a garden and a far house behind.
fn garden_wall(b: &mut Builder, p: &Palette) {
    let brick =
        Masonry { palette: [0x70_3A2E, 0x9A_5540, 0xB8_8468].map(srgb), moss: 0.5, ..Masonry::brick() };
    let wall_material = b.material(Pattern::Masonry(brick));
    let wall = Axes::facing(-3.6, -1.0, 0.0, FRAC_PI_2);
    let niche = Opening { left: 8.75, bottom: 0.8, width: 0.75, height: 0.75, arched: true };
    b.wall(&wall, [11.5, 2.75], &[niche], 0.3, wall_material);
    b.patch(&wall.moved(8.7, 0.7, -0.3), [1.0, 1.5], Outline::Rectangle, p.clay);
    pot(b, p, wall.at(9.12, 0.8, -0.12), 0.16, 0.42);
    b.block(&wall.moved(-0.1, 2.72, -0.35), [11.6, 0.1, 0.45], p.stone);
    ivy(b, p, &wall.moved(6.1, 0.0, 0.0), [2.2, 2.75], 20, 5);
    ivy(b, p, &wall.moved(9.6, 0.0, 0.0), [1.6, 2.75], 12, 8);
    let crown =
        |extent: [f64; 3], leaves, seed| Foliage { extent, leaves, leaf: [0.2, 0.11], blossoms: None, seed };
    tree(b, p, Point3::new(-6.6, 12.5, 0.0), 5.9, &crown([1.9, 1.6, 1.6], 5200, 31));
    foliage(b, p, Point3::new(-4.7, 9.4, 2.9), &crown([0.9, 1.6, 0.55], 1500, 32));
    for (x, height, seed) in [(-9.2, 7.6, 41), (-10.6, 6.6, 42)] {
        let tall = Foliage { leaf: [0.26, 0.1], ..crown([0.75, 0.75, height / 2.0], 3400, seed) };
        foliage(b, p, Point3::new(x, 19.0, height / 2.0), &tall);
    }
    let far = b.material(Pattern::Plaster(srgb(0xC9_8A6A), 0.2, Masonry::brick()));
    b.block(&Axes::facing(-9.0, 26.0, 0.0, 0.1), [7.0, 5.2, 4.0], far);
}

/// A round basin, a turned stem, a bowl and a sphere on top.
fn fountain(b: &mut Builder, p: &Palette, base: Point3<f64>) {
    b.lathe(
        base,
        &[
            (1.5, 0.0),
            (1.5, 0.12),
            (1.25, 0.12),
            (1.2, 0.2),
            (1.16, 0.44),
            (1.27, 0.5),
            (1.29, 0.58),
            (1.08, 0.58),
            (1.05, 0.3),
        ],
        p.stone,
    );
    b.lathe(base, &[(1.5, 0.12), (1.2, 0.121)], p.stone);
    b.lathe(base, &[(1.29, 0.58), (1.08, 0.581)], p.stone);
    let water = b.material(Pattern::Water(srgb(0x2C_5048)));
    b.disc(base + Vector3::z() * 0.47, 1.07, water);
    let stem = [
        (0.3, 0.3),
        (0.3, 0.52),
        (0.2, 0.6),
        (0.13, 0.72),
        (0.17, 0.86),
        (0.2, 0.94),
        (0.12, 1.04),
        (0.13, 1.12),
        (0.3, 1.2),
        (0.48, 1.29),
        (0.56, 1.4),
        (0.58, 1.42),
        (0.5, 1.42),
        (0.3, 1.33),
        (0.12, 1.31),
        (0.1, 1.5),
        (0.15, 1.58),
        (0.09, 1.66),
        (0.07, 1.74),
    ];
    b.lathe(base, &stem, p.stone);
    b.disc(base + Vector3::z() * 1.385, 0.47, water);
    b.add(Shape::Sphere { centre: base + Vector3::z() * 1.86, radius: 0.15 }, p.stone);
    // Lily pads in the basin.
    for k in 0..9 {
        let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
        let centre = base + Vector3::new(cos * 0.78, sin * 0.8, 0.476 + 0.001 * f64::from(k));
        b.disc(centre, 0.085 + 0.02 * f64::from(k % 3), p.leaves[k as usize % 3]);
        if k % 4 == 1 {
            for petal in 0..7 {
                let (s, c) = (TAU * f64::from(petal) / 7.0).sin_cos();
                let along = Vector3::new(c, s, 0.8);
                leaf(b, centre, along, Vector3::new(-c, -s, 1.2), [0.1, 0.05], p.blossoms[1]);
            }
        }
    }
}

/// Crates, fruit and a barrel in the foreground.
fn goods(b: &mut Builder, p: &Palette) {
    let stack = |x: f64, y: f64, z: f64, yaw: f64| Axes::facing(x, y, z, yaw);
    wooden_crate(b, p, &stack(1.25, 5.35, 0.0, 0.16), [0.78, 0.56, 0.6]);
    wooden_crate(b, p, &stack(1.98, 5.05, 0.0, -0.24), [0.62, 0.46, 0.52]);
    fruit_crate(b, p, &stack(1.36, 5.3, 0.56, 0.05), [0.56, 0.2, 0.42], p.fruit[0], 3);
    fruit_crate(b, p, &stack(2.02, 5.0, 0.46, -0.3), [0.52, 0.18, 0.4], p.fruit[1], 4);
    fruit_crate(b, p, &stack(0.86, 4.75, 0.0, 0.42), [0.5, 0.18, 0.36], p.fruit[2], 5);
    barrel(b, p, Point3::new(-2.12, 5.15, 0.0), 0.33, 0.86);
    barrel(b, p, Point3::new(-2.72, 5.75, 0.0), 0.3, 0.8);
    // A board leaning against the barrel: the day's menu.
    let board = Axes::facing(-1.86, 4.66, 0.0, -0.18).leaning(0.2);
    poster(b, &board, [0.5, 0.74], [0x3A_403E, 0xE4_DEC8, 0xC8_7A3C]);
    b.frame(&board.moved(0.0, 0.0, -0.005), [0.5, 0.74], 0.035, 0.03, p.door);
}

/// Pots, flowers and the orange tree.
fn plants(b: &mut Builder, p: &Palette) {
    let bush = |extent: [f64; 3], leaves, blossoms, seed| Foliage {
        extent,
        leaves,
        leaf: [0.1, 0.05],
        blossoms,
        seed,
    };
    let [red, pink, yellow] = p.flowers();
    let on_barrel = Point3::new(-2.12, 5.15, 0.84);
    potted_plant(b, p, on_barrel, 0.75, &bush([0.3, 0.3, 0.24], 420, red, 51));
    let rows = [
        (-3.2, 7.3, 1.15, [0.36, 0.36, 0.42], pink, 52),
        (-3.15, 8.2, 1.0, [0.3, 0.3, 0.34], None, 53),
        (-3.2, 9.15, 1.2, [0.34, 0.34, 0.5], yellow, 54),
        (2.9, 6.75, 1.1, [0.32, 0.32, 0.36], red, 55),
        (0.55, 8.6, 0.9, [0.3, 0.3, 0.3], pink, 56),
        (-2.2, 9.9, 1.1, [0.3, 0.3, 0.45], None, 57),
    ];
    for (x, y, size, extent, blossoms, seed) in rows {
        potted_plant(b, p, Point3::new(x, y, 0.0), size, &bush(extent, 520, blossoms, seed));
    }
    orange_tree(b, p, Point3::new(2.05, 8.5, 0.0));
}

fn orange_tree(b: &mut Builder, p: &Palette, base: Point3<f64>) {
    let fruit: MaterialId = p.fruit[0];
    let soil = pot(b, p, base, 0.42, 0.62);
    let crown =
        Foliage { extent: [0.85, 0.85, 0.75], leaves: 2600, leaf: [0.13, 0.06], blossoms: None, seed: 61 };
    tree(b, p, soil, 2.25, &crown);
    for k in 0..16 {
        let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
        let z = 1.15 + 0.065 * f64::from(k);
        let r = 0.74 * (1.0 - ((z - 1.5) / 0.85).powi(2)).max(0.05).sqrt();
        let centre = soil + Vector3::new(r * cos, r * sin, z);
        b.add(Shape::Sphere { centre, radius: 0.05 }, fruit);
    }
}
