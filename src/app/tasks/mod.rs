//! Work outside the thread of the window. Each kind of work has its own thread.

mod estimating;
mod loader;
mod opening;
mod picking;
pub mod saver;
mod services;
mod session_opening;
mod task;
mod waker;
mod writing;

use std::path::Path;

pub use estimating::Estimating;
pub use loader::{Loader, Wanted};
pub use opening::{LoadedPair, Opening, OpeningFailure};
pub use picking::Picked;
pub use services::Services;
pub use task::panic_text;
pub use waker::Waker;
pub use writing::Writing;

use super::model::Model;
use super::model::command::PickPurpose;
use super::model::comparison::{Comparison, ComparisonQuestion};
use super::model::exchange::ImportQuestion;
use super::model::inspection::{Inspection, InspectionRequest};
use super::model::picture::Pictures;
use super::model::recording::{OffsetFound, Recordings};
use super::model::rectified::{Rectified, RectifyQuestion};
use super::model::scene::{Scene, SceneQuestion};
use super::model::suggesting::{
    LensQuestion, PairsQuestion, RepairQuestion, Repaired, SuggestQuestion, Suggested,
};
use crate::estimate::DivisionFit;
use crate::io::{Autosave, ImportedFile};
use crate::motion::{MOST_OFFSET, find_offset};
use crate::study::PlaceFound;
use crate::suggest::NextClick;
use saver::{SaveJob, Written};
use task::{Following, Task, Waiting};

pub struct Tasks {
    pub waker: Waker,
    pub estimating: Estimating,
    preparing: Following<Pictures, ()>,
    comparing: Following<ComparisonQuestion, Comparison>,
    inspecting: Following<InspectionRequest, Inspection>,
    suggesting: Following<SuggestQuestion, Suggested>,
    advising: Following<PairsQuestion, Option<NextClick>>,
    straightening: Following<LensQuestion, (LensQuestion, Option<DivisionFit>)>,
    checking: Following<PairsQuestion, (PairsQuestion, Vec<PlaceFound>)>,
    pub repairing: Task<RepairQuestion, Repaired>,
    pub aligning: Task<Recordings, OffsetFound>,
    rectifying: Following<RectifyQuestion, Rectified>,
    triangulating: Following<SceneQuestion, Option<Scene>>,
    pub loader: Loader,
    pub importing: Task<ImportQuestion, Result<ImportedFile, String>>,
    pub writing: Writing,
    pub saver: Task<SaveJob, Written>,
    /// Slot for copies of unsaved work, if available.
    pub autosave: Option<Autosave>,
    /// Reason why no slot is available, although one should be.
    pub no_autosave: Option<String>,
    pub picking: Task<PickPurpose, Picked>,
}

impl Tasks {
    pub fn new(services: Services) -> Self {
        let Services {
            mut prepare,
            estimate,
            follow,
            mut suggest,
            mut next_click,
            mut lens,
            mut places,
            mut repair,
            pick_file,
            pick_folder,
            pick_save,
            copies,
        } = services;
        let (autosave, no_autosave) = match copies.as_deref().map(|folder: &Path| Autosave::begin(folder)) {
            Some(Ok(autosave)) => (Some(autosave), None),
            Some(Err(problem)) => (None, Some(problem)),
            None => (None, None),
        };
        let waker = Waker::default();
        let preparing =
            Task::new("prepare", waker.clone(), Waiting::Newest, move |pictures: Pictures, turn| {
                turn.give_way();
                prepare(&pictures, &turn.cancel);
                None
            });
        let repairing =
            Task::new("repair", waker.clone(), Waiting::Newest, move |question: RepairQuestion, _| {
                let outcome = repair(&question);
                Some((question, outcome))
            });
        let aligning = Task::new("offset", waker.clone(), Waiting::Newest, |recordings: Recordings, turn| {
            let both = recordings.each_ref().map(|recording| &recording.silhouettes);
            let outcome = find_offset(both, MOST_OFFSET, &turn.cancel);
            (!turn.cancel.is_cancelled()).then_some((recordings, outcome))
        });
        let rectifying =
            Task::new("rectification", waker.clone(), Waiting::Newest, |question: RectifyQuestion, turn| {
                // A draft is always finished. A drag asks in every frame and would otherwise show
                // no draft.
                if !question.moving {
                    turn.give_way();
                }
                question.answer(&turn.cancel)
            });
        Self {
            estimating: Estimating::new(estimate, follow, &waker),
            preparing: Following { task: preparing, asked: None, keeps: false },
            comparing: Following::keeping("comparison", &waker, |question: ComparisonQuestion| {
                question.answer()
            }),
            inspecting: Following::keeping("inspection", &waker, |request: InspectionRequest| {
                request.inspect()
            }),
            suggesting: Following::strict("suggest", &waker, move |question| suggest(&question)),
            advising: Following::strict("next click", &waker, move |question| next_click(&question)),
            straightening: Following::strict("lens", &waker, move |question| {
                let found = lens(&question);
                (question, found)
            }),
            checking: Following::strict("places of pairs", &waker, move |question| {
                let found = places(&question);
                (question, found)
            }),
            repairing,
            aligning,
            rectifying: Following { task: rectifying, asked: None, keeps: true },
            triangulating: Following::strict("scene", &waker, SceneQuestion::answer),
            loader: Loader::new(waker.clone()),
            importing: Task::answering("import", waker.clone(), |question: ImportQuestion| {
                Some(question.answer())
            }),
            writing: Writing::new(waker.clone()),
            saver: saver::saver(waker.clone()),
            autosave,
            no_autosave,
            picking: picking::picking(waker.clone(), [pick_file, pick_folder], pick_save),
            waker,
        }
    }

