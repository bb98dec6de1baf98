//! A single action and its presentation in the window.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::app::model::{Command, Model, TabId};

/// An action that can be offered to the user.
pub struct Action {
    /// The command. An entry whose command carries data stands for all commands of that kind that
    /// have no entry of their own.
    pub command: Command,
    pub name: &'static str,
    pub tooltip: &'static str,
    /// Keyboard shortcuts; the first one is displayed.
    pub keys: Vec<KeyboardShortcut>,
    pub group: &'static str,
    /// Whether the shortcuts work while a text field or a dialog has the keyboard.
    pub works_while_typing: bool,
    /// Title in the list of all commands; `None` if the action is not listed under a title of its
    /// own.
    pub listed: Option<fn(&Model) -> &'static str>,
    /// Whether the action applies in the present state.
    pub makes_sense: fn(&Model) -> bool,
}

impl Action {
    pub fn key(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.keys.push(KeyboardShortcut::new(modifiers, key));
        self
    }

    /// Makes the shortcuts work while text is typed.
    pub fn while_typing(mut self) -> Self {
        self.works_while_typing = true;
        self
    }

    /// Lists the action among all commands under this title.
    pub fn listed(mut self, title: fn(&Model) -> &'static str) -> Self {
        self.listed = Some(title);
        self
    }

    /// Restricts the action to the states for which `makes_sense` is true.
    pub fn when(mut self, makes_sense: fn(&Model) -> bool) -> Self {
        self.makes_sense = makes_sense;
        self
    }
}

/// Creates an action without shortcuts that always applies.
pub fn action(command: impl Into<Command>, name: &'static str, tooltip: &'static str) -> Action {
    let (keys, makes_sense) = (Vec::new(), |_: &Model| true);
    Action {
        command: command.into(),
        name,
        tooltip,
        keys,
        group: "",
        works_while_typing: false,
        listed: None,
        makes_sense,
    }
}

/// Creates the action that shows a tab of the dock.
pub fn tab(id: TabId, key: Key, tooltip: &'static str) -> Action {
    action(Command::ShowTab(id), id.title(), tooltip).key(Modifiers::NONE, key)
}
