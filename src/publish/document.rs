//! Content of a document.

use super::plot::SvgDrawing;

/// Document of numbered tables and figures under headings. All texts are plain.
#[derive(Debug, Clone)]
pub struct Publication {
    /// Title of the document.
    pub title: String,
    /// Line below the title.
    pub subtitle: String,
    /// Content in order.
    pub blocks: Vec<Block>,
}

/// Element of a document.
#[derive(Debug, Clone)]
pub enum Block {
    /// Heading of a section.
    Section(String),
    /// Heading of a subsection.
    Subsection(String),
    /// Paragraph of text.
    Paragraph(String),
    /// Command to copy into a shell.
    Command(String),
    /// List of short sentences.
    List(Vec<String>),
    /// Names with their values, without number or caption.
    Facts(Vec<(String, String)>),
    /// Numbered table.
    Table(TextTable),
    /// Numbered figure.
    Figure(Figure),
}

/// Table with a caption.
#[derive(Debug, Clone)]
pub struct TextTable {
    /// Caption of the table.
    pub caption: String,
    /// Column headings.
    pub headings: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
    /// Number of text columns from the left; the others hold numbers.
    pub words: usize,
    /// Rows that begin a group, except the first.
    pub ruled: Vec<usize>,
}

/// Drawing with a caption.
#[derive(Debug, Clone)]
pub struct Figure {
    /// File name without extension: lower-case letters, digits and `-`.
    pub name: String,
    /// Drawing of the figure.
    pub drawing: SvgDrawing,
    /// Caption of the figure.
    pub caption: String,
}

impl Publication {
    /// Creates an empty document.
    pub fn new(title: impl Into<String>, subtitle: impl Into<String>) -> Self {
        Self { title: title.into(), subtitle: subtitle.into(), blocks: Vec::new() }
    }

    /// Appends the heading of a section.
    pub fn section(&mut self, heading: impl Into<String>) {
        self.blocks.push(Block::Section(heading.into()));
    }

    /// Appends the heading of a subsection.
    pub fn subsection(&mut self, heading: impl Into<String>) {
        self.blocks.push(Block::Subsection(heading.into()));
    }

    /// Appends a paragraph.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Appends a command.
    pub fn command(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Command(text.into()));
    }

    /// Appends a list, unless it is empty.
    pub fn list(&mut self, items: Vec<String>) {
        if !items.is_empty() {
            self.blocks.push(Block::List(items));
        }
    }

    /// Appends names with their values.
    pub fn facts(&mut self, facts: Vec<(String, String)>) {
        self.blocks.push(Block::Facts(facts));
    }

    /// Appends a table.
    pub fn table(&mut self, table: TextTable) {
        self.blocks.push(Block::Table(table));
    }

    /// Appends a figure.
    pub fn figure(&mut self, name: impl Into<String>, drawing: SvgDrawing, caption: impl Into<String>) {
        self.blocks.push(Block::Figure(Figure { name: name.into(), drawing, caption: caption.into() }));
    }

    /// Returns the blocks with the number of each table and figure, counted separately from 1;
    /// others have 0.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (usize, &Block)> {
        let (mut tables, mut figures) = (0, 0);
        self.blocks.iter().map(move |block| {
            let counter = match block {
                Block::Table(_) => &mut tables,
                Block::Figure(_) => &mut figures,
                _ => return (0, block),
            };
            *counter += 1;
            (*counter, block)
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use maud::html as markup;

    /// Returns a document with one block of each kind and two figures. Every text is `text`.
    pub(in crate::publish) fn example(text: &str) -> Publication {
        let drawing = SvgDrawing::new(20.0, 10.0, markup! { text x="1" y="9" { (text) } });
        let mut document = Publication::new(text, text);
        document.section(text);
        document.figure("first", drawing.clone(), text);
        document.subsection(text);
        document.paragraph(text);
        document.command(text);
        document.list(vec![text.to_owned()]);
        document.facts(vec![(text.to_owned(), text.to_owned())]);
        let cells = || vec![text.to_owned(), "1.5".to_owned()];
        document.table(TextTable {
            caption: text.to_owned(),
            headings: cells(),
            rows: vec![cells(), cells()],
            words: 1,
            ruled: vec![1],
        });
        document.figure("second", drawing, text);
        document
    }

    #[test]
    fn an_empty_list_is_none() {
        let mut document = Publication::new("", "");
        document.list(Vec::new());
        assert!(document.blocks.is_empty());
    }
}
