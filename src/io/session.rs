//! Sessions: a person's work on an image pair, in one readable JSON file.
//!
//! This module defines the envelope: format, version, both images by relative path and SHA-256, and
//! F for other programs. The window defines the content `T`.
//!
//! Pitfall: a path is only a hint. The hash decides whether a file is the image of the session.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use super::geometry_file::TrustNote;
use super::hash::sha256_of_file;
use super::output::{OutputFile, WriteError, folder_of};
use super::picture_file::{PictureError, PictureFormat, encode_picture};
use super::read::{ReadError, limited, read_text};
use super::sequence_file::folder_sha256;
use crate::camera::PicturesOf;
use crate::foreign::shown_path;
use crate::geometry::{Frame, FundamentalMatrix};
use crate::image::Picture;

/// Version written by this program, and the newest it reads.
pub const SESSION_VERSION: u64 = 1;

/// Value of the field `format`.
const FORMAT: &str = "epiline-session";
/// Largest session file, bytes. Sessions have some kilobytes.
const LARGEST: u64 = 16 << 20;
/// Longest name of a file, bytes.
const LONGEST_NAME: usize = 1024;
/// Longest path of a file, bytes.
const LONGEST_PATH: usize = 8192;
/// Value of the field `convention`.
const CONVENTION: &str = "Pixels are (x, y), x right, y down, the centre of the top-left pixel is (0, 0). F is nested \
    rows: x2' F x1 = 0. Paths are relative to the folder of this file.";

/// Reason why a session cannot be read. The message is shown to the user.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is not a session.
    #[error("{0} is not a session of Epiline")]
    Foreign(String),
    /// The file is too large for a session.
    #[error("{path} is too large for a session of Epiline ({megabytes} MiB)")]
    TooLarge { path: String, megabytes: u64 },
    /// The file was saved by a newer version.
    #[error(
        "{path} was saved by a newer Epiline (version {version} of the format, this program knows {SESSION_VERSION}). \
         Update Epiline to open it"
    )]
    Newer { path: String, version: u64 },
    /// A part of the session is missing or invalid.
    #[error("{0} is damaged: {1}")]
    Damaged(String, String),
}

/// Origin of an image of a session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ImageSource {
    /// Image file: its path, relative to the folder of the session if possible, with `/` between folders,
    /// and the hexadecimal SHA-256 of its bytes.
    File { path: String, sha256: String },
    /// Picture of the built-in sample of this name.
    Sample { sample: String },
}

/// Image of a session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageReference {
    /// Origin of the image.
    #[serde(flatten)]
    pub source: ImageSource,
    /// Size of the image, px.
    #[serde(flatten)]
    pub frame: Frame,
}

/// Current location of an image file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Located {
    /// The file is the image of the session.
    Same(PathBuf),
    /// A file of that name has another content.
    Changed(PathBuf),
    /// There is no file at the path of the session.
    Missing(PathBuf),
}

/// Session with its content.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionFile<T> {
    /// References to both images.
    pub images: [ImageReference; 2],
    /// Result at the time of saving.
    pub fundamental: Option<FundamentalMatrix>,
    /// Pictures that the result belongs to; written only.
    pub pictures: PicturesOf,
    /// Verdict on the result; written only.
    pub trust: Option<TrustNote>,
    /// Content defined by the window.
    pub content: T,
}

/// Fields of the written file.
#[derive(Serialize)]
struct WrittenSession<'a, T> {
    format: &'static str,
    version: u64,
    program: &'static str,
    convention: &'static str,
    images: &'a [ImageReference; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    fundamental: Option<FundamentalMatrix>,
    #[serde(flatten)]
    pictures: &'a PicturesOf,
    #[serde(flatten)]
    trust: Option<&'a TrustNote>,
    content: &'a T,
}

/// Fields read from a file.
#[derive(Deserialize)]
struct ReadSession<T> {
    images: [ImageReference; 2],
    #[serde(default)]
    fundamental: Option<FundamentalMatrix>,
    content: T,
}

