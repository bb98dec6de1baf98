//! Calibrations as other programs write them.

use nalgebra::Vector3;

use super::*;
use crate::camera::{Lens, ViewPair};
use crate::geometry::{Point, PointPair};
use crate::skipping;

fn read(text: &str) -> Vec<CalibratedCamera> {
    Calibration::parse(text).unwrap_or_else(|e| panic!("{e}\n{text}")).cameras
}

fn refused(text: &str) -> String {
    Calibration::parse(text).unwrap_err()
}

/// Pixel of a ray up and to the right.
fn pixel(camera: &CalibratedCamera) -> Point {
    camera.model.image_from_ray(&Vector3::new(0.3, -0.2, 1.0)).unwrap()
}

const OPENCV: &str = "%YAML:1.0
---
K1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320., 0., 505., 240., 0., 0., 1. ]
D1: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.3, 0.1, 0.001, -0.002, 0.01 ]
K2: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 490., 0., 310., 0., 495., 250., 0., 0., 1. ]
D2: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0., 0., 0., 0., 0. ]
R: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]
T: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ -0.12, 0., 0. ]
";

#[test]
fn stereo_calibrations_of_opencv_have_lenses_and_the_pose() {
    let cameras = read(OPENCV);
    assert_eq!(cameras.len(), 2);
    let lens = Lens::from_opencv(&[-0.3, 0.1, 0.001, -0.002, 0.01]).unwrap();
    assert_eq!(*cameras[0].model.lens(), lens);
    assert!(cameras[1].model.lens().is_ideal());
    let pair = Calibration { cameras }.pair(None).unwrap();
    let (pose, baseline) = CalibratedCamera::relative_pose(&pair).unwrap();
    assert!((baseline - 0.12).abs() < 1e-15 && (pose.translation - -Vector3::x()).norm() < 1e-15);
}

#[test]
fn one_camera_describes_both_images() {
    let text = "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                data: [500, 0, 320, 0, 505, 240, 0, 0, 1]\ndistortion_model: plumb_bob\n\
                distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.3, 0.1, 0, 0, 0]\n";
    let calibration = Calibration::parse(text).unwrap();
    let [left, right] = calibration.pair(None).unwrap();
    assert_eq!(left, right);
    assert!(left.check_frame(Frame::new(640, 480)).is_ok());
    assert!(left.check_frame(Frame::new(320, 240)).unwrap_err().contains("640×480"));
    assert!(CalibratedCamera::relative_pose(&[left, right]).is_none());
    let json = r#"{"K": [[500, 0, 320], [0, 505, 240], [0, 0, 1]], "D": [-0.3, 0.1, 0, 0]}"#;
    assert_eq!(pixel(&read(json)[0]), pixel(&read(text)[0]));
}

#[test]
fn camera_chains_of_kalibr_go_through_the_chain_or_the_inertial_unit() {
    let chain = "cam0:\n  camera_model: pinhole\n  intrinsics: [458.6, 457.3, 367.2, 248.4]\n  distortion_model: \
                 radtan\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n  resolution: [752, 480]\ncam1:\n  \
                 T_cn_cnm1:\n    - [1.0, 0.0, 0.0, -0.11]\n    - [0.0, 1.0, 0.0, 0.0]\n    - [0.0, 0.0, 1.0, \
                 0.0]\n    - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  intrinsics: [190.9, 190.9, 254.9, \
                 256.8]\n  distortion_model: equidistant\n  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]\n  \
                 resolution: [512, 512]\n";
    let cameras = read(chain);
    assert_eq!(cameras[1].name, "cam1");
    assert_eq!(cameras[1].frame, Some(Frame::new(512, 512)));
    assert_eq!(cameras[1].model.lens().projection, crate::camera::Projection::Equidistant);
    let pair = Calibration { cameras }.pair(Some(["cam0", "cam1"])).unwrap();
    assert!((CalibratedCamera::relative_pose(&pair).unwrap().1 - 0.11).abs() < 1e-12);
    let through = "T_imu_cam:\n    - [0.0, -1.0, 0.0, X]\n    - [1.0, 0.0, 0.0, 0.5]\n    - [0.0, 0.0, 1.0, 0.2]\n    \
                   - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  intrinsics: [458, 457, 367, 248]\n  \
                   distortion_model: none\n  distortion_coeffs: []\n";
    let text = format!("cam0:\n  {}cam1:\n  {}", through.replace('X', "0.1"), through.replace('X', "0.3"));
    let pair = Calibration::parse(&text).unwrap().pair(None).unwrap();
    let (pose, baseline) = CalibratedCamera::relative_pose(&pair).unwrap();
    // The cameras are 0.2 apart along x of the unit, which is −y of the cameras.
    assert!((baseline - 0.2).abs() < 1e-12 && (pose.position2() - -Vector3::y()).norm() < 1e-12, "{pose:?}");
    assert!(refused(&chain.replace("radtan", "magic")).contains("magic"));
    assert!(refused(&chain.replace("camera_model: pinhole", "camera_model: omni")).contains("omni"));
}

