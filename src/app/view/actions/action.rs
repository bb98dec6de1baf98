//! One action, as it is offered.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::ids::TabId;

/// Something that can be done, as it is offered.
pub struct Action {
    /// What is done. Entries of commands with something particular in them stand for all of their kind, unless those
    /// have an entry of their own.
    pub command: Command,
    /// What it is called on buttons.
    pub name: &'static str,
    /// One sentence about it.
    pub tooltip: &'static str,
    /// Keys of the action, the first one being the one that is shown.
    pub keys: Vec<KeyboardShortcut>,
    /// Whether its keys work while a text field or a dialog has the keyboard.
    pub works_while_typing: bool,
    /// What it is called in the list of all commands, if it is in there.
    pub listed: Option<fn(&Model) -> &'static str>,
    /// Whether it makes sense in the state as it is.
    pub makes_sense: fn(&Model) -> bool,
}

impl Action {
    /// With another key.
    pub fn key(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.keys.push(KeyboardShortcut::new(modifiers, key));
        self
    }

    /// The same with keys that work while a text is typed, too.
    pub fn while_typing(mut self) -> Self {
        self.works_while_typing = true;
        self
    }

    /// The same in the list of all commands.
    pub fn listed(mut self, title: fn(&Model) -> &'static str) -> Self {
        self.listed = Some(title);
        self
    }

    /// The same where it makes sense in some states alone.
    pub fn when(mut self, makes_sense: fn(&Model) -> bool) -> Self {
        self.makes_sense = makes_sense;
        self
    }
}

/// A command with its name and its sentence.
pub fn action(command: impl Into<Command>, name: &'static str, tooltip: &'static str) -> Action {
    let (keys, makes_sense) = (Vec::new(), |_: &Model| true);
    Action {
        command: command.into(),
        name,
        tooltip,
        keys,
        works_while_typing: false,
        listed: None,
        makes_sense,
    }
}

/// A tab of the bottom panel.
pub fn tab(id: TabId, key: Key, tooltip: &'static str) -> Action {
    action(Command::ShowTab(id), id.title(), tooltip).key(Modifiers::NONE, key)
}
