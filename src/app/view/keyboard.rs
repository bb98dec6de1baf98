//! Commands given by keyboard shortcuts.

use egui::{Event, Id, Key, KeyboardShortcut, Modifiers};

use super::actions::{ACTIONS, Action};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::crosshair::CrosshairCommand;
use crate::app::model::point_table::PointsCommand;
use crate::geometry::Vector;

/// Steps of an arrow key, px.
const NUDGES: [(Modifiers, f64); 3] =
    [(Modifiers::SHIFT, 10.0), (Modifiers::ALT, 0.1), (Modifiers::NONE, 1.0)];

/// The context in which keys are interpreted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyboardState {
    /// A dialog is open and receives keys that type text.
    pub dialog_open: bool,
    /// Enter can accept a suggested match. Otherwise Enter presses the focused button.
    pub suggestion: bool,
    /// The crosshair takes Enter and Tab.
    pub crosshair: bool,
}

/// Returns whether a command of a key can be run now.
pub fn makes_sense(command: &Command, model: &Model) -> bool {
    ACTIONS.iter().find(|action| action.command == *command).is_none_or(|action| (action.makes_sense)(model))
}

/// Returns the commands of the keys pressed since the last frame. What follows the key that opens the list of commands
/// is typed into it.
pub fn pressed(ctx: &egui::Context, keyboard: KeyboardState) -> Vec<Command> {
    let typing = keyboard.dialog_open || ctx.text_edit_focused();
    if !typing {
        keep_typed(ctx, Command::TogglePalette.keys());
    }
    // An open menu handles Escape itself.
    let menu_open = egui::Popup::is_any_open(ctx);
    let is_focused = ctx.memory(|memory| memory.focused().is_some());
    let mut commands = Vec::new();
    ctx.input_mut(|input| {
        for action in ACTIONS.iter() {
            let command = &action.command;
            if typing && !action.works_while_typing
                || menu_open && *command == Command::Cancel
                || *command == Command::AcceptSuggestion && !(keyboard.suggestion || keyboard.crosshair)
                || *command == CrosshairCommand::ChangePicture.into() && !keyboard.crosshair
            {
                continue;
            }
            for shortcut in &action.keys {
                // Space presses a focused button, and pans when held.
                if shortcut.logical_key == Key::Space {
                    continue;
                }
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
        let arrows = [
            (Key::ArrowLeft, Vector::new(-1.0, 0.0)),
            (Key::ArrowRight, Vector::new(1.0, 0.0)),
            (Key::ArrowUp, Vector::new(0.0, -1.0)),
            (Key::ArrowDown, Vector::new(0.0, 1.0)),
        ];
        for (key, direction) in arrows {
            for (modifiers, step) in NUDGES {
                let count = input.count_and_consume_key(modifiers, key);
                if count > 0 {
                    commands.push(Command::Nudge(direction * (step * count as f64)));
                }
            }
        }
    });
    let tapped = tapped_space(ctx).filter(|_| !typing && !is_focused);
    let by_space = tapped.and_then(|modifiers| {
        let is_its = |action: &&Action| {
            let mut keys = action.keys.iter();
            keys.any(|key| key.logical_key == Key::Space && key.modifiers == modifiers)
        };
        ACTIONS.iter().find(is_its).map(|action| action.command.clone())
    });
    commands.extend(by_space);
    commands
}

/// Keeps the letters that follow one of the keys that open the list of commands, and takes them and later keys from the
/// events. On a slow display, one frame may have all of them.
fn keep_typed(ctx: &egui::Context, keys: &[KeyboardShortcut]) {
    let typed: String = ctx.input_mut(|input| {
        let opens = |event: &Event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => {
                keys.iter().any(|own| own.logical_key == *key && modifiers.matches_logically(own.modifiers))
            }
            _ => false,
        };
        let Some(at) = input.events.iter().position(opens) else { return String::new() };
        let is_typing = |event: &Event| matches!(event, Event::Key { pressed: true, .. } | Event::Text(_));
        let later = input.events.split_off(at + 1);
        let (typing, others): (Vec<Event>, Vec<Event>) = later.into_iter().partition(is_typing);
        input.events.extend(others);
        let letters = |event| if let Event::Text(text) = event { Some(text) } else { None };
        typing.into_iter().filter_map(letters).collect()
    });
    if !typed.is_empty() {
        ctx.data_mut(|data| data.insert_temp(typed_id(), typed));
    }
}

/// Returns the letters that were typed in the frame in which the list of commands opened.
pub fn take_typed(ctx: &egui::Context) -> String {
    ctx.data_mut(|data| data.remove_temp(typed_id())).unwrap_or_default()
}

fn typed_id() -> Id {
    Id::unique("letters for the list of commands")
}

/// Returns the modifiers of the space bar if it was released now, and nothing was dragged while it was down.
fn tapped_space(ctx: &egui::Context) -> Option<Modifiers> {
    let dragged = egui::Id::unique("dragged with the space bar");
    let (is_dragging, released) = ctx.input(|input| {
        let released = input.events.iter().find_map(|event| match event {
            egui::Event::Key { key: Key::Space, pressed: false, modifiers, .. } => Some(*modifiers),
            _ => None,
        });
        (input.key_down(Key::Space) && input.pointer.any_down(), released)
    });
    if is_dragging {
        ctx.data_mut(|data| data.insert_temp(dragged, true));
    }
    let was_dragged = || ctx.data_mut(|data| data.remove_temp::<bool>(dragged)).unwrap_or(false);
    released
        .filter(|_| !was_dragged())
        .map(|modifiers| Modifiers { shift: modifiers.shift, ..Modifiers::NONE })
}

/// Returns the first shortcut of a command as text, such as `Ctrl+Z`.
pub fn key_text(ctx: &egui::Context, command: &Command) -> Option<String> {
    // egui spells out the names of these keys.
    command.keys().first().map(|shortcut| match shortcut.logical_key {
        Key::Questionmark => "?".into(),
        Key::Comma => ",".into(),
        Key::Period => ".".into(),
        _ => ctx.format_shortcut(shortcut),
    })
}