#[test]
fn kitti_has_raw_and_rectified_cameras() {
    let raw = "calib_time: 09-Jan-2012 13:57:47\nS_00: 1392 512\nK_00: 984 0 690 0 981 233 0 0 1\nD_00: -0.37 0.2 \
               0.002 0.001 -0.07\nR_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\nK_01: 989 0 702 0 988 245 0 0 1\nD_01: \
               -0.36 0.18 0.001 -0.0006 -0.05\nR_01: 1 0 0 0 1 0 0 0 1\nT_01: -0.537 0.0048 -0.0125\n";
    let pair = Calibration::parse(raw).unwrap().pair(Some(["00", "01"])).unwrap();
    assert_eq!(pair[0].frame, Some(Frame::new(1392, 512)));
    assert!((CalibratedCamera::relative_pose(&pair).unwrap().1 - 0.5372).abs() < 1e-3);
    let rectified = "P0: 721 0 609 0 0 721 172 0 0 0 1 0\nP1: 721 0 609 -387.5 0 721 172 0 0 0 1 0\n";
    let pair = Calibration::parse(rectified).unwrap().pair(None).unwrap();
    assert!((CalibratedCamera::relative_pose(&pair).unwrap().1 - 387.5 / 721.0).abs() < 1e-12);
    assert!(refused("K_00: 1 2 3\n").contains("expected 9 numbers"));
    assert!(refused("P0: 0 0 0 0 0 0 0 0 0 0 0 0\n").contains("impossible"));
}

#[test]
fn middlebury_and_colmap_are_read() {
    let text = "cam0=[3997.684 0 1176.728; 0 3997.684 1011.728; 0 0 1]\ncam1=[3997.684 0 1307.839; 0 3997.684 \
                1011.728; 0 0 1]\ndoffs=131.111\nbaseline=193.001\nwidth=2964\nheight=1988\n";
    let pair = Calibration::parse(text).unwrap().pair(None).unwrap();
    assert_eq!(pair[1].frame, Some(Frame::new(2964, 1988)));
    assert!((CalibratedCamera::relative_pose(&pair).unwrap().1 - 193.001).abs() < 1e-9);
    let colmap =
        "# Camera list\n1 SIMPLE_RADIAL 640 480 688.8 320 240 -0.127\n2 PINHOLE 640 480 600 600 320 240\n";
    let cameras = read(colmap);
    assert_eq!((cameras[0].name.as_str(), cameras.len()), ("1", 2));
    // The centre of the top-left pixel is (0.5, 0.5) in COLMAP.
    assert!((cameras[1].model.calibration()[(0, 2)] - 319.5).abs() < 1e-12);
    assert!(refused("1 SIMPLE_RADIAL 640 480 688.8\n").contains("line 1: SIMPLE_RADIAL has 4 parameters"));
}

