//! The table of actions: names, tooltips, shortcuts, and where each action is offered.
//!
//! A new action is a variant of [`Command`], an entry in a file here, and an arm where commands are
//! applied.

mod action;
mod dialogs;
mod keys;
mod named;

use std::mem::discriminant;
use std::sync::LazyLock;

use egui::KeyboardShortcut;

use crate::app::model::command::Command;
pub use action::Action;
pub use keys::GROUPS;

/// All actions. Those with shortcuts come first, in the order of the list of keys.
pub static ACTIONS: LazyLock<Vec<Action>> = LazyLock::new(|| {
    [keys::with_keys(), named::by_name(), dialogs::in_dialogs()].into_iter().flatten().collect()
});

/// Returns whether two commands are of one kind: the same variant, and for roles the same role.
fn is_alike(one: &Command, other: &Command) -> bool {
    match (one, other) {
        (Command::Session(one), Command::Session(other)) => discriminant(one) == discriminant(other),
        (Command::Exchange(one), Command::Exchange(other)) => discriminant(one) == discriminant(other),
        (Command::Rectified(one), Command::Rectified(other)) => discriminant(one) == discriminant(other),
        (Command::Player(one), Command::Player(other)) => discriminant(one) == discriminant(other),
        (Command::Replay(one), Command::Replay(other)) => discriminant(one) == discriminant(other),
        (Command::SetRole(_, one), Command::SetRole(_, other)) => one == other,
        (Command::Points(one), Command::Points(other)) => discriminant(one) == discriminant(other),
        _ => discriminant(one) == discriminant(other),
    }
}

impl Command {
    /// Returns the entry of this command, or else of its kind. Commands that only the mouse gives
    /// have none.
    pub(super) fn action(&self) -> Option<&'static Action> {
        let own = ACTIONS.iter().find(|action| action.command == *self);
        own.or_else(|| ACTIONS.iter().find(|action| is_alike(&action.command, self)))
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
    use crate::app::model::command::{ExchangeCommand, SessionCommand};
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
