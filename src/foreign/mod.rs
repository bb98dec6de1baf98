//! Untrusted input: opening files of any kind, and quoting text of unknown origin.
//!
//! A path can lead to a named pipe without a writer, to an endless device, or into a loop of links.
//! A name or a line of a file can be megabytes long and can hold terminal control codes. Every file
//! is opened for reading by [`open_input`]. Every foreign word in a message passes through
//! [`excerpt`] or [`shown_path`].

mod input;
mod text;

pub(crate) use input::{open_input, reason};
#[cfg(feature = "cli")]
pub(crate) use text::escaped_lines;
pub use text::excerpt;
pub(crate) use text::{escaped, shown_path};