#[test]
fn calibration_matrices_without_names_are_read() {
    let (first, second) = ("# left\n900 0 320\n0 910 240\n0 0 1\n", "8.5e2, 0, 330\n0, 860, 235\n0, 0, 1\n");
    let one = read(first);
    assert_eq!((one.len(), one[0].model.calibration()[(1, 1)], one[0].frame), (1, 910.0, None));
    let both = read(&format!("{first}\n{second}"));
    assert_eq!(
        (both.len(), both[0].model.calibration()[(0, 2)], both[1].model.calibration()[(0, 0)]),
        (2, 320.0, 850.0)
    );
    // A matrix of another kind, and numbers beside the matrices.
    for text in [
        "900 0 320\n0 910 240\n0 0.1 1\n",
        "1 0 0\n0 1 0\n0 0 1\n",
        "0.5 0 10\n0 0.5 20\n0 0 1\n",
        "1e-6 2e-6 -1e-3\n3e-6 1e-7 2e-3\n1e-3 -2e-3 1\n",
        &format!("{first}1 0 0\n"),
    ] {
        assert!(Calibration::parse(text).is_err(), "{text}");
    }
}

#[test]
fn sections_of_toml_are_cameras() {
    let text = "[metadata]\nadjusted = true\n\n[cam_0]\nname = \"left\"\nsize = [1280, 720]\nmatrix = [[894.0, 0.0, \
                624.0], [0.0, 896.0, 361.0], [0.0, 0.0, 1.0]]\ndistortions = [-0.33, 0.09, 0.0, 0.0, 0.0]\nrotation \
                = [0.0, 0.0, 0.0]\ntranslation = [0.0, 0.0, 0.0]\n\n[cam_1]\nname = \"right\"\nsize = [1280, \
                720]\nmatrix = [[894.0, 0.0, 624.0], [0.0, 896.0, 361.0], [0.0, 0.0, 1.0]]\ndistortions = [0.0, \
                0.0, 0.0, 0.0, 0.0]\nrotation = [0.0, 0.1, 0.0]\ntranslation = [1.0, 0.0, 0.0]\n";
    let pair = Calibration::parse(text).unwrap().pair(Some(["left", "right"])).unwrap();
    let (pose, _) = CalibratedCamera::relative_pose(&pair).unwrap();
    assert!((pose.rotation.angle() - 0.1).abs() < 1e-12);
    let told = Calibration::parse(text).unwrap().pair(Some(["left", "middle"])).unwrap_err();
    assert!(told.contains("no camera middle") && told.contains("left, right"), "{told}");
}

#[test]
fn what_is_no_calibration_is_told_in_words() {
    for text in ["", "hello", "[1, 2]", "{}", "{\"K\": \"x\"}", "K: [1, 2]", "[a]\nb = 1\n", "1 2 3 4\n"] {
        assert!(!refused(text).is_empty(), "{text}");
    }
    assert!(refused("{\"a\": 1}").contains("no camera calibration"));
    assert!(
        refused(
            &OPENCV.replace(
                "1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT",
                "2., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT"
            )
        )
        .contains("rotation")
    );
}

#[test]
fn calibrations_of_other_programs_are_read() {
    let Some(data) = skipping::shared("data") else { return };
    for (name, cameras, has_pose) in [
        ("projects/calibrations/kalibr-euroc_mav.yaml", 2, true),
        ("projects/calibrations/kalibr-rs_t265.yaml", 2, true),
        ("projects/calibrations/kalibr-tum_vi.yaml", 2, true),
        ("projects/calibrations/kitti-calib_cam_to_cam.txt", 4, true),
        ("projects/opencv-stereo/stereo.yml", 2, true),
        ("projects/opencv-stereo/left.yml", 1, false),
        ("projects/kermit/sparse-text/cameras.txt", 1, false),
        ("video-charuco/camera_array.toml", 4, true),
    ] {
        let found = Calibration::read(&data.join(name)).unwrap();
        assert_eq!(found.cameras.len(), cameras, "{name}");
        let pair = found.pair(None).unwrap();
        assert_eq!(CalibratedCamera::relative_pose(&pair).is_some(), has_pose, "{name}");
    }
}