/// Reason why a session cannot be handed over, one sentence.
#[derive(Debug, Error)]
pub enum HandOverError {
    /// A file of a picture cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A picture without a file cannot be encoded.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl<T: Serialize> SessionFile<T> {
    /// Writes content about two pictures as a session into a folder, beside those of the pictures that are not files.
    /// Returns the path of the session.
    pub fn hand_over(pictures: [&Picture; 2], content: T, folder: &Path) -> Result<PathBuf, HandOverError> {
        let path = folder.join("session.json");
        let reference = |picture: &Picture, name: &str| -> Result<ImageReference, HandOverError> {
            let file = if let Some(file) = &picture.path {
                file.clone()
            } else {
                let file = folder.join(name);
                let png = encode_picture(&picture.pixels, PictureFormat::Png)?;
                OutputFile::prepare_private(&file)?.write(&png)?;
                file
            };
            let source = ImageSource::File { sha256: sha256_of(&file)?, path: relative(&file, &path) };
            Ok(ImageReference { source, frame: picture.frame() })
        };
        let images = [reference(pictures[0], "left.png")?, reference(pictures[1], "right.png")?];
        let session = Self { images, fundamental: None, pictures: PicturesOf::Untold, trust: None, content };
        session.write_private(&path)?;
        Ok(path)
    }

    /// Returns the content of the file.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let written = WrittenSession {
            format: FORMAT,
            version: SESSION_VERSION,
            program: env!("CARGO_PKG_VERSION"),
            convention: CONVENTION,
            images: &self.images,
            fundamental: self.fundamental,
            pictures: &self.pictures,
            trust: self.trust.as_ref(),
            content: &self.content,
        };
        serde_json::to_string_pretty(&written).map(|text| text + "\n")
    }

    /// Writes the session completely or not at all. A failure keeps the previous session.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let text = self.to_text().map_err(|e| WriteError::new(path, e.to_string()))?;
        OutputFile::prepare(path)?.write(text.as_bytes())
    }

    /// Writes the session like [`SessionFile::write`], readable only by its owner, for automatic
    /// copies.
    pub fn write_private(&self, path: &Path) -> Result<(), WriteError> {
        let text = self.to_text().map_err(|e| WriteError::new(path, e.to_string()))?;
        OutputFile::prepare_private(path)?.write(text.as_bytes())
    }
}

impl<T: DeserializeOwned> SessionFile<T> {
    /// Reads a session of this version or an older one.
    pub fn read(path: &Path) -> Result<Self, SessionError> {
        let shown = || shown_path(path);
        if let Ok(found) = path.metadata()
            && found.len() > LARGEST
        {
            return Err(SessionError::TooLarge { path: shown(), megabytes: found.len() >> 20 });
        }
        let text = read_text(path)?;
        let damaged = |e: serde_json::Error| SessionError::Damaged(shown(), limited(&e.to_string()));
        let value: Value = match serde_json::from_str(&text) {
            Ok(value) => value,
            Err(error) if text.contains(FORMAT) => return Err(damaged(error)),
            Err(_) => return Err(SessionError::Foreign(shown())),
        };
        if value.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(SessionError::Foreign(shown()));
        }
        match value.get("version").and_then(Value::as_u64) {
            Some(version) if version > SESSION_VERSION => {
                return Err(SessionError::Newer { path: shown(), version });
            }
            Some(1..) => {}
            _ => {
                let problem = "its version is not a number of at least 1".into();
                return Err(SessionError::Damaged(shown(), problem));
            }
        }
        let ReadSession { images, fundamental, content } = serde_json::from_value(value).map_err(damaged)?;
        if images.iter().any(|image| image.name().len() > LONGEST_NAME || image.place().len() > LONGEST_PATH)
        {
            let problem = "the path of an image is longer than any valid path".into();
            return Err(SessionError::Damaged(shown(), problem));
        }
        Ok(Self { images, fundamental, pictures: PicturesOf::Untold, trust: None, content })
    }
}

