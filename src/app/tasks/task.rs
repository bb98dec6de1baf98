//! A thread that answers questions. All threads of the window are tasks.
//!
//! Either only the newest waiting question is answered ([`Waiting::Newest`]), or all in order
//! ([`Waiting::All`]). During a drag, a question comes every frame. If each question cancelled the
//! previous one, none would ever be answered. So the running question goes on until it
//! [gives way](Turn::give_way). News carries the number of its question and never arrives after news
//! of a later question. Panics are reported, too.

use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use super::waker::Waker;
use crate::cancel::CancelFlag;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Waiting {
    /// Only the newest question is answered. Dropping the task cancels the running one.
    Newest,
    /// All questions are answered in order. Dropping the task waits for them.
    All,
}

enum Event<A> {
    Told(A),
    /// The end: an answer, or the message of a panic.
    Over(Result<Option<A>, String>),
}

struct Running {
    cancel: CancelFlag,
    gives_way: bool,
}

struct Slot<Q> {
    waiting: VecDeque<(u64, Q)>,
    running: Option<Running>,
    closed: bool,
}

impl<Q> Slot<Q> {
    fn cancel(&mut self) {
        self.waiting.clear();
        self.cancel_running();
    }

    fn cancel_running(&self) {
        if let Some(running) = &self.running {
            running.cancel.cancel();
        }
    }

    /// Cancels the running question if it allows that and a newer one waits.
    fn give_way(&self) {
        if !self.waiting.is_empty() && self.running.as_ref().is_some_and(|running| running.gives_way) {
            self.cancel_running();
        }
    }
}

struct Inbox<Q> {
    slot: Mutex<Slot<Q>>,
    changed: Condvar,
}

impl<Q> Inbox<Q> {
    /// Questions are answered outside the lock, so a poisoned lock still guards valid data.
    fn lock(&self) -> MutexGuard<'_, Slot<Q>> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Interface of the answering function to its task.
pub struct Turn<'a, A> {
    /// Set when the answer is no longer wanted.
    pub cancel: CancelFlag,
    tell: &'a (dyn Fn(A) + Sync),
    give_way: &'a (dyn Fn() + Sync),
}

impl<A> Turn<'_, A> {
    pub fn tell(&self, news: A) {
        (self.tell)(news);
    }

    /// Allows that this question is cancelled as soon as a newer one waits.
    pub fn give_way(&self) {
        (self.give_way)();
    }
}

/// A handle to the answering thread.
pub struct Task<Q, A> {
    inbox: Arc<Inbox<Q>>,
    outbox: Sender<(u64, Event<A>)>,
    events: Receiver<(u64, Event<A>)>,
    waiting: Waiting,
    thread: Option<JoinHandle<()>>,
    /// Number of the newest question.
    asked: u64,
    /// Number of the newest question that is finished or cancelled.
    over: u64,
    /// News about this question and earlier ones is discarded.
    unwanted: u64,
}

impl<Q: Send + 'static, A: Send + 'static> Task<Q, A> {
    /// Starts the thread. It calls `waker` after each piece of news.
    pub fn new(
        name: &str,
        waker: Waker,
        waiting: Waiting,
        mut answer: impl FnMut(Q, &Turn<A>) -> Option<A> + Send + 'static,
    ) -> Self {
        let slot = Slot { waiting: VecDeque::new(), running: None, closed: false };
        let inbox = Arc::new(Inbox { slot: Mutex::new(slot), changed: Condvar::new() });
        let (outbox, events) = channel();
        let thread = std::thread::Builder::new().name(name.into()).spawn({
            let (inbox, outbox) = (Arc::clone(&inbox), outbox.clone());
            move || run(&inbox, &outbox, &mut answer, &waker)
        });
        Self { inbox, outbox, events, waiting, thread: thread.ok(), asked: 0, over: 0, unwanted: 0 }
    }

    /// Creates a task that answers only the newest question, without intermediate news.
    pub fn answering(
        name: &str,
        waker: Waker,
        mut answer: impl FnMut(Q) -> Option<A> + Send + 'static,
    ) -> Self {
        Self::new(name, waker, Waiting::Newest, move |question, _| answer(question))
    }

    /// Queues a question and returns its number, which all its news carries.
    pub fn ask(&mut self, question: Q) -> u64 {
        self.asked += 1;
        if self.thread.is_some() {
            let mut slot = self.inbox.lock();
            if self.waiting == Waiting::Newest {
                slot.waiting.clear();
            }
            slot.waiting.push_back((self.asked, question));
            slot.give_way();
            drop(slot);
            self.inbox.changed.notify_all();
        } else {
            // The receiver lives as long as `self`.
            let _ = self.outbox.send((self.asked, Event::Over(Err("no thread could be started".into()))));
        }
        self.asked
    }

