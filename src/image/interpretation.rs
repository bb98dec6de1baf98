//! How the pixels of a picture file were understood.

use serde::{Deserialize, Serialize};

/// Meaning of the pixels of a file, as far as the file leaves it open.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Interpretation {
    /// Numbers of the file that are black and white, for pixels of more than 8 bits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// Fraction of the pixels that are no picture: missing data or transparent, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub masked: Option<f64>,
    /// Number of bands of the file, if only the first one is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<u16>,
}
