//! What a document consists of.

use super::plot::SvgDrawing;

/// A document of numbered tables and figures under headings. All texts are plain.
#[derive(Debug, Clone)]
pub struct Publication {
    /// Title on top of it.
    pub title: String,
    /// One line below the title.
    pub subtitle: String,
    /// Content in order.
    pub blocks: Vec<Block>,
}

/// A piece of a document.
#[derive(Debug, Clone)]
pub enum Block {
    /// Begins a section.
    Section(String),
    /// Begins a part of a section.
    Subsection(String),
    /// A paragraph.
    Paragraph(String),
    /// What someone types, to be copied.
    Command(String),
    /// Short sentences, one below the other.
    List(Vec<String>),
    /// Names with their values, without number or caption.
    Facts(Vec<(String, String)>),
    /// A table.
    Table(TextTable),
    /// A figure.
    Figure(Figure),
}

/// A table with a caption.
#[derive(Debug, Clone)]
pub struct TextTable {
    /// What it shows.
    pub caption: String,
    /// Names of the columns.
    pub headings: Vec<String>,
    /// The cells, row by row.
    pub rows: Vec<Vec<String>>,
    /// How many columns from the left hold words; the others hold numbers.
    pub words: usize,
    /// Rows that begin a group, the first one not among them.
    pub ruled: Vec<usize>,
}

/// A drawing with a caption.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of its file where it has one: lower-case letters, digits and `-`.
    pub name: String,
    /// The drawing.
    pub drawing: SvgDrawing,
    /// What it shows.
    pub caption: String,
}

impl Publication {
    /// A document without content.
    pub fn new(title: impl Into<String>, subtitle: impl Into<String>) -> Self {
        Self { title: title.into(), subtitle: subtitle.into(), blocks: Vec::new() }
    }

    /// Appends a section's heading.
    pub fn section(&mut self, heading: impl Into<String>) {
        self.blocks.push(Block::Section(heading.into()));
    }

    /// Appends the heading of a part of a section.
    pub fn subsection(&mut self, heading: impl Into<String>) {
        self.blocks.push(Block::Subsection(heading.into()));
    }

    /// Appends a paragraph.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Appends what someone types.
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

    /// The content, where tables and figures have their number, each kind counted from 1, and others 0.
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

    /// A document with one block of each kind and two figures, which says `text` everywhere.
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
