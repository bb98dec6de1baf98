//! Tests on exact scenes with each mistake put in.

use nalgebra::{Matrix3, Point3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::cameras::DecomposedCamera;
use super::*;
use crate::convention::Reading;
use crate::geometry::{GroupedObservation, Observation, fit_fundamental, grouped_covariance, scaling};

const FRAMES: [Frame; 2] = [Frame { width: 768, height: 576 }; 2];
/// Scenes for each mistake.
const SCENES: u64 = 8;

/// Two cameras with different calibrations and their matches with some noise.
struct Scene {
    cameras: [DecomposedCamera; 2],
    matches: Vec<PointPair>,
}

impl Scene {
    fn new(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut camera = |x: f64, focal: [f64; 2], principal: [f64; 2]| {
            let mut near = |v: f64, by: f64| v + random.random_range(-by..by);
            let turn = [near(0.0, 0.12), near(-0.12 * x.signum(), 0.08), near(0.0, 0.12)];
            let rotation = Rotation3::from_euler_angles(turn[0], turn[1], turn[2]).into_inner();
            let position = Vector3::new(near(x, 0.3), near(0.0, 0.4), near(0.0, 0.4));
            let calibration =
                Matrix3::new(focal[0], 0.0, principal[0], 0.0, focal[1], principal[1], 0.0, 0.0, 1.0);
            DecomposedCamera { calibration, rotation, translation: -(rotation * position) }
        };
        let cameras =
            [camera(-0.6, [820.0, 740.0], [402.0, 262.0]), camera(0.6, [700.0, 790.0], [371.0, 310.0])];
        let matches = of_cameras(&cameras, seed);
        Self { cameras, matches }
    }

    fn geometry(cameras: &[DecomposedCamera; 2]) -> GivenGeometry {
        let [a, b] = cameras.each_ref().map(|camera| camera.composed().unwrap());
        GivenGeometry { cameras: Some([a, b]), ..Camera::fundamental(&a, &b).unwrap().into() }
    }

    fn truth(&self) -> GivenGeometry {
        Self::geometry(&self.cameras)
    }

    fn judged(&self, given: &GivenGeometry, matches: &[PointPair]) -> Judgement {
        let fundamental = self.truth().fundamental;
        judge(given, &reference(fundamental, matches), LIMIT).unwrap()
    }
}

/// Returns matches of two cameras with some noise.
fn of_cameras(cameras: &[DecomposedCamera; 2], seed: u64) -> Vec<PointPair> {
    let both = cameras.map(|camera| camera.composed().unwrap());
    let mut random = Pcg64Mcg::seed_from_u64(1000 + seed);
    let mut matches = Vec::new();
    while matches.len() < 250 {
        let mut along = |by: f64| random.random_range(-by..by);
        let point = Point3::new(along(4.0), along(3.0), 6.5 + along(2.5));
        let mut seen = both.map(|camera| camera.project(&point));
        for seen in seen.iter_mut().flatten() {
            *seen += crate::geometry::Vector::new(along(0.3), along(0.3));
        }
        if let [Some(point1), Some(point2)] = seen
            && FRAMES[0].contains(point1)
            && FRAMES[1].contains(point2)
        {
            matches.push(PointPair { point1, point2 });
        }
    }
    matches
}

/// Returns a trusted reference, all of whose matches are witnesses.
fn reference(fundamental: FundamentalMatrix, matches: &[PointPair]) -> Reference<'_> {
    let (is_trusted, has_epipoles) = (true, true);
    Reference {
        fundamental,
        matches,
        witnesses: matches,
        frames: FRAMES,
        is_trusted,
        has_epipoles,
        covariance: None,
    }
}

/// Returns `F` for mapped pixels of both images.
fn mapped(f: &FundamentalMatrix, maps: [Matrix3<f64>; 2]) -> GivenGeometry {
    let [m1, m2] = maps.map(|map| map.try_inverse().unwrap());
    FundamentalMatrix::from_rank_two(m2.transpose() * f.matrix() * m1).unwrap().into()
}

