//! Matches worth clicking: corners one can find again by eye, with their exact partners.

use super::matches::{texture, true_match};
use super::ray::Eye;
use super::scene::Scene;
use epiline::geometry::{Camera, Frame, FundamentalMatrix, Point, PointPair, Vector};
use epiline::image::GrayPlane;

/// Separation of two shown matches from each other's epipolar lines, as a share of the longer side.
pub const SEPARATION: f64 = 0.12;

/// Matches at corners, and three of them to show the program with.
#[derive(Debug, Clone)]
pub struct Landmarks {
    /// Best first.
    pub matches: Vec<PointPair>,
    /// Two well separated ones.
    pub show_me: [PointPair; 2],
    /// A third, separated from both.
    pub third: PointPair,
}

/// Smaller eigenvalue of the structure tensor over 9×9 px (Shi & Tomasi 1994), grey levels² per px².
fn cornerness(plane: &GrayPlane, x: usize, y: usize) -> f64 {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for j in y - 4..=y + 4 {
        for i in x - 4..=x + 4 {
            let gx = f64::from(plane.at(i + 1, j) - plane.at(i - 1, j)) / 2.0;
            let gy = f64::from(plane.at(i, j + 1) - plane.at(i, j - 1)) / 2.0;
            xx += gx * gx;
            xy += gx * gy;
            yy += gy * gy;
        }
    }
    let (mean, half) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
    (mean - half) / 81.0
}

/// Correlation of the 11×11 px around the two points of a pair, −1 ..= 1.
fn likeness(planes: [&GrayPlane; 2], pair: &PointPair) -> f64 {
    let window = |plane: &GrayPlane, p: Point| -> Vec<f64> {
        (0..121)
            .map(|k| f64::from(plane.sample(p + Vector::new(f64::from(k % 11 - 5), f64::from(k / 11 - 5)))))
            .collect()
    };
    let centred = |v: Vec<f64>| {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        v.into_iter().map(|x| x - mean).collect::<Vec<_>>()
    };
    let (a, b) = (centred(window(planes[0], pair.point1)), centred(window(planes[1], pair.point2)));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt().max(1e-9)
}

/// The smallest distance of a point of either pair to the epipolar line of the other, over both images, px.
pub fn separation(f: &FundamentalMatrix, a: &PointPair, b: &PointPair) -> f64 {
    let one_way = |from: &PointPair, to: &PointPair| {
        let line1 = f.line1_from_point2(from.point2).map_or(0.0, |l| l.distance(to.point1));
        let line2 = f.line2_from_point1(from.point1).map_or(0.0, |l| l.distance(to.point2));
        line1.min(line2)
    };
    one_way(a, b).min(one_way(b, a))
}

/// The strongest corner in each cell of a 10×8 grid that has an exact match which also looks alike.
/// `None` when no three of them are separated. `first` are places of the pairs to show, or `None` to choose them.
pub fn landmarks(
    scene: &Scene,
    cameras: &[Camera; 2],
    frame: Frame,
    planes: [&GrayPlane; 2],
    first: Option<[Point; 2]>,
) -> Option<Landmarks> {
    let f = Camera::fundamental(&cameras[0], &cameras[1])?;
    let eye = Eye::new(&cameras[0])?;
    let (columns, rows) = (10, 8);
    let mut ranked = Vec::new();
    for cell in 0..columns * rows {
        let range = |k: usize, n: usize, size: usize| {
            (k * size / n).max(8)..((k + 1) * size / n).min(size.saturating_sub(8))
        };
        let mut corners: Vec<(f64, usize, usize)> = range(cell / columns, rows, frame.height)
            .flat_map(|y| range(cell % columns, columns, frame.width).map(move |x| (x, y)))
            .map(|(x, y)| (cornerness(planes[0], x, y), x, y))
            .collect();
        corners.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = corners.into_iter().take(200).find_map(|(strength, x, y)| {
            let point1 = Point::new(x as f64, y as f64);
            texture(scene, &eye, point1)?;
            let pair = true_match(scene, &cameras[0], &cameras[1], frame, point1)?;
            (strength > 20.0 && likeness(planes, &pair) > 0.6).then_some((strength, pair))
        });
        ranked.extend(best);
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let matches: Vec<PointPair> = ranked.into_iter().map(|(_, pair)| pair).collect();

    // Shown points stand well inside both pictures and on something larger than a leaf.
    let least = SEPARATION * frame.longer_side() * 1.25;
    let border = 0.1 * frame.shorter_side();
    let inside = |p: Point| {
        p.x > border && p.y > border && p.x < frame.right() - border && p.y < frame.bottom() - border
    };
    let sturdy = |m: &PointPair| {
        scene.intersect(&eye.ray(m.point1)).is_some_and(|hit| {
            let bounds = scene.object(hit.object).shape.bounds();
            (bounds.high - bounds.low).max() > 0.4
        })
    };
    let central: Vec<_> =
        matches.iter().filter(|m| inside(m.point1) && inside(m.point2) && sturdy(m)).collect();
    let apart = |a: &PointPair, b: &PointPair| separation(&f, a, b) > least;
    if let Some(first) = first {
        let [p, q] = first.map(|place| true_match(scene, &cameras[0], &cameras[1], frame, place));
        let show_me = [p?, q?];
        let third = **central.iter().find(|m| show_me.iter().all(|shown| apart(shown, m)))?;
        return Some(Landmarks { matches, show_me, third });
    }
    for (j, q) in central.iter().enumerate() {
        for p in &central[..j] {
            if !apart(p, q) {
                continue;
            }
            if let Some(third) = central.iter().find(|m| apart(p, m) && apart(q, m)) {
                let (show_me, third) = ([**p, **q], **third);
                return Some(Landmarks { matches, show_me, third });
            }
        }
    }
    None
}
