//! As much XML as files of numbers need: elements, texts, comments, the entities that XML defines itself.
//!
//! Every character is looked at once, whatever the file holds: attributes and namespaces, which general parsers compare
//! with each other, are passed over. Document types, which can define entities that grow without bounds, are refused.

use serde_json::{Map, Value};

use super::Problem;
use super::fields::insert;
use crate::foreign::excerpt;

/// Levels of elements in elements. Matrices need three.
const DEEPEST: usize = 32;

/// An element that is not closed yet.
struct OpenElement<'a> {
    name: &'a str,
    text: String,
    children: Vec<(&'a str, Value)>,
}

/// Name and content of the outermost element. Elements with elements in them are objects, or lists if those are called
/// `_`; others are texts, without the quotes around them.
pub(super) fn parse(text: &str) -> Result<(&str, Value), Problem> {
    let mut reader = Reader { text, at: 0 };
    reader.element().map_err(|(at, problem)| {
        let line = 1 + text.get(..at).map_or(0, |before| before.matches('\n').count());
        Problem::at(line, problem)
    })
}

/// Where something is wrong, and what.
type Wrong = (usize, String);

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn wrong<T>(&self, problem: &str) -> Result<T, Wrong> {
        Err((self.at, format!("this is not valid XML: {problem}")))
    }

    /// Goes behind the next `end`.
    fn skip_past(&mut self, end: &str, what: &str) -> Result<&'a str, Wrong> {
        match self.rest().find(end) {
            Some(length) => {
                let inside = &self.rest()[..length];
                self.at += length + end.len();
                Ok(inside)
            }
            None => self.wrong(&format!("{what} has no end")),
        }
    }

    fn element(&mut self) -> Result<(&'a str, Value), Wrong> {
        let mut open: Vec<OpenElement> = Vec::new();
        loop {
            let rest = self.rest();
            let Some(before) = rest.find('<') else {
                return self.wrong(match open.last() {
                    Some(_) => "an element is not closed",
                    None => "there is no element in it",
                });
            };
            match open.last_mut() {
                // What stands between elements is of no use.
                Some(element) if element.children.is_empty() => {
                    let at = self.at;
                    unescape(&rest[..before], &mut element.text).map_err(|problem| (at, problem))?;
                }
                None if !rest[..before].trim().is_empty() => {
                    return self.wrong("there is text in front of the first element");
                }
                _ => {}
            }
            self.at += before;
            let tag = self.rest();
            let closed = if tag.starts_with("<!--") {
                self.at += 4;
                self.skip_past("-->", "a comment")?;
                None
            } else if tag.starts_with("<![CDATA[") {
                self.at += 9;
                let inside = self.skip_past("]]>", "a CDATA section")?;
                if let Some(element) = open.last_mut() {
                    element.text.push_str(inside);
                }
                None
            } else if tag.starts_with("<?") {
                self.skip_past("?>", "an instruction")?;
                None
            } else if tag.starts_with("<!") {
                return self.wrong("document types are not read");
            } else if tag.starts_with("</") {
                self.at += 2;
                let name = local(self.skip_past(">", "a tag")?.trim());
                match open.pop() {
                    Some(element) if element.name == name => Some(element),
                    _ => return self.wrong(&format!("</{}> closes no element", excerpt(name))),
                }
            } else {
                let (name, is_empty) = self.start_tag()?;
                let element = OpenElement { name, text: String::new(), children: Vec::new() };
                if open.len() > DEEPEST {
                    return Err((self.at, format!("elements are nested more than {DEEPEST} deep")));
                }
                if is_empty {
                    Some(element)
                } else {
                    open.push(element);
                    None
                }
            };
            let Some(closed) = closed else { continue };
            let name = closed.name;
            let value = closed.value().map_err(|problem| (self.at, problem))?;
            match open.last_mut() {
                Some(parent) => parent.children.push((name, value)),
                None => return Ok((name, value)),
            }
        }
    }

    /// Name of the element that begins here, and whether it ends here, too.
    fn start_tag(&mut self) -> Result<(&'a str, bool), Wrong> {
        self.at += 1;
        let is_end = |c: char| c.is_whitespace() || matches!(c, '>' | '/' | '<' | '=' | '"' | '\'');
        let length = self.rest().find(is_end).unwrap_or(self.rest().len());
        let name = &self.rest()[..length];
        if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.') {
            return self.wrong("< is not followed by a name (in a text it is written &lt;)");
        }
        self.at += length;
        loop {
            let Some(next) = self.rest().find(['>', '/', '"', '\'', '<']) else {
                return self.wrong("a tag has no end");
            };
            self.at += next;
            let rest = self.rest();
            match rest.as_bytes()[0] {
                b'>' => {
                    self.at += 1;
                    return Ok((local(name), false));
                }
                b'/' if rest.starts_with("/>") => {
                    self.at += 2;
                    return Ok((local(name), true));
                }
                quote @ (b'"' | b'\'') => {
                    self.at += 1;
                    self.skip_past(if quote == b'"' { "\"" } else { "'" }, "the value of an attribute")?;
                }
                _ => return self.wrong("a tag has no end"),
            }
        }
    }
}

