//! Which commands the keys that were pressed stand for.

use egui::{Key, Modifiers};

use super::actions::ACTIONS;
use crate::app::model::command::Command;
use crate::app::model::point_table::PointsCommand;
use crate::geometry::Vector;

/// Pixels an arrow key moves a point; ten times as far with Shift.
const NUDGE: f64 = 0.1;

/// What keys mean just now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyboardState {
    /// Keys that also write text belong to a dialog.
    pub dialog_open: bool,
    /// There is a suggestion for Enter to accept; else Enter presses the button that has the focus.
    pub suggestion: bool,
}

/// The commands of the keys pressed since the last frame.
pub fn pressed(ctx: &egui::Context, keyboard: KeyboardState) -> Vec<Command> {
    let typing = keyboard.dialog_open || ctx.text_edit_focused();
    // An open menu closes on Escape by itself.
    let menu_open = egui::Popup::is_any_open(ctx);
    let mut commands = Vec::new();
    ctx.input_mut(|input| {
        for action in ACTIONS.iter() {
            let command = &action.command;
            if typing && !action.works_while_typing
                || menu_open && *command == Command::Cancel
                || !keyboard.suggestion && *command == Command::AcceptSuggestion
            {
                continue;
            }
            for shortcut in &action.keys {
                for _ in 0..input.count_and_consume_key(shortcut.modifiers, shortcut.logical_key) {
                    commands.push(command.clone());
                }
            }
        }
        if typing {
            return;
        }
        commands.extend(input.events.iter().filter_map(|event| match event {
            egui::Event::Copy => Some(PointsCommand::Copy.into()),
            egui::Event::Paste(text) => Some(PointsCommand::Paste(text.clone()).into()),
            _ => None,
        }));
        if input.count_and_consume_key(Modifiers::COMMAND, Key::A) > 0 {
            commands.push(PointsCommand::ChooseAll.into());
        }
        let arrows = [
            (Key::ArrowLeft, Vector::new(-1.0, 0.0)),
            (Key::ArrowRight, Vector::new(1.0, 0.0)),
            (Key::ArrowUp, Vector::new(0.0, -1.0)),
            (Key::ArrowDown, Vector::new(0.0, 1.0)),
        ];
        for (key, direction) in arrows {
            for (modifiers, far) in [(Modifiers::SHIFT, 10.0), (Modifiers::NONE, 1.0)] {
                let count = input.count_and_consume_key(modifiers, key);
                if count > 0 {
                    commands.push(Command::Nudge(direction * (NUDGE * far * count as f64)));
                }
            }
        }
    });
    commands
}

/// A command's first key as text, such as `Ctrl+Z`.
pub fn key_text(ctx: &egui::Context, command: &Command) -> Option<String> {
    command.keys().first().map(|shortcut| {
        // The name of this key is a word, but people know it by its sign.
        if shortcut.logical_key == Key::Questionmark { "?".into() } else { ctx.format_shortcut(shortcut) }
    })
}
