//! The shown geometry in a database of COLMAP.

use crate::exchange::type_into;
use crate::support::*;

use std::path::PathBuf;

use egui_kittest::kittest::Queryable;
use epiline::internals::app::{Services, Start};

/// Returns a database of COLMAP with the open pictures under these names.
fn colmap_database(files: &Files, window: &Window, names: [&str; 2]) -> PathBuf {
    let path = files.0.path().join("project.db");
    let connection = rusqlite::Connection::open(&path).unwrap();
    connection
        .execute_batch(
            "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model INTEGER, width INTEGER, height INTEGER);
             CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT UNIQUE, camera_id INTEGER);
             CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);
             CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);
             CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB, \
             config INTEGER, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);",
        )
        .unwrap();
    let frames = window.state().document().frames().unwrap();
    for (number, (name, frame)) in (1i64..).zip(names.into_iter().zip(frames)) {
        let size = (number, frame.width as i64, frame.height as i64);
        connection.execute("INSERT INTO cameras VALUES (?1, 2, ?2, ?3)", size).unwrap();
        connection.execute("INSERT INTO images VALUES (?1, ?2, ?1)", (number, name)).unwrap();
    }
    path
}

#[test]
fn the_shown_geometry_goes_into_a_copy_of_a_database_of_colmap() {
    let files = Files::new();
    let services = Services {
        estimate: Box::new(|request, _| matched_estimate(&request.pairs, &request.parameters)),
        ..services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    run_command(&mut window, "COLMAP");
    window.get_by_label("Choose the database that has both pictures.");
    type_into(&mut window, "Database", &files.text("text.db"));
    tap(&mut window, "Export file");
    window.get_by_label_contains("not an SQLite file");
    let others = colmap_database(&files, &window, ["one.jpg", "two.jpg"]);
    type_into(&mut window, "Database", &others);
    assert!(window.query_by_label_contains("not an SQLite file").is_none());
    tap(&mut window, "Export file");
    window.get_by_label_contains("Open the two pictures under the names that they have in the database");
    std::fs::remove_file(&others).unwrap();
    let pictures = window.state().document().pictures.clone().unwrap();
    let source = colmap_database(&files, &window, pictures.each_ref().map(|picture| picture.name.as_str()));
    let before = std::fs::read(&source).unwrap();
    tap(&mut window, "Export file");
    window.get_by_label_contains("Exported 5 matches of");
    assert_eq!(std::fs::read(&source).unwrap(), before);
    let copy = rusqlite::Connection::open(files.0.path().join("project-epiline.db")).unwrap();
    let number = |sql: &str| copy.query_row(sql, [], |row| row.get::<_, i64>(0)).unwrap();
    assert_eq!(number("SELECT rows FROM matches"), 5);
    assert_eq!(number("SELECT rows FROM keypoints WHERE image_id = 2"), 5);
    assert_eq!(number("SELECT config FROM two_view_geometries WHERE F NOTNULL AND H ISNULL"), 3);
}
