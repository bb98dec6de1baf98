//! Features of a texture that can be drawn exactly at any rotation and scale: a sum of Gaussian
//! blobs.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::geometry::{Frame, angle_between};

struct Blob {
    centre: Point,
    /// Inverse covariance, 1/px².
    shape: Matrix2<f64>,
    reach: f64,
    height: f64,
}

impl Blob {
    fn new(centre: Point, [along, across]: [f64; 2], angle: f64, height: f64) -> Self {
        let turn = Rotation2::new(angle).into_inner();
        let shape =
            turn * Matrix2::from_diagonal(&Vector2::new(along.powi(-2), across.powi(-2))) * turn.transpose();
        Self { centre, shape, reach: 4.5 * along.max(across), height }
    }
}

/// Returns blobs of many sizes, mostly small, over a square of the given side.
fn texture(side: f64, count: usize, seed: u64) -> Vec<Blob> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let centre = Point::new(random.random_range(0.0..side), random.random_range(0.0..side));
            let size = 1.6 * random.random_range(0.0f64..2.0).exp2();
            let ratio = random.random_range(0.5..1.0);
            let height = random.random_range(20.0..60.0) * if random.random_bool(0.5) { 1.0 } else { -1.0 };
            Blob::new(centre, [size, ratio * size], random.random_range(0.0..PI), height)
        })
        .collect()
}

/// A view of the texture: `x' = scale · R(angle) · (x − middle) + middle'`, with `middle'` the
/// frame's centre.
struct View {
    similarity: Matrix2<f64>,
    from: Point,
    to: Point,
}

impl View {
    fn new(side: f64, frame: Frame, angle: f64, scale: f64) -> Self {
        let middle = Point::new(0.5 * side, 0.5 * side);
        let to = Point::new(0.5 * (frame.width - 1) as f64, 0.5 * (frame.height - 1) as f64);
        Self { similarity: Rotation2::new(angle).into_inner() * scale, from: middle, to }
    }

    fn place(&self, p: Point) -> Point {
        self.to + self.similarity * (p - self.from)
    }

    fn draw(&self, frame: Frame, blobs: &[Blob]) -> GrayPlane {
        let back = self.similarity.try_inverse().unwrap();
        let scale = self.similarity.determinant().sqrt();
        let mut values = vec![128f32; frame.width * frame.height];
        for blob in blobs {
            let (middle, reach) = (self.place(blob.centre), blob.reach * scale);
            let range = |c: f64, end: usize| {
                ((c - reach).max(0.0) as usize).min(end)..((c + reach).max(0.0) as usize + 1).min(end)
            };
            for y in range(middle.y, frame.height) {
                for x in range(middle.x, frame.width) {
                    let offset = back * (Point::new(x as f64, y as f64) - middle);
                    let value = blob.height * (-0.5 * offset.dot(&(blob.shape * offset))).exp();
                    values[y * frame.width + x] += value as f32;
                }
            }
        }
        GrayPlane::new(frame, values)
    }
}

#[test]
fn a_blob_is_found_with_its_position_scale_and_orientation() {
    let frame = Frame::new(161, 141);
    for (k, sigma) in [2.0, 3.3, 5.0, 8.0, 12.0].into_iter().enumerate() {
        let centre = Point::new(79.3 + 0.13 * k as f64, 70.6);
        let angle = 0.3 + 1.1 * k as f64;
        let (sin, cos) = angle.sin_cos();
        // A ramp gives the blob an orientation. No difference of Gaussians responds to a ramp.
        let blob = Blob::new(centre, [sigma, sigma], 0.0, -60.0);
        let plain = View::new(0.0, Frame::new(1, 1), 0.0, 1.0).draw(frame, &[blob]);
        let plane = GrayPlane::from_fn(frame, |x, y| {
            plain.at(x, y) + ((cos * x as f64 + sin * y as f64) * 12.0 / sigma) as f32
        });
        let found = find_features(&plane, &FeatureParameters::default());
        let nearest = found
            .features()
            .iter()
            .filter(|f| (f.position - centre).norm() < sigma)
            .max_by(|a, b| a.response.total_cmp(&b.response))
            .unwrap();
        assert!((nearest.position - centre).norm() < 0.02 * sigma + 0.02, "{sigma} {nearest:?}");
        // The difference of Gaussians σ and kσ is largest for a blob of √k σ.
        let size = nearest.scale * (0.5 / INTERVALS as f64).exp2();
        assert!((size / sigma - 1.0).abs() < 0.05, "{sigma} {nearest:?}");
        assert!(angle_between(nearest.orientation, angle) < 2f64.to_radians(), "{angle} {nearest:?}");
    }
}

