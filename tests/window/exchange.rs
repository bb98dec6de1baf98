//! Files of other programs: what is exported, what is imported, and the question what a matrix means.

use crate::support::*;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use egui::{ColorImage, Key, Modifiers, ViewportCommand};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::camera::PicturesOf;
use epiline::geometry::{FundamentalMatrix, PointPair};
use epiline::internals::app::model::comparison::{Contestant, PointSet};
use epiline::internals::app::model::document::Side;
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::{Format, GeometryFile};
use epiline::synthetic::{Sample, SamplePair};

pub fn truth() -> SamplePair {
    Sample::default().load()
}

pub fn file(files: &Files, name: &str, text: &str) -> PathBuf {
    let path = files.0.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

pub fn rows(f: &FundamentalMatrix) -> String {
    f.rows().map(|row| row.map(|v| format!("{v:e}")).join(" ")).join("\n")
}

fn transposed(f: &FundamentalMatrix) -> FundamentalMatrix {
    FundamentalMatrix::from_rank_two(f.matrix().transpose()).unwrap()
}

fn csv(pairs: &[PointPair]) -> String {
    let row = |p: &PointPair| format!("{},{},{},{}\n", p.point1.x, p.point1.y, p.point2.x, p.point2.y);
    "x1,y1,x2,y2\n".to_owned() + &pairs.iter().map(row).collect::<String>()
}

pub fn imported(window: &Window) -> Option<FundamentalMatrix> {
    window.state().document().imported.as_ref().map(|imported| imported.fundamental)
}

fn is_near(a: &FundamentalMatrix, b: &FundamentalMatrix) -> bool {
    (a.matrix() - b.matrix()).norm() < 1e-9
}

pub fn told(window: &Window, words: &str) -> bool {
    window.state().messages().any(|text| text.contains(words))
}

#[test]
fn point_pairs_become_those_of_the_document_in_one_step() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().pairs.clone();
    let mut pairs = truth().matches[..5].to_vec();
    pairs.push(PointPair::new(-4.0, 10.0, 20.0, 20.0));
    drop_files(&mut window, &[file(&files, "m.csv", &csv(&pairs))]);
    assert_eq!(window.state().document().pairs, pairs[..5]);
    let words = "outside the images: 1 of the 6 point pairs of m.csv (number 6)";
    assert!(told(&window, words), "the one outside is named");
    window.get_by_label("5 point pairs from m.csv, each can be dragged.");
    undo(&mut window);
    assert_eq!(window.state().document().pairs, before);
}

#[test]
fn many_pairs_leave_the_pictures_visible() {
    let files = Files::new();
    let mut window = sample();
    let full = |window: &Window| {
        let rings = window.output().shapes.iter().filter(|clipped| {
            matches!(&clipped.shape, egui::Shape::Circle(circle) if (circle.radius - 6.5).abs() < 0.01)
        });
        // Each ring has an edge.
        rings.count() / 2
    };
    for (count, shown) in [(24, 48), (25, 0)] {
        let pairs = &truth().matches[..count];
        drop_files(&mut window, &[file(&files, "m.csv", &csv(pairs))]);
        assert_eq!(full(&window), shown, "{count} pairs");
    }
    let row = window.get_by_label("Row of pair p").rect().center();
    window.hover_at(row);
    settle(&mut window);
    assert_eq!(full(&window), 2, "both points of the pair under the cursor");
}

