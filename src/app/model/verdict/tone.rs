//! Whether what is said is good news or bad.

/// How the news is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// There is nothing yet.
    Idle,
    /// Work is under way.
    Busy,
    /// A result to rely on.
    Good,
    /// A result with something to know about it.
    Caution,
    /// No result.
    Bad,
}