#[test]
fn corners_of_a_board_lie_on_their_epipolar_curves() {
    let Some(data) = skipping::shared("data/video-charuco") else { return };
    let calibration = Calibration::read(&data.join("camera_array.toml")).unwrap();
    // Corners by time, camera and number.
    let text = std::fs::read_to_string(data.join("xy.csv")).unwrap();
    let mut corners = std::collections::BTreeMap::new();
    for row in text.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let point = Point::new(cells[6].parse().unwrap(), cells[7].parse().unwrap());
        corners.insert((cells[1], cells[0], cells[5]), point);
    }
    for (a, b) in [("0", "1"), ("1", "2"), ("2", "3")] {
        let cameras = calibration.pair(Some([a, b])).unwrap();
        let frames = cameras.each_ref().map(|camera| camera.frame.unwrap());
        let (pose, _) = CalibratedCamera::relative_pose(&cameras).unwrap();
        let median = |models: [CameraModel; 2]| {
            let views = ViewPair::new([&models[0], &models[1]], frames).unwrap();
            let f = pose.fundamental(&views.calibrations()).unwrap();
            let of_a = corners.iter().filter(|((camera, ..), _)| *camera == a);
            let distances = of_a.filter_map(|((_, time, number), point1)| {
                let pair = PointPair { point1: *point1, point2: *corners.get(&(b, *time, *number))? };
                views.distance_from_curves(&f, &views.undistorted_from_original(&pair)?)
            });
            crate::geometry::median(distances)
        };
        let models = [cameras[0].model, cameras[1].model];
        let (bent, straight) = (
            median(models),
            median(models.map(|m| CameraModel::new(&m.calibration(), Lens::IDEAL).unwrap())),
        );
        // 0.44 to 0.76 px: the poses of the file are that precise.
        assert!(bent < 0.8 && straight > 1.5 * bent, "{a} and {b}: {bent} and {straight} px");
    }
}

#[test]
fn many_names_give_the_same_calibration() {
    let expected = read(OPENCV);
    let same = |text: &str| {
        let found = read(text);
        assert_eq!(found.len(), 2, "{text}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!((found.model, found.pose), (expected.model, expected.pose), "{text}");
            assert!(found.reading.unread.is_empty(), "{:?}", found.reading);
        }
    };
    for [k, d, r, t] in [
        ["cameraMatrix#", "distCoeffs#", "R", "T"],
        ["M#", "dist_coeff_#", "rotation_matrix", "translation_vector"],
        ["camera_matrix_#", "distCoeff#", "rot", "trans"],
        ["intrinsics_#", "kc#", "Rotation", "Translation"],
        ["CAMERA_MATRIX_#", "d#", "R_stereo", "T_stereo"],
        ["mtx#", "dist_#", "R", "tvec"],
    ] {
        for sides in [["1", "2"], ["0", "1"], ["left", "right"], ["L", "R"], ["l", "r"]] {
            let mut text = OPENCV.replace("\nR:", &format!("\n{r}:")).replace("\nT:", &format!("\n{t}:"));
            for (number, side) in ["1", "2"].into_iter().zip(sides) {
                let of = |name: &str| name.replace('#', side);
                text = text.replace(&format!("\nK{number}:"), &format!("\n{}:", of(k)));
                text = text.replace(&format!("\nD{number}:"), &format!("\n{}:", of(d)));
            }
            same(&text);
        }
    }
    let nested = "{\"stereo_params\": {\"left\": {\"K\": [[500,0,320],[0,505,240],[0,0,1]], \"D\": \
                  [-0.3,0.1,0.001,-0.002,0.01]}, \"right\": {\"K\": [[490,0,310],[0,495,250],[0,0,1]], \"D\": \
                  [0,0,0,0,0]}, \"R\": [[1,0,0],[0,1,0],[0,0,1]], \"T\": [-0.12,0,0]}}";
    same(nested);
    let assigned = "K1 = [500 0 320; 0 505 240; 0 0 1];\nD1 = [-0.3 0.1 0.001 -0.002 0.01];\nK2 = np.array([[490, 0, \
                    310],\n  [0, 495, 250],\n  [0, 0, 1]])\nD2 = [0, 0, 0, 0, 0]\nR = [1 0 0; 0 1 0; 0 0 1]\nT = \
                    [-0.12; 0; 0]\n";
    same(assigned);
    same(&OPENCV.replace("data: [", "data:[").replace("K1: ", "K1:"));
}

