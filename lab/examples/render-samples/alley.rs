//! The alley: houses on both sides, an archway ahead, sun beyond. The cameras move forward.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3};

use super::build::{Axes, Builder};
use super::furnish::{
    Foliage, Palette, barrel, bunting, cloth, foliage, fruit_crate, ivy, opening, poster, potted_plant, tree,
    window, windows, wooden_crate,
};
use super::light::Light;
use super::scene::Scene;
use super::shape::{Opening, Outline};
use super::texture::{Masonry, Pattern, srgb};
use epiline::geometry::{Camera, Frame};

/// The two cameras: the second 70 cm further on, a little to the right and higher, both epipoles inside.
pub fn cameras(frame: Frame) -> Option<[Camera; 2]> {
    let focal = 600.0 / 768.0 * frame.width as f64;
    let camera = |position: Point3<f64>, target: Point3<f64>, roll: f64| {
        Camera::looking_at(position, target, Vector3::new(roll, 0.0, 1.0), focal, frame.centre())
    };
    Some([
        camera(Point3::new(-0.08, 0.0, 1.6), Point3::new(-0.05, 10.0, 2.0), 0.0)?,
        camera(Point3::new(0.03, 0.7, 1.65), Point3::new(0.0, 10.0, 2.0), -0.012)?,
    ])
}

/// The scene. x is right, y down the alley, z up, metres.
pub fn scene() -> Scene {
    let mut b = Builder::new(77);
    let p = Palette::new(&mut b);
    let street = b.material(Pattern::Masonry(Masonry::setts()));
    b.floor(Point3::new(-14.0, -6.0, 0.0), [28.0, 46.0], street);
    left_side(&mut b, &p);
    right_side(&mut b, &p);
    archway(&mut b, &p);
    square(&mut b, &p);
    things(&mut b, &p);
    let flags =
        [0xC0_4438, 0xE4_D8B0, 0x3A_7890, 0xE0_A040, 0x6A_8A48].map(|code| cloth(&mut b, [code; 3], 0.09));
    bunting(&mut b, &p, Point3::new(-1.7, 6.2, 4.1), Point3::new(1.7, 7.6, 3.7), &flags);
    bunting(&mut b, &p, Point3::new(-1.8, 10.4, 3.9), Point3::new(1.5, 9.4, 4.4), &flags);
    let mut light = Light::day(Vector3::new(0.42, -0.36, 0.8));
    light.exposure = 0.8;
    b.finish(light)
}

/// A door in an opening, with a stone frame and a step.
fn door(b: &mut Builder, p: &Palette, wall: &Axes, o: &Opening) {
    let height = o.height + if o.arched { o.width / 2.0 } else { 0.0 };
    b.block(&wall.moved(o.left, o.bottom, -0.24), [o.width, height, 0.05], p.door);
    b.block(&wall.moved(o.left - 0.15, 0.0, 0.0), [o.width + 0.3, 0.12, 0.3], p.stone);
    if !o.arched {
        b.frame(&wall.moved(o.left, 0.0, 0.0), [o.width, o.height], 0.14, 0.05, p.stone);
    }
}

/// The end face of a house that stands out from its neighbour, and its cornice.
fn finish_house(b: &mut Builder, p: &Palette, wall: &Axes, size: [f64; 2]) {
    b.block(&wall.moved(-0.05, size[1] - 0.1, -0.1), [size[0] + 0.1, 0.16, 0.32], p.stone);
}

fn left_side(b: &mut Builder, p: &Palette) {
    let side = |x: f64, y: f64| Axes::facing(x, y, 0.0, FRAC_PI_2);
    let end = |x: f64, y: f64| Axes::facing(x - 1.0, y, 0.0, 0.0);

    let brick = b.material(Pattern::Masonry(Masonry::brick()));
    let wall = side(-1.75, -3.0);
    let o = [opening(6.0, 1.1, 0.8, 1.15), opening(4.2, 1.1, 0.7, 1.1), opening(5.6, 3.6, 0.8, 1.2)];
    b.wall(&wall, [8.0, 6.2], &o, 0.3, brick);
    windows(b, p, &wall, &o, 0x4A_7490);
    finish_house(b, p, &wall, [8.0, 6.2]);

    let ochre = b.material(Pattern::Plaster(srgb(0xE0_AE62), 0.5, Masonry::brick()));
    let wall = side(-1.62, 5.0);
    b.patch(&end(-1.62, 5.0), [1.0, 5.4], Outline::Rectangle, ochre);
    let entrance = Opening { left: 1.0, bottom: 0.0, width: 1.05, height: 1.75, arched: true };
    let o = [opening(2.75, 1.1, 0.8, 1.2), opening(1.1, 3.2, 0.8, 1.25), opening(2.9, 3.2, 0.8, 1.25)];
    b.wall(&wall, [4.6, 5.4], &[entrance, o[0], o[1], o[2]], 0.3, ochre);
    door(b, p, &wall, &entrance);
    windows(b, p, &wall, &o, 0x4C_7A52);
    finish_house(b, p, &wall, [4.6, 5.4]);

    let ashlar = b.material(Pattern::Masonry(Masonry::ashlar()));
    let wall = side(-1.9, 9.6);
    let o = [opening(1.2, 1.2, 0.7, 1.0), opening(3.0, 3.0, 0.8, 1.1)];
    let gate = opening(2.7, 0.0, 1.0, 2.1);
    b.wall(&wall, [5.4, 6.0], &[o[0], o[1], gate], 0.3, ashlar);
    door(b, p, &wall, &gate);
    windows(b, p, &wall, &o, 0xA0_5238);
    finish_house(b, p, &wall, [5.4, 6.0]);
}

