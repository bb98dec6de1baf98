//! Agreement of the barcodes of corresponding epipolar lines over both images.

use crate::geometry::{AnchoredLine, Frame, FundamentalMatrix, Line, Point};
use crate::motion::{Barcode, Silhouettes};

/// Number of lines of each image, evenly spread along its border. Neighbouring lines hardly differ,
/// so more lines would take only time.
const LINES: usize = 128;
/// Number of shifts in time at which chance agreement is measured. By chance, an agreement exceeds
/// the largest of 24 in one case of 25.
const SHIFTS: usize = 24;
/// Smallest and largest of these shifts, as shares of the sequence. After a smaller shift, moving
/// objects have hardly moved on.
const SHIFTED: [f64; 2] = [0.2, 0.8];

/// Largest counted correlation of neighbours. It keeps the number of independent lines above 0.
const MOST_ALIKE: f64 = 0.999;

/// Barcodes of corresponding lines of a geometry, in the order of the lines.
pub(super) struct Pencils {
    pairs: Vec<[Barcode; 2]>,
}

impl Pencils {
    /// Returns the barcodes of a geometry in full-size pixels. `None` if it has no lines.
    pub(super) fn new(silhouettes: [&Silhouettes; 2], f: &FundamentalMatrix) -> Option<Self> {
        let [frame1, frame2] = silhouettes.map(Silhouettes::full_size);
        let scales = [0, 1].map(|image: usize| {
            silhouettes[image].full_size().width as f64 / silhouettes[image].size().width as f64
        });
        let barcode = |image: usize, line: &Line, frame: Frame| {
            let anchor = line.foot(frame.centre());
            silhouettes[image].barcode(&AnchoredLine { anchor, direction: line.direction() }, scales[image])
        };
        let (e1, e2) = (f.epipole1(), f.epipole2());
        let through1 = |at: Point| Line::joining(&e1, &at.to_homogeneous()).zip(f.line2_from_point1(at));
        let through2 = |at: Point| f.line1_from_point2(at).zip(Line::joining(&e2, &at.to_homogeneous()));
        let lines = border(frame1).filter_map(through1).chain(border(frame2).filter_map(through2));
        let pairs: Vec<[Barcode; 2]> =
            lines.map(|(line1, line2)| [barcode(0, &line1, frame1), barcode(1, &line2, frame2)]).collect();
        (!pairs.is_empty()).then_some(Self { pairs })
    }

    /// Returns one minus the agreement of all bits. The agreement is twice the covariance over the
    /// sum of both variances. A correlation of the lines with motion in both images would reward
    /// moving lines to places without motion.
    pub(super) fn cost(&self) -> f64 {
        1.0 - agreement(self.pairs.iter().map(|[a, b]| (a, b)))
    }

    /// Returns the best agreement of the same lines with the second sequence shifted in time.
    pub(super) fn correlation_by_chance(&self) -> f64 {
        let frames = self.pairs[0][0].len() as f64;
        let shifted = |k: usize| {
            let share = SHIFTED[0] + (SHIFTED[1] - SHIFTED[0]) * k as f64 / (SHIFTS - 1) as f64;
            let by = (share * frames) as usize;
            let turned: Vec<Barcode> = self.pairs.iter().map(|[_, b]| b.turned(by)).collect();
            agreement(self.pairs.iter().zip(&turned).map(|([a, _], b)| (a, b)))
        };
        (0..SHIFTS).map(shifted).fold(0.0, f64::max)
    }

    /// Returns the number of independent lines: `n (1 − ρ) / (1 + ρ)` for `n` lines whose
    /// neighbours have the correlation ρ.
    pub(super) fn independent_lines(&self) -> f64 {
        let telling =
            |image: usize| self.pairs.iter().filter(move |pair| pair[image].variance() > 0.0).count();
        let neighbours = self.pairs.windows(2).filter_map(|two| two[0][0].correlation(&two[1][0]));
        let (sum, count) = neighbours.fold((0.0, 0usize), |(sum, count), c| (sum + c, count + 1));
        let rho = (sum / count.max(1) as f64).clamp(0.0, MOST_ALIKE);
        // Each line crosses the border at two places.
        let lines = 0.25 * (telling(0) + telling(1)) as f64;
        lines * (1.0 - rho) / (1.0 + rho)
    }

