//! The images and their overlays.

mod film;
mod image_pane;
mod loupe;
pub mod overlays;
pub mod scene;
mod texture;
mod transform;

pub use image_pane::{ImagePane, PanePlace, halves, zoom_asked};
pub use texture::PictureTexture;
pub use transform::Transform;
