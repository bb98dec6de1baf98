//! One trial as a picture, as profiles and as figures.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::style::{CLICKS, ESTIMATED, FURTHER_CLICK, PROFILES, TRUE, click_name};
use super::{ReportSubject, style};
use crate::estimate::{Construction, Estimate};
use crate::evaluate::contender::Detail;
use crate::evaluate::report::TrialRecord;
use crate::evaluate::{KnownScene, Record};
use crate::geometry::{FundamentalMatrix, Point, PointPair, finite_point, place_in_words};
use crate::publish::plot::{Curve, Mark, MarkedPicture, Panel, Sign, Stroke, SvgDrawing, curves, pictures};
use crate::similarity::{WarpedProfile, inspect_lines, inspection_scale};

/// Maximum number of lines of true matches in a picture.
const LINES: usize = 8;

/// Trial shown in the document.
pub(super) struct Sight<'a> {
    pub(super) scene: &'a KnownScene,
    pub(super) record: &'a Record,
    pub(super) trial: &'a TrialRecord,
    pub(super) clicks: Vec<PointPair>,
    pub(super) fundamental: FundamentalMatrix,
    /// Intermediate results of the estimate, for methods that have any.
    pub(super) detail: Option<Detail>,
}

impl<'a> Sight<'a> {
    /// Repeats the estimate; `None` for a trial without an F.
    pub(super) fn new(
        subject: &ReportSubject<'a>,
        scene: usize,
        contender: usize,
        trial: &'a TrialRecord,
    ) -> Option<Self> {
        let fundamental = trial.fundamental?;
        let record = &subject.report.records[scene * subject.contenders.len() + contender];
        let (scene, contender) = (&subject.scenes[scene], &subject.contenders[contender]);
        let clicks: Vec<_> =
            trial.clicks.iter().map(|[x1, y1, x2, y2]| PointPair::new(*x1, *y1, *x2, *y2)).collect();
        // A panic must not remove the trial from the report.
        let detail =
            catch_unwind(AssertUnwindSafe(|| contender.estimate_in_detail(scene, &clicks))).unwrap_or(None);
        Some(Self { scene, record, trial, clicks, fundamental, detail })
    }

    fn estimate(&self) -> Option<&Estimate> {
        self.detail.as_ref().map(|d| &d.estimate)
    }

    /// Returns the lines of the result.
    fn construction(&self) -> Option<&Construction> {
        Some(&self.estimate()?.assessment.lines.as_ref()?.construction)
    }

    /// Draws both images with epipolar lines of some true matches, the matches, the clicks, and
    /// epipoles inside.
    pub(super) fn picture(&self) -> SvgDrawing {
        let matches = self.spread_matches();
        let mut epipole_inside = false;
        let both = [0, 1].map(|image| {
            let mut picture = MarkedPicture::new(format!("Image {}", image + 1), &self.scene.images[image]);
            let frame = self.scene.images[image].frame();
            for (f, stroke) in [
                (&self.scene.truth, Stroke::solid(TRUE, 3.4)),
                (&self.fundamental, Stroke::solid(ESTIMATED, 1.3)),
            ] {
                let lines = matches.iter().filter_map(|m| match image {
                    0 => f.line1_from_point2(m.point2),
                    _ => f.line2_from_point1(m.point1),
                });
                picture.marks.extend(lines.filter_map(|line| {
                    let segment = frame.clip(&line)?;
                    Some(Mark::Line { ends: [segment.start, segment.end], stroke })
                }));
            }
            picture.marks.extend(matches.iter().enumerate().map(|(k, m)| Mark::Dot {
                at: side(m, image),
                label: (k + 1).to_string(),
                color: MATCH,
            }));
            for (f, color) in [(&self.scene.truth, TRUE), (&self.fundamental, ESTIMATED)] {
                let epipole = if image == 0 { f.epipole1() } else { f.epipole2() };
                if let Some(at) = finite_point(&epipole).filter(|p| frame.contains(*p)) {
                    picture.marks.push(Mark::Square { at, color });
                    epipole_inside = true;
                }
            }
            picture.marks.extend(self.clicks.iter().enumerate().map(|(k, click)| Mark::Cross {
                at: side(click, image),
                label: click_name(k),
                color: CLICKS.get(k).copied().unwrap_or(FURTHER_CLICK),
            }));
            picture
        });
        let mut legend = vec![
            (Sign::Line(Stroke::solid(ESTIMATED, 2.4)), "estimated epipolar line".to_owned()),
            (Sign::Line(Stroke::solid(TRUE, 3.4)), "true epipolar line".to_owned()),
            (Sign::Dot(MATCH), "true match".to_owned()),
        ];
        if epipole_inside {
            legend.push((Sign::Square(INK), "epipole, estimated and true".to_owned()));
        }
        pictures(&both, &legend)
    }