#[test]
fn a_transposed_matrix_is_recognised_before_it_is_drawn() {
    let files = Files::new();
    let mut window = sample();
    let true_f = truth().fundamental;
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&transposed(&true_f)))]);
    window.get_by_label("Convention of the matrix");
    window.get_by_label_contains("The geometry does not fit as read");
    window.get_by_label("recommended");
    assert_eq!(imported(&window), None);
    window.hover_at(at(&window, Side::Left, 0.1, 0.1));
    window.step();
    assert!(lines(&window, Side::Right, HOVER).is_empty(), "nothing is drawn with a wrong reading");
    tap(&mut window, "Import matrix");
    assert!(is_near(&imported(&window).unwrap(), &true_f));
    let kept = window.state().document().imported.clone().unwrap();
    assert!(kept.reading.starts_with("transposed") && kept.check.is_some_and(|c| c.fits && c.median < 1.0));
    // The whole window shows it, without any click.
    window.get_by_label_contains("The images show the imported geometry");
    window.hover_at(at(&window, Side::Left, 0.1, 0.1));
    window.step();
    window.step();
    assert!(!lines(&window, Side::Right, HOVER).is_empty());
    window.key_press(Key::I);
    click_at(&mut window, Side::Left, 0.1, 0.1);
    assert_eq!(window.state().document().pins.len(), 1);
    assert!(painted(&window, "pin 1"), "its lines can be pinned");
    press(&mut window, Key::Escape);
    undo(&mut window);
    assert!(window.state().document().pins.is_empty());
    undo(&mut window);
    assert_eq!(imported(&window), None);
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert!(imported(&window).is_some());
}

#[test]
fn as_it_is_means_as_the_file_has_it() {
    let files = Files::new();
    let mut window = sample();
    let given = transposed(&truth().fundamental);
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&given))]);
    tap(&mut window, "as in the file");
    tap(&mut window, "Import matrix");
    assert!(is_near(&imported(&window).unwrap(), &given));
    assert!(window.state().document().imported.as_ref().unwrap().check.as_ref().is_some_and(|c| !c.fits));
    window.get_by_label_contains("It does not fit the matches");
    tap(&mut window, "Remove it");
    assert_eq!(imported(&window), None);
    undo(&mut window);
    assert!(imported(&window).is_some());
}

#[test]
fn the_next_reading_that_the_sentence_names_can_be_chosen() {
    let files = Files::new();
    let mut window = sample();
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&truth().fundamental))]);
    window.get_by_label_contains("Under the next different reading (pixels counted from (0.5, 0.5))");
    window.get_by_label("pixels counted from (0.5, 0.5)");
    tap(&mut window, "as in the file");
    tap(&mut window, "Import matrix");
    assert!(painted(&window, "Convention") && painted(&window, "as in the file"));
    assert!(!painted(&window, "as read"));
}

#[test]
fn without_matches_a_matrix_is_marked_as_unchecked() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 640, 480), files.image("b.png", 640, 480)]);
    let path = file(&files, "F.txt", &rows(&truth().fundamental));
    drop_files(&mut window, std::slice::from_ref(&path));
    window.get_by_label_contains("that takes 8 matches, and there are");
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Convention of the matrix").is_none() && imported(&window).is_none());
    drop_files(&mut window, &[path]);
    tap(&mut window, "Import matrix");
    assert_eq!(window.state().document().imported.as_ref().unwrap().check, None);
    window.get_by_label("unchecked");
}

#[test]
fn own_files_come_back_with_their_pairs_and_cameras_count_too() {
    let files = Files::new();
    let sample_pair = truth();
    let pairs = sample_pair.matches[..12].to_vec();
    let whole = GeometryFile {
        fundamental: Some(sample_pair.fundamental),
        pairs: pairs.clone(),
        ..GeometryFile::of(PicturesOf::Untold)
    };
    for format in Format::ALL.into_iter().filter(|format| *format != Format::Matlab) {
        let mut window = sample();
        let path = file(&files, &format!("own.{}", format.extension()), &whole.to_text(format));
        drop_files(&mut window, &[path]);
        window.get_by_label_contains("The geometry fits as read");
        tap(&mut window, "Import matrix");
        assert!(is_near(&imported(&window).unwrap(), &sample_pair.fundamental), "{format:?}");
        assert_eq!(window.state().document().pairs.len(), 12);
        undo(&mut window);
        assert!(window.state().document().pairs.is_empty() && imported(&window).is_none(), "one step");
    }
    let camera = |k: usize| {
        let m = sample_pair.cameras[k].matrix();
        let row = |r: usize| (0..4).map(|c| format!("{:e}", m[(r, c)])).collect::<Vec<_>>().join(" ");
        file(&files, &format!("view{k}.P"), &(0..3).map(row).collect::<Vec<_>>().join("\n"))
    };
    let mut window = sample();
    drop_files(&mut window, &[camera(0), camera(1)]);
    tap(&mut window, "Import matrix");
    assert!(is_near(&imported(&window).unwrap(), &sample_pair.fundamental));
    drop_files(&mut window, &[camera(0)]);
    assert!(told(&window, "it is the camera of one image"));
}

