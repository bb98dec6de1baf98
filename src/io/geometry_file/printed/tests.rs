use super::*;

/// A fundamental matrix with entries of very different sizes.
const F: [f64; 9] = [
    6.181_396_811_6e-7,
    -1.528_264_082e-5,
    -0.004_056_142_85,
    1.831_367_114_8e-5,
    3.210_350_69e-7,
    -0.082_424_941_9,
    0.001_285_954_73,
    0.081_500_668_7,
    1.0,
];

/// Returns the numbers, each written by a function.
fn cells(write: impl Fn(f64) -> String) -> Vec<String> {
    F.iter().map(|number| write(*number)).collect()
}

/// Joins rows of three cells.
fn joined(cells: &[String], cell: &str, row: &str) -> String {
    cells.chunks(3).map(|three| three.join(cell)).collect::<Vec<_>>().join(row)
}

/// Returns the same matrix in the notations of many programs.
#[expect(clippy::too_many_lines, reason = "it is a table")]
fn notations() -> Vec<String> {
    let plain = cells(|v| format!("{v:e}"));
    let python = joined(&plain, ", ", "],\n       [");
    let numpy = joined(&plain, " ", "]\n [");
    let short = |power: i32| {
        cells(move |v| {
            let exponent = if v - 1.0 == 0.0 { 0 } else { v.abs().log10().floor() as i32 };
            format!(
                "{} {power_of}{{{exponent}}}",
                v / 10f64.powi(exponent),
                power_of = if power == 0 { "\\times 10^" } else { "\\cdot 10^" }
            )
        })
    };
    let fortran = cells(|v| format!("{v:e}").replace('e', "D"));
    let mathematica = cells(|v| format!("{v:e}").replace('e', "`15.2*^"));
    let scalars = cells(|v| format!("np.float64({v:e})"));
    let scaled = cells(|v| format!("{}", v * 1e3));
    let blocks = |columns: std::ops::Range<usize>| {
        (0..3).map(|r| plain[3 * r..][columns.clone()].join("   ")).collect::<Vec<_>>().join("\n   ")
    };
    let entry = |write: fn(usize, usize) -> String| {
        let lines = (0..9).map(|k| format!("{} = {};\n", write(k / 3, k % 3), plain[k]));
        lines.collect::<Vec<_>>().concat()
    };
    let by_columns: Vec<String> = (0..9).map(|k| plain[3 * (k % 3) + k / 3].clone()).collect();
    vec![
        format!("[[{numpy}]]"),
        format!("array([[{python}]])"),
        format!("F = np.array([[{python}]], dtype=float64)\n"),
        format!("Fundamental matrix (8 points, 2026-11-27 12:03:05, rank 2):\n [[{numpy}]]\n"),
        format!("tensor([[{python}]], device='cuda:0', dtype=torch.float64)\n"),
        format!("[array([[{python}]]), 12]").replace(", 12]", "]"),
        format!("{{'F': array([[{python}]])}}"),
        format!("[[{}]]", joined(&scalars, ", ", "], [")),
        format!("[{}]", joined(&plain, ", ", ";\n ")),
        format!("F: [{}]", joined(&plain, ", ", ";\n ")),
        format!("F = [{}]; % 3x3, rank 2\n", joined(&plain, " ", "; ...\n")),
        format!("F =\n\n   1.0e-03 *\n\n   {}\n", joined(&scaled, "   ", "\n   ")),
        format!("F =\n\n  Columns 1 through 2\n\n   {}\n\n  Column 3\n\n   {}\n", blocks(0..2), blocks(2..3)),
        format!("{{{{{}}}}}", joined(&mathematica, ", ", "}, {")),
        format!("F = \\begin{{pmatrix}}\n{}\n\\end{{pmatrix}}", joined(&short(0), " & ", " \\\\\n")),
        format!(
            "\\left[\\begin{{array}}{{ccc}}{}\\end{{array}}\\right]",
            joined(&short(1), "&", "\\\\[2pt]")
        ),
        format!("const double F[9] = {{{}}};", plain.join(", ")),
        format!("double F[3][3] = {{ {{{}}} }};", joined(&plain, ", ", "},\n {")),
        format!("Eigen::Matrix3d F;\nF << {};", joined(&plain, ", ", ",\n     ")),
        format!("cv::Mat F = (cv::Mat_<double>(3,3) << {});", plain.join(", ")),
        format!("cv::Matx33d F({});", plain.join("f, ")).replace("1e0)", "1e0f)"),
        joined(&fortran, "  ", "\n"),
        format!(
            "            [,1]   [,2]  [,3]\n[1,] {}\n[2,] {}\n[3,] {}\n",
            plain[..3].join(" "),
            plain[3..6].join(" "),
            plain[6..].join(" ")
        ),
        format!("F <- matrix(c({}), nrow = 3, byrow = TRUE)", plain.join(", ")),
        format!("F <- matrix(c({}), 3, 3)", by_columns.join(", ")),
        format!("structure(c({}), dim = c(3L, 3L))", by_columns.join(", ")),
        format!("F = reshape([{}], 3, 3)", by_columns.join(" ")),
        format!("np.array([{}]).reshape(3, 3)", plain.join(", ")),
        format!("F = [{}]'", joined(&by_columns, " ", "; ")),
        format!("3×3 Matrix{{Float64}}:\n {}", joined(&plain, "  ", "\n ")),
        joined(&plain, ",", "\n"),
        joined(&plain, ";", "\n"),
        joined(&plain, "\t", "\r\n"),
        plain.join(","),
        plain.join("\n"),
        format!("| {} |", joined(&plain, " | ", " |\n| ")),
        format!("⎡{}⎤", joined(&plain, "  ", "⎤\n⎢")),
        entry(|r, c| format!("F{}{}", r + 1, c + 1)),
        entry(|r, c| format!("F[{r}][{c}]")),
        entry(|r, c| format!("F({},{})", r + 1, c + 1)),
        format!(
            "row1: {}\nrow2: {}\nrow3: {}\n",
            plain[..3].join(" "),
            plain[3..6].join(" "),
            plain[6..].join(" ")
        ),
        format!(
            "F(1,:) = [{}]\nF(2,:) = [{}]\nF(3,:) = [{}]\n",
            plain[..3].join(" "),
            plain[3..6].join(" "),
            plain[6..].join(" ")
        ),
        format!(
            "F = \\begin{{pmatrix}} {} \\end{{pmatrix}} \\times 10^{{-3}}",
            joined(&scaled, " & ", " \\\\ ")
        ),
        format!("[geometry]\nF = [\n  [{}],\n]\n", joined(&plain, ", ", "],\n  [")),
        format!("3 3\n{}", joined(&plain, " ", "\n")),
        format!(
            "          0         1         2\n0  {}\n1  {}\n2  {}",
            plain[..3].join(" "),
            plain[3..6].join(" "),
            plain[6..].join(" ")
        ),
        format!("127 inliers of 200\nF = [[{python}]]\nE = [[1, 2, 3], [4, 5, 6], [7, 8, 9]]\nerror: 0.35\n"),
        format!("# F, from 8 points\n{}\n", joined(&plain, " ", "\n")),
        format!("%%MatrixMarket matrix array real general\n3 3\n{}", by_columns.join("\n")),
        joined(&cells(|v| format!("{v:.18}")), ";", "\n").replace('.', ","),
        format!("F = [{}]", joined(&plain, ", ", "; ")).replace('-', "\u{2212}"),
    ]
}

