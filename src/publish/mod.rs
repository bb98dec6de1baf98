//! Documents of text, tables and figures, as a single HTML page or as Markdown with figure files.
//!
//! A [`Publication`] holds the content in order. [`html`] and [`markdown`] only decide its
//! appearance, so both outputs have the same content. Figures are [`plot::SvgDrawing`]s in both.
//! All texts are plain: the writers escape characters with a meaning in HTML, SVG or Markdown.
//!
//! The module is independent of the subject of a document.

mod document;
mod html;
mod markdown;
pub mod plot;

pub use document::{Block, Figure, Publication, TextTable};
pub use html::html;
pub use markdown::{MarkdownFiles, markdown};
