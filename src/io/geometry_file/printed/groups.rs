//! Groups of numbers between words, with the words that name them.

use super::tokens::{Placed, Token, tokens};
use crate::io::values::MatrixName;

/// Number of a group, with its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub value: f64,
    pub line: usize,
    /// Innermost bracket around it; 0 is none.
    pub bracket: usize,
    /// Number of row marks (`;`, `\\`) before it.
    pub row: usize,
    /// Number of the block of columns.
    pub block: usize,
}

/// Place of a group in a matrix, given by its name: `F(1,2)`, `F12`, `row1`. `None` is a colon.
pub(super) type Index = Vec<Option<usize>>;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub word: String,
    line: usize,
    pub index: Index,
    is_transposed: bool,
}

/// Numbers with no word between them.
#[expect(clippy::struct_excessive_bools, reason = "independent facts about the text around the numbers")]
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Group {
    pub entries: Vec<Entry>,
    /// Words before the group, back to the group before.
    pub labels: Vec<Label>,
    /// Whether a mark behind the numbers transposes them.
    pub is_transposed: bool,
    /// Whether a bracket, an assignment or a new line separates the group from the one before.
    pub is_clear: bool,
    /// Number that is not finite, as written.
    pub not_finite: Option<String>,
    /// Whether a word stands before the group on its first line, or behind its only number.
    pub is_described: bool,
    /// Whether an assignment stands directly before the group.
    pub is_assigned: bool,
    /// Whether a product, a quotient or a sign that is not worked out stands directly before the group.
    pub is_broken: bool,
}

/// Numbers of a 3×3 matrix.
pub(super) const MATRIX: usize = 9;

/// Words that name a kind of container, not a matrix.
const CONTAINERS: [&str; 30] = [
    "array",
    "matrix",
    "mat",
    "tensor",
    "list",
    "tuple",
    "double",
    "float",
    "const",
    "static",
    "auto",
    "let",
    "mut",
    "var",
    "val",
    "return",
    "print",
    "c",
    "structure",
    "dtype",
    "f64",
    "f32",
    "float64",
    "float32",
    "cv",
    "np",
    "numpy",
    "torch",
    "eigen",
    "sympy",
];

impl Label {
    /// Returns whether the word names more than a container or a shape.
    fn tells(&self) -> bool {
        let is_container = |part: &str| {
            let part = part.to_lowercase();
            let word = part.trim_end_matches(|c: char| c.is_ascii_digit());
            CONTAINERS.contains(&&*part)
                || CONTAINERS.contains(&word)
                || part.starts_with(|c: char| c.is_ascii_digit())
        };
        !self.word.split(['.', ':', '_']).filter(|part| !part.is_empty()).all(is_container)
    }
}

impl Group {
    /// Returns what the words before the group say it is, and the word that says so.
    pub(super) fn name(&self) -> (MatrixName, Option<&str>) {
        let told: Vec<&Label> = self.labels.iter().filter(|label| label.tells()).collect();
        let Some(nearest) = told.last().map(|label| label.line) else { return (MatrixName::Unknown, None) };
        let line = told.iter().filter(|label| label.line == nearest);
        let known = line.map(|label| (MatrixName::of(&label.word), &*label.word));
        let mut known = known.filter(|(name, _)| *name != MatrixName::Unknown);
        if let Some((name, word)) = known.next() {
            return (name, Some(word));
        }
        let other = told.iter().rev().find(|label| MatrixName::of(&label.word) == MatrixName::Other);
        match other {
            Some(label) => (MatrixName::Other, Some(&label.word)),
            None => (MatrixName::Unknown, told.last().map(|label| &*label.word)),
        }
    }

    /// Returns whether the numbers are the shape of a matrix, `3, 3` or `9`.
    pub(super) fn is_shape(&self) -> bool {
        let values: Vec<f64> = self.entries.iter().map(|entry| entry.value).collect();
        matches!(values[..], [3.0, 3.0] | [9.0])
    }

    /// Returns whether the name is that of a transposed matrix (`F' = …`).
    pub(super) fn is_named_transposed(&self) -> bool {
        self.labels.last().is_some_and(|label| label.is_transposed)
    }
}