/// Returns the repeatability of the features of one view in the other, and the precision of the
/// matches.
fn repeated(angle: f64, scale: f64) -> [f64; 2] {
    let side = 300.0;
    let blobs = texture(side, 1200, 11);
    let (frame1, frame2) =
        (Frame::new(240, 230), Frame::new((300.0 * scale) as usize, (295.0 * scale) as usize));
    let (view1, view2) = (View::new(side, frame1, 0.0, 1.0), View::new(side, frame2, angle, scale));
    let [set1, set2] = [(&view1, frame1), (&view2, frame2)]
        .map(|(v, frame)| find_features(&v.draw(frame, &blobs), &FeatureParameters::default()));
    let onto2 = |p: Point| view2.place(view1.from + (p - view1.to));
    // Features away from the border, well above the contrast threshold, and large enough to be seen
    // at half the size.
    let wanted: Vec<&Feature> = set1
        .features()
        .iter()
        .filter(|f| {
            let inside = |f: Feature, frame: Frame| {
                let p = f.position;
                let room = [p.x, p.y, frame.right() - p.x, frame.bottom() - p.y];
                room.iter().all(|d| *d > 10.0 * f.scale)
            };
            let there = Feature { position: onto2(f.position), scale: scale * f.scale, ..**f };
            inside(**f, frame1) && inside(there, frame2) && there.scale > 1.2 && f.response > 5.0
        })
        .collect();
    assert!(wanted.len() > 60, "{} features", wanted.len());
    let again = |f: &Feature, g: &Feature| {
        (g.position - onto2(f.position)).norm() < 0.3 * g.scale
            && (g.scale / (scale * f.scale)).ln().abs() < 0.15
            && angle_between(g.orientation, f.orientation + angle) < 6f64.to_radians()
    };
    let count = wanted.iter().filter(|f| set2.features().iter().any(|g| again(f, g))).count();
    let matches = match_features(&set1, &set2);
    let unique: Vec<_> = matches.iter().filter(|m| m.ratio < 0.8).collect();
    let right = unique
        .iter()
        .filter(|m| (m.pair.point2 - onto2(m.pair.point1)).norm() < 0.5 * set2.features()[m.feature2].scale)
        .count();
    [count as f64 / wanted.len() as f64, right as f64 / unique.len() as f64]
}

#[test]
fn features_repeat_at_any_rotation_and_at_twice_or_half_the_size() {
    for (degrees, scale) in [
        (0.0, 2.0),
        (30.0, 1.0),
        (77.0, 1.3),
        (90.0, 0.5),
        (145.0, 1.0),
        (180.0, 2.0),
        (263.0, 0.7),
        (331.0, 2.0),
    ] {
        let [again, right] = repeated(f64::to_radians(degrees), scale);
        println!("{degrees}°, scale {scale}: {again:.2} found again, {right:.2} of the matches right");
        // Neighbouring extrema merge or vanish; Lowe's repeatability is about 80 %.
        assert!(again > 0.75, "{degrees}° {scale} {again}");
        assert!(right > 0.95, "{degrees}° {scale} {right}");
    }
}

#[test]
fn the_strongest_features_are_kept_on_any_number_of_threads() {
    let blobs = texture(260.0, 1000, 5);
    let frame = Frame::new(240, 230);
    let plane = View::new(260.0, frame, 0.0, 1.0).draw(frame, &blobs);
    let found = |most: usize, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| find_features(&plane, &FeatureParameters { most, ..FeatureParameters::default() }))
    };
    let all = found(usize::MAX, 3);
    assert!(all.len() > 150);
    assert!(all.features().is_sorted_by(|a, b| a.response >= b.response));
    let few = found(100, 1);
    assert_eq!(few.features(), &all.features()[..100]);
    assert_eq!(few.descriptors(), &all.descriptors()[..100]);
}

