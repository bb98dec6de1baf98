//! Messages to the user, one or two sentences each. Questions and dangers stay until they are dismissed or settled,
//! the others for as long as reading them takes.

use super::command::Command;

/// Maximum number of visible messages. Older ones are only counted.
const MOST: usize = 4;
/// Maximum number of kept messages. The oldest is removed first.
const KEPT: usize = 100;
/// Lifetime of messages of success, seconds.
const STAYS: f64 = 8.0;
/// Lifetime of other messages that need no answer, seconds. Three sentences take half of that to read.
const STAYS_LONG: f64 = 30.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// A failure, or a command that cannot be carried out.
    Problem,
    /// A finished task that took some time.
    Done,
    /// An answer, or a remark on work that succeeded.
    Answer,
    /// How imported points were taken. The next such message replaces it.
    Taken,
    /// A question whether to replace a file that another program changed.
    Replace,
    /// A failure about a point pair as it is now. The next change of the document removes it.
    OfPair,
    /// A lasting danger for unsaved work.
    Unprotected,
}

impl MessageKind {
    /// Returns label and tooltip of the button that removes the message.
    pub fn close(self) -> (&'static str, &'static str) {
        match self {
            Self::Replace => ("Cancel", "Save nothing. The file stays as it is."),
            _ => ("Dismiss", "Remove this message."),
        }
    }

    /// Returns the seconds after which the message goes by itself.
    fn stays(self) -> Option<f64> {
        match self {
            Self::Done => Some(STAYS),
            Self::Problem | Self::Answer | Self::Taken | Self::OfPair => Some(STAYS_LONG),
            Self::Replace | Self::Unprotected => None,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Number for [`Command::Dismiss`].
    pub number: u64,
    pub kind: MessageKind,
    /// The fact and the action to take.
    pub text: String,
    pub actions: Vec<MessageAction>,
    /// Time when it was first visible, seconds of the clock of the window.
    seen: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct MessageAction {
    pub label: &'static str,
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

    pub fn below(&self) -> usize {
        self.list.len().saturating_sub(MOST)
    }

    /// Removes the newest message and returns whether there was one.
    pub fn dismiss_top(&mut self) -> bool {
        self.list.pop().is_some()
    }

    /// Removes expired messages and returns the seconds until the next one expires.
    pub fn retire(&mut self, now: f64) -> Option<f64> {
        let left = |message: &Message| Some(message.seen? + message.kind.stays()? - now);
        self.list.retain(|message| left(message).is_none_or(|left| left > 0.0));
        for message in self.list.iter_mut().rev().take(MOST) {
            message.seen.get_or_insert(now);
        }
        self.list.iter().filter_map(left).min_by(f64::total_cmp)
    }

    /// Adds a message about a failure.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.say(MessageKind::Problem, text.into(), Vec::new());
    }

    /// Adds remarks on work that succeeded.
    pub fn remark(&mut self, notes: Vec<String>) {
        for note in notes {
            self.say(MessageKind::Answer, note, Vec::new());
        }
    }

    pub fn say(&mut self, kind: MessageKind, text: String, actions: Vec<MessageAction>) {
        self.list.retain(|message| message.text != text);
        self.shown += 1;
        self.list.push(Message { number: self.shown, kind, text, actions, seen: None });
        if self.list.len() > KEPT {
            self.list.remove(0);
        }
    }

    pub fn settle(&mut self, kind: MessageKind) {
        self.list.retain(|message| message.kind != kind);
    }

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
    fn messages_go_when_they_can_have_been_read_and_dangers_stay() {
        let mut messages = Messages::default();
        messages.say(MessageKind::Unprotected, "Save often.".into(), Vec::new());
        assert_eq!(messages.retire(1.0), None);
        messages.tell("It went wrong.");
        messages.say(MessageKind::Done, "Written.".into(), Vec::new());
        assert_eq!(messages.retire(100.0), Some(STAYS));
        assert_eq!(messages.retire(103.0), Some(STAYS - 3.0));
        assert_eq!(messages.retire(100.0 + STAYS), Some(STAYS_LONG - STAYS));
        assert_eq!(messages.list().len(), 2);
        // A message below the others cannot be seen, and its time has not come.
        for k in 0..MOST {
            messages.say(MessageKind::Answer, k.to_string(), Vec::new());
        }
        messages.tell("Below the others.");
        messages.say(MessageKind::Answer, "On top.".into(), Vec::new());
        assert_eq!(messages.retire(110.0), Some(STAYS_LONG - 10.0));
        assert_eq!(messages.retire(110.0 + STAYS_LONG), Some(STAYS_LONG), "the first two are seen only now");
        assert_eq!(messages.list().len(), 3);
        assert_eq!(messages.retire(110.0 + 2.0 * STAYS_LONG), None);
        assert_eq!(messages.list().len(), 1);
    }
}
