//! What the window tests share: a window without a display, and the hands of a person.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Color32, Key, Modifiers, PointerButton, Pos2, Rect, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use epiline::estimate::{
    Assessment, Candidate, Clicks, ComparedPencils, Construction, Estimate, EstimateError, LineEvidence,
    LineFigures, Parameters, PatchSupport, Reason, RefinedMatch, Refinement, SearchPlan, SearchTrace,
    Suspect,
};
use epiline::geometry::{FundamentalMatrix, Point, PointPair, fan};
use epiline::internals::app::model::document::{PointRef, Side};
use epiline::internals::app::model::look::Look;
use epiline::internals::app::{Inspector, Opening, Services, Start, install_theme};
use epiline::similarity::CostMatrix;
use epiline::suggest::SuggestError;
use epiline::synthetic::Sample;
use nalgebra::{Matrix3, Vector3};

/// Long enough for a loaded machine; reached only when something is wrong.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// A stand-in for the estimator, instant and exact for the two pairs it is given: `F = [e2]× T` with the
/// translation `T` from `p1` to `p2`, and `e2` on the line of `q2` and `T q1`.
pub fn fake_estimate(pairs: &[PointPair], parameters: &Parameters) -> Result<Estimate, EstimateError> {
    let [p, q, ..] = pairs else {
        return Err(EstimateError::TooFewPairs { found: pairs.len(), needed: 2 });
    };
    let t = p.point2 - p.point1;
    let shift = Matrix3::new(1.0, 0.0, t.x, 0.0, 1.0, t.y, 0.0, 0.0, 1.0);
    let line = q.point2.to_homogeneous().cross(&(shift * q.point1.to_homogeneous()));
    let e2 = line.cross(&Vector3::new(0.0, 1.0, -100.0)).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let fundamental =
        FundamentalMatrix::from_rank_two(e2.cross_matrix() * shift).ok_or(EstimateError::NoGeometry)?;
    let assessment = Assessment {
        lines: Some(line_figures(&fundamental, [*p, *q], 0.25)?),
        margin: Some(0.4),
        line_evidence: Some(LineEvidence { likelihood: 320.0, rival: 20.0, log_false_alarms: -900.0 }),
        refinement: Some(Refinement { matches: Vec::new(), uncertainty: None, noise: None, is_posed: false }),
        ..Assessment::default()
    };
    let trace = SearchTrace {
        clicks: Clicks::for_plan(pairs, SearchPlan::of(parameters, pairs.len())),
        preset: parameters.preset,
        seed: parameters.seed,
        first_seconds: 0.01,
        seconds: 0.02,
        ..SearchTrace::default()
    };
    Ok(Estimate { fundamental, origin: None, assessment, trace: Some(Arc::new(trace)) })
}

fn line_figures(
    f: &FundamentalMatrix,
    clicks: [PointPair; 2],
    score: f64,
) -> Result<LineFigures, EstimateError> {
    let construction = Construction::of(f, clicks, 0.0).ok_or(EstimateError::NoGeometry)?;
    Ok(LineFigures { score: Some(score), round_trip_area: Some(0.5), construction })
}

/// [`fake_estimate`] with three hypotheses, worst line score first, and pencils in which lines of the same
/// direction are alike.
pub fn rich_estimate(pairs: &[PointPair], parameters: &Parameters) -> Result<Estimate, EstimateError> {
    let estimate = fake_estimate(pairs, parameters)?;
    let clicks = [pairs[0], pairs[1]];
    let hypothesis = |number: usize| {
        // Another match for q, and so other lines.
        let mut moved = clicks;
        moved[1].point2.y += 40.0 * number as f64;
        let fundamental = *fake_estimate(&moved, parameters)?.fundamental();
        let assessment = Assessment {
            lines: Some(line_figures(&fundamental, clicks, 0.9 - 0.2 * number as f64)?),
            support: Some(PatchSupport { matches: 30, score: 100.0 - 10.0 * number as f64 }),
            ..Assessment::default()
        };
        Ok(Estimate { fundamental, origin: None, assessment, trace: None })
    };
    let hypotheses = (0..3).map(hypothesis).collect::<Result<Vec<_>, EstimateError>>()?;
    let compared = |click| {
        let angles = |count: usize| (0..count).map(|k| PI * k as f64 / 24.0).collect::<Vec<f64>>();
        let (angles1, angles2) = (angles(24), angles(48));
        let costs = angles1
            .iter()
            .flat_map(|a| angles2.iter().map(move |b| (b - a).abs()))
            .map(|turn| if turn < PI / 4.0 { turn as f32 + 0.1 } else { f32::INFINITY })
            .collect();
        let candidates = angles1.iter().map(|a| Candidate { angles: [*a, *a], cost: 0.1 }).collect();
        let costs = CostMatrix::new(24, 48, costs);
        Arc::new(ComparedPencils { click, angles1, angles2, lines_before: [24, 24], costs, candidates })
    };
    let trace = estimate.trace.as_deref().cloned();
    let trace = trace
        .map(|trace| Arc::new(SearchTrace { hypotheses, pencils: clicks.map(compared).to_vec(), ..trace }));
    Ok(Estimate { trace, ..estimate })
}

