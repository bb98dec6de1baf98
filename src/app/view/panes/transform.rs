//! Transforms between image pixels and the screen, the only ones in the window.
//!
//! Image coordinates are those of [`crate::geometry`]: the centre of the top-left pixel is `(0,
//! 0)`, so the edge of the picture lies half a pixel outside.

use crate::app::model::dock::BETWEEN;
use crate::app::model::pane_view::{LARGEST_SCALE, PaneView, QuarterTurns};
use crate::app::model::rectified::{RectifiedView, Viewing};
use crate::camera::UndistortedView;
use crate::geometry::{Frame, Point, Vector};
use egui::{Pos2, Rect, Response, Ui, Vec2, vec2};

impl PaneView {
    pub fn transform(&self, frame: Frame, rect: Rect) -> Transform {
        let scale = self.scale.unwrap_or_else(|| self.fitting_scale(frame, rect));
        Transform { rect, centre: self.centre, scale, turn: self.turn, lens: None }
    }

    /// Zooms by a factor and keeps the image position under `at` in place.
    pub fn zoom(&mut self, transform: &Transform, frame: Frame, at: Pos2, factor: f64) {
        let smallest = self.fitting_scale(frame, transform.rect) * 0.25;
        let scale = (transform.scale * factor).clamp(smallest.min(LARGEST_SCALE), LARGEST_SCALE);
        let fixed = transform.pixel_from_screen(at);
        self.scale = Some(scale);
        self.centre = fixed - transform.at(transform.rect, scale).image_vector(at - transform.rect.center());
        self.keep_in_sight(frame);
    }

    /// Moves the image position `start` to the offset `delta` from the middle of the pane.
    pub fn pan(&mut self, transform: &Transform, frame: Frame, start: Point, delta: Vec2) {
        self.scale = Some(transform.scale);
        self.centre = start - transform.image_vector(delta);
        self.keep_in_sight(frame);
    }

    /// Returns the scale at which the whole image fits.
    fn fitting_scale(&self, frame: Frame, rect: Rect) -> f64 {
        let frame = self.turn.turned_frame(frame);
        let room = |extent: f32, pixels: usize| f64::from(extent).max(1.0) / pixels.max(1) as f64;
        room(rect.width(), frame.width).min(room(rect.height(), frame.height)).min(LARGEST_SCALE)
    }

    /// Returns the same part of another image, relative to its width and height, with the turn of the
    /// view `own` of that image.
    #[must_use]
    pub fn carried_over(&self, from: (Frame, Rect), own: &Self, to: (Frame, Rect)) -> Self {
        let share = |v: f64, from: f64, to: f64| v / from.max(1.0) * to;
        Self {
            centre: Point::new(
                share(self.centre.x, from.0.right(), to.0.right()),
                share(self.centre.y, from.0.bottom(), to.0.bottom()),
            ),
            scale: self
                .scale
                .map(|scale| scale / self.fitting_scale(from.0, from.1) * own.fitting_scale(to.0, to.1)),
            turn: own.turn,
        }
    }
}

impl Viewing {
    /// Returns the view for pictures and a pane of this size. The size of the pictures changes with
    /// the geometry; the visible part stays.
    pub fn view(&self, frame: Frame, rect: Rect, turn: QuarterTurns) -> PaneView {
        let turned = |view: PaneView| PaneView { turn, ..view };
        match self.view {
            None => turned(PaneView::fitting(frame)),
            Some(RectifiedView { frame: own, view }) if own == frame => turned(view),
            Some(RectifiedView { frame: own, view }) => {
                let view = turned(view);
                view.carried_over((own, rect), &view, (frame, rect))
            }
        }
    }
}

/// Position of points that cannot be shown.
const OUT_OF_SIGHT: Pos2 = Pos2::new(-1e5, -1e5);
/// Pieces of a curve. With 48, a line bent by 50 px is off by 0.02 px.
const PIECES: usize = 48;

/// Transform between an image and the pane that shows it.
///
/// Image positions are the coordinates of the window. Pixels are those of the picture on the screen. They
/// differ where a calibration undoes the distortion of a lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    pub rect: Rect,
    centre: Point,
    /// Screen points per image pixel.
    pub scale: f64,
    pub turn: QuarterTurns,
    /// View without distortion whose coordinates the window uses; `None` if they are the pixels.
    lens: Option<UndistortedView>,
}

