//! The windows in front of the window.

use std::path::Path;

use egui::Context;

use super::panels::{
    CommandPalette, ExportDialog, FileExport, OpenDialog, ReadingDialog, RelocateDialog, SaveDialog,
    shortcuts,
};
use crate::app::model::Model;
use crate::app::model::command::{Command, PickPurpose};

/// All of them, open or not.
#[derive(Default)]
pub struct Dialogs {
    /// Dialog for opening files.
    pub open: OpenDialog,
    /// Dialog for saving the session.
    pub save: Option<SaveDialog>,
    /// Dialog for the images of a session that are not where they were.
    pub relocate: Option<RelocateDialog>,
    /// Dialog for writing the rectified pair.
    pub rectified: ExportDialog,
    /// Dialog for files of other programs.
    pub export: FileExport,
    /// How an imported matrix is meant.
    pub reading: Option<ReadingDialog>,
    /// The list of all commands.
    pub palette: CommandPalette,
    /// The list of keys and mouse actions.
    pub shortcuts: bool,
}

impl Dialogs {
    /// Whether one is open that takes what is typed.
    pub fn is_open(&self) -> bool {
        self.open.open
            || self.rectified.open
            || self.export.open
            || self.palette.open
            || self.save.is_some()
            || self.relocate.is_some()
            || self.reading.is_some()
    }

    /// Closes the topmost one; says whether there was one.
    pub fn close_top(&mut self) -> bool {
        std::mem::take(&mut self.palette.open)
            || self.relocate.take().is_some()
            || self.save.take().is_some()
            || std::mem::take(&mut self.open.open)
            || self.reading.take().is_some()
            || std::mem::take(&mut self.rectified.open)
            || std::mem::take(&mut self.export.open)
            || std::mem::take(&mut self.shortcuts)
    }

    /// Fills in what was chosen with the system's dialog.
    pub fn offer(&mut self, purpose: &PickPurpose, path: &Path) {
        match purpose {
            PickPurpose::Image(side) => drop(self.open.offer(path, Some(*side))),
            PickPurpose::Folder => self.open.offer_folder(path),
            PickPurpose::Import => self.open.offer_import(path),
            PickPurpose::Export => self.rectified.offer(path),
            PickPurpose::ExportFile(_) => self.export.offer(path),
            PickPurpose::Session(_) => self.save.iter_mut().for_each(|dialog| dialog.offer(path)),
            PickPurpose::Lost(side) => self.relocate.iter_mut().for_each(|dialog| dialog.offer(*side, path)),
        }
    }

    /// Shows those that are open.
    pub fn show(&mut self, ctx: &Context, model: &Model, commands: &mut Vec<Command>) {
        self.open.show(ctx, model, commands);
        self.save.take_if(|dialog| !dialog.show(ctx, commands));
        self.relocate.take_if(|dialog| !dialog.show(ctx, commands));
        self.rectified.show(ctx, commands);
        self.export.show(ctx, model, commands);
        self.reading.take_if(|dialog| !dialog.show(ctx, commands));
        self.palette.show(ctx, model, commands);
        if self.shortcuts {
            shortcuts(ctx, &mut self.shortcuts);
        }
    }
}
