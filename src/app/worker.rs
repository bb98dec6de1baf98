//! The thread that computes.
//!
//! One thread runs one request at a time; of those that wait only the newest counts. While a point is dragged
//! a request comes every frame: if each cancelled the one before, none would ever get anywhere. So the running
//! one is left alone until its first result that can be drawn, and is cancelled through its [`CancelFlag`] as
//! soon as it has one and a newer request waits. News carries the generation of its request and never comes
//! after news of a newer one. A panic in the computation becomes [`Failure::Panic`].

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use super::waker::Waker;
use crate::estimate::{
    CancelFlag, ComparedPencils, Estimate, EstimateError, Monitor, Parameters, Progress, Stage,
};
use crate::geometry::PointPair;
use crate::image::Picture;

/// The computation: the estimator of this library, or something that stands in for it.
pub type EstimateFn = dyn FnMut(&Request, &Monitor) -> Result<Estimate, EstimateError> + Send;

/// What is to be computed.
#[derive(Debug, Clone)]
pub struct Request {
    /// The two pictures.
    pub pictures: [Arc<Picture>; 2],
    /// The pairs to estimate from.
    pub pairs: Vec<PointPair>,
    /// Everything else.
    pub parameters: Parameters,
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The estimator said why.
    Estimate(EstimateError),
    /// The computation stopped unexpectedly: a fault of the program.
    Panic(String),
}

/// News of a request.
#[derive(Debug)]
pub enum News {
    /// A stage has begun.
    Started(Stage),
    /// The pencils through the anchors have been compared.
    Pencils(Vec<Arc<ComparedPencils>>),
    /// A result good enough to draw; better ones follow.
    Preliminary(Box<Estimate>),
    /// The end.
    Finished(Result<Box<Estimate>, Failure>),
}

struct Job {
    generation: u64,
    request: Request,
}

/// The job under way.
struct Running {
    cancel: CancelFlag,
    /// Whether it has given a result that can be drawn.
    drawable: bool,
}

#[derive(Default)]
struct Slot {
    waiting: Option<Job>,
    running: Option<Running>,
    closed: bool,
}

impl Slot {
    /// Cancels what is running if it has had its turn and something newer waits.
    fn give_way(&mut self) {
        if let Some(running) = self.running.as_ref().filter(|running| running.drawable)
            && self.waiting.is_some()
        {
            running.cancel.cancel();
        }
    }

    fn cancel(&mut self) {
        self.waiting = None;
        if let Some(running) = &self.running {
            running.cancel.cancel();
        }
    }
}

#[derive(Default)]
struct Shared {
    slot: Mutex<Slot>,
    changed: Condvar,
}

