//! Geometry of views without distortion: every file names the lens, and true matches of the pictures lie on
//! the lines of the written `F` after the mapping that the file describes.

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::*;
use crate::camera::{CameraModel, Lens, PicturesOf, RelativePose, ViewPair};
use crate::geometry::{Frame, symmetric_epipolar_distance};

const FRAME: Frame = Frame { width: 640, height: 480 };

/// Models with a lens of usual strength.
fn lenses() -> [(&'static str, Vec<f64>); 6] {
    [
        ("opencv", vec![-0.28, 0.09, 1e-3, -5e-4]),
        ("opencv", vec![0.4, -0.1, 0.0, 0.0, 0.01, 0.5, 0.02, 0.0]),
        ("opencv-fisheye", vec![-0.02, 0.004, -0.003, 0.0005]),
        ("thin-prism-fisheye", vec![-0.02, 0.004, 1e-3, -5e-4, 0.001, 0.0, 2e-4, 1e-4]),
        ("fov", vec![0.9]),
        ("division", vec![-0.25]),
    ]
}

/// A pair seen through a lens: its views, `F` of the views, and true matches in the pictures.
fn scene(model: &str, coefficients: &[f64]) -> (ViewPair, FundamentalMatrix, Vec<PointPair>) {
    let camera = |focal: f64, x: f64| {
        let k = Matrix3::new(focal, 0.0, x, 0.0, focal * 1.01, 236.0, 0.0, 0.0, 1.0);
        CameraModel::new(&k, Lens::of_model(model, coefficients).unwrap()).unwrap()
    };
    let cameras = [camera(420.0, 325.5), camera(431.0, 311.25)];
    let views = ViewPair::new(cameras.each_ref(), [FRAME; 2]).unwrap();
    let pose = RelativePose {
        rotation: Rotation3::from_euler_angles(0.02, -0.06, 0.03),
        translation: Vector3::new(-0.96, 0.1, 0.26).normalize(),
    };
    let places = (0..200).map(|k| {
        let k = f64::from(k);
        Point3::new(3.0 * (1.7 * k).sin(), 2.2 * (2.3 * k).cos(), 4.0 + 2.0 * (0.9 * k).sin())
    });
    let seen = |place: Point3<f64>| {
        let second = pose.rotation * place.coords + pose.translation;
        let points = [cameras[0].image_from_ray(&place.coords)?, cameras[1].image_from_ray(&second)?];
        let [point1, point2] = points;
        points.iter().all(|p| FRAME.contains(*p)).then_some(PointPair { point1, point2 })
    };
    let matches: Vec<PointPair> = places.filter_map(seen).collect();
    assert!(matches.len() > 50, "{model}: {}", matches.len());
    (views, pose.fundamental(&views.calibrations()).unwrap(), matches)
}

fn example(views: &ViewPair, fundamental: FundamentalMatrix, matches: &[PointPair]) -> GeometryFile {
    GeometryFile {
        fundamental: Some(fundamental),
        pairs: matches.iter().filter_map(|pair| views.undistorted_from_original(pair)).collect(),
        ..GeometryFile::of(PicturesOf::from(Some(views)))
    }
}

/// Largest distance from their lines of matches of the pictures, after the mapping.
fn largest(file: &GeometryFile, matches: &[PointPair]) -> f64 {
    let (views, f) = (file.pictures.views().expect("the views are described"), file.geometry().unwrap());
    let distance =
        |pair: &PointPair| symmetric_epipolar_distance(&f, &views.undistorted_from_original(pair).unwrap());
    matches.iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn every_format_describes_the_lens_so_that_matches_lie_on_their_lines() {
    for (model, coefficients) in lenses() {
        let (views, f, matches) = scene(model, &coefficients);
        let raw = matches.iter().map(|pair| symmetric_epipolar_distance(&f, pair)).fold(0.0, f64::max);
        assert!(raw > 5.0, "{model}: the pictures themselves are off: {raw}");
        let file = example(&views, f, &matches);
        for format in Format::ALL {
            let text = file.to_text(format);
            for words in ["undistorted", model, &format!("{:?}", coefficients[0])] {
                assert!(text.contains(words), "{format:?}: {words} is not in\n{text}");
            }
            if format == Format::Matlab {
                continue;
            }
            let (found, _) = GeometryFile::parse(&text).unwrap();
            assert_eq!(found.pictures, file.pictures, "{format:?} {model}");
            assert!(largest(&found, &matches) < 1e-6, "{format:?} {model}");
            // The points come back as places in the pictures.
            let back = found.original_pairs().unwrap();
            let off = back.iter().zip(&matches).map(|(a, b)| (a.point1 - b.point1).norm());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{format:?} {model}");
        }
        let copied = Notation::Json.text(&f, &file.pictures, None);
        assert!(largest(&GeometryFile::parse(&copied).unwrap().0, &matches) < 1e-6, "{model}");
        for notation in [Notation::NumPy, Notation::Cpp, Notation::Matlab, Notation::Latex] {
            let text = notation.text(&f, &file.pictures, None);
            assert!(text.contains("not to the pictures") && text.contains(model), "{text}");
            let has_code = notation == Notation::Latex || text.contains("undistorted1");
            assert!(has_code, "{text}");
        }
    }
}

#[test]
fn pictures_that_are_not_known_are_refused_or_stay_unknown() {
    let (views, f, matches) = scene("division", &[-0.25]);
    let file = example(&views, f, &matches);
    let parse = |text: &str| GeometryFile::parse(text).map(|(file, _)| file.pictures);
    let json = file.to_text(Format::Json);
    assert_eq!(parse(&json.replace("\"undistorted\"", "\"original\"")).unwrap(), PicturesOf::Original);
    let other = parse(&json.replace("\"undistorted\"", "\"drawn\"")).unwrap_err();
    assert!(other.to_string().contains("called drawn"), "{other}");
    // An unknown lens stays a lens.
    for text in
        [json.replace("\"division\"", "\"tilted\""), json.replace("original_matrix", "matrix_of_picture")]
    {
        assert_eq!(parse(&text).unwrap(), PicturesOf::Undistorted(None));
        let points = GeometryFile::parse(&text).unwrap().0.original_pairs();
        assert!(points.unwrap_err().contains("does not describe"));
    }
    let rows = f.rows().map(|row| row.map(|v| format!("{v:e}")).join(" ")).join("\n");
    assert_eq!(parse(&rows).unwrap(), PicturesOf::Untold);
    assert!(crate::io::fundamental_as_npy(&f, &file.pictures).unwrap_err().contains("no room"));
    assert!(crate::io::fundamental_as_npy(&f, &PicturesOf::Original).is_ok());
}