/// A mistake: the wrong geometry of a scene, and whether a change names it.
type Mistake = (&'static str, fn(&Scene) -> GivenGeometry, fn(&Change) -> bool);

/// Applies the opposite of a mistake to the true cameras.
fn wrong(scene: &Scene, with: fn(&mut DecomposedCamera)) -> GivenGeometry {
    let mut cameras = scene.cameras;
    cameras.iter_mut().for_each(with);
    Scene::geometry(&cameras)
}

fn is_camera(change: &Change, wanted: CameraChange) -> bool {
    matches!(change, Change::Cameras { mistake } if *mistake == wanted)
}

const MISTAKES: [Mistake; 18] = [
    (
        "transposed",
        |s| s.truth().fundamental.swapped().into(),
        |c| {
            matches!(
                c,
                Change::Convention { reading: Reading { transposed: true, axes_exchanged: false, .. } }
            )
        },
    ),
    (
        "x and y exchanged",
        |s| {
            let exchange = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
            mapped(&s.truth().fundamental, [exchange; 2])
        },
        |c| {
            matches!(
                c,
                Change::Convention { reading: Reading { transposed: false, axes_exchanged: true, .. } }
            )
        },
    ),
    (
        "half size",
        |s| mapped(&s.truth().fundamental, [scaling(0.5, -0.25, -0.25); 2]),
        |c| matches!(c, Change::Resized { images: Affected::Both, factor } if (factor - 0.5).abs() < 0.01),
    ),
    (
        "image 2 at half size",
        |s| mapped(&s.truth().fundamental, [scaling(1.0, 0.0, 0.0), scaling(0.5, -0.25, -0.25)]),
        |c| matches!(c, Change::Resized { images: Affected::Image2, factor } if (factor - 0.5).abs() < 0.01),
    ),
    (
        "cropped",
        |s| mapped(&s.truth().fundamental, [scaling(1.0, -40.0, 25.0); 2]),
        |c| matches!(c, Change::Moved { .. }),
    ),
    (
        "image 1 cropped",
        |s| mapped(&s.truth().fundamental, [scaling(1.0, -30.0, -40.0), Matrix3::identity()]),
        |c| matches!(c, Change::Moved { .. }),
    ),
    (
        "image 2 turned by 180°",
        |s| {
            let turn = Matrix3::new(-1.0, 0.0, 767.0, 0.0, -1.0, 575.0, 0.0, 0.0, 1.0);
            mapped(&s.truth().fundamental, [Matrix3::identity(), turn])
        },
        |c| matches!(c, Change::Mirrored { images: Affected::Image2, mirror: Mirror::HalfTurn }),
    ),
    (
        "y counted from the bottom",
        |s| {
            let flip = Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 575.0, 0.0, 0.0, 1.0);
            mapped(&s.truth().fundamental, [flip; 2])
        },
        |c| matches!(c, Change::Mirrored { images: Affected::Both, mirror: Mirror::TopBottom }),
    ),
    (
        "principal point",
        |s| {
            wrong(s, |camera| {
                camera.calibration[(0, 2)] += 35.0;
                camera.calibration[(1, 2)] -= 30.0;
            })
        },
        |c| matches!(c, Change::Moved { .. }),
    ),
    (
        "focal lengths exchanged",
        |s| {
            wrong(s, |camera| {
                let k = camera.calibration;
                (camera.calibration[(0, 0)], camera.calibration[(1, 1)]) = (k[(1, 1)], k[(0, 0)]);
            })
        },
        |c| is_camera(c, CameraChange::FocalLengthsExchanged),
    ),
    (
        "calibrations exchanged",
        |s| {
            let [a, b] = s.cameras;
            Scene::geometry(&[
                DecomposedCamera { calibration: b.calibration, ..a },
                DecomposedCamera { calibration: a.calibration, ..b },
            ])
        },
        |c| is_camera(c, CameraChange::CalibrationsExchanged),
    ),
    (
        "calibration matrices transposed",
        |s| wrong(s, |camera| camera.calibration.transpose_mut()),
        |c| is_camera(c, CameraChange::CalibrationTransposed),
    ),
    (
        "axes of OpenGL",
        |s| {
            wrong(s, |camera| {
                let axes = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
                (camera.rotation, camera.translation) = (axes * camera.rotation, axes * camera.translation);
            })
        },
        |c| is_camera(c, CameraChange::OpenGlAxes),
    ),
    (
        "camera to world",
        |s| {
            wrong(s, |camera| {
                let inverse = camera.rotation.transpose();
                (camera.rotation, camera.translation) = (inverse, -(inverse * camera.translation));
            })
        },
        |c| is_camera(c, CameraChange::CameraToWorld),
    ),
    (
        "position for translation",
        |s| wrong(s, |camera| camera.translation = -(camera.rotation.transpose() * camera.translation)),
        |c| is_camera(c, CameraChange::PositionForTranslation),
    ),
    (
        "rotation inverted",
        |s| wrong(s, |camera| camera.rotation.transpose_mut()),
        |c| is_camera(c, CameraChange::RotationInverted),
    ),
    (
        "order of the quaternion",
        |s| {
            wrong(s, |camera| {
                let right =
                    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(camera.rotation));
                let misread = Quaternion::new(right.i, right.j, right.k, right.w);
                camera.rotation = UnitQuaternion::from_quaternion(misread).to_rotation_matrix().into_inner();
            })
        },
        |c| is_camera(c, CameraChange::QuaternionOrder),
    ),
    (
        "mirrored",
        |s| {
            let mirror = Matrix3::new(-1.0, 0.0, 767.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
            mapped(&s.truth().fundamental, [mirror; 2])
        },
        |c| matches!(c, Change::Mirrored { images: Affected::Both, mirror: Mirror::LeftRight }),
    ),
];

