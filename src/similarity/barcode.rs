//! Motion barcodes of lines as a similarity (paper, section 2.3).

use std::sync::Arc;

use rayon::prelude::*;

use super::{CostMatrix, LineSimilarity, ScaledSimilarity, SimilaritySource};
use crate::geometry::{AnchoredLine, Frame};
use crate::motion::{Barcode, Silhouettes};

/// Two synchronised sequences of static cameras, compared by the motion barcodes of lines.
pub struct BarcodeSource {
    /// Silhouettes of the moving objects in each sequence, with the same number of frames.
    pub silhouettes: [Arc<Silhouettes>; 2],
}

impl SimilaritySource for BarcodeSource {
    fn at(&self, side: f64) -> ScaledSimilarity<'_> {
        let full = [0, 1].map(|image| self.silhouettes[image].full_size());
        let scale = (side / full[0].longer_side()).min(1.0);
        let frames = full.map(|frame| {
            Frame::new(
                ((frame.width as f64 * scale).round() as usize).max(1),
                ((frame.height as f64 * scale).round() as usize).max(1),
            )
        });
        let scales = [0, 1].map(|image| frames[image].width as f64 / full[image].width as f64);
        let to_mask = |image: usize| frames[image].width as f64 / self.silhouettes[image].size().width as f64;
        let lines = BarcodeSimilarity {
            silhouettes: [&self.silhouettes[0], &self.silhouettes[1]],
            scales: [to_mask(0), to_mask(1)],
        };
        ScaledSimilarity { lines: Box::new(lines), frames, scales }
    }
}

/// A similarity of lines by motion barcodes. The cost is 1 minus the lower bound of the normalised
/// cross-correlation ([`Barcode::least_correlation`]), 0 to 2.
pub struct BarcodeSimilarity<'a> {
    /// Silhouettes of the moving objects in each sequence.
    pub silhouettes: [&'a Silhouettes; 2],
    /// Size of the images in which lines are given, over the size of the masks.
    pub scales: [f64; 2],
}

/// Cost of unrelated lines.
const UNRELATED: f32 = 1.0;

impl BarcodeSimilarity<'_> {
    fn barcode(&self, image: usize, line: &AnchoredLine) -> Barcode {
        self.silhouettes[image].barcode(line, self.scales[image])
    }

    fn barcodes(&self, image: usize, lines: &[AnchoredLine]) -> Vec<Barcode> {
        lines.par_iter().map(|line| self.barcode(image, line)).collect()
    }
}

fn cost(a: &Barcode, b: &Barcode) -> f32 {
    a.least_correlation(b).map_or(f32::INFINITY, |correlation| 1.0 - correlation as f32)
}

impl LineSimilarity for BarcodeSimilarity<'_> {
    fn pair_costs(&self, pairs: &[(AnchoredLine, AnchoredLine)]) -> Vec<f32> {
        pairs
            .par_iter()
            .map(|(line1, line2)| cost(&self.barcode(0, line1), &self.barcode(1, line2)))
            .collect()
    }

    fn cost_matrix(
        &self,
        lines1: &[AnchoredLine],
        lines2: &[AnchoredLine],
        allowed: &(dyn Fn(usize, usize) -> bool + Sync),
        stop: &(dyn Fn() -> bool + Sync),
    ) -> CostMatrix {
        let (barcodes1, barcodes2) = (self.barcodes(0, lines1), self.barcodes(1, lines2));
        let mut costs = vec![f32::INFINITY; lines1.len() * lines2.len()];
        if !lines2.is_empty() {
            costs.par_chunks_mut(lines2.len()).enumerate().for_each(|(i, row)| {
                if stop() {
                    return;
                }
                for j in (0..row.len()).filter(|j| allowed(i, *j)) {
                    row[j] = cost(&barcodes1[i], &barcodes2[j]);
                }
            });
        }
        CostMatrix::new(lines1.len(), lines2.len(), costs)
    }

    /// Returns the standard deviation of the bits of each line's barcode, 0 to 1/2; 0 for a nearly
    /// constant barcode. Correlations of many line pairs, weighted by both deviations, give the
    /// correlation of all their bits.
    fn information(&self, image: usize, lines: &[AnchoredLine]) -> Vec<f64> {
        self.barcodes(image, lines).iter().map(|barcode| barcode.variance().sqrt()).collect()
    }

    fn outside_cost(&self) -> f32 {
        UNRELATED
    }
}