impl ImageReference {
    /// Returns the file name without folders, or the name of the sample.
    pub fn name(&self) -> &str {
        match &self.source {
            ImageSource::File { path, .. } => path.rsplit('/').next().unwrap_or(path),
            ImageSource::Sample { sample } => sample,
        }
    }

    /// Returns whether the picture belongs to a built-in sample.
    pub fn is_sample(&self) -> bool {
        matches!(self.source, ImageSource::Sample { .. })
    }

    /// Returns the path as written, or the name of the sample.
    fn place(&self) -> &str {
        match &self.source {
            ImageSource::File { path, .. } => path,
            ImageSource::Sample { sample } => sample,
        }
    }

    /// Locates the image file: at the path of the session, otherwise under the same name beside the
    /// session. Returns `None` for a sample.
    pub fn locate(&self, session: &Path) -> Option<Located> {
        let ImageSource::File { path, sha256 } = &self.source else { return None };
        let said = resolve(path, session);
        let beside = said.file_name().map(|name| folder_of(session).join(name));
        let mut changed = None;
        for candidate in [Some(said.clone()), beside].into_iter().flatten() {
            match sha256_of(&candidate) {
                Ok(found) if found.eq_ignore_ascii_case(sha256) => return Some(Located::Same(candidate)),
                Ok(_) => changed = changed.or(Some(candidate)),
                Err(_) => {}
            }
        }
        Some(changed.map_or(Located::Missing(said), Located::Changed))
    }
}

/// Returns the SHA-256 of a file's bytes, hexadecimal. For a folder of frames it covers names and
/// bytes.
pub fn sha256_of(path: &Path) -> Result<String, ReadError> {
    if path.is_dir() { folder_sha256(path) } else { sha256_of_file(path) }
}

/// Returns the path to write into a session: relative to the folder of the session if possible,
/// with `/` between folders.
pub fn relative(path: &Path, session: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = folder_of(session);
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let found = pathdiff::diff_paths(&whole, &folder).unwrap_or(whole);
    let parts: Vec<_> = found.components().map(|c| c.as_os_str().to_string_lossy()).collect();
    // The root of an absolute path is a separate component.
    parts.join("/").replacen("//", "/", usize::from(found.has_root()))
}

