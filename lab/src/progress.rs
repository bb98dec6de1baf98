//! Progress of the trials on standard error.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use epiline::internals::{cli::tell, excerpt};

use crate::TrialDone;

/// Progress on standard error: one changing line on a terminal, occasional lines in a log.
pub(super) struct ProgressLine {
    started: Instant,
    watched: bool,
    last: Mutex<Option<Instant>>,
}

impl ProgressLine {
    pub(super) fn new() -> Self {
        Self { started: Instant::now(), watched: std::io::stderr().is_terminal(), last: Mutex::new(None) }
    }

    pub(super) fn hear(&self, news: &TrialDone) {
        let pause = Duration::from_millis(if self.watched { 100 } else { 10_000 });
        // A poisoned lock still holds the last time.
        let mut last = self.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if news.done < news.total && last.is_some_and(|t| t.elapsed() < pause) {
            return;
        }
        *last = Some(Instant::now());
        let elapsed = self.started.elapsed().as_secs_f64();
        let left = elapsed / news.done as f64 * (news.total - news.done) as f64;
        let error =
            if news.error.is_finite() { format!("{:.2} px", news.error) } else { "no geometry".into() };
        let line = format!(
            "{} of {} trials, about {} left; {} {}: {error}",
            news.done,
            news.total,
            duration(left),
            news.pair,
            news.contender
        );
        if self.watched { tell_in_place(&line) } else { tell(line) }
    }

    pub(super) fn finish(&self) {
        if self.watched {
            tell_in_place("");
        }
    }
}

/// Overwrites the current line of the terminal. Errors are ignored: there is no other channel.
fn tell_in_place(line: &str) {
    let mut err = std::io::stderr();
    let _ = write!(err, "\r\x1b[2K{}", excerpt(line)).and_then(|()| err.flush());
}

/// Formats seconds, or minutes and seconds.
fn duration(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    if seconds < 60 { format!("{seconds} s") } else { format!("{} min {:02} s", seconds / 60, seconds % 60) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_well() {
        assert_eq!([0.4, 59.4, 61.0, 3600.0].map(duration), ["0 s", "59 s", "1 min 01 s", "60 min 00 s"]);
    }
}
