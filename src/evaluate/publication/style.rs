//! Colours and strokes shared by all figures.

use super::ReportSubject;
use crate::publish::plot::{COLORS, Stroke};

/// Colour of true lines on a picture.
pub(super) const TRUE: &str = "#4d94ff";
/// Colour of estimated lines on a picture.
pub(super) const ESTIMATED: &str = "#1acc8c";
/// Colours of the clicks p, q and r.
pub(super) const CLICKS: [&str; 3] = ["#f0a000", "#f080be", "#56b4e9"];
/// Colour of further clicks.
pub(super) const FURTHER_CLICK: &str = "#e1e1e1";
/// Colours of the profiles of image 1 and image 2.
pub(super) const PROFILES: [&str; 2] = ["#1a1a1a", "#d55e00"];

/// Returns the stroke of a contender: a colour per method and preset, dashed if refinement differs
/// from the preset.
pub(super) fn stroke(subject: &ReportSubject, contender: usize) -> Stroke {
    let kind = |c: usize| {
        let contender = &subject.contenders[c];
        (contender.method(), contender.preset().and_then(|preset| preset.split(' ').next()))
    };
    let mut kinds: Vec<_> = Vec::new();
    for other in 0..=contender {
        if !kinds.contains(&kind(other)) {
            kinds.push(kind(other));
        }
    }
    let place = kinds.iter().position(|k| *k == kind(contender)).unwrap_or(0);
    let dashed = subject.contenders[contender].preset().is_some_and(|preset| preset.contains(' '));
    Stroke { color: COLORS[place % COLORS.len()], width: 1.8, dashed }
}

/// Returns the name of a click: p, q and r, then numbers.
pub(super) fn click_name(click: usize) -> String {
    ["p", "q", "r"].get(click).map_or_else(|| (click + 1).to_string(), |name| (*name).to_owned())
}