/// Resolves a path written by [`relative`].
pub fn resolve(written: &str, session: &Path) -> PathBuf {
    let joined = folder_of(session).join(written);
    // Removes `..` steps for readability.
    let mut plain = PathBuf::new();
    for part in joined.components() {
        match part {
            std::path::Component::ParentDir if plain.file_name().is_some() => {
                plain.pop();
            }
            std::path::Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(folder: &Path) -> SessionFile<Vec<f64>> {
        let image = |name: &str, bytes: &[u8]| {
            std::fs::write(folder.join(name), bytes).unwrap();
            ImageReference {
                source: ImageSource::File {
                    path: relative(&folder.join(name), &folder.join("s.json")),
                    sha256: sha256_of(&folder.join(name)).unwrap(),
                },
                frame: Frame::new(4, 3),
            }
        };
        SessionFile {
            images: [image("a.png", b"one"), image("b.png", b"two")],
            fundamental: FundamentalMatrix::from_rows([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
                .ok(),
            pictures: PicturesOf::Untold,
            trust: None,
            content: vec![0.1, 2.5e-300, 3.0],
        }
    }

    #[test]
    fn comes_back_as_it_was_and_moves_with_its_images() {
        let folder = tempfile::tempdir().unwrap();
        let session = example(folder.path());
        let path = folder.path().join("s.json");
        session.write(&path).unwrap();
        let back = SessionFile::<Vec<f64>>::read(&path).unwrap();
        assert_eq!((back.images, back.content), (session.images, session.content));
        let (f, was) = (back.fundamental.unwrap(), session.fundamental.unwrap());
        assert!((f.matrix() - was.matrix()).norm() < 1e-12);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("\"path\": \"a.png\"") && !text.contains(&*folder.path().to_string_lossy()));
        let elsewhere = tempfile::tempdir().unwrap();
        for name in ["a.png", "b.png", "s.json"] {
            std::fs::rename(folder.path().join(name), elsewhere.path().join(name)).unwrap();
        }
        let moved = elsewhere.path().join("s.json");
        let found = SessionFile::<Vec<f64>>::read(&moved).unwrap();
        let located = found.images.map(|i| i.locate(&moved).unwrap());
        assert_eq!(located, ["a.png", "b.png"].map(|n| Located::Same(elsewhere.path().join(n))));
    }

    #[test]
    fn missing_and_changed_images_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let session = example(folder.path());
        let path = folder.path().join("s.json");
        std::fs::remove_file(folder.path().join("a.png")).unwrap();
        std::fs::write(folder.path().join("b.png"), "other").unwrap();
        let located = session.images.clone().map(|i| i.locate(&path).unwrap());
        assert_eq!(located[0], Located::Missing(folder.path().join("a.png")));
        assert_eq!(located[1], Located::Changed(folder.path().join("b.png")));
        // An image beside the session is found even if its path is wrong.
        let below = folder.path().join("deep");
        std::fs::create_dir(&below).unwrap();
        let reference = ImageReference {
            source: ImageSource::File {
                path: "elsewhere/c.png".into(),
                sha256: "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae".into(),
            },
            frame: Frame::new(1, 1),
        };
        std::fs::write(below.join("c.png"), "foo").unwrap();
        assert_eq!(reference.locate(&below.join("s.json")), Some(Located::Same(below.join("c.png"))));
    }

    #[test]
    fn paths_are_written_relative_and_read_back() {
        let session = Path::new("/home/me/project/s.json");
        for (path, written) in [
            ("/home/me/project/a.png", "a.png"),
            ("/home/me/project/deep/a.png", "deep/a.png"),
            ("/home/me/photos/a.png", "../photos/a.png"),
            ("/data/a.png", "../../../data/a.png"),
        ] {
            assert_eq!(relative(Path::new(path), session), written);
            assert_eq!(resolve(written, session), Path::new(path));
        }
        assert_eq!(resolve("/abs/a.png", session), Path::new("/abs/a.png"));
    }

    #[test]
    fn what_is_no_session_is_refused_in_a_sentence() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.json");
        let good = example(folder.path()).to_text().unwrap();
        let newer = good.replace("\"version\": 1", "\"version\": 7");
        let cut = &good[..good.len() / 2];
        let no_content = good.replace("\"content\"", "\"contents\"");
        let deep = format!("{{\"format\": \"epiline-session\", \"x\": {}", "[".repeat(100_000));
        for (text, words) in [
            ("", "not a session of Epiline"),
            ("{}", "not a session of Epiline"),
            ("[1, 2]", "not a session of Epiline"),
            ("{\"fundamental\": [[1,0,0],[0,1,0],[0,0,0]]}", "not a session of Epiline"),
            (&newer, "was saved by a newer Epiline (version 7 of the format, this program knows 1)"),
            (cut, "is damaged: EOF"),
            (&no_content, "is damaged: missing field `content`"),
            (&good.replace("\"version\": 1", "\"version\": 0"), "is damaged: its version"),
            (&good.replace("\"width\": 4", "\"width\": -4"), "is damaged"),
            (&deep, "is damaged"),
            (
                &good.replace("\"path\": \"", &format!("\"path\": \"{}/", "x".repeat(10_000))),
                "longer than any valid path",
            ),
        ] {
            std::fs::write(&path, text).unwrap();
            let message = SessionFile::<Vec<f64>>::read(&path).unwrap_err().to_string();
            assert!(message.contains(words), "{words} in {message}");
        }
        let missing = SessionFile::<Vec<f64>>::read(&folder.path().join("none")).unwrap_err().to_string();
        assert!(missing.contains("no such file"), "{missing}");
    }
}
