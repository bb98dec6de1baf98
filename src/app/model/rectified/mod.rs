//! The rectified pair: drawing (`making`), way of viewing (`viewing`) and commands.

mod command;
mod making;
mod misfit;
mod viewing;

pub use command::{RectifiedCommand, RectifyOrder, WritingProgress};
#[cfg(test)]
pub use making::example;
pub use making::{DrawnPair, MatchesAtHand, Rectified, RectifiedSheet, RectifyQuestion};
pub use viewing::{Blink, RectifiedLayout, RectifiedLook, RectifiedView, Viewing, guide_spacing};
