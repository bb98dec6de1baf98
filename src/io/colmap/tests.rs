use nalgebra::{Matrix3, Matrix6, Rotation3, Vector3};
use rusqlite::Connection;

use super::super::geometry_file::{CalibratedNote, ImageNote};
use super::*;
use crate::camera::PicturesOf;
use crate::geometry::random_scene::{example_fundamental, example_seen};
use crate::geometry::{Frame, Point};

const FRAME: Frame = Frame { width: 768, height: 576 };

/// Returns a database with two images, `b/left.jpg` before `a/right.jpg` by number if not turned. The
/// left image has five keypoints, and the pair has one match.
fn database(folder: &Path, is_turned: bool) -> std::path::PathBuf {
    let path = folder.join("database.db");
    let connection = Connection::open(&path).unwrap();
    let [left, right] = if is_turned { [5, 2] } else { [2, 5] };
    connection
        .execute_batch(&format!(
            "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model INTEGER, width INTEGER, height INTEGER);
             CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT UNIQUE, camera_id INTEGER);
             CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);
             CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);
             CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB, \
             config INTEGER, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);
             INSERT INTO cameras VALUES (1, 2, 768, 576);
             INSERT INTO images VALUES ({left}, 'b/left.jpg', 1), ({right}, 'a/right.jpg', 1), (9, 'c/right.jpg', 1);"
        ))
        .unwrap();
    let keypoints: Vec<u8> = (0..20).flat_map(|k| (k as f32 * 3.0).to_le_bytes()).collect();
    connection.execute("INSERT INTO keypoints VALUES (?1, 5, 4, ?2)", (left, keypoints)).unwrap();
    let matches: Vec<u8> = [4u32, 7].iter().flat_map(|k| k.to_le_bytes()).collect();
    connection.execute("INSERT INTO matches VALUES (?1, 1, 2, ?2)", (pair(), matches)).unwrap();
    path
}

fn pair() -> i64 {
    2_147_483_647 * 2 + 5
}

fn example() -> GeometryFile {
    let at = |k: f64| example_seen((k * 0.7).sin(), (k * 1.3).cos(), 5.0 + (k * 0.31).sin());
    GeometryFile {
        fundamental: Some(example_fundamental()),
        pairs: vec![at(0.0), at(1.0), PointPair::new(100.0, 100.0, 100.0, 400.0)],
        found: (0..20).map(|k| at(f64::from(k))).collect(),
        images: Some(["left.jpg", "right.jpg"].map(|name| ImageNote::new(name.into(), FRAME))),
        ..GeometryFile::of(PicturesOf::Untold)
    }
}

/// Numbers of a column of a row.
fn numbers<T>(path: &Path, sql: &str, number: fn([u8; 4]) -> T) -> Vec<T> {
    let data: Vec<u8> = Connection::open(path).unwrap().query_row(sql, [], |row| row.get(0)).unwrap();
    data.as_chunks().0.iter().map(|bytes| number(*bytes)).collect()
}

fn matrix(path: &Path, column: &str) -> Matrix3<f64> {
    let sql = format!("SELECT {column} FROM two_view_geometries");
    let data: Vec<u8> = Connection::open(path).unwrap().query_row(&sql, [], |row| row.get(0)).unwrap();
    Matrix3::from_row_iterator(data.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)))
}

