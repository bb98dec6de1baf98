//! Tests of the code against `tests/arrows.txt`, the allowed imports, and of the recipes in
//! `ARCHITECTURE.md`.
//!
//! A section of `arrows.txt` is a folder: each line is a file or subfolder with its imports. The
//! test reads every `crate::` and `super::` path outside tests. It fails for an import missing from
//! the file and for an arrow missing from the code. Arrows point downwards, which excludes cycles.
//!
//! Further tests: re-exports count as imports of the defining file, and no files import each
//! other. The recipes name few files, and all of them exist.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Allowed imports.
const ARROWS: &str = "tests/arrows.txt";
/// Document with the recipes.
const DOCUMENT: &str = "ARCHITECTURE.md";

#[test]
fn the_code_has_the_declared_arrows_and_no_others() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join(ARROWS)).expect("the file is in the repository");
    let sections = Section::all(&text);
    let declared: Vec<String> = sections.iter().map(|section| section.folder.join("/")).collect();
    for folder in ["", "app", "estimate"] {
        assert!(declared.iter().any(|name| name == folder), "{ARROWS} has no section src/{folder}");
    }
    let sources = Source::all(&root.join("src"));
    let complaints: Vec<String> =
        sections.iter().flat_map(|section| section.complaints(&section.arrows_of(&sources))).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn no_files_import_each_other() {
    let sources = Source::all(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let circles = circles(&sources);
    let listed: Vec<String> = circles.iter().map(|circle| circle.join(", ")).collect();
    assert!(circles.is_empty(), "these import each other in a circle:\n{}", listed.join("\n"));
}

#[test]
fn circles_are_found_through_what_folders_pass_on() {
    let file = |path: &str, code: &str| Source::new(PathBuf::from(path), code);
    let sources = [
        file("src/lib.rs", "pub mod e; pub mod f;"),
        file("src/e/mod.rs", "mod a; mod b; pub use a::A; pub(crate) use b::B; pub struct Own;"),
        file("src/e/a.rs", "use super::{B, Own};"),
        file("src/e/b.rs", "use crate::f::F; use super::Own; use std::fmt::Write;"),
        file("src/f.rs", "use crate::e::A; use crate::e::Own;"),
    ];
    assert_eq!(circles(&sources), [["src/e/a.rs", "src/e/b.rs", "src/f.rs"]]);
    assert_eq!(circles(&sources[..4]), [[""; 0]; 0]);
}

#[test]
fn imports_are_read_as_rust_reads_them() {
    let code = "
        //! [`crate::nowhere`]
        use crate::{cancel::CancelFlag, geometry::{Line, pencil}};
        pub(in crate::estimate) fn f(s: &str) -> super::Found { g(\"crate::nowhere\", '\\'', super::super::io::VALUE) }
        #[cfg(test)]
        use crate::nowhere;
        #[cfg(test)]
        mod tests { fn f() { crate::nowhere::g() } }
        #[cfg(test)]
        mod scene;
        fn last() -> crate::image::Picture {}";
    let source = Source::new(PathBuf::from("src/estimate/lines/x.rs"), code);
    let found: Vec<(String, usize)> = source.imports.iter().map(|i| (i.path.join("::"), i.line)).collect();
    let expected = [
        ("cancel::CancelFlag", 3),
        ("geometry::Line", 3),
        ("geometry::pencil", 3),
        ("estimate", 4),
        ("estimate::lines::Found", 4),
        ("estimate::io::VALUE", 4),
        ("image::Picture", 11),
    ];
    assert_eq!(found, expected.map(|(path, line)| (path.to_owned(), line)));
    assert_eq!(source.test_modules, ["scene"]);
}

#[test]
fn complaints_name_the_place() {
    let section = Section::all("# Comment: ignored\n[src]\na: b, c\nb:\nc: b\n").remove(0);
    let sources = [
        Source::new(PathBuf::from("src/a/mod.rs"), "use crate::b::X;\nuse crate::d::Y;"),
        Source::new(PathBuf::from("src/b.rs"), ""),
        Source::new(PathBuf::from("src/d.rs"), ""),
    ];
    assert_eq!(
        section.complaints(&section.arrows_of(&sources)),
        [
            "src/a/mod.rs:2: `a -> d` is not in tests/arrows.txt",
            "tests/arrows.txt:3: `a -> c` is not in the code",
            "tests/arrows.txt:5: `c -> b` is not in the code",
            "tests/arrows.txt:5: `c -> b` goes upwards",
            "tests/arrows.txt: `d` is missing from the section src",
        ]
    );
    let section = Section::all("[src/e]\na: b\nb:\n").remove(0);
    let sources = [
        Source::new(PathBuf::from("src/e/mod.rs"), "pub use a::A;\npub use b::B;\npub struct Own;"),
        Source::new(PathBuf::from("src/e/a.rs"), "use super::{B, Own};"),
        Source::new(PathBuf::from("src/e/b.rs"), "use super::Own;"),
    ];
    assert_eq!(section.complaints(&section.arrows_of(&sources)), [""; 0]);
}

/// Maximum number of files in a recipe.
const MOST_FILES: usize = 5;

#[test]
fn recipes_name_few_files_and_all_that_they_name_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let document = std::fs::read_to_string(root.join(DOCUMENT)).expect("the document is beside Cargo.toml");
    let code: Vec<String> = files_below(&root.join("src"))
        .iter()
        .map(|file| std::fs::read_to_string(file).expect("the code can be read"))
        .collect();
    let words: HashSet<&str> =
        code.iter().flat_map(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
    let is_there = |path: &str| root.join("src").join(path).exists() || root.join(path).exists();
    let recipes = recipes(&document);
    for asked in ["A line similarity", "Another source", "A kernel", "Another search", "A file format"] {
        assert!(recipes.iter().any(|recipe| recipe.name.starts_with(asked)), "{asked} has its recipe");
    }
    let mut complaints = Vec::new();
    for Recipe { name, paths, names } in &recipes {
        if paths.is_empty() || paths.len() > MOST_FILES {
            complaints.push(format!("{name} touches {} files", paths.len()));
        }
        complaints
            .extend(paths.iter().filter(|path| !is_there(path)).map(|path| format!("{name}: no {path}")));
        let missing = names.iter().filter(|word| !words.contains(word.as_str()));
        complaints.extend(missing.map(|word| format!("{name}: nothing is called {word}")));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn a_recipe_is_a_paragraph_with_a_heading() {
    let document = "**No recipe.** `x.rs`\n\n## How to add\n\n`y.rs`\n\n**A thing.** A `Thing::made` in `a/`,\n`a/b.rs`, `a/b.rs` \
                    with `--set`\nor `k = v`.\n\n## Next\n\n**Another.** `z.rs`\n";
    let found = recipes(document);
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].name.as_str(), &found[0].paths),
        ("A thing", &["a/", "a/b.rs"].map(String::from).into())
    );
    assert_eq!(found[0].names, ["Thing", "made"]);
}

/// Recipe: the files to change to add a feature.
struct Recipe {
    name: String,
    /// Files to change, and folders for new files.
    paths: BTreeSet<String>,
    /// Names used in the code.
    names: Vec<String>,
}

/// Returns the recipes of the document, one per paragraph.
fn recipes(document: &str) -> Vec<Recipe> {
    let section = document.split("\n## ").find_map(|section| section.strip_prefix("How to add\n"));
    let paragraphs = section.unwrap_or_default().split("\n\n");
    let recipe = |paragraph: &str| {
        let (name, _) = paragraph.trim_start().strip_prefix("**")?.split_once(".**")?;
        let marked: Vec<&str> = paragraph.split('`').skip(1).step_by(2).collect();
        let is_path = |word: &str| word.contains('/') || word.contains('.');
        let is_word = |word: &str| word.chars().all(|c| c.is_alphanumeric() || c == '_' || c == ':');
        let paths = marked.iter().filter(|word| is_path(word)).map(|path| (*path).to_owned()).collect();
        let names = marked.iter().filter(|word| is_word(word)).flat_map(|word| word.split("::"));
        Some(Recipe { name: name.to_owned(), paths, names: names.map(str::to_owned).collect() })
    };
    paragraphs.filter_map(recipe).collect()
}

/// Returns all source files below a folder, sorted.
fn files_below(src: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![src.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("src can be read") {
            let path = entry.expect("src can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Allowed imports within one folder.
struct Section {
    /// Module path of the folder, empty for `src`.
    folder: Vec<String>,
    /// Members of the folder from top to bottom, with their imports and the line of the file.
    rows: Vec<(String, Vec<String>, usize)>,
}

/// Imports between the members of a folder, with the first place of each, and all members.
struct Arrows {
    places: BTreeMap<(String, String), String>,
    members: Vec<String>,
}

impl Section {
    /// Returns all sections of the file.
    fn all(text: &str) -> Vec<Self> {
        let mut sections: Vec<Self> = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            if let Some(folder) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                let folder = folder.split('/').skip(1).map(str::to_owned).collect();
                sections.push(Self { folder, rows: Vec::new() });
                continue;
            }
            let (from, to) = line.split_once(':').expect("a line is `folder: allowed, allowed`");
            let to = to.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
            let section = sections.last_mut().expect("a section begins with its folder in brackets");
            section.rows.push((from.trim().to_owned(), to.collect(), number + 1));
        }
        sections
    }

    /// Returns the imports in this folder.
    fn arrows_of(&self, sources: &[Source]) -> Arrows {
        let depth = self.folder.len();
        let inside =
            |path: &[String]| path.starts_with(&self.folder).then(|| path.get(depth).cloned()).flatten();
        let mut members: Vec<String> = sources.iter().filter_map(|source| inside(&source.module)).collect();
        members.sort();
        members.dedup();
        // A re-export of the folder's own file belongs to the defining file.
        let passed_on: HashMap<&str, &[String]> = sources
            .iter()
            .filter(|source| source.module == self.folder)
            .flat_map(|source| &source.imports)
            .filter_map(|import| Some((import.path.last()?.as_str(), import.path.as_slice())))
            .collect();
        let mut places = BTreeMap::new();
        for source in sources {
            let Some(from) = inside(&source.module) else { continue };
            for import in &source.imports {
                let Some(name) = inside(&import.path) else { continue };
                let to = match passed_on.get(name.as_str()) {
                    _ if members.contains(&name) => Some(name),
                    Some(path) => inside(path),
                    // Items of the folder's own file are common to all members.
                    None => None,
                };
                let Some(to) = to.filter(|to| *to != from) else { continue };
                places
                    .entry((from.clone(), to))
                    .or_insert_with(|| format!("{}:{}", source.file.display(), import.line));
            }
        }
        Arrows { places, members }
    }

    /// Returns all differences between the section and the code.
    fn complaints(&self, arrows: &Arrows) -> Vec<String> {
        let row = |name: &str| self.rows.iter().position(|(from, _, _)| from == name);
        let mut complaints = Vec::new();
        for ((from, to), place) in &arrows.places {
            if !self.rows.iter().any(|(name, drawn, _)| name == from && drawn.contains(to)) {
                complaints.push(format!("{place}: `{from} -> {to}` is not in {ARROWS}"));
            }
        }
        for (k, (from, drawn, line)) in self.rows.iter().enumerate() {
            for to in drawn {
                let complain = |what: &str| format!("{ARROWS}:{line}: `{from} -> {to}` {what}");
                if !arrows.places.contains_key(&(from.clone(), to.clone())) {
                    complaints.push(complain("is not in the code"));
                }
                if row(to).is_none_or(|below| below <= k) {
                    complaints.push(complain("goes upwards"));
                }
            }
        }
        let folder = [&["src".to_owned()], self.folder.as_slice()].concat().join("/");
        for name in arrows.members.iter().filter(|name| row(name).is_none()) {
            complaints.push(format!("{ARROWS}: `{name}` is missing from the section {folder}"));
        }
        complaints
    }
}

/// Returns the cycles of files that import each other, directly or indirectly, each once; files by
/// path.
fn circles(sources: &[Source]) -> Vec<Vec<String>> {
    let by_module: HashMap<&[String], usize> =
        sources.iter().enumerate().map(|(k, source)| (source.module.as_slice(), k)).collect();
    let imported: Vec<BTreeSet<usize>> = sources
        .iter()
        .map(|source| {
            let own = source.imports.iter().filter(|import| !import.is_passed_on);
            own.filter_map(|import| defined_in(&import.path, sources, &by_module)).collect()
        })
        .collect();
    let reached: Vec<BTreeSet<usize>> = (0..sources.len())
        .map(|from| {
            let (mut reached, mut next) = (BTreeSet::new(), vec![from]);
            while let Some(file) = next.pop() {
                next.extend(imported[file].iter().filter(|to| reached.insert(**to)));
            }
            reached
        })
        .collect();
    let circles: BTreeSet<Vec<String>> = (0..sources.len())
        .map(|file| {
            let back =
                reached[file].iter().filter(|other| **other != file && reached[**other].contains(&file));
            let all: BTreeSet<usize> = back.copied().chain([file]).collect();
            all.into_iter().map(|k| sources[k].file.display().to_string()).collect()
        })
        .filter(|circle: &Vec<String>| circle.len() > 1)
        .collect();
    circles.into_iter().collect()
}

/// Returns the file that defines an item, following re-exports.
fn defined_in(path: &[String], sources: &[Source], by_module: &HashMap<&[String], usize>) -> Option<usize> {
    let mut path = path;
    // A chain of re-exports ends; Rust has no cyclic ones.
    for _ in 0..10 {
        let (depth, file) = (0..=path.len()).rev().find_map(|n| Some((n, *by_module.get(&path[..n])?)))?;
        let passed_on = path.get(depth).and_then(|name| {
            sources[file].imports.iter().find(|i| i.path.last() == Some(name) && i.path.as_slice() != path)
        });
        match passed_on {
            Some(import) => path = &import.path,
            None => return Some(file),
        }
    }
    None
}

/// Path used by the code, from the root of the crate.
#[derive(Debug)]
struct Import {
    path: Vec<String>,
    line: usize,
    /// Whether the import is a re-export.
    is_passed_on: bool,
}

/// Source file of the crate.
struct Source {
    file: PathBuf,
    /// Module path from the root of the crate.
    module: Vec<String>,
    imports: Vec<Import>,
    /// Test modules in separate files.
    test_modules: Vec<String>,
}

impl Source {
    /// Reads all files below a folder, except tests.
    fn all(src: &Path) -> Vec<Self> {
        let files = files_below(src);
        let root = src.parent().expect("src is in the repository");
        let sources: Vec<Self> = files
            .iter()
            .map(|file| {
                let code = std::fs::read_to_string(file).expect("the code can be read");
                Self::new(file.strip_prefix(root).expect("it was found there").to_owned(), &code)
            })
            .collect();
        let tests: HashSet<Vec<String>> = sources
            .iter()
            .flat_map(|s| {
                s.test_modules.iter().map(|name| [s.module.as_slice(), std::slice::from_ref(name)].concat())
            })
            .collect();
        let of_tests = |s: &Source| {
            s.file.to_string_lossy().ends_with("tests.rs")
                || (1..=s.module.len()).any(|n| tests.contains(&s.module[..n]))
        };
        sources.into_iter().filter(|s| !of_tests(s)).collect()
    }

    fn new(file: PathBuf, code: &str) -> Self {
        let mut module: Vec<String> =
            file.with_extension("").iter().skip(1).map(|name| name.to_string_lossy().into_owned()).collect();
        if module.last().is_some_and(|name| name == "mod" || name == "lib") {
            module.pop();
        }
        let (tokens, test_modules) = without_tests(&tokens(code));
        let imports = imports(&tokens, &module);
        Self { file, module, imports, test_modules }
    }
}

type Token = (String, usize);

/// Splits code into names, numbers, `::` and single characters, with their lines. Comments, strings
/// and characters are omitted.
fn tokens(code: &str) -> Vec<Token> {
    let all: Vec<char> = code.chars().collect();
    let starts = |at: usize, what: &str| what.chars().enumerate().all(|(k, c)| all.get(at + k) == Some(&c));
    let is_name = |c: &char| c.is_alphanumeric() || *c == '_';
    let mut tokens: Vec<Token> = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < all.len() {
        let begun = at;
        let first = line;
        if starts(at, "//") {
            at += all[at..].iter().position(|c| *c == '\n').unwrap_or(all.len() - at);
        } else if all[at] == '"' {
            let hashes = all[..at].iter().rev().take_while(|c| **c == '#').count();
            let raw = all.get(at.wrapping_sub(hashes + 1)) == Some(&'r');
            let end = if raw { format!("\"{}", "#".repeat(hashes)) } else { "\"".to_owned() };
            at += 1;
            while at < all.len() && !starts(at, &end) {
                at += if all[at] == '\\' && !raw { 2 } else { 1 };
            }
            at += end.len();
        } else if all[at] == '\'' && (all.get(at + 1) == Some(&'\\') || all.get(at + 2) == Some(&'\'')) {
            at += 2;
            at += all[at..].iter().position(|c| *c == '\'').map_or(0, |end| end + 1);
        } else if is_name(&all[at]) {
            at += all[at..].iter().take_while(|c| is_name(c)).count();
            tokens.push((all[begun..at].iter().collect(), first));
        } else {
            at += if starts(at, "::") { 2 } else { 1 };
            let token: String = all[begun..at].iter().collect();
            if !token.trim().is_empty() {
                tokens.push((token, first));
            }
        }
        let at_most = at.min(all.len());
        line += all[begun..at_most].iter().filter(|c| **c == '\n').count();
    }
    tokens
}

/// Removes test-only items. Returns the remaining tokens and the names of test modules in separate
/// files.
fn without_tests(tokens: &[Token]) -> (Vec<Token>, Vec<String>) {
    let is = |at: usize, what: &[&str]| {
        what.iter().enumerate().all(|(k, token)| tokens.get(at + k).is_some_and(|(t, _)| t == token))
    };
    let mut kept = Vec::new();
    let mut modules = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if !is(at, &["#", "[", "cfg", "(", "test", ")", "]"]) {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        at += 7;
        let begun = at;
        let mut depth = 0;
        while at < tokens.len() {
            let token = tokens[at].0.as_str();
            at += 1;
            match token {
                "{" | "(" | "[" => depth += 1,
                "}" | ")" | "]" => depth -= 1,
                _ => {}
            }
            if depth == 0 && (token == ";" || token == "}") {
                break;
            }
        }
        if let [.., (keyword, _), (name, _), (end, _)] = &tokens[begun..at]
            && keyword == "mod"
            && end == ";"
        {
            modules.push(name.clone());
        }
    }
    (kept, modules)
}

/// Returns every imported path, and every path written out from `crate` or `super`.
fn imports(tokens: &[Token], module: &[String]) -> Vec<Import> {
    let is = |at: usize, what: &str| tokens.get(at).is_some_and(|(token, _)| token == what);
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let written_out = ["crate", "super"].iter().any(|name| is(at, name))
            && is(at + 1, "::")
            && !(at > 0 && is(at - 1, "::"));
        // `use<…>` is part of a type.
        if is(at, "use") && !is(at + 1, "<") {
            let begun = found.len();
            let is_passed_on = at > 0 && (is(at - 1, "pub") || is(at - 1, ")"));
            at = tree(tokens, at + 1, module.to_vec(), &mut found);
            found[begun..].iter_mut().for_each(|import| import.is_passed_on = is_passed_on);
        } else if written_out {
            at = tree(tokens, at, module.to_vec(), &mut found);
        } else {
            at += 1;
        }
    }
    found
}

/// Reads a tree of imports below `path`, and returns its end.
fn tree(tokens: &[Token], mut at: usize, mut path: Vec<String>, found: &mut Vec<Import>) -> usize {
    let is = |at: usize, what: &str| tokens.get(at).is_some_and(|(token, _)| token == what);
    while let Some((token, line)) = tokens.get(at) {
        at += 1;
        match token.as_str() {
            "{" => {
                while at < tokens.len() && !is(at, "}") {
                    at = if is(at, ",") { at + 1 } else { tree(tokens, at, path.clone(), found) };
                }
                return at + 1;
            }
            // Programs and examples refer to the crate by name.
            "crate" | "epiline" => path.clear(),
            "super" => drop(path.pop()),
            "self" => {}
            name => path.push(name.to_owned()),
        }
        if !is(at, "::") {
            found.push(Import { path, line: *line, is_passed_on: false });
            return if is(at, "as") { at + 2 } else { at };
        }
        at += 1;
    }
    at
}
