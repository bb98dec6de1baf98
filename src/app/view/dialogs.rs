//! The dialogs in front of the window.

use std::path::Path;

use egui::Context;

use super::panels::{
    CommandPalette, FileExport, FocalDialog, OpenDialog, ReadingDialog, RelocateDialog, SaveDialog, shortcuts,
};
use crate::app::model::command::PickPurpose;
use crate::app::model::{Command, Model};

#[derive(Default)]
pub struct Dialogs {
    pub open: OpenDialog,
    pub save: Option<SaveDialog>,
    /// Dialog for the images of a session that are missing or have changed.
    pub relocate: Option<RelocateDialog>,
    pub export: FileExport,
    /// Dialog for the convention of an imported matrix.
    pub reading: Option<ReadingDialog>,
    pub focal: Option<FocalDialog>,
    pub palette: CommandPalette,
    /// The list of keys and mouse actions.
    pub shortcuts: bool,
}

impl Dialogs {
    /// Returns whether a dialog that takes keyboard input is open.
    pub fn is_open(&self) -> bool {
        self.open.open
            || self.export.open
            || self.palette.open
            || self.save.is_some()
            || self.relocate.is_some()
            || self.reading.is_some()
            || self.focal.is_some()
    }

    /// Closes the topmost dialog. Returns whether there was one.
    pub fn close_top(&mut self) -> bool {
        std::mem::take(&mut self.palette.open)
            || self.relocate.take().is_some()
            || self.save.take().is_some()
            || std::mem::take(&mut self.open.open)
            || self.reading.take().is_some()
            || self.focal.take().is_some()
            || std::mem::take(&mut self.export.open)
            || std::mem::take(&mut self.shortcuts)
    }

    /// Fills in the path chosen in the system dialog.
    pub fn offer(&mut self, purpose: &PickPurpose, path: &Path) {
        match purpose {
            PickPurpose::Image(side) => drop(self.open.offer(path, Some(*side))),
            PickPurpose::Folder => self.open.offer_folder(path),
            PickPurpose::Import => self.open.offer_import(path),
            PickPurpose::Export | PickPurpose::ExportFile(_) => self.export.offer(path),
            PickPurpose::Database => self.export.offer_database(path),
            PickPurpose::Session(_) => self.save.iter_mut().for_each(|dialog| dialog.offer(path)),
            PickPurpose::Lost(side) => self.relocate.iter_mut().for_each(|dialog| dialog.offer(*side, path)),
        }
    }

    pub fn show(&mut self, ctx: &Context, model: &Model, commands: &mut Vec<Command>) {
        self.open.show(ctx, model, commands);
        self.save.take_if(|dialog| !dialog.show(ctx, commands));
        self.relocate.take_if(|dialog| !dialog.show(ctx, commands));
        self.export.show(ctx, model, commands);
        self.reading.take_if(|dialog| !dialog.show(ctx, commands));
        self.focal.take_if(|dialog| !dialog.show(ctx, commands));
        self.palette.show(ctx, model, commands);
        self.shortcuts &= !self.is_open();
        if self.shortcuts {
            shortcuts(ctx, &mut self.shortcuts);
        }
    }
}
