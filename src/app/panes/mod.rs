//! The images, and what is drawn over them.

mod image_pane;
pub mod overlays;
mod texture;
mod view;

pub use image_pane::{ImagePane, halves};
pub use texture::Overview;
pub use view::Transform;
