//! Construction of a hypothesis from lines, in full-size pixels, as the figures of the paper show
//! it.
//!
//! A line pair through each click gives the epipoles. The bisector of the two lines of image 1,
//! with its best match in image 2, gives the map H from the pencil of image 1 to the pencil of
//! image 2. The bisector in image 2, with its best match in image 1, gives the map G back. For the
//! right epipoles, `GH` is the identity.

use nalgebra::Vector2;

use super::pencil_pair::{PencilAngles, PencilPair};
use crate::geometry::{AnchoredLine, Frame, FundamentalMatrix, Line, LinePair, PencilMap, PointPair};

/// Lines from which a hypothesis is built.
#[derive(Debug, Clone)]
pub struct Construction {
    pencils: PencilPair,
    turn: f64,
    /// κ of G, if G was searched.
    kappa_backward: Option<f64>,
}

/// A line of image 1 mapped to image 2 and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundTrip {
    /// The line l in image 1.
    pub line1: Line,
    /// The line H l in image 2.
    pub line2: Line,
    /// The line GH l in image 1. It equals l if both maps agree.
    pub back1: Line,
}

impl Construction {
    /// Returns the construction from the directions at the clicks, full-size pixels. The directions
    /// contain κ of H.
    pub(crate) fn new(
        angles: &PencilAngles,
        clicks: [PointPair; 2],
        kappa_backward: Option<f64>,
    ) -> Option<Self> {
        let pencils = PencilPair::new(angles, clicks)?;
        Some(Self { pencils, turn: angles.p[1] - angles.p[0], kappa_backward })
    }

    /// Returns the construction that corresponds to a matrix: its epipolar lines at the clicks.
    /// `turn` is the approximate rotation of image 2 against image 1, radians, which tells the
    /// sense of the lines. Returns `None` where the lines degenerate.
    pub fn of(f: &FundamentalMatrix, clicks: [PointPair; 2], turn: f64) -> Option<Self> {
        let angles = PencilAngles::of(f, &clicks, turn)?;
        Self::new(&angles, clicks, Some(angles.kappa))
    }

    /// Returns the matrix of the line pairs and H.
    pub(crate) fn fundamental(&self) -> Option<FundamentalMatrix> {
        self.pencils.fundamental()
    }

    /// Returns κ of the paper's H: bisector chosen in image 1, matching line found in image 2.
    pub fn kappa_line2_from_line1(&self) -> f64 {
        self.pencils.map.kappa()
    }

    /// Returns κ of the paper's G: bisector chosen in image 2, matching line found in image 1.
    /// Returns `None` when G was not searched.
    pub fn kappa_line1_from_line2(&self) -> Option<f64> {
        self.kappa_backward
    }

    /// Returns the lines through the first click.
    pub fn p(&self) -> &LinePair {
        self.pencils.map.p()
    }

    /// Returns the lines through the second click.
    pub fn q(&self) -> &LinePair {
        self.pencils.map.q()
    }

    /// Returns the rotation of the line of image 2 through the first click against the line of
    /// image 1, radians.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// Returns the bisector of image 1 and the matching line of image 2, which give H.
    pub fn forward(&self) -> Option<LinePair> {
        let map = self.pencils.map;
        let bisector = PencilMap::bisector1();
        Some(LinePair { line1: map.line1(bisector)?, line2: map.line2_from_line1(bisector)? })
    }

    /// Returns the bisector of image 2 and the matching line of image 1, which give G. Returns
    /// `None` when G was not searched.
    pub fn backward(&self) -> Option<LinePair> {
        let map = self.pencils.map.with_kappa(self.kappa_backward?);
        let bisector = PencilMap::bisector1();
        Some(LinePair { line1: map.line1_from_line2(bisector)?, line2: map.line2(bisector)? })
    }

    /// Returns about `count` lines spread evenly over image 1, mapped to image 2 by H and back by
    /// G. Returns none when G is not known.
    pub fn round_trips(&self, frame1: Frame, count: usize) -> Vec<RoundTrip> {
        let Some(kappa_backward) = self.kappa_backward else { return Vec::new() };
        let map = self.pencils.map;
        let ratio = map.kappa() / kappa_backward;
        let coordinates = self.pencils.coordinates_over_image1(frame1, count);
        let round_trip = |c: Vector2<f64>| {
            Some(RoundTrip {
                line1: map.line1(c)?,
                line2: map.line2_from_line1(c)?,
                back1: map.line1(Vector2::new(c.x, c.y * ratio))?,
            })
        };
        coordinates.into_iter().filter_map(round_trip).collect()
    }