impl Shared {
    /// Computations run outside the lock, so a poisoned lock still guards sound data.
    fn lock(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A handle to the computing thread. Dropping it stops the thread.
pub struct Worker {
    shared: Arc<Shared>,
    sender: Sender<(u64, News)>,
    news: Receiver<(u64, News)>,
    /// Number of the newest request.
    generation: u64,
    /// News of this generation and the ones before is unwanted.
    unwanted: u64,
    /// Whether the thread could be started at all.
    alive: bool,
}

impl Worker {
    /// Starts the thread; it calls `waker` after each piece of news.
    pub fn new(mut estimate: Box<EstimateFn>, waker: Waker) -> Self {
        let shared = Arc::new(Shared::default());
        let (sender, news) = channel();
        let thread = std::thread::Builder::new().name("estimate".into()).spawn({
            let (shared, sender) = (Arc::clone(&shared), sender.clone());
            move || run(&shared, &sender, &mut *estimate, &waker)
        });
        Self { shared, sender, news, generation: 0, unwanted: 0, alive: thread.is_ok() }
    }

    /// Asks for a computation in place of whatever is waiting; what is running gets as far as its first result.
    /// Returns the generation that the news of this request will carry.
    pub fn submit(&mut self, request: Request) -> u64 {
        self.generation += 1;
        if self.alive {
            let mut slot = self.shared.lock();
            slot.waiting = Some(Job { generation: self.generation, request });
            slot.give_way();
            drop(slot);
            self.shared.changed.notify_one();
        } else {
            let failure = Failure::Panic("no thread could be started".into());
            // The receiver lives as long as `self`.
            let _ = self.sender.send((self.generation, News::Finished(Err(failure))));
        }
        self.generation
    }

    /// Stops what is running or waiting; none of its news will arrive.
    pub fn cancel(&mut self) {
        self.unwanted = self.generation;
        self.shared.lock().cancel();
    }

    /// The next piece of news, with the generation of its request.
    pub fn poll(&self) -> Option<(u64, News)> {
        self.news.try_iter().find(|(generation, _)| *generation > self.unwanted)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // The thread is not joined: a computation slow to notice must not hold up the closing window.
        let mut slot = self.shared.lock();
        slot.cancel();
        slot.closed = true;
        drop(slot);
        self.shared.changed.notify_one();
    }
}

/// The thread's loop.
fn run(shared: &Shared, sender: &Sender<(u64, News)>, estimate: &mut EstimateFn, waker: &Waker) {
    loop {
        let mut slot = shared.lock();
        let Job { generation, request } = loop {
            if slot.closed {
                return;
            }
            if let Some(job) = slot.waiting.take() {
                break job;
            }
            slot = shared.changed.wait(slot).unwrap_or_else(PoisonError::into_inner);
        };
        let cancel = CancelFlag::default();
        slot.running = Some(Running { cancel: cancel.clone(), drawable: false });
        drop(slot);
        let tell = |news| {
            // Nobody listens any more when the window has closed.
            let _ = sender.send((generation, news));
            waker.wake();
        };
        let monitor = Monitor::new(cancel, |progress| match progress {
            Progress::Started(stage) => tell(News::Started(stage)),
            Progress::Pencils(pencils) => tell(News::Pencils(pencils)),
            Progress::Preliminary(estimate) => {
                tell(News::Preliminary(estimate));
                let mut slot = shared.lock();
                if let Some(running) = &mut slot.running {
                    running.drawable = true;
                }
                slot.give_way();
            }
        });
        let result = catch_unwind(AssertUnwindSafe(|| estimate(&request, &monitor)));
        shared.lock().running = None;
        tell(News::Finished(match result {
            Ok(Ok(estimate)) => Ok(Box::new(estimate)),
            Ok(Err(error)) => Err(Failure::Estimate(error)),
            Err(payload) => Err(Failure::Panic(panic_text(payload.as_ref()))),
        }));
    }
}

/// The message of a panic.
pub fn panic_text(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use std::time::{Duration, Instant};

    /// Long enough for a loaded machine; reached only when something is wrong.
    const PATIENCE: Duration = Duration::from_secs(20);

    fn wait(worker: &Worker) -> (u64, News) {
        let start = Instant::now();
        loop {
            if let Some(news) = worker.poll() {
                return news;
            }
            assert!(start.elapsed() < PATIENCE, "no news");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn finish(worker: &Worker) -> (u64, Result<Box<Estimate>, Failure>) {
        loop {
            if let (generation, News::Finished(result)) = wait(worker) {
                return (generation, result);
            }
        }
    }

    /// A computation that reports a preliminary result whenever it is let to, and ends when it is cancelled.
    fn endless(go_on: Receiver<()>) -> Box<EstimateFn> {
        Box::new(move |request, monitor| {
            loop {
                monitor.check()?;
                if go_on.try_recv().is_ok() {
                    let estimate = fake::estimate(request, monitor);
                    estimate?;
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        })
    }

    #[test]
    fn delivers_preliminary_results_before_the_final_one() {
        let mut worker = Worker::new(Box::new(fake::estimate), Waker::default());
        worker.submit(fake::request(0.0));
        let mut preliminary = 0;
        loop {
            match wait(&worker).1 {
                News::Started(_) | News::Pencils(_) => {}
                News::Preliminary(_) => preliminary += 1,
                News::Finished(result) => break assert!(result.is_ok()),
            }
        }
        assert_eq!(preliminary, 1);
    }

    #[test]
    fn a_running_request_reaches_its_first_result_and_then_gives_way_to_the_newest() {
        let (go_on, gate) = channel();
        let mut worker = Worker::new(endless(gate), Waker::default());
        let first = worker.submit(fake::request(0.0));
        let started = Instant::now();
        while worker.shared.lock().running.is_none() {
            assert!(started.elapsed() < PATIENCE);
            std::thread::sleep(Duration::from_millis(1));
        }
        worker.submit(fake::request(2.0));
        let newest = worker.submit(fake::request(3.0));
        // It has nothing to show yet, so it goes on although others wait.
        assert!(worker.shared.lock().running.as_ref().is_some_and(|running| !running.cancel.is_cancelled()));
        go_on.send(()).unwrap();
        let (generation, result) = finish(&worker);
        assert_eq!((generation, result.unwrap_err()), (first, Failure::Estimate(EstimateError::Cancelled)));
        go_on.send(()).unwrap();
        let generation = loop {
            if let (generation, News::Preliminary(_)) = wait(&worker) {
                break generation;
            }
        };
        assert_eq!(generation, newest, "the one in between was overtaken");
        // Nothing newer waits: it may go on until one comes.
        worker.submit(fake::request(4.0));
        assert_eq!(finish(&worker).0, newest);
    }

    #[test]
    fn a_panic_becomes_an_error_and_the_worker_lives_on() {
        let mut worker = Worker::new(
            Box::new(|request, monitor| {
                assert!(request.pairs[0].point1.x >= 1.0, "boom at {}", request.pairs[0].point1.x);
                fake::estimate(request, monitor)
            }),
            Waker::default(),
        );
        worker.submit(fake::request(0.0));
        assert_eq!(finish(&worker).1.unwrap_err(), Failure::Panic("boom at 0".into()));
        worker.submit(fake::request(2.0));
        assert!(finish(&worker).1.is_ok());
    }

    #[test]
    fn errors_of_the_estimator_come_through_and_cancelled_work_is_silent() {
        let mut worker = Worker::new(Box::new(|_, _| Err(EstimateError::NoGeometry)), Waker::default());
        worker.submit(fake::request(0.0));
        assert_eq!(finish(&worker).1.unwrap_err(), Failure::Estimate(EstimateError::NoGeometry));
        worker.submit(fake::request(0.0));
        worker.cancel();
        std::thread::sleep(Duration::from_millis(20));
        assert!(worker.poll().is_none());
    }
}
