//! The rectified pair: how it is made (`making`), how it is looked at (`viewing`), and what can be done with it.

mod command;
mod disparity;
mod making;
mod misfit;
mod viewing;

pub use command::{RectifiedCommand, RectifyOrder, WritingProgress};
pub use disparity::DisparityMap;
pub use making::{DrawnPair, MatchesAtHand, Rectified, RectifiedSheet, RectifyQuestion};
pub use viewing::{Blink, Guides, RectifiedLayout, RectifiedLook, RectifiedView, Viewing};
