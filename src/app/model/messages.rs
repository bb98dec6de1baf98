//! What the user is told, a sentence or two each, until it is dismissed or settled.

use super::command::Command;

/// Messages shown at once at most; those before are counted.
const MOST: usize = 4;
/// Messages kept at most; the oldest gives way.
const KEPT: usize = 100;
/// Seconds that news of success stays.
const STAYS: f64 = 8.0;

/// What a message is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// Something went wrong, or cannot be done.
    Problem,
    /// Something was done that took its time.
    Done,
    /// Whether to restore what was not saved.
    LeftBehind,
    /// Whether to replace a file that others have changed.
    Replace,
}

impl MessageKind {
    /// What the button that removes the message says, and what it does.
    pub fn close(self) -> (&'static str, &'static str) {
        match self {
            Self::LeftBehind => ("Later", "Leave it as it is; the next start asks again."),
            Self::Replace => ("Cancel", "Leave everything as it is."),
            Self::Problem | Self::Done => ("Dismiss", "Remove this message."),
        }
    }
}

/// Something the user should read.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Number for [`Command::Dismiss`].
    pub number: u64,
    /// What it is about.
    pub kind: MessageKind,
    /// What happened and what to do.
    pub text: String,
    /// What can be done about it at once.
    pub actions: Vec<MessageAction>,
    /// When it was seen first, seconds of the window's clock.
    seen: Option<f64>,
}

/// A button of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MessageAction {
    /// What the button says.
    pub label: &'static str,
    /// What it does.
    pub command: Command,
}

/// What the user was told and has not dismissed.
#[derive(Debug, Clone, Default)]
pub struct Messages {
    list: Vec<Message>,
    shown: u64,
}

impl Messages {
    /// The messages, the oldest first.
    pub fn list(&self) -> &[Message] {
        &self.list
    }

    /// Messages that are shown, the newest first.
    pub fn on_top(&self) -> impl Iterator<Item = &Message> {
        self.list.iter().rev().take(MOST)
    }

    /// How many more there are.
    pub fn below(&self) -> usize {
        self.list.len().saturating_sub(MOST)
    }

    /// Removes the newest; says whether there was one.
    pub fn dismiss_top(&mut self) -> bool {
        self.list.pop().is_some()
    }

    /// Removes news of success that has been there long enough; returns the seconds until the next is due.
    pub fn retire(&mut self, now: f64) -> Option<f64> {
        for message in &mut self.list {
            message.seen.get_or_insert(now);
        }
        let due = |message: &Message| message.seen.unwrap_or(now) + STAYS - now;
        self.list.retain(|message| message.kind != MessageKind::Done || due(message) > 0.0);
        let done = self.list.iter().filter(|message| message.kind == MessageKind::Done);
        done.map(due).min_by(f64::total_cmp)
    }

    /// Tells that something went wrong.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.say(MessageKind::Problem, text.into(), Vec::new());
    }

    /// Tells something, perhaps with buttons.
    pub fn say(&mut self, kind: MessageKind, text: String, actions: Vec<MessageAction>) {
        self.list.retain(|message| message.text != text);
        self.shown += 1;
        self.list.push(Message { number: self.shown, kind, text, actions, seen: None });
        if self.list.len() > KEPT {
            self.list.remove(0);
        }
    }

    /// Removes what is settled.
    pub fn settle(&mut self, kind: MessageKind) {
        self.list.retain(|message| message.kind != kind);
    }

    /// Removes a message by its number.
    pub fn dismiss(&mut self, number: u64) {
        self.list.retain(|message| message.number != number);
    }
}

/// What was done last, for the status bar: it goes by itself as other news of success does.
#[derive(Debug, Clone, Default)]
pub struct LastDone {
    text: Option<String>,
    /// When it was seen first, seconds of the window's clock.
    seen: Option<f64>,
}

impl LastDone {
    /// Tells what was done, in place of what was done before.
    pub fn tell(&mut self, text: impl Into<String>) {
        *self = Self { text: Some(text.into()), seen: None };
    }

    /// What was done, while that is news.
    pub fn text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// Forgets what has been there long enough; returns the seconds until then.
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
    fn what_is_settled_goes_and_everything_else_stays() {
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
    fn the_newest_are_on_top_and_nothing_is_told_twice() {
        let mut messages = Messages::default();
        for number in [0, 1, 2, 2, 3, 4] {
            messages.tell(format!("Problem {number}."));
        }
        let texts: Vec<_> = messages.on_top().map(|message| message.text.as_str()).collect();
        assert_eq!(texts, ["Problem 4.", "Problem 3.", "Problem 2.", "Problem 1."]);
        assert_eq!(messages.below(), 1);
        assert!(messages.dismiss_top());
        assert_eq!((messages.on_top().count(), messages.below()), (4, 0));
    }

    #[test]
    fn news_of_success_goes_by_itself_and_problems_stay() {
        let mut messages = Messages::default();
        messages.tell("It went wrong.");
        assert_eq!(messages.retire(1.0), None);
        messages.say(MessageKind::Done, "Written.".into(), Vec::new());
        assert_eq!(messages.retire(100.0), Some(STAYS));
        assert_eq!(messages.retire(103.0), Some(STAYS - 3.0));
        assert_eq!(messages.retire(100.0 + STAYS), None);
        assert_eq!(messages.list().len(), 1);
    }

    #[test]
    fn what_was_done_last_goes_after_a_while() {
        let mut done = LastDone::default();
        assert_eq!(done.retire(5.0), None);
        done.tell("Saved.");
        assert_eq!((done.retire(10.0), done.retire(10.0 + STAYS / 2.0)), (Some(STAYS), Some(STAYS / 2.0)));
        done.tell("Saved again.");
        assert_eq!(done.retire(10.0 + STAYS), Some(STAYS), "it is news again");
        assert_eq!(done.text(), Some("Saved again."));
        assert_eq!(done.retire(10.0 + 2.0 * STAYS), None);
        assert_eq!(done.text(), None);
    }
}