fn right_side(b: &mut Builder, p: &Palette) {
    // These walls run towards the viewer: their origin is the far end.
    let side = |x: f64, y: f64| Axes::facing(x, y, 0.0, -FRAC_PI_2);
    let end = |x: f64, y: f64| Axes::facing(x, y, 0.0, 0.0);

    let rose = b.material(Pattern::Plaster(srgb(0xD2_9078), 0.55, Masonry::ashlar()));
    let wall = side(1.66, 4.6);
    let o = [opening(0.5, 1.05, 0.85, 1.2), opening(0.6, 3.2, 0.8, 1.2), opening(2.0, 1.05, 0.8, 1.2)];
    b.wall(&wall, [8.0, 4.6], &o, 0.3, rose);
    windows(b, p, &wall, &o, 0x6E_8688);
    finish_house(b, p, &wall, [8.0, 4.6]);

    let ashlar = Masonry { palette: [0xB0_9A78, 0xC8_B48C, 0xA0_8A70].map(srgb), ..Masonry::ashlar() };
    let ashlar = b.material(Pattern::Masonry(ashlar));
    let wall = side(1.82, 9.2);
    let gate = Opening { left: 1.6, bottom: 0.0, width: 1.1, height: 1.7, arched: true };
    let o = [opening(0.35, 1.2, 0.75, 1.0)];
    b.wall(&wall, [4.6, 3.3], &[gate, o[0]], 0.3, ashlar);
    door(b, p, &wall, &gate);
    window(b, p, &wall, &o[0], None);
    finish_house(b, p, &wall, [4.6, 3.3]);

    let brick = Masonry { palette: [0x8A_4A36, 0xB4_6C4C, 0xCC_9872].map(srgb), ..Masonry::brick() };
    let brick = b.material(Pattern::Masonry(brick));
    let wall = side(1.58, 15.0);
    b.patch(&end(1.58, 9.2), [1.2, 6.4], Outline::Rectangle, brick);
    let o = [opening(3.8, 1.1, 0.8, 1.2), opening(1.6, 1.1, 0.8, 1.2), opening(3.6, 3.4, 0.8, 1.2)];
    b.wall(&wall, [5.8, 6.4], &o, 0.3, brick);
    windows(b, p, &wall, &o, 0x3C_7C78);
    finish_house(b, p, &wall, [5.8, 6.4]);
}

/// The house across the alley with the passage below.
fn archway(b: &mut Builder, p: &Palette) {
    let cream = b.material(Pattern::Plaster(srgb(0xE2_CDA0), 0.45, Masonry::brick()));
    let front = Axes::facing(-2.4, 15.0, 0.0, 0.0);
    let passage = Opening { left: 1.15, bottom: 0.0, width: 2.3, height: 2.0, arched: true };
    let o = opening(1.85, 3.85, 0.85, 1.1);
    b.wall(&front, [4.8, 5.4], &[passage, o], 1.6, cream);
    windows(b, p, &front, &[o], 0x6A_4A3C);
    let stones = Masonry { size: [0.3, 0.26], ..Masonry::ashlar() };
    let ring = b.material(Pattern::Voussoirs(stones, 1.4));
    b.patch(&front.moved(0.9, 2.0, 0.03), [2.8, 1.4], Outline::Arch(0.82), ring);
    for x in [0.9, 3.45] {
        b.block(&front.moved(x, 0.0, 0.0), [0.25, 2.0, 0.05], p.stone);
    }
    let tiles = b.material(Pattern::RoofTiles([0x9A_4E34, 0xC0_7048, 0xB0_8060].map(srgb)));
    b.patch(&front.moved(-0.3, 5.3, 0.35).leaning(1.1), [5.4, 3.0], Outline::Rectangle, tiles);
}

