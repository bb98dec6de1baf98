//! Exchange of files with OpenCV itself.
//!
//! The tests need Python with `cv2`: the program named by `EPILINE_PYTHON`, or `python3`. Otherwise
//! they print "skipped", or fail if `EPILINE_REQUIRE_PYTHON` is set, as in `.ci/run`.

mod skipping;

use std::path::Path;
use std::process::Command;

use epiline::camera::{CameraModel, Lens, PicturesOf, RelativePose, ViewPair};
use epiline::geometry::{Camera, Frame, Point, PointPair};
use epiline::io::{CalibratedNote, Format, GeometryFile, ImageNote, Notation};
use nalgebra::{Matrix3, Matrix6, Point3, Rotation3, SMatrix, Vector3};
use serde_json::Value;
use skipping::python;

/// Runs the script and returns its output.
fn opencv(python: &Path, task: &str, path: &Path) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/interchange/opencv.py");
    let output = Command::new(python).arg(script).arg(task).arg(path).output().unwrap();
    assert!(output.status.success(), "{task}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns two cameras, noisy points, and homographies with entries of all magnitudes.
fn example() -> GeometryFile {
    let camera = |x: f64| {
        let up = Vector3::new(0.1, -1.0, 0.05);
        let principal = Point::new(383.5, 287.5);
        Camera::looking_at(Point3::new(x, 0.1, 0.3 * x), Point3::new(0.1, 0.0, 6.0), up, 800.0, principal)
            .unwrap()
    };
    let cameras = [camera(-0.4), camera(0.7)];
    let pair = |k: f64| {
        let x = Point3::new((k * 0.7).sin() * 2.0, (k * 1.3).cos(), 5.0 + (k * 0.31).sin());
        let [a, b] = cameras.map(|c| c.project(&x).unwrap());
        PointPair::new(a.x + 0.3 * (k * 5.1).sin(), a.y, b.x, b.y + 0.2 * (k * 3.7).cos())
    };
    GeometryFile {
        fundamental: Camera::fundamental(&cameras[0], &cameras[1]),
        cameras: Some(cameras),
        homographies: Some([
            Matrix3::new(1.01, 0.02, -3.5, -0.01, 1.0 / 3.0, 7.25, 1e-5, -2.5e-17, 1.0),
            Matrix3::new(0.97, 0.0, 1e6, 0.03, 1.02, -4.0, 3e-7, 1e-6, 1.0),
        ]),
        pairs: (0..40).map(|k| pair(f64::from(k))).collect(),
        images: Some(
            [("l", 768, 576), ("it's <r> & \"co\" \\ é.png", 1024, 3)]
                .map(|(name, width, height)| ImageNote::new(name.to_owned(), Frame::new(width, height))),
        ),
        ..GeometryFile::of(PicturesOf::Untold)
    }
}

fn rows<const R: usize, const C: usize>(matrix: &nalgebra::SMatrix<f64, R, C>) -> Value {
    Value::Array(matrix.row_iter().map(|row| row.iter().copied().collect::<Value>()).collect())
}

/// A file with a line less or a name changed gives the same geometry or a sentence, never another geometry.
#[test]
fn changed_files_never_give_another_geometry() {
    let expected = example();
    let f = *expected.fundamental.unwrap().matrix();
    for format in [Format::Json, Format::Text, Format::OpencvYaml] {
        let text = expected.to_text(format);
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for k in 0..lines.len() {
            let mut less = lines.clone();
            less.remove(k);
            let mut renamed = lines.clone();
            if let Some(at) = renamed[k].find(char::is_alphabetic) {
                renamed[k].insert(at, 'x');
            }
            let mut shorter = lines.clone();
            let cut = shorter[k].rfind([' ', ',']).unwrap_or(0);
            shorter[k].truncate(cut);
            for changed in [less, renamed, shorter] {
                let Ok((found, _)) = GeometryFile::parse(&changed.join("\n")) else { continue };
                let said = format!("{format:?}, line {}: {}", k + 1, lines[k]);
                if let Some(found) = found.geometry() {
                    assert!((found.matrix() - f).norm() < 1e-9, "{said}");
                }
                assert!(found.cameras.is_none() || found.cameras == expected.cameras, "{said}");
                assert!(
                    found.homographies.is_none() || found.homographies == expected.homographies,
                    "{said}"
                );
                assert!(found.pairs.iter().all(|pair| expected.pairs.contains(pair)), "{said}");
            }
        }
    }
}

/// Every number arrives bit for bit, and OpenCV's residual equals the one stated in the file.
#[test]
fn opencv_reads_what_we_write() {
    let Some(python) = python("cv2") else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut file = example();
    // The first image has a name with every character that could be misread.
    file.images = file.images.map(|[a, b]| [b, a]);
    let path = folder.path().join("geometry.yml");
    file.write(&path, Format::OpencvYaml).unwrap();
    let found = opencv(&python, "read", &path);
    println!("OpenCV {}: {}", found["version"], path.display());
    let matrices = &found["matrices"];
    let f = file.fundamental.unwrap();
    assert_eq!(matrices["F"], rows(f.matrix()));
    assert_eq!(matrices["e1"], rows(&f.epipole1()));
    assert_eq!(matrices["e2"], rows(&f.epipole2()));
    let ([p1, p2], [h1, h2]) = (file.cameras.unwrap(), file.homographies.unwrap());
    assert_eq!((&matrices["P1"], &matrices["P2"]), (&rows(p1.matrix()), &rows(p2.matrix())));
    assert_eq!((&matrices["H1"], &matrices["H2"]), (&rows(&h1), &rows(&h2)));
    for (name, of) in [("points1", 0), ("points2", 1)] {
        let points: Value =
            file.pairs.iter().map(|p| [p.point1, p.point2][of]).map(|p| vec![p.x, p.y]).collect();
        assert_eq!(matrices[name], points);
    }
    let number = |name: &str| found[name].as_f64().unwrap();
    assert_eq!(found["stated_pairs"], 40.0);
    assert!(number("mean") > 0.05 && number("max") > number("mean"));
    // Lines of OpenCV are in double precision, with different rounding.
    assert!((number("mean") - number("stated_mean")).abs() < 1e-9, "{found}");
    assert!((number("max") - number("stated_max")).abs() < 1e-9, "{found}");
    let name = &file.images.as_ref().unwrap()[0].name;
    assert_eq!(found["image1"], serde_json::json!([name, 1024.0, 3.0]));
    for length in found["annihilated"].as_array().unwrap() {
        assert!(length.as_f64().unwrap() < 1e-12);
    }
}

#[test]
fn numpy_loads_the_array_of_f() {
    let Some(python) = python("cv2") else { return };
    let folder = tempfile::tempdir().unwrap();
    let f = example().fundamental.unwrap();
    let path = folder.path().join("F.npy");
    std::fs::write(&path, epiline::io::fundamental_as_npy(&f, &PicturesOf::Original).unwrap()).unwrap();
    let script = "import json, sys, numpy; F = numpy.load(sys.argv[1]); print(json.dumps([str(F.dtype), F.flags['C_CONTIGUOUS'], F.tolist()]))";
    let output = Command::new(python).args(["-c", script]).arg(&path).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found, serde_json::json!(["float64", true, rows(f.matrix())]));
}