    /// Returns two corresponding lines of this geometry or of a similar one, ready for stereo
    /// matching: directed alike and anchored at nearly the same scene point.
    pub fn corresponding(&self, line1: &Line, line2: &Line) -> Option<(AnchoredLine, AnchoredLine)> {
        self.pencils.anchored(line1, line2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{example_fundamental, example_seen};
    use crate::geometry::symmetric_epipolar_distance;

    const FRAME: Frame = Frame { width: 768, height: 576 };

    fn example() -> (FundamentalMatrix, [PointPair; 2]) {
        (example_fundamental(), [example_seen(-0.5, -0.6, 5.0), example_seen(0.6, 0.7, 6.0)])
    }

    #[test]
    fn a_matrix_is_constructed_from_its_own_lines() {
        let (f, clicks) = example();
        let construction = Construction::of(&f, clicks, 0.0).unwrap();
        assert!((construction.pencils.fundamental().unwrap().matrix() - f.matrix()).norm() < 1e-9);
        for pair in [construction.forward().unwrap(), construction.backward().unwrap()] {
            let on1 = pair.line1.foot(FRAME.centre());
            assert!(f.line2_from_point1(on1).unwrap().distance(pair.line2.foot(FRAME.centre())) < 1e-6);
        }
        let trips = construction.round_trips(FRAME, 12);
        assert_eq!(trips.len(), 12);
        for trip in trips {
            assert!(trip.line1.coefficients().cross(trip.back1.coefficients()).norm() < 1e-6);
            let pair = PointPair {
                point1: trip.line1.foot(FRAME.centre()),
                point2: trip.line2.foot(FRAME.centre()),
            };
            assert!(symmetric_epipolar_distance(&f, &pair) < 1e-6);
        }
    }

    #[test]
    fn lines_run_the_same_way_at_any_rotation() {
        let (f, clicks) = example();
        // Rotating image 2 by half a turn reverses all of its lines.
        let half_turn = nalgebra::Matrix3::new(-1.0, 0.0, 767.0, 0.0, -1.0, 575.0, 0.0, 0.0, 1.0);
        let turned = FundamentalMatrix::from_rank_two(half_turn.tr_mul(f.matrix())).unwrap();
        let turned_clicks = clicks.map(|c| PointPair {
            point2: crate::geometry::Point::new(767.0 - c.point2.x, 575.0 - c.point2.y),
            ..c
        });
        for (f, clicks, turn) in [(f, clicks, 0.0), (turned, turned_clicks, std::f64::consts::PI)] {
            let construction = Construction::of(&f, clicks, turn).unwrap();
            let line1 = f.line1_from_point2(clicks[0].point2).unwrap();
            let line2 = f.line2_from_point1(clicks[0].point1).unwrap();
            let (l1, l2) = construction.corresponding(&line1, &line2).unwrap();
            assert!(
                (l1.anchor - clicks[0].point1).norm() < 1e-6 && (l2.anchor - clicks[0].point2).norm() < 1e-6
            );
            // The example cameras are hardly rotated against each other.
            assert!(l1.direction.dot(&l2.direction) * turn.cos() > 0.5);
        }
    }

    #[test]
    fn different_maps_leave_an_area_between_a_line_and_its_return() {
        let (f, clicks) = example();
        let mut construction = Construction::of(&f, clicks, 0.0).unwrap();
        construction.kappa_backward = Some(construction.pencils.map.kappa() * 1.5);
        let moved = construction
            .round_trips(FRAME, 12)
            .iter()
            .any(|trip| trip.line1.coefficients().cross(trip.back1.coefficients()).norm() > 1e-3);
        assert!(moved);
        construction.kappa_backward = None;
        assert!(construction.round_trips(FRAME, 12).is_empty() && construction.backward().is_none());
    }
}
