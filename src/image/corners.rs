//! Corner points: where the smaller eigenvalue of the structure tensor has a local maximum (Shi & Tomasi 1994).

use std::cmp::Ordering;

use rayon::prelude::*;

use super::GrayPlane;
use crate::geometry::{Frame, Point};

/// Corners at pixel positions, strongest first, at most `count`, spread over the image: a cell of an 8×8 grid
/// gives at most four times its share, so that one busy region does not take them all. Corners keep `border`
/// px from the edge of the image.
pub fn find_corners(plane: &GrayPlane, count: usize, border: usize) -> Vec<Point> {
    let frame = plane.frame();
    let border = border.max(RADIUS + 2);
    if frame.width <= 2 * border || frame.height <= 2 * border {
        return Vec::new();
    }
    let response = smaller_eigenvalue(plane);
    let mut peaks: Vec<(f32, usize, usize)> = (border..frame.height - border)
        .into_par_iter()
        .flat_map_iter(|y| {
            let response = &response;
            (border..frame.width - border).filter_map(move |x| {
                let value = response.at(x, y);
                (value > 1.0 && is_peak(response, x, y, value)).then_some((value, x, y))
            })
        })
        .collect();
    // Position decides between equals, so that the order does not depend on threads.
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.2, a.1).cmp(&(b.2, b.1))));
    let mut room = [(count / 16).max(4); 64];
    peaks
        .into_iter()
        .filter(|(_, x, y)| {
            let cell = &mut room[y * 8 / frame.height * 8 + x * 8 / frame.width];
            let free = *cell > 0;
            *cell -= usize::from(free);
            free
        })
        .take(count)
        .map(|(_, x, y)| Point::new(x as f64, y as f64))
        .collect()
}

/// Half width of the window the structure tensor is averaged over.
const RADIUS: usize = 2;

fn is_peak(response: &GrayPlane, x: usize, y: usize, value: f32) -> bool {
    (y - 2..=y + 2).all(|v| {
        (x - 2..=x + 2).all(|u| {
            // On a plateau the first pixel in reading order wins.
            let other = response.at(u, v);
            match other.total_cmp(&value) {
                Ordering::Less => true,
                Ordering::Equal => (v, u) >= (y, x),
                Ordering::Greater => false,
            }
        })
    })
}

/// Smaller eigenvalue of the structure tensor, squared grey levels per px².
fn smaller_eigenvalue(plane: &GrayPlane) -> GrayPlane {
    let Frame { width, height } = plane.frame();
    // Products of the central differences, summed along each row, then down each column.
    let mut rows = vec![[0f32; 3]; width * height];
    rows.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        if y == 0 || y + 1 == height {
            return;
        }
        let (above, row, below) = (plane.row(y - 1), plane.row(y), plane.row(y + 1));
        let products: Vec<[f32; 3]> = (0..width)
            .map(|x| {
                if x == 0 || x + 1 == width {
                    return [0.0; 3];
                }
                let gx = 0.5 * (row[x + 1] - row[x - 1]);
                let gy = 0.5 * (below[x] - above[x]);
                [gx * gx, gx * gy, gy * gy]
            })
            .collect();
        for x in RADIUS..width - RADIUS {
            for product in &products[x - RADIUS..=x + RADIUS] {
                for k in 0..3 {
                    out[x][k] += product[k];
                }
            }
        }
    });
    let mut values = vec![0f32; width * height];
    let area = ((2 * RADIUS + 1) * (2 * RADIUS + 1)) as f32;
    values.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        if y < RADIUS || y + RADIUS >= height {
            return;
        }
        for (x, value) in out.iter_mut().enumerate() {
            let mut sum = [0f32; 3];
            for v in y - RADIUS..=y + RADIUS {
                for k in 0..3 {
                    sum[k] += rows[v * width + x][k];
                }
            }
            let [a, b, c] = sum;
            let half = 0.5 * (a - c);
            *value = (0.5 * (a + c) - half.hypot(b)) / area;
        }
    });
    GrayPlane::new(plane.frame(), values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_corners_of_a_square_and_nothing_on_its_edges() {
        let inside = |x: usize, y: usize| (20..44).contains(&x) && (16..40).contains(&y);
        let plane = GrayPlane::from_fn(Frame::new(64, 56), |x, y| if inside(x, y) { 200.0 } else { 40.0 });
        let corners = find_corners(&plane, 50, 4);
        assert_eq!(corners.len(), 4, "{corners:?}");
        for expected in [(20.0, 16.0), (43.0, 16.0), (20.0, 39.0), (43.0, 39.0)] {
            let near = corners.iter().any(|c| (c - Point::new(expected.0, expected.1)).norm() < 2.5);
            assert!(near, "{expected:?} in {corners:?}");
        }
    }

    #[test]
    fn flat_and_tiny_images_have_none() {
        assert!(find_corners(&GrayPlane::from_fn(Frame::new(50, 50), |_, _| 7.0), 10, 4).is_empty());
        assert!(find_corners(&GrayPlane::from_fn(Frame::new(3, 3), |x, _| x as f32), 10, 0).is_empty());
    }
}
