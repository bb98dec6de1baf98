//! A result at a glance, in two rows of figures: how far the lines are off, and where the epipoles are.

use super::epipoles::{NOT_DETERMINED, interval_in_words, length_in_words};
use super::facts::{FAR, direction, far_direction, median_distance};
use crate::estimate::{
    Determined, EpipoleBearing, EpipoleCertainty, EpipoleEllipse, Estimate, LineBands, Trust,
};
use crate::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, Vector, finite_point};

/// Half of a 95 % interval, in standard deviations.
const REACH: f64 = 1.96;

/// Two figures of a kind with their ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct Glance {
    pub name: &'static str,
    /// What both figures have in common; empty if nothing.
    pub common: &'static str,
    pub heads: [&'static str; 2],
    pub values: [String; 2],
    /// Range of each value; empty if there is none.
    pub ranges: [String; 2],
    pub tooltip: &'static str,
}

/// Place of an epipole in a few words.
#[derive(Debug, Clone, PartialEq)]
pub struct EpipolePlace {
    /// Where it is from the picture: `inside`, or the side. Empty if that is open.
    pub side: &'static str,
    pub value: String,
    /// 95 % interval; empty if it is unknown.
    pub range: String,
}

impl EpipolePlace {
    /// Describes an epipole. `bearing` and `ellipse` are its uncertainty.
    fn of(
        epipole: &HomogeneousPoint,
        frame: Frame,
        bearing: Option<&EpipoleBearing>,
        ellipse: Option<EpipoleEllipse>,
    ) -> Self {
        let at = finite_point(epipole);
        if let Some(inside) = at.filter(|p| frame.contains(*p)) {
            let half = ellipse.map(|ellipse| REACH * ellipse.half_axes[0].max(ellipse.half_axes[1]));
            return Self {
                side: "inside",
                value: format!("{:.0}, {:.0}", inside.x, inside.y),
                range: half.map_or_else(String::new, |half| format!("± {} px", length_in_words(half, half))),
            };
        }
        let away = at.map_or(f64::INFINITY, |p| (p - frame.centre()).norm());
        if let Some(bearing) = bearing {
            if bearing.certainty() == EpipoleCertainty::Open {
                return Self::open();
            }
            let (sin, cos) = bearing.direction.sin_cos();
            let side = direction(frame.centre() + Vector::new(cos, sin) * (2.0 * frame.longer_side()), frame);
            let interval = interval_in_words(bearing);
            let (value, range) = match bearing.certainty() {
                EpipoleCertainty::Position => {
                    let range = interval.strip_suffix(" px away").unwrap_or(&interval);
                    let half = 0.5 * (bearing.farthest.unwrap_or(away) - bearing.nearest);
                    let value = format!("{} px", length_in_words(away, half.min(0.1 * away)));
                    let range =
                        range.split_once(" ± ").map_or(range.to_owned(), |(_, half)| format!("± {half}"));
                    (value, range)
                }
                _ => ("far away".to_owned(), interval.rsplit(", ").next().unwrap_or_default().to_owned()),
            };
            return Self { side, value, range };
        }
        match at.filter(|_| away < FAR) {
            Some(p) => {
                Self { side: direction(p, frame), value: format!("{away:.0} px"), range: String::new() }
            }
            None => {
                Self {
                    side: "", value: format!("far, {:.0}°", far_direction(epipole)), range: String::new()
                }
            }
        }
    }

    /// Describes an epipole that the matches do not determine.
    fn open() -> Self {
        Self { side: "", value: NOT_DETERMINED.to_owned(), range: String::new() }
    }

    /// Returns whether the matches do not determine the epipole.
    pub fn is_open(&self) -> bool {
        self.value == NOT_DETERMINED
    }

    /// Returns the label at the edge of a picture.
    pub fn label(&self) -> String {
        let away = if self.value.ends_with("px") { " away" } else { "" };
        let range = if self.range.is_empty() { String::new() } else { format!(", {}", self.range) };
        format!("epipole {}{away}{range}", self.value)
    }
}

/// Returns how far the lines of a result are off in images of these sizes, if it has matches.
pub fn lines_at_a_glance(estimate: &Estimate, frames: [Frame; 2]) -> Option<Glance> {
    let typical = median_distance(estimate)?;
    let bands = estimate.line_bands(frames);
    let decimals = |figure: f64| if figure < 0.1 { 2 } else { usize::from(figure < 10.0) };
    let px = |figure: f64| format!("{figure:.*} px", decimals(figure));
    let within = |bands: &LineBands| format!("± {}", px(bands.typical));
    let worst = |bands: &LineBands| format!("worst ± {}", px(bands.worst));
    Some(Glance {
        name: "Lines",
        common: "",
        heads: ["residual", "uncertainty"],
        values: [px(typical), bands.as_ref().map_or_else(|| "not known".to_owned(), within)],
        ranges: [String::new(), bands.as_ref().map_or_else(String::new, worst)],
        tooltip: "The residual is the median of all matches. The uncertainty is that of a typical line all over the \
                  pictures, and one line in twenty exceeds the worst.",
    })
}

