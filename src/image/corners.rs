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
    // A band at a time: over the whole of a large image the products take several times its memory.
    let bands: Vec<usize> = (border..frame.height - border).step_by(BAND).collect();
    let mut peaks: Vec<(f32, usize, usize)> = bands
        .into_par_iter()
        .flat_map_iter(|first| {
            let end = (first + BAND).min(frame.height - border);
            let response = Response::of_rows(plane, first - 2, end + 2);
            let mut found = Vec::new();
            for y in first..end {
                for x in border..frame.width - border {
                    let value = response.at(x, y);
                    if value > 1.0 && is_peak(&response, x, y, value) {
                        found.push((value, x, y));
                    }
                }
            }
            found
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
/// Rows that are looked at at once.
const BAND: usize = 64;

fn is_peak(response: &Response, x: usize, y: usize, value: f32) -> bool {
    // Most pixels are on a slope, which the next ones tell.
    let next = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
    if next.iter().any(|(u, v)| response.at(*u, *v) > value) {
        return false;
    }
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

/// Smaller eigenvalue of the structure tensor on some rows, squared grey levels per px².
struct Response {
    first: usize,
    width: usize,
    values: Vec<f32>,
}

impl Response {
    fn at(&self, x: usize, y: usize) -> f32 {
        self.values[(y - self.first) * self.width + x]
    }

    /// Of the rows from `first` to before `end`, which are at least `RADIUS` rows from the edge.
    fn of_rows(plane: &GrayPlane, first: usize, end: usize) -> Self {
        let Frame { width, height } = plane.frame();
        // Products of the central differences, summed along each row, then down each column.
        let above = first - RADIUS;
        let mut rows = vec![[0f32; 3]; width * (end + RADIUS - above)];
        for (out, y) in rows.chunks_mut(width).zip(above..) {
            if y > 0 && y + 1 < height {
                sum_products(plane, y, out);
            }
        }
        let mut values = vec![0f32; width * (end - first)];
        let area = ((2 * RADIUS + 1) * (2 * RADIUS + 1)) as f32;
        for (k, out) in values.chunks_mut(width).enumerate() {
            for (x, value) in out.iter_mut().enumerate() {
                let mut sum = [0f32; 3];
                for row in k..=k + 2 * RADIUS {
                    for (sum, product) in sum.iter_mut().zip(rows[row * width + x]) {
                        *sum += product;
                    }
                }
                let [a, b, c] = sum;
                let half = 0.5 * (a - c);
                // Squares of grey levels are far from the largest numbers.
                *value = (0.5 * (a + c) - (half * half + b * b).sqrt()) / area;
            }
        }
        Self { first, width, values }
    }
}

/// Sums of the products of the differences over the window along one row.
fn sum_products(plane: &GrayPlane, y: usize, out: &mut [[f32; 3]]) {
    let width = plane.frame().width;
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
    fn the_bands_show_in_nothing() {
        let frame = Frame::new(90, 3 * BAND + 17);
        let plane = GrayPlane::from_fn(frame, |x, y| ((x * x * 31 + y * y * 17 + x * y) % 241) as f32);
        let whole = Response::of_rows(&plane, RADIUS, frame.height - RADIUS);
        let expected: Vec<Point> = find_corners(&plane, 100_000, 4);
        let mut all = Vec::new();
        for y in 4..frame.height - 4 {
            for x in 4..frame.width - 4 {
                let value = whole.at(x, y);
                if value > 1.0 && is_peak(&whole, x, y, value) {
                    all.push((value, x, y));
                }
            }
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.2, a.1).cmp(&(b.2, b.1))));
        let all: Vec<Point> = all.into_iter().map(|(_, x, y)| Point::new(x as f64, y as f64)).collect();
        assert!(all.len() > 100, "{}", all.len());
        assert_eq!(expected, all);
    }

    #[test]
    fn flat_and_tiny_images_have_none() {
        assert!(find_corners(&GrayPlane::from_fn(Frame::new(50, 50), |_, _| 7.0), 10, 4).is_empty());
        assert!(find_corners(&GrayPlane::from_fn(Frame::new(3, 3), |x, _| x as f32), 10, 0).is_empty());
    }
}