/// [`rich_estimate`] with three matches on the sample.
pub fn matched_estimate(pairs: &[PointPair], parameters: &Parameters) -> Result<Estimate, EstimateError> {
    let mut estimate = rich_estimate(pairs, parameters)?;
    let at = |x: f64, y: f64| PointPair::new(x, y, x - 12.0, y);
    let matches = [at(200.0, 150.0), at(400.0, 300.0), at(600.0, 450.0)];
    let matches = matches.map(|pair| RefinedMatch { pair, correlation: 0.9 }).to_vec();
    estimate.assessment.refinement =
        Some(Refinement { matches, uncertainty: None, noise: None, is_posed: false });
    Ok(estimate)
}

/// Whether a text is painted anywhere.
pub fn painted(window: &Window, text: &str) -> bool {
    window.output().shapes.iter().any(|clipped| match &clipped.shape {
        Shape::Text(shape) => shape.galley.text().contains(text),
        _ => false,
    })
}

/// Runs a command by its title in the list of all commands.
pub fn run_command(window: &mut Window, title: &str) {
    press_with(window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Search commands").type_text(title);
    settle(window);
    press(window, Key::Enter);
}

/// That a pair, counted from 1, is so far off its line (Sampson).
pub fn click_off(pair: usize, distance: f64) -> Reason {
    Reason::ClickOff { pair, distance, suspect: Suspect::Click }
}

/// Services with [`rich_estimate`] for the estimator.
pub fn rich_services() -> Services {
    Services {
        estimate: Box::new(|request, _| rich_estimate(&request.pairs, &request.parameters)),
        ..services()
    }
}

/// The lines of a colour drawn over an image, as their ends on the screen.
pub fn lines(window: &Window, side: Side, color: Color32) -> Vec<[Pos2; 2]> {
    let pane = pane(window, side);
    let shapes =
        window.output().shapes.iter().filter(|clipped| pane.expand(1.0).contains_rect(clipped.clip_rect));
    let lines = shapes.filter_map(|clipped| match &clipped.shape {
        Shape::LineSegment { points, stroke } if stroke.color == color => Some(*points),
        _ => None,
    });
    lines.collect()
}

/// The estimated lines' colour.
pub const ESTIMATED: Color32 = Color32::from_rgb(31, 199, 152);
/// Lines of a geometry that is shown in place of the result.
pub const OTHER: Color32 = Color32::from_rgb(184, 113, 242);

/// Where in a fitting image a place of the screen is.
pub fn image_position(window: &Window, side: Side, at: Pos2) -> Point {
    let offset = (at - pane(window, side).center()) / fitting_scale(window, side);
    window.state().document().frame(side).unwrap().centre()
        + epiline::geometry::Vector::new(f64::from(offset.x), f64::from(offset.y))
}

/// Whether the numbered lines of a geometry are drawn in the right image, in this colour.
pub fn shows_lines(window: &Window, f: &FundamentalMatrix, color: Color32) -> bool {
    let document = window.state().document();
    let found: Vec<_> = window.state().model().matched_pairs().collect();
    let matches = if found.is_empty() { &document.pairs } else { &found };
    let numbered = fan::numbered(f, document.frames().unwrap(), matches);
    let drawn = lines(window, Side::Right, color);
    let mut parts = numbered.iter().filter_map(|own| own.parts[1]);
    parts.all(|part| {
        let ends = [part.start, part.end].map(|end| screen_of(window, Side::Right, end));
        drawn.iter().any(|drawn| drawn.iter().zip(&ends).all(|(a, b)| a.distance(*b) < 0.5))
    })
}

/// Where an image position appears in a fitting image.
pub fn screen_of(window: &Window, side: Side, point: Point) -> Pos2 {
    let offset = point - window.state().document().frame(side).unwrap().centre();
    pane(window, side).center() + vec2(offset.x as f32, offset.y as f32) * fitting_scale(window, side)
}

pub fn services() -> Services {
    Services {
        prepare: Box::new(|_, _| ()),
        estimate: Box::new(|request, _| fake_estimate(&request.pairs, &request.parameters)),
        follow: Box::new(|_, _| None),
        suggest: Box::new(|_| Err(SuggestError::Flat)),
        next_click: Box::new(|_| None),
        lens: Box::new(|_| None),
        places: Box::new(|_| Vec::new()),
        repair: Box::new(|_| Err("Nothing is alike".into())),
        pick_file: Arc::new(|| None),
        pick_folder: Arc::new(|| None),
        pick_save: Arc::new(|_| None),
        copies: None,
    }
}

pub type Window = Harness<'static, Inspector>;

/// Opens the second sample in place of the first one: its epipoles are outside, and its focal lengths are unknown.
pub fn window(start: Start, services: Services) -> Window {
    let start = match start.opening {
        Opening::Sample(_) => Start { opening: Opening::Sample(Sample::Courtyard), ..start },
        _ => start,
    };
    started(start, services)
}

pub fn started(start: Start, services: Services) -> Window {
    let mut window = Harness::builder()
        .with_size(vec2(1280.0, 848.0))
        .with_max_steps(30)
        .with_step_dt(0.05)
        .with_context_setup(install_theme)
        .build_ui_state(|ui, inspector: &mut Inspector| inspector.show(ui), Inspector::new(start, services));
    // Tests of the replay play it; all others see the last moment of a step.
    window.state_mut().set_look(Look { still_steps: true, ..Look::default() });
    settle(&mut window);
    window
}

pub fn sample() -> Window {
    window(Start::default(), services())
}

/// Steps until nothing is under way in any thread, then until nothing is repainted.
pub fn settle(window: &mut Window) {
    let start = Instant::now();
    window.step();
    loop {
        while window.state().is_busy() {
            assert!(start.elapsed() < PATIENCE, "still busy");
            std::thread::sleep(Duration::from_millis(1));
            window.step();
        }
        // The last frames may ask for more.
        window.run();
        if !window.state().is_busy() {
            return;
        }
    }
}

pub fn pane(window: &Window, side: Side) -> Rect {
    window.get_by_label(&format!("{} image", side.name())).rect()
}

/// Screen points per image pixel of an image that fits its pane.
pub fn fitting_scale(window: &Window, side: Side) -> f32 {
    let rect = pane(window, side);
    let frame = window.state().document().frame(side).unwrap();
    (rect.width() / frame.width as f32).min(rect.height() / frame.height as f32).min(64.0)
}

/// A place in a fitting image, as a fraction of its size from the middle.
pub fn at(window: &Window, side: Side, x: f32, y: f32) -> Pos2 {
    let frame = window.state().document().frame(side).unwrap();
    let offset = vec2(x * frame.width as f32, y * frame.height as f32);
    pane(window, side).center() + offset * fitting_scale(window, side)
}

pub fn button(window: &Window, pos: Pos2, button: PointerButton, pressed: bool) {
    window.event(egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
}

/// Clicks the element of this name.
pub fn tap(window: &mut Window, name: &str) {
    window.get_by_label(name).click();
    settle(window);
}

pub fn press_with(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    settle(window);
}

pub fn undo(window: &mut Window) {
    press_with(window, Modifiers::COMMAND, Key::Z);
}

/// Clicks a place of an image, as for [`at`].
pub fn click_at(window: &mut Window, side: Side, x: f32, y: f32) {
    let place = at(window, side, x, y);
    click(window, place);
}

pub fn press(window: &mut Window, key: Key) {
    window.key_press(key);
    settle(window);
}

pub fn click(window: &mut Window, position: Pos2) {
    window.hover_at(position);
    button(window, position, PointerButton::Primary, true);
    button(window, position, PointerButton::Primary, false);
    // Long enough for the next click not to be the second of a double click.
    for _ in 0..8 {
        window.step();
    }
    settle(window);
}

pub fn right_click(window: &mut Window, at: Pos2) {
    window.hover_at(at);
    button(window, at, PointerButton::Secondary, true);
    button(window, at, PointerButton::Secondary, false);
    for _ in 0..3 {
        window.step();
    }
    settle(window);
}

pub fn drag(window: &mut Window, from: Pos2, to: Pos2, with: PointerButton) {
    window.hover_at(from);
    button(window, from, with, true);
    for k in 1..=5 {
        window.hover_at(from.lerp(to, k as f32 / 5.0));
    }
    window.step();
    button(window, to, with, false);
    window.step();
    settle(window);
}

/// Two pairs on the sample: `p` near the top left, `q` near the bottom right.
pub fn click_two_pairs(window: &mut Window) {
    for (x, y) in [(-0.2, -0.2), (0.2, 0.25)] {
        for side in Side::BOTH {
            click_at(window, side, if side == Side::Left { x } else { x - 0.05 }, y);
        }
    }
}

/// Where a point appears in a fitting image.
pub fn screen(window: &Window, at: PointRef) -> Pos2 {
    let document = window.state().document();
    let offset = document.point(at).unwrap() - document.frame(at.side).unwrap().centre();
    let scale = fitting_scale(window, at.side);
    pane(window, at.side).center() + vec2(offset.x as f32, offset.y as f32) * scale
}

pub const P_LEFT: PointRef = PointRef { pair: 0, side: Side::Left };

pub fn point(window: &Window, at: PointRef) -> Point {
    window.state().document().point(at).unwrap()
}

/// A file that is removed with its folder.
pub struct Files(pub tempfile::TempDir);

impl Files {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn image(&self, name: &str, width: u32, height: u32) -> PathBuf {
        let path = self.0.path().join(name);
        image::GrayImage::from_fn(width, height, |x, y| image::Luma([(x * 7 + y * 13) as u8]))
            .save(&path)
            .unwrap();
        path
    }

    pub fn text(&self, name: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, "not an image").unwrap();
        path
    }
}

#[derive(Debug)]
pub struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub fn drop_files(window: &mut Window, paths: &[PathBuf]) {
    for path in paths {
        window.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    }
    window.step();
    settle(window);
}

pub fn open(paths: [PathBuf; 2]) -> Window {
    let [left, right] = paths;
    window(Start { opening: Opening::Files(left, right), ..Start::default() }, services())
}

/// The colour of the line pair of the cursor.
pub const HOVER: Color32 = Color32::from_rgb(244, 239, 110);

/// Opens a session in a new window.
pub fn reopened(path: PathBuf) -> Window {
    window(Start { opening: Opening::Session(path.into()), ..Start::default() }, services())
}

/// Saves the session in a file, by its dialog.
pub fn save_as(window: &mut Window, path: &Path) {
    press_with(window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    let field = window.get_by_label("File");
    field.focus();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label("File").type_text(path.to_str().unwrap());
    settle(window);
    window.key_press(Key::Enter);
    settle(window);
}

/// A turn of the wheel by so many screen points, towards the top where positive.
pub fn wheel(by: f32) -> egui::Event {
    egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, by),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    }
}