#[test]
fn hostile_files_change_nothing_and_are_told_in_a_sentence() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().clone();
    let huge = files.0.path().join("huge.csv");
    std::fs::File::create(&huge).unwrap().set_len(400 << 20).unwrap();
    let binary = files.0.path().join("binary.txt");
    std::fs::write(&binary, [0xff, 0xfe, 0, 1, 2]).unwrap();
    for (path, words) in [
        (file(&files, "empty.txt", ""), "empty.txt could not be imported"),
        (file(&files, "words.txt", "not a matrix at all"), "words.txt could not be imported"),
        (file(&files, "rank.txt", "1 2 3\n2 4 6\n3 6 9"), "rank 1 or 0"),
        (file(&files, "cut.json", "{\"fundamental\": [[1, 2"), "cannot be imported either"),
        (file(&files, "other.json", "{\"a\": 1}"), "cannot be imported either"),
        (
            file(&files, "cut.yml", "%YAML:1.0\n---\nF: !!opencv-matrix\n   rows: 3\n"),
            "cut.yml could not be imported",
        ),
        (
            file(&files, "cut.xml", "<?xml version=\"1.0\"?>\n<opencv_storage><F>"),
            "cut.xml could not be imported",
        ),
        (file(&files, "nan.csv", "1,2,3,nan\n"), "not a finite number"),
        (file(&files, "far.csv", "1e300,2,3,4\n"), "none of its point pairs"),
        (file(&files, "one.P", "1 2 3 4"), "the camera of one image"),
        (huge, "larger than 64 MiB"),
        (binary, "not a text file"),
        (files.0.path().join("missing.csv"), "no such file"),
    ] {
        drop_files(&mut window, std::slice::from_ref(&path));
        assert!(told(&window, words), "{words}: {:?}", window.state().messages().collect::<Vec<_>>());
        assert_eq!(window.state().document(), &before, "{}", path.display());
        assert!(window.query_by_label("Convention of the matrix").is_none());
    }
}

#[test]
fn images_and_what_belongs_to_them_are_dropped_together() {
    let files = Files::new();
    let mut window = sample();
    let pairs = [PointPair::new(3.0, 4.0, 5.0, 6.0), PointPair::new(30.0, 40.0, 35.0, 46.0)];
    let (a, b) = (files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    drop_files(&mut window, &[a.clone(), file(&files, "m.txt", &csv(&pairs)), b.clone()]);
    let document = window.state().document();
    assert_eq!(document.pictures.clone().unwrap().map(|picture| picture.name), ["a.png", "b.png"]);
    assert_eq!(document.pairs, pairs);
    // The command line does the same.
    let imports = vec![files.0.path().join("m.txt")];
    let window = crate::support::window(
        Start { opening: Opening::Files(a, b), imports, ..Start::default() },
        services(),
    );
    assert_eq!(window.state().document().pairs, pairs);
    let start = Start {
        opening: Opening::Session(
            file(&files, "F.json", "{\"F\": [[1, 0, 0], [0, 1, 0], [0, 0, 0]]}").into(),
        ),
        ..Start::default()
    };
    let window = crate::support::window(start, services());
    assert!(told(&window, "open its two images first"));
}

#[test]
fn the_first_result_after_an_import_is_shown() {
    let files = Files::new();
    let mut window = window(Start::default(), services());
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&truth().fundamental))]);
    tap(&mut window, "Import matrix");
    assert!(window.state().model().shown().unwrap().contestant == Some(Contestant::Imported));
    click_two_pairs(&mut window);
    assert!(window.state().model().shown().unwrap().is_result());
}

