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

/// Runs work on threads of this process. A fork has none of the threads of its parent, so work on those would never end.
pub fn on_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let process = std::process::id();
    let pool = {
        let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
        match &*own {
            Some((of, pool)) if *of == process => Some(Arc::clone(pool)),
            _ => {
                let made = ThreadPoolBuilder::new().build().ok().map(Arc::new);
                // The threads of a parent cannot be ended here.
                std::mem::forget(std::mem::replace(&mut *own, made.clone().map(|pool| (process, pool))));
                made
            }
        }
    };
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Runs work with a monitor on other threads. `progress` is called with the name of each stage and the seconds until it
/// began, on the thread of the caller. Its exceptions and Ctrl-C stop the work.
pub fn watched<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Monitor) -> T + Send,
) -> PyResult<T> {
    if threads.is_some_and(|threads| !(1..=MOST_THREADS).contains(&threads)) {
        return Err(input(py, format!("threads is at least 1 and at most {MOST_THREADS}")));
    }
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
            let Some(threads) = threads else { return Ok::<_, String>(on_threads(|| work(&monitor))) };
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            Ok(pool
                .map_err(|error| format!("cannot start {threads} threads: {error}"))?
                .install(|| work(&monitor)))
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
        (None, Ok(Ok(found))) => Ok(found),
        (None, Ok(Err(problem))) => Err(input(py, problem)),
        (None, Err(_)) => Err(PyRuntimeError::new_err("internal error, please report it")),
    }
}
