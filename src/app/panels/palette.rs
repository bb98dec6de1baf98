//! The list of every command, to search and run by name.

use egui::{Align2, Key, Modifiers, RichText, ScrollArea, TextEdit, Ui, Window, vec2};

use super::finish_button;
use crate::app::command::Command;
use crate::app::comparison::Contestant;
use crate::app::exchange::ExchangeCommand;
use crate::app::keyboard::key_text;
use crate::app::panes::overlays::OVERLAYS;
use crate::app::rectified::{Layout, RectifiedCommand};
use crate::app::scene::Scene;
use crate::estimate::{Method, Preset};
use crate::evaluate::Protocol;
use crate::rectify;

/// What has been typed and which entry is marked.
#[derive(Debug, Clone, Default)]
pub struct CommandPalette {
    /// Whether it is shown.
    pub open: bool,
    text: String,
    marked: usize,
    just_opened: bool,
}

/// A command that can be run now.
struct Entry {
    title: String,
    command: Command,
}

impl CommandPalette {
    /// Shows it, empty.
    pub fn show_empty(&mut self) {
        *self = Self { open: true, just_opened: true, ..Self::default() };
    }

    /// Shows the window.
    pub fn show(&mut self, ctx: &egui::Context, scene: &Scene, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let keys = |key| ctx.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        let (up, down, run) = (keys(Key::ArrowUp), keys(Key::ArrowDown), keys(Key::Enter) > 0);
        let mut open = true;
        Window::new("Commands")
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .anchor(Align2::CENTER_TOP, vec2(0.0, 90.0))
            .show(ctx, |ui| {
                ui.set_width(460.0);
                let edit = TextEdit::singleline(&mut self.text)
                    .hint_text("Type a few letters of a command")
                    .desired_width(f32::INFINITY);
                let field = ui.add(edit);
                let editable = true;
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::TextInput, editable, "Search commands")
                });
                if self.just_opened {
                    field.request_focus();
                }
                if field.changed() {
                    self.marked = 0;
                }
                let found = found(entries(scene), &self.text);
                self.marked = (self.marked + down).saturating_sub(up).min(found.len().saturating_sub(1));
                ui.add_space(4.0);
                let moved = up + down > 0;
                self.list(ui, &found, moved, commands);
                if run && let Some(entry) = found.get(self.marked) {
                    commands.push(entry.command.clone());
                    self.open = false;
                }
            });
        self.just_opened = false;
        self.open &= open;
    }

    fn list(&mut self, ui: &mut Ui, found: &[Entry], moved: bool, commands: &mut Vec<Command>) {
        if found.is_empty() {
            ui.weak("No command has these letters.");
        }
        let room = (ui.ctx().content_rect().height() - 240.0).clamp(80.0, 380.0);
        ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            for (number, entry) in found.iter().enumerate() {
                ui.horizontal(|ui| {
                    let marked = number == self.marked;
                    let response = ui.selectable_label(marked, &entry.title);
                    if marked && moved {
                        response.scroll_to_me(None);
                    }
                    let response = finish_button(ui, response, entry.command.clone(), commands);
                    if response.clicked() {
                        self.open = false;
                    }
                    if let Some(key) = key_text(ui.ctx(), &entry.command) {
                        let right = egui::Layout::right_to_left(egui::Align::Center);
                        ui.with_layout(right, |ui| {
                            // Clear of the scroll bar.
                            ui.add_space(14.0);
                            ui.label(RichText::new(key).weak());
                        });
                    }
                });
            }
        });
    }
}

/// Every command that makes sense in the state as it is.
fn entries(scene: &Scene) -> Vec<Entry> {
    let named = [
        (Command::ToggleLoupe, "Loupe while placing points"),
        (Command::OpenSample, "Open the sample images"),
        (Command::ClearPairs, "Clear all points"),
        (Command::Stop, "Stop the computation"),
        (Command::UnpinAll, "Unpin all lines"),
        (Command::ChooseContestant(Contestant::Imported), "Show the imported geometry"),
        (Command::Exchange(ExchangeCommand::RemoveImported), "Remove the imported geometry"),
        (Command::ChooseHypothesis(None), "Show the result instead of a hypothesis"),
        (Command::SetMethod(Method::TwoPoint), "Estimate from two pairs"),
        (Command::SetMethod(Method::ThreePoint), "Estimate from three pairs"),
        (Command::SetPreset(Preset::Robust), "Preset: robust"),
        (Command::SetPreset(Preset::Paper), "Preset: paper"),
    ]
    .map(|(command, title)| Entry { title: title.to_owned(), command });
    let rectified = [
        (RectifiedCommand::SetMethod(rectify::Method::Auto), "Rectify: choose the method automatically"),
        (RectifiedCommand::SetMethod(rectify::Method::Planar), "Rectify: planar method"),
        (RectifiedCommand::SetMethod(rectify::Method::Polar), "Rectify: polar method"),
        (RectifiedCommand::LayOut(Layout::SideBySide), "Rectified pair side by side"),
        (RectifiedCommand::LayOut(Layout::Blink), "Rectified pair by turns (blink)"),
        (RectifiedCommand::LayOut(Layout::Anaglyph), "Rectified pair as anaglyph, red and cyan"),
        (RectifiedCommand::View(None), "Fit the rectified pair"),
        (RectifiedCommand::StopExport, "Stop the export of the rectified pair"),
    ]
    .map(|(command, title)| Entry { title: title.to_owned(), command: Command::Rectified(command) });
    let overlays = OVERLAYS.iter().zip(scene.overlays).enumerate();
    let overlays = overlays.filter(|(_, (overlay, _))| overlay.visibility.is_a_choice(scene)).map(
        |(number, (overlay, shown))| Entry {
            title: format!("{} {}", if *shown { "Hide" } else { "Show" }, overlay.name.to_lowercase()),
            command: Command::ToggleOverlay(number),
        },
    );
    let with_keys = Command::with_keys().into_iter().map(|command| Entry {
        title: match command {
            Command::ToggleTruth if scene.truth().is_some() => "Hide the ground truth".to_owned(),
            Command::ToggleTruth => "Compare with the ground truth".to_owned(),
            Command::RandomTrial(Protocol::WellPosed) => {
                "Random trial: two true matches, well-posed".to_owned()
            }
            Command::RandomTrial(_) => "Random trial: two true matches, as in the paper".to_owned(),
            Command::ShowMe => "Show me: place two pairs on the sample".to_owned(),
            Command::ToggleInspectTool => "Inspect: pin line pairs".to_owned(),
            Command::FitAll => "Fit both images".to_owned(),
            Command::EnlargeTabs => "Enlarge or reduce the panel".to_owned(),
            Command::Rectified(RectifiedCommand::Swap) => "Rectified pair: show the other picture".to_owned(),
            Command::Rectified(RectifiedCommand::ShowExport) => "Export rectified pair…".to_owned(),
            Command::Exchange(ExchangeCommand::ShowExport) => {
                "Export… (geometry, point pairs, report, profile, view)".to_owned()
            }
            Command::ToggleShortcuts => "List of keys".to_owned(),
            _ => command.name().to_owned(),
        },
        command,
    });
    let all = with_keys.chain(named).chain(rectified).chain(overlays);
    all.filter(|entry| makes_sense(&entry.command, scene)).collect()
}

