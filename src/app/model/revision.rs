//! Unique numbers. The view compares them to tell whether its cached figures or pictures are
//! current.

use std::sync::atomic::{AtomicU64, Ordering};

static LAST: AtomicU64 = AtomicU64::new(0);

/// Returns a number that was never returned before.
pub fn fresh() -> u64 {
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}
