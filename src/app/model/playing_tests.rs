use super::*;
use crate::app::model::picture::Opened;
use crate::app::model::recording::example;
use crate::app::model::shared::Shared;
use crate::geometry::AnchoredLine;
use crate::image::Picture;
use crate::motion::OffsetAgreement;

/// Returns a model with two open sequences of 40 and 37 frames.
fn model() -> Model {
    let opened = |frames: usize| {
        let recording = example(frames);
        let size = recording.sequence.size();
        let pixels = image::DynamicImage::new_luma8(size.width as u32, size.height as u32);
        Opened::recorded(Picture::from_pixels("frames".into(), None, pixels).unwrap(), recording)
    };
    let mut model = Model::default();
    model.open([opened(40), opened(37)], None, false, None);
    model
}

#[test]
fn the_offset_says_which_frames_belong_together() {
    let mut model = model();
    assert!(model.compares_barcodes(), "sequences are compared by barcodes");
    assert_eq!((model.playable(), model.shown_frames()), (Some(0..=36), Some([0, 0])));
    model.apply_to_player(PlayerCommand::Seek(30));
    model.apply_to_player(PlayerCommand::SetOffset(5));
    assert_eq!((model.playable(), model.shown_frames()), (Some(0..=31), Some([30, 35])));
    model.apply_to_player(PlayerCommand::Step(1));
    model.apply_to_player(PlayerCommand::Step(1));
    assert_eq!(model.shown_frames(), Some([31, 36]), "not beyond the last frame");
    model.apply_to_player(PlayerCommand::SetOffset(-6));
    model.apply_to_player(PlayerCommand::Seek(0));
    assert_eq!((model.playable(), model.shown_frames()), (Some(6..=39), Some([6, 0])));
    // However far the offset is dragged, enough frames stay.
    model.apply_to_player(PlayerCommand::SetOffset(1000));
    assert_eq!(model.synchronised().unwrap().offset, 21);
    assert_eq!(model.playable(), Some(0..=15));
    model.travel(true);
    assert_eq!(model.document.offset, 0, "all moves of a drag are one step");
}

#[test]
fn the_intensity_comes_from_the_shown_frame() {
    let mut model = model();
    let recording = model.recordings().unwrap()[0].clone();
    let size = recording.sequence.size();
    // A position with a ball in one frame and not in another.
    let moving = |k: &usize| recording.silhouettes.mask(3)[*k] && !recording.silhouettes.mask(30)[*k];
    let at = (0..size.width * size.height).find(moving).unwrap();
    let point = Point::new((at % size.width) as f64, (at / size.width) as f64);
    for frame in [3, 30] {
        model.apply_to_player(PlayerCommand::Seek(frame));
        let shown = model.intensity_at(Side::Left, point);
        assert_eq!(shown, Some(f32::from(recording.sequence.frame(frame)[at])), "frame {frame}");
        let [left, _] = model.frame_pictures().unwrap();
        assert_eq!(left.to_luma8().as_raw(), recording.sequence.frame(frame), "the picture for figures");
    }
}

#[test]
fn after_the_last_frame_the_first_one_is_played() {
    let mut model = model();
    assert!(!model.play_on(0.1), "nobody asked");
    model.apply_to_player(PlayerCommand::Seek(35));
    model.apply_to_player(PlayerCommand::TogglePlay);
    assert!(model.play_on(0.04));
    assert_eq!(model.shown_frames(), Some([36, 36]));
    assert!(model.play_on(0.04));
    assert_eq!(model.shown_frames(), Some([0, 0]));
    model.apply_to_player(PlayerCommand::TogglePlay);
    assert!(!model.play_on(0.04));
}

#[test]
fn barcodes_are_of_the_frames_in_common() {
    let mut model = model();
    let line = AnchoredLine::at_angle(crate::geometry::Point::new(80.0, 60.0), 0.3);
    let at = |model: &Model| model.synchronised().unwrap().barcodes(&[line, line]);
    let together = at(&model);
    assert_eq!((together.first, together.barcodes[0].len()), (0, 37));
    // The same line of the same frames.
    assert_eq!(together.barcodes[0], together.barcodes[1]);
    model.document.offset = -6;
    let shifted = at(&model);
    assert_eq!((shifted.first, shifted.barcodes[0].len()), (6, 34));
    assert!((0..34).all(|k| shifted.barcodes[1].is_set(k) == together.barcodes[1].is_set(k)));
    model.document.parameters.similarity.measure = LineMeasure::Stereo;
    assert!(model.compared_recordings().is_none() && model.synchronised().is_some());
}

/// Returns these agreements before those of unrelated recordings at other offsets.
fn agreeing(best: &[(i32, f64)]) -> Vec<OffsetAgreement> {
    let others = (20..60).map(|offset| (offset, 0.01 * f64::from(offset % 7 - 3)));
    best.iter()
        .copied()
        .chain(others)
        .map(|(offset, correlation)| OffsetAgreement { offset, correlation })
        .collect()
}

#[test]
fn an_offset_of_other_sequences_is_ignored() {
    let mut model = model();
    let others = [Shared::new(example(20)), Shared::new(example(20))];
    let outcome = |offset| Ok(agreeing(&[(offset, 0.8)]));
    model.take_offset((others, outcome(7)));
    assert_eq!(model.document.offset, 0);
    let own = model.recordings().unwrap();
    model.take_offset((own.clone(), outcome(7)));
    assert_eq!(model.document.offset, 7);
    assert!(model.open.done.text().is_some_and(|text| text.contains("+7 frames") && text.contains("0.80")));
    model.take_offset((own.clone(), Ok(Vec::new())));
    assert_eq!(model.document.offset, 7);
    assert_eq!(model.messages.list().len(), 1);
    // Two offsets agree as well.
    let unclear = Ok(agreeing(&[(3, 0.5), (-12, 0.4)]));
    model.take_offset((own, unclear));
    assert_eq!(model.document.offset, 7);
    assert_eq!(model.messages.list().last().unwrap().text, "No offset is clear. The present one is kept.");
}