impl Transform {
    /// Creates a transform with `centre` in the middle of `rect`, at `scale` screen points per
    /// image pixel, not turned.
    #[cfg(test)]
    pub fn new(rect: Rect, centre: Point, scale: f64) -> Self {
        Self { rect, centre, scale, turn: QuarterTurns::default(), lens: None }
    }

    /// Returns the same view of a reduced picture, each of whose pixels covers `times` pixels along a side.
    #[must_use]
    pub fn of_reduced(self, times: f64) -> Self {
        let reduced = |v: f64| (v + 0.5) / times - 0.5;
        let centre = Point::new(reduced(self.centre.x), reduced(self.centre.y));
        Self { centre, scale: self.scale * times, ..self }
    }

    /// Returns the same view in another rectangle and at another scale.
    #[must_use]
    pub fn at(self, rect: Rect, scale: f64) -> Self {
        Self { rect, scale, ..self }
    }

    /// Returns the transform of a picture whose lens distorts it.
    #[must_use]
    pub fn through(self, lens: Option<&UndistortedView>) -> Self {
        Self { lens: lens.copied(), ..self }
    }

    /// Returns whether straight lines of the image are curves on the screen.
    pub fn bends(&self) -> bool {
        self.lens.is_some()
    }

    /// Returns the transform in another rectangle, with the pixel of an image position in its middle.
    pub fn around(&self, point: Point, rect: Rect, scale: f64) -> Self {
        Self { rect, scale, centre: self.pixel(point).unwrap_or(self.centre), ..*self }
    }

    /// Returns the pixel of an image position. `None` beyond the range of the lens.
    fn pixel(&self, point: Point) -> Option<Point> {
        self.lens.as_ref().map_or(Some(point), |lens| lens.original_from_undistorted(point))
    }

    pub fn image_vector(&self, v: Vec2) -> Vector {
        self.turn.inverse().turned(Vector::new(f64::from(v.x), f64::from(v.y))) / self.scale
    }

    /// Returns the screen position of an image position; far outside the screen beyond the range of the
    /// lens.
    pub fn screen_from_image(&self, point: Point) -> Pos2 {
        self.pixel(point).map_or(OUT_OF_SIGHT, |pixel| self.screen_from_pixel(pixel))
    }

    /// Returns the image position at a screen position; not a number beyond the range of the lens.
    pub fn image_from_screen(&self, position: Pos2) -> Point {
        let pixel = self.pixel_from_screen(position);
        let point = self.lens.as_ref().map_or(Some(pixel), |lens| lens.undistorted_from_original(pixel));
        point.unwrap_or(Point::new(f64::NAN, f64::NAN))
    }

    pub fn screen_from_pixel(&self, pixel: Point) -> Pos2 {
        let offset = self.turn.turned((pixel - self.centre) * self.scale);
        self.rect.center() + vec2(offset.x as f32, offset.y as f32)
    }

    pub fn pixel_from_screen(&self, position: Pos2) -> Point {
        self.centre + self.image_vector(position - self.rect.center())
    }

    /// Returns the curve of a segment of the image on the screen: its two ends, or pieces of it where the
    /// lens bends it. Parts beyond the range of the lens are left out.
    pub fn curve(&self, start: Point, end: Point) -> Vec<Pos2> {
        let pieces = if self.bends() { PIECES } else { 1 };
        let at = |k: usize| start + (end - start) * (k as f64 / pieces as f64);
        (0..=pieces).filter_map(|k| Some(self.screen_from_pixel(self.pixel(at(k))?))).collect()
    }

    /// Returns the screen rectangle of the pixels from `first` up to but not including `end`.
    pub fn screen_from_pixels(&self, first: [usize; 2], end: [usize; 2]) -> Rect {
        let corner = |p: [usize; 2]| self.screen_from_pixel(Point::new(p[0] as f64 - 0.5, p[1] as f64 - 0.5));
        Rect::from_two_pos(corner(first), corner(end))
    }

    /// Returns the range of pixels that a rectangle of the screen shows: the smallest and the largest
    /// coordinates.
    pub fn pixel_range(&self, area: Rect) -> [Point; 2] {
        let (a, b) = (self.pixel_from_screen(area.min), self.pixel_from_screen(area.max));
        [Point::new(a.x.min(b.x), a.y.min(b.y)), Point::new(a.x.max(b.x), a.y.max(b.y))]
    }
}

/// Zoom per scrolled point, as an exponent.
const ZOOM_A_POINT: f32 = 0.005;

