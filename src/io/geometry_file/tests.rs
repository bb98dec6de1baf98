use super::*;
use crate::camera::PicturesOf;
use crate::geometry::random_scene::example_seen;
use crate::geometry::{Camera, Frame, symmetric_epipolar_distance};
use nalgebra::Matrix3;
use proptest::prelude::*;

fn example() -> GeometryFile {
    let (camera1, camera2) = Camera::example_pair();
    let pair = |k: f64| {
        let mut pair = example_seen((k * 0.7).sin() * 2.0, (k * 1.3).cos(), 4.0 + (k * 0.31).sin() * 2.0);
        // Noise of tenths of a pixel gives the self-check a value.
        pair.point1.x += 0.3 * (k * 5.1).sin();
        pair.point2.y += 0.2 * (k * 3.7).cos();
        pair
    };
    GeometryFile {
        fundamental: Camera::fundamental(&camera1, &camera2),
        cameras: Some([camera1, camera2]),
        homographies: Some([
            Matrix3::new(1.01, 0.02, -3.5, -0.01, 0.99, 7.25, 1e-5, -2e-6, 1.0),
            Matrix3::new(0.97, 1.0 / 3.0, 12.0, 0.03, 1.02, -4.0, 3e-7, 1e-6, 1.0),
        ]),
        homography21: Some(Matrix3::new(0.9, -0.1, 30.5, 0.1, 0.9, -7.0, 1e-5, 3e-6, 1.0)),
        pairs: (0..30).map(|k| pair(f64::from(k))).collect(),
        images: Some(
            ["left view.png", "it's F = [<a> \"test\"] & more.png"]
                .map(|name| ImageNote::new(name.to_owned(), Frame::new(768, 576))),
        ),
        ..GeometryFile::of(PicturesOf::Untold)
    }
}

#[test]
fn every_format_says_how_far_to_trust_it_and_where_the_pairs_come_from() {
    let origins = [PairOrigin::Clicked, PairOrigin::Clicked, PairOrigin::Suggested];
    let names = ["p", "it's \"<the>\" -- door\n", "r"];
    let labels = names.iter().zip(origins).map(|(name, origin)| PairLabel { name: (*name).into(), origin });
    let automatic = PairLabel { origin: PairOrigin::Automatic, ..PairLabel::default() };
    let file = GeometryFile {
        labels: labels.chain(vec![automatic; 27]).collect(),
        trust: Some(TrustNote {
            geometry: "imported from F.txt, as read".into(),
            verdict: "unreliable".into(),
            reasons: vec!["Pair q is 9 px off -- check it.".into()],
        }),
        ..example()
    };
    for format in Format::ALL {
        let text = file.to_text(format);
        for words in [
            "unreliable",
            "imported from F.txt, as read",
            "Pair q is 9 px off -- check it.",
            "clicked",
            "suggested",
            "automatic",
            "door",
        ] {
            assert!(text.contains(words), "{format:?}: {words} is not in\n{text}");
        }
    }
    for format in read_formats() {
        let (found, told) = GeometryFile::parse(&file.to_text(format)).unwrap();
        assert_eq!((found, told), (example(), format), "the words are no numbers");
    }
    assert!(file.to_text(Format::Text).contains("# automatic: 27\n"));
    assert!(file.to_text(Format::Matlab).contains("'it''s \"<the>\" -- door '"));
}

/// Returns the formats that can be read.
fn read_formats() -> impl Iterator<Item = Format> {
    Format::ALL.into_iter().filter(|format| *format != Format::Matlab)
}

#[test]
fn every_format_gives_everything_back() {
    let expected = example();
    for format in read_formats() {
        let text = expected.to_text(format);
        let (found, told) = GeometryFile::parse(&text).unwrap_or_else(|e| panic!("{format:?}: {e}\n{text}"));
        assert_eq!(told, format);
        assert_eq!(found, expected, "{format:?}");
        // Windows line ends must give the same file.
        let (found, told) = GeometryFile::parse(&text.replace('\n', "\r\n")).unwrap();
        assert_eq!(told, format);
        assert_eq!(found, expected, "{format:?}");
    }
}

