//! Numbers, words and marks of a printed matrix, in any notation.
//!
//! A number is what Python, C, MATLAB, Fortran (`1D-05`), Mathematica (`1.5*^-5`, ``1.5`8.``), LaTeX
//! (`1.5 \times 10^{-5}`) and their like print. Digits within a word (`float64`, `F1`, `3x3`) and runs that are no
//! number (dates, times, versions, fractions) are words. Comments give words alone.

/// Piece of a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(f64),
    /// A number that is not finite, as written.
    NotFinite(String),
    Word(String),
    /// Word of a comment.
    Remark(String),
    Open(char),
    Close,
    /// End of a line.
    Line,
    /// End of a row: `;` or `\\`.
    Row,
    Comma,
    /// `=`, `:`, `<<`, `<-` and the like.
    Assign(char),
    Times,
    Slash,
    /// A minus that stands apart from its number.
    Minus,
    /// `'`, `.T`, `^T` and the like behind a matrix or a name.
    Transposed,
}

/// Token with its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    pub token: Token,
    /// Line, from 0.
    pub line: usize,
    /// Whether no space stands before it.
    pub is_glued: bool,
}

/// Splits a text into tokens.
pub(super) fn tokens(text: &str) -> Vec<Placed> {
    let text: String = text.chars().map(plain).collect();
    let mut scanner =
        Scanner { rest: &text, line: 0, is_glued: false, is_quoted: false, before: '\n', found: Vec::new() };
    while let Some(c) = scanner.rest.chars().next() {
        scanner.step(c);
    }
    joined_powers(scanner.found)
}

/// Returns the plain form of a character: minus signs and superscripts.
fn plain(c: char) -> char {
    match c {
        '\u{2212}' | '\u{fe63}' | '\u{ff0d}' => '-',
        '⋅' | '·' | '×' => '×',
        other => other,
    }
}

/// Begin and end of comments.
const COMMENTS: [(&str, &str); 6] =
    [("#", "\n"), ("%", "\n"), ("//", "\n"), ("!", "\n"), ("/*", "*/"), ("(*", "*)")];

/// Suffixes of numbers in C, Java and Rust.
const SUFFIXES: [&str; 10] = ["_f64", "_f32", "f64", "f32", "f", "F", "l", "L", "d", "m"];

struct Scanner<'a> {
    rest: &'a str,
    line: usize,
    is_glued: bool,
    /// Whether a single quotation mark is open.
    is_quoted: bool,
    /// Character before `rest`.
    before: char,
    found: Vec<Placed>,
}

