//! Presentation of the model. The view reads the model and returns commands.

pub mod actions;
mod capture;
pub mod dialogs;
mod figure;
mod heat;
mod keyboard;
mod layout;
mod panels;
mod panes;
mod system_fonts;
pub mod theme;

pub use capture::{Destination, WantedView, excerpt, screen_as_png};
pub use figure::figure;
pub use keyboard::{KeyboardState, makes_sense, pressed};
pub use layout::View;
pub use panels::{FocalDialog, OpenDialog, ReadingDialog, RelocateDialog, SaveDialog};
pub use panes::ImagePane;
pub use system_fonts::SystemFonts;