/// Whatever the order of the numbers of the images, the points that COLMAP reads fit the matrix that
/// it reads.
#[test]
fn a_pair_is_added_in_pixels_of_colmap_and_nothing_else_changes() {
    for is_turned in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let source = database(folder.path(), is_turned);
        let before = std::fs::read(&source).unwrap();
        let [copy, again] = ["new.db", "again.db"].map(|name| folder.path().join(name));
        let output = OutputFile::prepare(&copy).unwrap();
        let names = Some(["left.jpg", "a/right.jpg"]);
        let file = example();
        let added = file.add_to_colmap(names, &source, &output).unwrap();
        // Two clicks are matches, too, and the third is a mistake.
        assert_eq!((added.matches, added.verified, added.keypoints), (21, 20, [21, 21]));
        assert_eq!(std::fs::read(&source).unwrap(), before);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "one new file");
        let [left, right] = if is_turned { [5, 2] } else { [2, 5] };
        let keypoints = |image: i32| {
            numbers(
                &copy,
                &format!("SELECT data FROM keypoints WHERE image_id = {image}"),
                f32::from_le_bytes,
            )
        };
        let (first, second) = (keypoints(left), keypoints(right));
        assert_eq!(first[..20], (0..20).map(|k| k as f32 * 3.0).collect::<Vec<_>>()[..]);
        assert_eq!(
            first[20..24],
            [file.pairs[0].point1.x as f32 + 0.5, file.pairs[0].point1.y as f32 + 0.5, 1.0, 0.0]
        );
        let all = numbers(&copy, "SELECT data FROM matches", u32::from_le_bytes);
        assert_eq!((all.len(), &all[..2]), (44, &[4, 7][..]), "the old match comes first");
        let f = FundamentalMatrix::from_rank_two(matrix(&copy, "F")).unwrap();
        let verified = numbers(&copy, "SELECT data FROM two_view_geometries", u32::from_le_bytes);
        assert_eq!(verified.len(), 40);
        for numbers in verified.as_chunks::<2>().0 {
            let [i, j] = numbers.map(|number| number as usize);
            let [i, j] = if is_turned { [j, i] } else { [i, j] };
            let p = Point::new(f64::from(first[4 * i]), f64::from(first[4 * i + 1]));
            let q = Point::new(f64::from(second[2 * j]), f64::from(second[2 * j + 1]));
            let [point1, point2] = if is_turned { [q, p] } else { [p, q] };
            assert!(sampson_distance(&f, &PointPair { point1, point2 }) < 1e-3);
        }
        // The same pair finds its own keypoints.
        let output = OutputFile::prepare(&again).unwrap();
        let added = file.add_to_colmap(names, &copy, &output).unwrap();
        assert_eq!((added.matches, added.keypoints), (21, [0, 0]));
        assert_eq!(numbers(&again, "SELECT data FROM matches", u32::from_le_bytes), all);
        let list = OutputFile::prepare(&folder.path().join("list.txt")).unwrap();
        assert_eq!(file.write_colmap_matches(names, &again, &list).unwrap().matches, 21);
        let text = std::fs::read_to_string(list.path()).unwrap();
        assert!(text.starts_with("b/left.jpg a/right.jpg\n5 0\n6 1\n") && text.ends_with("\n\n"), "{text}");
        let refused = file.write_colmap_matches(names, &source, &list).unwrap_err().to_string();
        assert!(refused.contains("no match has a keypoint at both points"), "{refused}");
    }
}

#[test]
fn a_pose_is_written_as_a_quaternion_and_turned_with_the_images() {
    let rotation = Rotation3::from_euler_angles(0.1, -0.2, 0.3);
    let pose = RelativePose { rotation, translation: Vector3::new(0.6, 0.0, 0.8) };
    let covariance = Some(Matrix6::identity());
    let calibrated =
        CalibratedNote { pose: Some(pose), pose_covariance: covariance, ..CalibratedNote::default() };
    let file = GeometryFile { calibrated: Some(calibrated), ..example() };
    for is_turned in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let source = database(folder.path(), is_turned);
        let copy = folder.path().join("new.db");
        let output = OutputFile::prepare(&copy).unwrap();
        file.add_to_colmap(Some(["left.jpg", "a/right.jpg"]), &source, &output).unwrap();
        let essential = if is_turned { pose.essential().transpose() } else { pose.essential() };
        assert!((matrix(&copy, "E") - essential).norm() < 1e-12);
        let connection = Connection::open(&copy).unwrap();
        let row = "SELECT config, qvec, tvec FROM two_view_geometries";
        let (config, q, t): (i64, Vec<u8>, Vec<u8>) =
            connection.query_row(row, [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?))).unwrap();
        let real =
            |bytes: &[u8]| bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect::<Vec<_>>();
        let (q, t) = (real(&q), real(&t));
        let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
        let stored =
            RelativePose { rotation: q.to_rotation_matrix(), translation: Vector3::from_row_slice(&t) };
        assert!(config == 2 && (stored.essential() - essential).norm() < 1e-12);
    }
}