#[test]
fn parts_can_be_missing() {
    let whole = example();
    let parts = [
        GeometryFile { fundamental: whole.fundamental, ..GeometryFile::of(PicturesOf::Untold) },
        GeometryFile { pairs: whole.pairs.clone(), ..GeometryFile::of(PicturesOf::Untold) },
        GeometryFile {
            fundamental: whole.fundamental,
            pairs: whole.pairs.clone(),
            ..GeometryFile::of(PicturesOf::Untold)
        },
        GeometryFile { homographies: whole.homographies, ..GeometryFile::of(PicturesOf::Untold) },
        GeometryFile { homography21: whole.homography21, ..GeometryFile::of(PicturesOf::Untold) },
    ];
    for format in read_formats() {
        for part in &parts {
            let found = GeometryFile::parse(&part.to_text(format));
            // Homographies alone are not a geometry, but they are read back.
            let (found, _) = found.unwrap_or_else(|e| panic!("{format:?}: {e}"));
            assert_eq!(found.pairs.len(), part.pairs.len());
            assert_eq!(found.fundamental.is_some(), part.fundamental.is_some());
            assert_eq!(found.homographies.is_some(), part.homographies.is_some());
            assert_eq!(found.homography21, part.homography21);
            assert!(found.images.is_none() && found.cameras.is_none());
        }
    }
}

#[test]
fn cameras_alone_are_written_with_their_f() {
    let cameras = GeometryFile { cameras: example().cameras, ..GeometryFile::of(PicturesOf::Untold) };
    for format in read_formats() {
        let (found, _) = GeometryFile::parse(&cameras.to_text(format)).unwrap();
        let difference = found.fundamental.unwrap().matrix() - example().fundamental.unwrap().matrix();
        assert!(difference.norm() < 1e-12, "{format:?}");
    }
}

/// Checks that the numbers in a file, with the origin it states, have the stated self-check.
#[test]
fn every_file_fits_itself_and_says_how_well() {
    let file = example();
    let f = file.fundamental.unwrap();
    let distances: Vec<f64> = file.pairs.iter().map(|p| symmetric_epipolar_distance(&f, p)).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let max = distances.iter().copied().fold(0.0, f64::max);
    assert!(mean > 0.05 && max > mean);
    for format in Format::ALL {
        let written = WrittenGeometry::new(&file, format);
        let check = written.check.unwrap();
        assert_eq!(check.pairs, 30);
        assert!((check.mean - mean).abs() < 1e-9 && (check.max - max).abs() < 1e-9, "{format:?} {check:?}");
        let text = file.to_text(format);
        assert!(text.contains(&format!("{mean:.3e} px on average and {max:.3e} px at most")), "{text}");
        let origin = format!("upper left pixel is ({0}, {0})", format.origin());
        for words in ["x2' F x1 = 0", "row by row", "left view.png", "768", "576", &origin] {
            assert!(text.contains(words), "{format:?}: {words}");
        }
    }
}

#[test]
fn json_has_the_names_of_a_result() {
    let text = example().to_text(Format::Json);
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["fundamental"].as_array().unwrap().len(), 3);
    for epipole in ["epipole1", "epipole2"] {
        assert!(value[epipole].as_array().unwrap().iter().all(serde_json::Value::is_f64));
    }
    assert_eq!(value["pairs"][0].as_array().unwrap().len(), 4);
    assert_eq!(value["images"][0]["width"], 768);
    // Null counts as a missing field. The matches of a result are not rows of numbers.
    let result =
        "{\"fundamental\": [[0,0,-4],[0,0,-7],[4,7,0]], \"matches\": [{\"pair\": [1,2,3,4]}], \"P1\": null}";
    let (file, _) = GeometryFile::parse(result).unwrap();
    assert!(file.fundamental.is_some() && file.pairs.is_empty());
}

