//! Possible causes of a trial's error: positions of the clicks, texture along their lines, and the
//! search.

use std::f64::consts::PI;

use super::sight::{Sight, side};
use super::style::click_name;
use crate::estimate::ComparedPencils;
use crate::evaluate::RankingRecord;
use crate::evaluate::protocol::{OFF_LINE, distances_off_lines};
use crate::evaluate::statistics::median;
use crate::geometry::{AnchoredLine, Line, PointPair, finite_point};
use crate::image::Profile;

/// Distance below which clicks are close together, as a fraction of the longer side.
const CLOSE: f64 = 0.1;
/// Distance from the epipole below which the line of a click is unstable, as a fraction of the
/// longer side.
const NEAR_EPIPOLE: f64 = 0.15;
/// Angle between estimated and true lines that suggests another motion of the camera, radians.
const TURNED: f64 = 15.0 * PI / 180.0;
/// Contrast along a line that counts as little, relative to the median over lines through the same
/// click.
const LITTLE_CONTRAST: f64 = 0.5;
/// Distance at which candidates and hypotheses are near the truth, as a fraction of the longer
/// side.
const NEAR: f64 = 0.01;
/// Number of directions for the median contrast, over half a turn.
const DIRECTIONS: usize = 90;
/// Distance of a click from its true match that is a mistake and not noise, px.
const MISTAKE: f64 = 10.0;

/// Measurements of a trial's clicks and search; lengths in px at full size.
pub(super) struct Circumstances {
    /// Longer side of the larger image.
    side: f64,
    /// Distance between the first two clicks in each image.
    apart: [f64; 2],
    /// Smallest distance of either click from the true epipolar line of the other, over both
    /// images.
    off_line: f64,
    /// Angle between their true epipolar lines in each image, radians.
    angle: [f64; 2],
    /// Click nearest to a true epipole, the image, and the distance.
    epipole: Option<(usize, usize, f64)>,
    /// Contrast along the true line of each click, relative to the median over lines through the
    /// click, in the image where the ratio is lower.
    contrast: Vec<f64>,
    /// Distance of each click's best candidate line pair from the true pair, at the border of the
    /// image.
    candidates: Vec<f64>,
    /// Distance of each click from its true match, in the image where it is larger.
    mistakes: Vec<f64>,
    /// Ranking of the search's hypotheses.
    search: Option<RankingRecord>,
    error: f64,
    /// Median angle between estimated and true lines, radians.
    turned: f64,
}

impl Circumstances {
    pub(super) fn of(sight: &Sight) -> Self {
        let (scene, clicks) = (sight.scene, [sight.clicks[0], sight.clicks[1]]);
        let lines = clicks.map(|c| true_lines(sight, &c));
        let apart =
            [clicks[0].point1 - clicks[1].point1, clicks[0].point2 - clicks[1].point2].map(|v| v.norm());
        let off_line = distances_off_lines(&scene.truth, &clicks[0], &clicks[1])
            .into_iter()
            .flatten()
            .fold(f64::INFINITY, f64::min);
        let angle = [0, 1].map(|image| match (lines[0][image], lines[1][image]) {
            (Some(a), Some(b)) => a.angle_to(&b),
            _ => 0.0,
        });
        let epipoles = [scene.truth.epipole1(), scene.truth.epipole2()];
        let epipole = (0..2)
            .flat_map(|click| (0..2).map(move |image| (click, image)))
            .filter_map(|(click, image)| {
                let place = finite_point(&epipoles[image])?;
                Some((click, image, (place - side(&clicks[click], image)).norm()))
            })
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let contrast = |click: usize| {
            let of = |image: usize| {
                Some(relative_contrast(sight, &clicks[click], image, lines[click][image].as_ref()?))
            };
            (0..2).filter_map(of).fold(f64::INFINITY, f64::min)
        };
        let trace = sight.detail.as_ref().and_then(|d| d.estimate.trace.as_ref());
        let candidates = trace.iter().flat_map(|trace| &trace.pencils).zip(&lines);
        let mistakes = sight.trial.matches.iter().zip(&sight.clicks).map(|(index, click)| {
            let meant = &scene.matches[*index];
            f64::max((meant.point1 - click.point1).norm(), (meant.point2 - click.point2).norm())
        });
        Self {
            side: scene.longer_side(),
            apart,
            off_line,
            angle,
            epipole,
            contrast: (0..2).map(contrast).collect(),
            candidates: candidates.filter_map(|(p, l)| candidate_distance(sight, p, l)).collect(),
            mistakes: mistakes.collect(),
            search: sight.trial.search,
            error: sight.trial.mean,
            turned: sight.scene.turned(&sight.fundamental),
        }
    }

