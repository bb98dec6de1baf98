//! Report files of an evaluation.

use std::path::{Path, PathBuf};

use super::{Pictures, epiline, run, small_pairs, text};

/// Evaluates the pair of a folder into its subfolder `drawn`. Returns the HTML page and the
/// Markdown text.
#[track_caller]
fn drawn(pictures: &Pictures, rest: &[&str]) -> (String, String) {
    let (folder, report) = (pictures.0.path().to_str().unwrap(), pictures.text("drawn"));
    let ask = ["evaluate", "pairs", folder, "--trials", "2", "--protocol", "paper", "--report", &report];
    let output = run(&[&ask[..], rest].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(pictures.path("drawn").join(name)).unwrap();
    (read("report.html"), read("report.md"))
}

/// Returns the figures linked from a Markdown text.
fn figures(markdown: &str) -> Vec<PathBuf> {
    let links = markdown.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    links.map(PathBuf::from).collect()
}

#[test]
fn is_one_page_and_the_same_as_markdown() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let (html, markdown) = drawn(&pictures, &["--methods", "two-point,seven-point,eight-point"]);
    for words in
        ["Pair p", "two-point robust", "eight-point", "Worst trials", "Trials without a result", "Parameters"]
    {
        assert!(html.contains(words) && markdown.contains(words), "{words}");
    }
    // The page loads no other file and contains no machine path.
    for reference in ["src=", "<link", "<script", "url(", "@import"] {
        assert!(!html.contains(reference), "{reference}");
    }
    let machine = pictures.0.path().to_str().unwrap();
    assert!(!html.contains(machine) && !markdown.contains(machine));
    assert!(html.contains("data:image/jpeg;base64,"), "pictures are in the page");

    let shown = figures(&markdown);
    assert_eq!(shown.len(), html.matches("<figure>").count());
    for figure in &shown {
        let content = std::fs::read_to_string(pictures.path("drawn").join(figure)).unwrap();
        assert!(content.starts_with("<?xml") && !content.contains("NaN"), "{}", figure.display());
    }
    // Both outputs have every row of every table.
    let rows = markdown.lines().filter(|line| line.starts_with("| ")).count();
    let tables = html.matches("<thead>").count();
    assert_eq!(rows, html.matches("<tr").count() - facts(&html) + tables, "one line of dashes a table");
}

/// Counts the rows of lists of names and values, which are not tables in Markdown.
fn facts(html: &str) -> usize {
    html.matches("<th scope=\"row\">").count()
}

#[test]
fn is_the_same_again() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let ask = ["--methods", "two-point,eight-point", "--seed", "3"];
    let seen = |page: &str| {
        // Times occur only in two tables, not in figures.
        let figures: Vec<_> =
            page.split("<figure>").skip(1).map(|f| f.split("</figure>").next().unwrap()).collect();
        figures.join("\n")
    };
    let (first, _) = drawn(&pictures, &ask);
    let (again, _) = drawn(&pictures, &[&ask[..], &["--threads", "1"]].concat());
    assert_eq!(seen(&first), seen(&again));
}

#[cfg(unix)]
#[test]
fn shows_hostile_names_as_they_are() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let hostile = "<script>x|*y*&\"'";
    for (from, to) in [("pA.png", "A.png"), ("pB.png", "B.png"), ("p.txt", ".txt")] {
        std::fs::rename(pictures.path(from), pictures.path(&format!("{hostile}{to}"))).unwrap();
    }
    let (html, markdown) = drawn(&pictures, &["--methods", "eight-point"]);
    assert!(!html.contains("<script") && html.contains("&lt;script&gt;x|*y*&amp;"));
    assert!(markdown.contains("\\<script\\>x\\|\\*y\\*\\&"), "{markdown}");
    for figure in figures(&markdown) {
        assert!(pictures.path("drawn").join(&figure).is_file(), "{}", figure.display());
        assert!(figure.to_str().unwrap().chars().all(|c| c.is_ascii_alphanumeric() || "-/.".contains(c)));
    }
}

#[test]
fn is_refused_before_the_work_where_it_cannot_be_written() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    let folder = pictures.0.path().to_str().unwrap();
    let occupied = pictures.text("words.txt");
    let below = pictures.text("words.txt/report");
    for place in [&occupied, &below] {
        let started =
            epiline(&["evaluate", "pairs", folder, "--trials", "1", "--report", place]).output().unwrap();
        assert_eq!(started.status.code(), Some(2));
        let complaint = text(&started.stderr);
        assert!(complaint.contains("cannot make the folder") && !complaint.contains("trials"), "{complaint}");
    }
    assert!(Path::new(&occupied).is_file());
}
