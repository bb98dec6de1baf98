//! Parameters of the stereo cost (paper, equation 1).

use serde::{Deserialize, Serialize};

/// Which changes of disparity from one sample to the next are allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ordering {
    /// Matched positions `i + dᵢ` never go back: `dᵢ₊₁ ≥ dᵢ − 1`. The usual ordering constraint of stereo.
    #[default]
    Positions,
    /// Changes of any size.
    Free,
    /// `dᵢ₊₁ ≥ dᵢ`, as the paper prints it. It also forbids surfaces that come nearer along the line.
    Disparities,
}

/// Disparities that are tried, in samples: `min ..= max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisparityRange {
    /// Smallest disparity.
    pub min: i32,
    /// Largest disparity.
    pub max: i32,
}

impl DisparityRange {
    /// `−reach ..= reach`.
    pub fn symmetric(reach: i32) -> Self {
        Self { min: -reach, max: reach }
    }

    /// Number of disparities.
    pub fn len(&self) -> usize {
        (self.max - self.min + 1).max(0) as usize
    }

    /// Whether nothing is allowed.
    pub fn is_empty(&self) -> bool {
        self.max < self.min
    }

    /// The range seen from the other line.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { min: -self.max, max: -self.min }
    }
}

/// The numbers of the stereo cost. Costs are in squared grey levels.
///
/// `C(d) = Σ min((I₁(i) − I₂(i + dᵢ))², r) + Σ min(λ (dᵢ − dᵢ₋₁)², α)`, and a sample whose match falls outside
/// the other image pays `outside` instead of its first term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StereoParameters {
    /// r: largest cost of one sample, squared grey levels.
    pub truncation: u16,
    /// λ: cost of a disparity change of one sample, squared grey levels.
    pub lambda: u16,
    /// α: largest cost of a disparity change, squared grey levels.
    pub alpha: u16,
    /// Cost of a sample whose match falls outside the other image, squared grey levels.
    pub outside: u16,
    /// Which disparity changes are allowed.
    pub ordering: Ordering,
}

/// What two lines are compared by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineMeasure {
    /// Stereo matching of the intensities along them.
    #[default]
    Stereo,
    /// Motion barcodes: in which frames of two synchronised sequences something moves across them.
    Barcodes,
}

/// What the similarity of lines of two images depends on besides the images.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SimilarityParameters {
    /// What two lines are compared by.
    #[serde(default)]
    pub measure: LineMeasure,
    /// The numbers of the stereo cost.
    pub stereo: StereoParameters,
    /// Largest disparity tried, as a fraction of the longer image side, either way.
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

    /// ψ: cost of a change of disparity by `change` samples; `None` when the ordering forbids it.
    pub fn change_cost(&self, change: i32) -> Option<u16> {
        let allowed = match self.ordering {
            Ordering::Positions => change >= -1,
            Ordering::Free => true,
            Ordering::Disparities => change >= 0,
        };
        let quadratic = u64::from(self.lambda) * u64::from(change.unsigned_abs()).pow(2);
        allowed.then(|| quadratic.min(u64::from(self.alpha)) as u16)
    }

    /// φ: cost of matching a sample with a sample, or with the outside of the other image.
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