#[test]
fn numpy_loads_the_covariances_of_a_result() {
    let Some(python) = python("cv2") else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.npz");
    let covariance = SMatrix::<f64, 9, 9>::from_fn(|r, c| 1.0 / (1.0 + (r + c) as f64));
    let pose_covariance = Matrix6::from_fn(|r, c| 2.0 / (3.0 + (r * c) as f64));
    let rotation = Rotation3::from_euler_angles(0.1, -0.2, 0.3);
    let pose = RelativePose { rotation, translation: Vector3::new(0.6, 0.0, 0.8) };
    let file = GeometryFile {
        covariance: Some(covariance),
        calibrated: Some(CalibratedNote {
            pose: Some(pose),
            pose_covariance: Some(pose_covariance),
            ..CalibratedNote::default()
        }),
        ..example()
    };
    std::fs::write(&path, file.covariances_as_npz().unwrap()).unwrap();
    let script = "import json, sys, numpy; print(json.dumps({k: a.tolist() for k, a in numpy.load(sys.argv[1]).items()}))";
    let output = Command::new(python).args(["-c", script]).arg(&path).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let expected = serde_json::json!({
        "fundamental": rows(file.fundamental.unwrap().matrix()),
        "covariance": rows(&covariance),
        "rotation": rows(rotation.matrix()),
        "translation": [0.6, 0.0, 0.8],
        "pose_covariance": rows(&pose_covariance),
    });
    assert_eq!(found, expected);
    assert!(example().covariances_as_npz().unwrap_err().contains("Only refined results"));
}

#[test]
fn we_read_what_opencv_writes() {
    let Some(python) = python("cv2") else { return };
    let folder = tempfile::tempdir().unwrap();
    let written = opencv(&python, "write", folder.path());
    let (file, told) = GeometryFile::read(&folder.path().join("written.yml")).unwrap();
    assert_eq!(told, Format::OpencvYaml);
    // OpenCV writes 17 digits, so no precision is lost. The sign of F is normalised.
    let rows = |value: &Value| {
        let numbers: Vec<f64> = value
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|r| r.as_array().unwrap())
            .map(|v| v.as_f64().unwrap())
            .collect();
        numbers
    };
    let f = Matrix3::from_row_slice(&rows(&written["F"]));
    let found = *file.fundamental.unwrap().matrix();
    assert!(found == f || found == -f, "{found} {f}");
    let [h1, h2] = file.homographies.unwrap();
    assert_eq!(h1, Matrix3::from_row_slice(&rows(&written["H1"])));
    assert_eq!(h2, Matrix3::from_row_slice(&rows(&written["H2"])));
    let (points1, points2) = (rows(&written["points1"]), rows(&written["points2"]));
    let expected: Vec<_> =
        points1.chunks(2).zip(points2.chunks(2)).map(|(a, b)| (a[0], a[1], b[0], b[1])).collect();
    let found: Vec<_> = file.pairs.iter().map(|p| (p.point1.x, p.point1.y, p.point2.x, p.point2.y)).collect();
    // Single precision is written with nine digits, so double precision reads a nearby number.
    assert_eq!(found.len(), 12);
    for (a, b) in found.iter().zip(&expected) {
        assert_eq!((a.0, a.1), (b.0, b.1));
        assert!((a.2 - b.2).abs() < 1e-5 && (a.3 - b.3).abs() < 1e-5, "{a:?} {b:?}");
    }
    assert_eq!(GeometryFile::read(&folder.path().join("written.xml")).unwrap().0, file);
    // Compressed files are not text, and infinite numbers are not JSON: each gives an error message.
    for (name, words) in [("written.yml.gz", "not a text file"), ("written.json", "not valid JSON")] {
        let message = GeometryFile::read(&folder.path().join(name)).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}