#[test]
fn a_lens_is_never_dropped() {
    let told = refused(&OPENCV.replace("D1:", "xyz1:"));
    assert!(told.contains("xyz1 has 5 numbers and may be the distortion"), "{told}");
    let told = refused(&OPENCV.replace("K1:", "xyz1:"));
    assert!(told.contains("there is D1, but no camera matrix"), "{told}");
    let twice = format!("{OPENCV}distCoeffs1: [0.1, 0.2, 0.3, 0.4, 0.5]\n");
    assert!(refused(&twice).contains("D1 and distCoeffs1 differ"), "{}", refused(&twice));
    let single = "{\"camera_matrix\": [[500,0,320],[0,505,240],[0,0,1]], \"foo\": [1, 2, 3], \"rms\": 0.3, \"bar\": 7}";
    let unread = &read(single)[0].reading.unread;
    assert_eq!(*unread, ["bar", "foo"]);
    for (text, words) in [
        ("fx: 500\nfy: 505\ncx: 320\ncy: 240\nk2: 0.1\n", "missing between"),
        ("fx: 500\nfy: 505\ncx: 320\nk1: 0.1\n", "fx, fy, cx and cy"),
        ("fx: 500\nfy: 505\ncx: 320\ncy: 240\nk1: 0.1\np1: 0.1\n", "p1 and p2"),
        ("K: [[500,0,320],[0,505,240],[0,0,1]]\nD: [1,2,3,4,5]\ndistortion_model: magic\n", "magic"),
        ("K: [[500,0,320],[0,505,240],[0,0,1]]\ncamera_model: mei\nD: [1,2,3,4]\n", "mei"),
    ] {
        assert!(refused(text).contains(words), "{}", refused(text));
    }
}

#[test]
fn rectifications_of_ros_tell_the_pose() {
    let [left, right] = ["0.999, 0, 0.0447102, 0, 1, 0, -0.0447102, 0, 0.999", "1, 0, 0, 0, 1, 0, 0, 0, 1"];
    let text = |rotation: &str, offset: &str| {
        format!(
            "camera_matrix: {{rows: 3, cols: 3, data: [861, 0, 646, 0, 857, 524, 0, 0, 1]}}\ndistortion_model: \
             plumb_bob\ndistortion_coefficients: {{rows: 1, cols: 5, data: [-0.2, 0.06, 0, 0, 0]}}\n\
             rectification_matrix: {{rows: 3, cols: 3, data: [{rotation}]}}\nprojection_matrix: {{rows: 3, cols: 4, \
             data: [800, 0, 644, {offset}, 0, 800, 524, 0, 0, 0, 1, 0]}}\n"
        )
    };
    let cameras = [read(&text(left, "0")).remove(0), read(&text(right, "-240")).remove(0)];
    let (pose, baseline) = CalibratedCamera::relative_pose(&cameras).unwrap();
    assert!((baseline - 0.3).abs() < 1e-9 && (pose.translation - -Vector3::x()).norm() < 1e-9);
    // R = R2ᵀ R1
    assert!((pose.rotation.matrix()[(0, 2)] - 0.044_710_2).abs() < 1e-4);
}

