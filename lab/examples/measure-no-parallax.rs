//! Counts the pairs without parallax that are called reliable. The epipoles of such a pair are
//! undetermined, so the verdict should never be reliable.
//!
//! The program makes seeded pairs from any photographs and estimates from two points of the
//! background:
//!
//! - `static`: a static camera while pasted objects move
//! - `darker`: the same, with a darker and noisier second image
//! - `turned`: a camera that only rotates
//! - `captions`: unrelated pictures under the same captions
//! - `halves`: two halves that move apart
//! - `warp`: a smooth warp
//! - `lens`: strong lens distortion
//! - `screen`: a screen whose text is scrolled
//!
//! `cargo run --release -p epiline-lab --example measure-no-parallax -- PAIRS_A_KIND [KIND...] PICTURE PICTURE...`
//!
//! `A..B` instead of a count repeats the pairs of those numbers. Without kinds, all kinds are made.
//! Pairs called reliable are listed by number. Photographs should show different scenes: two
//! photographs of one scene under the same captions have parallax.

use std::path::Path;

use epiline::estimate::{Monitor, Parameters, Verdict, estimate};
use epiline::geometry::{Frame, Point, PointPair, Vector};
use epiline::image::{GrayPlane, Picture};
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Size of the pairs, px.
const FRAME: Frame = Frame { width: 768, height: 576 };

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Static,
    Darker,
    Turned,
    Captions,
    Halves,
    Warp,
    Lens,
    Screen,
}

const KINDS: [Kind; 8] = [
    Kind::Static,
    Kind::Darker,
    Kind::Turned,
    Kind::Captions,
    Kind::Halves,
    Kind::Warp,
    Kind::Lens,
    Kind::Screen,
];