/// The copied code, and the comments of exported YAML, lead true matches of the pictures onto their lines.
#[test]
fn copied_code_maps_matches_of_bent_pictures_onto_their_lines() {
    let Some(python) = python("cv2") else { return };
    let lenses: [(&str, &[f64]); 7] = [
        ("none", &[]),
        ("opencv", &[-0.28, 0.09, 1e-3, -5e-4]),
        ("opencv", &[0.4, -0.1, 0.0, 0.0, 0.01, 0.5, 0.02, 0.0]),
        ("opencv-fisheye", &[-0.02, 0.004, -0.003, 0.0005]),
        ("thin-prism-fisheye", &[-0.02, 0.004, 1e-3, -5e-4, 0.001, 0.0, 2e-4, 1e-4]),
        ("fov", &[0.9]),
        ("division", &[-0.25]),
    ];
    let frame = Frame::new(640, 480);
    // With a skew, the code does not use OpenCV's functions, which ignore it.
    for (skew, (model, coefficients)) in
        [0.0, 3.0].into_iter().flat_map(|skew| lenses.map(|lens| (skew, lens)))
    {
        let camera = |focal: f64, model: &str, coefficients: &[f64]| {
            let k = Matrix3::new(focal, skew, 325.5, 0.0, 1.01 * focal, 236.0, 0.0, 0.0, 1.0);
            CameraModel::new(&k, Lens::of_model(model, coefficients).unwrap()).unwrap()
        };
        // The two images have different lenses.
        let cameras = [camera(420.0, model, coefficients), camera(431.0, "division", &[-0.1])];
        let views = ViewPair::new(cameras.each_ref(), [frame; 2]).unwrap();
        let rotation = Rotation3::from_euler_angles(0.02, -0.06, 0.03);
        let pose = RelativePose { rotation, translation: Vector3::new(-0.96, 0.1, 0.26).normalize() };
        let seen = |k: i32| {
            let k = f64::from(k);
            let place =
                Vector3::new(3.0 * (1.7 * k).sin(), 2.2 * (2.3 * k).cos(), 4.0 + 2.0 * (0.9 * k).sin());
            let point1 = cameras[0].image_from_ray(&place)?;
            let point2 = cameras[1].image_from_ray(&(rotation * place + pose.translation))?;
            let is_seen = frame.contains(point1) && frame.contains(point2);
            is_seen.then_some([point1.x, point1.y, point2.x, point2.y])
        };
        let matches: Vec<[f64; 4]> = (0..200).filter_map(seen).collect();
        let (f, pictures) =
            (pose.fundamental(&views.calibrations()).unwrap(), PicturesOf::from(Some(&views)));
        let copied = Notation::NumPy.text(&f, &pictures, None);
        let file = GeometryFile { fundamental: Some(f), ..GeometryFile::of(pictures) };
        let yaml = file.to_text(Format::OpencvYaml);
        let start = yaml.find("# K1, D1").expect("the code of the mapping");
        let start = yaml[..start].rfind("# import cv2").filter(|at| at + 13 == start).unwrap_or(start);
        let code = yaml[start..].lines().take_while(|line| line.starts_with("# ") && !line.contains("x2'"));
        let code = code.map(|line| &line[2..]).collect::<Vec<_>>().join("\n");
        let rows = serde_json::to_string(&f.rows()).unwrap();
        for (name, code) in [("copied", copied), ("yaml", format!("F = np.array({rows})\n{code}"))] {
            let script = format!(
                "import numpy as np\n{code}\nm = np.array({matches:?})\na, b = undistorted1(m[:, :2]), undistorted2(m[:, \
                 2:])\na, b = [np.c_[p, np.ones(len(p))] for p in (a, b)]\nl, k = a @ F.T, b @ F\ne = np.abs(np.sum(b * l, \
                 axis=1))\nprint(max((e / np.hypot(l[:, 0], l[:, 1])).max(), (e / np.hypot(k[:, 0], k[:, 1])).max()))"
            );
            let output = Command::new(&python).args(["-c", &script]).output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            let told = String::from_utf8_lossy(&output.stdout).trim().parse::<f64>();
            let distance = told.unwrap_or_else(|_| panic!("{model} {name}: {error}\n{script}"));
            assert!(distance < 0.1, "{model} {name}, skew {skew}: {distance} px");
        }
    }
}