#[test]
fn transposed_matrices_of_matlab_are_told() {
    let text = "{\"cameraMatrix1\": [[900,0,0],[3.8,899,0],[285,242,1]], \"distCoeffs1\": [-0.5,0.9,0.006,-0.0005,-2], \
                \"cameraMatrix2\": [[862,0,0],[1,858,0],[192,300,1]], \"distCoeffs2\": [-0.3,-0.7,-0.005,0.02,2], \
                \"R\": [[0.8,0.6,0],[-0.6,0.8,0],[0,0,1]], \"T\": [-120, 0.5, 2]}";
    let pair = Calibration::parse(text).unwrap().pair(None).unwrap();
    let k = pair[0].model.calibration();
    let off = [k[(0, 2)] - 284.0, k[(1, 2)] - 241.0, k[(0, 1)] - 3.8];
    assert!(off.iter().all(|off| off.abs() < 1e-12), "MATLAB counts pixels from 1: {off:?}");
    let (pose, _) = CalibratedCamera::relative_pose(&pair).unwrap();
    assert!((pose.rotation.matrix()[(0, 1)] + 0.6).abs() < 1e-9);
    let notes = CalibratedCamera::notes_of(&pair).join(" ");
    assert!(notes.contains("transposed"), "{notes}");
    let matlab = "{\"CameraParameters1\": {\"RadialDistortion\": [-0.3, 0.1], \"TangentialDistortion\": [0, 0], \
                  \"ImageSize\": [480, 640], \"K\": [[500,0,321],[0,505,241],[0,0,1]]}, \"CameraParameters2\": \
                  {\"RadialDistortion\": [-0.3, 0.1], \"TangentialDistortion\": [0, 0], \"ImageSize\": [480, 640], \
                  \"K\": [[500,0,321],[0,505,241],[0,0,1]]}, \"RotationOfCamera2\": [[0.8,0.6,0],[-0.6,0.8,0],[0,0,1]], \
                  \"TranslationOfCamera2\": [-120, 0, 0]}";
    let pair = Calibration::parse(matlab).unwrap().pair(None).unwrap();
    assert_eq!(pair[1].frame, Some(Frame::new(640, 480)));
    assert!((pair[1].model.calibration()[(0, 2)] - 320.0).abs() < 1e-12);
    let (pose, _) = CalibratedCamera::relative_pose(&pair).unwrap();
    assert!((pose.rotation.matrix()[(0, 1)] + 0.6).abs() < 1e-9);
}

#[test]
fn files_join_and_foreign_files_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    let (intrinsics, extrinsics) = OPENCV.split_at(OPENCV.find("R: !!").unwrap());
    let first = file("intrinsics.yml", intrinsics.as_bytes());
    let second = file("extrinsics.yml", format!("%YAML:1.0\n---\n{extrinsics}").as_bytes());
    for order in [[&first, &second], [&second, &first]] {
        let found = Calibration::read_files(&order.map(std::path::PathBuf::as_path)).unwrap();
        assert_eq!(found.cameras, read(OPENCV));
    }
    let other = file("other.yml", OPENCV.replace("-0.12", "-0.13").as_bytes());
    assert!(Calibration::read_files(&[&second, &other]).is_err(), "R and T in both");
    let mat = file("stereoParams.mat", b"MATLAB 5.0 MAT-file, Platform: PCWIN64");
    assert!(Calibration::read(&mat).unwrap_err().to_string().contains("jsonencode"));
    assert!(Calibration::find(&mat).is_none());
    let refused = file("refused.yml", OPENCV.replace("D1:", "xyz1:").as_bytes());
    assert!(Calibration::find(&refused).unwrap().is_err());
}

#[test]
fn several_sizes_of_a_camera_are_chosen_by_the_images() {
    let sizes = |size: &str, fx: f64| {
        ["LEFT", "RIGHT"].map(|side| {
            format!(
                "[{side}_CAM_{size}]\nfx={fx}\nfy={fx}\ncx=600\ncy=360\nk1=-0.1\nk2=0\np1=0\np2=0\nk3=0\n"
            )
        })
    };
    let stereo = "[STEREO]\nBaseline=120\nTY=0\nTZ=0\nCV_2K=0\nRX_2K=0\nRZ_2K=0\nCV_HD=0\nRX_HD=0\nRZ_HD=0\n";
    let text = sizes("2K", 1400.0).concat() + &sizes("HD", 700.0).concat() + stereo;
    let pair = Calibration::parse(&text).unwrap().pair(None).unwrap();
    let pair = CalibratedCamera::settled(pair, [Frame::new(1280, 720); 2], Vec::new).unwrap();
    assert_eq!(pair[1].name, "RIGHT_CAM_HD");
    let (pose, length) = CalibratedCamera::relative_pose(&pair).unwrap();
    assert!((length - 120.0).abs() < 1e-9 && pose.translation.x < 0.0);
}

