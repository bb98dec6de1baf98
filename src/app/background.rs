//! A thread that answers the newest of many questions.
//!
//! For answers that take milliseconds to a second and are only wanted for the state as it is now: while one
//! question is being answered the newest one waits and those in between are forgotten.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};

use super::waker::Waker;

/// A handle to the answering thread; dropping it ends the thread after the answer under way.
pub struct Latest<Q, A> {
    questions: Sender<(u64, Q)>,
    answers: Receiver<(u64, Option<A>)>,
    asked: u64,
    /// The newest question that needs no answer any more.
    answered: u64,
}

impl<Q: Send + 'static, A: Send + 'static> Latest<Q, A> {
    /// Starts the thread; it calls `waker` after each answer. An answer that panics is no answer.
    pub fn new(name: &str, waker: Waker, mut answer: impl FnMut(Q) -> Option<A> + Send + 'static) -> Self {
        let (questions, inbox) = channel::<(u64, Q)>();
        let (outbox, answers) = channel();
        let thread = std::thread::Builder::new().name(name.into()).spawn(move || {
            while let Ok(first) = inbox.recv() {
                let (number, question) = inbox.try_iter().last().unwrap_or(first);
                let answer = catch_unwind(AssertUnwindSafe(|| answer(question))).ok().flatten();
                if outbox.send((number, answer)).is_err() {
                    return;
                }
                waker.wake();
            }
        });
        // Without a thread the inbox is gone: nothing is ever answered, and nothing else breaks.
        drop(thread);
        Self { questions, answers, asked: 0, answered: 0 }
    }

    /// Asks, in place of any question that still waits.
    pub fn ask(&mut self, question: Q) {
        self.asked += 1;
        if self.questions.send((self.asked, question)).is_err() {
            self.answered = self.asked;
        }
    }

    /// Makes the answers to everything asked so far unwanted.
    pub fn forget(&mut self) {
        self.asked += 1;
        self.answered = self.asked;
    }

    /// Whether the newest question is still to be answered.
    pub fn is_busy(&self) -> bool {
        self.answered < self.asked
    }

    /// The newest answer that has come since the last call, be it to the newest question or, while that one
    /// waits, to an earlier one that was not forgotten.
    pub fn poll(&mut self) -> Option<A> {
        let mut newest = None;
        for (number, answer) in self.answers.try_iter().filter(|(number, _)| *number > self.answered) {
            newest = Some((number, answer));
        }
        let (number, answer) = newest?;
        self.answered = number;
        answer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Barrier};

    fn wait(latest: &mut Latest<u32, u32>) -> Option<u32> {
        loop {
            let answer = latest.poll();
            if answer.is_some() || !latest.is_busy() {
                return answer;
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn questions_that_were_overtaken_are_not_answered() {
        let gate = Arc::new(Barrier::new(2));
        let mut latest = Latest::new("test", Waker::default(), {
            let gate = Arc::clone(&gate);
            move |question: u32| {
                if question == 1 {
                    gate.wait();
                    gate.wait();
                }
                assert_ne!(question, 2, "a question that was overtaken");
                Some(question * 10)
            }
        });
        latest.ask(1);
        gate.wait();
        for question in [2, 3] {
            latest.ask(question);
        }
        gate.wait();
        let mut answers = Vec::new();
        while latest.is_busy() {
            answers.extend(latest.poll());
        }
        assert_eq!(answers.last(), Some(&30));
        assert!(answers.iter().all(|answer| [10, 30].contains(answer)));
    }

    #[test]
    fn a_panic_is_no_answer_and_forgotten_questions_have_none() {
        let mut latest = Latest::new("test", Waker::default(), |question: u32| {
            assert_ne!(question, 1, "a question that panics");
            Some(question)
        });
        latest.ask(1);
        assert_eq!(wait(&mut latest), None);
        latest.ask(5);
        latest.forget();
        assert!(!latest.is_busy());
        latest.ask(7);
        assert_eq!(wait(&mut latest), Some(7));
    }
}