/// Turns the wheel, which zooms in.
pub fn scroll(window: &mut Window, at: Pos2) {
    scroll_by(window, at, 150.0);
}

/// Turns the wheel and waits until what it moves is at rest.
pub fn scroll_by(window: &mut Window, at: Pos2, by: f32) {
    window.hover_at(at);
    window.event(wheel(by));
    for _ in 0..10 {
        window.step();
    }
    settle(window);
}

/// Opens a menu and clicks an entry.
pub fn choose(window: &mut Window, menu: &str, entry: &str) {
    tap(window, menu);
    tap(window, entry);
}

/// Shows the last moment of a step of the search.
pub fn show_step(window: &mut Window, step: &str) {
    settle(window);
    tap(window, &format!("Step {step}"));
}

/// Shows the result with the table of its hypotheses.
pub fn show_hypotheses(window: &mut Window) {
    if window.state().model().replayed().is_some() {
        tap(window, "Result");
    }
    press(window, Key::Num1);
}

/// Shows a step of the method with its parameters.
pub fn show_parameters(window: &mut Window, step: &str) {
    show_step(window, step);
    let header = window.query_by_label("Parameters").or_else(|| window.query_by_label("Parameters *"));
    header.expect("a step with parameters").click();
    settle(window);
}

/// Unfolds a pair of the list.
pub fn unfold(window: &mut Window, pair: &str) {
    if window.query_by_label(&format!("Name of pair {pair}")).is_none() {
        tap(window, &format!("Row of pair {pair}"));
    }
}