#[test]
fn mistakes_are_found_and_named() {
    let (mut wrong, mut named) = (0, 0);
    for (name, of, names) in MISTAKES {
        for seed in 0..SCENES {
            let scene = Scene::new(seed);
            let judged = scene.judged(&of(&scene), &scene.matches);
            if judged.lines_apart.median <= LIMIT {
                assert_eq!(judged.finding, Finding::Fits, "{name}, scene {seed}");
                continue;
            }
            wrong += 1;
            assert_eq!(judged.finding, Finding::DoesNotFit, "{name}, scene {seed}");
            let is_named = judged.change.is_some_and(|found| names(&found.change));
            named += usize::from(is_named);
            if !is_named {
                println!("{name}, scene {seed}: {:?} {:?}", judged.lines_apart, judged.change);
            }
        }
    }
    println!("{named} of {wrong} mistakes named");
    assert!(wrong > 100 && named * 100 >= 95 * wrong, "{named} of {wrong}");
}

#[test]
fn a_sound_geometry_fits_and_its_change_is_not_looked_for() {
    for seed in 0..SCENES {
        let scene = Scene::new(seed);
        let judged = scene.judged(&scene.truth(), &scene.matches);
        assert_eq!((judged.finding, judged.change), (Finding::Fits, None));
        assert!(judged.lines_apart.median < 1e-6 && judged.residuals.median < 0.3);
    }
}

#[test]
fn distortion_that_is_left_out_is_named_with_its_size() {
    let mut count = 0;
    for seed in 0..SCENES {
        let scene = Scene::new(seed);
        for k in [0.12, -0.1] {
            // The lens bends the pixels: they are undistorted by d (1 + k r²).
            let bent: Vec<PointPair> = scene
                .matches
                .iter()
                .map(|pair| {
                    let mut bent = *pair;
                    for _ in 0..50 {
                        let back = change::undistorted(&bent, k, FRAMES);
                        bent.point1 -= back.point1 - pair.point1;
                        bent.point2 -= back.point2 - pair.point2;
                    }
                    bent
                })
                .collect();
            // An estimate bends with the matches.
            let reference = reference(crate::geometry::eight_point(&bent).unwrap(), &bent);
            let judged = judge(&scene.truth(), &reference, LIMIT).unwrap();
            if judged.finding == Finding::Fits {
                continue;
            }
            count += 1;
            let found = judged.change;
            let Some(FittingChange { change: Change::Distortion { k: found }, .. }) = found else {
                panic!("scene {seed}, {k}: {found:?}");
            };
            assert!((found - k).abs() < 0.02, "scene {seed}: {found} of {k}");
        }
    }
    assert!(count > 10, "{count}");
}

#[test]
fn an_untrusted_reference_confirms_but_does_not_contradict() {
    let scene = Scene::new(3);
    let fundamental = scene.truth().fundamental;
    let reference = Reference { is_trusted: false, ..reference(fundamental, &scene.matches) };
    let judged = judge(&scene.truth(), &reference, LIMIT).unwrap();
    assert_eq!((judged.finding, judged.doubt), (Finding::Fits, None));
    let transposed = fundamental.swapped().into();
    let judged = judge(&transposed, &reference, LIMIT).unwrap();
    assert_eq!((judged.finding, judged.doubt), (Finding::Undecided, Some(Doubt::Reference)));
    let few = Reference { matches: &scene.matches[..FEWEST_MATCHES - 1], ..reference };
    assert!(judge(&transposed, &few, LIMIT).is_none());
}

