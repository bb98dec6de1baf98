//! Values that are made at their first use, by work on all threads of the pool.

use std::sync::{Mutex, OnceLock, PoisonError};

/// A value that is made at its first use and kept.
///
/// No thread of the pool waits here. It makes the value itself, and the first finished value is
/// kept. With a `OnceLock`, threads of the pool could wait for the thread that makes the value,
/// which in turn needs threads of the pool. A thread could even meet its own lock when it takes up
/// other work in between. Threads outside the pool wait for the one that makes the value. Every
/// call must make the same value.
#[derive(Debug)]
pub(crate) struct Lazy<T> {
    value: OnceLock<T>,
    making: Mutex<()>,
}

impl<T> Default for Lazy<T> {
    fn default() -> Self {
        Self { value: OnceLock::new(), making: Mutex::default() }
    }
}

impl<T> Lazy<T> {
    /// Returns the value if it is made already.
    pub fn get(&self) -> Option<&T> {
        self.value.get()
    }

    pub fn get_or_make(&self, make: impl FnOnce() -> T) -> &T {
        if let Some(made) = self.value.get() {
            return made;
        }
        let is_of_the_pool = rayon::current_thread_index().is_some();
        // The lock guards no data, so a panic of its holder does no harm.
        let _turn = (!is_of_the_pool).then(|| self.making.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some(made) = self.value.get() {
            return made;
        }
        let fresh = make();
        self.value.get_or_init(|| fresh)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Duration;

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn threads_outside_the_pool_wait_instead_of_making_the_value_again() {
        let (once, makings) = (Lazy::default(), AtomicUsize::new(0));
        let make = || {
            thread::sleep(Duration::from_millis(20));
            makings.fetch_add(1, Ordering::Relaxed)
        };
        let found: Vec<usize> = thread::scope(|scope| {
            let asking: Vec<_> = (0..4).map(|_| scope.spawn(|| *once.get_or_make(make))).collect();
            asking.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert_eq!((found, makings.into_inner()), (vec![0; 4], 1));
    }

    #[test]
    fn threads_of_the_pool_never_wait() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let once = Lazy::default();
        // Each request comes from a thread of the pool, and its work needs both threads.
        let make = || (0..64_u64).into_par_iter().map(|k| thread::sleep(Duration::from_micros(k))).count();
        let found: Vec<usize> =
            pool.install(|| (0..64).into_par_iter().map(|_| *once.get_or_make(make)).collect());
        assert_eq!(found, vec![64; 64]);
    }

    #[test]
    fn all_threads_get_the_first_finished_value() {
        let once = Lazy::default();
        let addresses: Vec<usize> = (0..64)
            .into_par_iter()
            .map(|_| std::ptr::from_ref(once.get_or_make(|| [0_u8; 8])).addr())
            .collect();
        assert!(addresses.iter().all(|address| *address == addresses[0]));
    }

    #[test]
    fn after_a_panic_the_next_call_makes_the_value() {
        let once = Lazy::<u8>::default();
        let panics = thread::scope(|scope| scope.spawn(|| *once.get_or_make(|| panic!("on purpose"))).join());
        assert!(panics.is_err());
        assert_eq!(*once.get_or_make(|| 7), 7);
    }
}
