//! Documents of text, tables and figures, written as one HTML page or as Markdown with its figures beside it.
//!
//! A [`Publication`] says what is in it and in which order; [`html`] and [`markdown`] say how that looks and decide
//! nothing else, so the two cannot differ. Figures are [`plot::SvgDrawing`]s in both. Every text that goes in is
//! plain text: what has a meaning in HTML, SVG or Markdown is escaped by the writers.
//!
//! Nothing here knows what is written about.

mod document;
mod html;
mod markdown;
pub mod plot;

pub use document::{Block, Figure, Publication, TextTable};
pub use html::html;
pub use markdown::{MarkdownFiles, markdown};
