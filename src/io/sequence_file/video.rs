//! Videos, decoded by an installed `ffmpeg` into a stream of grey pictures. Network protocols are
//! disabled.

use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use image::codecs::pnm::PnmDecoder;
use image::{ColorType, ImageDecoder};

use super::{Gathered, SequenceError, SequenceFile};
use crate::cancel::CancelFlag;
use crate::foreign::{excerpt, shown_path};
use crate::geometry::Frame;
use crate::image::{GrayPlane, LoadOptions, Picture};

/// Maximum number of bytes kept of ffmpeg's error messages.
const MOST_WORDS: u64 = 4096;

/// Process that is killed when dropped.
struct RunningDecoder(Child);

impl Drop for RunningDecoder {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub(super) fn read(
    path: &Path,
    program: &str,
    cancel: &CancelFlag,
    each: &dyn Fn(usize),
) -> Result<SequenceFile, SequenceError> {
    let shown = shown_path(path);
    let failed = |reason: &str| SequenceError::Ffmpeg { path: shown.clone(), reason: excerpt(reason) };
    // An absolute path cannot be mistaken for an option or an address.
    let absolute = std::path::absolute(path).map_err(|e| failed(&crate::foreign::reason(&e)))?;
    let started = Command::new(program)
        .args(["-nostdin", "-v", "error", "-protocol_whitelist", "file,pipe", "-i"])
        .arg(&absolute)
        .args(["-map", "0:v:0", "-fps_mode", "passthrough", "-pix_fmt", "gray", "-c:v", "pgm"])
        .args(["-f", "image2pipe", "pipe:1"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut running = match started {
        Ok(child) => RunningDecoder(child),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(SequenceError::NoFfmpeg(shown));
        }
        Err(error) => return Err(failed(&crate::foreign::reason(&error))),
    };
    let complaints = running.0.stderr.take().map(|stderr| {
        std::thread::spawn(move || {
            let mut words = String::new();
            // Text only. The rest must be drained, or the process would block.
            let mut stderr = stderr;
            let _ = (&mut stderr).take(MOST_WORDS).read_to_string(&mut words);
            let _ = std::io::copy(&mut stderr, &mut std::io::sink());
            words
        })
    });
    let mut frames = BufReader::new(running.0.stdout.take().ok_or_else(|| failed("it has no output"))?);
    let mut gathered = Gathered::new(path, cancel, each);
    while let Some(gray) = next_frame(&mut frames, &shown)? {
        if gathered.first.is_none() {
            gathered.push_picture(Picture::from_pixels(String::new(), None, gray_picture(&gray))?)?;
        } else {
            gathered.push(&gray)?;
        }
    }
    drop(frames);
    let status = running.0.wait().map_err(|e| failed(&crate::foreign::reason(&e)))?;
    let words = complaints.and_then(|thread| thread.join().ok()).unwrap_or_default();
    let last = match words.lines().map(str::trim).rfind(|line| !line.is_empty()) {
        // Versions before 5.1 do not know this option.
        Some(_) if words.contains("fps_mode") => "it is too old. Install ffmpeg 5.1 or newer",
        last => last.unwrap_or("it gave no frames"),
    };
    if gathered.sequence.is_empty() {
        return Err(failed(last));
    }
    if !status.success() {
        let read = gathered.sequence.len();
        gathered.notes.push(format!("ffmpeg stopped in {shown} after {read} frames: {}", excerpt(last)));
    }
    gathered.finish()
}

/// Reads the next picture of the stream, a PGM; `None` at the end.
fn next_frame(stream: &mut BufReader<ChildStdout>, shown: &str) -> Result<Option<GrayPlane>, SequenceError> {
    let broken =
        || SequenceError::Ffmpeg { path: shown.to_owned(), reason: "its frames are not as expected".into() };
    if stream.fill_buf().map_err(|_| broken())?.is_empty() {
        return Ok(None);
    }
    let decoder = PnmDecoder::new(stream).map_err(|_| broken())?;
    let (width, height) = decoder.dimensions();
    if decoder.color_type() != ColorType::L8 {
        return Err(broken());
    }
    LoadOptions::from_environment()?.check(shown, width, height, 1)?;
    let frame = Frame::new(width as usize, height as usize);
    let mut bytes = vec![0u8; frame.width * frame.height];
    decoder.read_image(&mut bytes).map_err(|_| broken())?;
    Ok(Some(GrayPlane::new(frame, bytes.into_iter().map(f32::from).collect())))
}

fn gray_picture(plane: &GrayPlane) -> image::DynamicImage {
    let frame = plane.frame();
    let level = |x: u32, y: u32| image::Luma([plane.at(x as usize, y as usize) as u8]);
    image::GrayImage::from_fn(frame.width as u32, frame.height as u32, level).into()
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    /// Writes a script that replaces ffmpeg.
    fn program(folder: &Path, script: &str) -> String {
        let path = folder.join("ffmpeg");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        path.display().to_string()
    }

    fn read_with(script: &str) -> Result<SequenceFile, SequenceError> {
        let folder = tempfile::tempdir().unwrap();
        let program = program(folder.path(), script);
        super::read(&folder.path().join("film.mp4"), &program, &CancelFlag::default(), &|_| ())
    }

    const FRAME: &str = "printf 'P5\\n4 3\\n255\\n'; printf 'abcdefghijkl';";

    #[test]
    fn frames_come_one_after_the_other() {
        let read = read_with(&FRAME.repeat(5)).unwrap();
        assert_eq!((read.sequence.len(), read.sequence.full_size()), (5, Frame::new(4, 3)));
        assert_eq!(read.sequence.frame(4), b"abcdefghijkl");
        assert_eq!((read.first.name.as_str(), read.notes.len()), ("film.mp4", 0));
    }

    #[test]
    fn what_goes_wrong_is_told_in_its_words() {
        let told = |script: &str| read_with(script).unwrap_err().to_string();
        assert!(told("echo 'moov atom not found' >&2; exit 1").ends_with("as a video: moov atom not found"));
        assert!(told("printf 'P6 4 3 255 abc'").contains("not as expected"));
        assert!(told("printf 'P5 99999999 99999999 255 abc'").contains("pixels"), "no memory is asked for");
        assert!(told("echo \"Unrecognized option 'fps_mode'.\" >&2; exit 1").contains("Install ffmpeg 5.1"));
        assert!(told(FRAME).contains("single frame"));
        let cut = read_with(&format!("{FRAME}{FRAME} echo 'end of file' >&2; exit 1")).unwrap();
        assert_eq!(cut.notes.len(), 1);
        let missing = super::read(Path::new("film.mp4"), "no-such-program", &CancelFlag::default(), &|_| ());
        assert!(missing.unwrap_err().to_string().contains("Install ffmpeg, or give a folder of frames"));
    }
}