    /// Returns all measurements with their names.
    pub(super) fn facts(&self) -> Vec<(String, String)> {
        let percent = |length: f64| format!("{:.1} %", 100.0 * length / self.side);
        let mut facts = vec![
            (
                "Clicks apart".to_owned(),
                format!("{:.0} px in image 1, {:.0} px in image 2", self.apart[0], self.apart[1]),
            ),
            (
                "Off one line".to_owned(),
                format!(
                    "minimum distance of a click from the true epipolar line of the other: {:.1} px ({} of the longer side)",
                    self.off_line,
                    percent(self.off_line)
                ),
            ),
            (
                "Lines of the clicks".to_owned(),
                format!(
                    "meet at {:.1}° in image 1, {:.1}° in image 2",
                    self.angle[0].to_degrees(),
                    self.angle[1].to_degrees()
                ),
            ),
            (
                "Contrast".to_owned(),
                format!(
                    "{} of the median over lines through the same click",
                    named(&self.contrast, |c| format!("{:.0} %", 100.0 * c))
                ),
            ),
        ];
        if let Some((click, image, distance)) = self.epipole {
            let text = format!(
                "{distance:.0} px from the nearest click, {} in image {}",
                click_name(click),
                image + 1
            );
            facts.push(("True epipole".to_owned(), text));
        }
        if !self.candidates.is_empty() {
            let text = named(&self.candidates, |d| format!("{d:.0} px"));
            facts.push((
                "Nearest candidates".to_owned(),
                format!("{text} from the true line pair at the image border"),
            ));
        }
        if let Some(search) = &self.search {
            facts.push(("Search".to_owned(), search_in_words(search)));
        }
        facts
    }

    /// Returns the unusual measurements, one sentence each.
    pub(super) fn sentences(&self) -> Vec<String> {
        let mut told = Vec::new();
        for (k, distance) in self.mistakes.iter().enumerate().filter(|(_, d)| **d > MISTAKE) {
            told.push(format!("Click {} is {distance:.0} px from its true position.", click_name(k)));
        }
        if self.off_line < OFF_LINE * self.side {
            told.push(format!(
                "The clicks lie nearly on one epipolar line: one is only {:.1} px from the line of the other ({:.1} % of \
                 the longer side; well-posed clicks have {:.0} %). Nearly coincident lines leave the epipoles undetermined.",
                self.off_line,
                100.0 * self.off_line / self.side,
                100.0 * OFF_LINE
            ));
        }
        let apart = self.apart[0].min(self.apart[1]);
        if apart < CLOSE * self.side {
            told.push(format!("The clicks are close together, {apart:.0} px."));
        }
        if let Some((click, image, distance)) = self.epipole.filter(|(.., d)| *d < NEAR_EPIPOLE * self.side) {
            told.push(format!(
                "Click {} is {distance:.0} px from the epipole of image {}. There every pixel turns its line.",
                click_name(click),
                image + 1
            ));
        }
        for (k, contrast) in self.contrast.iter().enumerate().filter(|(_, c)| **c < LITTLE_CONTRAST) {
            told.push(format!(
                "The true line of {} crosses little texture: {:.0} % of the median contrast of lines through the click.",
                click_name(k),
                100.0 * contrast
            ));
        }
        for (k, distance) in self.candidates.iter().enumerate().filter(|(_, d)| **d > 2.0 * NEAR * self.side)
        {
            told.push(format!(
                "The true line pair of {} was not among the candidates. The nearest one is {distance:.0} px off at the \
                 border of the image.",
                click_name(k)
            ));
        }
        told.extend(self.search.as_ref().and_then(|search| self.search_failure(search)));
        if self.turned > TURNED {
            told.push(format!(
                "The estimated lines are turned by {:.0}° against the true ones (median). Distances in px hide this \
                 if matches move little between the images.",
                self.turned.to_degrees()
            ));
        }
        if told.is_empty() {
            told.push("Nothing about the clicks or the search is unusual.".to_owned());
        }
        told
    }

    /// Describes a failed search: no hypothesis near the truth, or a better one that was not
    /// chosen.
    fn search_failure(&self, search: &RankingRecord) -> Option<String> {
        let near = NEAR * self.side;
        if search.best_error > near {
            return Some(format!(
                "None of the {} hypotheses is near the truth. The best has an error of {:.1} px.",
                search.hypotheses, search.best_error
            ));
        }
        (self.error > 2.0 * search.best_error.max(0.5)).then(|| {
            format!(
                "The search had a hypothesis with an error of {:.1} px, but did not choose it: {}.",
                search.best_error,
                ranks_in_words(search)
            )
        })
    }
}

/// Lists a value of each click in words.
fn named(values: &[f64], text: impl Fn(f64) -> String) -> String {
    let all = values.iter().enumerate().map(|(k, v)| format!("{} {}", click_name(k), text(*v)));
    all.collect::<Vec<_>>().join(", ")
}

fn search_in_words(search: &RankingRecord) -> String {
    format!(
        "{} hypotheses kept, the best {:.1} px; {}",
        search.hypotheses,
        search.best_error,
        ranks_in_words(search)
    )
}

