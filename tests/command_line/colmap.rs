//! Databases of COLMAP, with COLMAP itself.

use super::*;

const MODEL: &str = "data/projects/colmap-dslr";
/// COLMAP connects the first three pictures. The last one was taken 40° or more from them.
const NAMES: [&str; 4] = ["DSC_5285.jpg", "DSC_5286.jpg", "DSC_5287.jpg", "DSC_5303.jpg"];

/// Runs the script and returns its output.
fn colmap(python: &Path, arguments: &[&str]) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command_line/colmap.py");
    let output = Command::new(python).arg(script).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_picture_that_colmap_cannot_connect_is_registered_after_five_clicks() {
    let Some(data) = skipping::shared(MODEL) else { return };
    let Some(python) = skipping::python("pycolmap") else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let shared = |name: &str| data.join(name).to_str().unwrap().to_owned();
    let [model, pictures] = ["sparse/0", "images"].map(shared);
    let before = colmap(&python, &[&["match", &model, &pictures, &path("")], &NAMES[..]].concat());
    assert_eq!((&before["verified"], &before["registered"]), (&0.into(), &3.into()));
    let clicks: Vec<String> = before["clicks"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|row| ["--pair".to_owned(), row.to_string().trim_matches(['[', ']']).to_owned()])
        .collect();
    let [left, right] = [NAMES[0], NAMES[3]].map(path);
    let (result, source, copy) = (path("result.json"), path("database.db"), path("new.db"));
    let content = std::fs::read(&source).unwrap();
    for (calibrated, config) in [(false, 3), (true, 2)] {
        let mut arguments = vec!["estimate", &left, &right, "--json", &result];
        arguments.extend(clicks.iter().map(String::as_str));
        let cameras = path("cameras.txt");
        if calibrated {
            arguments.extend(["--calibration", &cameras]);
        }
        let output = run(&arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let output = run(&["convert", &result, "--database", &source, "--output", &copy]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(std::fs::read(&source).unwrap() == content, "the database itself stays");
        let after = colmap(&python, &[&["register", &model, &copy, &path("")], &NAMES[..]].concat());
        println!("{after}");
        assert_eq!((&after["registered"], &after["config"]), (&4.into(), &Value::from(config)));
        assert_eq!(after["pose"], calibrated);
        let number = |name: &str| after[name].as_f64().unwrap();
        assert!(number("verified") >= 100.0 && number("distance") < 0.5, "{after}");
        assert!(number("residual") < 0.5 && number("rotation_error") < 1.0, "{after}");
    }
    // The database of the project has larger pictures.
    let other = shared("database.db");
    fails(&["convert", &result, "--database", &other, "--output", &copy], 2, "3031×2006 px in the database");
}

#[test]
fn a_database_is_neither_replaced_nor_taken_for_something_else() {
    let pictures = Pictures::new();
    pictures.write("words.db", "This is no database, but it is long enough.");
    let result = serde_json::json!({
        "fundamental": [[0, 0, 0], [0, 0, -1], [0, 1, 0]], "pairs": [[1, 2, 3, 2]],
        "images": [{"name": "a", "width": 9, "height": 9}, {"name": "b", "width": 9, "height": 9}],
    });
    pictures.write("result.json", &result.to_string());
    let [result, database, new] = ["result.json", "words.db", "new.db"].map(|name| pictures.text(name));
    let convert = ["convert", &result, "--database", &database, "--output"];
    fails(&[&convert[..], &[&database]].concat(), 2, "it is one of the files that are read");
    fails(&[&convert[..], &[&new]].concat(), 2, "not an SQLite file");
    fails(&[&convert[..], &[&pictures.text("new.json")]].concat(), 2, "a copy of the database (.db)");
    assert!(!pictures.path("new.db").exists());
}
