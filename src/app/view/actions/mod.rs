//! The table of actions: names, tooltips, shortcuts, and where each action is offered.
//!
//! A new action is a variant of [`Command`], an entry in a file here, and an arm where commands are
//! applied.

mod action;
mod dialogs;
mod keys;
mod named;

use std::mem::{Discriminant, discriminant};
use std::sync::LazyLock;

use egui::KeyboardShortcut;

use crate::app::model::command::{Command, ExchangeCommand, SessionCommand};
use crate::app::model::document::Role;
use crate::app::model::point_table::PointsCommand;
use crate::app::model::recording::PlayerCommand;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::model::tones::TonesCommand;
pub use action::Action;
pub use keys::GROUPS;

/// All actions. Those with shortcuts come first, in the order of the list of keys.
pub static ACTIONS: LazyLock<Vec<Action>> = LazyLock::new(|| {
    [keys::with_keys(), named::by_name(), dialogs::in_dialogs()].into_iter().flatten().collect()
});

/// Kind of a command: its variant, and the data that select another entry.
#[derive(PartialEq, Eq)]
enum Kind {
    Session(Discriminant<SessionCommand>),
    Exchange(Discriminant<ExchangeCommand>),
    Rectified(Discriminant<RectifiedCommand>),
    Tones(Discriminant<TonesCommand>),
    /// Also the sign of the step: forwards and backwards have separate entries.
    Player(Discriminant<PlayerCommand>, Option<i32>),
    /// Also the role of the chosen rows.
    Points(Discriminant<PointsCommand>, Option<Role>),
    /// Each role has an entry.
    Role(Role),
    Other(Discriminant<Command>),
}

fn kind(command: &Command) -> Kind {
    match command {
        Command::Session(command) => Kind::Session(discriminant(command)),
        Command::Exchange(command) => Kind::Exchange(discriminant(command)),
        Command::Rectified(command) => Kind::Rectified(discriminant(command)),
        Command::Tones(command) => Kind::Tones(discriminant(command)),
        Command::Player(command) => {
            let by = if let PlayerCommand::Step(by) = command { Some(by.signum()) } else { None };
            Kind::Player(discriminant(command), by)
        }
        Command::Points(command) => {
            let role = if let PointsCommand::SetRole(role) = command { Some(*role) } else { None };
            Kind::Points(discriminant(command), role)
        }
        Command::SetRole(_, role) => Kind::Role(*role),
        other => Kind::Other(discriminant(other)),
    }
}

impl Command {
    /// Returns the entry of this command, or else of its kind. Commands that only the mouse gives
    /// have none.
    pub(super) fn action(&self) -> Option<&'static Action> {
        let own = ACTIONS.iter().find(|action| action.command == *self);
        own.or_else(|| ACTIONS.iter().find(|action| kind(&action.command) == kind(self)))
    }

    /// Returns the text of the command's button.
    pub(super) fn name(&self) -> &'static str {
        self.action().map_or("", |action| action.name)
    }

    pub(super) fn tooltip(&self) -> &'static str {
        self.action().map_or("", |action| action.tooltip)
    }

    /// Returns the shortcuts; the first one is displayed.
    pub(super) fn keys(&self) -> &'static [KeyboardShortcut] {
        // A shortcut runs exactly the command of its entry, not another one of its kind.
        let own = self.action().filter(|action| action.command == *self);
        own.map_or(&[], |action| &action.keys)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_actions_share_a_key_and_each_has_a_name_and_a_tooltip() {
        let mut seen = HashSet::new();
        for action in ACTIONS.iter() {
            let command = &action.command;
            assert!(!action.name.is_empty() && action.tooltip.ends_with('.'), "{command:?}");
            assert!(std::ptr::eq(command.action().unwrap(), action), "{command:?} twice");
            for shortcut in &action.keys {
                assert!(seen.insert(*shortcut), "{shortcut:?} twice");
            }
        }
    }

    #[test]
    fn longer_shortcuts_come_before_the_ones_they_contain() {
        let mut seen: Vec<KeyboardShortcut> = Vec::new();
        for shortcut in ACTIONS.iter().flat_map(|action| &action.keys) {
            let hidden = seen.iter().any(|earlier| {
                earlier.logical_key == shortcut.logical_key
                    && shortcut.modifiers.matches_logically(earlier.modifiers)
            });
            assert!(!hidden, "{shortcut:?} would never be seen");
            seen.push(*shortcut);
        }
    }

    #[test]
    fn a_command_with_data_has_the_entry_of_its_kind() {
        assert_eq!(Command::Unpin(7).name(), "Unpin");
        assert_eq!(Command::from(SessionCommand::SaveTo("a.json".into())).name(), "Save session");
        assert_eq!(Command::StepPair { forward: false }.name(), "Previous pair");
        assert_eq!(
            Command::from(ExchangeCommand::Accept { reading: None, with_pairs: true }).name(),
            "Import matrix"
        );
        assert!(Command::ChooseHypothesis(Some(3)).keys().is_empty());
    }
}
