//! Pictures side by side with lines and points on them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{ExtendedColorType, GrayImage, Luma};
use maud::{Markup, html as markup};

use super::legend::{Sign, row};
use super::{FAINT, Stroke, SvgDrawing, TEXT, WIDTH, n};
use crate::geometry::{Frame, Point};
use crate::image::GrayPlane;

/// Maximum width of an embedded picture, px: enough for print at its size in a column.
const PIXELS: u32 = 640;
/// JPEG quality, 0 to 100.
const QUALITY: u8 = 82;
/// Gap between two pictures.
const GAP: f64 = 12.0;

/// Mark on a picture, in its pixels.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Straight line.
    Line {
        /// Both ends.
        ends: [Point; 2],
        /// Stroke of the line, drawn over a dark outline.
        stroke: Stroke,
    },
    /// Small disc with a label.
    Dot {
        /// Centre of the mark.
        at: Point,
        /// Text beside the mark.
        label: String,
        /// Colour of the mark.
        color: &'static str,
    },
    /// Cross in a circle, with a label.
    Cross {
        /// Centre of the mark.
        at: Point,
        /// Text beside the mark.
        label: String,
        /// Colour of the mark.
        color: &'static str,
    },
    /// Open square.
    Square {
        /// Centre of the mark.
        at: Point,
        /// Colour of the mark.
        color: &'static str,
    },
}

/// Picture with marks.
#[derive(Debug, Clone)]
pub struct MarkedPicture {
    /// Title above the picture.
    pub title: String,
    frame: Frame,
    /// Grey JPEG as a data URI.
    pixels: String,
    /// Marks from the lowest to the topmost.
    pub marks: Vec<Mark>,
}

impl MarkedPicture {
    /// Creates a picture without marks, reduced for a page.
    pub fn new(title: impl Into<String>, plane: &GrayPlane) -> Self {
        let frame = plane.frame();
        Self { title: title.into(), frame, pixels: data_uri(plane), marks: Vec::new() }
    }

    /// Draws the picture with its marks, `width` wide.
    fn markup(&self, left: f64, top: f64, width: f64) -> Markup {
        let scale = width / self.frame.width as f64;
        let height = scale * self.frame.height as f64;
        markup! {
            text x=(n(left)) y=(n(top - 6.0)) fill=(FAINT) { (self.title) }
            // An inner drawing clips its content.
            svg x=(n(left)) y=(n(top)) width=(n(width)) height=(n(height)) {
                image width=(n(width)) height=(n(height)) preserveAspectRatio="none" href=(self.pixels) {}
                @for mark in &self.marks { (mark.markup(scale)) }
            }
        }
    }
}

impl Mark {
    fn markup(&self, scale: f64) -> Markup {
        // Pixel centres have integer coordinates; the origin of the drawing is a pixel corner.
        let at = |p: &Point| [scale * (p.x + 0.5), scale * (p.y + 0.5)];
        match self {
            Self::Line { ends, stroke } => {
                let [[x1, y1], [x2, y2]] = [at(&ends[0]), at(&ends[1])];
                let line = |color: &str, width: f64, opacity: &str, dashes: Option<&str>| {
                    markup! {
                        line x1=(n(x1)) y1=(n(y1)) x2=(n(x2)) y2=(n(y2)) stroke=(color) stroke-width=(n(width))
                            stroke-opacity=(opacity) stroke-dasharray=[dashes] {}
                    }
                };
                markup! {
                    (line("#000000", stroke.width + 1.4, "0.45", None))
                    (line(stroke.color, stroke.width, "1", stroke.dashes()))
                }
            }
            Self::Dot { at: place, label, color } => {
                let [x, y] = at(place);
                markup! {
                    circle cx=(n(x)) cy=(n(y)) r="3.2" fill=(color) stroke="#000000" stroke-width="0.8" {}
                    (label_at(x + 5.5, y - 5.0, label, "#ffffff"))
                }
            }
            Self::Cross { at: place, label, color } => {
                let [x, y] = at(place);
                let (left, right, up, down) = (n(x - 9.0), n(x + 9.0), n(y - 9.0), n(y + 9.0));
                let cross = format!("M{left} {}H{right}M{} {up}V{down}", n(y), n(x));
                markup! {
                    @for (stroke, width) in [("#000000", "3.6"), (*color, "1.8")] {
                        circle cx=(n(x)) cy=(n(y)) r="5.5" fill="none" stroke=(stroke) stroke-width=(width) {}
                        path d=(cross) stroke=(stroke) stroke-width=(width) {}
                    }
                    (label_at(x + 9.0, y - 9.0, label, color))
                }
            }
            Self::Square { at: place, color } => {
                let [x, y] = at(place);
                markup! {
                    @for (stroke, width) in [("#000000", "4.5"), (*color, "2.2")] {
                        rect x=(n(x - 6.0)) y=(n(y - 6.0)) width="12" height="12" fill="none" stroke=(stroke)
                            stroke-width=(width) {}
                    }
                }
            }
        }
    }
}

