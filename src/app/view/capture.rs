//! The window as a picture: asked for in a frame that has nothing in front of the images, and read back from the
//! screen by the toolkit.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{ColorImage, Context, Rect};

use crate::app::model::exchange::{ExportContent, ViewPart};
use crate::io::{PictureFormat, TrustNote, described, encode_picture};

/// A screen that takes longer than this has no picture to give.
const PATIENCE: Duration = Duration::from_secs(5);

/// A picture that is wanted.
struct WantedView {
    path: PathBuf,
    part: ViewPart,
    since: Instant,
    /// None before it was asked for.
    picture: Option<Receiver<Arc<ColorImage>>>,
}

/// What became of it.
pub struct CapturedView {
    /// Where it is to be written.
    pub path: PathBuf,
    /// The picture and which part of it; none when the screen gave none.
    pub picture: Option<(Arc<ColorImage>, ViewPart)>,
}

/// The picture that is being taken, one at a time.
#[derive(Default)]
pub struct ViewCapture {
    wanted: Option<WantedView>,
}

impl ViewCapture {
    /// Takes a picture of the next frame.
    pub fn begin(&mut self, path: PathBuf, part: ViewPart) {
        self.wanted = Some(WantedView { path, part, since: Instant::now(), picture: None });
    }

    /// Whether the frame that is being drawn may be the picture.
    pub fn is_under_way(&self) -> bool {
        self.wanted.is_some()
    }

    /// Asks for the frame that is about to be drawn, once.
    pub fn ask(&mut self, ctx: &Context) {
        if let Some(wanted) = self.wanted.as_mut().filter(|wanted| wanted.picture.is_none()) {
            let (sender, picture) = channel();
            let window = ctx.clone();
            ctx.request_screenshot(move |image| {
                // Nobody waits for it any more when the window has closed.
                let _ = sender.send(image);
                window.request_repaint();
            });
            wanted.picture = Some(picture);
        }
    }

    /// The picture, once it is there, or that there is none.
    pub fn poll(&mut self, ctx: &Context) -> Option<CapturedView> {
        let wanted = self.wanted.as_ref()?;
        let picture = wanted.picture.as_ref()?.try_recv().ok();
        if picture.is_none() && wanted.since.elapsed() < PATIENCE {
            ctx.request_repaint_after(Duration::from_millis(50));
            return None;
        }
        let WantedView { path, part, .. } = self.wanted.take()?;
        Some(CapturedView { path, picture: picture.map(|picture| (picture, part)) })
    }
}

/// The view as it was on the screen; `part` in screen points.
/// `trust` is how far its geometry is to be trusted.
pub fn picture(
    screen: Arc<ColorImage>,
    part: Option<Rect>,
    pixels_per_point: f32,
    trust: Option<TrustNote>,
) -> ExportContent {
    Box::new(move || {
        let picture = cut(&screen, part, pixels_per_point).into();
        let png = encode_picture(&picture, PictureFormat::Png).map_err(|error| error.to_string())?;
        Ok(trust.iter().fold(png, |png, trust| described(png, &trust.in_words())))
    })
}

/// A part of the window as an image; all of it where the part is empty or not on it.
fn cut(screen: &ColorImage, part: Option<Rect>, pixels_per_point: f32) -> image::RgbaImage {
    let [width, height] = screen.size;
    let whole = [0, 0, width, height];
    let [left, top, right, bottom] = part.map_or(whole, |part| {
        let edge = |v: f32, size: usize| ((v * pixels_per_point).round().max(0.0) as usize).min(size);
        let [left, top] = [edge(part.min.x, width), edge(part.min.y, height)];
        let [right, bottom] = [edge(part.max.x, width), edge(part.max.y, height)];
        if left < right && top < bottom { [left, top, right, bottom] } else { whole }
    });
    image::RgbaImage::from_fn((right - left) as u32, (bottom - top) as u32, |x, y| {
        let at = (top + y as usize) * width + left + x as usize;
        // What is seen has no transparent places, whatever the screen keeps in its fourth channel.
        let [r, g, b, _] = screen.pixels[at].to_array();
        image::Rgba([r, g, b, 255])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, pos2};

    #[test]
    fn the_part_is_cut_in_pixels_of_the_screen() {
        let pixels = (0..60).map(|k| Color32::from_rgb(k, 0, 0)).collect();
        let screen = ColorImage::new([10, 6], pixels);
        let part = Rect::from_min_max(pos2(1.0, 0.5), pos2(3.0, 2.0));
        let image = cut(&screen, Some(part), 2.0);
        assert_eq!(image.dimensions(), (4, 3));
        assert_eq!(image.get_pixel(0, 0).0, [12, 0, 0, 255]);
        assert_eq!(image.get_pixel(3, 2).0, [35, 0, 0, 255]);
        for nothing in [None, Some(Rect::NOTHING), Some(part.translate(egui::vec2(500.0, 0.0)))] {
            assert_eq!(cut(&screen, nothing, 2.0).dimensions(), (10, 6));
        }
    }
}
