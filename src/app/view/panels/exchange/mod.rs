//! Dialogs for files of other programs.

mod export;
mod reading;

pub use export::FileExport;
pub use reading::ReadingDialog;