/// Old versions of COLMAP keep verified matches in `inlier_matches`, without matrices.
#[test]
fn an_old_database_keeps_its_table_of_verified_matches() {
    let folder = tempfile::tempdir().unwrap();
    let source = database(folder.path(), false);
    let file = example();
    // The first keypoint of the left image is on the scene, and so is a keypoint of the right one: their
    // verified match agrees with the geometry. The other verified match does not.
    let pair = file.found[7];
    let floats = |numbers: &[f64]| -> Vec<u8> {
        numbers.iter().flat_map(|v| (*v as f32 + 0.5).to_le_bytes()).collect()
    };
    let left = floats(&[pair.point1.x, pair.point1.y, 20.0, 20.0]);
    let right = floats(&[pair.point2.x, pair.point2.y, 500.0, 500.0]);
    let old: Vec<u8> = [0u32, 0, 1, 1].iter().flat_map(|k| k.to_le_bytes()).collect();
    let connection = Connection::open(&source).unwrap();
    connection
        .execute_batch(
            "DROP TABLE two_view_geometries;
             CREATE TABLE inlier_matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB, \
             config INTEGER);
             DELETE FROM keypoints;",
        )
        .unwrap();
    connection.execute("INSERT INTO keypoints VALUES (2, 2, 2, ?1)", [left]).unwrap();
    connection.execute("INSERT INTO keypoints VALUES (5, 2, 2, ?1)", [right]).unwrap();
    connection.execute("INSERT INTO inlier_matches VALUES (?1, 2, 2, ?2, 2)", (self::pair(), old)).unwrap();
    drop(connection);
    let copy = folder.path().join("new.db");
    let output = OutputFile::prepare(&copy).unwrap();
    // Without the match at the keypoints, so that only the old row has it.
    let without: Vec<PointPair> = file.found.iter().copied().filter(|other| *other != pair).collect();
    let file = GeometryFile { found: without, ..file };
    let added = file.add_to_colmap(Some(["left.jpg", "a/right.jpg"]), &source, &output).unwrap();
    assert_eq!(added.verified, 19);
    let verified = numbers(&copy, "SELECT data FROM inlier_matches", u32::from_le_bytes);
    assert_eq!(verified.len(), 2 * (19 + 1));
    assert_eq!(verified[2 * 19..], [0, 0], "the old match that agrees stays, and the other one goes");
    let connection = Connection::open(&copy).unwrap();
    let count = |sql: &str| connection.query_row(sql, [], |row| row.get::<_, i64>(0)).unwrap();
    assert_eq!(count("SELECT config FROM inlier_matches"), 3);
    let tables = "SELECT COUNT(*) FROM sqlite_master WHERE name = 'two_view_geometries'";
    assert_eq!(count(tables), 0, "no table is added");
}

#[test]
fn what_cannot_be_added_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let source = database(folder.path(), false);
    let path = |name: &str| folder.path().join(name);
    let output = OutputFile::prepare(&path("new.db")).unwrap();
    let refused = |file: &GeometryFile, names: Option<[&str; 2]>, source: &Path| {
        let message = file.add_to_colmap(names, source, &output).unwrap_err().to_string();
        assert!(!path("new.db").exists());
        message
    };
    let file = example();
    let names = Some(["left.jpg", "a/right.jpg"]);
    let ambiguous = refused(&file, None, &source);
    assert!(ambiguous.contains("right.jpg may be a/right.jpg or c/right.jpg"), "{ambiguous}");
    let missing = refused(&file, Some(["left.jpg", "ight.jpg"]), &source);
    assert!(missing.contains("there is no image ight.jpg in it"), "{missing}");
    assert!(
        refused(&file, Some(["left.jpg"; 2]), &source)
            .contains("both images of the result would be b/left.jpg")
    );
    let mut small = example();
    small.images.as_mut().unwrap()[0].frame = Frame::new(384, 288);
    let size = refused(&small, names, &source);
    assert!(
        size.contains("b/left.jpg has 768×576 px in the database and 384×288 px in the result"),
        "{size}"
    );
    assert!(
        refused(&GeometryFile { images: None, ..example() }, None, &source)
            .contains("does not name its images")
    );
    assert!(refused(&GeometryFile::of(PicturesOf::Untold), names, &source).contains("has no matches"));
    assert!(
        refused(&GeometryFile { fundamental: None, ..example() }, names, &source).contains("no fundamental")
    );
    let apart = GeometryFile { is_of_different_scenes: true, ..example() };
    assert!(refused(&apart, names, &source).contains("different scenes"));
    let bent = GeometryFile { pictures: PicturesOf::Undistorted(None), ..example() };
    assert!(refused(&bent, names, &source).contains("does not have its points in the pictures"));
    for (name, content) in [("empty.db", ""), ("text.db", "This is no database, but it is long enough.")] {
        std::fs::write(path(name), content).unwrap();
        assert!(refused(&file, names, &path(name)).contains("not an SQLite file"));
    }
    Connection::open(path("other.db")).unwrap().execute_batch("CREATE TABLE images (name TEXT)").unwrap();
    assert!(refused(&file, names, &path("other.db")).contains("this is not a database of COLMAP"));
    let whole = std::fs::read(&source).unwrap();
    std::fs::write(path("cut.db"), &whole[..whole.len() / 2]).unwrap();
    assert!(refused(&file, names, &path("cut.db")).contains("damaged"));
    std::fs::write(path("database.db-wal"), "log").unwrap();
    assert!(refused(&file, names, &source).contains("Close COLMAP"));
}
