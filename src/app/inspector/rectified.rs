//! What is done with the rectified pair: which one is made, how it is looked at, where it is written.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Inspector, PickPurpose};
use crate::app::computation::Freshness;
use crate::app::document::Side;
use crate::app::history::Step;
use crate::app::panels::tabs::TABS;
use crate::app::rectified::{Blink, Layout, Matches, Order, Question, RectifiedCommand};
use crate::io::RectifiedOptions;

impl Inspector {
    /// Does what a command says.
    pub(super) fn apply_to_rectified(&mut self, ctx: &egui::Context, command: RectifiedCommand) {
        match command {
            RectifiedCommand::SetMethod(method) => {
                self.edit(Step::Single, |document| document.rectification = method);
            }
            RectifiedCommand::LayOut(layout) => self.look.rectified.layout = layout,
            RectifiedCommand::SetGuides(guides) => self.look.rectified.guides = guides,
            RectifiedCommand::View(view) => self.viewing.view = view,
            RectifiedCommand::Swap => {
                if !self.wants_rectified() {
                    return;
                }
                let (shown, _) = self.viewing.blink.shown(ctx.input(|input| input.time));
                // From the other layouts the first press shows the left picture, the next one the right one.
                let blinks = self.look.rectified.layout == Layout::Blink;
                self.viewing.blink = Blink::Still(if blinks { shown.other() } else { Side::Left });
                self.look.rectified.layout = Layout::Blink;
            }
            RectifiedCommand::RunBlink => {
                let (shown, _) = self.viewing.blink.shown(ctx.input(|input| input.time));
                self.viewing.blink = match self.viewing.blink {
                    Blink::Running => Blink::Still(shown),
                    Blink::Still(_) => Blink::Running,
                };
            }
            RectifiedCommand::ShowExport => self.show_export(),
            RectifiedCommand::Browse => self.pick(PickPurpose::Export),
            RectifiedCommand::Export { folder, options } => self.export(folder, options),
            RectifiedCommand::StopExport => self.writing.stop(),
        }
    }

    /// Whether the rectified pair is looked at.
    pub(super) fn wants_rectified(&self) -> bool {
        self.scene().tab.is_some_and(|tab| TABS[tab].rectifies)
    }

    /// The pair to be rectified, once there is a geometry.
    pub(super) fn to_rectify(&self) -> Option<Question> {
        let scene = self.scene();
        let shown = scene.shown()?;
        let pictures = self.pictures.as_ref()?.each_ref().map(|opened| Arc::clone(&opened.picture));
        let matches = match (scene.truth().and(self.known.as_ref()), shown.estimate.matches()) {
            (Some(known), _) => Matches::True(Arc::clone(&known.truth)),
            (None, found) if !found.is_empty() => Matches::Found(found.iter().map(|m| m.pair).collect()),
            _ => Matches::Clicked(self.document.pairs.clone()),
        };
        Some(Question {
            pictures,
            fundamental: *shown.fundamental,
            matches,
            method: self.document.rectification,
            moving: shown.freshness == Freshness::Followed || self.hover.is_some_and(|hover| hover.dragging),
        })
    }

    /// Asks where to write, beside the left image unless something else was typed before.
    fn show_export(&mut self) {
        if self.scene().shown().is_none() {
            self.tell("There is nothing to rectify yet: click two point pairs first.".into());
            return;
        }
        let left = self.document.pictures.as_ref().and_then(|[left, _]| left.path.clone());
        let folder = left.and_then(|path| Some(path.parent()?.join("rectified")));
        self.export_dialog.show_with(folder);
    }

    fn export(&mut self, folder: PathBuf, options: RectifiedOptions) {
        let Some(question) = self.to_rectify() else {
            self.tell("There is nothing to rectify yet: click two point pairs first.".into());
            return;
        };
        if self.writing.begin(Order { question, folder, options }) {
            self.export_dialog.open = false;
        } else {
            self.tell("A rectified pair is being written already: wait for it, or stop it.".into());
        }
    }
}
