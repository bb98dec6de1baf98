//! Good or bad news.

/// Colour of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// No result yet.
    Idle,
    /// Work in progress.
    Busy,
    /// A reliable result.
    Good,
    /// A result with warnings.
    Caution,
    /// No result, or an unreliable one.
    Bad,
    /// The pictures probably show different scenes, so there is no geometry to judge.
    Apart,
}
