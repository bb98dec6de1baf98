//! What comes from outside: opening files that may be anything, and showing texts that anybody may have written.
//!
//! A path can lead to a named pipe that nobody writes to, to a device without an end, or round in a circle; a name or a
//! line of a file can be megabytes long and hold the codes that a terminal obeys. Everything that opens a file for
//! reading goes through [`open_input`], and every foreign word in a message through [`excerpt`] or [`shown_path`].

mod input;
mod text;

pub(crate) use input::{open_input, reason};
#[cfg(feature = "cli")]
pub(crate) use text::escaped_lines;
pub(crate) use text::{escaped, excerpt, shown_path};
