//! The table of overlays. A file of its own draws each of them.

use egui::Color32;

use super::{
    Canvas, epipoles, given, hover, hypotheses, lines, matches, next_click, pinned, pointed, points,
    residuals, samples, suggestion, true_lines, true_matches, uncertainty,
};
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;

pub struct Overlay {
    pub id: OverlayId,
    pub tooltip: &'static str,
    pub color: Color32,
    /// Whether the loupe shows the overlay, because it helps to place a point.
    pub magnified: bool,
    /// Function that draws the overlay on one image.
    pub draw: fn(&Canvas),
}

/// All overlays from bottom to top, in the order of [`OverlayId`].
pub const OVERLAYS: [Overlay; OverlayId::COUNT] = [
    Overlay {
        id: OverlayId::Uncertainty,
        tooltip: "Uncertainty of each epipolar line and epipole: two standard deviations, from the matches. \
                  Often narrower than the line until you zoom in.",
        color: theme::BAND,
        magnified: true,
        draw: uncertainty::draw,
    },
    Overlay {
        id: OverlayId::Lines,
        tooltip: "Evenly spaced lines. A point of a line has its match on the line with the same number in the other image. \
                  The selected pair has a line of its own.",
        color: theme::ESTIMATED,
        magnified: true,
        draw: lines::draw,
    },
    Overlay {
        id: OverlayId::TrueLines,
        tooltip: "True lines through the same places as the numbered lines, and of the cursor, from the ground truth. Dashed, \
                  so that an estimated line below shows through.",
        color: theme::TRUE,
        magnified: true,
        draw: true_lines::draw,
    },
    Overlay {
        id: OverlayId::CursorLine,
        tooltip: "The line in the other image on which the match of the point under the cursor lies.",
        color: theme::HOVER,
        magnified: true,
        draw: hover::draw,
    },
    Overlay {
        id: OverlayId::Pinned,
        tooltip: "Line pairs pinned with the pin tool, with their numbers where there is room. Right-click a line to \
                  see its number.",
        color: theme::PINNED,
        magnified: true,
        draw: pinned::draw,
    },
    Overlay {
        id: OverlayId::Samples,
        tooltip: "Matched samples along the pinned line pair. Dots of the same colour match.",
        color: theme::HOVER,
        magnified: false,
        draw: samples::draw,
    },
    Overlay {
        id: OverlayId::TrueMatches,
        tooltip: "Points whose match in the other image is known. Point at one to see its match. At most 300 \
                  are drawn.",
        color: theme::TRUE,
        magnified: false,
        draw: true_matches::draw,
    },
    Overlay {
        id: OverlayId::Given,
        tooltip: "Imported matches: violet rings fit the geometry to 1 px, red ones do not. At most 2,000 are drawn.",
        color: theme::UNCHECKED,
        magnified: false,
        draw: given::draw,
    },
    Overlay {
        id: OverlayId::Matches,
        tooltip: "Patches that the refinement matched along the epipolar lines. The geometry is fitted to them.",
        color: theme::UNCHECKED,
        magnified: true,
        draw: matches::draw,
    },
    Overlay {
        id: OverlayId::MagnifiedResiduals,
        tooltip: "Distance from each refined match to its epipolar line, magnified 50 times: 1 pixel is drawn \
                  as 50 pixels.",
        color: theme::UNCHECKED,
        magnified: false,
        draw: residuals::draw,
    },
    Overlay {
        id: OverlayId::Hypotheses,
        tooltip: "Epipoles of the hypotheses, the best ones brightest. An arrow at the edge points to an \
                  epipole outside.",
        color: theme::UNCHECKED,
        magnified: false,
        draw: hypotheses::draw,
    },
    Overlay {
        id: OverlayId::Epipoles,
        tooltip: "Position of the other camera in this image, where all epipolar lines meet. White: epipole of \
                  the ground truth.",
        color: theme::ESTIMATED,
        magnified: false,
        draw: epipoles::draw,
    },
    Overlay {
        id: OverlayId::PointedAt,
        tooltip: "The item under the cursor in a table, a matrix or a plot, highlighted in the images.",
        color: theme::SELECTED,
        magnified: false,
        draw: pointed::draw,
    },
    Overlay {
        id: OverlayId::Suggestion,
        tooltip: "After the first click of a pair: the most similar places in the other image. The number is the \
                  correlation of their surroundings with those of the click, 1 for equal ones. Enter accepts a \
                  clear match.",
        color: theme::UNCHECKED,
        magnified: true,
        draw: suggestion::draw,
    },
    Overlay {
        id: OverlayId::NextClick,
        tooltip: "The place in the left image where one more pair would help most, while the result is doubtful.",
        color: theme::SELECTED,
        magnified: false,
        draw: next_click::draw,
    },
    Overlay {
        id: OverlayId::Points,
        tooltip: "The clicked points: p cyan, q pink, others light. Squares only check, and ! marks a \
                  pair that the images contradict.",
        color: theme::PAIRS[0],
        magnified: false,
        draw: points::draw,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_overlay_is_in_its_place() {
        assert!(OVERLAYS.iter().map(|overlay| overlay.id).eq(OverlayId::ALL));
    }
}