fn makes_sense(command: &Command, scene: &Scene) -> bool {
    let document = scene.document;
    match command {
        // It closes this very list.
        Command::TogglePalette | Command::Cancel => false,
        Command::ShowMe => scene.has_sample_points,
        Command::Undo => scene.can_undo_redo[0],
        Command::Redo => scene.can_undo_redo[1],
        Command::DeleteSelected => document.selection.is_some() || scene.focus.inspected().is_some(),
        Command::ClearPairs => !document.pairs.is_empty() || document.half.is_some(),
        Command::AcceptSuggestion => scene.accepted_suggestion().is_some(),
        Command::Stop => scene.computation.is_running(),
        Command::Recompute => document.used_pairs().is_some(),
        Command::UnpinAll => !scene.focus.pins().is_empty(),
        Command::Rectified(command) => rectified_makes_sense(command, scene),
        Command::Exchange(ExchangeCommand::ShowExport) => document.pictures.is_some(),
        Command::ChooseContestant(Contestant::Imported)
        | Command::Exchange(ExchangeCommand::RemoveImported) => document.imported.is_some(),
        Command::StepPair { forward } => {
            scene.folder().is_some_and(|(folder, pair)| folder.neighbour(pair, *forward).is_some())
        }
        Command::ToggleTruth => scene.known.is_some(),
        Command::RandomTrial(_) => scene.no_trial().is_none(),
        Command::ChooseHypothesis(None) => scene.shows_another(),
        _ => true,
    }
}

fn rectified_makes_sense(command: &RectifiedCommand, scene: &Scene) -> bool {
    match command {
        RectifiedCommand::Swap | RectifiedCommand::View(_) | RectifiedCommand::LayOut(_) => {
            scene.rectified.is_some()
        }
        RectifiedCommand::ShowExport => scene.shown().is_some() && scene.writing.is_none(),
        RectifiedCommand::StopExport => scene.writing.is_some(),
        _ => true,
    }
}

/// The entries that fit the text, best first; without a text all of them.
fn found(entries: Vec<Entry>, text: &str) -> Vec<Entry> {
    let mut ranked: Vec<(usize, Entry)> = entries
        .into_iter()
        .filter_map(|entry| Some((rank(&entry.title.to_lowercase(), &text.trim().to_lowercase())?, entry)))
        .collect();
    // Of titles that fit alike the shorter one says less that was not asked for.
    let typed = !text.trim().is_empty();
    ranked.sort_by_key(|(rank, entry)| (*rank, if typed { entry.title.len() } else { 0 }));
    ranked.into_iter().map(|(_, entry)| entry).collect()
}

/// How far a title is from what was typed: where the words are; beyond that, titles that only have the letters in
/// that order. `None` when it has not even these.
fn rank(title: &str, text: &str) -> Option<usize> {
    let words = text.split_whitespace().map(|word| title.find(word)).sum::<Option<usize>>();
    words.or_else(|| {
        let mut rest = title.chars();
        let mut letters = text.chars().filter(|letter| !letter.is_whitespace());
        letters.all(|letter| rest.any(|other| other == letter)).then_some(10_000 + title.len())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_before_letters_and_beginnings_before_ends() {
        let titles = ["Fit both images", "Open the sample images", "Light or dark", "Link views"];
        let entries = || {
            titles
                .map(|title| Entry { title: title.to_owned(), command: Command::FitAll })
                .into_iter()
                .collect()
        };
        let search = |text: &str| -> Vec<String> {
            found(entries(), text).into_iter().map(|entry| entry.title).collect()
        };
        assert_eq!(search("images"), ["Fit both images", "Open the sample images"]);
        assert_eq!(search("o").first().map(String::as_str), Some("Open the sample images"));
        assert_eq!(search("view link"), ["Link views"]);
        assert_eq!(search("lv"), ["Link views"]);
        assert_eq!(search("").len(), titles.len());
        assert!(search("zzz").is_empty());
    }
}
