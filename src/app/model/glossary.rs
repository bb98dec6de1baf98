//! Terms of the field, with their meanings.

use std::ops::Range;

/// Terms in small letters, and their meanings in one or two sentences.
const TERMS: [(&str, &str); 8] = [
    ("epipole", "Where the other camera appears in this picture. All epipolar lines meet there."),
    ("epipolar line", "A line in one picture. The match of a point in the other picture lies on it."),
    ("pencil", "All lines through one point."),
    ("round trip", "Distance between a line and its return through H and G."),
    (
        "support",
        "How many corner patches find a match along the lines of a geometry, weighted by similarity. It compares geometries.",
    ),
    (
        "residual",
        "Distance of a match from its line. It tells how well the lines fit the matches, not how right they are elsewhere.",
    ),
    (
        "uncertainty",
        "How far a line may be from the true one, with 95 % probability. It grows far from all matches.",
    ),
    ("disparity", "Shift of a point along its line from the left picture to the right one."),
];

/// Returns the terms of a text where they first appear, as ranges of characters with the meanings.
pub fn terms_in(text: &str) -> impl Iterator<Item = (Range<usize>, &'static str)> + use<> {
    let text = text.to_ascii_lowercase();
    TERMS.into_iter().filter_map(move |(word, meaning)| {
        let is_whole = |at: &usize| {
            let rest = &text[at + word.len()..];
            let rest = rest.strip_prefix('s').unwrap_or(rest);
            !text[..*at].ends_with(char::is_alphanumeric) && !rest.starts_with(char::is_alphanumeric)
        };
        let at = text.match_indices(word).map(|(at, _)| at).find(is_whole)?;
        let start = text[..at].chars().count();
        Some((start..start + word.len(), meaning))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_found_once_as_whole_words() {
        let found =
            |text: &str| terms_in(text).map(|(range, _)| (range.start, range.end)).collect::<Vec<_>>();
        assert_eq!(found("± 2 px: epipoles. An epipole"), [(8, 15)]);
        assert_eq!(found("Round trip"), [(0, 10)]);
        assert_eq!(found("Epipolar lines, supported"), [(0, 13)]);
        assert!(TERMS.iter().all(|(word, meaning)| word.is_ascii() && meaning.ends_with('.')));
    }
}