#[test]
fn an_imported_geometry_takes_part_in_the_comparison_and_is_saved() {
    let files = Files::new();
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    press(&mut window, Key::Num4);
    assert!(window.query_by_label("Geometry: Imported").is_none(), "there is none");
    let true_f = truth().fundamental;
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&true_f))]);
    tap(&mut window, "Import matrix");
    assert_eq!(window.state().focus().contestant(), Some(Contestant::Imported));
    window.get_by_label_contains("The images show the imported geometry, not the result");
    press(&mut window, Key::R);
    assert_eq!(window.state().focus().contestant(), None);
    tap(&mut window, "Geometry: Imported");
    assert_eq!(window.state().focus().contestant(), Some(Contestant::Imported));

    let path = files.0.path().join("s.json");
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    type_into(&mut window, "File", &path);
    press(&mut window, Key::Enter);
    let again = crate::support::window(
        Start { opening: Opening::Session(path.into()), ..Start::default() },
        services(),
    );
    assert_eq!(again.state().document().imported, window.state().document().imported);
    assert!(again.state().document().imported.is_some());
}

#[test]
fn matches_of_another_program_are_searched_with_shown_and_kept() {
    let files = Files::new();
    let known = truth().matches;
    let row = |pair: &PointPair| {
        let PointPair { point1: p, point2: q } = pair;
        format!("{},{},{},{}\n", p.x, p.y, q.x, q.y)
    };
    // Too many to be clicked.
    let text: String = known.iter().cycle().take(400).map(row).collect();
    let path = file(&files, "m.csv", &text);
    let asked: Arc<Mutex<Vec<Option<usize>>>> = Arc::default();
    let note = Arc::clone(&asked);
    let clicks: Vec<PointPair> = known[..2].to_vec();
    let services = Services {
        estimate: Box::new(move |request, _| {
            note.lock().unwrap().push(request.given.as_ref().map(|given| given.len()));
            fake_estimate(&clicks, &request.parameters)
        }),
        ..services()
    };
    let mut window = window(Start::default(), services);
    drop_files(&mut window, &[path]);
    settle(&mut window);
    let given = |window: &Window| window.state().document().given.clone();
    let pairs = |window: &Window| given(window).map(|given| given.pairs().copied().collect::<Vec<_>>());
    let before = pairs(&window).unwrap();
    assert!(before.len() == 400 && window.state().document().pairs.is_empty());
    assert_eq!(asked.lock().unwrap().last(), Some(&Some(400)));
    assert!(
        window
            .state()
            .messages()
            .all(|text| text.starts_with("400 given matches from m.csv take part in the search"))
    );
    // The other way, and back.
    tap(&mut window, "Make point pairs");
    let editable = |window: &Window| (window.state().document().pairs.len(), given(window).is_none());
    assert_eq!(editable(&window), (400, true));
    window.get_by_label("400 point pairs from m.csv, each can be dragged.");
    tap(&mut window, "Make given matches");
    assert_eq!(editable(&window), (0, false));
    undo(&mut window);
    undo(&mut window);
    assert_eq!((editable(&window), pairs(&window).as_ref()), ((0, false), Some(&before)));
    press(&mut window, Key::Escape);
    tap(&mut window, "Details");
    window.get_by_label_contains("of 400 fit to 1 px");
    press(&mut window, Key::Num3);
    tap(&mut window, "Given");
    window.get_by_label("Given match 1");
    window.get_by_label_contains("distances of the given matches that fit");
    let comparison = window.state().model().open.comparison.as_ref().unwrap();
    assert_eq!((comparison.measured, comparison.points.len()), (PointSet::Given, 400));
    let session = files.0.path().join("s.json");
    save_as(&mut window, &session);
    let start = Start { opening: Opening::Session(session.into()), ..Start::default() };
    assert_eq!(pairs(&crate::support::window(start, self::services())), Some(before));
    run_command(&mut window, "Remove the given matches");
    assert_eq!((asked.lock().unwrap().last(), given(&window)), (Some(&None), None));
}