/// As written by OpenCV 4.12: floats of both sizes, points as N×1 with two channels.
#[test]
fn files_of_opencv_are_read() {
    let yaml = "%YAML:1.0\n---\nF: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0., 0., -4., 0., 0.,\n       -7., 4., 7., 0. ]\npoints1: !!opencv-matrix\n   rows: 2\n   cols: 1\n   dt: \"2f\"\n   data: [ 1., 2.5, -3., 4.e+00 ]\npoints2: !!opencv-matrix\n   rows: 2\n   cols: 2\n   dt: i\n   data: [ 5, 6, 7, 8 ]\nname: \"a: b\"\n";
    let json = "{\"F\": {\"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\", \"data\": [0.0,0.0,-4,0,0,-7,4,7,0]}, \"pairs\": [[1,2.5,5,6],[-3,4,7,8]]}";
    let nested = "F: [[0, 0, -4], [0, 0, -7], [4, 7, 0]]\npairs:\n  - [1, 2.5, 5, 6]\n  - [-3, 4, 7, 8]\n";
    for text in [yaml, &yaml.replace("%YAML:1.0", "%YAML 1.2"), json, nested] {
        let (file, _) = GeometryFile::parse(text).unwrap_or_else(|e| panic!("{e} in {text}"));
        assert!((file.fundamental.unwrap().matrix() * 130f64.sqrt()).iter().any(|v| (v - 7.0).abs() < 1e-9));
        assert_eq!(file.pairs, [PointPair::new(1.0, 2.5, 5.0, 6.0), PointPair::new(-3.0, 4.0, 7.0, 8.0)]);
    }
}

/// MATLAB counts pixels from 1, and the numbers in the script must agree with that.
#[test]
fn matlab_scripts_count_from_one_and_are_not_read() {
    let file = example();
    let text = file.to_text(Format::Matlab);
    let numbers = |name: &str| -> Vec<f64> {
        let inside = text.split(&format!("\n{name} = [")).nth(1).unwrap().split("];").next().unwrap();
        inside.split([',', ';', '\n']).filter_map(|n| n.trim().parse().ok()).collect()
    };
    let f = FundamentalMatrix::from_rank_two(Matrix3::from_row_slice(&numbers("F"))).unwrap();
    let (points1, points2) = (numbers("points1"), numbers("points2"));
    assert_eq!((points1.len(), points2.len()), (60, 60));
    for ((a, b), pair) in points1.chunks(2).zip(points2.chunks(2)).zip(&file.pairs) {
        let there = PointPair::new(a[0], a[1], b[0], b[1]);
        assert!((there.point1 - pair.point1).add_scalar(-1.0).norm() < 1e-9);
        let [from_file, own] = [(&f, &there), (&file.fundamental.unwrap(), pair)]
            .map(|(f, pair)| symmetric_epipolar_distance(f, pair));
        assert!((from_file - own).abs() < 1e-9);
    }
    for words in ["F_vgg = F';", "tform1 = H1';", "tform2 = H2';", "it''s F"] {
        assert!(text.contains(words), "{words}");
    }
    let refused = GeometryFile::parse(&text).unwrap_err().to_string();
    assert!(refused.contains("MATLAB script") && refused.contains("writematrix"), "{refused}");
}

/// Conflicting values are ambiguous.
#[test]
fn what_comes_twice_is_refused() {
    let (f, g) = ("0 0 0 0 0 -1 0 1 0", "0 0 -4 0 0 -7 4 7 0");
    let list = |numbers: &str| format!("[{}]", numbers.replace(' ', ", "));
    let writers: [&dyn Fn(&str) -> String; 4] = [
        &|second| format!("{{\"F\": {}, \"F\": {}}}", list(f), list(second)),
        &|second| format!("{{\"F\": {}, \"fundamental\": {}}}", list(f), list(second)),
        &|second| format!("F: {}\nF: {}\n", list(f), list(second)),
        &|second| format!("F\n{f}\nF\n{second}\n"),
    ];
    for write in writers {
        let problem = GeometryFile::parse(&write(g)).unwrap_err().to_string();
        assert!(problem.contains("occurs twice with different values"), "{problem}");
        assert!(GeometryFile::parse(&write(f)).unwrap().0.fundamental.is_some());
    }
}

fn read(content: &str) -> Result<FundamentalMatrix, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f");
    std::fs::write(&path, content).unwrap();
    read_fundamental(&path).map_err(|e| e.to_string())
}

