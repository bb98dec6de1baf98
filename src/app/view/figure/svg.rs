//! The figure as SVG: the images as PNG inside it, everything over them as lines and letters.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use egui::epaint::{Mesh, PathShape, RectShape, TextShape};
use egui::{Color32, Pos2, Shape, Stroke};

use super::sheet::Sheet;
use crate::io::{PictureFormat, encode_picture};

/// The whole file.
pub fn write(sheet: &Sheet) -> Result<Vec<u8>, String> {
    let (width, height) = (sheet.size.x, sheet.size.y);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"0 0 {width:.1} {height:.1}\" font-family=\"Ubuntu, Helvetica, Arial, sans-serif\">\n"
    );
    let _ = writeln!(text, "<title>{}</title>", escaped(&sheet.title));
    if let Some(trust) = &sheet.trust {
        let reasons = escaped(&trust.reasons.join(" "));
        let _ = writeln!(text, "<desc>The geometry is {}. {reasons}</desc>", escaped(&trust.verdict));
    }
    let background = paint("fill", sheet.background);
    let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" {background}/>");
    for (k, place) in sheet.places.iter().enumerate() {
        let area = place.transform.rect;
        let (pixels, rect) = sheet.picture(k);
        let png = encode_picture(&pixels, PictureFormat::Png).map_err(|e| e.to_string())?;
        let crisp = if place.transform.scale > 1.5 { " style=\"image-rendering:pixelated\"" } else { "" };
        let _ = writeln!(
            text,
            "<clipPath id=\"image{k}\"><rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"/></clipPath>",
            area.min.x,
            area.min.y,
            area.width(),
            area.height()
        );
        let _ = writeln!(
            text,
            "<g clip-path=\"url(#image{k})\">\n<image x=\"{:.3}\" y=\"{:.3}\" width=\"{:.3}\" height=\"{:.3}\" preserveAspectRatio=\"none\"{crisp} href=\"data:image/png;base64,{}\"/>",
            rect.min.x,
            rect.min.y,
            rect.width(),
            rect.height(),
            STANDARD.encode(png)
        );
        for clipped in sheet.shapes().filter(|clipped| area.expand(0.5).contains_rect(clipped.clip_rect)) {
            shape(&mut text, &clipped.shape);
        }
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    Ok(text.into_bytes())
}

fn shape(text: &mut String, shape: &Shape) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|inner| self::shape(text, inner)),
        Shape::LineSegment { points: [a, b], stroke } => {
            let _ = writeln!(
                text,
                "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {}/>",
                a.x,
                a.y,
                b.x,
                b.y,
                stroked(*stroke)
            );
        }
        Shape::Circle(circle) => {
            let (centre, fill) = (circle.center, paint("fill", circle.fill));
            let _ = writeln!(
                text,
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" {fill} {}/>",
                centre.x,
                centre.y,
                circle.radius,
                stroked(circle.stroke)
            );
        }
        Shape::Rect(RectShape { rect, corner_radius, fill, stroke, .. }) => {
            let _ = writeln!(
                text,
                "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" rx=\"{}\" {} {}/>",
                rect.min.x,
                rect.min.y,
                rect.width(),
                rect.height(),
                corner_radius.nw,
                paint("fill", *fill),
                stroked(*stroke)
            );
        }
        Shape::Path(PathShape { points, closed, fill, stroke }) => {
            let element = if *closed { "polygon" } else { "polyline" };
            let color = match &stroke.color {
                egui::epaint::ColorMode::Solid(color) => *color,
                egui::epaint::ColorMode::UV(_) => Color32::TRANSPARENT,
            };
            let stroke = stroked(Stroke::new(stroke.width, color));
            let _ =
                writeln!(text, "<{element} points=\"{}\" {} {stroke}/>", list(points), paint("fill", *fill));
        }
        Shape::Mesh(mesh) => triangles(text, mesh),
        Shape::Text(letters) => write_text(text, letters),
        // Nothing else is drawn over the images.
        _ => {}
    }
}

fn triangles(text: &mut String, mesh: &Mesh) {
    for corners in mesh.indices.as_chunks::<3>().0 {
        let corners = corners.map(|k| mesh.vertices[k as usize]);
        let channel =
            |k: usize| (corners.iter().map(|v| u32::from(v.color.to_array()[k])).sum::<u32>() / 3) as u8;
        let color = Color32::from_rgba_premultiplied(channel(0), channel(1), channel(2), channel(3));
        if color.a() > 0 {
            let points = corners.map(|corner| corner.pos);
            let _ = writeln!(text, "<polygon points=\"{}\" {}/>", list(&points), paint("fill", color));
        }
    }
}

fn write_text(text: &mut String, letters: &TextShape) {
    let galley = &letters.galley;
    let format = galley.job.sections.first().map(|section| &section.format);
    let color = letters.override_text_color.or(format.map(|format| format.color)).unwrap_or(Color32::WHITE);
    let color = if color == Color32::PLACEHOLDER { letters.fallback_color } else { color };
    let size = format.map_or(13.0, |format| format.font_id.size);
    for row in &galley.rows {
        let Some(glyph) = row.row.glyphs.first() else { continue };
        let at = letters.pos + row.pos.to_vec2() + glyph.pos.to_vec2();
        let words: String = row.row.glyphs.iter().map(|glyph| glyph.chr).collect();
        let _ = writeln!(
            text,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" {}>{}</text>",
            at.x,
            at.y,
            paint("fill", color),
            escaped(&words)
        );
    }
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
