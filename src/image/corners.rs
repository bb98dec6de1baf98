//! Corner points: local maxima of the smaller eigenvalue of the structure tensor (Shi & Tomasi
//! 1994).

use std::cmp::Ordering;

use multiversion::multiversion;
use rayon::prelude::*;

use super::GrayPlane;
use crate::geometry::{Frame, Point};
use crate::lanes::marked;

/// Finds up to `count` corners at pixel positions, strongest first, at least `border` px from the
/// edge of the image and from pixels that are no picture.
///
/// A cell of an 8×8 grid holds at most four times its share of the corners, so that one busy region
/// cannot take all of them.
pub fn find_corners(plane: &GrayPlane, count: usize, border: usize) -> Vec<Point> {
    let frame = plane.frame();
    let border = border.max(RADIUS + 2);
    if frame.width <= 2 * border || frame.height <= 2 * border {
        return Vec::new();
    }
    // Bands limit the memory: the products of a whole large image take several times its size.
    let bands: Vec<usize> = (border..frame.height - border).step_by(BAND).collect();
    let mut peaks: Vec<(f32, usize, usize)> = bands
        .into_par_iter()
        .flat_map_iter(|first| {
            let end = (first + BAND).min(frame.height - border);
            let response = Response::of_rows(plane, first - 2, end + 2);
            let mut found = Vec::new();
            let mut tops = vec![0u8; frame.width - 2 * border];
            for y in first..end {
                // Most pixels lie on a slope, which the four neighbours already show.
                mark_tops([y - 1, y, y + 1].map(|y| &response.row(y)[border - 1..]), &mut tops);
                for x in marked(&tops).map(|k| border + k) {
                    let value = response.at(x, y);
                    if is_peak(&response, x, y, value) {
                        found.push((value, x, y));
                    }
                }
            }
            found
        })
        .collect();
    // Ties are ordered by position, so that the order does not depend on threads.
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.2, a.1).cmp(&(b.2, b.1))));
    let mut room = [(count / 16).max(4); 64];
    peaks
        .into_iter()
        .filter(|(_, x, y)| plane.is_clear(Point::new(*x as f64, *y as f64), border as f64))
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

/// Half width of the averaging window of the structure tensor.
const RADIUS: usize = 2;
/// Rows per band.
const BAND: usize = 64;

/// Marks pixels above 1 and no lower than their four neighbours. The first mark is for the second
/// pixel of `row`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn mark_tops([above, row, below]: [&[f32]; 3], tops: &mut [u8]) {
    let inner = tops.len();
    let (left, middle, right) = (&row[..inner], &row[1..=inner], &row[2..inner + 2]);
    let (above, below) = (&above[1..=inner], &below[1..=inner]);
    for x in 0..inner {
        let value = middle[x];
        let [l, r, a, b] = [left[x], right[x], above[x], below[x]];
        tops[x] = u8::from(value > 1.0 && value >= l && value >= r && value >= a && value >= b);
    }
}

fn is_peak(response: &Response, x: usize, y: usize, value: f32) -> bool {
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

/// Smaller eigenvalue of the structure tensor for a band of rows, squared grey levels per px².
struct Response {
    first: usize,
    width: usize,
    values: Vec<f32>,
}

impl Response {
    fn at(&self, x: usize, y: usize) -> f32 {
        self.values[(y - self.first) * self.width + x]
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.values[(y - self.first) * self.width..][..self.width]
    }

    /// Computes the response of rows `first..end`, which must be at least `RADIUS` rows from the
    /// edge.
    fn of_rows(plane: &GrayPlane, first: usize, end: usize) -> Self {
        let Frame { width, height } = plane.frame();
        // Products of the central differences are summed along each row, then down each column.
        let above = first - RADIUS;
        let mut products: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0f32; width]);
        let mut sums: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0f32; width * (end + RADIUS - above)]);
        for (k, y) in (above..end + RADIUS).enumerate() {
            if y > 0 && y + 1 < height {
                let own = k * width..(k + 1) * width;
                let sums = sums.each_mut().map(|sums| &mut sums[own.clone()]);
                sum_products([plane.row(y - 1), plane.row(y), plane.row(y + 1)], &mut products, sums);
            }
        }
        let mut values = vec![0f32; width * (end - first)];
        for (k, out) in values.chunks_mut(width).enumerate() {
            let rows = sums.each_ref().map(|sums| &sums[k * width..(k + 2 * RADIUS + 1) * width]);
            smaller_eigenvalues(rows, out);
        }
        Self { first, width, values }
    }
}

/// Sums the products of the differences along one row over the window, from the row and its
/// neighbours.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn sum_products([above, row, below]: [&[f32]; 3], products: &mut [Vec<f32>; 3], sums: [&mut [f32]; 3]) {
    let inner = row.len() - 2;
    let [xx, xy, yy] = products.each_mut().map(|product| &mut product[1..=inner]);
    let (left, right) = (&row[..inner], &row[2..]);
    let (above, below) = (&above[1..=inner], &below[1..=inner]);
    for x in 0..inner {
        let gx = 0.5 * (right[x] - left[x]);
        let gy = 0.5 * (below[x] - above[x]);
        (xx[x], xy[x], yy[x]) = (gx * gx, gx * gy, gy * gy);
    }
    for (product, sums) in products.iter().zip(sums) {
        let inside = product.len() - 2 * RADIUS;
        let shifted: [&[f32]; 2 * RADIUS + 1] = std::array::from_fn(|k| &product[k..k + inside]);
        for (x, sum) in sums[RADIUS..RADIUS + inside].iter_mut().enumerate() {
            *sum = shifted.iter().fold(0.0, |sum, shifted| sum + shifted[x]);
        }
    }
}

/// Computes the smaller eigenvalues of one row from the sums of as many rows as the window is high.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn smaller_eigenvalues(sums: [&[f32]; 3], out: &mut [f32]) {
    let width = out.len();
    let area = ((2 * RADIUS + 1) * (2 * RADIUS + 1)) as f32;
    let rows = |sums| -> [&[f32]; 2 * RADIUS + 1] {
        let all: &[f32] = sums;
        std::array::from_fn(|k| &all[k * width..(k + 1) * width])
    };
    let [xx, xy, yy] = sums.map(rows);
    for (x, value) in out.iter_mut().enumerate() {
        let sum = |rows: &[&[f32]; 2 * RADIUS + 1]| rows.iter().fold(0.0, |sum, row| sum + row[x]);
        let (a, b, c) = (sum(&xx), sum(&xy), sum(&yy));
        let half = 0.5 * (a - c);
        // Squared grey levels are far from overflow.
        *value = (0.5 * (a + c) - (half * half + b * b).sqrt()) / area;
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