impl Kind {
    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// An object cut out of a picture, with its position in each image.
struct Thing {
    picture: usize,
    from: Point,
    at: [Point; 2],
    half: Vector,
}

impl Thing {
    /// Returns the source position of a pixel of an image, if the object covers it.
    fn source(&self, image: usize, p: Point) -> Option<Point> {
        let d = p - self.at[image];
        (d.x.abs() < self.half.x && d.y.abs() < self.half.y).then(|| self.from + d)
    }
}

struct Made {
    images: [GrayPlane; 2],
    clicks: Vec<PointPair>,
}

fn make(kind: Kind, pictures: &[GrayPlane], rng: &mut Pcg64Mcg) -> Made {
    let (first, second) = (rng.random_range(0..pictures.len()), rng.random_range(0..pictures.len()));
    let count = rng.random_range(5..=30);
    let things: Vec<Thing> = match kind {
        Kind::Static | Kind::Darker | Kind::Turned => {
            (0..count).map(|_| thing(pictures.len(), rng)).collect()
        }
        Kind::Captions => (0..rng.random_range(3..=6)).map(|_| caption(pictures.len(), rng)).collect(),
        Kind::Halves | Kind::Warp | Kind::Lens | Kind::Screen => Vec::new(),
    };
    let turn = turn(rng);
    let (shift, wave, lens) = (
        Vector::new(rng.random_range(4.0..20.0), rng.random_range(-6.0..6.0)),
        (rng.random_range(3.0..10.0), rng.random_range(0.01..0.03), rng.random_range(0.0..6.0)),
        rng.random_range(-0.15..0.15),
    );
    let background = if kind == Kind::Captions { second } else { first };
    // Maps a pixel of image 2 to its source in the background picture.
    let behind = |p: Point| match kind {
        Kind::Turned => mapped(&turn, p),
        Kind::Halves if p.x < 0.5 * FRAME.width as f64 => p + shift,
        Kind::Halves => p - shift,
        Kind::Warp => p + Vector::new((wave.1 * p.y + wave.2).sin(), (wave.1 * p.x).cos()) * wave.0,
        Kind::Lens => {
            let d = (p - FRAME.centre()) / FRAME.longer_side() * 2.0;
            FRAME.centre() + d * (1.0 + lens * d.norm_squared()) * (0.5 * FRAME.longer_side())
        }
        Kind::Screen if is_scrolled(p) => p + Vector::new(0.0, shift.x.round()),
        Kind::Static | Kind::Darker | Kind::Captions | Kind::Screen => p,
    };
    let gain = if kind == Kind::Darker { 0.6 } else { 1.0 };
    let noise = if kind == Kind::Darker { 4.0 } else { 1.0 };
    let mut draw = |image: usize, base: usize, from: &dyn Fn(Point) -> Point| {
        let mut values = Vec::with_capacity(FRAME.width * FRAME.height);
        for k in 0..FRAME.width * FRAME.height {
            let p = Point::new((k % FRAME.width) as f64, (k / FRAME.width) as f64);
            let source = things.iter().rev().find_map(|t| Some((t.picture, t.source(image, p)?)));
            let (picture, at) = source.unwrap_or_else(|| (base, from(p)));
            let value = if kind == Kind::Screen {
                screen(at, base as u64)
            } else {
                f64::from(pictures[picture].sample(wrapped(at, pictures[picture].frame())))
            };
            let noise: f64 = noise * (rng.random_range(-1.0..1.0) + rng.random_range(-1.0..1.0));
            let value = if image == 1 { gain * value } else { value };
            values.push((value + noise).clamp(0.0, 255.0) as f32);
        }
        GrayPlane::new(FRAME, values)
    };
    let images = [draw(0, first, &|p| p), draw(1, background, &behind)];
    // Two points of the background, or of captions, far apart. Image 2 shows each point at its
    // moved position.
    let inverse = |p: Point| {
        let mut q = p;
        for _ in 0..50 {
            q += p - behind(q);
        }
        q
    };
    let mut clicks: Vec<PointPair> = Vec::new();
    while clicks.len() < 2 {
        let p = Point::new(rng.random_range(60.0..700.0), rng.random_range(60.0..500.0));
        let far = clicks.iter().all(|c| (c.point1 - p).norm() > 250.0);
        let q = inverse(p);
        let fits = (behind(q) - p).norm() < 0.1 && FRAME.contains(q);
        if far && fits {
            clicks.push(PointPair { point1: p, point2: q });
        }
    }
    Made { images, clicks }
}

fn thing(pictures: usize, rng: &mut Pcg64Mcg) -> Thing {
    let at = Point::new(rng.random_range(60.0..700.0), rng.random_range(60.0..510.0));
    let moved = Vector::new(rng.random_range(-40.0..40.0), rng.random_range(-40.0..40.0));
    Thing {
        picture: rng.random_range(0..pictures),
        from: Point::new(rng.random_range(80.0..600.0), rng.random_range(80.0..400.0)),
        at: [at, at + moved],
        half: Vector::new(rng.random_range(15.0..50.0), rng.random_range(15.0..50.0)),
    }
}

/// Returns a wide, low object at the same position in both images.
fn caption(pictures: usize, rng: &mut Pcg64Mcg) -> Thing {
    let at = Point::new(rng.random_range(200.0..560.0), rng.random_range(60.0..510.0));
    Thing {
        at: [at, at],
        half: Vector::new(rng.random_range(80.0..180.0), rng.random_range(12.0..40.0)),
        ..thing(pictures, rng)
    }
}

/// Returns the homography from image 2 to image 1 of a camera that rotates by some degrees.
fn turn(rng: &mut Pcg64Mcg) -> Matrix3<f64> {
    let k = Matrix3::new(800.0, 0.0, 383.5, 0.0, 800.0, 287.5, 0.0, 0.0, 1.0);
    let mut angle = |most: f64| rng.random_range(-most..most);
    let rotation = Rotation3::new(Vector3::new(angle(0.08), angle(0.08), angle(0.15)));
    k * rotation.matrix() * k.try_inverse().expect("a camera has a focal length")
}

/// Returns whether a point lies in the scrolled text. The list beside it and the bar above are
/// static.
fn is_scrolled(p: Point) -> bool {
    p.x > 200.0 && p.y > 60.0
}

/// Returns the grey level of a screen of text; `what` selects the letters.
fn screen(p: Point, what: u64) -> f64 {
    let (row, column) = ((p.y / 16.0).floor(), (p.x / 8.0).floor());
    let mix = |a: f64, b: f64, c: u64| {
        let v = (a as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ (b as i64 as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        ((v ^ c.wrapping_mul(0x1656_67b1_9e37_79f9)).wrapping_mul(0xff51_afd7_ed55_8ccd) >> 33) as u32
    };
    // A letter is a pattern of 3 × 4 strokes; about every sixth is a space.
    let letter = mix(row, column, what);
    let (x, y) = (p.x.rem_euclid(8.0), p.y.rem_euclid(16.0));
    let stroke = (x / 2.5) as u32 + 3 * ((y - 3.0).max(0.0) / 2.6) as u32;
    let is_ink = letter % 6 != 0 && x < 7.0 && (3.0..13.0).contains(&y) && (letter >> (stroke % 24)) & 1 == 1;
    let paper = if is_scrolled(p) { 245.0 } else { 215.0 };
    if is_ink { 40.0 } else { paper }
}

fn mapped(h: &Matrix3<f64>, p: Point) -> Point {
    let q = h * p.to_homogeneous();
    Point::new(q.x / q.z, q.y / q.z)
}

/// Reflects a position at the borders, so that pictures continue as their mirror images.
fn wrapped(p: Point, frame: Frame) -> Point {
    let fold = |v: f64, most: f64| {
        let v = v.rem_euclid(2.0 * most.max(1.0));
        if v > most { 2.0 * most - v } else { v }
    };
    Point::new(fold(p.x, frame.right()), fold(p.y, frame.bottom()))
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let wanted = arguments.next().unwrap_or_else(|| "5".to_owned());
    let (first, end) = wanted.split_once("..").unwrap_or(("0", &wanted));
    let pairs = [first, end].map(|n| n.parse().unwrap_or_else(|_| panic!("give how many pairs, or A..B")));
    let pairs: std::ops::Range<u64> = pairs[0]..pairs[1];
    let count = pairs.end - pairs.start;
    let named = |argument: &String| KINDS.into_iter().find(|kind| kind.name() == *argument);
    let (kinds, paths): (Vec<String>, Vec<String>) =
        arguments.partition(|argument| named(argument).is_some());
    let mut kinds: Vec<Kind> = kinds.iter().filter_map(named).collect();
    if kinds.is_empty() {
        kinds.extend(KINDS);
    }
    let pictures: Vec<GrayPlane> = paths
        .iter()
        .map(|path| Picture::open(Path::new(path)).unwrap_or_else(|error| panic!("{path}: {error}")).gray)
        .collect();
    assert!(!pictures.is_empty(), "give some photographs");
    println!(
        "{:<10} {:>6} {:>9} {:>9} {:>11} {:>7}",
        "kind", "pairs", "reliable", "doubtful", "unreliable", "none"
    );
    let mut all = 0;
    let mut trusted = 0;
    for kind in kinds {
        let mut counts = [0; 4];
        let mut numbers = Vec::new();
        for k in pairs.clone() {
            let mut rng = Pcg64Mcg::seed_from_u64(k * 100 + kind as u64);
            let made = make(kind, &pictures, &mut rng);
            let [a, b] = &made.images;
            let found = estimate(a, b, &made.clicks, &Parameters::default(), &Monitor::silent());
            let verdict = found.ok().and_then(|found| found.assessment.trust).map(|trust| trust.verdict);
            if verdict == Some(Verdict::Reliable) {
                numbers.push(k);
            }
            counts[match verdict {
                Some(Verdict::Reliable) => 0,
                Some(Verdict::Doubtful) => 1,
                Some(Verdict::Unreliable | Verdict::DifferentScenes) => 2,
                None => 3,
            }] += 1;
        }
        let [reliable, doubtful, unreliable, none] = counts;
        println!(
            "{:<10} {count:>6} {reliable:>9} {doubtful:>9} {unreliable:>11} {none:>7}  {}",
            kind.name(),
            numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(" ")
        );
        all += count;
        trusted += reliable;
    }
    println!("{trusted} of {all} called reliable");
}
