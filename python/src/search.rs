//! Computations without the lock of the interpreter, which Ctrl-C stops and a callback follows.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use epiline::estimate::{CancelFlag, Event, EventKind, Monitor, Progress};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::input;

/// Time between two looks at the signals of the process.
const PATIENCE: Duration = Duration::from_millis(50);

/// Largest number of threads, as for the command line.
const MOST_THREADS: usize = 256;

/// Threads of a process, with its number.
static OWN: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Threads for a computation.
pub struct Threads(Option<Arc<ThreadPool>>);

impl Threads {
    /// Starts this many threads.
    pub fn new(py: Python<'_>, count: usize) -> PyResult<Self> {
        if !(1..=MOST_THREADS).contains(&count) {
            return Err(input(py, format!("threads is at least 1 and at most {MOST_THREADS}")));
        }
        let made = ThreadPoolBuilder::new().num_threads(count).build();
        let made = made.map_err(|error| input(py, format!("cannot start {count} threads: {error}")))?;
        Ok(Self(Some(Arc::new(made))))
    }

    /// Returns the threads of this process, one for each core. A fork has none of the threads of its parent, so work on
    /// those would never end.
    pub fn of_process() -> Self {
        let process = std::process::id();
        let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, pool)) = &*own
            && *of == process
        {
            return Self(Some(Arc::clone(pool)));
        }
        let made = ThreadPoolBuilder::new().build().ok().map(Arc::new);
        // The threads of a parent cannot be ended here.
        std::mem::forget(std::mem::replace(&mut *own, made.clone().map(|pool| (process, pool))));
        Self(made)
    }

    /// Starts this many threads, or returns those of this process.
    pub fn given(py: Python<'_>, count: Option<usize>) -> PyResult<Self> {
        count.map_or_else(|| Ok(Self::of_process()), |count| Self::new(py, count))
    }

    /// Runs work on the threads.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// Runs work with a monitor on these threads. `progress` is called with the name of each stage and the seconds until it
/// began, on the thread of the caller. Its exceptions and Ctrl-C stop the work.
pub fn watched<T: Send>(
    py: Python<'_>,
    threads: &Threads,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Monitor) -> T + Send,
) -> PyResult<T> {
    let cancel = CancelFlag::default();
    let (sender, mut receiver) = channel();
    let begun = Instant::now();
    let mut stopped = None;
    let done = std::thread::scope(|scope| {
        let flag = cancel.clone();
        let task = scope.spawn(move || {
            let monitor = Monitor::new(flag, move |news| {
                if let Progress::Happened(Event { kind: EventKind::Began(stage), .. }) = news {
                    // Nobody may listen any more.
                    let _ = sender.send((stage.label(), begun.elapsed().as_secs_f64()));
                }
            });
            threads.run(|| work(&monitor))
        });
        loop {
            let (kept, news) = py.detach(move || {
                let news = receiver.recv_timeout(PATIENCE);
                (receiver, news)
            });
            receiver = kept;
            let called = match (news, progress) {
                (Err(RecvTimeoutError::Disconnected), _) => break,
                (Ok(news), Some(progress)) if stopped.is_none() => progress.call1(news).map(|_| ()),
                _ => Ok(()),
            };
            if let Err(error) = called.and_then(|()| py.check_signals()) {
                cancel.cancel();
                stopped.get_or_insert(error);
            }
        }
        py.detach(|| task.join())
    });
    match (stopped, done) {
        (Some(error), _) => Err(error),
        (None, Ok(found)) => Ok(found),
        (None, Err(_)) => Err(PyRuntimeError::new_err("internal error, please report it")),
    }
}