fn ranks_in_words(search: &RankingRecord) -> String {
    let rank = |rank: Option<usize>| rank.map_or_else(|| "unranked".to_owned(), |r| r.to_string());
    let by_lines = format!(
        "by lines it has rank {} and the truth rank {}",
        search.best_rank_by_lines,
        rank(search.true_rank_by_lines)
    );
    match search.best_rank_by_patches {
        Some(best) => format!("{by_lines}, by patches {best} and {}", rank(search.true_rank_by_patches)),
        None => by_lines,
    }
}

/// Returns the true epipolar lines of a click in image 1 and image 2.
fn true_lines(sight: &Sight, click: &PointPair) -> [Option<Line>; 2] {
    let truth = &sight.scene.truth;
    [truth.line1_from_point2(click.point2), truth.line2_from_point1(click.point1)]
}

/// Returns the contrast through a click parallel to a line, relative to the median of all
/// directions; 1 without contrast.
fn relative_contrast(sight: &Sight, click: &PointPair, image: usize, line: &Line) -> f64 {
    let (plane, at) = (&sight.scene.images[image], side(click, image));
    let along = |angle: f64| Profile::sample(plane, &AnchoredLine::at_angle(at, angle), 1.0).texture();
    let all: Vec<f64> = (0..DIRECTIONS).map(|k| along(k as f64 * PI / DIRECTIONS as f64)).collect();
    let direction = line.direction();
    let middle = median(&all);
    if middle > 0.0 { along(direction.y.atan2(direction.x)) / middle } else { 1.0 }
}

/// Returns the distance of the nearest candidate pair from the true lines at the farthest corner,
/// in the image where it is larger. `None` without candidates or true lines.
fn candidate_distance(sight: &Sight, pencils: &ComparedPencils, lines: &[Option<Line>; 2]) -> Option<f64> {
    let [Some(line1), Some(line2)] = lines else { return None };
    let reach =
        [0, 1].map(|image| sight.scene.images[image].frame().farthest_corner(side(&pencils.click, image)));
    let off = |angle: f64, line: &Line, reach: f64| {
        let direction = line.direction();
        reach * (angle.cos() * direction.y - angle.sin() * direction.x).abs()
    };
    let distances = pencils
        .candidates
        .iter()
        .map(|c| f64::max(off(c.angles[0], line1, reach[0]), off(c.angles[1], line2, reach[1])));
    distances.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDINARY: Circumstances = Circumstances {
        side: 1000.0,
        apart: [400.0, 420.0],
        off_line: 300.0,
        angle: [0.3, 0.4],
        epipole: Some((0, 1, 700.0)),
        contrast: Vec::new(),
        candidates: Vec::new(),
        mistakes: Vec::new(),
        search: None,
        error: 0.4,
        turned: 0.01,
    };

    fn search(best_error: f64) -> RankingRecord {
        RankingRecord {
            hypotheses: 60,
            best_error,
            best_rank_by_lines: 7,
            best_rank_by_patches: None,
            true_rank_by_lines: Some(3),
            true_rank_by_patches: None,
        }
    }

    #[test]
    fn each_of_them_is_told_when_it_is_unusual_and_only_then() {
        assert_eq!(ORDINARY.sentences(), ["Nothing about the clicks or the search is unusual."]);
        for (unusual, words) in [
            (Circumstances { off_line: 20.0, ..ORDINARY }, "only 20.0 px from the line of the other (2.0 %"),
            (Circumstances { apart: [35.0, 400.0], ..ORDINARY }, "close together, 35 px"),
            (
                Circumstances { epipole: Some((1, 0, 30.0)), ..ORDINARY },
                "Click q is 30 px from the epipole of image 1",
            ),
            (
                Circumstances { contrast: vec![0.9, 0.2], ..ORDINARY },
                "line of q crosses little texture: 20 %",
            ),
            (
                Circumstances { candidates: vec![44.0, 3.0], ..ORDINARY },
                "line pair of p was not among the candidates",
            ),
            (
                Circumstances { mistakes: vec![0.8, 80.0], ..ORDINARY },
                "Click q is 80 px from its true position",
            ),
            (
                Circumstances { search: Some(search(35.0)), error: 40.0, ..ORDINARY },
                "None of the 60 hypotheses",
            ),
            (
                Circumstances { search: Some(search(2.0)), error: 40.0, ..ORDINARY },
                "did not choose it: by lines it has rank 7 and the truth rank 3",
            ),
            (Circumstances { turned: 1.0, ..ORDINARY }, "turned by 57°"),
        ] {
            let told = unusual.sentences();
            assert!(told.len() == 1 && told[0].contains(words), "{words}: {told:?}");
        }
        // The best available hypothesis was chosen.
        let chosen = Circumstances { search: Some(search(2.0)), error: 2.2, ..ORDINARY };
        assert!(chosen.sentences()[0].starts_with("Nothing"));
    }
}