/// Draws text with an outline, legible on any background.
fn label_at(x: f64, y: f64, text: &str, color: &str) -> Markup {
    markup! {
        text x=(n(x)) y=(n(y)) font-size="13" font-weight="bold" fill=(color) stroke="#000000" stroke-width="3"
            stroke-linejoin="round" paint-order="stroke" { (text) }
    }
}

/// Draws the pictures from left to right with equal widths, above a legend.
pub fn pictures(all: &[MarkedPicture], legend: &[(Sign, String)]) -> SvgDrawing {
    let count = all.len().max(1) as f64;
    let width = (WIDTH - GAP * (count - 1.0)) / count;
    let top = 8.0 + TEXT;
    let height = all.iter().map(|p| width / p.frame.width as f64 * p.frame.height as f64).fold(0.0, f64::max);
    let content = markup! {
        @for (k, picture) in all.iter().enumerate() { (picture.markup(k as f64 * (width + GAP), top, width)) }
        (row(legend, 0.0, top + height + 16.0))
    };
    SvgDrawing::new(WIDTH, top + height + 16.0 + TEXT, content)
}

/// Encodes the picture, at most [`PIXELS`] wide.
fn data_uri(plane: &GrayPlane) -> String {
    let Frame { width, height } = plane.frame();
    let mut pixels = GrayImage::from_fn(width as u32, height as u32, |x, y| {
        Luma([(plane.at(x as usize, y as usize) + 0.5).clamp(0.0, 255.0) as u8])
    });
    if pixels.width() > PIXELS {
        let rows = f64::from(PIXELS) / f64::from(pixels.width()) * f64::from(pixels.height());
        pixels = resize(&pixels, PIXELS, (rows.round() as u32).max(1), FilterType::Triangle);
    }
    let mut bytes = Vec::new();
    let encoded = JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode(
        pixels.as_raw(),
        pixels.width(),
        pixels.height(),
        ExtendedColorType::L8,
    );
    // A picture too large for JPEG (a side above 65,535 px) is omitted.
    if encoded.is_err() {
        return "data:,".to_owned();
    }
    format!("data:image/jpeg;base64,{}", STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(width: usize, height: usize) -> MarkedPicture {
        let plane = GrayPlane::from_fn(Frame::new(width, height), |x, y| ((x * 3 + y * 5) % 256) as f32);
        let mut picture = MarkedPicture::new("<title>", &plane);
        let [a, b] = [Point::new(0.0, 0.0), Point::new(10.0, 5.0)];
        picture.marks = vec![
            Mark::Line { ends: [a, b], stroke: Stroke::solid("#00ff00", 2.0) },
            Mark::Dot { at: a, label: "<1>".into(), color: "#ffffff" },
            Mark::Cross { at: b, label: "p&q".into(), color: "#ffffff" },
            Mark::Square { at: b, color: "#ffffff" },
        ];
        picture
    }

    #[test]
    fn pictures_are_reduced_and_come_back_from_their_text() {
        for (width, shown) in [(1280, 640), (320, 320)] {
            let uri = marked(width, 240).pixels;
            let bytes = STANDARD.decode(uri.strip_prefix("data:image/jpeg;base64,").unwrap()).unwrap();
            let decoded = image::load_from_memory(&bytes).unwrap();
            assert_eq!(decoded.width(), shown);
        }
    }

    #[test]
    fn labels_are_text_and_pixel_centres_are_where_they_should_be() {
        let drawing = pictures(&[marked(100, 50), marked(100, 50)], &[(Sign::Diamond, "a<b".into())]);
        let text = drawing.file("");
        for escaped in ["&lt;title&gt;", "&lt;1&gt;", "p&amp;q", "a&lt;b"] {
            assert!(text.contains(escaped), "{escaped}");
        }
        // 464 units for 100 pixels: the centre of the first pixel is half a pixel inside.
        assert!(text.contains("x1=\"2.32\" y1=\"2.32\""), "{text}");
    }
}
