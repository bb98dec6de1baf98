//! Tests of the rules that hold for every program.

use std::sync::Arc;

use super::*;
use crate::camera::{CameraModel, FocalLength, Lens, Radial, RelativePose, ViewPair, calibration};
use crate::estimate::{
    Assessment, Estimate, Match, MatchFitError, Monitor, Parameters, Reason, RefinedMatch, Refinement, Trust,
    Verdict,
};
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::synthetic::{Motion, TestPair, test_pair};

const FRAME: Frame = Frame { width: 320, height: 240 };

/// Returns a pair with its exact cameras.
fn scene() -> (TestPair, [CameraModel; 2]) {
    let cameras = Motion::Sideways.cameras(FRAME).unwrap();
    let model = |k: usize| CameraModel::new(&cameras[k].calibration().unwrap(), Lens::IDEAL).unwrap();
    (test_pair(FRAME, Motion::Sideways, 3).unwrap(), [model(0), model(1)])
}

/// Returns the cameras with focal lengths of this relative deviation.
fn guessed(cameras: &[CameraModel; 2], deviation: f64) -> [CameraModel; 2] {
    cameras.each_ref().map(|camera| {
        let pixels = camera.calibration()[(0, 0)];
        camera.with_focal_length(FocalLength { pixels, deviation }).unwrap()
    })
}

fn views(cameras: &[CameraModel; 2]) -> ViewPair {
    plan_views(cameras.each_ref(), [FRAME; 2]).unwrap()
}

/// Returns the views of a lens that has no inverse 160 px from the middle.
fn bent() -> ViewPair {
    let lens = Lens::perspective(Radial::polynomial(&[-0.9]));
    let camera = CameraModel::new(&calibration([200.0; 2], [159.5, 119.5]), lens).unwrap();
    views(&[camera; 2])
}

fn is_posed(found: &Estimate) -> bool {
    found.assessment.refinement.as_ref().unwrap().is_posed
}

#[test]
fn known_cameras_take_part_in_a_search_and_guessed_ones_do_not() {
    let (pair, cameras) = scene();
    let study = Study::of_pictures(pair.pictures.clone());
    let parameters = Parameters::default();
    let question = Question { clicks: &pair.matches[..2], given: None, parameters: &parameters };
    let solve =
        |views: Option<ViewPair>| study.clone().drawn_in(views).solve(&question, &Monitor::silent()).unwrap();
    let (known, free) = (views(&cameras), solve(None));
    assert!(Study::searches_with(&known) && is_posed(&solve(Some(known))));
    let guessed = views(&guessed(&cameras, 0.1));
    assert!(!Study::searches_with(&guessed) && !is_posed(&free));
    // A guess changes no bit of the geometry.
    assert_eq!(solve(Some(guessed)).fundamental(), free.fundamental());
    let pinhole = study.clone().with_views(known);
    assert!(std::ptr::eq(pinhole.pictures()[0], study.pictures()[0]), "nothing to draw");
    assert_eq!(pinhole.views(), Some(&known));
}

#[test]
fn given_matches_are_fitted_once_and_leave_the_pictures_alone() {
    let (pair, _) = scene();
    let study = Study::of_pictures(pair.pictures.clone());
    let parameters = Parameters::default();
    let given: Vec<Match> = pair.matches.iter().copied().map(Match::from).collect();
    let asked = |given| Question { clicks: &pair.matches[..2], given, parameters: &parameters };
    let solve = |study: &Study, given| *study.solve(&asked(given), &Monitor::silent()).unwrap().fundamental();
    let (without, with) = (solve(&study, None), solve(&study, Some(&given[..])));
    assert_eq!(study.check_given(&asked(Some(&given))), Ok(()));
    assert_eq!(study.check_given(&asked(Some(&given[..5]))), Err(MatchFitError::TooFew(5)));
    assert_eq!((solve(&study, Some(&given)), solve(&study, None)), (with, without));
    let fresh = Study::of_pictures(pair.pictures.clone());
    assert_eq!(solve(&fresh, Some(&given)), with);
}

#[test]
fn clicks_beyond_a_lens_are_refused_and_matches_left_out() {
    let views = bent();
    let (inside, beyond) =
        (PointPair::new(150.0, 110.0, 140.0, 120.0), PointPair::new(1.0, 1.0, 150.0, 110.0));
    assert_eq!(clicks_in(&views, &[inside, beyond]), Err(StudyError::ClickBeyondLens(2)));
    let placed = views.undistorted_from_original(&inside).unwrap();
    assert_eq!(clicks_in(&views, &[inside]), Ok(vec![placed]));
    let given = |pairs: &[PointPair]| pairs.iter().copied().map(Match::from).collect::<Vec<_>>();
    let moved = matches_in(&views, &given(&[beyond, inside])).unwrap();
    assert_eq!(moved, given(&[placed]));
    assert_eq!(matches_in(&views, &given(&[beyond])), Err(StudyError::MatchesBeyondLens));
}

