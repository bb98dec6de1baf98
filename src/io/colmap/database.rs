//! Tables of a database, through SQLite.
//!
//! The database comes from elsewhere, and SQLite is C code. SQLite works on a copy, runs no
//! triggers and no views of the file, and refuses changes of its schema.

use std::io::Read;
use std::path::{Path, PathBuf};

use rusqlite::config::DbConfig;
use rusqlite::types::Value;
use rusqlite::{Connection, OpenFlags, OptionalExtension, params_from_iter};

use super::super::output::{OutputFile, StagedFile};
use super::super::read::ReadError;
use super::error::{ColmapError, ImageProblem};
use super::keypoints::Keypoints;
use crate::foreign::{excerpt, open_input, reason};
use crate::geometry::Frame;

/// Start of every SQLite database.
const MARK: &[u8; 16] = b"SQLite format 3\0";
/// Bytes of the header that tell the kind of journal, and the value for none beside the database.
const JOURNAL: std::ops::Range<usize> = 18..20;
const NO_WRITE_AHEAD_LOG: u8 = 1;
/// Largest number of an image, plus one.
const MOST_IMAGES: i64 = 2_147_483_647;

/// A copy of a database, open for changes.
pub(super) struct Database {
    connection: Connection,
    file: StagedFile,
}

/// Image of a database.
#[derive(Debug, Clone)]
pub(super) struct Image {
    pub(super) id: i64,
    pub(super) name: String,
    pub(super) frame: Frame,
}

