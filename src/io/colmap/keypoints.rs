//! Keypoints of an image, and the search for those at a place.

use std::collections::{HashMap, HashSet};

use crate::geometry::Point;

/// Largest distance of a point from the keypoint that stands for it, px.
const REACH: f64 = 1.0;

/// Keypoints of an image in pixels of COLMAP. New ones come last.
#[derive(Debug)]
pub(super) struct Keypoints {
    /// Numbers of a keypoint: x and y, then scale and orientation (4), or an affine shape (6).
    pub(super) columns: usize,
    pub(super) values: Vec<f32>,
    /// Number of keypoints before any was appended.
    known: usize,
    /// Numbers of the keypoints in each square of the size of the reach.
    cells: HashMap<[i64; 2], Vec<u32>>,
    /// Keypoints of matches of this pair.
    taken: HashSet<u32>,
}

impl Keypoints {
    pub(super) fn new(columns: usize, values: Vec<f32>) -> Self {
        let known = values.len() / columns;
        let mut keypoints = Self { columns, values, known, cells: HashMap::new(), taken: HashSet::new() };
        for number in 0..known as u32 {
            keypoints.note(number);
        }
        keypoints
    }

    fn len(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Returns the number of new keypoints.
    pub(super) fn appended(&self) -> usize {
        self.len() - self.known
    }

    /// Returns the place of a keypoint.
    pub(super) fn point(&self, number: u32) -> Option<Point> {
        let start = (number as usize).checked_mul(self.columns)?;
        let place = self.values.get(start..start + 2)?;
        Some(Point::new(f64::from(place[0]), f64::from(place[1])))
    }

    /// Returns the nearest keypoint within reach.
    pub(super) fn nearest(&self, point: Point) -> Option<u32> {
        self.nearest_of(point, |_| true)
    }

    /// Returns the nearest keypoint within reach that no match of this pair has.
    pub(super) fn nearest_free(&self, point: Point) -> Option<u32> {
        self.nearest_of(point, |number| !self.is_taken(number))
    }

    fn nearest_of(&self, point: Point, is_wanted: impl Fn(u32) -> bool) -> Option<u32> {
        let [x, y] = cell(point);
        let around =
            (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x.saturating_add(dx), y.saturating_add(dy)]));
        let near = around.filter_map(|cell| self.cells.get(&cell)).flatten();
        let distance = |number: &u32| Some(((self.point(*number)? - point).norm(), *number));
        let found = near.filter(|number| is_wanted(**number)).filter_map(distance);
        let found = found.filter(|(distance, _)| *distance <= REACH);
        found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
    }

    /// Adds a keypoint of scale 1 and returns its number.
    pub(super) fn append(&mut self, point: Point) -> u32 {
        let number = self.len() as u32;
        let shape: &[f32] = match self.columns {
            4 => &[1.0, 0.0],
            6 => &[1.0, 0.0, 0.0, 1.0],
            _ => &[],
        };
        self.values.extend([point.x as f32, point.y as f32]);
        self.values.extend(shape);
        self.note(number);
        number
    }

    /// Returns whether a match of this pair has the keypoint.
    pub(super) fn is_taken(&self, number: u32) -> bool {
        self.taken.contains(&number)
    }

    pub(super) fn take(&mut self, number: u32) {
        self.taken.insert(number);
    }

    fn note(&mut self, number: u32) {
        if let Some(point) = self.point(number) {
            self.cells.entry(cell(point)).or_default().push(number);
        }
    }
}

/// Returns the square of a point.
fn cell(point: Point) -> [i64; 2] {
    [point.x, point.y].map(|v| (v / REACH).floor() as i64)
}