#[test]
fn images_decide_between_two_models_of_four_coefficients() {
    let text = |flag: &str| {
        format!(
            "K1: [[230,0,320],[0,230,240],[0,0,1]]\nD1: [0.012, 0.003, -0.006, 0.001]\nK2: \
             [[230,0,320],[0,230,240],[0,0,1]]\nD2: [0.02, -0.015, 0.02, -0.01]\nR: [0.0, 0.05, 0.0]\nT: [-1, 0.1, \
             0.1]\n{flag}"
        )
    };
    let frames = [Frame::new(640, 480); 2];
    let open = Calibration::parse(&text("")).unwrap();
    assert!(open.pair(None).unwrap_err().contains("fisheye: 1"));
    for (flag, is_fisheye) in [("fisheye: 1\n", true), ("fisheye: 0\n", false)] {
        let truth = Calibration::parse(&text(flag)).unwrap().pair(None).unwrap();
        let pose2 = truth[1].pose.unwrap();
        // Points of a grid in space, at several depths.
        let matches: Vec<PointPair> = (0..400)
            .filter_map(|k| {
                let [x, y] = [f64::from(k % 20) / 10.0 - 1.0, f64::from(k / 20) / 10.0 - 1.0];
                let depth = 3.0 + f64::from(k * 7 % 11);
                let point = Vector3::new(1.3 * x * depth, y * depth, depth);
                let point1 = truth[0].model.image_from_ray(&point)?;
                let point2 = truth[1].model.image_from_ray(&(pose2.rotation * point + pose2.translation))?;
                Some(PointPair { point1, point2 })
            })
            .collect();
        let mut without_pose = open.open_pair(None).unwrap();
        for camera in &mut without_pose {
            camera.pose = None;
        }
        for pair in [open.open_pair(None).unwrap(), without_pose] {
            let settled = CalibratedCamera::settled(pair, frames, || matches.clone()).unwrap();
            assert_eq!(settled[0].model, truth[0].model, "fisheye: {is_fisheye}");
            let notes = CalibratedCamera::notes_of(&settled).join(" ");
            assert!(notes.contains("fisheye"), "{notes}");
        }
    }
    let told = CalibratedCamera::settled(open.open_pair(None).unwrap(), frames, Vec::new).unwrap_err();
    assert!(told.contains("fisheye: 0"), "{told}");
    // Small tangential coefficients are read as such where the images are silent.
    let plain =
        text("").replace("-0.006, 0.001", "-0.0006, 0.0001").replace("0.02, -0.01]", "0.0002, -0.0001]");
    let plain = Calibration::parse(&plain).unwrap().open_pair(None).unwrap();
    let settled = CalibratedCamera::settled(plain, frames, Vec::new).unwrap();
    assert!(
        settled[0].reading.fisheye.is_none()
            && (settled[0].model.lens().tangential[0] + 0.0006).abs() < 1e-12
    );
    assert!(CalibratedCamera::notes_of(&settled).join(" ").contains("add fisheye: 1"));
    // A narrow lens bends both ways alike.
    let narrow = Calibration::parse(&text("").replace("230", "20000")).unwrap().open_pair(None).unwrap();
    let settled =
        CalibratedCamera::settled(narrow, frames, || unreachable!("no matches are needed")).unwrap();
    assert!(settled[0].reading.fisheye.is_none() && settled[0].reading.notes.is_empty());
}
