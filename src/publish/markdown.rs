//! Output of a document as Markdown (GitHub's flavour, for its tables), with a file per figure.

use std::fmt::Write;

use super::{Block, Publication, TextTable};

/// Files of a Markdown document.
#[derive(Debug, Clone)]
pub struct MarkdownFiles {
    /// Markdown text.
    pub text: String,
    /// File name and content of each figure. The text links to `FOLDER/NAME`.
    pub figures: Vec<(String, String)>,
}

/// Returns the Markdown text, and its figures for a folder beside it.
///
/// `folder` is the name of that folder, without characters that have a meaning in a URL.
pub fn markdown(document: &Publication, folder: &str) -> MarkdownFiles {
    let mut text = format!("# {}\n\n{}\n", escaped(&document.title), escaped(&document.subtitle));
    let mut figures = Vec::new();
    for (number, block) in document.numbered() {
        text.push('\n');
        // Writing to a string cannot fail.
        let _ = match block {
            Block::Section(heading) => writeln!(text, "## {}", escaped(heading)),
            Block::Subsection(heading) => writeln!(text, "### {}", escaped(heading)),
            Block::Paragraph(words) => writeln!(text, "{}", escaped(words)),
            Block::Command(words) => writeln!(text, "    {}", words.replace(['\n', '\r'], " ")),
            Block::List(items) => items.iter().try_for_each(|item| writeln!(text, "- {}", escaped(item))),
            Block::Facts(facts) => facts
                .iter()
                .try_for_each(|(name, value)| writeln!(text, "- {}: {}", escaped(name), escaped(value))),
            Block::Table(table) => write_table(&mut text, number, table),
            Block::Figure(figure) => {
                let caption = escaped(&figure.caption);
                let file = format!("{folder}/{}.svg", figure.name);
                figures.push((format!("{}.svg", figure.name), figure.drawing.file(&figure.caption)));
                writeln!(text, "![Figure {number}]({file})\n\n**Figure {number}.** {caption}")
            }
        };
    }
    MarkdownFiles { text, figures }
}

fn write_table(text: &mut String, number: usize, table: &TextTable) -> std::fmt::Result {
    let line = |cells: &[String]| {
        let cells: Vec<_> = cells.iter().map(|cell| escaped(cell)).collect();
        format!("| {} |", cells.join(" | "))
    };
    let rule: Vec<_> =
        (0..table.headings.len()).map(|column| if column < table.words { ":---" } else { "---:" }).collect();
    writeln!(text, "**Table {number}.** {}\n", escaped(&table.caption))?;
    writeln!(text, "{}", line(&table.headings))?;
    writeln!(text, "| {} |", rule.join(" | "))?;
    table.rows.iter().try_for_each(|row| writeln!(text, "{}", line(row)))
}

/// Escapes all characters with a meaning in Markdown and joins the lines.
fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\r' | '\t' => result.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '~' | '!' | '$' | '&' => {
                result.push('\\');
                result.push(c);
            }
            c => result.push(c),
        }
    }
    // At the start of a line these characters begin a list or a rule.
    if result.starts_with(['-', '+', '=']) && result.len() > 1 {
        result.insert(0, '\\');
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::publish::document::tests::example;

    #[test]
    fn what_has_a_meaning_is_escaped() {
        assert_eq!(escaped("a|b *c* <d> [e](f) `g` \\"), "a\\|b \\*c\\* \\<d\\> \\[e\\](f) \\`g\\` \\\\");
        assert_eq!(escaped("- no list\n# no heading"), "\\- no list \\# no heading");
        assert_eq!((escaped("0-1"), escaped("-")), ("0-1".to_owned(), "-".to_owned()));
    }

    #[test]
    fn every_figure_has_its_file_and_every_table_its_columns() {
        let files = markdown(&example("a | b"), "figures");
        assert_eq!(files.figures.len(), 2);
        for (name, content) in &files.figures {
            assert!(files.text.contains(&format!("](figures/{name})")), "{name}");
            assert!(content.starts_with("<?xml") && content.trim_end().ends_with("</svg>"));
        }
        let rows: Vec<_> = files.text.lines().filter(|line| line.starts_with('|')).collect();
        assert_eq!(rows.len(), 4);
        for row in rows {
            assert_eq!(row.replace("\\|", "").matches('|').count(), 3, "{row}");
        }
    }
}