/// What is seen through the archway: a sunlit house, a tree, a cart of crates.
fn square(b: &mut Builder, p: &Palette) {
    let yellow = b.material(Pattern::Plaster(srgb(0xE8_C070), 0.3, Masonry::brick()));
    let front = Axes::facing(-7.0, 26.0, 0.0, 0.0);
    let o = [opening(5.4, 1.1, 1.0, 1.5), opening(8.2, 1.1, 1.0, 1.5)];
    b.wall(&front, [14.0, 7.5], &o, 0.3, yellow);
    windows(b, p, &front, &o, 0x3A_6A5C);
    let crown = Foliage { extent: [1.3, 1.3, 1.1], leaves: 1800, leaf: [0.2, 0.1], blossoms: None, seed: 71 };
    tree(b, p, Point3::new(0.9, 22.0, 0.0), 4.0, &crown);
    wooden_crate(b, p, &Axes::facing(-1.1, 20.5, 0.0, 0.3), [0.8, 0.7, 0.7]);
}

fn things(b: &mut Builder, p: &Palette) {
    let bush =
        |extent: [f64; 3], blossoms, seed| Foliage { extent, leaves: 480, leaf: [0.1, 0.05], blossoms, seed };
    let [red, pink, yellow] = p.flowers();
    let pots = [
        (-1.35, 4.55, 1.0, [0.28, 0.28, 0.34], red, 81),
        (-1.25, 5.6, 1.1, [0.3, 0.3, 0.45], None, 82),
        (-1.3, 8.1, 1.0, [0.3, 0.3, 0.36], pink, 83),
        (-1.5, 10.4, 1.2, [0.34, 0.34, 0.5], yellow, 84),
        (1.5, 5.3, 1.0, [0.28, 0.28, 0.3], pink, 85),
        (1.5, 8.6, 1.1, [0.3, 0.3, 0.5], None, 86),
        (1.25, 12.0, 1.1, [0.3, 0.3, 0.42], red, 87),
    ];
    for (x, y, size, extent, blossoms, seed) in pots {
        potted_plant(b, p, Point3::new(x, y, 0.0), size, &bush(extent, blossoms, seed));
    }
    wooden_crate(b, p, &Axes::facing(0.92, 4.55, 0.0, -0.2), [0.6, 0.5, 0.5]);
    fruit_crate(b, p, &Axes::facing(0.98, 4.5, 0.5, -0.3), [0.48, 0.17, 0.36], p.fruit[0], 6);
    fruit_crate(b, p, &Axes::facing(0.7, 4.0, 0.0, -0.1), [0.46, 0.17, 0.34], p.fruit[1], 7);
    barrel(b, p, Point3::new(1.4, 6.4, 0.0), 0.3, 0.82);
    barrel(b, p, Point3::new(-1.55, 9.25, 0.0), 0.3, 0.8);

    let left = Axes::facing(-1.75, 0.0, 0.0, FRAC_PI_2);
    poster(b, &left.moved(4.15, 1.0, 0.0), [0.62, 0.92], [0xE8_DEC4, 0x26_2E3A, 0xC0_5A38]);
    let right = Axes::facing(1.66, 4.6, 0.0, -FRAC_PI_2);
    b.block(&right.moved(-0.02, 0.0, 0.0), [8.0, 0.55, 0.05], p.stone);
    let ashlar = Axes::facing(1.82, 9.2, 0.0, -FRAC_PI_2);
    poster(b, &ashlar.moved(3.2, 0.95, 0.0), [0.66, 0.98], [0xEA_E2CE, 0x30_2030, 0x3A_7A88]);
    ivy(b, p, &Axes::facing(-1.9, 11.0, 0.0, FRAC_PI_2), [1.6, 4.2], 18, 9);
    ivy(b, p, &ashlar.moved(-0.2, 0.0, 0.0), [1.4, 3.3], 14, 10);
    let spill =
        Foliage { extent: [0.5, 1.2, 0.5], leaves: 1300, leaf: [0.12, 0.07], blossoms: pink, seed: 91 };
    foliage(b, p, Point3::new(2.0, 7.2, 3.35), &spill);
    // Signs that hang across the way.
    for (x, y, z, codes) in [
        (-1.6, 6.9, 2.55, [0x2E_4A44, 0xE6_DCC0, 0xC8_9A50]),
        (0.95, 9.6, 2.5, [0x7A_2E28, 0xEA_DCC0, 0xD8_A850]),
    ] {
        let sign = Axes::facing(x, y, z, 0.0);
        poster(b, &sign, [0.6, 0.62], codes);
        b.frame(&sign.moved(0.0, 0.0, -0.008), [0.6, 0.62], 0.03, 0.03, p.iron);
    }
}
