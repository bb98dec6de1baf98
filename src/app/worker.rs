//! The thread that computes.
//!
//! One thread runs one request at a time. A newer request cancels the running one through its
//! [`CancelFlag`] and replaces the waiting one; each carries a generation number, and [`Worker::poll`]
//! drops news of older generations, so that an old result can never overwrite a newer one. A panic in
//! the computation becomes [`Failure::Panic`].

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};

use crate::estimate::{
    CancelFlag, ComparedPencils, Estimate, EstimateError, Monitor, Parameters, PreparedPair, Progress, Stage,
    estimate_prepared,
};
use crate::geometry::PointPair;
use crate::image::Picture;

/// The computation: [`estimator`], or something that stands in for it.
pub type EstimateFn = dyn FnMut(&Request, &Monitor) -> Result<Estimate, EstimateError> + Send;

/// The estimator of this library. It keeps what depends on the pictures alone from one request to the next,
/// so that moving a point costs only what depends on the point.
pub fn estimator() -> Box<EstimateFn> {
    let mut kept: Option<([Arc<Picture>; 2], PreparedPair)> = None;
    Box::new(move |request, monitor| {
        let same = |pictures: &[Arc<Picture>; 2]| {
            pictures.iter().zip(&request.pictures).all(|(a, b)| Arc::ptr_eq(a, b))
        };
        let (_, prepared) = match kept.take() {
            Some((pictures, prepared)) if same(&pictures) => kept.insert((pictures, prepared)),
            _ => {
                let [image1, image2] = &request.pictures;
                kept.insert((request.pictures.clone(), PreparedPair::new(&image1.gray, &image2.gray)))
            }
        };
        estimate_prepared(prepared, &request.pairs, &request.parameters, monitor)
    })
}

/// Wakes the window from another thread. Works from its first frame on; before, there is nothing to wake.
#[derive(Clone, Default)]
pub struct Waker(Arc<OnceLock<egui::Context>>);

impl Waker {
    /// Names the window to wake; only the first call counts.
    pub fn attach(&self, ctx: &egui::Context) {
        self.0.get_or_init(|| ctx.clone());
    }

    /// Asks for a new frame.
    pub fn wake(&self) {
        if let Some(ctx) = self.0.get() {
            ctx.request_repaint();
        }
    }
}

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

/// News of the current request.
#[derive(Debug)]
pub enum News {
    /// A stage has begun.
    Started(Stage),
    /// The pencils through the first two clicks have been compared.
    Pencils(Arc<[ComparedPencils; 2]>),
    /// A result good enough to draw; better ones follow.
    Preliminary(Box<Estimate>),
    /// The end.
    Finished(Result<Box<Estimate>, Failure>),
}

struct Job {
    generation: u64,
    cancel: CancelFlag,
    request: Request,
}

#[derive(Default)]
struct Slot {
    waiting: Option<Job>,
    closed: bool,
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
    generation: u64,
    cancel: CancelFlag,
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
        Self { shared, sender, news, generation: 0, cancel: CancelFlag::default(), alive: thread.is_ok() }
    }

    /// Asks for a computation in place of whatever is running or waiting.
    pub fn submit(&mut self, request: Request) {
        self.cancel();
        if !self.alive {
            let failure = Failure::Panic("no thread could be started".into());
            // The receiver lives as long as `self`.
            let _ = self.sender.send((self.generation, News::Finished(Err(failure))));
            return;
        }
        let job = Job { generation: self.generation, cancel: self.cancel.clone(), request };
        self.shared.lock().waiting = Some(job);
        self.shared.changed.notify_one();
    }

    /// Stops what is running or waiting; none of its news will arrive.
    pub fn cancel(&mut self) {
        self.cancel.cancel();
        self.cancel = CancelFlag::default();
        self.generation += 1;
        self.shared.lock().waiting = None;
    }

    /// The next piece of news of the current request, if there is one.
    pub fn poll(&self) -> Option<News> {
        self.news.try_iter().find(|(generation, _)| *generation == self.generation).map(|(_, news)| news)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // The thread is not joined: a computation slow to notice must not hold up the closing window.
        self.cancel.cancel();
        self.shared.lock().closed = true;
        self.shared.changed.notify_one();
    }
}

/// The thread's loop.
fn run(shared: &Shared, sender: &Sender<(u64, News)>, estimate: &mut EstimateFn, waker: &Waker) {
    loop {
        let mut slot = shared.lock();
        let job = loop {
            if slot.closed {
                return;
            }
            if let Some(job) = slot.waiting.take() {
                break job;
            }
            slot = shared.changed.wait(slot).unwrap_or_else(PoisonError::into_inner);
        };
        drop(slot);
        let Job { generation, cancel, request } = job;
        let tell = |news| {
            // Nobody listens any more when the window has closed.
            let _ = sender.send((generation, news));
            waker.wake();
        };
        let monitor = Monitor::new(cancel, |progress| {
            tell(match progress {
                Progress::Started(stage) => News::Started(stage),
                Progress::Pencils(pencils) => News::Pencils(pencils),
                Progress::Preliminary(estimate) => News::Preliminary(estimate),
            });
        });
        let result = catch_unwind(AssertUnwindSafe(|| estimate(&request, &monitor)));
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

    fn wait(worker: &Worker) -> News {
        let start = Instant::now();
        loop {
            if let Some(news) = worker.poll() {
                return news;
            }
            assert!(start.elapsed() < PATIENCE, "no news");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn finish(worker: &Worker) -> Result<Box<Estimate>, Failure> {
        loop {
            if let News::Finished(result) = wait(worker) {
                return result;
            }
        }
    }

    #[test]
    fn delivers_preliminary_results_before_the_final_one() {
        let mut worker = Worker::new(Box::new(fake::estimate), Waker::default());
        worker.submit(fake::request(0.0));
        let mut preliminary = 0;
        loop {
            match wait(&worker) {
                News::Started(_) | News::Pencils(_) => {}
                News::Preliminary(_) => preliminary += 1,
                News::Finished(result) => break assert!(result.is_ok()),
            }
        }
        assert_eq!(preliminary, 1);
    }

    #[test]
    fn a_newer_request_cancels_the_older_one_and_hides_its_news() {
        let mut worker = Worker::new(
            Box::new(|request, monitor| {
                // The first request runs until it is cancelled.
                while request.pairs[0].point1.x < 1.0 && !monitor.is_cancelled() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                let mut estimate = fake::estimate(request, monitor)?;
                estimate.score = request.pairs[0].point1.x;
                Ok(estimate)
            }),
            Waker::default(),
        );
        worker.submit(fake::request(0.0));
        std::thread::sleep(Duration::from_millis(20));
        worker.submit(fake::request(2.0));
        worker.submit(fake::request(3.0));
        let estimate = finish(&worker).unwrap();
        assert!((estimate.score - 3.0).abs() < 1e-12);
        assert!(worker.poll().is_none());
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
        assert_eq!(finish(&worker).unwrap_err(), Failure::Panic("boom at 0".into()));
        worker.submit(fake::request(2.0));
        assert!(finish(&worker).is_ok());
    }

    #[test]
    fn errors_of_the_estimator_come_through_and_cancelled_work_is_silent() {
        let mut worker = Worker::new(Box::new(|_, _| Err(EstimateError::NoGeometry)), Waker::default());
        worker.submit(fake::request(0.0));
        assert_eq!(finish(&worker).unwrap_err(), Failure::Estimate(EstimateError::NoGeometry));
        worker.submit(fake::request(0.0));
        worker.cancel();
        std::thread::sleep(Duration::from_millis(20));
        assert!(worker.poll().is_none());
    }
}
