//! Output of a document as a single HTML file.

use maud::{DOCTYPE, Markup, PreEscaped, html as markup};

use super::{Block, Figure, Publication, TextTable};

const STYLE: &str = include_str!("style.css");

/// Maximum number of columns at the usual text size.
const NARROW: usize = 9;

/// Returns the HTML page.
pub fn html(document: &Publication) -> String {
    let page = markup! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (document.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (document.title) }
                    p { (document.subtitle) }
                }
                main { @for (number, block) in document.numbered() { (block_markup(number, block)) "\n" } }
            }
        }
    };
    page.into_string()
}

fn block_markup(number: usize, block: &Block) -> Markup {
    match block {
        Block::Section(text) => markup! { h2 { (text) } },
        Block::Subsection(text) => markup! { h3 { (text) } },
        Block::Paragraph(text) => markup! { p { (text) } },
        Block::Command(text) => markup! { pre { code { (text) } } },
        Block::List(items) => markup! { ul { @for item in items { li { (item) } } } },
        Block::Facts(facts) => markup! {
            table.facts { tbody {
                @for (name, value) in facts { tr { th scope="row" { (name) } td { (value) } } }
            } }
        },
        Block::Table(table) => table_markup(number, table),
        Block::Figure(Figure { drawing, caption, .. }) => markup! {
            figure {
                (drawing.inline(caption))
                figcaption { b { "Figure " (number) ". " } (caption) }
            }
        },
    }
}

fn table_markup(number: usize, table: &TextTable) -> Markup {
    let class = |column: usize| if column < table.words { "word" } else { "number" };
    markup! {
        div.table.wide[table.headings.len() > NARROW] {
            p.caption { b { "Table " (number) ". " } (table.caption) }
            table aria-label={ "Table " (number) } {
                thead { tr {
                    @for (column, heading) in table.headings.iter().enumerate() {
                        th scope="col" class=(class(column)) {
                            // Breaks between words, not at hyphens.
                            @for word in heading.split_whitespace() { span { (word) } " " }
                        }
                    }
                } }
                tbody {
                    @for (number, row) in table.rows.iter().enumerate() {
                        tr.ruled[table.ruled.contains(&number)] {
                            @for (column, cell) in row.iter().enumerate() {
                                td class=(class(column)) { (cell) }
                            }
                        }
                        "\n"
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::publish::document::tests::example;

    #[test]
    fn nothing_in_a_text_becomes_a_tag() {
        let page = html(&example("<script>alert('&')</script>\" onload=\"x"));
        assert!(!page.contains("<script") && !page.contains("\" onload="), "{page}");
        assert!(page.contains("&lt;script&gt;alert('&amp;')&lt;/script&gt;"));
    }

    #[test]
    fn needs_nothing_from_elsewhere() {
        let page = html(&example("text"));
        for reference in ["src=", "<link", "@import", "url(", "<script", "http-equiv"] {
            assert!(!page.contains(reference), "{reference}");
        }
        // The namespace is a name, not an address to load.
        let addresses = page.matches("http").count();
        assert_eq!(addresses, page.matches("http://www.w3.org/2000/svg").count());
    }

    #[test]
    fn tables_and_figures_are_numbered_apart() {
        let page = html(&example("text"));
        for word in ["Table 1. ", "Figure 1. ", "Figure 2. "] {
            assert_eq!(page.matches(word).count(), 1, "{word}");
        }
    }
}
