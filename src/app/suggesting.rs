//! The suggestion of a match while the second click of a pair is due, made in a thread.

use std::sync::Arc;

use super::background::Latest;
use super::document::HalfPair;
use super::waker::Waker;
use crate::geometry::FundamentalMatrix;
use crate::image::Picture;
use crate::suggest::{SuggestError, Suggestions};

/// What a match is to be suggested for.
#[derive(Clone)]
pub struct Question {
    /// The two pictures.
    pub pictures: [Arc<Picture>; 2],
    /// The first click.
    pub half: HalfPair,
    /// The geometry, when it is known: then only the epipolar line is searched.
    pub fundamental: Option<FundamentalMatrix>,
}

impl PartialEq for Question {
    fn eq(&self, other: &Self) -> bool {
        let same = |k: usize| Arc::ptr_eq(&self.pictures[k], &other.pictures[k]);
        same(0) && same(1) && self.half == other.half && self.fundamental == other.fundamental
    }
}

/// Places that look like the first click, or why there are none.
pub type Suggested = Result<Suggestions, SuggestError>;

/// Suggests the match of a first click, in some hundredths of a second.
pub type SuggestFn = dyn FnMut(&Question) -> Suggested + Send;

/// The suggestion and the thread that makes it.
pub struct Suggesting {
    thread: Latest<Question, (Question, Suggested)>,
    asked: Option<Question>,
    answer: Option<Suggested>,
}

impl Suggesting {
    /// Nothing suggested yet.
    pub fn new(mut suggest: Box<SuggestFn>, waker: Waker) -> Self {
        let thread = Latest::new("suggest", waker, move |question: Question| {
            let answer = suggest(&question);
            Some((question, answer))
        });
        Self { thread, asked: None, answer: None }
    }

    /// Asks when the question is another one than before, and takes in answers.
    pub fn follow(&mut self, question: Option<Question>) {
        if question != self.asked {
            self.asked.clone_from(&question);
            self.answer = None;
            match question {
                Some(question) => self.thread.ask(question),
                None => self.thread.forget(),
            }
        }
        if let Some((question, answer)) = self.thread.poll()
            && self.asked.as_ref() == Some(&question)
        {
            self.answer = Some(answer);
        }
    }

    /// Whether an answer is still to come.
    pub fn is_busy(&self) -> bool {
        self.thread.is_busy()
    }

    /// The answer to the question as it is now.
    pub fn answer(&self) -> Option<&Suggested> {
        self.answer.as_ref()
    }
}