    /// Returns unclicked true matches far from each other. The first is nearest to the centre of
    /// image 1.
    fn spread_matches(&self) -> Vec<PointPair> {
        let frames = [0, 1].map(|k| self.scene.images[k].frame());
        let visible = |m: &PointPair| frames[0].contains(m.point1) && frames[1].contains(m.point2);
        let mut left: Vec<PointPair> = self
            .scene
            .matches
            .iter()
            .enumerate()
            .filter(|(k, m)| !self.trial.matches.contains(k) && visible(m))
            .map(|(_, m)| *m)
            .collect();
        let mut chosen: Vec<PointPair> = Vec::new();
        while chosen.len() < LINES && !left.is_empty() {
            let distance = |m: &PointPair| {
                let nearest =
                    chosen.iter().map(|c| (c.point1 - m.point1).norm()).fold(f64::INFINITY, f64::min);
                if chosen.is_empty() { -(m.point1 - frames[0].centre()).norm() } else { nearest }
            };
            let farthest = (0..left.len()).max_by(|a, b| distance(&left[*a]).total_cmp(&distance(&left[*b])));
            let Some(next) = farthest else { break };
            chosen.push(left.swap_remove(next));
        }
        chosen
    }

    /// Draws the intensities of the better line pair of the first two clicks, before and after
    /// warping, with a caption.
    pub(super) fn profiles(&self) -> Option<(SvgDrawing, String)> {
        let parameters = &self.detail.as_ref()?.parameters;
        let construction = self.construction()?;
        let planes = [&*self.scene.images[0], &*self.scene.images[1]];
        let (step, range) = inspection_scale(planes[0].frame(), parameters.similarity.disparity_reach);
        let inspected =
            [construction.p(), construction.q()].into_iter().enumerate().filter_map(|(k, lines)| {
                let (line1, line2) = construction.corresponding(&lines.line1, &lines.line2)?;
                let warped =
                    inspect_lines(planes, [&line1, &line2], step, range, &parameters.similarity.stereo);
                let samples = warped.profile1.len();
                (samples > 1).then(|| (k, warped.matching.cost as f64 / samples as f64, warped))
            });
        let (click, cost, warped) = inspected.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let caption = format!(
            "Grey levels along the estimated epipolar lines of click {}, the more similar of the two clicks' line \
             pairs (mean cost {cost:.0} grey² per sample): above, both lines at the same distance from the click; below, \
             the line of image 2 brought onto that of image 1 by the disparities found.",
            click_name(click)
        );
        Some((profile_plot(&warped, step), caption))
    }