pub fn type_into(window: &mut Window, label: &str, path: &Path) {
    window.get_by_label(label).focus();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label(label).type_text(path.to_str().unwrap());
    settle(window);
}

/// Exports with these choices.
pub fn export(window: &mut Window, choices: &[&str], path: &Path) {
    press_with(window, Modifiers::COMMAND, Key::E);
    for choice in choices {
        tap(window, choice);
    }
    type_into(window, "File", path);
    tap(window, "Export file");
}

#[test]
fn exports_can_be_read_again() {
    let files = Files::new();
    let mut window = sample();
    press(&mut window, Key::S);
    let f = *window.state().estimate().unwrap().fundamental();
    let pairs = window.state().document().pairs.clone();

    let path = files.0.path().join("g.json");
    export(&mut window, &["Geometry"], &path);
    window.get_by_label_contains("Exported F and 2 point pairs to");
    let (read, format) = GeometryFile::read(&path).unwrap();
    assert_eq!((read.fundamental, &read.pairs, format), (Some(f), &pairs, Format::Json));
    assert!(read.images.is_some());

    let path = files.0.path().join("p.txt");
    export(&mut window, &["Pairs alone"], &path);
    assert_eq!(GeometryFile::read(&path).unwrap().0.pairs, pairs);

    let path = files.0.path().join("r.json");
    export(&mut window, &["Report", "JSON"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\"convention\"") && text.contains("\"parameters\""), "{text}");
    assert_eq!(GeometryFile::read(&path).unwrap().0.fundamental, Some(f));
    let path = files.0.path().join("r.txt");
    export(&mut window, &["Report", "Plain text"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("x2' F x1 = 0") && text.contains("Point pair p, true-match: ("), "{text}");

    let path = files.0.path().join("profile.csv");
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    press(&mut window, Key::Escape);
    press(&mut window, Key::Num2);
    export(&mut window, &["Profile"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("# The geometry is "), "{text}");
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(rows.next(), Some("distance,x1,y1,left,right_unmatched,shift,x2,y2,right_matched,cost"));
    assert!(rows.clone().count() > 100 && rows.all(|row| row.split(',').count() == 10));
}

#[test]
fn an_export_that_fails_says_so_and_one_that_replaces_as_well() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let place = |window: &Window| window.get_by_label("File").accesskit_node().value().unwrap_or_default();
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    let suggested = place(&window);
    press(&mut window, Key::Escape);
    let nowhere = files.0.path().join("no/such/folder/g.json");
    export(&mut window, &[], &nowhere);
    // The dialog stays, with the reason, to correct the path.
    window.get_by_label_contains("Nothing was exported: cannot write");
    assert!(window.get_by_label("File").is_focused() && place(&window) == nowhere.display().to_string());
    press(&mut window, Key::Escape);
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    assert!(window.query_by_label_contains("Nothing was exported").is_none());
    assert_eq!(place(&window), suggested, "a folder that is missing is not proposed");
    type_into(&mut window, "File", &file(&files, "there.json", "old"));
    window.get_by_label_contains("exists and will be replaced");
    tap(&mut window, "Browse for the export file");
    assert!(told(&window, "file dialog could not be opened here"));
}

#[test]
fn a_name_without_an_ending_gets_that_of_its_kind_and_a_file_is_no_folder() {
    let files = Files::new();
    let mut window = sample();
    press(&mut window, Key::S);
    export(&mut window, &["Report", "Plain text"], &files.0.path().join("report"));
    assert!(files.0.path().join("report.txt").is_file());
    export(&mut window, &["Geometry"], &files.0.path().join("g"));
    assert!(files.0.path().join("g.json").is_file());
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    tap(&mut window, "Rectified pair");
    let folder = files.0.path().join("g2.json");
    type_into(&mut window, "Folder", &folder);
    window.get_by_label_contains("this name ends like that of a file");
    press(&mut window, Key::Enter);
    assert!(!folder.exists());
    assert!(window.get_by_label("Export rectified pair").accesskit_node().is_disabled());
    // JSON under the name of another kind would be read as that.
    tap(&mut window, "Geometry");
    for (name, is_refused) in [("g.mat", true), ("g.csv", true), ("g.JSON", false), ("g.dat", false)] {
        type_into(&mut window, "File", &files.0.path().join(name));
        let told = window.query_by_label_contains("belongs to another kind of file").is_some();
        let stopped = window.get_by_label("Export file").accesskit_node().is_disabled();
        assert_eq!([told, stopped], [is_refused; 2], "{name}");
    }
    // The ending names the format.
    let yaml = files.0.path().join("g.yml");
    type_into(&mut window, "File", &yaml);
    tap(&mut window, "Export file");
    assert_eq!(GeometryFile::read(&yaml).unwrap().1, Format::OpencvYaml);
    for (kind, name, begin) in [
        ("Report", "r.json", "{"),
        ("Report", "r.txt", "Epipolar geometry"),
        ("Figure", "f.pdf", "%PDF"),
        ("Figure", "f.svg", "<svg"),
    ] {
        let path = files.0.path().join(name);
        export(&mut window, &[kind], &path);
        let content = std::fs::read(&path).unwrap();
        assert!(content.starts_with(begin.as_bytes()), "{name}: {:?}", &content[..20]);
    }
}

/// Returns the area of the export dialog's buttons, and the path that it names.
fn export_dialog(window: &Window) -> ([egui::Rect; 3], String) {
    let areas = ["Export file", "Table", "Figure"].map(|label| window.get_by_label(label).rect());
    let path = window.get_by_label("File").accesskit_node().value().unwrap_or_default();
    (areas, path)
}

#[test]
fn kinds_of_export_have_their_own_names_and_the_dialog_stands_still() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::Num2);
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    tap(&mut window, "Table");
    type_into(&mut window, "File", &files.0.path().join("fig.csv"));
    let (areas, typed) = export_dialog(&window);
    let mut names = vec![typed.clone()];
    for kind in ["Geometry", "NumPy array", "Pairs alone", "Report", "Figure", "Picture"] {
        tap(&mut window, kind);
        let (now, name) = export_dialog(&window);
        assert_eq!(now, areas, "{kind} moves what is under the cursor");
        // The name of the pictures, in the folder that was typed.
        let beginning = files.0.path().join("courtyard-1-courtyard-2");
        assert!(name.starts_with(beginning.to_str().unwrap()), "{kind}: {name}");
        assert!(!names.contains(&name), "{kind} replaces {name}");
        names.push(name);
    }
    tap(&mut window, "Table");
    assert_eq!(export_dialog(&window).1, typed);
}

