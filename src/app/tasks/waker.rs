//! Wakes the window from other threads.

use std::sync::{Arc, OnceLock};

/// A handle that wakes the window. It has no effect before the first frame of the window.
#[derive(Clone, Default)]
pub struct Waker(Arc<OnceLock<egui::Context>>);

impl Waker {
    /// Sets the window to wake. Only the first call has an effect.
    pub fn attach(&self, ctx: &egui::Context) {
        self.0.get_or_init(|| ctx.clone());
    }

    /// Requests a new frame.
    pub fn wake(&self) {
        if let Some(ctx) = self.0.get() {
            ctx.request_repaint();
        }
    }
}