/// Splits a text into groups of numbers.
pub(super) fn groups(text: &str) -> Vec<Group> {
    let tokens = indexed(&tokens(text));
    let mut gatherer = Gatherer::default();
    let mut at = 0;
    while at < tokens.len() {
        at += gatherer.step(&tokens, at);
    }
    gatherer.close();
    gatherer.found
}

/// Token, or a word with its index, or the heading of a block of columns.
#[derive(Debug, Clone, PartialEq)]
enum Item {
    Token(Token),
    Indexed(String, Index),
    Block,
}

type Tokens = [(Item, Placed)];

/// Joins words with their indices, and finds the headings of columns that MATLAB, Octave and R print.
fn indexed(tokens: &[Placed]) -> Vec<(Item, Placed)> {
    let mut items = Vec::with_capacity(tokens.len());
    let (mut at, mut depth) = (0, 0usize);
    while let Some(placed) = tokens.get(at) {
        let begins_line = at == 0 || tokens[at - 1].token == Token::Line;
        let (item, used) = if begins_line && let Some(used) = heading(&tokens[at..]) {
            (Item::Block, used)
        } else if begins_line
            && depth == 0
            && let Some(used) = row_label(&tokens[at..])
        {
            at += used;
            continue;
        } else if let Token::Word(word) = &placed.token
            && let Some((index, used)) = index(&tokens[at + 1..], depth)
        {
            (Item::Indexed(word.clone(), index), 1 + used)
        } else {
            match placed.token {
                Token::Open(_) => depth += 1,
                Token::Close => depth = depth.saturating_sub(1),
                _ => {}
            }
            (Item::Token(placed.token.clone()), 1)
        };
        items.push((item, placed.clone()));
        at += used;
    }
    items
}

fn whole(token: Option<&Placed>) -> Option<usize> {
    match token?.token {
        Token::Number(value) if value.fract() == 0.0 && (0.0..1000.0).contains(&value) => {
            Some(value as usize)
        }
        _ => None,
    }
}

fn is(token: Option<&Placed>, wanted: impl Fn(&Token) -> bool) -> bool {
    token.is_some_and(|placed| wanted(&placed.token))
}

/// Returns the length of a heading of columns: `Columns 1 through 2`, or `[,1] [,2]`.
fn heading(tokens: &[Placed]) -> Option<usize> {
    let end = tokens.iter().position(|placed| placed.token == Token::Line).unwrap_or(tokens.len());
    let line = &tokens[..end];
    let is_r = !line.is_empty()
        && line.chunks(4).all(|label| {
            label.len() == 4
                && label[0].token == Token::Open('[')
                && label[1].token == Token::Comma
                && whole(label.get(2)).is_some()
                && label[3].token == Token::Close
        });
    let is_matlab = matches!(&line.first()?.token, Token::Word(word)
        if matches!(&*word.to_lowercase(), "column" | "columns" | "col" | "cols"))
        && line.iter().skip(1).all(|placed| match &placed.token {
            Token::Number(_) | Token::Assign(':') => true,
            Token::Word(word) => matches!(&*word.to_lowercase(), "through" | "and" | "to"),
            _ => false,
        });
    (is_r || is_matlab).then_some(end)
}

/// Returns the length of a label of R at the beginning of a line: `[1,]`, or `[1]` before numbers.
fn row_label(tokens: &[Placed]) -> Option<usize> {
    if !is(tokens.first(), |token| *token == Token::Open('[')) || whole(tokens.get(1)).is_none() {
        return None;
    }
    let is_row = is(tokens.get(2), |token| *token == Token::Comma)
        && is(tokens.get(3), |token| *token == Token::Close);
    let is_place = is(tokens.get(2), |token| *token == Token::Close)
        && is(tokens.get(3), |token| matches!(token, Token::Number(_)));
    if is_row { Some(4) } else { is_place.then_some(3) }
}