#[test]
fn the_table_states_its_own_pixel_origin() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    tap(&mut window, "Geometry");
    window.get_by_role_and_label(egui::accesskit::Role::ComboBox, "Format").click();
    settle(&mut window);
    tap(&mut window, "MATLAB, Octave and VGG");
    assert!(window.query_by_label_contains("pixel is (1, 1)").is_some());
    tap(&mut window, "Table");
    assert!(window.query_by_label_contains("pixel is (0, 0)").is_some());
    assert!(window.query_by_label_contains("pixel is (1, 1)").is_none());
}

#[test]
fn f_is_exported_for_numpy() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let f = *window.state().estimate().unwrap().fundamental();
    let path = files.0.path().join("F.npy");
    export(&mut window, &["NumPy array"], &path);
    window.get_by_label_contains("Exported F as a NumPy array to");
    let written = std::fs::read(&path).unwrap();
    assert_eq!(written, epiline::io::fundamental_as_npy(&f, &PicturesOf::Original).unwrap());
    // It can be read again, like an array of point pairs.
    assert_eq!(epiline::io::read_fundamental(&path).unwrap(), f);
    drop_files(&mut window, &[path]);
    settle(&mut window);
    assert!(
        window.state().messages().next().is_none(),
        "{:?}",
        window.state().messages().collect::<Vec<_>>()
    );
}