/// Returns the centre and the factor of a requested zoom.
pub fn zoom_asked(ui: &Ui, response: &Response) -> Option<(Pos2, f64)> {
    let at = response.hover_pos()?;
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = (scroll * ZOOM_A_POINT).exp() * pinch;
    ((factor - 1.0).abs() > 1e-6).then_some((at, f64::from(factor)))
}

/// Splits an area for two pictures, side by side or stacked.
pub fn halves(rect: Rect, stacked: bool) -> [Rect; 2] {
    let half = BETWEEN / 2.0;
    if stacked {
        let (upper, lower) = rect.split_top_bottom_at_fraction(0.5);
        return [upper.with_max_y(upper.max.y - half), lower.with_min_y(lower.min.y + half)];
    }
    let (left, right) = rect.split_left_right_at_fraction(0.5);
    [left.with_max_x(left.max.x - half), right.with_min_x(right.min.x + half)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;
    use proptest::prelude::*;

    const FRAME: Frame = Frame { width: 768, height: 576 };

    fn pane() -> Rect {
        Rect::from_min_size(pos2(30.0, 50.0), vec2(600.0, 400.0))
    }

    #[test]
    fn a_turned_view_shows_all_of_the_image_and_its_top_at_the_right() {
        let (rect, view) = (pane(), PaneView::fitting(FRAME).turned());
        let transform = view.transform(FRAME, rect);
        let image = transform.screen_from_pixels([0, 0], [FRAME.width, FRAME.height]);
        assert!(rect.contains_rect(image) && image.height() > image.width());
        assert!((image.center() - rect.center()).length() < 1e-3);
        // Clockwise: the top left corner goes to the top right.
        let corner = transform.screen_from_image(Point::new(-0.5, -0.5));
        assert!((corner - image.right_top()).length() < 1e-3, "{corner} {image}");
        let [low, high] = transform.pixel_range(image);
        assert!(
            (low - Point::new(-0.5, -0.5)).norm() < 1e-3 && (high - Point::new(767.5, 575.5)).norm() < 1e-3
        );
        let four = (0..4).fold(view, |view, _| view.turned());
        assert_eq!(four, view);
    }

    #[test]
    fn extreme_images_have_a_view() {
        for frame in [Frame::new(1, 1), Frame::new(12_000, 200), Frame::new(1, 9_000)] {
            for rect in [pane(), Rect::from_min_size(pos2(0.0, 0.0), vec2(0.0, 0.0))] {
                let mut view = PaneView::fitting(frame);
                for factor in [1e-9, 1e9, 0.5] {
                    let transform = view.transform(frame, rect);
                    view.zoom(&transform, frame, rect.center(), factor);
                    assert!(transform.scale.is_finite() && transform.scale > 0.0);
                }
            }
        }
    }

    #[test]
    fn a_view_carried_over_and_back_is_the_same() {
        let (small, large) = ((FRAME, pane()), (Frame::new(4000, 3000), pane()));
        let mut view = PaneView::fitting(FRAME);
        assert!(view.carried_over(small, &view, large).fits());
        view.zoom(&view.transform(FRAME, pane()), FRAME, pos2(200.0, 200.0), 3.0);
        let there = view.carried_over(small, &view, large);
        assert!((there.centre.x / 3999.0 - view.centre.x / 767.0).abs() < 1e-9);
        let back = there.carried_over(large, &view, small);
        assert!((back.centre - view.centre).norm() < 1e-9);
        assert!((back.scale.unwrap() - view.scale.unwrap()).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn the_transforms_undo_each_other_and_zoom_keeps_the_cursor(
            x in 40.0..600.0f32, y in 60.0..420.0f32, factor in 0.8..1.3f64, turn in 0..4u8
        ) {
            let rect = pane();
            let mut view = PaneView { turn: turn.into(), ..PaneView::fitting(FRAME) };
            let before = view.transform(FRAME, rect);
            let at = pos2(x, y);
            prop_assert!((before.screen_from_image(before.image_from_screen(at)) - at).length() < 1e-3);
            let under = before.image_from_screen(at);
            view.zoom(&before, FRAME, at, factor);
            let after = view.transform(FRAME, rect);
            // The limit that keeps the image in view may have moved it.
            if FRAME.contains(after.image_from_screen(rect.center())) && view.centre.x > 0.0 && view.centre.y > 0.0 && view.centre.x < FRAME.right() && view.centre.y < FRAME.bottom() {
                prop_assert!((after.image_from_screen(at) - under).norm() < 1e-3);
            }
        }
    }
}