#[test]
fn flat_and_tiny_pictures_have_no_features() {
    for (width, height) in [(1, 1), (15, 200), (16, 16), (200, 150)] {
        let plane = GrayPlane::from_fn(Frame::new(width, height), |_, _| 77.0);
        assert!(find_features(&plane, &FeatureParameters::default()).is_empty());
    }
}

/// Matches a texture with a compressed copy. Returns the numbers of correct and of distinctive
/// matches, and the error of the correct matches' affine maps (median of the largest entry).
fn compressed(angle: f64, by: f64, find: impl Fn(&GrayPlane) -> FeatureSet) -> (usize, usize, f64) {
    let (side, frame) = (300.0, Frame::new(240, 230));
    let blobs = texture(side, 1200, 7);
    let view1 = View::new(side, frame, 0.0, 1.0);
    let turn = Rotation2::new(angle).into_inner();
    let affine = turn * Matrix2::from_diagonal(&Vector2::new(1.0 / by, 1.0)) * turn.transpose();
    let view2 = View { similarity: affine, ..View::new(side, frame, 0.0, 1.0) };
    let sets = [&view1, &view2].map(|view| find(&view.draw(frame, &blobs)));
    let mut matches = match_features(&sets[0], &sets[1]);
    without_repeats(&mut matches, sets.each_ref());
    matches.retain(|m| m.ratio < 0.8);
    let onto2 = |p: Point| view2.place(view1.from + (p - view1.to));
    let is_right = |m: &&FeatureMatch| (m.pair.point2 - onto2(m.pair.point1)).norm() < 1.5;
    let mut off: Vec<f64> = matches
        .iter()
        .filter(is_right)
        .map(|m| {
            let [a, b] = [&sets[0].features()[m.feature1], &sets[1].features()[m.feature2]];
            (a.affine_to(b) - affine).amax()
        })
        .collect();
    off.sort_by(f64::total_cmp);
    (off.len(), matches.len(), off.get(off.len() / 2).copied().unwrap_or(f64::INFINITY))
}

#[test]
fn features_of_slanted_views_match_with_the_right_affine_maps() {
    let parameters = FeatureParameters::default();
    let frontal = |plane: &GrayPlane| find_features(plane, &parameters);
    let all = |plane: &GrayPlane| {
        let mut set = frontal(plane);
        set.append(find_slanted_features(plane, &parameters));
        set
    };
    for (degrees, by) in [(0.0, 3.0), (45.0, 2.5), (70.0, 2.5), (135.0, 3.0)] {
        let angle = f64::to_radians(degrees);
        let (before, _, _) = compressed(angle, by, frontal);
        let (right, count, off) = compressed(angle, by, all);
        println!("{degrees}°, by {by}: {before} before, {right} of {count} right, maps off by {off:.2}");
        assert!(right > 3 * before.max(10), "{degrees}° {right} {before}");
        assert!(10 * right > 9 * count, "{degrees}° {right} of {count}");
        // The view is compressed to half, the texture to a third, so the map is off by 1/6. The map
        // of a frontal feature is off by 2/3.
        assert!(off < 0.3, "{degrees}° {off}");
    }
}

#[test]
fn slanted_features_lie_in_the_picture_on_any_number_of_threads() {
    let blobs = texture(260.0, 1000, 5);
    let frame = Frame::new(240, 131);
    let plane = View::new(260.0, frame, 0.0, 1.0).draw(frame, &blobs);
    let found = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| find_slanted_features(&plane, &FeatureParameters::default()))
    };
    let set = found(3);
    assert!(set.len() > 200 && set.features().iter().all(|f| frame.contains(f.position)));
    assert!(set.features().iter().all(|f| (f.shape.determinant() - 1.0).abs() < 1e-9));
    assert_eq!((set.features(), set.descriptors()), (found(1).features(), found(1).descriptors()));
    for (width, height) in [(1, 1), (16, 16), (90, 40)] {
        let plane = GrayPlane::from_fn(Frame::new(width, height), |_, _| 77.0);
        assert!(find_slanted_features(&plane, &FeatureParameters::default()).is_empty());
    }
}