/// On a chessboard, a search may match each corner with a neighbour of its partner. The lines through such
/// matches are no evidence.
#[test]
fn a_reference_on_a_shifted_pattern_does_not_accuse() {
    let scene = Scene::new(4);
    let truth = scene.truth();
    let shifted: Vec<PointPair> = scene
        .matches
        .iter()
        .map(|pair| PointPair { point2: pair.point2 + crate::geometry::Vector::new(3.0, 21.0), ..*pair })
        .collect();
    let wrong = reference(crate::geometry::eight_point(&shifted).unwrap(), &shifted);
    let judged = |witnesses: &[PointPair]| judge(&truth, &Reference { witnesses, ..wrong }, LIMIT).unwrap();
    let board = judged(&[]);
    assert_eq!((board.finding, board.change), (Finding::Undecided, None));
    assert_eq!(board.doubt, Some(Doubt::FewWitnesses { places: Contest::default() }));
    // Wrong matches of one place, such as the edge of the board.
    let edge = [shifted[0]; 20];
    assert_eq!(judged(&edge).finding, Finding::Undecided);
    // The distinctive points of the background know better.
    let right: Vec<PointPair> = scene.matches.iter().step_by(2).copied().collect();
    assert!(matches!(judged(&right).doubt, Some(Doubt::WitnessesAgree { places }) if places.first == 0));
    assert_eq!(judged(&shifted).finding, Finding::DoesNotFit);
}

/// A trusted reference owes nothing for having been fitted: ten places decide, as for any two explanations.
#[test]
fn ten_places_with_witnesses_refute_a_geometry_and_nine_do_not() {
    let scene = Scene::new(3);
    let fundamental = scene.truth().fundamental;
    let transposed: GivenGeometry = fundamental.swapped().into();
    let mut places: Vec<PointPair> = Vec::new();
    let place = |pair: &PointPair| [pair.point1.x, pair.point1.y].map(|v| (v / 76.8).floor() as i64);
    for pair in &scene.matches {
        let is_far = symmetric_epipolar_distance(&transposed.fundamental, pair) > 2.0 * LIMIT;
        if is_far && places.iter().all(|other| place(other) != place(pair)) {
            places.push(*pair);
        }
    }
    assert!(places.len() >= 10, "{}", places.len());
    let judged = |witnesses: &[PointPair]| {
        judge(&transposed, &Reference { witnesses, ..reference(fundamental, &scene.matches) }, LIMIT).unwrap()
    };
    let ten = judged(&places[..10]);
    assert_eq!((ten.finding, ten.doubt), (Finding::DoesNotFit, None));
    assert!(ten.change.is_some());
    let nine = judged(&places[..9]);
    assert_eq!(nine.doubt, Some(Doubt::FewWitnesses { places: Contest { first: 9, second: 0 } }));
}

#[test]
fn no_change_is_named_if_the_epipoles_are_open_or_another_search_disagrees() {
    let scene = Scene::new(3);
    let fundamental = scene.truth().fundamental;
    let transposed: GivenGeometry = fundamental.swapped().into();
    let reference = reference(fundamental, &scene.matches);
    let found = judge(&transposed, &reference, LIMIT).unwrap();
    assert!(found.change.is_some());
    let open = judge(&transposed, &Reference { has_epipoles: false, ..reference }, LIMIT).unwrap();
    assert_eq!((open.finding, open.change), (Finding::DoesNotFit, None));
    assert_eq!(found.clone().confirmed_by(&found, &reference), found);
    assert_eq!(found.clone().confirmed_by(&open, &reference), open);
    let fits = judge(&fundamental.into(), &reference, LIMIT).unwrap();
    let undecided = found.confirmed_by(&fits, &reference);
    assert_eq!((undecided.finding, undecided.doubt), (Finding::Undecided, Some(Doubt::OtherSearch)));
    assert!(undecided.change.is_none());
}

#[test]
fn a_translation_with_the_wrong_sign_puts_the_scene_behind_both_cameras() {
    let scene = Scene::new(6);
    let [first, mut second] = scene.cameras;
    // The second camera as seen from the first, with the baseline reversed.
    let rotation = second.rotation * first.rotation.transpose();
    let baseline = second.translation - rotation * first.translation;
    second.translation = rotation * first.translation - baseline;
    let reversed = Scene::geometry(&[first, second]);
    let judged = scene.judged(&reversed, &scene.matches);
    assert!(judged.lines_apart.median < 1e-6, "F is the same: {:?}", judged.lines_apart);
    assert_eq!((judged.finding, judged.doubt), (Finding::DoesNotFit, None));
    assert_eq!(judged.change.unwrap().change, Change::TranslationReversed);
    let few = Reference { witnesses: &[], ..reference(scene.truth().fundamental, &scene.matches) };
    let judged = judge(&reversed, &few, LIMIT).unwrap();
    assert_eq!((judged.finding, judged.doubt), (Finding::Undecided, Some(Doubt::Depth)));
    // Cameras of a mirrored scene, or with a matrix times −1, have no certain sign.
    let negative = |camera: Camera| Camera::from_matrix(-camera.matrix()).unwrap();
    let open = GivenGeometry { cameras: reversed.cameras.map(|both| both.map(negative)), ..reversed };
    assert_eq!(scene.judged(&open, &scene.matches).finding, Finding::Fits);
}

