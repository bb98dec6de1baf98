//! The images and their overlays.

mod chip;
mod film;
mod image_pane;
mod loupe;
pub mod overlays;
pub mod scene;
mod texture;
mod transform;

pub use chip::label;
pub use image_pane::{ImagePane, PanePlace};
pub use texture::PictureTexture;
pub use transform::{Transform, halves, zoom_asked};