/// Row of `two_view_geometries` without its matches.
#[derive(Debug)]
pub(super) struct StoredGeometry {
    pub(super) config: i64,
    /// Names of columns, and their numbers row by row.
    pub(super) matrices: [(&'static str, Option<Vec<f64>>); 5],
}

/// Returns the number of a pair of images, `id1 < id2`.
pub(super) fn pair_id(id1: i64, id2: i64) -> i64 {
    MOST_IMAGES * id1 + id2
}

impl Database {
    /// Copies a database to a temporary file beside the output.
    pub(super) fn copied(path: &Path, output: &OutputFile) -> Result<Self, ColmapError> {
        let refused = |problem: &str| ReadError::content(path, problem);
        let mut input = open_input(path).map_err(|reason| ReadError::open(path, &reason))?.file;
        let mut header = [0; JOURNAL.end];
        if input.read_exact(&mut header).is_err() || !header.starts_with(MARK) {
            return Err(refused("this is not a database of COLMAP (not an SQLite file)").into());
        }
        for ending in ["-wal", "-journal"] {
            let mut beside = path.as_os_str().to_owned();
            beside.push(ending);
            if PathBuf::from(beside).metadata().is_ok_and(|found| found.len() > 0) {
                let problem = "a program still has the database open, or did not close it. Close COLMAP, or open the \
                               database with it once more";
                return Err(refused(problem).into());
            }
        }
        // Without its log the database is complete; the copy needs none.
        header[JOURNAL].fill(NO_WRITE_AHEAD_LOG);
        let file = output.stage_from(&mut header.chain(input))?;
        let connection = open(file.part.path()).map_err(|e| refused(&in_words(&e)))?;
        Ok(Self { connection, file })
    }

    /// Closes the database and returns its file.
    pub(super) fn finish(self) -> Result<StagedFile, String> {
        self.connection.close().map_err(|(_, e)| in_words(&e))?;
        self.file.part.sync().map_err(|e| reason(&e))?;
        Ok(self.file)
    }

    /// Returns the image of a name. Folders before the name may be missing.
    pub(super) fn image(&self, wanted: &str) -> Result<Image, ImageProblem> {
        let sql = "SELECT image_id, name, width, height FROM images JOIN cameras USING (camera_id)";
        let inside = format!("/{wanted}");
        let mut found: Vec<Image> = Vec::new();
        let all = self.connection.prepare(sql).and_then(|mut statement| {
            let mut rows = statement.query([])?;
            while let Some(row) = rows.next()? {
                let name: String = row.get(1)?;
                let is_same = name == wanted;
                if is_same || name.ends_with(&inside) {
                    let [width, height] = [row.get::<_, i64>(2)?, row.get(3)?];
                    let side = |length| usize::try_from(length).unwrap_or_default();
                    let image = Image { id: row.get(0)?, name, frame: Frame::new(side(width), side(height)) };
                    if is_same {
                        found = vec![image];
                        break;
                    }
                    found.push(image);
                }
            }
            Ok(())
        });
        all.map_err(|e| in_words(&e))?;
        match &found[..] {
            [image] if (0..MOST_IMAGES).contains(&image.id) => Ok(image.clone()),
            [image] => {
                Err(format!("the image {} has the impossible image_id {}", excerpt(wanted), image.id).into())
            }
            [] => Err(ImageProblem::Names(format!("there is no image {} in it", excerpt(wanted)))),
            [first, second, ..] => Err(ImageProblem::Names(format!(
                "{} may be {} or {}",
                excerpt(wanted),
                excerpt(&first.name),
                excerpt(&second.name)
            ))),
        }
    }

    pub(super) fn keypoints(&self, image: i64) -> Result<Keypoints, String> {
        let Some(blob) = self.blob("keypoints", "image_id", image)? else {
            return Ok(Keypoints::new(2, Vec::new()));
        };
        if !matches!(blob.columns, 2 | 4 | 6) {
            return Err(format!("keypoints with {} columns are not supported", blob.columns));
        }
        Ok(Keypoints::new(blob.columns, blob.numbers(f32::from_le_bytes)))
    }

    /// Returns the matches of a pair in a table.
    pub(super) fn matches(&self, table: &str, pair: i64) -> Result<Vec<[u32; 2]>, String> {
        let Some(blob) = self.blob(table, "pair_id", pair)? else { return Ok(Vec::new()) };
        if blob.columns != 2 && blob.rows != 0 {
            return Err(format!("the matches have {} columns, expected 2", blob.columns));
        }
        let numbers = blob.numbers(u32::from_le_bytes);
        Ok(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
    }

    pub(super) fn verified(&self, pair: i64) -> Result<Vec<[u32; 2]>, String> {
        self.matches(self.geometries()?.0, pair)
    }

    pub(super) fn write_keypoints(&self, image: i64, keypoints: &Keypoints) -> Result<(), String> {
        let data = bytes(&keypoints.values, f32::to_le_bytes);
        let rows = keypoints.values.len() / keypoints.columns;
        self.replace("keypoints", "image_id", image, [rows, keypoints.columns], data, Vec::new())
    }

    pub(super) fn write_matches(&self, pair: i64, matches: &[[u32; 2]]) -> Result<(), String> {
        let data = bytes(matches.as_flattened(), u32::to_le_bytes);
        self.replace("matches", "pair_id", pair, [matches.len(), 2], data, Vec::new())
    }

    /// Writes the geometry of a pair with its verified matches. Columns that the database lacks are
    /// left out.
    pub(super) fn write_geometry(
        &self,
        pair: i64,
        verified: &[[u32; 2]],
        geometry: &StoredGeometry,
    ) -> Result<(), String> {
        let (table, columns) = self.geometries()?;
        let mut more = vec![("config", Value::Integer(geometry.config))];
        for (name, numbers) in &geometry.matrices {
            if columns.iter().any(|column| column == name) {
                let numbers = numbers.as_deref().map(|numbers| bytes(numbers, f64::to_le_bytes));
                more.push((name, numbers.map_or(Value::Null, Value::Blob)));
            }
        }
        let data = bytes(verified.as_flattened(), u32::to_le_bytes);
        self.replace(table, "pair_id", pair, [verified.len(), 2], data, more)
    }

    /// Returns the table of two-view geometries and its columns. It had another name in old versions of COLMAP.
    fn geometries(&self) -> Result<(&'static str, Vec<String>), String> {
        for table in ["two_view_geometries", "inlier_matches"] {
            let columns = self.columns(table).map_err(|e| in_words(&e))?;
            if !columns.is_empty() {
                return Ok((table, columns));
            }
        }
        Err("this is not a database of COLMAP: it has no table two_view_geometries".into())
    }

    fn columns(&self, table: &str) -> rusqlite::Result<Vec<String>> {
        let mut statement = self.connection.prepare("SELECT name FROM pragma_table_info(?1)")?;
        statement.query_map([table], |row| row.get(0))?.collect()
    }

    fn blob(&self, table: &str, key: &str, number: i64) -> Result<Option<Blob>, String> {
        let sql = format!("SELECT rows, cols, data FROM {table} WHERE {key} = ?1");
        let row = self.connection.query_row(&sql, [number], |row| {
            Ok((row.get::<_, i64>(0)?, row.get::<_, i64>(1)?, row.get::<_, Option<Vec<u8>>>(2)?))
        });
        let Some((rows, columns, data)) = row.optional().map_err(|e| in_words(&e))? else { return Ok(None) };
        let data = data.unwrap_or_default();
        let damaged = || format!("the table {table} is damaged");
        let (Ok(rows), Ok(columns)) = (usize::try_from(rows), usize::try_from(columns)) else {
            return Err(damaged());
        };
        if rows.checked_mul(columns).and_then(|count| count.checked_mul(4)) != Some(data.len()) {
            return Err(damaged());
        }
        Ok(Some(Blob { rows, columns, data }))
    }

    fn replace(
        &self,
        table: &str,
        key: &str,
        number: i64,
        [rows, columns]: [usize; 2],
        data: Vec<u8>,
        more: Vec<(&str, Value)>,
    ) -> Result<(), String> {
        let mut cells = vec![
            (key, Value::Integer(number)),
            ("rows", Value::Integer(rows as i64)),
            ("cols", Value::Integer(columns as i64)),
            ("data", Value::Blob(data)),
        ];
        cells.extend(more);
        let (names, values): (Vec<&str>, Vec<Value>) = cells.into_iter().unzip();
        let places = vec!["?"; names.len()].join(", ");
        let sql = format!("INSERT OR REPLACE INTO {table} ({}) VALUES ({places})", names.join(", "));
        self.connection.execute(&sql, params_from_iter(values)).map(drop).map_err(|e| in_words(&e))
    }
}

/// Table of numbers of four bytes.
struct Blob {
    rows: usize,
    columns: usize,
    data: Vec<u8>,
}

impl Blob {
    fn numbers<T>(&self, number: fn([u8; 4]) -> T) -> Vec<T> {
        self.data.as_chunks().0.iter().map(|bytes| number(*bytes)).collect()
    }
}

fn bytes<T: Copy, const N: usize>(numbers: &[T], bytes: fn(T) -> [u8; N]) -> Vec<u8> {
    numbers.iter().flat_map(|number| bytes(*number)).collect()
}

/// Opens a database that no other program uses. Switches off all actions that a file could trigger
/// in SQLite.
fn open(path: &Path) -> rusqlite::Result<Connection> {
    let connection = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    for (config, value) in [
        (DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true),
        (DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false),
        (DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false),
        (DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false),
        // Replacing a row must not delete others.
        (DbConfig::SQLITE_DBCONFIG_ENABLE_FKEY, false),
    ] {
        connection.set_db_config(config, value)?;
    }
    // A failure removes the copy, so the journal may be lost. No file appears beside the copy.
    connection.execute_batch(
        "PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF; PRAGMA cell_size_check = ON",
    )?;
    Ok(connection)
}

fn in_words(error: &rusqlite::Error) -> String {
    format!("this is not a database of COLMAP, or it is damaged ({})", excerpt(&error.to_string()))
}
