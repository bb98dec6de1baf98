//! Lines that sweep across the left picture, with their motion barcodes.

use crate::app::model::recording::{InspectedBarcodes, Synchronised};
use crate::estimate::{ComparedPencils, LinePairNote, lines_at};
use crate::geometry::{AnchoredLine, FundamentalMatrix, Line};

/// Largest number of lines of a sweep.
const SWEPT: usize = 90;
/// Distance from the anchor at which the turn of a line counts, px.
const TURNED: f64 = 200.0;

/// A line of the left picture and its best partner on the right.
#[derive(Debug)]
pub struct SweptLine {
    pub lines: [AnchoredLine; 2],
    pub compared: InspectedBarcodes,
}

impl SweptLine {
    fn new(lines: [AnchoredLine; 2], recordings: &Synchronised) -> Self {
        Self { lines, compared: recordings.barcodes(&lines) }
    }
}

/// Lines of the left picture with their best partners, in the order of their directions.
#[derive(Debug)]
pub struct Sweep {
    /// Number of the pencil that the lines belong to; `None` for lines near the middle of the picture.
    pub pencil: Option<usize>,
    pub swept: Vec<SweptLine>,
    /// The candidate that led to the result, or the candidate nearest to the result's lines.
    pub held: SweptLine,
}

impl Sweep {
    /// Takes lines through a click, by the number of its pencil. `partners` has the column of each row, `winner` the
    /// place of the candidate to hold. `None` if no line has a partner.
    pub fn through_click(
        number: usize,
        compared: &ComparedPencils,
        partners: &[Option<(usize, f32)>],
        winner: Option<usize>,
        recordings: &Synchronised,
    ) -> Option<Self> {
        let paired: Vec<[usize; 2]> =
            partners.iter().enumerate().filter_map(|(row, partner)| Some([row, (*partner)?.0])).collect();
        let kept = paired.len().min(SWEPT);
        let swept: Vec<SweptLine> = (0..kept)
            .map(|k| paired[k * paired.len() / kept])
            .filter_map(|[row, column]| compared.lines(row, column))
            .map(|lines| SweptLine::new(lines, recordings))
            .collect();
        let held = compared.candidates.get(winner.unwrap_or(0));
        let held = held.map(|candidate| lines_at(&compared.click, candidate.angles));
        let held = held.or(swept.first().map(|first| first.lines))?;
        Some(Self { pencil: Some(number), swept, held: SweptLine::new(held, recordings) })
    }

    /// Takes lines among all. `None` if there are none.
    pub fn of_lines(
        swept: &[LinePairNote],
        candidates: &[LinePairNote],
        result: Option<&FundamentalMatrix>,
        recordings: &Synchronised,
    ) -> Option<Self> {
        let nearest = result.and_then(|f| nearest_pairs(f, candidates).into_iter().next());
        let held = nearest.and_then(|place| candidates.get(place)).or(candidates.first()).or(swept.first())?;
        let held = SweptLine::new(held.lines, recordings);
        let swept = swept.iter().map(|own| SweptLine::new(own.lines, recordings)).collect();
        Some(Self { pencil: None, swept, held })
    }
}

/// Returns the places of candidates by their distance from corresponding lines of a geometry, nearest first.
pub fn nearest_pairs(f: &FundamentalMatrix, candidates: &[LinePairNote]) -> Vec<usize> {
    let away = |own: &LinePairNote| {
        let [line1, line2] = own.lines;
        let (of_f1, of_f2) = (f.line1_from_point2(line2.anchor)?, f.line2_from_point1(line1.anchor)?);
        let off = |line: &AnchoredLine, of_f: &Line| {
            of_f.distance(line.anchor) + TURNED * line.line().angle_to(of_f)
        };
        Some(off(&line1, &of_f1) + off(&line2, &of_f2))
    };
    let mut all: Vec<(f64, usize)> =
        candidates.iter().enumerate().filter_map(|(k, own)| Some((away(own)?, k))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, k)| k).collect()
}