    /// Returns the number of events: how often an object begins or ceases to cross an independent
    /// line.
    pub(super) fn events(&self) -> f64 {
        let changes: usize = self.pairs.iter().map(|[a, b]| a.changes() + b.changes()).sum();
        changes as f64 / (2 * self.pairs.len()) as f64 * self.independent_lines()
    }
}

fn agreement<'a>(pairs: impl Iterator<Item = (&'a Barcode, &'a Barcode)>) -> f64 {
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (a, b) in pairs {
        let (va, vb) = (a.variance(), b.variance());
        variance += 0.5 * (va + vb);
        covariance += a.correlation(b).unwrap_or(0.0) * (va * vb).sqrt();
    }
    if variance > 0.0 { covariance / variance } else { 0.0 }
}

/// Returns places evenly spread along the border of an image, in order.
fn border(frame: Frame) -> impl Iterator<Item = Point> {
    let corners = frame.corners();
    let lengths = [0, 1, 2, 3].map(|k: usize| (corners[(k + 1) % 4] - corners[k]).norm());
    let around: f64 = lengths.iter().sum();
    (0..LINES).map(move |k| {
        let mut along = around * (k as f64 + 0.5) / LINES as f64;
        let mut side = 0;
        while side < 3 && along > lengths[side] {
            along -= lengths[side];
            side += 1;
        }
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        from + (to - from) * (along / lengths[side].max(1e-9))
    })
}

#[cfg(test)]
mod tests {
    use super::super::exact::{BAND, FRAME, bands, by_itself};
    use super::*;
    use crate::estimate::exact::rows;

    fn pencils(first: &Silhouettes, second: &Silhouettes, shift: f64) -> Pencils {
        Pencils::new([first, second], &rows(shift)).unwrap()
    }

    #[test]
    fn the_same_barcodes_cost_nothing_and_others_about_one() {
        let seen = bands(300, by_itself);
        assert!(pencils(&seen, &seen, 0.0).cost().abs() < 1e-12);
        let others = pencils(&seen, &seen, BAND as f64).cost();
        assert!((0.8..1.1).contains(&others), "{others}");
        // The second recording has half the motion.
        let rarely = bands(300, |band, time| by_itself(band, time) && time % 2 == 0);
        let halved = pencils(&seen, &rarely, 0.0).cost();
        assert!((0.2..0.5).contains(&halved), "{halved}");
    }

    #[test]
    fn periodic_motion_agrees_by_chance() {
        let seen = bands(300, by_itself);
        assert!(pencils(&seen, &seen, 0.0).correlation_by_chance() < 0.2);
        // One period is as long as two steps between shifts.
        let again = bands(300, |band, time| by_itself(band, time % 10));
        assert!(pencils(&again, &again, 0.0).correlation_by_chance() > 0.99);
    }

    #[test]
    fn equal_lines_count_as_less_than_one_independent_line() {
        let lines = |of: fn(usize, usize) -> bool| {
            let seen = bands(300, of);
            pencils(&seen, &seen, 0.0).independent_lines()
        };
        let (alike, apart) = (lines(|_, time| by_itself(0, time)), lines(by_itself));
        assert!(alike < 0.1, "{alike}");
        // Each of the twelve bands meets the border twice.
        assert!((3.0..24.0).contains(&apart), "{apart}");
        assert!(lines(|band, time| band == 5 && by_itself(band, time)) < apart / 2.0, "most tell nothing");
    }

    #[test]
    fn events_are_the_changes_of_independent_lines() {
        // On for two frames, off for three: two changes every five frames, except the last one.
        let seen = bands(100, |_, time| time % 5 < 2);
        let pencils = pencils(&seen, &seen, 0.0);
        let changes = pencils.events() / pencils.independent_lines();
        assert!((changes - 39.0).abs() < 1e-9, "{changes}");
    }

    #[test]
    fn places_go_round_the_border_in_even_steps() {
        let places: Vec<Point> = border(FRAME).collect();
        let step = 2.0 * (FRAME.right() + FRAME.bottom()) / LINES as f64;
        assert_eq!(places.len(), LINES);
        assert_eq!(places[0], Point::new(0.5 * step, 0.0));
        for two in places.windows(2) {
            let by = two[1] - two[0];
            assert!((by.x.abs() + by.y.abs() - step).abs() < 1e-9, "{two:?}");
        }
        let is_outer = |v: f64, last: f64| v.abs() < 1e-9 || (v - last).abs() < 1e-9;
        assert!(places.iter().all(|p| is_outer(p.x, FRAME.right()) || is_outer(p.y, FRAME.bottom())));
    }
}