/// Returns the places of both epipoles of a geometry, with their intervals if it is that of `estimate`.
pub fn epipole_places(
    f: &FundamentalMatrix,
    frames: [Frame; 2],
    estimate: Option<&Estimate>,
) -> [EpipolePlace; 2] {
    let is_open = |estimate: &Estimate| {
        let trust = estimate.assessment.trust.as_ref();
        estimate.determined(frames) == Some(Determined::Lines) || trust.is_some_and(Trust::doubts_the_motion)
    };
    if estimate.is_some_and(is_open) {
        return [EpipolePlace::open(), EpipolePlace::open()];
    }
    let bearings = estimate.and_then(|estimate| estimate.epipole_bearings(frames));
    let uncertainty = estimate.and_then(Estimate::uncertainty);
    let ellipses = uncertainty.map_or([None; 2], |own| [own.epipole1(), own.epipole2()]);
    let epipoles = [f.epipole1(), f.epipole2()];
    let place = |k: usize| {
        EpipolePlace::of(&epipoles[k], frames[k], bearings.as_ref().map(|both| &both[k]), ellipses[k])
    };
    [place(0), place(1)]
}

/// Returns the places of both epipoles as a row of figures.
pub fn epipoles_at_a_glance(
    f: &FundamentalMatrix,
    frames: [Frame; 2],
    estimate: Option<&Estimate>,
) -> Glance {
    let places = epipole_places(f, frames, estimate);
    let is_common = places[0].side == places[1].side;
    let range = |place: &EpipolePlace| match (is_common, place.side.is_empty(), place.range.is_empty()) {
        (true, ..) | (_, true, _) => place.range.clone(),
        (_, _, true) => place.side.to_owned(),
        _ => format!("{}, {}", place.side, place.range),
    };
    Glance {
        name: "Epipole",
        common: if is_common { places[0].side } else { "" },
        heads: ["left", "right"],
        ranges: places.each_ref().map(range),
        values: places.map(|place| place.value),
        tooltip: "Image of the other camera, where all epipolar lines of a picture meet. Inside the picture: its place. \
                  Outside: the side, and the distance from the middle of the picture. The 95 % interval, if there is \
                  one, follows from the matches.",
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::estimate::{Assessment, Reason, Verdict};

    fn bearing(direction: f64, farthest: Option<f64>) -> EpipoleBearing {
        EpipoleBearing { direction, direction_error: 0.02, distance: 950.0, nearest: 900.0, farthest }
    }

    #[test]
    fn an_epipole_outside_has_a_side_a_distance_and_a_range() {
        let frame = Frame::new(100, 100);
        let told = |direction: f64, farthest| {
            let epipole = HomogeneousPoint::new(direction.cos(), direction.sin(), 1.0 / 950.0);
            let place = EpipolePlace::of(&epipole, frame, Some(&bearing(direction, farthest)), None);
            (place.side, place.label())
        };
        assert_eq!(told(0.1, Some(1010.0)), ("right", "epipole 900 px away, ± 60".to_owned()));
        assert_eq!(told(3.1, Some(2500.0)), ("left", "epipole 1000 px away, 900 to 2500".to_owned()));
        assert_eq!(told(-1.5, None), ("above", "epipole far away, direction ± 1.1°".to_owned()));
    }

    #[test]
    fn too_little_motion_determines_no_epipole() {
        let rows = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
        let fundamental = FundamentalMatrix::from_rank_two(rows).unwrap();
        let are_open = |reason| {
            let trust = Some(Trust { verdict: Verdict::Doubtful, reasons: vec![reason] });
            let assessment = Assessment { trust, ..Assessment::default() };
            let found = Estimate { fundamental, origin: None, assessment, trace: None };
            epipole_places(&fundamental, [Frame::new(100, 100); 2], Some(&found)).map(|place| place.is_open())
        };
        assert_eq!(are_open(Reason::FewBarcodes { lines: 9 }), [true; 2]);
        assert_eq!(are_open(Reason::LooseBarcodes { deviation: 2.7 }), [false; 2]);
    }

    #[test]
    fn an_epipole_inside_has_its_place_and_one_without_uncertainty_no_range() {
        let frame = Frame::new(100, 100);
        let of = |x, y, z, ellipse| EpipolePlace::of(&HomogeneousPoint::new(x, y, z), frame, None, ellipse);
        let ellipse = EpipoleEllipse {
            centre: crate::geometry::Point::new(30.0, 40.0),
            half_axes: [1.5, 0.5],
            angle: 0.0,
        };
        let inside = of(30.0, 40.0, 1.0, Some(ellipse));
        assert_eq!((inside.side, &*inside.value, &*inside.range), ("inside", "30, 40", "± 3 px"));
        assert_eq!(of(-50.0, 20.0, 0.5, None).label(), "epipole 150 px away");
        assert_eq!(of(-1.0, -1.0, 0.0, None).label(), "epipole far, 45°");
        assert!(EpipolePlace::open().is_open());
    }
}