fn is_f(numbers: &[f64; 9]) -> bool {
    // The scale has no meaning, and some notations round.
    let scale = numbers[8];
    numbers
        .iter()
        .zip(F)
        .all(|(number, expected)| (number / scale - expected).abs() <= 1e-7 * expected.abs().max(1e-6))
}

/// Words by which a language lists columns or rows. Without them the text is another one.
const NOTATION: [&str; 8] = ["matrix", "byrow", "TRUE", "structure", "reshape", "dim", "MatrixMarket", "c"];

#[test]
fn every_notation_gives_the_same_matrix() {
    let failed: Vec<String> = notations()
        .iter()
        .filter_map(|text| match read(text) {
            Ok(found) if is_f(&found.numbers) => None,
            other => Some(format!("{other:?} of\n{text}\n")),
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn what_is_not_clear_is_refused() {
    let nine = "1 2 3\n4 5 6\n7 8 9";
    for (text, told) in [
        (format!("K = [{nine}]"), "called K"),
        (format!("Essential matrix:\n{nine}"), "called Essential"),
        (format!("# homography\n{nine}"), "called homography"),
        (format!("A = [{nine}]\nB = [2 2 3; 4 5 6; 7 8 9]"), "A and B"),
        (format!("F1 = [{nine}]\nF2 = [2 2 3; 4 5 6; 7 8 9]"), "F1 and F2"),
        ("F = [1 2 3; 4 5 6; 7 8]\nM = [1 2 3; 4 5 6; 7 8 9]".into(), "F has 8"),
        (format!("F = [{nine}]\n\n5 6 7"), "F has 12"),
        ("F =\n1 2 x\n4 5 6\n7 8 9\n10 11 12".into(), "F has 2"),
        ("1 2 x\n4 5 6\n7 8 9\n10 11 12".into(), "cannot be told apart"),
        ("F = [1 2; 3 4 5 6; 7 8 9]".into(), "rows of 2, 4, 3"),
        ("[[1 2] [3 4 5 6] [7 8 9]]".into(), "rows of 2, 4, 3"),
        ("F = 1 2 3 4\n5 6 7 8\n9".into(), "rows of 4, 4, 1"),
        ("F = [1 2 3; 4 nan 6; 7 8 9]".into(), "\"nan\""),
        ("F11 = 1\nF12 = 2\nF13 = 3\nF21 = 4".into(), "found 4"),
        ("F11 = 1\nF12 = 2\nF11 = 3\nF21 = 4".into(), "not those of one"),
    ] {
        match read(&text) {
            Err(NoMatrix::Unclear(problem)) => assert!(problem.contains(told), "{problem}: {text}"),
            other => panic!("{other:?}: {text}"),
        }
    }
    for (text, count) in [
        ("F1 = nothing, on 27/11/2026 at 12:03:05, version 1.2.3, 3x3".to_owned(), 0),
        ("1 2 3\n4 5 6\n7 8".to_owned(), 8),
        (format!("[[{nine} 10]]"), 10),
        ("[[1 2 3] [4 5 6] [7 8 1/3]]".to_owned(), 8),
        (format!("{nine}\n\n{nine}"), 18),
        ("1 2 3 - 4 5 6 7 8 9".to_owned(), 5),
    ] {
        assert_eq!(read(&text), Err(NoMatrix::Count(count)), "{text}");
    }
}

/// Returns a text with each word and number left out, replaced and doubled in turn, and with each line left out.
fn changed(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let words = text.split(|c: char| c.is_whitespace() || ",;()[]{}|&".contains(c));
    for word in words.filter(|word| word.contains(char::is_alphanumeric)) {
        let from = word.as_ptr() as usize - text.as_ptr() as usize;
        let (before, after) = (&text[..from], &text[from + word.len()..]);
        // Without such a word the text is in another language.
        if NOTATION.iter().any(|part| word.contains(part)) {
            continue;
        }
        all.push(format!("{before}{after}"));
        all.push(format!("{before}Name{after}"));
        if word.parse::<f64>().is_ok() {
            all.push(format!("{before}{word} {word}{after}"));
            all.push(format!("{before}x{after}"));
            all.push(format!("{before}1/3{after}"));
        }
    }
    let lines: Vec<&str> = text.lines().collect();
    for line in (0..lines.len()).filter(|k| !lines[*k].contains("MatrixMarket")) {
        let mut less = lines.clone();
        less.remove(line);
        all.push(less.join("\n"));
    }
    all
}

/// A text with a word or a number less, another word, a line less or a number twice never shows another matrix.
#[test]
fn changed_texts_give_the_same_matrix_or_none() {
    let texts: Vec<String> = notations().iter().flat_map(|text| changed(text)).collect();
    let wrong: Vec<&String> =
        texts.iter().filter(|text| read(text).is_ok_and(|found| !is_f(&found.numbers))).collect();
    assert!(wrong.is_empty(), "{} of {}, such as\n{}", wrong.len(), texts.len(), wrong[0]);
}
