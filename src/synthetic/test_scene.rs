//! Small scenes with every kind of motion at any picture size, for tests and benchmarks.

use image::DynamicImage;
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::build::{Axes, Builder};
use super::furnish::{Palette, barrel, column, poster, wooden_crate};
use super::light::Light;
use super::matches::true_matches;
use super::render::{Quality, render_with};
use super::scene::Scene;
use super::shape::Shape;
use super::texture::{Masonry, Pattern, srgb};
use crate::geometry::{Camera, Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;

/// How camera 2 differs from camera 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// To the right: epipoles at infinity.
    Sideways,
    /// Forward and a little aside: epipoles inside.
    Forward,
    /// To the right, both turned about the vertical towards the same point: epipoles outside.
    Converging,
    /// To the right and rolled by 20°.
    Roll,
    /// To the right with 1.5 times the focal length.
    Scale,
}

impl Motion {
    /// All motions.
    pub const ALL: [Self; 5] = [Self::Sideways, Self::Forward, Self::Converging, Self::Roll, Self::Scale];

    /// The two cameras for a picture size.
    pub fn cameras(self, frame: Frame) -> Option<[Camera; 2]> {
        let focal = 0.85 * frame.width as f64;
        let camera = |position: [f64; 3], target: [f64; 3], roll: f64, focal: f64| {
            let up = Vector3::new(roll.sin(), 0.0, roll.cos());
            Camera::looking_at(Point3::from(position), Point3::from(target), up, focal, frame.centre())
        };
        let straight = camera([0.0, 0.0, 1.5], [0.0, 8.0, 1.5], 0.0, focal)?;
        let aim = [0.1, 6.0, 1.4];
        Some(match self {
            Self::Sideways => [straight, camera([0.4, 0.0, 1.5], [0.4, 8.0, 1.5], 0.0, focal)?],
            Self::Forward => [straight, camera([0.09, 0.7, 1.55], [0.05, 8.0, 1.5], 0.0, focal)?],
            Self::Converging => {
                [camera([-0.5, 0.0, 1.5], aim, 0.0, focal)?, camera([0.8, 0.1, 1.5], aim, 0.0, focal)?]
            }
            Self::Roll => {
                let roll = 20f64.to_radians();
                [straight, camera([0.4, 0.0, 1.5], [0.3, 8.0, 1.5], roll, focal)?]
            }
            Self::Scale => [straight, camera([0.35, 0.0, 1.55], [0.1, 8.0, 1.5], 0.0, 1.5 * focal)?],
        })
    }
}

/// A rendered pair with its truth.
#[derive(Debug, Clone)]
pub struct TestPair {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// The exact fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// The cameras.
    pub cameras: [Camera; 2],
    /// Some 60 exact matches on textured surfaces.
    pub matches: Vec<PointPair>,
}

/// A paved yard between three walls with boxes, barrels, columns and balls; the seed moves things and
/// changes every texture.
pub fn test_scene(seed: u64) -> Scene {
    let mut rng = Pcg32::seed_from_u64(seed);
    let mut b = Builder::new(seed as u32 ^ 0x5EED);
    let p = Palette::new(&mut b);
    let paving = b.material(Pattern::Masonry(Masonry::flagstones()));
    let brick = b.material(Pattern::Masonry(Masonry::brick()));
    let ashlar = b.material(Pattern::Masonry(Masonry::ashlar()));
    let plaster = b.material(Pattern::Plaster(srgb(0xDA_B480), 0.5, Masonry::brick()));
    b.floor(Point3::new(-12.0, -6.0, 0.0), [24.0, 24.0], paving);
    b.patch(&Axes::facing(-6.0, 10.0, 0.0, 0.0), [12.0, 5.2], super::Outline::Rectangle, brick);
    let quarter = std::f64::consts::FRAC_PI_2;
    b.patch(&Axes::facing(-3.4, -2.0, 0.0, quarter), [12.0, 3.6], super::Outline::Rectangle, ashlar);
    b.patch(&Axes::facing(3.4, 10.0, 0.0, -quarter), [12.0, 4.2], super::Outline::Rectangle, plaster);
    for k in 0..3 {
        let x = -2.6 + 2.1 * f64::from(k) + rng.random_range(-0.2..0.2);
        let z = rng.random_range(1.2..2.2);
        poster(&mut b, &Axes::facing(x, 9.98, z, 0.0), [0.9, 1.3], [0xE6_DCC0, 0x28_303A, 0x3C_7C8C]);
        let y = rng.random_range(4.6..8.5);
        let crate_at = Axes::facing(-2.4 + 1.9 * f64::from(k), y, 0.0, rng.random_range(-0.5..0.5));
        wooden_crate(&mut b, &p, &crate_at, [0.8, 0.6 + 0.25 * f64::from(k), 0.7]);
    }
    for side in [-1.0, 1.0] {
        let y = rng.random_range(6.5..9.2);
        column(&mut b, &p, Point3::new(2.3 * side, y, 0.0), 0.17, 3.2);
        let y = rng.random_range(4.6..6.0);
        barrel(&mut b, &p, Point3::new(side * rng.random_range(1.5..2.2), y, 0.0), 0.33, 0.9);
        let centre = Point3::new(side * rng.random_range(0.4..1.2), rng.random_range(5.0..8.0), 0.32);
        b.add(Shape::Sphere { centre, radius: 0.32 }, p.stone);
    }
    b.finish(Light::day(Vector3::new(-0.5, -0.6, 0.75)))
}