/// Returns the index behind a word and its length: `(1,2)`, `[0][1]`, `(1,:)`, or a number before an assignment.
fn index(tokens: &[Placed], depth: usize) -> Option<(Index, usize)> {
    if let Some(number) = whole(tokens.first())
        && is(tokens.get(1), |token| matches!(token, Token::Assign(_)))
    {
        return Some((vec![Some(number)], 1));
    }
    let (mut found, mut at) = (Index::new(), 0);
    while is(tokens.get(at), |token| matches!(token, Token::Open('(' | '['))) && tokens[at].is_glued {
        at += 1;
        loop {
            found.push(match whole(tokens.get(at)) {
                Some(number) => Some(number),
                None if is(tokens.get(at), |token| *token == Token::Assign(':')) => None,
                None => return None,
            });
            at += 2;
            match tokens.get(at - 1).map(|placed| &placed.token) {
                Some(Token::Comma) => {}
                Some(Token::Close) => break,
                _ => return None,
            }
        }
    }
    let is_index = is(tokens.get(at), |token| match token {
        Token::Assign(_) | Token::Open(_) => true,
        Token::Number(_) => depth == 0,
        _ => false,
    });
    (matches!(found.len(), 1 | 2) && is_index).then_some((found, at))
}

#[derive(Debug, Default)]
struct Bracket {
    parent: usize,
    /// Whether a word stands directly before it, as in `float64(1.5)`.
    is_call: bool,
    /// Numbers in it.
    count: usize,
}

#[derive(Default)]
struct Gatherer {
    found: Vec<Group>,
    current: Group,
    labels: Vec<Label>,
    brackets: Vec<Bracket>,
    bracket: usize,
    row: usize,
    block: usize,
    /// Whether a bracket, an assignment or a line end came since the last number.
    is_clear: bool,
    is_assigned: bool,
    is_broken: bool,
}

impl Gatherer {
    /// Takes an item, and returns how many were used.
    fn step(&mut self, tokens: &Tokens, at: usize) -> usize {
        if self.brackets.is_empty() {
            self.brackets.push(Bracket::default());
        }
        let (item, placed) = &tokens[at];
        let next = |k: usize| tokens.get(at + k).map(|(item, _)| item);
        match item {
            Item::Block => self.block += 1,
            Item::Indexed(word, index) => self.word(word, placed.line, index.clone()),
            Item::Token(token) => match token {
                Token::Number(value) => return self.number(*value, tokens, at),
                Token::NotFinite(written) => {
                    self.entry(f64::NAN, placed.line);
                    self.current.not_finite.get_or_insert_with(|| written.clone());
                }
                Token::Word(word) => {
                    let opens = matches!(tokens.get(at + 1), Some((Item::Token(Token::Open(_)), next)) if next.is_glued);
                    let describes =
                        matches!(self.current.entries.as_slice(), [only] if only.line == placed.line);
                    self.current.is_described |= describes;
                    // A power of ten before or behind the matrix scales it, which means the same F.
                    let mut before = tokens[..at].iter().rev().map(|(item, _)| item);
                    let last = before.find(|item| **item != Item::Token(Token::Times));
                    let is_behind =
                        self.current.entries.is_empty() || last == Some(&Item::Token(Token::Close));
                    let is_factor = word.starts_with("10^") && is_behind;
                    if !(is_factor || opens && self.bracket > 0) {
                        self.word(word, placed.line, Index::new());
                    }
                }
                Token::Remark(word) => {
                    if self.bracket == 0 && MatrixName::of(word) != MatrixName::Unknown {
                        self.close();
                    }
                    self.label(word, placed.line, Index::new());
                }
                Token::Open(_) => self.open(tokens, at),
                Token::Close => {
                    let closed = &self.brackets[self.bracket];
                    let (parent, is_wrapper) = (closed.parent, closed.is_call && closed.count == 1);
                    if is_wrapper && let Some(entry) = self.current.entries.last_mut() {
                        entry.bracket = parent;
                        self.brackets[parent].count += 1;
                    }
                    self.bracket = parent;
                    self.is_clear = true;
                }
                Token::Line => self.is_clear = true,
                Token::Row => self.row += 1,
                Token::Assign(_) => {
                    self.close();
                    (self.is_clear, self.is_assigned) = (true, true);
                }
                Token::Transposed if self.current.entries.len() >= MATRIX => {
                    self.current.is_transposed ^= true;
                }
                Token::Transposed if !self.current.entries.is_empty() => {
                    self.word("'", placed.line, Index::new());
                }
                Token::Transposed if matches!(next(1), Some(Item::Token(Token::Assign(_)))) => {
                    self.labels.iter_mut().last().into_iter().for_each(|label| label.is_transposed = true);
                }
                Token::Comma | Token::Times | Token::Slash | Token::Minus | Token::Transposed => {}
            },
        }
        1
    }

