//! Scripts for MATLAB, Octave and the VGG toolbox: assignments of matrices.
//!
//! MATLAB counts pixels from 1. The documentation of `estimateFundamentalMatrix` gives
//! `[P2 1] * F * [P1 1]' = 0` with points as rows, which is `x2ᵀ F x1 = 0`. `vgg_F_from_P` of the
//! toolbox of Hartley & Zisserman's book agrees. `vgg_gui_F` and `vgg_F_from_7pts_2img` use the
//! transpose.

use std::fmt::Write;

use super::coordinates::{WrittenGeometry, numbers, one_line};
use super::views;
use crate::io::values::Quantity;

fn quoted(text: &str) -> String {
    format!("'{}'", one_line(text).replace('\'', "''"))
}

pub(super) fn write(written: &WrittenGeometry) -> String {
    let mut text = String::new();
    for line in written.preamble() {
        let _ = writeln!(text, "% {line}");
    }
    for (k, image) in written.images.iter().flat_map(|i| i.iter()).enumerate() {
        let name = quoted(&image.name);
        let (number, frame) = (k + 1, image.frame);
        let _ = writeln!(
            text,
            "image{number} = struct('name', {name}, 'width', {}, 'height', {});",
            frame.width, frame.height
        );
    }
    text += &views::as_matlab(written.pictures, written.format.origin());
    for table in written.tables() {
        let symbol = table.quantity.symbol();
        let _ = writeln!(text, "% {}\n{symbol} = [", table.quantity.meaning());
        for row in table.values.chunks(table.columns) {
            let _ = writeln!(text, "   {};", numbers(row, ", "));
        }
        text.push_str("];\n");
        let transposed = match table.quantity {
            Quantity::Fundamental => "F_vgg = F';\n",
            Quantity::Homography1 => "tform1 = H1';\n",
            Quantity::Homography2 => "tform2 = H2';\n",
            _ => "",
        };
        text.push_str(transposed);
    }
    if let Some(check) = written.check {
        let _ = writeln!(
            text,
            "self_check = struct('pairs', {}, 'mean_distance', {:?}, 'max_distance', {:?});",
            check.pairs, check.mean, check.max
        );
    }
    if let Some(trust) = written.trust {
        let (geometry, verdict) = (quoted(&trust.geometry), quoted(&trust.verdict));
        let _ = writeln!(text, "geometry = {geometry};\nverdict = {verdict};");
    }
    for (name, words) in written.words() {
        let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
        let _ = writeln!(text, "{name} = {{{}}};", words.join(", "));
    }
    text
}