#[test]
fn pictures_of_a_lens_are_drawn_in_their_views() {
    let (pair, _) = scene();
    let views = bent();
    let study = Study::of_pictures(pair.pictures.map(Arc::new)).with_views(views);
    assert_eq!(study.frames(), views.frames());
    assert_ne!(study.frames(), [FRAME; 2]);
    let tiny = plan_views([views.views[0].camera(); 2], [Frame::new(1, 1); 2]);
    assert_eq!(tiny.unwrap_err(), StudyError::FoldsBack);
}

/// Returns an estimate that found the exact matches, with a doubt.
fn doubted(fundamental: FundamentalMatrix, matches: &[PointPair], reasons: Vec<Reason>) -> Estimate {
    let matches = matches.iter().map(|pair| RefinedMatch { pair: *pair, correlation: 1.0 }).collect();
    let refinement = Some(Refinement { matches, uncertainty: None, noise: None, is_posed: false });
    let trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
    let assessment = Assessment { refinement, trust, ..Assessment::default() };
    Estimate { assessment, ..Estimate::from(fundamental) }
}

#[test]
fn a_pose_without_a_determined_epipole_has_no_uncertainty() {
    let (TestPair { fundamental, matches, .. }, cameras) = scene();
    let views = views(&cameras);
    let found = |matches: &[PointPair], reasons| doubted(fundamental, matches, reasons);
    let clear = PoseOutcome::new(&found(&matches, Vec::new()), &views);
    assert!(clear.determined().unwrap().uncertainty.is_some());
    let plane = Reason::NoRelief { along: 3, across: 4, on_warp: 400 };
    let open = PoseOutcome::new(&found(&matches, vec![plane]), &views);
    assert!(open.determined().is_none() && open.fit().unwrap().uncertainty.is_none());
    let turned = Reason::OnlyTurned { along: 3, across: 4, turned: 400 };
    let behind = Reason::BehindCameras { in_front: 160, matches: 300 };
    let doubtful = PoseOutcome::new(&found(&matches, vec![turned.clone(), behind]), &views);
    assert!(matches!(doubtful, PoseOutcome::OpenEpipole(_)));
    let turned = PoseOutcome::new(&found(&matches, vec![turned]), &views);
    assert!(matches!(turned, PoseOutcome::OnlyTurned(_)) && turned.determined().is_none());
    let few = PoseOutcome::new(&found(&matches[..5], Vec::new()), &views);
    assert!(matches!(few, PoseOutcome::TooFewMatches) && few.fit().is_none());
    let lens = cameras.map(|_| CameraModel::of_division(-0.1, FRAME).unwrap());
    let unknown = PoseOutcome::new(&found(&matches, Vec::new()), &self::views(&lens));
    assert!(matches!(unknown, PoseOutcome::NoFocalLengths));
}

#[test]
fn a_stereo_pair_takes_the_pose_of_f_and_the_baseline_of_its_calibration() {
    let (TestPair { fundamental, matches, .. }, cameras) = scene();
    let views = views(&cameras);
    let pose = RelativePose::from_fundamental(&fundamental, &views.calibrations(), &matches).unwrap();
    let own = Some((pose, 0.12));
    assert_eq!(stereo_pose(own, &views, None, &[]).unwrap(), (pose, Some(0.12)));
    assert_eq!(stereo_pose(None, &views, None, &matches), Err(StudyError::NoPose));
    assert_eq!(stereo_pose(own, &views, Some(&fundamental), &[]), Err(StudyError::NoMatches));
    let (found, baseline) = stereo_pose(None, &views, Some(&fundamental), &matches).unwrap();
    let off = (found.rotation.matrix() - pose.rotation.matrix()).norm();
    assert!(off < 1e-9 && baseline.is_none(), "{off}");
    assert!(found.angle() < 1e-6, "rounding leaves a number: {}", found.angle());
    // Fewer matches than a fit needs still tell the left camera.
    assert!(stereo_pose(own, &views, Some(&fundamental), &matches[..3]).is_ok());
    let lens = self::views(&cameras.map(|_| CameraModel::of_division(-0.1, FRAME).unwrap()));
    assert_eq!(stereo_pose(own, &lens, Some(&fundamental), &matches), Err(StudyError::NoFocalLengths));
}
