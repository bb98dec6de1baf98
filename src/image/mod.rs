//! Pictures in memory: loading, grey planes, pyramids and samples along lines.

mod alignment;
mod corners;
mod decode;
mod deep_tiff;
mod fixed;
mod limit;
mod load;
mod load_error;
mod luma;
mod options;
mod pair;
mod patch;
mod patch_block;
mod plane;
mod pyramid;
mod sampling;
mod tiff_header;
mod webp;
mod whole;

pub(crate) use alignment::{Alignment, LEAST_INSIDE, Placement, align};
pub use corners::find_corners;
pub use limit::MEGAPIXELS_VARIABLE;
pub use load::Picture;
pub use load_error::LoadError;
pub use options::LoadOptions;
pub use pair::{PairLevel, PyramidPair, RelativeView};
pub(crate) use patch::{HALF, Patch, PatchSampler, Warp, correlation, offsets, warps_around};
pub(crate) use patch_block::{PatchBlock, Sketch, correlations, may_correlate, most_correlations};
pub use plane::GrayPlane;
pub(crate) use plane::interpolate_all;
pub use pyramid::Pyramid;
pub use sampling::Profile;
