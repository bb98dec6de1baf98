//! Foreign text in messages: shortened, with control characters escaped.

use std::path::Path;

/// Maximum number of characters of a foreign text in a message.
const MOST: usize = 80;
/// Maximum number of characters of a path in a message. A longer path keeps its end, the more
/// telling part.
const MOST_OF_A_PATH: usize = 300;

/// Returns the beginning of a text, at most 80 characters, with control characters escaped.
pub fn excerpt(text: &str) -> String {
    let shown = escaped(&text.chars().take(MOST + 1).collect::<String>());
    if shown.chars().count() <= MOST {
        return shown;
    }
    shown.chars().take(MOST - 1).chain(['…']).collect()
}

/// Returns the whole text with control characters escaped.
pub fn escaped(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    text.chars().for_each(|c| push(&mut shown, c));
    shown
}

/// Returns the whole text with control characters escaped, except tabs and line ends.
#[cfg(feature = "cli")]
pub fn escaped_lines(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, '\n' | '\t') { shown.push(c) } else { push(&mut shown, c) }
    }
    shown
}

/// Returns a path for display: control characters escaped, at most 300 characters from the end.
pub fn shown_path(path: &Path) -> String {
    let shown = escaped(&path.to_string_lossy());
    let count = shown.chars().count();
    if count <= MOST_OF_A_PATH {
        return shown;
    }
    ['…'].into_iter().chain(shown.chars().skip(count + 1 - MOST_OF_A_PATH)).collect()
}

fn push(shown: &mut String, c: char) {
    // Marks that change the writing direction can disguise a name.
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if c.is_control() || turns {
        shown.extend(c.escape_default());
    } else {
        shown.push(c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_most_eighty_characters_and_no_control_characters() {
        assert_eq!(excerpt("12.5x"), "12.5x");
        assert_eq!(excerpt("\u{1b}[31mred\0\r\n"), "\\u{1b}[31mred\\u{0}\\r\\n");
        assert_eq!(excerpt("a\u{202e}b"), "a\\u{202e}b");
        assert_eq!(excerpt(&"x".repeat(80)), "x".repeat(80));
        for long in ["x".repeat(81), "x".repeat(10_000_000), "\0".repeat(81), "ä".repeat(1000)] {
            let shown = excerpt(&long);
            assert!(shown.chars().count() <= 80 && shown.ends_with('…'), "{shown}");
        }
    }

    #[test]
    fn of_a_long_path_the_end_is_shown() {
        assert_eq!(shown_path(Path::new("a/b\u{7}.png")), "a/b\\u{7}.png");
        let shown = shown_path(Path::new(&format!("{}/name.png", "x".repeat(5000))));
        assert!(shown.ends_with("/name.png") && shown.chars().count() == MOST_OF_A_PATH, "{shown}");
    }
}
