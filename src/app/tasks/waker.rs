//! Waking the window from other threads.

use std::sync::{Arc, OnceLock};

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
