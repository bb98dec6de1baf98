//! The one action that the sentence of the verdict asks for.

use super::{Tone, VerdictInWords, verdict};
use crate::app::model::Model;
use crate::app::model::command::{Command, ExchangeCommand};
use crate::app::model::computation::{EstimateFailure, Freshness};
use crate::app::model::document::{Role, pair_name};
use crate::app::model::exchange::ExportKind;
use crate::estimate::{Estimate, Reason, Suspect, Verdict};
use crate::presentation::PARTLY_RELIABLE;

/// Text of the button that undoes the distortion of the lens.
pub const USE_LENS: &str = "Correct the lens distortion";
/// What a reliable result says whose lines a lens bends.
pub const BENT: &str =
    "The lens bends the lines: they are right near the matches, and everywhere once it is corrected.";

#[derive(Debug, Clone, PartialEq)]
pub struct CardAction {
    pub label: String,
    pub command: Command,
    /// Whether it can help. A disabled button keeps its place, so that nothing jumps once a match is found.
    pub enabled: bool,
}

impl CardAction {
    fn new(label: impl Into<String>, command: Command) -> Self {
        Self { label: label.into(), command, enabled: true }
    }
}

impl Model {
    /// Returns the action that does what the verdict asks for.
    pub fn card_action(&self) -> Option<CardAction> {
        let computation = &self.open.computation;
        if computation.is_running() {
            return None;
        }
        let Some((estimate, Freshness::Final)) = computation.result() else {
            // From the same points, the estimator fails again.
            let has_panicked = matches!(computation.failure(), Some(EstimateFailure::Panic(_)));
            if has_panicked || computation.was_stopped() {
                return Some(CardAction::new("Compute again", Command::Recompute));
            }
            let find = || CardAction::new("Find without clicks", Command::FindWithoutClicks);
            return (self.result().is_none() && self.can_find_without_clicks()).then(find);
        };
        if self.tone() == Tone::Apart {
            return Some(CardAction::new("Choose other pictures…", Command::ShowOpenDialog));
        }
        let reasons = estimate.assessment.trust.iter().flat_map(|trust| &trust.reasons);
        let off = reasons.clone().filter_map(|reason| match *reason {
            // Where the geometry is the likelier culprit, the sentence asks for another pair.
            Reason::ClickOff { pair, suspect: Suspect::Click, distance } => {
                Some((self.document.used().nth(pair.checked_sub(1)?)?, distance))
            }
            _ => None,
        });
        let off = off.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(pair, _)| pair);
        let looks_for_matches = self.places_question().is_some();
        if let Some(pair) = off.or_else(|| self.slid_pair()).filter(|_| looks_for_matches) {
            let label = format!("Move {} to its match", pair_name(pair));
            let action = CardAction::new(label, Command::MoveToMatch(pair));
            return Some(CardAction { enabled: self.better_place(pair).is_some(), ..action });
        }
        let lens = self.offered_lens().map(|_| CardAction::new(USE_LENS, Command::UseLens));
        if reasons.clone().any(|reason| matches!(reason, Reason::Pattern { .. })) && lens.is_some() {
            return lens;
        }
        if estimate.assessment.plane.is_some() && self.tone() != Tone::Bad {
            let command = ExchangeCommand::ShowExport(Some(ExportKind::Plane)).into();
            return Some(CardAction::new("Export the homography…", command));
        }
        if matches!(self.open.next_click, Some(Some(_))) {
            return Some(CardAction::new("Add a pair at the mark", Command::PlaceAtMark));
        }
        self.lines_switch().or(lens)
    }

    /// Returns what the images tell besides the verdict: sentences, each after a space.
    pub fn card_remarks(&self) -> String {
        let slid = self.slid_pair().map(pair_name);
        let slid = slid.map(|name| format!(" The match of {name} probably lies elsewhere on its line."));
        let lens = self
            .offered_lens()
            .map(|_| " A lens bends these images; correct it for exact lines and epipoles.".to_owned());
        slid.into_iter().chain(lens).collect()
    }

    /// Returns the first used pair that is misplaced along its line.
    fn slid_pair(&self) -> Option<usize> {
        self.document.used().find(|pair| self.slid(*pair).is_some())
    }

    /// Returns another way out: for a misplaced pair whose match is not clear, and for pictures that seem to show
    /// different scenes.
    pub fn card_alternative(&self) -> Option<CardAction> {
        if self.tone() == Tone::Apart {
            return Some(CardAction::new("Click pairs anyway", Command::ClearPairs));
        }
        let Command::MoveToMatch(pair) = self.card_action()?.command else { return None };
        let label = format!("Leave out {}", pair_name(pair));
        Some(CardAction::new(label, Command::SetRole(pair, Role::Excluded)))
    }

    /// Returns the switch of the lines of an unreliable geometry.
    pub fn lines_switch(&self) -> Option<CardAction> {
        let is_bad = self.result().is_some() && self.tone() == Tone::Bad;
        let label = if self.open.lines_anyway { "Hide lines" } else { "Show lines anyway" };
        is_bad.then(|| CardAction::new(label, Command::ToggleUnreliableLines))
    }

    /// Returns whether the matches determine the lines near them, but no epipole.
    pub fn epipole_is_open(&self) -> bool {
        self.result().is_some_and(Estimate::says_one_plane)
    }

    /// Returns whether the state of the estimate is good or bad news.
    pub fn tone(&self) -> Tone {
        super::tone(&self.document, &self.open.computation)
    }

    /// Describes the state of the estimate. Beside a lens that explains more, lines are right near the matches alone.
    pub fn verdict_in_words(&self) -> VerdictInWords {
        let found = verdict(&self.document, &self.open.computation);
        let is_bent = found.word == "Reliable" && self.offered_lens().is_some();
        let (word, sentence) = (PARTLY_RELIABLE, BENT.to_owned());
        if is_bent { VerdictInWords { word, sentence, ..found } } else { found }
    }

    /// Returns the word for lines that must not be trusted as they are, for pictures that leave the window.
    pub fn doubt(&self) -> Option<(&'static str, LineLook)> {
        match self.line_look() {
            LineLook::Solid => None,
            // Only a running search draws lines without a geometry.
            LineLook::Other if self.shown().is_none() && !self.is_live() => None,
            look @ LineLook::Other if self.result().is_some() && self.shows_another() => {
                Some(("Not the result", look))
            }
            look @ LineLook::Other => Some(("Not checked", look)),
            look @ LineLook::Dashed => Some(("Doubtful", look)),
            look => Some(("Unreliable", look)),
        }
    }

    fn is_preliminary(&self) -> bool {
        matches!(self.open.computation.result(), Some((_, Freshness::Preliminary)))
    }

    /// Returns how epipolar lines are drawn.
    pub fn line_look(&self) -> LineLook {
        let is_other =
            self.shown().is_some_and(|shown| shown.hypothesis.is_some() || shown.contestant.is_some());
        match self.tone() {
            _ if is_other || self.is_preliminary() => LineLook::Other,
            // Only a checked result is green, and what was hidden stays so.
            Tone::Busy => match self.look_of(self.verdict_before()) {
                LineLook::Hidden => LineLook::Hidden,
                _ => LineLook::Other,
            },
            Tone::Caution => LineLook::Dashed,
            Tone::Bad => self.look_of(Some(Verdict::Unreliable)),
            Tone::Apart => LineLook::Hidden,
            Tone::Good => LineLook::Solid,
            // The search has found nothing yet.
            Tone::Idle => LineLook::Other,
        }
    }

    fn look_of(&self, verdict: Option<Verdict>) -> LineLook {
        match verdict {
            Some(Verdict::Doubtful) => LineLook::Dashed,
            Some(Verdict::Unreliable) if self.open.lines_anyway => LineLook::Dotted,
            Some(Verdict::Unreliable | Verdict::DifferentScenes) => LineLook::Hidden,
            Some(Verdict::Reliable) => LineLook::Solid,
            None => LineLook::Other,
        }
    }

    /// Returns the verdict on the geometry that follows the moved points, before they moved.
    fn verdict_before(&self) -> Option<Verdict> {
        let searched = self.open.computation.searched()?;
        searched.assessment.trust.as_ref().map(|trust| trust.verdict)
    }
}

/// Look of epipolar lines, which tells the verdict without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineLook {
    /// A reliable geometry.
    Solid,
    /// A geometry without a verdict: the first result of a search, or one that the user chose to see in
    /// place of the result.
    Other,
    /// A doubtful geometry.
    Dashed,
    /// An unreliable geometry that the user wants to see.
    Dotted,
    /// An unreliable geometry.
    Hidden,
}