    /// Returns names and values: the trial, its result, and the assessment by the method.
    pub(super) fn facts(&self) -> Vec<(String, String)> {
        let trial = self.trial;
        let mut facts = vec![
            (
                "Error".to_owned(),
                format!(
                    "mean {:.2} px, median {:.2} px over {} true matches (true geometry: mean {:.2} px)",
                    trial.mean,
                    trial.median,
                    self.scene.matches.len(),
                    self.record.truth_error
                ),
            ),
            (
                "Direction".to_owned(),
                format!(
                    "the estimated lines of the true matches are turned by {:.1}° against the true ones (median)",
                    self.scene.turned(&self.fundamental).to_degrees()
                ),
            ),
            ("Clicks".to_owned(), self.clicks_in_words()),
        ];
        let mut fact = |name: &str, value: String| facts.push((name.to_owned(), value));
        for image in [0, 1] {
            let of = |f: &FundamentalMatrix| {
                let epipole = if image == 0 { f.epipole1() } else { f.epipole2() };
                place_in_words(&epipole, self.scene.images[image].frame())
            };
            let name = format!("Epipole in image {}", image + 1);
            fact(&name, format!("estimated {}; true {}", of(&self.fundamental), of(&self.scene.truth)));
        }
        if let Some(verdict) = trial.verdict {
            fact("Verdict", verdict.label().to_owned());
        }
        if let Some(margin) = trial.margin {
            fact("Margin", format!("{:.0} % to the best clearly different geometry", 100.0 * margin));
        }
        if let Some(estimate) = self.estimate() {
            let assessment = &estimate.assessment;
            if let Some(score) = estimate.line_score() {
                fact("Line score", format!("{score:.4} (lower is better)"));
            }
            if let Some(area) = assessment.lines.as_ref().and_then(|lines| lines.round_trip_area) {
                fact("Round trip", format!("{area:.2} px mean area between l and GH l over the image width"));
            }
            if let Some(support) = &assessment.support {
                fact("Patch support", format!("{:.1} from {} patches", support.score, support.matches));
            }
            if estimate.is_refined() {
                let matches = estimate.matches().len();
                fact("Refined", format!("on {matches} patches matched along the epipolar lines"));
            }
            if let Some(counts) = estimate.trace.as_ref().map(|trace| &trace.counts) {
                let candidates: Vec<String> = counts.candidates.iter().map(ToString::to_string).collect();
                fact(
                    "Examined",
                    format!(
                        "{} candidate line pairs through the clicks, {} hypotheses, {} validated",
                        candidates.join(" + "),
                        counts.hypotheses,
                        counts.validated
                    ),
                );
            }
        }
        let rows = self.fundamental.rows().map(|row| row.map(|v| format!("{v:.6e}")).join(", "));
        fact("F", rows.join("; "));
        if !trial.warnings.is_empty() {
            fact("Warnings", format!("{}.", trial.warnings.join("; ")));
        }
        facts
    }

    fn clicks_in_words(&self) -> String {
        let words = self.clicks.iter().enumerate().map(|(k, PointPair { point1, point2 })| {
            format!(
                "{} ({:.1}, {:.1}) and ({:.1}, {:.1})",
                click_name(k),
                point1.x,
                point1.y,
                point2.x,
                point2.y
            )
        });
        words.collect::<Vec<_>>().join("; ")
    }
}

/// Colour of true matches on a picture.
const MATCH: &str = "#f0e442";
/// Colour of legend signs that stand for several colours.
const INK: &str = style::PROFILES[0];

/// Returns the point of a pair in image 1 (0) or image 2 (1).
pub(super) fn side(pair: &PointPair, image: usize) -> Point {
    if image == 0 { pair.point1 } else { pair.point2 }
}

fn profile_plot(warped: &WarpedProfile, step: f64) -> SvgDrawing {
    let x = |sample: i32| f64::from(sample) * step;
    let curve = |image: usize, points: Vec<(f64, Option<f64>)>| Curve {
        name: format!("line of image {}", image + 1),
        stroke: Stroke::solid(PROFILES[image], 1.2),
        points,
    };
    let own = |profile: &crate::image::Profile| -> Vec<_> {
        (profile.first..).zip(&profile.values).map(|(i, v)| (x(i), Some(f64::from(*v)))).collect()
    };
    let brought =
        (warped.profile1.first..).zip(&warped.warped2).map(|(i, v)| (x(i), v.map(f64::from))).collect();
    let panel = |title: &str, second: Vec<_>| Panel {
        title: title.to_owned(),
        curves: vec![curve(0, own(&warped.profile1)), curve(1, second)],
    };
    let panels = [panel("Before warping", own(&warped.profile2)), panel("After warping", brought)];
    curves(&panels, "distance from the click along the line, px", "grey level", [0.0, 255.0])
}
