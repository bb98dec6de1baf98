//! The figure as SVG, with the images embedded as PNG, and vector lines and text.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use egui::{Color32, Pos2, Rect, Stroke};

use super::pieces::{Piece, take_apart};
use super::sheet::Sheet;
use crate::io::{PictureFormat, encode_picture};

pub fn write(sheet: &Sheet) -> Result<Vec<u8>, String> {
    let (width, height) = (sheet.size.x, sheet.size.y);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"0 0 {width:.1} {height:.1}\" font-family=\"Ubuntu, Helvetica, Arial, sans-serif\">\n"
    );
    let _ = writeln!(text, "<title>{}</title>", escaped(&sheet.title));
    if let Some(trust) = &sheet.trust {
        let _ = writeln!(text, "<desc>{}</desc>", escaped(&trust.in_words()));
    }
    let background = paint("fill", sheet.background);
    let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" {background}/>");
    for (k, place) in sheet.places.iter().enumerate() {
        let area = place.transform.rect;
        let (pixels, rect) = sheet.picture(k);
        let png = encode_picture(&pixels, PictureFormat::Png).map_err(|e| e.to_string())?;
        let crisp = if place.transform.scale > 1.5 { " style=\"image-rendering:pixelated\"" } else { "" };
        let _ = writeln!(text, "<clipPath id=\"image{k}\"><rect {}/></clipPath>", placed(area, 2));
        let _ = writeln!(
            text,
            "<g clip-path=\"url(#image{k})\">\n<image {} preserveAspectRatio=\"none\"{crisp} href=\"data:image/png;base64,{}\"/>",
            placed(rect, 3),
            STANDARD.encode(png)
        );
        for shape in sheet.shapes(k) {
            take_apart(shape, &mut |piece| write_piece(&mut text, piece));
        }
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    Ok(text.into_bytes())
}

fn write_piece(text: &mut String, piece: Piece) {
    let _ = match piece {
        Piece::Line([a, b], stroke) => writeln!(
            text,
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {}/>",
            a.x,
            a.y,
            b.x,
            b.y,
            stroked(stroke)
        ),
        Piece::Circle(circle) => writeln!(
            text,
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" {} {}/>",
            circle.center.x,
            circle.center.y,
            circle.radius,
            paint("fill", circle.fill),
            stroked(circle.stroke)
        ),
        Piece::Rect(shape) => writeln!(
            text,
            "<rect {} rx=\"{}\" {} {}/>",
            placed(shape.rect, 2),
            shape.corner_radius.nw,
            paint("fill", shape.fill),
            stroked(shape.stroke)
        ),
        Piece::Path { points, closed, fill, stroke } => {
            let element = if closed { "polygon" } else { "polyline" };
            let (fill, stroke) = (paint("fill", fill), stroked(stroke));
            writeln!(text, "<{element} points=\"{}\" {fill} {stroke}/>", list(points))
        }
        Piece::Letters { at, size, color, words } => writeln!(
            text,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" {}>{}</text>",
            at.x,
            at.y,
            paint("fill", color),
            escaped(&words)
        ),
    };
}

/// Returns the place and the size of a rectangle as attributes.
fn placed(rect: Rect, digits: usize) -> String {
    let (at, size) = (rect.min, rect.size());
    format!(
        "x=\"{:.digits$}\" y=\"{:.digits$}\" width=\"{:.digits$}\" height=\"{:.digits$}\"",
        at.x, at.y, size.x, size.y
    )
}

fn list(points: &[Pos2]) -> String {
    points.iter().map(|p| format!("{:.2},{:.2}", p.x, p.y)).collect::<Vec<_>>().join(" ")
}

fn paint(what: &str, color: Color32) -> String {
    let [red, green, blue, alpha] = color.to_srgba_unmultiplied();
    match alpha {
        0 => format!("{what}=\"none\""),
        255 => format!("{what}=\"#{red:02x}{green:02x}{blue:02x}\""),
        _ => format!(
            "{what}=\"#{red:02x}{green:02x}{blue:02x}\" {what}-opacity=\"{:.3}\"",
            f32::from(alpha) / 255.0
        ),
    }
}

fn stroked(stroke: Stroke) -> String {
    if stroke.width <= 0.0 {
        return String::new();
    }
    format!("{} stroke-width=\"{:.2}\"", paint("stroke", stroke.color), stroke.width)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
