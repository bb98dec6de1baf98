use super::*;
use image::{Delay, Frame as AnimationFrame, GrayImage, Luma, RgbaImage};

fn gray(k: u32) -> GrayImage {
    GrayImage::from_fn(40, 30, |x, y| Luma([if x / 4 == k { 200 } else { (x + y) as u8 }]))
}

fn read(path: &Path) -> Result<SequenceFile, SequenceError> {
    read_sequence(path, &CancelFlag::default(), &|_| ())
}

fn folder_of(numbers: &[u32]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for number in numbers {
        gray(number % 10).save(folder.path().join(format!("frame{number:04}.png"))).unwrap();
    }
    folder
}

#[test]
fn a_folder_of_frames_is_read_by_number_and_gaps_are_filled_and_told() {
    let folder = folder_of(&[8, 9, 10, 11, 12, 13, 14, 15, 16]);
    std::fs::write(folder.path().join("notes.txt"), "nothing").unwrap();
    let all = read(folder.path()).unwrap();
    assert_eq!((all.sequence.len(), all.notes.len()), (9, 0));
    assert_eq!(all.sequence.frame(2)[1], 200, "frame 10 shows number 0");
    std::fs::remove_file(folder.path().join("frame0011.png")).unwrap();
    let gap = read(folder.path()).unwrap();
    assert_eq!(gap.sequence.len(), 9, "the later ones keep their time");
    assert_eq!(gap.sequence.frame(3), gap.sequence.frame(2));
    assert!(gap.notes[0].contains(": 11; the frame before"), "{}", gap.notes[0]);
}

#[test]
fn what_is_no_sequence_is_a_sentence() {
    let told = |path: &Path| read(path).unwrap_err().to_string();
    let empty = tempfile::tempdir().unwrap();
    assert!(told(empty.path()).contains("no numbered pictures"));
    let few = folder_of(&[1]);
    assert!(told(few.path()).contains("single picture"));
    assert!(told(&few.path().join("frame0001.png")).contains("single picture"));
    assert!(told(&few.path().join("nothing.mp4")).contains("there is no such file"));
    let sizes = folder_of(&[1, 2, 3]);
    GrayImage::new(8, 8).save(sizes.path().join("frame0002.png")).unwrap();
    assert!(told(sizes.path()).contains("8×8 px, but the first one is 40×30 px"));
    let double = folder_of(&[1, 2]);
    gray(1).save(double.path().join("frame1.png")).unwrap();
    assert!(told(double.path()).contains("have the same number"));
    let far = folder_of(&[1, 2, 90_000]);
    assert!(told(far.path()).contains("missing"));
}

#[test]
fn animations_are_read_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("moving.gif");
    let mut encoder = image::codecs::gif::GifEncoder::new(std::fs::File::create(&path).unwrap());
    let frame = |k: u32| {
        let pixels: RgbaImage = image::DynamicImage::from(gray(k)).to_rgba8();
        AnimationFrame::from_parts(pixels, 0, 0, Delay::from_numer_denom_ms(40, 1))
    };
    encoder.encode_frames((0..9).map(frame)).unwrap();
    drop(encoder);
    let moving = read(&path).unwrap();
    assert_eq!(moving.sequence.len(), 9);
    assert!(moving.sequence.frame(5)[21] > 180 && moving.sequence.frame(5)[5] < 60);
    // A file cut off in the middle is read as far as possible, with a note.
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let cut = read(&path).unwrap();
    assert!(cut.sequence.len() > 2 && cut.sequence.len() < 9);
    assert_eq!(cut.notes.len(), 1, "{:?}", cut.notes);
}

#[test]
fn reading_stops_when_asked_to() {
    let folder = folder_of(&[1, 2, 3, 4, 5, 6, 7, 8]);
    let flag = CancelFlag::default();
    let stop_after_three = |count: usize| {
        if count == 3 {
            flag.cancel();
        }
    };
    let stopped = read_sequence(folder.path(), &flag, &stop_after_three);
    assert!(matches!(stopped, Err(SequenceError::Motion(MotionError::Cancelled))));
}