    fn number(&mut self, value: f64, tokens: &Tokens, at: usize) -> usize {
        let line = tokens[at].1.line;
        let token = |k: usize| match tokens.get(k) {
            Some((Item::Token(token), placed)) if placed.line == line => Some(token),
            _ => None,
        };
        let before = |k: usize| at.checked_sub(k).and_then(token);
        match token(at + 1) {
            // A product or a quotient of numbers is not worked out.
            Some(Token::Times | Token::Slash) if matches!(token(at + 2), Some(Token::Number(_))) => {
                self.broken("*", line);
                return 3;
            }
            // A factor of the whole matrix means the same F. It stands before a bracket, a call or a line end.
            Some(Token::Times) => {
                let is_call = matches!(tokens.get(at + 3), Some((Item::Token(Token::Open('(' | '[')), next)) if next.is_glued);
                let is_before_matrix = match token(at + 2) {
                    None | Some(Token::Line | Token::Open(_)) => true,
                    Some(Token::Word(_)) => is_call,
                    _ => false,
                };
                if !(is_before_matrix && self.current.entries.is_empty()) {
                    self.broken("*", line);
                }
                return 2;
            }
            _ => {}
        }
        match (before(1), before(2)) {
            (Some(Token::Times | Token::Slash), Some(Token::Close)) => return 1,
            (Some(Token::Minus), Some(Token::Comma | Token::Open(_) | Token::Row | Token::Assign(_))) => {
                self.entry(-value, line);
            }
            // The sign may as well be a dash.
            (Some(Token::Minus), _) => self.broken("-", line),
            _ => self.entry(value, line),
        }
        1
    }

    fn entry(&mut self, value: f64, line: usize) {
        if self.current.entries.is_empty() {
            let has_words = self.labels.last().is_some_and(|label| label.line == line);
            self.current = Group {
                labels: std::mem::take(&mut self.labels),
                is_clear: self.is_clear || self.found.is_empty(),
                is_described: has_words || self.is_assigned,
                is_assigned: self.is_assigned,
                is_broken: std::mem::take(&mut self.is_broken),
                ..Group::default()
            };
            self.block = 0;
        }
        let (bracket, row, block) = (self.bracket, self.row, self.block);
        self.current.entries.push(Entry { value, line, bracket, row, block });
        self.brackets[bracket].count += 1;
        self.is_clear = false;
        self.is_assigned = false;
    }

    fn open(&mut self, tokens: &Tokens, at: usize) {
        let before = at.checked_sub(1).map(|k| &tokens[k].0);
        let is_word = matches!(before, Some(Item::Token(Token::Word(_)) | Item::Indexed(..)));
        let parent = self.bracket;
        self.bracket = self.brackets.len();
        self.brackets.push(Bracket { parent, is_call: is_word && tokens[at].1.is_glued, count: 0 });
        self.is_clear = true;
    }

    /// Takes numbers that are not worked out. The group behind them is no matrix.
    fn broken(&mut self, word: &str, line: usize) {
        self.word(word, line, Index::new());
        self.is_broken = true;
    }

    fn word(&mut self, word: &str, line: usize, index: Index) {
        self.close();
        self.label(word, line, index);
    }

    fn label(&mut self, word: &str, line: usize, index: Index) {
        self.labels.push(Label { word: word.to_owned(), line, index, is_transposed: false });
    }

    fn close(&mut self) {
        if !self.current.entries.is_empty() {
            self.found.push(std::mem::take(&mut self.current));
        }
    }
}
