//! Mutations of known calibrations: whatever is renamed, missing or in another order, the meaning stays, or a
//! sentence tells what was not understood.

use nalgebra::Matrix3;
use proptest::prelude::*;

use super::{CalibratedCamera, Calibration};
use crate::camera::CameraModel;
use crate::geometry::Frame;

const R: &str = "0.99980001, 0.0, 0.01999867, 0.0, 1.0, 0.0, -0.01999867, 0.0, 0.99980001";

/// Small calibrations as programs write them.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub(super) fn known() -> Vec<(&'static str, String)> {
    let matrix = |name: &str, rows: usize, columns: usize, data: &str| {
        format!(
            "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n"
        )
    };
    let k1 = "500., 0., 320., 0., 505., 240., 0., 0., 1.";
    let k2 = "490., 0., 310., 0., 495., 250., 0., 0., 1.";
    let d1 = "-0.3, 0.1, 0.001, -0.002, 0.01";
    let d2 = "-0.28, 0.09, 0.002, -0.001, 0.02";
    let opencv = [
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n".to_owned(),
        matrix("K1", 3, 3, k1),
        matrix("D1", 1, 5, d1),
        matrix("K2", 3, 3, k2),
        matrix("D2", 1, 5, d2),
        matrix("R", 3, 3, R),
        matrix("T", 3, 1, "-0.12, 0.001, 0.002"),
    ]
    .concat();
    let rows = |data: &str| {
        let numbers: Vec<&str> = data.split(", ").collect();
        let rows: Vec<String> = numbers.chunks(3).map(|row| format!("[{}]", row.join(", "))).collect();
        format!("[{}]", rows.join(", "))
    };
    let plain = |data: &str| data.replace("., ", ".0, ").replace("1.", "1.0").replace("1.00", "1.0");
    let json = format!(
        "{{\"mtx_left\": {},\n \"dist_left\": [[{d1}]],\n \"mtx_right\": {},\n \"dist_right\": [[{d2}]],\n \
         \"rotation_matrix\": {},\n \"translation_vector\": [[-0.12], [0.001], [0.002]],\n \
         \"image_size\": [640, 480],\n \"rms\": 0.3}}\n",
        rows(&plain(k1)),
        rows(&plain(k2)),
        rows(R),
    );
    let toml = |name: &str, offset: &str| {
        format!(
            "[{name}]\nsize = [640, 480]\nmatrix = [[500.0, 0.0, 320.0], [0.0, 505.0, 240.0], [0.0, 0.0, \
             1.0]]\ndistortions = [-0.3, 0.1, 0.0, 0.0, 0.01]\nrotation = [0.0, 0.01, 0.0]\ntranslation = \
             [{offset}, 0.2, 0.3]\n\n"
        )
    };
    let chained = |name: &str, rest: &str| {
        format!(
            "{name}:\n{rest}  camera_model: pinhole\n  intrinsics: [458.6, 457.3, 367.2, 248.4]\n  \
             distortion_model: radtan\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n  resolution: [752, \
             480]\n"
        )
    };
    let step = "  T_cn_cnm1:\n    - [1.0, 0.0, 0.0, -0.11]\n    - [0.0, 1.0, 0.0, 0.01]\n    - [0.0, 0.0, 1.0, \
                0.02]\n    - [0.0, 0.0, 0.0, 1.0]\n";
    let zed = |side: &str| {
        format!(
            "[{side}_CAM_HD]\nfx=700.5\nfy=701.5\ncx=640.25\ncy=360.5\nk1=-0.17\nk2=0.02\nk3=0.003\np1=-0.0006\np2=0.0002\n\n"
        )
    };
    let kitti = |k: usize| {
        format!(
            "S_0{k}: 1392 512\nK_0{k}: 984 0 690 0 981 233 0 0 1\nD_0{k}: -0.37 0.2 0.002 0.001 -0.07\nR_0{k}: 1 0 0 \
             0 1 0 0 0 1\nT_0{k}: -0.{k}37 0.0048 -0.0125\n"
        )
    };
    let element = |name: &str, rows: usize, columns: usize, data: &str| {
        let data = data.replace(',', "");
        format!(
            "<{name} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{columns}</cols>\n  <dt>d</dt>\n  \
             <data>\n    {data}</data></{name}>\n"
        )
    };
    let xml = [
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n".to_owned(),
        element("cameraMatrix1", 3, 3, k1),
        element("distCoeffs1", 5, 1, d1),
        element("cameraMatrix2", 3, 3, k2),
        element("distCoeffs2", 5, 1, d2),
        element("R", 3, 3, R),
        element("T", 3, 1, "-0.12, 0.001, 0.002"),
        "</opencv_storage>\n".to_owned(),
    ]
    .concat();
    let vins = "%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 752\nimage_height: 480\ndistortion_parameters:\n   \
                k1: -0.29\n   k2: 0.09\n   p1: 0.0008\n   p2: 0.0002\nprojection_parameters:\n   fx: 461.5\n   fy: \
                460.5\n   cx: 363.5\n   cy: 248.25\n";
    let euroc = "T_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, -1.0, 0.0, -0.02, 1.0, 0.0, 0.0, -0.06, 0.0, 0.0, 1.0, \
                 0.01, 0.0, 0.0, 0.0, 1.0]\nrate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: \
                 [458.5, 457.5, 367.5, 248.5]\ndistortion_model: radial-tangential\ndistortion_coefficients: [-0.28, \
                 0.07, 0.0002, 0.00002]\n";
    let ros = "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: \
               [500, 0, 320, 0, 505, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: \
               1\n  cols: 5\n  data: [-0.3, 0.1, 0.001, 0.002, 0.01]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  \
               data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: [490, 0, 320, \
               -49, 0, 490, 240, 0, 0, 0, 1, 0]\n";
    let orb = "%YAML:1.0\nCamera.type: \"PinHole\"\nCamera1.fx: 458.5\nCamera1.fy: 457.5\nCamera1.cx: \
               367.5\nCamera1.cy: 248.5\nCamera1.k1: -0.28\nCamera1.k2: 0.07\nCamera1.p1: 0.0002\nCamera1.p2: \
               0.00002\nCamera2.fx: 457.5\nCamera2.fy: 456.5\nCamera2.cx: 379.5\nCamera2.cy: 255.5\nCamera2.k1: \
               -0.28\nCamera2.k2: 0.07\nCamera2.p1: -0.0001\nCamera2.p2: -0.00003\nCamera.width: \
               752\nCamera.height: 480\nStereo.T_c1_c2: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n   \
               data:[1.0, 0.0, 0.0, 0.11, 0.0, 1.0, 0.0, 0.01, 0.0, 0.0, 1.0, 0.02, 0.0, 0.0, 0.0, 1.0]\n";
    vec![
        ("OpenCV", opencv),
        ("JSON", json),
        ("TOML", toml("cam_0", "0.5") + &toml("cam_1", "1.5")),
        ("Kalibr", chained("cam0", "") + &chained("cam1", step)),
        (
            "ZED",
            zed("LEFT")
                + &zed("RIGHT").replace("700.5", "699.5")
                + "[STEREO]\nBaseline=120.5\nTY=-0.02\nTZ=0.03\nCV_HD=0.005\nRX_HD=-0.002\nRZ_HD=0.001\n",
        ),
        ("KITTI", kitti(0) + &kitti(1).replace("984", "989")),
        (
            "KITTI, rectified",
            "P0: 721 0 609 0 0 721 172 0 0 0 1 0\nP1: 721 0 609 -387.5 0 721 172 0 0 0 1 0\nP2: 721 0 609 44.5 0 721 \
             172 0.2 0 0 1 0.003\n"
                .to_owned(),
        ),
        (
            "Middlebury",
            "cam0=[3997.684 0 1176.728; 0 3997.684 1011.728; 0 0 1]\ncam1=[3997.684 0 1307.839; 0 3997.684 1011.728; \
             0 0 1]\ndoffs=131.111\nbaseline=193.001\nwidth=2964\nheight=1988\n"
                .to_owned(),
        ),
        (
            "COLMAP",
            "1 SIMPLE_RADIAL 640 480 688.8 320 240 -0.127\n2 OPENCV 640 480 600 601 320 240 -0.1 0.02 0.001 0.002\n"
                .to_owned(),
        ),
        ("XML", xml),
        ("VINS", vins.to_owned()),
        ("EuRoC", euroc.to_owned()),
        ("ROS", ros.to_owned()),
        ("ORB-SLAM", orb.to_owned()),
    ]
}

