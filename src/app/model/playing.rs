//! Open sequences: playback, time offset, and the barcodes of the inspected lines.

use std::ops::RangeInclusive;

use image::imageops::FilterType;
use image::{DynamicImage, GrayImage};

use super::Model;
use super::document::Side;
use super::history::EditKey;
use super::recording::{InspectedBarcodes, OffsetFound, PlayerCommand, Recordings, Synchronised};
use crate::geometry::{Frame, Point, rescaled};
use crate::motion::{FEWEST_FRAMES, OffsetAgreement, clear_offset};
use crate::similarity::LineMeasure;

/// Playback speed, frames per second.
const RATE: f64 = 25.0;

impl Model {
    /// Returns the open sequences; `None` for pictures.
    pub fn recordings(&self) -> Option<Recordings> {
        let [left, right] = self.open.pictures.as_ref()?.each_ref().map(|opened| opened.recording.clone());
        Some([left?, right?])
    }

    pub fn has_sequences(&self) -> bool {
        self.recordings().is_some()
    }

    /// Returns the sequences with their time offset.
    pub fn synchronised(&self) -> Option<Synchronised> {
        let recordings = self.recordings()?;
        let [left, right] = recordings.each_ref().map(|recording| recording.sequence.len());
        let most = |count: usize| count.saturating_sub(FEWEST_FRAMES) as i32;
        let offset = self.document.offset.clamp(-most(left), most(right));
        Some(Synchronised { recordings, offset })
    }

    /// Returns the sequences if lines are compared by motion barcodes.
    pub fn compared_recordings(&self) -> Option<Synchronised> {
        let by_barcodes = self.document.parameters.similarity.measure == LineMeasure::Barcodes;
        self.synchronised().filter(|_| by_barcodes)
    }

    /// Returns whether lines are compared by motion barcodes.
    pub fn compares_barcodes(&self) -> bool {
        self.document.parameters.similarity.measure == LineMeasure::Barcodes && self.recordings().is_some()
    }

    /// Returns whether the player of the frames is in the place of the timeline.
    pub fn shows_player(&self) -> bool {
        self.has_sequences() && !self.open.player.gives_way
    }

    /// Returns the frames of the left sequence that have a partner in the right one.
    pub fn playable(&self) -> Option<RangeInclusive<usize>> {
        let ([first, _], count) = self.synchronised()?.in_common();
        Some(first..=first + count.max(1) - 1)
    }

    /// Returns the visible frames, left and right: those of the replay, if it runs through the frames.
    pub fn shown_frames(&self) -> Option<[usize; 2]> {
        let synchronised = self.synchronised()?;
        if let Some(frames) = self.open.replay.moment().and_then(|moment| moment.frames) {
            return Some(frames);
        }
        let playable = self.playable()?;
        let left = (self.open.player.position as usize).clamp(*playable.start(), *playable.end());
        let last = synchronised.recordings[1].sequence.len() - 1;
        let right = (left as i64 + i64::from(synchronised.offset)).clamp(0, last as i64) as usize;
        Some([left, right])
    }

    /// Returns the visible frames at the size of the recording.
    pub fn frame_pictures(&self) -> Option<[DynamicImage; 2]> {
        let (recordings, frames) = (self.recordings()?, self.shown_frames()?);
        let enlarged = |k: usize| {
            let sequence = &recordings[k].sequence;
            let (size, full) = (sequence.size(), sequence.full_size());
            let (width, height) = (size.width as u32, size.height as u32);
            let kept = GrayImage::from_raw(width, height, sequence.frame(frames[k]).to_vec())?;
            let (width, height) = (full.width as u32, full.height as u32);
            Some(DynamicImage::from(kept).resize_exact(width, height, FilterType::Triangle))
        };
        Some([enlarged(0)?, enlarged(1)?])
    }

