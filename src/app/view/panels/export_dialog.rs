//! The dialog for exporting the rectified pair.

use std::path::{Path, PathBuf};

use egui::{DragValue, Ui};

use super::dialog::{PathField, dialog, ending, path_of, row_label};
use crate::app::model::command::Command;
use crate::app::model::rectified::RectifiedCommand;
use crate::io::{PictureFormat, RectifiedOptions};

/// Choices of the dialog, kept for the next time.
#[derive(Debug, Clone)]
pub struct ExportDialog {
    pub open: bool,
    folder: String,
    /// Name of the folder for the pair that the dialog was shown for.
    pair: PathBuf,
    options: RectifiedOptions,
    just_opened: bool,
}

impl Default for ExportDialog {
    fn default() -> Self {
        let options = RectifiedOptions { format: PictureFormat::Png, guide_spacing: 40, maps: false };
        Self { open: false, folder: String::new(), pair: PathBuf::new(), options, just_opened: false }
    }
}

impl ExportDialog {
    /// Opens the dialog for a pair. It suggests a folder named after the pair, beside the folder of the pair
    /// before, or else in the documents of the user. The folder of the same pair stays.
    pub fn show_with(&mut self, pair: PathBuf) {
        (self.open, self.just_opened) = (true, true);
        if self.pair == pair && !self.folder.trim().is_empty() {
            return;
        }
        let before = path_of(&self.folder).and_then(|folder| folder.parent().map(Path::to_owned));
        self.folder = before.unwrap_or_else(documents).join(&pair).display().to_string();
        self.pair = pair;
    }

    /// Fills in a chosen folder.
    pub fn offer(&mut self, folder: &Path) {
        self.folder = folder.display().to_string();
    }

    /// Shows the dialog if open.
    pub fn show(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let open = dialog(ctx, "Export rectified pair", 520.0, |ui| {
            ui.weak(
                "Writes both pictures at full size, one picture of both with guide lines, and \
                 rectification.json.",
            );
            ui.add_space(6.0);
            let folder = PathField {
                name: "Folder",
                hint: "path of the folder, created if missing",
                width: 330.0,
                browse: "Browse for the export folder",
                command: RectifiedCommand::Browse.into(),
            };
            let folder = folder.show(ui, &mut self.folder, commands);
            if self.just_opened {
                folder.request_focus();
            }
            self.choices(ui);
            ui.add_space(2.0);
            ui.weak("Existing files of the same names are replaced.");
            ui.add_space(6.0);
            let folder = path_of(&self.folder);
            let options = self.options;
            let export = |folder| RectifiedCommand::Export { folder, options }.into();
            let described = export(PathBuf::new());
            ui.horizontal(|ui| ending(ui, "Export rectified pair", folder.map(export), described, commands));
        });
        self.just_opened = false;
        self.open &= open;
    }

    fn choices(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            row_label(ui, "Pictures");
            for (format, name, tooltip) in [
                (PictureFormat::Png, "PNG", "8 or 16 bits with transparency. Every program reads PNG."),
                (PictureFormat::Tiff, "TIFF", "8 or 16 bits or floating point, with transparency."),
            ] {
                ui.radio_value(&mut self.options.format, format, name).on_hover_text(tooltip);
            }
        });
        ui.horizontal(|ui| {
            let label = row_label(ui, "Guide lines");
            let value = DragValue::new(&mut self.options.guide_spacing)
                .range(0..=1000)
                .prefix("every ")
                .suffix(" rows");
            ui.add(value)
                .labelled_by(label.id)
                .on_hover_text("Rows between two guide lines in the picture of both. 0 draws none.");
        });
        ui.horizontal(|ui| {
            row_label(ui, "Maps");
            ui.checkbox(
                &mut self.options.maps,
                "Source position of each pixel, as .npy arrays for cv2.remap",
            )
            .on_hover_text(
                "Rows × columns × (x, y) in pixels of the original image, as 32-bit floats. Empty pixels \
                 have (-1, -1).",
            );
        });
    }
}

/// Returns the folder for documents, or else the folder of the user.
fn documents() -> PathBuf {
    let home = std::env::home_dir().unwrap_or_default();
    let documents = home.join("Documents");
    if documents.is_dir() { documents } else { home }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pair_has_a_folder_of_its_own_beside_the_folder_used_before() {
        let mut dialog = ExportDialog::default();
        dialog.show_with("a-b-rectified".into());
        assert_eq!(Path::new(&dialog.folder), documents().join("a-b-rectified"));
        let used = Path::new("used").join("mine");
        dialog.offer(&used);
        dialog.show_with("a-b-rectified".into());
        assert_eq!(Path::new(&dialog.folder), used, "the same pair");
        dialog.show_with("c-d-rectified".into());
        assert_eq!(Path::new(&dialog.folder), Path::new("used").join("c-d-rectified"));
    }
}