impl Scanner<'_> {
    fn push(&mut self, token: Token, length: usize) {
        self.found.push(Placed { token, line: self.line, is_glued: self.is_glued });
        self.skip(length);
    }

    fn skip(&mut self, length: usize) {
        let (gone, rest) = self.rest.split_at(length);
        self.before = gone.chars().next_back().unwrap_or(self.before);
        self.line += gone.matches('\n').count();
        self.is_glued = true;
        self.rest = rest;
    }

    fn step(&mut self, c: char) {
        if let Some((begin, end)) = COMMENTS.iter().find(|(begin, _)| self.rest.starts_with(begin)) {
            return self.comment(begin, end);
        }
        match c {
            '\n' => {
                self.is_quoted = false;
                self.push(Token::Line, 1);
                self.is_glued = false;
            }
            _ if c.is_whitespace() => {
                self.skip(c.len_utf8());
                self.is_glued = false;
            }
            _ if self.starts_number() => self.number(),
            '\\' if self.rest.starts_with("\\\\") => {
                // `\\[2pt]` tells the height of the row.
                let height = self.rest[2..].strip_prefix('[').and_then(|rest| rest.split_once(']'));
                self.push(Token::Row, 2 + height.map_or(0, |(height, _)| height.len() + 2));
            }
            '\\' if self.rest[1..].starts_with(|c: char| c.is_alphabetic()) => self.command(),
            _ if c.is_alphabetic() || c == '_' => self.word(),
            '(' | '[' | '{' => self.push(Token::Open(c), 1),
            ')' | ']' | '}' => self.push(Token::Close, 1),
            ';' => self.push(Token::Row, 1),
            ',' | '&' | '|' => self.push(Token::Comma, 1),
            '<' if self.rest.starts_with("<<") || self.rest.starts_with("<-") => {
                self.push(Token::Assign('='), 2);
            }
            ':' if self.rest.starts_with(":=") => self.push(Token::Assign('='), 2),
            '=' | '→' => self.push(Token::Assign('='), c.len_utf8()),
            ':' => self.push(Token::Assign(':'), 1),
            '*' if self.rest.starts_with("**") => self.push(Token::Word("**".into()), 2),
            '*' | '×' => self.push(Token::Times, c.len_utf8()),
            '/' => self.push(Token::Slash, 1),
            '-' => self.push(Token::Minus, 1),
            '^' => self.raised(),
            'ᵀ' | '⊤' => self.push(Token::Transposed, c.len_utf8()),
            '\'' => self.quote(),
            '.' if ")]}".contains(self.before) => self.method(),
            _ => self.skip(c.len_utf8()),
        }
    }

    /// Scans a comment. Its words are kept, its numbers are not.
    fn comment(&mut self, begin: &str, end: &str) {
        let content = &self.rest[begin.len()..];
        let length = content.find(end).unwrap_or(content.len());
        let words = content[..length].split(|c: char| !c.is_alphanumeric() && !"_.".contains(c));
        let words = words.filter(|word| word.starts_with(|c: char| c.is_alphabetic()));
        let remarks: Vec<_> =
            words.map(|word| Token::Remark(word.trim_end_matches('.').to_owned())).collect();
        for remark in remarks {
            self.found.push(Placed { token: remark, line: self.line, is_glued: false });
        }
        let end = if end == "\n" { 0 } else { end.len() };
        self.skip((begin.len() + length + end).min(self.rest.len()));
    }

    fn starts_number(&self) -> bool {
        let unsigned = self.rest.strip_prefix(['-', '+']).unwrap_or(self.rest);
        unsigned.starts_with(|c: char| c.is_ascii_digit())
            || unsigned.strip_prefix('.').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    }

    fn number(&mut self) {
        let sign = usize::from(self.rest.starts_with(['-', '+']));
        // In `-.5` and `1.5-2` the sign is part of the run.
        let (mut length, value) = scanned(&self.rest[sign..]);
        length += sign;
        let value = if self.rest.starts_with('-') { -value } else { value };
        let rest = &self.rest[length..];
        if let Some((exponent, used)) = (&self.rest[sign..length] == "10").then(|| power(rest)).flatten() {
            return self.push(Token::Word(format!("10^{exponent}")), length + used);
        }
        let suffix = SUFFIXES.iter().find(|suffix| {
            rest.strip_prefix(**suffix)
                .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        });
        let length = length + suffix.map_or(0, |suffix| suffix.len());
        let rest = &self.rest[length..];
        let mut next = rest.chars();
        let ends = match (next.next(), next.next()) {
            // `1.5x10^-5`
            (Some('x' | 'X'), Some('1')) | (None, _) => true,
            (Some('+' | '-' | ':' | '/' | '.'), Some(c)) => !c.is_ascii_digit(),
            (Some(c), _) => !(c.is_alphanumeric() || "_^`".contains(c)),
        };
        if ends && !(self.is_glued && (self.before.is_alphanumeric() || self.before == '.')) {
            let token = if value.is_finite() {
                Token::Number(value)
            } else {
                Token::NotFinite(self.rest[..length].to_owned())
            };
            return self.push(token, length);
        }
        // A date, a time, a version, a shape: everything up to the next mark.
        let run = rest.find(|c: char| c.is_whitespace() || ",;()[]{}&|\"'".contains(c)).unwrap_or(rest.len());
        self.push(Token::Word(self.rest[..length + run].to_owned()), length + run);
    }

    fn word(&mut self) {
        let mut length = 0;
        let mut characters = self.rest.char_indices().peekable();
        while let Some((at, c)) = characters.next() {
            let next = characters.peek().map_or(' ', |(_, next)| *next);
            let goes_on = c.is_alphanumeric()
                || c == '_'
                || (c == '.' && (next.is_alphabetic() || next == '_'))
                || (c == ':' && (next == ':' || self.rest[..at].ends_with(':')));
            if !goes_on || "ᵀ".contains(c) {
                break;
            }
            length = at + c.len_utf8();
        }
        let word = &self.rest[..length];
        // Subscripts of LaTeX: F_{12}
        if let Some((index, used)) = word.ends_with('_').then(|| braced(&self.rest[length..])).flatten() {
            let word = format!("{word}{index}");
            return self.push(Token::Word(word), length + used);
        }
        let token = match &*word.to_lowercase() {
            "nan" | "inf" | "infinity" => Token::NotFinite(word.to_owned()),
            _ => Token::Word(word.to_owned()),
        };
        self.push(token, length);
    }

    /// Scans a command of LaTeX.
    fn command(&mut self) {
        let name: String = self.rest[1..].chars().take_while(|c| c.is_alphabetic()).collect();
        let length = 1 + name.len();
        match &*name {
            "times" | "cdot" => self.push(Token::Times, length),
            "top" => self.push(Token::Transposed, length),
            "begin" | "end" => {
                let used = braced(&self.rest[length..]).map_or(0, |(_, used)| used);
                let token = if name == "begin" { Token::Open('{') } else { Token::Close };
                self.push(token, length + used);
            }
            _ => self.skip(length),
        }
    }

    /// Scans `^T`, `^{T}`, `^\top`, or another superscript.
    fn raised(&mut self) {
        let rest = self.rest[1..].trim_start_matches(['{', '\\', '(']);
        let used = self.rest.len() - rest.len();
        let word: String = rest.chars().take_while(|c| c.is_alphanumeric()).collect();
        if matches!(&*word, "T" | "top" | "t" | "intercal") {
            let closing = usize::from(self.rest[1..].starts_with(['{', '(']));
            let used = (used + word.len() + closing).min(self.rest.len());
            return self.push(Token::Transposed, used);
        }
        self.push(Token::Word("^".into()), 1);
    }

    /// Scans a quotation mark, which in MATLAB transposes the matrix before it.
    fn quote(&mut self) {
        if self.is_quoted {
            self.is_quoted = false;
            self.skip(1);
        } else if ")]}.".contains(self.before)
            || (self.before.is_alphanumeric() && !"ubr".contains(self.before))
        {
            self.push(Token::Transposed, 1);
        } else {
            self.is_quoted = true;
            self.skip(1);
        }
    }

    /// Scans a method behind a matrix.
    fn method(&mut self) {
        let name: String = self.rest[1..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        match &*name {
            "T" | "t" | "transpose" | "transposed" => {
                let call = if self.rest[1 + name.len()..].starts_with("()") { 2 } else { 0 };
                self.push(Token::Transposed, 1 + name.len() + call);
            }
            _ => self.skip(1),
        }
    }
}