/// Renders a pair. `None` only for a frame without pixels.
pub fn test_pair(frame: Frame, motion: Motion, seed: u64) -> Option<TestPair> {
    let scene = test_scene(seed);
    let cameras = motion.cameras(frame)?;
    let large = frame.width * frame.height > 1_500_000;
    // Twelve megapixels at the finer setting would take many minutes.
    let (supersampling, ambient_rays, relief) = if large { (2, 0, false) } else { (3, 2, true) };
    let picture = |k: usize| {
        let quality =
            Quality { supersampling, ambient_rays, relief, seed: 2 * seed + k as u64, ..Quality::default() };
        let pixels = render_with(&scene, &cameras[k], frame, &quality)?;
        Picture::from_pixels(format!("synthetic {}", k + 1), None, DynamicImage::ImageRgb8(pixels)).ok()
    };
    let matches = true_matches(&scene, &cameras[0], &cameras[1], frame, 60, seed);
    let fundamental = Camera::fundamental(&cameras[0], &cameras[1])?;
    Some(TestPair { pictures: [picture(0)?, picture(1)?], fundamental, cameras, matches })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, symmetric_epipolar_distance};

    const SMALL: Frame = Frame { width: 256, height: 192 };

    #[test]
    fn matches_fit_every_motion_exactly() {
        for motion in Motion::ALL {
            let scene = test_scene(3);
            let [c1, c2] = motion.cameras(SMALL).unwrap();
            let f = Camera::fundamental(&c1, &c2).unwrap();
            let matches = true_matches(&scene, &c1, &c2, SMALL, 60, 1);
            assert!(matches.len() >= 50, "{motion:?}: {}", matches.len());
            for m in &matches {
                assert!(symmetric_epipolar_distance(&f, m) < 1e-6);
                assert!(SMALL.contains(m.point1) && SMALL.contains(m.point2));
            }
        }
    }

    #[test]
    fn matches_look_alike_and_others_do_not() {
        let pair = test_pair(SMALL, Motion::Sideways, 5).unwrap();
        let [a, b] = [&pair.pictures[0].gray, &pair.pictures[1].gray];
        let difference = |p: Point, q: Point| f64::from((a.sample(p) - b.sample(q)).abs());
        let n = pair.matches.len();
        let mean = |shift: usize| {
            let other = |k: usize| pair.matches[(k + shift) % n].point2;
            (0..n).map(|k| difference(pair.matches[k].point1, other(k))).sum::<f64>() / n as f64
        };
        let (right, wrong) = (mean(0), (1..8).map(mean).sum::<f64>() / 7.0);
        // The most textured points are chosen, where half a pixel matters: not near zero, but far below.
        assert!(right < 12.0 && right < 0.4 * wrong, "{right} against {wrong}");
    }

    #[test]
    fn rendering_is_repeatable_on_any_number_of_threads() {
        let frame = Frame::new(48, 36);
        let bytes = || test_pair(frame, Motion::Forward, 9).unwrap().pictures.map(|p| p.pixels.into_bytes());
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(bytes);
        assert!(bytes() == alone);
    }

    #[test]
    fn seeds_change_the_picture() {
        let frame = Frame::new(32, 24);
        let first = |seed| test_pair(frame, Motion::Roll, seed).unwrap().pictures[0].gray.clone();
        assert!(first(1) != first(2));
    }
}