impl OpenElement<'_> {
    fn value(self) -> Result<Value, String> {
        match self.children.first() {
            None => {
                let text = self.text.trim();
                let inside = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
                Ok(Value::String(inside.unwrap_or(text).to_owned()))
            }
            Some(("_", _)) => Ok(Value::Array(self.children.into_iter().map(|(_, value)| value).collect())),
            Some(_) => {
                let mut fields = Map::new();
                for (name, value) in self.children {
                    insert(&mut fields, name.to_owned(), value)?;
                }
                Ok(Value::Object(fields))
            }
        }
    }
}

/// A name without its namespace.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Adds a text with its entities resolved.
fn unescape(text: &str, to: &mut String) -> Result<(), String> {
    let mut parts = text.split('&');
    to.push_str(parts.next().unwrap_or(""));
    for part in parts {
        let Some((name, rest)) = part.split_once(';') else {
            return Err("this is not valid XML: & is not followed by a name and ;".into());
        };
        let number = |digits: &str, radix| u32::from_str_radix(digits, radix).ok().and_then(char::from_u32);
        let character = match name {
            "lt" => Some('<'),
            "gt" => Some('>'),
            "amp" => Some('&'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            _ => name.strip_prefix('#').and_then(|digits| match digits.strip_prefix('x') {
                Some(digits) => number(digits, 16),
                None => number(digits, 10),
            }),
        };
        let unknown = || format!("this is not valid XML: there is no entity &{};", excerpt(name));
        to.push(character.ok_or_else(unknown)?);
        to.push_str(rest);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn elements_become_objects_lists_and_texts() {
        let text = "<?xml version=\"1.0\"?>\n<!-- a > b --><root a='>' b=\"/\"><x:n>\"a &lt;&#65;&#x42;\"</x:n>\n\
                    <l><_>1</_><_>2<!-- - --></_></l><e/><c><![CDATA[<&]]></c></root>";
        let expected = json!({"n": "a <AB", "l": ["1", "2"], "e": "", "c": "<&"});
        assert_eq!(parse(text).unwrap(), ("root", expected));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, line, words) in [
            ("", 1, "no element"),
            ("x<a/>", 1, "text in front"),
            ("<a>\n<b>", 2, "not closed"),
            ("<a>\n</b>", 2, "</b> closes no element"),
            ("<a>\n\n&lol;</a>", 1, "no entity &lol;"),
            ("<a>&amp</a>", 1, "& is not followed"),
            ("<!DOCTYPE a [<!ENTITY b \"c\">]><a/>", 1, "document types"),
            ("<a><!-- ", 1, "a comment has no end"),
            ("<a b=\"", 1, "attribute has no end"),
            ("<a <b>", 1, "a tag has no end"),
            ("<a>1 < 2</a>", 1, "not followed by a name"),
            ("<a>&#xd800;</a>", 1, "no entity"),
        ] {
            let problem = parse(text).unwrap_err();
            assert!(problem.problem.contains(words), "{text}: {}", problem.problem);
            assert_eq!(problem.line, Some(line), "{text}");
        }
        let deep = "<a>".repeat(100_000);
        assert!(parse(&deep).unwrap_err().problem.contains("nested more than"));
    }

    #[test]
    fn time_grows_with_the_length_of_the_text_and_no_faster() {
        let list = |item: &dyn Fn(u32) -> String| (0..200_000).map(item).collect::<Vec<_>>().concat();
        let attributes = list(&|k| format!(" a{k}=\"\""));
        let spaces = list(&|k| format!(" xmlns:n{k}=\"u{k}\""));
        let many = "<n0:b/>".repeat(200_000);
        for text in [format!("<a{attributes}/>"), format!("<a{spaces}>{many}</a>"), format!("<a>{many}</a>")]
        {
            let started = std::time::Instant::now();
            parse(&text).unwrap();
            // Quadratic time would be minutes.
            assert!(started.elapsed().as_secs() < 5, "{} bytes", text.len());
        }
    }
}