#[test]
fn an_essential_matrix_is_told_with_a_focal_length() {
    let k = scaling(900.0, 383.5, 287.5);
    for seed in 0..SCENES {
        let scene = Scene::new(seed);
        let cameras = scene.cameras.map(|camera| DecomposedCamera { calibration: k, ..camera });
        let seen = of_cameras(&cameras, seed);
        let truth = Scene::geometry(&cameras).fundamental;
        let essential = FundamentalMatrix::from_rank_two(k.transpose() * truth.matrix() * k).unwrap();
        let judged = judge(&essential.into(), &reference(truth, &seen), LIMIT).unwrap();
        assert!(judged.looks_essential && judged.finding == Finding::DoesNotFit, "scene {seed}");
        assert!(
            matches!(judged.change.unwrap().change, Change::Essential { focal } if (focal - 900.0).abs() < 20.0),
            "scene {seed}: {:?}",
            judged.change
        );
        assert!(!judge(&truth.into(), &reference(truth, &seen), LIMIT).unwrap().looks_essential);
    }
}

/// Returns the fit to pairs with noise of the standard deviation `sigma`, and its covariance.
pub(super) fn fitted(
    start: &FundamentalMatrix,
    pairs: &[PointPair],
    sigma: f64,
) -> (FundamentalMatrix, Matrix9) {
    let observed: Vec<Observation> = pairs.iter().map(|pair| Observation { pair: *pair, sigma }).collect();
    let fit = fit_fundamental(start, &observed, 10.0).unwrap().fundamental;
    let grouped: Vec<GroupedObservation> = observed
        .iter()
        .enumerate()
        .map(|(group, o)| GroupedObservation {
            observation: Observation { sigma: 10.0 * sigma, ..*o },
            deviation: sigma,
            group,
        })
        .collect();
    (fit, grouped_covariance(&fit, &grouped, None).unwrap())
}

/// Half a pixel moves lines by less than the limit; the covariance of precise matches shows it.
#[test]
fn half_a_pixel_is_significant_and_named() {
    let (mut named, mut significant) = (0, 0);
    for seed in 0..SCENES {
        let scene = Scene::new(seed);
        // The noise of the matches is uniform, ±0.3 px in each coordinate.
        let sigma = 0.3 / 3f64.sqrt();
        let truth = scene.truth();
        let (fundamental, covariance) = fitted(&truth.fundamental, &scene.matches, sigma);
        let covariance = Some(covariance);
        let matches = &scene.matches[..];
        let reference = Reference { covariance, ..reference(fundamental, matches) };
        let judged = judge(&truth, &reference, LIMIT).unwrap();
        assert!(!judged.significance.unwrap().is_significant && judged.change.is_none(), "scene {seed}");
        let doubtful = Reference { is_trusted: false, ..reference };
        assert!(judge(&truth, &doubtful, LIMIT).unwrap().significance.is_none());
        for images in Affected::ALL {
            let half = scaling(1.0, 0.5, 0.5);
            let of = |image| match images {
                Affected::Image1 if image == 1 => Matrix3::identity(),
                Affected::Image2 if image == 0 => Matrix3::identity(),
                _ => half,
            };
            let judged = judge(&mapped(&truth.fundamental, [of(0), of(1)]), &reference, LIMIT).unwrap();
            assert_eq!(judged.finding, Finding::Fits);
            if !judged.significance.unwrap().is_significant {
                continue;
            }
            significant += 1;
            let change = judged.change.map(|found| found.change);
            named += usize::from(match change {
                Some(Change::HalfPixel { images: found, offset }) => found == images && offset > 0.0,
                Some(Change::Convention { reading }) => {
                    images == Affected::Both && (reading.origin - 0.5).abs() < 1e-9
                }
                _ => false,
            });
        }
    }
    // Half a pixel in one image and the opposite in the other one may move lines alike.
    assert!(significant > 12 && 4 * named > 3 * significant, "{named} of {significant}");
}
