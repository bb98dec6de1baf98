use super::*;
use image::{GrayImage, Luma};

fn gray(k: u32) -> GrayImage {
    GrayImage::from_fn(40, 30, |x, y| Luma([if x / 4 == k { 200 } else { (x + y) as u8 }]))
}

fn read(path: &Path) -> Result<SequenceFile, SequenceError> {
    read_sequence(path, &CancelFlag::default(), &|_| ())
}

fn folder_of(numbers: &[u64]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for number in numbers {
        gray((number % 10) as u32).save(folder.path().join(format!("frame{number:04}.png"))).unwrap();
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
    assert!(gap.notes[0].contains(": 11. The frame before"), "{}", gap.notes[0]);
}

#[test]
fn the_largest_numbers_of_frames_end_a_sequence() {
    // The number expected after the gap would be larger than any number.
    let last = u64::MAX;
    let folder = folder_of(&[last - 20, last - 16, last - 12, last - 8, last - 2, last]);
    let found = read(folder.path()).unwrap();
    assert_eq!((found.sequence.len(), found.notes.len()), (11, 1), "in steps of two");
    let odd = folder_of(&[last - 30, last - 26, last - 22, last - 18, last - 14, last - 10, last - 6, last]);
    assert_eq!(read(odd.path()).unwrap().sequence.len(), 9, "in steps of four, with one missing frame");
}

#[test]
fn what_is_no_sequence_is_a_sentence() {
    let told = |path: &Path| read(path).unwrap_err().to_string();
    let empty = tempfile::tempdir().unwrap();
    assert!(told(empty.path()).contains("no numbered pictures"));
    let few = folder_of(&[1]);
    assert!(told(few.path()).contains("single frame"));
    for name in ["frame0001.png", "moving.gif", "moving.WEBP"] {
        let told = told(&few.path().join(name));
        assert!(told.contains("animated or not. Give a video, or a folder"), "{told}");
    }
    assert!(told(&few.path().join("nothing.mp4")).contains("there is no such file"));
    let sizes = folder_of(&[1, 2, 3]);
    GrayImage::new(8, 8).save(sizes.path().join("frame0002.png")).unwrap();
    assert!(told(sizes.path()).contains("8×8 px, but the first frame is 40×30 px"));
    let double = folder_of(&[1, 2]);
    gray(1).save(double.path().join("frame1.png")).unwrap();
    assert!(told(double.path()).contains("have the same number"));
    let far = folder_of(&[1, 2, 90_000]);
    assert!(told(far.path()).contains("missing"));
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