    /// Stores new results in the model.
    pub fn take(&mut self, model: &mut Model) {
        let open = &mut model.open;
        self.estimating.take(&mut open.computation);
        self.inspecting.take(&mut open.inspection);
        self.comparing.take(&mut open.comparison);
        self.rectifying.take(&mut open.rectified);
        self.triangulating.take(&mut open.scene);
        self.suggesting.take(&mut open.suggestion);
        self.advising.take(&mut open.next_click);
        self.straightening.take(&mut open.lens);
        self.checking.take(&mut open.places);
        open.follow_result();
    }

    /// Sends the requests of the current state. `exports`: the inspected lines may be exported.
    pub fn follow(&mut self, model: &mut Model, exports: bool) {
        let pictures = model.pictures_to_prepare();
        self.preparing.follow(pictures, &mut None);
        let request = model.estimate_request();
        self.estimating.follow(&mut model.open.computation, request);
        let question = model.suggest_question();
        self.suggesting.follow(question, &mut model.open.suggestion);
        let question = model.next_click_question();
        self.advising.follow(question, &mut model.open.next_click);
        let question = model.lens_question();
        self.straightening.follow(question, &mut model.open.lens);
        let question = model.places_question();
        self.checking.follow(question, &mut model.open.places);
        // A moving replay asks in every frame. Each question is answered, so that there is always something to show.
        if !(model.open.replay.is_playing() || model.is_live()) || !self.inspecting.is_busy() {
            let request = model.inspection_request(exports);
            self.inspecting.follow(request, &mut model.open.inspection);
        }
        let question = model.comparison_question();
        self.comparing.follow(question, &mut model.open.comparison);
        let question = model.wants_rectified().then(|| model.rectify_question()).flatten();
        self.rectifying.follow(question, &mut model.open.rectified);
        let question = model.scene_question();
        self.triangulating.follow(question, &mut model.open.scene);
    }

    /// Cancels all work on the previous pictures.
    pub fn forget_pair(&mut self) {
        self.preparing.forget();
        self.estimating.forget();
        self.comparing.forget();
        self.inspecting.forget();
        self.suggesting.forget();
        self.advising.forget();
        self.straightening.forget();
        self.checking.forget();
        self.repairing.forget();
        self.aligning.forget();
        self.rectifying.forget();
        self.triangulating.forget();
        self.importing.forget();
    }

    pub fn is_rectifying(&self) -> bool {
        self.rectifying.is_busy()
    }

    /// Returns whether the window waits for anything besides the estimate.
    pub fn is_busy(&self) -> bool {
        self.loader.is_busy()
            || self.suggesting.is_busy()
            || self.advising.is_busy()
            || self.straightening.is_busy()
            || self.checking.is_busy()
            || self.repairing.is_busy()
            || self.aligning.is_busy()
            || self.inspecting.is_busy()
            || self.comparing.is_busy()
            || self.rectifying.is_busy()
            || self.triangulating.is_busy()
            || self.writing.is_busy()
            || self.picking.is_busy()
            || self.saver.is_busy()
            || self.importing.is_busy()
    }
}