#[test]
fn readings_that_fit_nothing_are_not_offered() {
    let files = Files::new();
    let mut window = sample();
    drop_files(&mut window, &[file(&files, "F.txt", &rows(&transposed(&truth().fundamental)))]);
    window.get_by_label("recommended");
    let shares: Vec<String> =
        window.query_all_by_label_contains(" %").filter_map(|label| label.accesskit_node().value()).collect();
    assert!(shares.iter().filter(|share| *share == "0 %").count() <= 1, "only that of the file: {shares:?}");
}

#[test]
fn the_view_is_what_is_on_the_screen() {
    let files = Files::new();
    let mut window = sample();
    let path = files.0.path().join("view.png");
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    tap(&mut window, "Picture");
    type_into(&mut window, "File", &path);
    window.get_by_label("Export file").click();
    let mut asked = None;
    for _ in 0..6 {
        window.step();
        let commands = window.output().viewport_output.values().flat_map(|viewport| &viewport.commands);
        for command in commands {
            if let ViewportCommand::Screenshot(callback) = command {
                asked = Some(callback.clone());
                assert!(window.query_by_label("Export file").is_none(), "the dialog is not in the picture");
            }
        }
        if asked.is_some() {
            break;
        }
    }
    let screen = ColorImage::filled([1280, 848], egui::Color32::from_rgb(1, 2, 3));
    asked.expect("a picture is asked for").complete(Arc::new(screen));
    settle(&mut window);
    window.get_by_label_contains("Exported the view to");
    let picture = image::open(&path).unwrap();
    let both = pane(&window, Side::Left).union(pane(&window, Side::Right));
    assert!((f32::from(picture.width() as u16) - both.width()).abs() < 30.0, "{}", picture.width());
    assert!(picture.height() < 700);
}

#[test]
fn many_messages_stack_compactly_and_escape_closes_the_top_one() {
    let files = Files::new();
    let mut window = sample();
    for number in 0..6 {
        let path = files.0.path().join(format!("nothing-{number}.txt"));
        std::fs::write(&path, "no numbers").unwrap();
        drop_files(&mut window, &[path]);
    }
    for _ in 0..40 {
        window.step();
    }
    let heights = |window: &Window| -> Vec<f32> {
        let mut tops: Vec<f32> =
            window.query_all_by_label("Dismiss").map(|button| button.rect().center().y).collect();
        tops.sort_by(f32::total_cmp);
        tops.windows(2).map(|two| two[1] - two[0]).collect()
    };
    assert_eq!(heights(&window).len(), 3, "four are shown");
    assert!(heights(&window).iter().all(|height| *height < 110.0), "{:?}", heights(&window));
    window.get_by_label("and 2 more below");
    window.get_by_label_contains("nothing-5.txt");
    press(&mut window, egui::Key::Escape);
    assert!(window.query_by_label_contains("nothing-5.txt").is_none());
    window.get_by_label("and 1 more below");
    assert_eq!(window.state().messages().count(), 5);
}

#[test]
fn nothing_measured_on_one_pair_shows_beside_another() {
    let files = Files::new();
    let mut window = sample();
    let path = file(&files, "F.txt", &rows(&truth().fundamental));
    drop_files(&mut window, std::slice::from_ref(&path));
    tap(&mut window, "Import matrix");
    window.get_by_label_contains("Imported a geometry from F.txt");
    window.get_by_label_contains("true matches");
    // Asked about once more, and not answered.
    drop_files(&mut window, std::slice::from_ref(&path));
    window.get_by_label("Convention of the matrix");
    drop_files(&mut window, &[files.image("a.png", 640, 480), files.image("b.png", 640, 480)]);
    assert!(window.query_by_label("Convention of the matrix").is_none());
    assert_eq!(imported(&window), None);
    for words in ["Imported a geometry", "true matches", "The images show the imported geometry"] {
        assert!(window.query_by_label_contains(words).is_none(), "{words}");
    }
    // Beside these pictures nothing is known that could tell what the matrix means.
    drop_files(&mut window, &[path]);
    window.get_by_label_contains("that takes 8 matches, and there are");
    tap(&mut window, "Import matrix");
    window.get_by_label("unchecked");
}