/// What a calibration says.
type Said = [(CameraModel, Option<CameraModel>, Option<Frame>); 2];

/// What a calibration says of each camera, its pose, and its cameras.
type Read = (Said, Option<Matrix3<f64>>, [CalibratedCamera; 2]);

fn said(text: &str) -> Result<Read, String> {
    let pair = Calibration::parse(text)?.open_pair(None)?;
    let pose = CalibratedCamera::relative_pose(&pair);
    // Rotation and direction in one matrix, with the length in a corner that R alone leaves free.
    let pose = pose.map(|(pose, length)| {
        pose.rotation.matrix() + Matrix3::from_diagonal(&(pose.translation * length * 7.0))
    });
    Ok((pair.each_ref().map(|c| (c.model, c.reading.fisheye, c.frame)), pose, pair))
}

/// Returns whether a mutated text keeps its meaning, or says what is wrong.
fn is_told(original: &str, mutated: &str) -> bool {
    let (before, pose, _) = said(original).unwrap();
    match said(mutated) {
        Err(sentence) => !sentence.is_empty(),
        Ok((after, new_pose, pair)) => {
            let is_same = before == after && pose == new_pose;
            let is_open = pair.iter().any(|camera| camera.reading.fisheye.is_some());
            is_same || is_open || pair.iter().any(|camera| !camera.reading.unread.is_empty())
        }
    }
}

