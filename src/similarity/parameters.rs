//! Parameters of the stereo cost (paper, equation 1).

use serde::{Deserialize, Serialize};

/// The disparity changes allowed from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ordering {
    /// Matched positions `i + dᵢ` never decrease: `dᵢ₊₁ ≥ dᵢ − 1`. The usual ordering constraint of
    /// stereo.
    #[default]
    Positions,
    /// Disparities may change by any amount.
    Free,
    /// Disparities never decrease, `dᵢ₊₁ ≥ dᵢ`, as printed in the paper. The constraint also
    /// forbids surfaces that approach along the line.
    Disparities,
}

/// Range of the disparities tried, in samples: `min ..= max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisparityRange {
    /// Smallest disparity.
    pub min: i32,
    /// Largest disparity.
    pub max: i32,
}

impl DisparityRange {
    /// Creates the range `−reach ..= reach`.
    pub fn symmetric(reach: i32) -> Self {
        Self { min: -reach, max: reach }
    }

    /// Returns the number of disparities.
    pub fn len(&self) -> usize {
        (self.max - self.min + 1).max(0) as usize
    }

    /// Returns whether the range holds no disparity.
    pub fn is_empty(&self) -> bool {
        self.max < self.min
    }

    /// Returns the range with the lines exchanged.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { min: -self.max, max: -self.min }
    }
}

/// Parameters of the stereo cost. Costs are in squared grey levels.
///
/// `C(d) = Σ min((I₁(i) − I₂(i + dᵢ))², r) + Σ min(λ (dᵢ − dᵢ₋₁)², α)`. A sample whose match falls
/// outside the other image pays `outside` instead of its first term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StereoParameters {
    /// Largest cost of one sample, r, squared grey levels.
    pub truncation: u16,
    /// Cost of a disparity change of one sample, λ, squared grey levels.
    pub lambda: u16,
    /// Largest cost of a disparity change, α, squared grey levels.
    pub alpha: u16,
    /// Cost of a sample whose match falls outside the other image, squared grey levels.
    pub outside: u16,
    /// Allowed disparity changes.
    pub ordering: Ordering,
}

/// The measure by which two lines are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineMeasure {
    /// Stereo matching of the intensities along the lines.
    #[default]
    Stereo,
    /// Motion barcodes: the frames of two synchronised sequences in which moving objects cross the
    /// lines.
    Barcodes,
}

/// Parameters of the line similarity of two images.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SimilarityParameters {
    /// Measure by which two lines are compared.
    #[serde(default)]
    pub measure: LineMeasure,
    /// Parameters of the stereo cost.
    pub stereo: StereoParameters,
    /// Largest disparity tried in either direction, as a fraction of the longer image side.
    pub disparity_reach: f64,
}

impl StereoParameters {
    /// The published values: r = 50², λ = 2, α = 3.
    pub const PAPER: Self =
        Self { truncation: 2500, lambda: 2, alpha: 3, outside: 300, ordering: Ordering::Positions };

    /// Returns the cost of the largest disparity changes: α, and 0 where λ = 0.
    pub fn jump_cost(&self) -> u16 {
        if self.lambda == 0 { 0 } else { self.alpha }
    }

    /// Returns the number of disparity changes with a cost of their own: those with `λ Δ² < α` and Δ ≥ 1 that `range`
    /// has. All larger ones cost [`StereoParameters::jump_cost`].
    pub fn explicit_changes(&self, range: DisparityRange) -> usize {
        let differs = |d: &usize| u64::from(self.lambda) * (*d as u64).pow(2) < u64::from(self.jump_cost());
        (1..range.len()).take_while(differs).count()
    }

    /// Returns ψ, the cost of a disparity change by `change` samples. Returns `None` when the
    /// ordering forbids the change.
    pub fn change_cost(&self, change: i32) -> Option<u16> {
        let allowed = match self.ordering {
            Ordering::Positions => change >= -1,
            Ordering::Free => true,
            Ordering::Disparities => change >= 0,
        };
        let quadratic = u64::from(self.lambda) * u64::from(change.unsigned_abs()).pow(2);
        allowed.then(|| quadratic.min(u64::from(self.alpha)) as u16)
    }

    /// Returns φ, the cost of matching a sample with a sample or with the outside of the other
    /// image.
    pub fn sample_cost(&self, a: u8, b: Option<u8>) -> u16 {
        match b {
            Some(b) => (u16::from(a.abs_diff(b)) * u16::from(a.abs_diff(b))).min(self.truncation),
            None => self.outside,
        }
    }
}

impl Default for StereoParameters {
    fn default() -> Self {
        Self::PAPER
    }
}