/// Returns the content of a group in braces, and its length with them.
fn braced(text: &str) -> Option<(&str, usize)> {
    let (content, _) = text.strip_prefix('{')?.split_once('}')?;
    Some((content, content.len() + 2))
}

/// Scans a number without a sign and returns its length. It begins with a digit or a point.
fn scanned(text: &str) -> (usize, f64) {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(text);
    let point = text[whole..].starts_with('.') && !text[whole + 1..].starts_with(['.', '\'']);
    let mantissa = if point { whole + 1 + digits(&text[whole + 1..]) } else { whole };
    let exponent_of = |text: &str, mark: usize| {
        let sign = usize::from(text[mark..].starts_with(['-', '+']));
        let count = digits(&text[mark + sign..]);
        (count > 0).then_some(mark + sign + count)
    };
    let mut length = mantissa;
    let mut exponent = "0";
    let rest = &text[mantissa..];
    if rest.starts_with(['e', 'E', 'd', 'D']) {
        if let Some(used) = exponent_of(rest, 1) {
            exponent = &rest[1..used];
            length += used;
        }
    } else {
        // Mathematica: precision behind a backquote, then the exponent.
        let precision = rest.strip_prefix('`').map_or(0, |after| {
            1 + after.bytes().take_while(|b| b.is_ascii_digit() || matches!(b, b'.' | b'`')).count()
        });
        length += precision;
        let rest = &rest[precision..];
        if rest.starts_with("*^")
            && let Some(used) = exponent_of(rest, 2)
        {
            exponent = &rest[2..used];
            length += used;
        }
    }
    (length, format!("{}e{exponent}", &text[..mantissa]).parse().unwrap_or(f64::NAN))
}

/// Returns the exponent behind a ten, and its length: `^-5`, `^{-5}`, `**-5`, or superscripts.
fn power(text: &str) -> Option<(i32, usize)> {
    let raised: String = text.chars().map_while(superscript).collect();
    if !raised.is_empty() {
        let used = text.chars().take(raised.chars().count()).map(char::len_utf8).sum();
        return Some((raised.parse().ok()?, used));
    }
    let rest = text.strip_prefix('^').or_else(|| text.strip_prefix("**"))?;
    let open = usize::from(rest.starts_with(['{', '(']));
    let number: String =
        rest[open..].chars().take_while(|c| c.is_ascii_digit() || "+-".contains(*c)).collect();
    let used = text.len() - rest.len() + open + number.len();
    Some((number.parse().ok()?, (used + open).min(text.len())))
}

fn superscript(c: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c).map(|digit| (b'0' + digit as u8) as char).or(match c {
        '⁻' => Some('-'),
        '⁺' => Some('+'),
        _ => None,
    })
}

/// Multiplies numbers with the powers of ten behind them, and drops shapes such as `3 × 3`.
fn joined_powers(found: Vec<Placed>) -> Vec<Placed> {
    let times = |token: &Token| match token {
        Token::Word(word) => matches!(&**word, "x" | "X" | "by"),
        token => *token == Token::Times,
    };
    let mut joined: Vec<Placed> = Vec::with_capacity(found.len());
    for placed in found {
        let before = joined
            .len()
            .checked_sub(2)
            .map(|at| (at, joined[at].token.clone(), joined[at + 1].token.clone()));
        match (&placed.token, before) {
            (Token::Word(word), Some((at, Token::Number(value), by)))
                if times(&by) && word.starts_with("10^") =>
            {
                // Written as digits, so that the result is the nearest double.
                let value = format!("{value}e{}", &word[3..]).parse().unwrap_or(f64::NAN);
                joined.truncate(at + 1);
                joined[at].token =
                    if f64::is_finite(value) { Token::Number(value) } else { Token::NotFinite(word.clone()) };
            }
            (Token::Number(columns), Some((at, Token::Number(rows), by)))
                if times(&by)
                    && [*columns, rows].iter().all(|s| s.fract() == 0.0 && (1.0..100.0).contains(s)) =>
            {
                joined.truncate(at);
                joined.push(Placed { token: Token::Word(format!("{rows}x{columns}")), ..placed });
            }
            _ => joined.push(placed),
        }
    }
    joined
}