#[test]
fn all_bare_forms_give_the_same_matrix() {
    let (camera1, camera2) = Camera::example_pair();
    let f = Camera::fundamental(&camera1, &camera2).unwrap();
    let rows = f.rows();
    let lines: Vec<String> = rows.iter().map(|r| format!("{} {} {}", r[0], r[1], r[2])).collect();
    let cameras: Vec<String> = [camera1, camera2]
        .iter()
        .flat_map(|c| {
            c.matrix().row_iter().map(|r| format!("{} {} {} {}", r[0], r[1], r[2], r[3])).collect::<Vec<_>>()
        })
        .collect();
    for content in [
        format!("{{\"score\": 1.5, \"fundamental\": {rows:?}}}"),
        format!("{rows:?}"),
        format!("{:?}", rows.concat()),
        format!("# F\n{}\n", lines.join("\n")),
        lines.join(", "),
        cameras.join("\n"),
        format!("P1\n{}\nP2\n{}", cameras[..3].join("\n"), cameras[3..].join("\n")),
    ] {
        let found = read(&content).unwrap();
        assert!((found.matrix() - f.matrix()).norm() < 1e-9, "{content}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    for (content, words) in [
        ("1 2 3", "expected the nine numbers of a fundamental matrix, found 3"),
        ("1 2 3\n4 nan 6", "line 2: \"nan\" is not a finite number"),
        ("{\"score\": 1}", "Known names are F or fundamental"),
        ("{\"pairs\": [[1, 2, 3, 4]]}", "there is no fundamental matrix in it"),
        ("{\"fundamental\": 7}", "not a list of rows"),
        ("[[1, 2, \"x\"]]", "\"x\" is not a finite number"),
        ("[[1, 2", "not valid JSON"),
        ("1 1 1 1 1 1 1 1 1", "rank 1 or 0"),
        ("0 0 0 0 0 0 0 0 0", "rank 1 or 0"),
        ("1 0 0 0 1 0 0 0 1", "the matrix has rank 3"),
        ("0.9 -0.3 120 0.31 0.92 -45 1e-4 -2e-5 1", "It may be a homography, or rounded to too few digits"),
        ("F\n1 2 3\n4 5\n", "row 2 has 2 numbers"),
        ("F\n1 2 3\n4 5 6\n", "expected a 3×3 matrix, found 2×3"),
        ("F\n1 2 x\n", "line 2: \"x\" is not a finite number"),
        ("P1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n", "P1 is given, but P2 is missing"),
        ("P1\n1 0 0 0\n0 1 0 0\n0 0 1 0\nP2\n1 0 0 0\n0 1 0 0\n0 0 1 0\n", "same centre"),
        ("F = [1 2 3; 4 5 x]", "but F has 5"),
        (
            "%YAML:1.0\n---\nF: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1, 2 ]\n",
            "expected 3×3 numbers, found 2",
        ),
        (
            "%YAML:1.0\n---\nF: !!opencv-matrix\n   rows: 1\n   cols: 3\n   dt: d\n   data: [ .Nan, 1, 2 ]\n",
            "\".Nan\" is not a finite number",
        ),
        (
            "%YAML:1.0\n---\nF: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1, 2",
            "not valid YAML",
        ),
        ("%YAML:1.0", "empty or ends too early"),
        ("F: [1, 2\npoints: 3", "but F has 2"),
        ("a: &a [1]\nF: *a\n", "aliases"),
        ("<opencv_storage><F>", "ends too early"),
        (
            "{\"F\": {\"rows\": 18446744073709551615, \"cols\": 2, \"dt\": \"99d\", \"data\": []}}",
            "numbers, found 0",
        ),
        (
            "{\"points1\": [[1, 2]], \"points2\": [[1, 2], [3, 4]], \"F\": [[0,0,0],[0,0,-1],[0,1,0]]}",
            "1 points in image 1 and 2",
        ),
        ("{\"pairs\": [[1e308, 1e308, 1]], \"F\": [[0,0,0],[0,0,-1],[0,1,0]]}", "expected rows of 4"),
        ("", "expected the nine numbers of a fundamental matrix, found 0"),
    ] {
        let message = read(content).unwrap_err();
        assert!(message.contains(words), "{words} in {message}");
        assert!(!message.contains('\n') && message.len() < 400, "{message}");
    }
    assert!(read_fundamental(Path::new("no/such")).unwrap_err().to_string().contains("no such file"));
}

#[test]
fn deep_nesting_is_refused() {
    const DEEP: usize = 100_000;
    for text in [
        "[".repeat(DEEP),
        format!("F: {}", "[".repeat(DEEP)),
        format!("F: {}{}", "[".repeat(DEEP), "]".repeat(DEEP)),
        format!("%YAML:1.0\n---\n{}", "{a: ".repeat(DEEP)),
        (0..2000).fold(String::from("---\n"), |text, k| format!("{text}{}a:\n", " ".repeat(k))),
        format!("<opencv_storage>{}</opencv_storage>", "<a>".repeat(DEEP)),
        format!("<opencv_storage>{}{}</opencv_storage>", "<a>".repeat(DEEP), "</a>".repeat(DEEP)),
        format!("F = {}", "[".repeat(DEEP)),
        format!("{}1 2 3", "F\n".repeat(DEEP)),
    ] {
        let message = GeometryFile::parse(&text).unwrap_err().to_string();
        assert!(message.len() < 400, "{message}");
    }
}

#[test]
fn pairs_of_every_format_and_none_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    for format in read_formats() {
        example().write(&path, format).unwrap();
        assert_eq!(read_point_pairs(&path).unwrap().len(), 30);
    }
    std::fs::write(&path, "# nothing\n").unwrap();
    assert!(read_point_pairs(&path).unwrap_err().to_string().contains("no point pairs"));
    std::fs::write(&path, "0 0 0 0 0 -1 0 1 0\n").unwrap();
    assert!(read_point_pairs(&path).unwrap_err().to_string().contains("no point pairs"));
    std::fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
    assert!(read_point_pairs(&path).unwrap_err().to_string().contains("not a text file"));
    assert!(read_point_pairs(folder.path()).unwrap_err().to_string().contains("it is a folder"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_numbers_come_back(
        cells in prop::array::uniform9(-1.0..1.0f64),
        scale in -6.0..2.0f64,
        points in prop::collection::vec(prop::array::uniform4(-1e4..1e4f64), 0..12),
        name in "[ -~é]{0,12}",
        with_images in any::<bool>(),
    ) {
        let weight = 10f64.powf(scale);
        let rows = [[0, 1, 2], [3, 4, 5], [6, 7, 8]].map(|r| r.map(|k| {
            cells[k] * if k % 3 < 2 { weight } else { 1.0 } * if k < 6 { weight } else { 1.0 }
        }));
        let matrix = Matrix3::from_fn(|r, c| rows[r][c]);
        let nearest = FundamentalMatrix::nearest_rank_two(matrix).and_then(|f| FundamentalMatrix::from_rows(f.rows()).ok());
        let Some(fundamental) = nearest else { return Ok(()) };
        let image = || ImageNote::new(name.trim().to_owned(), Frame::new(7, 5));
        let file = GeometryFile {
            fundamental: Some(fundamental),
            pairs: points.iter().map(|p| PointPair::new(p[0], p[1], p[2], p[3])).collect(),
            images: with_images.then(|| [image(), image()]),
            ..GeometryFile::of(PicturesOf::Untold)
        };
        for format in read_formats() {
            let text = file.to_text(format);
            let (found, told) = GeometryFile::parse(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
            prop_assert_eq!(told, format);
            prop_assert_eq!(&found, &file, "{:?}", format);
        }
    }
}

#[test]
fn a_result_without_refinement_has_its_clicks_and_no_matches() {
    let text =
        r#"{"fundamental": [[0, 0, 0], [0, 0, -1], [0, 1, 0]], "pairs": [[1, 2, 3, 2]], "matches": []}"#;
    let (file, _) = GeometryFile::parse(text).unwrap();
    assert_eq!(file.pairs, [PointPair::new(1.0, 2.0, 3.0, 2.0)]);
    let (file, _) = GeometryFile::parse(r#"{"matches": [[1, 2, 3, 2]]}"#).unwrap();
    assert_eq!(file.pairs.len(), 1);
}
