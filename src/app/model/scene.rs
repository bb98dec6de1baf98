//! The matches of a result as scene points.

use super::shared::Shared;
use crate::camera::{CloudPoint, PointCloud, PoseFit, ViewPair};
use crate::estimate::Estimate;
use crate::image::Picture;
use crate::study::PoseOutcome;

/// Inputs of a scene: one result and the views that it belongs to.
#[derive(Clone, PartialEq)]
pub struct SceneQuestion {
    pub left: Shared<Picture>,
    pub found: Shared<Estimate>,
    pub views: ViewPair,
}

/// Relative pose and scene points of one result.
pub struct Scene {
    question: SceneQuestion,
    /// Pose of camera 2, fitted to the matches.
    pub fit: PoseFit,
    pub cloud: PointCloud,
}

impl SceneQuestion {
    /// Fits the pose and triangulates the matches. `None` if they do not determine a pose.
    pub fn answer(self) -> Option<Scene> {
        let fit = PoseOutcome::new(&self.found, &self.views).determined()?.clone();
        let matches = self.found.matched_pairs();
        let cloud = PointCloud::new(&fit.pose, &self.views, &matches, |point| self.left.color_at(point));
        Some(Scene { question: self, fit, cloud })
    }
}

impl Scene {
    /// Returns whether the scene is that of these inputs.
    pub fn is_of(&self, question: &SceneQuestion) -> bool {
        self.question == *question
    }

    pub fn views(&self) -> &ViewPair {
        &self.question.views
    }

    /// Returns the relative standard deviation of the focal lengths, 0 for a calibration.
    pub fn focal_deviation(&self) -> f64 {
        self.question.views.focal_deviation()
    }

    pub fn point(&self, number: usize) -> Option<&CloudPoint> {
        let place = self.cloud.points.binary_search_by_key(&number, |point| point.number).ok()?;
        self.cloud.points.get(place)
    }
}