    /// Returns the intensity at a position of an image, 0 to 255. For sequences, of the visible
    /// frame.
    pub fn intensity_at(&self, side: Side, point: Point) -> Option<f32> {
        let picture = &self.open.pictures.as_ref()?[side.index()];
        let nearest = |point: Point, size: Frame| {
            let pixel = |v: f64, size: usize| (v.round().max(0.0) as usize).min(size.saturating_sub(1));
            (pixel(point.x, size.width), pixel(point.y, size.height))
        };
        let (Some(frames), Some(recording)) = (self.shown_frames(), &picture.recording) else {
            let plane = &picture.picture.gray;
            let (x, y) = nearest(point, plane.frame());
            return Some(plane.at(x, y));
        };
        let sequence = &recording.sequence;
        let (size, full) = (sequence.size(), sequence.full_size());
        let scale = size.width as f64 / full.width as f64;
        let kept = rescaled(point, scale);
        let (x, y) = nearest(kept, size);
        Some(f32::from(sequence.frame(frames[side.index()])[y * size.width + x]))
    }

    /// Returns the barcodes of the inspected line pair.
    pub fn inspected_barcodes(&self) -> Option<InspectedBarcodes> {
        let compared = self.compared_recordings()?;
        Some(compared.barcodes(&self.inspected()?.lines))
    }

    /// Applies a command to the sequences. Searching for the offset is a task and is not done here.
    pub fn apply_to_player(&mut self, command: PlayerCommand) {
        let (Some(playable), Some([shown, _])) = (self.playable(), self.shown_frames()) else { return };
        // The replay and the player do not run at the same time.
        let to_search = command == PlayerCommand::Exchange && self.shows_player();
        let player = &mut self.open.player;
        if to_search {
            (player.gives_way, player.playing) = (true, false);
        } else if !matches!(command, PlayerCommand::ToggleSilhouettes | PlayerCommand::SetOffset(_)) {
            player.gives_way = false;
            self.open.replay.stop();
        }
        match command {
            PlayerCommand::TogglePlay => {
                player.playing = !player.playing;
                if player.playing && shown == *playable.end() {
                    player.position = *playable.start() as f64;
                }
            }
            PlayerCommand::Step(by) => {
                player.playing = false;
                player.position = (shown as f64 + f64::from(by)).clamp(0.0, *playable.end() as f64);
            }
            PlayerCommand::Seek(frame) => player.position = frame as f64,
            PlayerCommand::ToggleSilhouettes => player.silhouettes = !player.silhouettes,
            PlayerCommand::SetOffset(offset) => {
                self.edit_run(EditKey::Offset, |document| document.offset = offset);
            }
            PlayerCommand::FindOffset | PlayerCommand::Exchange => {}
        }
    }

    /// Advances the playback and returns whether it is running. The first frame follows the last.
    pub fn play_on(&mut self, seconds: f64) -> bool {
        let Some(playable) = self.playable().filter(|_| self.open.player.playing) else { return false };
        let (first, last) = (*playable.start() as f64, *playable.end() as f64);
        let position = self.open.player.position.max(first) + seconds.clamp(0.0, 1.0) * RATE;
        self.open.player.position = if position >= last + 1.0 { first } else { position };
        true
    }

    /// Sets the offset that was found if it is clear, and reports it.
    pub fn take_offset(&mut self, (recordings, outcome): OffsetFound) {
        if self.recordings() != Some(recordings) {
            return;
        }
        match outcome {
            Ok(found) => {
                if found.is_empty() {
                    self.messages.tell("The sequences are too short to find their offset. Set it yourself.");
                } else if let Some(&OffsetAgreement { offset, correlation }) = clear_offset(&found) {
                    self.open.done.tell(format!(
                        "Time offset {offset:+} frames. The best lines have a correlation of at least {correlation:.2}."
                    ));
                    self.edit(|document| document.offset = offset);
                } else {
                    self.messages.tell("No offset is clear. The present one is kept.");
                }
            }
            Err(error) => self.messages.tell(format!("The offset was not found: {error}.")),
        }
    }
}

#[cfg(test)]
#[path = "playing_tests.rs"]
mod tests;
