use super::*;
use epiline::synthetic::Sample;

/// Writes the true F of a built-in pair.
fn true_f(pictures: &Pictures, sample: Sample) -> String {
    let rows = sample.load().fundamental.rows();
    pictures.write("f.json", &format!("{{\"fundamental\": {rows:?}}}"));
    pictures.text("f.json")
}

fn description(folder: &str) -> Value {
    let text = std::fs::read_to_string(std::path::Path::new(folder).join("rectification.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn writes_pictures_with_their_homographies() {
    let pictures = Pictures::new();
    let f = true_f(&pictures, Sample::Courtyard);
    let folder = pictures.text("new/folder");
    let output =
        run(&["rectify", "--sample", "courtyard", "--fundamental", &f, "--output", &folder, "--maps"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("Method: planar, because the epipoles lie well outside both images"), "{said}");
    let description = description(&folder);
    assert_eq!(description["method"], "planar");
    assert!(description["measures"]["rows"]["mean"].as_f64().unwrap() < 0.01);
    let size = ["width", "height"].map(|k| description["size"][k].as_u64().unwrap() as u32);
    for name in ["left.png", "right.png"] {
        let picture = image::open(pictures.path("new/folder").join(name)).unwrap();
        assert_eq!([picture.width(), picture.height()], size);
        assert!(picture.color().has_alpha());
    }
    let both = image::open(pictures.path("new/folder/side-by-side.png")).unwrap();
    assert_eq!([both.width(), both.height()], [2 * size[0], size[1]]);
    // The homographies map true matches into the same row, under the convention stated in the file.
    let matrix = |name: &str| -> [[f64; 3]; 3] { serde_json::from_value(description[name].clone()).unwrap() };
    let (h1, h2) = (matrix("homography1"), matrix("homography2"));
    let row = |h: &[[f64; 3]; 3], x: f64, y: f64| {
        let dot = |r: &[f64; 3]| r[0] * x + r[1] * y + r[2];
        dot(&h[1]) / dot(&h[2])
    };
    for m in Sample::Courtyard.load().matches {
        assert!((row(&h1, m.point1.x, m.point1.y) - row(&h2, m.point2.x, m.point2.y)).abs() < 0.01);
    }
    let map = std::fs::read(pictures.path("new/folder/left-map.npy")).unwrap();
    assert!(map.starts_with(b"\x93NUMPY"));
    assert!(map.len() > (size[0] * size[1] * 8) as usize);
}

#[test]
fn an_epipole_inside_is_no_obstacle_to_auto_and_a_sentence_for_planar() {
    let pictures = Pictures::new();
    let f = true_f(&pictures, Sample::Alley);
    let folder = pictures.text("out");
    let arguments =
        ["rectify", "--sample", "alley", "--fundamental", &f, "--output", &folder, "--format", "tiff"];
    let output = run(&arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let description = description(&folder);
    assert_eq!(description["method"], "polar");
    let height = description["size"]["height"].as_u64().unwrap();
    assert_eq!(description["polar1"]["angles"].as_array().unwrap().len() as u64, height);
    assert_eq!(u64::from(image::open(pictures.path("out/left.tiff")).unwrap().height()), height);
    let output = run(&[&arguments[..], &["--method", "planar"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains(
        "the epipole lies inside the left image. Planar rectification is impossible: use the polar method"
    ));
}

#[test]
fn bad_input_is_a_sentence() {
    let pictures = Pictures::new();
    let f = true_f(&pictures, Sample::Alley);
    pictures.write("file", "no folder");
    let ask = |output: &str, rest: &[&str]| {
        let all = [&["rectify", "--sample", "alley", "--fundamental", &f, "--output", output], rest].concat();
        let output = run(&all);
        assert_eq!(output.status.code(), Some(2), "{rest:?}");
        text(&output.stderr)
    };
    let taken = ask(&pictures.text("file"), &[]);
    assert!(
        taken.contains("cannot make the folder") && taken.contains("there is a file of that name"),
        "{taken}"
    );
    assert!(ask(&pictures.text("o"), &["--max-megapixels", "0"]).contains("expected millions of pixels"));
    let small =
        ask(&pictures.text("o"), &["--method", "polar", "--max-megapixels", "0.0001", "--matches", "none"]);
    assert!(small.contains("no such file"), "{small}");
    let missing =
        run(&["rectify", "--sample", "--fundamental", "none.json", "--output", &pictures.text("o")]);
    assert!(text(&missing.stderr).contains("none.json"), "{}", text(&missing.stderr));
    assert_eq!(missing.status.code(), Some(2));
    assert!(!pictures.path("o").exists(), "nothing is made before it is known to work");
}

#[test]
fn the_images_themselves_are_never_replaced() {
    let pictures = Pictures::new();
    for name in ["left.png", "right.png"] {
        textured(160, 120, 3).save(pictures.path(name)).unwrap();
    }
    pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 0\n");
    let before = std::fs::read(pictures.path("left.png")).unwrap();
    let [left, right, f] = ["left.png", "right.png", "f.txt"].map(|name| pictures.text(name));
    let folder = pictures.0.path().to_str().unwrap();
    let ask = |output: &str| run(&["rectify", &left, &right, "--fundamental", &f, "--output", output]);
    for folder in [folder.to_owned(), format!("{folder}/.")] {
        let output = ask(&folder);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr).contains("it is one of the files that are read, which would be lost"),
            "{}",
            text(&output.stderr)
        );
    }
    assert_eq!(std::fs::read(pictures.path("left.png")).unwrap(), before);
    assert!(ask(&pictures.text("rectified")).status.success());
}

#[test]
fn lines_that_reach_only_one_image_are_a_sentence() {
    let pictures = Pictures::new();
    // Rank 2, but all lines in image 2 pass through its corner.
    pictures.write("f.txt", "0 0 0\n0 1 0\n0 0 1\n");
    let (f, folder) = (pictures.text("f.txt"), pictures.text("out"));
    for method in ["auto", "polar"] {
        let output =
            run(&["rectify", "--sample", "--fundamental", &f, "--output", &folder, "--method", method]);
        if output.status.success() {
            let text = std::fs::read_to_string(pictures.path("out/rectification.json")).unwrap();
            assert!(!text.contains("null,\n    \"radius_step\""), "{text}");
        } else {
            assert_eq!(output.status.code(), Some(1));
            assert!(text(&output.stderr).contains("no epipolar line crosses both images"));
        }
    }
}
