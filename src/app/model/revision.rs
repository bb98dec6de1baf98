//! Numbers by which the view tells whether figures or pictures that it keeps are those of now.

use std::sync::atomic::{AtomicU64, Ordering};

static LAST: AtomicU64 = AtomicU64::new(0);

/// A number that nothing else has, whatever images are open.
pub fn fresh() -> u64 {
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}