    /// Cancels all questions. None of their news will arrive.
    pub fn forget(&mut self) {
        (self.over, self.unwanted) = (self.asked, self.asked);
        self.inbox.lock().cancel();
    }

    /// Requests the running question to end early. Its final news still arrives.
    pub fn stop(&self) {
        self.inbox.lock().cancel_running();
    }

    /// Returns whether the newest question is unanswered.
    pub fn is_busy(&self) -> bool {
        self.over < self.asked
    }

    /// Returns the next piece of news with the number of its question: an answer, intermediate or
    /// final, or the message of a panic.
    pub fn poll(&mut self) -> Option<(u64, Result<A, String>)> {
        for (number, event) in self.events.try_iter().filter(|(number, _)| *number > self.unwanted) {
            if matches!(event, Event::Over(_)) {
                self.over = number;
            }
            match event {
                Event::Told(answer) | Event::Over(Ok(Some(answer))) => return Some((number, Ok(answer))),
                Event::Over(Err(panic)) => return Some((number, Err(panic))),
                Event::Over(Ok(None)) => {}
            }
        }
        None
    }

    /// Returns the newest answer since the last call. It may belong to an earlier question while
    /// the newest one waits. Panics are skipped.
    pub fn latest(&mut self) -> Option<A> {
        std::iter::from_fn(|| self.poll()).filter_map(|(_, news)| news.ok()).last()
    }

    /// Waits until all questions are answered, up to a limit.
    pub fn wait(&self, patience: Duration) {
        let at_work = |slot: &mut Slot<Q>| !slot.waiting.is_empty() || slot.running.is_some();
        // The caller goes on whether or not all is done.
        drop(self.inbox.changed.wait_timeout_while(self.inbox.lock(), patience, at_work));
    }
}

impl<Q, A> Drop for Task<Q, A> {
    fn drop(&mut self) {
        let mut slot = self.inbox.lock();
        slot.closed = true;
        if self.waiting == Waiting::Newest {
            slot.cancel();
        }
        drop(slot);
        self.inbox.changed.notify_all();
        // A slow computation must not hold up the closing window, but files must be written.
        if let Some(thread) = self.thread.take().filter(|_| self.waiting == Waiting::All) {
            // A panic was already reported.
            let _ = thread.join();
        }
    }
}

fn run<Q: Send, A: Send>(
    inbox: &Inbox<Q>,
    outbox: &Sender<(u64, Event<A>)>,
    answer: &mut dyn FnMut(Q, &Turn<A>) -> Option<A>,
    waker: &Waker,
) {
    loop {
        let mut slot = inbox.lock();
        let (number, question) = loop {
            if let Some(next) = slot.waiting.pop_front() {
                break next;
            }
            if slot.closed {
                return;
            }
            slot = inbox.changed.wait(slot).unwrap_or_else(PoisonError::into_inner);
        };
        let cancel = CancelFlag::default();
        slot.running = Some(Running { cancel: cancel.clone(), gives_way: false });
        drop(slot);
        let send = |event| {
            // Nobody receives news after the window has closed.
            let _ = outbox.send((number, event));
            waker.wake();
        };
        let tell = |news| send(Event::Told(news));
        let give_way = || {
            let mut slot = inbox.lock();
            if let Some(running) = &mut slot.running {
                running.gives_way = true;
            }
            slot.give_way();
        };
        let turn = Turn { cancel, tell: &tell, give_way: &give_way };
        let result = catch_unwind(AssertUnwindSafe(|| answer(question, &turn)));
        inbox.lock().running = None;
        inbox.changed.notify_all();
        send(Event::Over(result.map_err(|payload| panic_text(payload.as_ref()))));
    }
}

pub fn panic_text(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".into())
}

/// A task that is asked whenever its question changes.
pub struct Following<Q, A> {
    pub task: Task<Q, A>,
    pub asked: Option<Q>,
    /// Whether the old answer is kept until the next one arrives.
    pub keeps: bool,
}

impl<Q: Clone + PartialEq + Send + 'static, A: Send + 'static> Following<Q, A> {
    /// Creates a task whose answers stay until the next ones arrive.
    pub fn keeping(name: &str, waker: &Waker, answer: impl FnMut(Q) -> A + Send + 'static) -> Self {
        Self { keeps: true, ..Self::strict(name, waker, answer) }
    }

    /// Creates a task whose answers are dropped when the question changes.
    pub fn strict(name: &str, waker: &Waker, mut answer: impl FnMut(Q) -> A + Send + 'static) -> Self {
        let task = Task::answering(name, waker.clone(), move |question| Some(answer(question)));
        Self { task, asked: None, keeps: false }
    }

