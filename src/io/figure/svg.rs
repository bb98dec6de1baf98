//! The figure as SVG, with the images embedded as PNG, and vector lines and text.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{Figure, FigureArea, FigureColor, FigurePicture, FigureShape, FigureStroke};
use crate::io::picture_file::{PictureFormat, encode_picture};

/// Returns the figure as SVG.
pub fn write_svg(figure: &Figure) -> Result<Vec<u8>, String> {
    let [width, height] = figure.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"0 0 {width:.1} {height:.1}\" font-family=\"Ubuntu, Helvetica, Arial, sans-serif\">\n"
    );
    let _ = writeln!(text, "<title>{}</title>", escaped(&figure.title));
    if let Some(trust) = &figure.trust {
        let _ = writeln!(text, "<desc>{}</desc>", escaped(&trust.in_words()));
    }
    let background = paint("fill", figure.background);
    let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" {background}/>");
    for (k, picture) in figure.pictures.iter().enumerate() {
        let FigurePicture { area, pixels, place, is_magnified, shapes } = picture;
        let png = encode_picture(pixels, PictureFormat::Png).map_err(|e| e.to_string())?;
        let crisp = if *is_magnified { " style=\"image-rendering:pixelated\"" } else { "" };
        let _ = writeln!(text, "<clipPath id=\"image{k}\"><rect {}/></clipPath>", placed(area, 2));
        let _ = writeln!(
            text,
            "<g clip-path=\"url(#image{k})\">\n<image {} preserveAspectRatio=\"none\"{crisp} href=\"data:image/png;base64,{}\"/>",
            placed(place, 3),
            STANDARD.encode(png)
        );
        for shape in shapes {
            write_shape(&mut text, shape);
        }
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    Ok(text.into_bytes())
}

fn write_shape(text: &mut String, shape: &FigureShape) {
    let _ = match shape {
        FigureShape::Line([[x1, y1], [x2, y2]], stroke) => writeln!(
            text,
            "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" {}/>",
            stroked(*stroke)
        ),
        FigureShape::Circle { centre: [x, y], radius, fill, stroke } => writeln!(
            text,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {} {}/>",
            paint("fill", *fill),
            stroked(*stroke)
        ),
        FigureShape::Rect { area, rounding, fill, stroke } => writeln!(
            text,
            "<rect {} rx=\"{rounding}\" {} {}/>",
            placed(area, 2),
            paint("fill", *fill),
            stroked(*stroke)
        ),
        FigureShape::Path { points, closed, fill, stroke } => {
            let element = if *closed { "polygon" } else { "polyline" };
            let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
            let (fill, stroke) = (paint("fill", *fill), stroked(*stroke));
            writeln!(text, "<{element} points=\"{}\" {fill} {stroke}/>", points.join(" "))
        }
        FigureShape::Text { at: [x, y], size, color, words } => writeln!(
            text,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" {}>{}</text>",
            paint("fill", *color),
            escaped(words)
        ),
    };
}

/// Returns the place and the size of a rectangle as attributes.
fn placed(area: &FigureArea, digits: usize) -> String {
    let FigureArea { at: [x, y], size: [width, height] } = area;
    format!("x=\"{x:.digits$}\" y=\"{y:.digits$}\" width=\"{width:.digits$}\" height=\"{height:.digits$}\"")
}

fn paint(what: &str, [red, green, blue, alpha]: FigureColor) -> String {
    match alpha {
        0 => format!("{what}=\"none\""),
        255 => format!("{what}=\"#{red:02x}{green:02x}{blue:02x}\""),
        _ => format!(
            "{what}=\"#{red:02x}{green:02x}{blue:02x}\" {what}-opacity=\"{:.3}\"",
            f32::from(alpha) / 255.0
        ),
    }
}

fn stroked(stroke: FigureStroke) -> String {
    if stroke.width <= 0.0 {
        return String::new();
    }
    format!("{} stroke-width=\"{:.2}\"", paint("stroke", stroke.color), stroke.width)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
