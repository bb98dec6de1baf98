//! Pictures in memory: loading, grey planes, pyramids and samples along lines.

mod alignment;
mod corners;
mod load;
mod pair;
mod patch;
mod plane;
mod pyramid;
mod sampling;

pub(crate) use alignment::{Alignment, LEAST_INSIDE, Placement, align, offsets};
pub use corners::find_corners;
pub use load::{LoadError, Picture};
pub use pair::{PairLevel, PyramidPair, RelativeView};
pub(crate) use patch::{HALF, Patch, Warp, correlate_all, patch, warps_around};
pub use plane::GrayPlane;
pub use pyramid::Pyramid;
pub use sampling::Profile;