    /// Asks if the question has changed. Without a question, the answer is dropped.
    pub fn follow(&mut self, question: Option<Q>, answer: &mut Option<A>) {
        if question == self.asked {
            return;
        }
        if question.is_none() || !self.keeps {
            self.forget();
            *answer = None;
        }
        self.asked.clone_from(&question);
        if let Some(question) = question {
            self.task.ask(question);
        }
    }

    /// Cancels the question, because other pictures were opened.
    pub fn forget(&mut self) {
        self.task.forget();
        self.asked = None;
    }

    pub fn take(&mut self, answer: &mut Option<A>) {
        if let Some(found) = self.task.latest() {
            *answer = Some(found);
        }
    }

    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::time::Instant;

    /// Long enough for a busy machine. Reached only when a test fails.
    const PATIENCE: Duration = Duration::from_secs(20);

    fn wait<A: Send + 'static>(task: &mut Task<u32, A>) -> (u64, Result<A, String>) {
        let start = Instant::now();
        loop {
            if let Some(news) = task.poll() {
                return news;
            }
            assert!(start.elapsed() < PATIENCE, "no news");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn overtaken_questions_are_not_answered() {
        let gate = Arc::new(Barrier::new(2));
        let mut task = Task::answering("test", Waker::default(), {
            let gate = Arc::clone(&gate);
            move |question: u32| {
                if question == 1 {
                    gate.wait();
                    gate.wait();
                }
                assert_ne!(question, 2, "an overtaken question");
                Some(question * 10)
            }
        });
        task.ask(1);
        gate.wait();
        for question in [2, 3] {
            task.ask(question);
        }
        gate.wait();
        let mut answers = Vec::new();
        while task.is_busy() {
            answers.extend(task.latest());
        }
        assert_eq!(answers.last(), Some(&30));
        assert!(answers.iter().all(|answer| [10, 30].contains(answer)));
    }

    #[test]
    fn a_panic_is_reported_and_forgotten_questions_are_silent() {
        let mut task = Task::answering("test", Waker::default(), |question: u32| {
            assert!(question != 1, "boom at {question}");
            Some(question)
        });
        task.ask(1);
        assert_eq!(wait(&mut task), (1, Err("boom at 1".to_owned())));
        task.ask(5);
        task.forget();
        assert!(!task.is_busy());
        task.ask(7);
        assert_eq!(wait(&mut task), (3, Ok(7)));
        assert!(!task.is_busy());
    }

    #[test]
    fn a_running_question_is_cancelled_only_after_it_gives_way() {
        let go_on = Arc::new(AtomicU32::new(0));
        let mut task = Task::new("test", Waker::default(), Waiting::Newest, {
            let go_on = Arc::clone(&go_on);
            move |question: u32, turn| {
                while !turn.cancel.is_cancelled() {
                    if go_on.swap(0, Ordering::Relaxed) > 0 {
                        turn.tell(question);
                        turn.give_way();
                    }
                    std::thread::sleep(Duration::from_millis(1));
                }
                None
            }
        });
        let is_at_work = |task: &Task<u32, u32>| {
            task.inbox.lock().running.as_ref().is_some_and(|running| !running.cancel.is_cancelled())
        };
        let begins = |task: &Task<u32, u32>| {
            let started = Instant::now();
            while !is_at_work(task) {
                assert!(started.elapsed() < PATIENCE);
                std::thread::sleep(Duration::from_millis(1));
            }
        };
        let first = task.ask(1);
        begins(&task);
        task.ask(2);
        let newest = task.ask(3);
        assert!(is_at_work(&task), "it has not given way yet, so it goes on although others wait");
        go_on.store(1, Ordering::Relaxed);
        assert_eq!(wait(&mut task), (first, Ok(1)));
        go_on.store(1, Ordering::Relaxed);
        assert_eq!(wait(&mut task), (newest, Ok(3)));
        // The question goes on until a newer one comes.
        let last = task.ask(4);
        begins(&task);
        go_on.store(1, Ordering::Relaxed);
        assert_eq!(wait(&mut task), (last, Ok(4)));
        task.forget();
        std::thread::sleep(Duration::from_millis(20));
        assert!(task.poll().is_none());
    }

    #[test]
    fn dropping_a_task_waits_for_all_questions() {
        let done = Arc::new(AtomicU32::new(0));
        let mut task = Task::new("test", Waker::default(), Waiting::All, {
            let done = Arc::clone(&done);
            move |add: u32, _: &Turn<()>| {
                std::thread::sleep(Duration::from_millis(2));
                done.fetch_add(add, Ordering::Relaxed);
                None
            }
        });
        for add in [1, 10, 100] {
            task.ask(add);
        }
        task.wait(PATIENCE);
        assert_eq!(done.load(Ordering::Relaxed), 111);
        task.ask(1000);
        drop(task);
        assert_eq!(done.load(Ordering::Relaxed), 1111);
    }
}
