//! Screenshots of the window. The toolkit reads back a frame in which nothing covers the images.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{ColorImage, Context, Rect};

use crate::app::model::exchange::ExportContent;
use crate::io::{PictureFormat, TrustNote, described, encode_picture};

/// Longest wait for the picture of the screen.
const PATIENCE: Duration = Duration::from_secs(5);

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    File(PathBuf),
    Clipboard,
}

pub struct WantedView {
    to: Destination,
    since: Instant,
    /// `None` before the toolkit was asked.
    picture: Option<Receiver<Arc<ColorImage>>>,
}

impl WantedView {
    /// Requests a picture of the next frame.
    pub fn new(to: Destination) -> Self {
        Self { to, since: Instant::now(), picture: None }
    }

    /// Asks the toolkit once, for the frame about to be drawn. Ends the screenshot once the picture has
    /// arrived or the wait is over. Returns its destination with the picture, `None` if the screen gave
    /// none.
    pub fn poll(wanted: &mut Option<Self>, ctx: &Context) -> Option<(Destination, Option<Arc<ColorImage>>)> {
        let asked = wanted.as_mut()?.picture.get_or_insert_with(|| {
            let (sender, picture) = channel();
            let window = ctx.clone();
            ctx.request_screenshot(move |image| {
                // Nobody receives the picture once the window has closed.
                let _ = sender.send(image);
                window.request_repaint();
            });
            picture
        });
        let picture = asked.try_recv().ok();
        if picture.is_none() && wanted.as_ref()?.since.elapsed() < PATIENCE {
            ctx.request_repaint_after(Duration::from_millis(50));
            return None;
        }
        Some((wanted.take()?.to, picture))
    }
}

/// Returns a part of a screenshot, in screen points, for the clipboard.
pub fn excerpt(screen: &ColorImage, part: Option<Rect>, pixels_per_point: f32) -> ColorImage {
    let picture = cut(screen, part, pixels_per_point);
    let size = [picture.width() as usize, picture.height() as usize];
    ColorImage::from_rgba_unmultiplied(size, &picture)
}

/// Encodes a screenshot as PNG. `part` is in screen points; `trust` is written into the file.
pub fn screen_as_png(
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

/// Cuts a part out of the screenshot. Returns all of it if the part is empty or off the screen.
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
        // The screenshot is opaque, whatever the screen keeps in the alpha channel.
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