/// Returns the places of all names that stand before a colon or an equals sign, of sections, and of elements.
fn names(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let mut start = None;
    for (at, c) in text.char_indices() {
        match (start, is_name(c)) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                let rest = text[at..].trim_start_matches('"');
                let before = text[..from].chars().last();
                let is_section = before == Some('[') && c == ']';
                let is_element = before == Some('<') && text[from..at].parse::<f64>().is_err();
                let is_key = rest.trim_start_matches(' ').starts_with([':', '=']) && before != Some('%');
                let is_word = text[from..at].starts_with(char::is_alphabetic);
                if is_word && (is_key || is_section || is_element) && !text[from..at].starts_with("type_id") {
                    found.push(from..at);
                }
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Returns the places of all numbers.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        if c.is_whitespace() || "[],=;<>\"{}:".contains(c) {
            let word = &text[start..at];
            if word.parse::<f64>().is_ok() && word.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
                found.push(start..at);
            }
            start = at + c.len_utf8();
        }
    }
    found
}

fn without(text: &str, place: &std::ops::Range<usize>) -> String {
    let before = text[..place.start].trim_end_matches(' ');
    let after = text[place.end..].trim_start_matches(' ');
    // The number goes with its comma.
    match (before.strip_suffix(','), after.strip_prefix(',')) {
        (_, Some(after)) => format!("{before} {after}"),
        (Some(before), None) => format!("{before} {after}"),
        _ => format!("{before} {after}"),
    }
}

/// Returns the blocks of a text that begin without an indentation, and the lines that must stay first.
fn blocks(text: &str) -> (String, Vec<String>) {
    let has_sections = text.starts_with('[');
    let (mut head, mut blocks) = (String::new(), Vec::<String>::new());
    for line in text.lines() {
        let is_head = line.starts_with('%') || line.starts_with("---");
        let is_new = if has_sections { line.starts_with('[') } else { !line.starts_with([' ', '}', '{']) };
        if is_head {
            head.push_str(line);
            head.push('\n');
        } else if is_new || blocks.is_empty() {
            blocks.push(format!("{line}\n"));
        } else if let Some(block) = blocks.last_mut() {
            block.push_str(line);
            block.push('\n');
        }
    }
    (head, blocks)
}

fn renamed(text: &str, place: &std::ops::Range<usize>, name: &str) -> String {
    let old = &text[place.clone()];
    let changed = format!("{}{name}{}", &text[..place.start], &text[place.end..]);
    if text.starts_with("<?xml") {
        // The end of the element is renamed too: the next one of the old name.
        let from = place.start + name.len();
        let end = format!("</{old}>");
        return match changed[from..].find(&end) {
            Some(at) => format!("{}</{name}>{}", &changed[..from + at], &changed[from + at + end.len()..]),
            None => changed,
        };
    }
    changed
}

#[test]
fn known_calibrations_have_all_parts() {
    for (kind, text) in known() {
        let (_, _, pair) = said(&text).unwrap_or_else(|e| panic!("{kind}: {e}\n{text}"));
        for camera in &pair {
            let reading = &camera.reading;
            assert!(reading.unread.is_empty() && reading.fisheye.is_none(), "{kind}: {reading:?}");
        }
        assert!(names(&text).len() > 3 || kind == "COLMAP" || kind.contains("rectified"), "{kind}");
        assert!(numbers(&text).len() > 10, "{kind}");
    }
}

#[test]
fn every_name_and_every_number_matters_or_is_told() {
    for (kind, text) in known() {
        for place in names(&text) {
            let mutated = renamed(&text, &place, "zqxv");
            assert!(is_told(&text, &mutated), "{kind}, {} renamed:\n{mutated}", &text[place]);
        }
        for place in numbers(&text) {
            let mutated = without(&text, &place);
            assert!(
                is_told(&text, &mutated),
                "{kind}, {} at {} removed:\n{mutated}",
                &text[place.clone()],
                place.start
            );
        }
    }
}

proptest! {
    #[test]
    fn mutations_keep_the_meaning_or_are_told(
        which in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(), name in "zq[bcfgjvwxyz]{2,6}",
        kind in 0..3, order in any::<u64>(),
    ) {
        let all = known();
        let (format, text) = which.get(&all);
        let mutated = match kind {
            0 => {
                let places = names(text);
                if places.is_empty() { return Ok(()) }
                renamed(text, at.get(&places), &name)
            }
            1 => without(text, at.get(&numbers(text))),
            _ if text.starts_with(['<', '{']) => return Ok(()),
            _ => {
                let (head, mut blocks) = blocks(text);
                let count = blocks.len() as u64;
                blocks.rotate_left((order % count) as usize);
                let other = (order / count % count) as usize;
                blocks.swap(0, other);
                let mutated = format!("{head}{}", blocks.concat());
                let (before, pose, _) = said(text).unwrap();
                let (after, new_pose, _) = said(&mutated).map_err(|e| TestCaseError::fail(format!("{e}\n{mutated}")))?;
                prop_assert!(before == after && pose == new_pose, "{format}:\n{mutated}");
                mutated
            }
        };
        prop_assert!(is_told(text, &mutated), "{format}:\n{mutated}");
    }
}
