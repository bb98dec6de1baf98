//! Difference between two fundamental matrices, in pixels.

use super::{Frame, FundamentalMatrix, Point};

/// Returns the mean distance between the epipolar lines of two geometries, px.
///
/// Points are spread over image 1. The midpoint of each point's epipolar line in image 2 under `f`
/// forms a match of `f`; its symmetric epipolar distance under `g` is measured. The mean covers
/// both directions, `f` and `g` exchanged. Each distance counts at most `cap` px.
pub fn epipolar_difference(
    f: &FundamentalMatrix,
    g: &FundamentalMatrix,
    frames: [Frame; 2],
    cap: f64,
) -> f64 {
    0.5 * (one_way(f, g, frames, cap) + one_way(g, f, frames, cap))
}

fn one_way(f: &FundamentalMatrix, g: &FundamentalMatrix, frames: [Frame; 2], cap: f64) -> f64 {
    const GRID: usize = 5;
    let (mut sum, mut count) = (0.0, 0);
    for k in 0..GRID * GRID {
        let at = |i: usize, last: f64| last * (i as f64 + 0.5) / GRID as f64;
        let x1 = Point::new(at(k % GRID, frames[0].right()), at(k / GRID, frames[0].bottom()));
        let Some(segment) = f.line2_from_point1(x1).and_then(|line| frames[1].clip(&line)) else { continue };
        let x2 = segment.midpoint();
        let distance = |line: Option<super::Line>, p| line.map_or(cap, |l| l.distance(p).min(cap));
        sum += 0.5 * (distance(g.line2_from_point1(x1), x2) + distance(g.line1_from_point2(x2), x1));
        count += 1;
    }
    if count == 0 { cap } else { sum / f64::from(count) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::rows;

    #[test]
    fn shifted_rows_differ_by_their_shift() {
        let frames = [Frame::new(200, 100); 2];
        assert!(epipolar_difference(&rows(0.0), &rows(0.0), frames, 50.0) < 1e-9);
        assert!((epipolar_difference(&rows(0.0), &rows(3.0), frames, 50.0) - 3.0).abs() < 0.2);
        assert!(epipolar_difference(&rows(0.0), &rows(80.0), frames, 50.0) > 40.0);
    }
}
