//! Overlay of the bisectors and the lines matched to them, which give the line maps H and G.

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let Some(construction) = canvas.model.construction() else { return };
    let left = canvas.side == Side::Left;
    let maps = [
        (construction.forward(), theme::FORWARD, if left { "bisector" } else { "H bisector" }),
        (construction.backward(), theme::BACKWARD, if left { "G bisector" } else { "bisector" }),
    ];
    for (lines, color, name) in maps {
        let Some(line) = lines.map(|lines| canvas.own(&lines)) else { continue };
        canvas.line(&line, theme::LINE_WIDTH, color);
        if let Some(segment) = canvas.frame.clip(&line) {
            // Near the ends, where the lines of a pencil are apart.
            let at =
                segment.start + (segment.end - segment.start) * if name == "bisector" { 0.12 } else { 0.88 };
            canvas.label(canvas.transform.screen_from_image(at), name, color);
        }
    }
}
