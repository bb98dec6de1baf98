//! Pictures in memory: loading, grey planes, pyramids and samples along lines.

mod alignment;
mod alignment_equations;
mod alignment_settings;
#[cfg(feature = "pictures")]
mod brightness;
mod corners;
#[cfg(feature = "pictures")]
mod decode;
#[cfg(feature = "pictures")]
mod fill;
mod fixed;
#[cfg(feature = "pictures")]
mod foreign_format;
mod interpretation;
#[cfg(all(test, feature = "pictures"))]
mod kinds_tests;
#[cfg(feature = "pictures")]
mod limit;
#[cfg(feature = "pictures")]
mod load;
#[cfg(feature = "pictures")]
mod load_error;
#[cfg(feature = "pictures")]
mod luma;
#[cfg(feature = "pictures")]
mod numbers;
#[cfg(feature = "pictures")]
mod options;
mod pair;
mod patch;
mod patch_block;
mod plane;
mod pyramid;
#[cfg(feature = "inspector")]
mod rendition;
mod sampling;
#[cfg(feature = "pictures")]
mod tiff_file;
#[cfg(feature = "pictures")]
mod tiff_header;
#[cfg(feature = "pictures")]
mod tiff_overlay;
#[cfg(feature = "pictures")]
mod tiff_tags;
mod validity;
#[cfg(feature = "pictures")]
mod warp;
#[cfg(feature = "pictures")]
mod webp;
#[cfg(feature = "pictures")]
mod whole;

pub(crate) use alignment::{Placement, align};
pub(crate) use alignment_settings::{Alignment, LEAST_INSIDE};
pub use corners::find_corners;
pub use interpretation::Interpretation;
#[cfg(feature = "pictures")]
pub use limit::MEGAPIXELS_VARIABLE;
#[cfg(feature = "pictures")]
pub use load::Picture;
#[cfg(feature = "pictures")]
pub use load_error::LoadError;
#[cfg(feature = "pictures")]
pub use options::LoadOptions;
pub use pair::{PairLevel, PyramidPair, RelativeView};
pub(crate) use patch::{HALF, Patch, PatchSampler, Warp, correlation, offsets, warps_around};
pub(crate) use patch_block::{PatchBlock, Sketch, correlations, may_correlate, most_correlations};
pub use plane::GrayPlane;
pub(crate) use plane::interpolate_all;
pub use pyramid::Pyramid;
#[cfg(feature = "inspector")]
#[doc(hidden)]
pub use rendition::Rendition;
pub use sampling::Profile;
#[cfg(feature = "pictures")]
pub(crate) use warp::{PixelMap, warp};
