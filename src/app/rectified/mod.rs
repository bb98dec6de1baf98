//! The rectified pair in the window: made (`making`), looked at (`viewing`) and written (`writing`), by commands of its own
//! (`command`).

mod command;
mod making;
mod viewing;
mod writing;

pub use command::RectifiedCommand;
pub use making::{Drawn, Matches, Question, Rectified, Rectifying, Sheet};
pub use viewing::{Blink, Guides, Layout, RectifiedLook, RectifiedView, Viewing};
pub use writing::{Order, Progress, Writing};
