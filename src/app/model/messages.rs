//! Messages to the user, one or two sentences each. They stay until dismissed or settled.

use super::command::Command;

/// Maximum number of visible messages. Older ones are only counted.
const MOST: usize = 4;
/// Maximum number of kept messages. The oldest is removed first.
const KEPT: usize = 100;
/// Lifetime of messages of success, seconds.
const STAYS: f64 = 8.0;

/// Subject of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// A failure, or a command that cannot be carried out.
    Problem,
    /// A finished task that took some time.
    Done,
    /// The answer to a question.
    Answer,
    /// An offer to restore unsaved work.
    LeftBehind,
    /// A question whether to replace a file that another program changed.
    Replace,
    /// A failure about a point pair as it is now. The next change of the document removes it.
    OfPair,
}

impl MessageKind {
    /// Returns label and tooltip of the button that removes the message.
    pub fn close(self) -> (&'static str, &'static str) {
        match self {
            Self::LeftBehind => ("Later", "Keep the unsaved work. The next start asks again."),
            Self::Replace => ("Cancel", "Save nothing. The file stays as it is."),
            Self::Problem | Self::Done | Self::Answer | Self::OfPair => ("Dismiss", "Remove this message."),
        }
    }
}

/// A message to the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Number for [`Command::Dismiss`].
    pub number: u64,
    /// Subject of the message.
    pub kind: MessageKind,
    /// The fact and the action to take.
    pub text: String,
    /// Buttons of the message.
    pub actions: Vec<MessageAction>,
    /// Time when it was first visible, seconds of the clock of the window.
    seen: Option<f64>,
}

/// A button of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MessageAction {
    /// Label of the button.
    pub label: &'static str,
    /// Effect of the button.
    pub command: Command,
}

/// Messages that the user has not dismissed.
#[derive(Debug, Clone, Default)]
pub struct Messages {
    list: Vec<Message>,
    shown: u64,
}

impl Messages {
    /// Returns the messages, oldest first.
    pub fn list(&self) -> &[Message] {
        &self.list
    }

    /// Returns the visible messages, newest first.
    pub fn on_top(&self) -> impl Iterator<Item = &Message> {
        self.list.iter().rev().take(MOST)
    }

    /// Returns the number of hidden messages.
    pub fn below(&self) -> usize {
        self.list.len().saturating_sub(MOST)
    }

    /// Removes the newest message and returns whether there was one.
    pub fn dismiss_top(&mut self) -> bool {
        self.list.pop().is_some()
    }

    /// Removes expired messages of success and returns the seconds until the next one expires.
    pub fn retire(&mut self, now: f64) -> Option<f64> {
        for message in &mut self.list {
            message.seen.get_or_insert(now);
        }
        let due = |message: &Message| message.seen.unwrap_or(now) + STAYS - now;
        self.list.retain(|message| message.kind != MessageKind::Done || due(message) > 0.0);
        let done = self.list.iter().filter(|message| message.kind == MessageKind::Done);
        done.map(due).min_by(f64::total_cmp)
    }

    /// Adds a message about a failure.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.say(MessageKind::Problem, text.into(), Vec::new());
    }

    /// Adds a message, with or without buttons.
    pub fn say(&mut self, kind: MessageKind, text: String, actions: Vec<MessageAction>) {
        self.list.retain(|message| message.text != text);
        self.shown += 1;
        self.list.push(Message { number: self.shown, kind, text, actions, seen: None });
        if self.list.len() > KEPT {
            self.list.remove(0);
        }
    }

    /// Removes all messages of a kind.
    pub fn settle(&mut self, kind: MessageKind) {
        self.list.retain(|message| message.kind != kind);
    }

    /// Removes a message by its number.
    pub fn dismiss(&mut self, number: u64) {
        self.list.retain(|message| message.number != number);
    }
}

/// The last action, for the status bar. It expires like other messages of success.
#[derive(Debug, Clone, Default)]
pub struct LastDone {
    text: Option<String>,
    /// Time when it was first visible, seconds of the clock of the window.
    seen: Option<f64>,
}

impl LastDone {
    /// Replaces the text.
    pub fn tell(&mut self, text: impl Into<String>) {
        *self = Self { text: Some(text.into()), seen: None };
    }

    /// Returns the text until it expires.
    pub fn text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// Removes an expired text and returns the remaining seconds.
    pub fn retire(&mut self, now: f64) -> Option<f64> {
        self.text.as_ref()?;
        let left = *self.seen.get_or_insert(now) + STAYS - now;
        if left <= 0.0 {
            self.text = None;
        }
        (left > 0.0).then_some(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_removes_messages_of_one_kind() {
        let mut messages = Messages::default();
        let restore = MessageAction { label: "Restore", command: Command::Undo };
        messages.say(MessageKind::LeftBehind, "Restore that work?".into(), vec![restore.clone()]);
        messages.say(MessageKind::Replace, "Replace the file?".into(), vec![restore]);
        messages.tell("It went wrong.");
        messages.settle(MessageKind::Replace);
        let kinds: Vec<_> = messages.list().iter().map(|message| message.kind).collect();
        assert_eq!(kinds, [MessageKind::LeftBehind, MessageKind::Problem]);
        messages.dismiss(messages.list()[1].number);
        assert_eq!(messages.list().len(), 1);
    }

    #[test]
    fn messages_of_success_expire_and_problems_stay() {
        let mut messages = Messages::default();
        messages.tell("It went wrong.");
        assert_eq!(messages.retire(1.0), None);
        messages.say(MessageKind::Done, "Written.".into(), Vec::new());
        assert_eq!(messages.retire(100.0), Some(STAYS));
        assert_eq!(messages.retire(103.0), Some(STAYS - 3.0));
        assert_eq!(messages.retire(100.0 + STAYS), None);
        assert_eq!(messages.list().len(), 1);
    }
}
