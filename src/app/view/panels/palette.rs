//! The list of all commands, searchable by name.

use egui::{Align2, Button, Key, Modifiers, RichText, ScrollArea, TextEdit, Ui, Window, vec2};

use super::finish_button;
use crate::app::model::replay::ReplayCommand;
use crate::app::model::{Command, Model, OverlayId};
use crate::app::view::actions::ACTIONS;
use crate::app::view::keyboard::{key_text, take_typed};

/// The typed text and the marked entry.
#[derive(Debug, Clone, Default)]
pub struct CommandPalette {
    pub open: bool,
    text: String,
    marked: usize,
    just_opened: bool,
}

struct PaletteEntry {
    title: String,
    command: Command,
    /// Whether the command can be run now.
    available: bool,
}

impl CommandPalette {
    /// Opens the list with an empty search, or closes it.
    pub fn toggle(&mut self) {
        *self = Self { open: !self.open, just_opened: true, ..Self::default() };
    }

    pub fn show(&mut self, ctx: &egui::Context, model: &Model, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        if self.just_opened {
            self.text = take_typed(ctx);
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
                let found = found(entries(model), &self.text);
                self.marked = (self.marked + down).saturating_sub(up).min(found.len().saturating_sub(1));
                ui.add_space(4.0);
                let moved = up + down > 0;
                self.list(ui, &found, moved, commands);
                if run && let Some(entry) = found.get(self.marked).filter(|entry| entry.available) {
                    commands.push(entry.command.clone());
                    self.open = false;
                }
            });
        self.just_opened = false;
        self.open &= open;
    }

    fn list(&mut self, ui: &mut Ui, found: &[PaletteEntry], moved: bool, commands: &mut Vec<Command>) {
        if found.is_empty() {
            ui.weak("No command matches.");
        }
        let room = (ui.ctx().content_rect().height() - 240.0).clamp(80.0, 380.0);
        ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            for (number, entry) in found.iter().enumerate() {
                ui.horizontal(|ui| {
                    let marked = number == self.marked;
                    let button = Button::selectable(marked, &entry.title);
                    let response = ui.add_enabled(entry.available, button);
                    if marked && moved {
                        response.scroll_to_me(None);
                    }
                    let response = finish_button(ui, response, entry.command.clone(), commands);
                    if response.clicked() {
                        self.open = false;
                    }
                    let key = key_text(ui.ctx(), &entry.command);
                    let note = if entry.available { key } else { Some("not available now".to_owned()) };
                    if let Some(note) = note {
                        let right = egui::Layout::right_to_left(egui::Align::Center);
                        ui.with_layout(right, |ui| {
                            // Keep clear of the scroll bar.
                            ui.add_space(14.0);
                            if !entry.available {
                                ui.disable();
                            }
                            ui.label(RichText::new(note).weak());
                        });
                    }
                });
            }
        });
    }
}

/// Returns all commands, except those that close this list.
fn entries(model: &Model) -> Vec<PaletteEntry> {
    let closes = |command: &Command| matches!(command, Command::TogglePalette | Command::Cancel);
    let named = ACTIONS.iter().filter(|action| !closes(&action.command)).filter_map(|action| {
        let title = match action.listed {
            Some(title) => title(model),
            // Every action with shortcuts is listed, under its name if it has no title.
            None if !action.keys.is_empty() => action.name,
            None => return None,
        };
        let available = (action.makes_sense)(model);
        Some(PaletteEntry { title: title.to_owned(), command: action.command.clone(), available })
    });
    let overlays = OverlayId::ALL.into_iter().filter(|overlay| model.offers(*overlay)).map(|overlay| {
        let verb = if model.look.shows(overlay) { "Hide" } else { "Show" };
        let title = format!("{verb} {}", overlay.name().to_lowercase());
        PaletteEntry { title, command: Command::ToggleOverlay(overlay), available: true }
    });
    let course = model.course();
    let steps = course.steps.iter().map(|timed| PaletteEntry {
        title: format!("Replay: {}", timed.step.title().to_lowercase()),
        command: ReplayCommand::Play(timed.step).into(),
        available: model.document.pictures.is_some(),
    });
    named.chain(steps).chain(overlays).collect()
}

/// Returns the entries that match the text, best first; all available ones for an empty text. Of equally good
/// matches, the available ones come first. A command that is not available stays above worse matches, so that Enter
/// runs none of those instead.
fn found(entries: Vec<PaletteEntry>, text: &str) -> Vec<PaletteEntry> {
    let wanted = text.trim().to_lowercase();
    let rank_of = |entry: &PaletteEntry| {
        rank(&entry.title.to_lowercase(), &entry.command.tooltip().to_lowercase(), &wanted)
    };
    let typed = !wanted.is_empty();
    let listed = entries.into_iter().filter(|entry| typed || entry.available);
    let mut ranked: Vec<(usize, PaletteEntry)> =
        listed.filter_map(|entry| Some((rank_of(&entry)?, entry))).collect();
    // Of an unavailable command, only the title tells that it was meant.
    ranked.retain(|(rank, entry)| entry.available || *rank < IN_TOOLTIP);
    // Of equally good matches, the shorter title is closer to the search.
    ranked.sort_by_key(|(rank, entry)| {
        (*rank / QUALITY, !entry.available, *rank, if typed { entry.title.len() } else { 0 })
    });
    ranked.into_iter().map(|(_, entry)| entry).collect()
}

/// Step of the rank from whole words to beginnings of words, and from these to letters inside a word.
const QUALITY: usize = 1000;

/// Rank from which the words are in the tooltip, not in the title.
const IN_TOOLTIP: usize = 100_000;

/// Returns the rank of an entry, lower is better: by the words in the title, or else in the tooltip. `None` without
/// them.
fn rank(title: &str, tooltip: &str, text: &str) -> Option<usize> {
    let words = |of: &str| text.split_whitespace().map(|word| place(of, word)).sum::<Option<usize>>();
    words(title).or_else(|| Some(IN_TOOLTIP + words(tooltip)?))
}

/// Returns the rank of a word in a text by its position. Whole words come before beginnings of words,
/// and these before letters inside a word.
fn place(text: &str, word: &str) -> Option<usize> {
    let rank = |(at, found): (usize, &str)| {
        let begins = !text[..at].ends_with(char::is_alphanumeric);
        let ends = !text[at + found.len()..].starts_with(char::is_alphanumeric);
        at + QUALITY * if begins { usize::from(!ends) } else { 2 }
    };
    text.match_indices(word).map(rank).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_words_rank_before_letters_inside_a_word() {
        let titles = ["Fit both images", "Open the sample images", "Light or dark", "Link views"];
        let entries = || {
            titles
                .map(|title| PaletteEntry {
                    title: title.to_owned(),
                    command: Command::EndDrag,
                    available: true,
                })
                .into_iter()
                .collect()
        };
        let search = |text: &str| -> Vec<String> {
            found(entries(), text).into_iter().map(|entry| entry.title).collect()
        };
        assert_eq!(search("images"), ["Fit both images", "Open the sample images"]);
        assert_eq!(search("o").first().map(String::as_str), Some("Open the sample images"));
        assert_eq!(search("view link"), ["Link views"]);
        let rank_of = |text: &str| rank("blink: swap", "exchange the two pictures.", text);
        assert!(rank_of("swap") < rank_of("exchange"));
        assert_eq!(rank_of("pinned"), None);
        let ranks =
            ["remove the lens correction", "lenses", "solense"].map(|title| rank(title, "", "lens").unwrap());
        assert!(ranks.is_sorted(), "{ranks:?}");
        assert!(rank("import a file…", "a calibration of the lens distortion.", "lens").unwrap() > ranks[2]);
        assert_eq!(rank("show me: place two pairs on the sample", "", "swap"), None);
        assert_eq!(search("").len(), titles.len());
        assert!(search("zzz").is_empty());
    }

    #[test]
    fn unavailable_commands_come_below_equal_matches_and_above_worse_ones() {
        let search = |text: &str| -> Vec<String> {
            let entry = |title: &str, command, available| PaletteEntry {
                title: title.to_owned(),
                command,
                available,
            };
            let entries = vec![
                entry("Find without clicks", Command::EndDrag, false),
                // Its tooltip has the word "without".
                entry("Pictures alone", Command::ToggleAlone, true),
                entry("Go on without a longer title", Command::EndDrag, true),
            ];
            found(entries, text).into_iter().map(|entry| entry.title).collect()
        };
        let all = ["Go on without a longer title", "Find without clicks", "Pictures alone"];
        assert_eq!(search("without"), all);
        assert_eq!(search("without clicks"), ["Find without clicks"]);
        assert_eq!(search(""), ["Pictures alone", "Go on without a longer title"]);
    }
}
