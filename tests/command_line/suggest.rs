use super::*;

/// Returns two views of one texture, the right one shifted by (7, −4) px.
fn moved() -> Pictures {
    let pictures = Pictures::new();
    // Softened cells of irregular brightness. Unlike waves, they do not repeat.
    let brightness = |x: i64, y: i64| {
        let cell = (x.div_euclid(6) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (y.div_euclid(5) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
        (cell.wrapping_mul(0x1656_67B1_9E37_79F9) >> 56) as i64
    };
    let soft = |x: i64, y: i64| {
        let sum: i64 = (-1..=1).flat_map(|v| (-1..=1).map(move |u| brightness(x + u, y + v))).sum();
        image::Luma([(sum / 9) as u8])
    };
    let view = |dx: i64, dy: i64| {
        image::GrayImage::from_fn(320, 240, |x, y| soft(i64::from(x) - dx, i64::from(y) - dy))
    };
    view(0, 0).save(pictures.path("left.png")).unwrap();
    view(7, -4).save(pictures.path("right.png")).unwrap();
    pictures
}

fn ask(pictures: &Pictures, rest: &[&str]) -> Output {
    let (left, right) = (pictures.text("left.png"), pictures.text("right.png"));
    run(&[&["suggest", &left, &right][..], rest].concat())
}

fn best(output: &Output) -> [f64; 2] {
    assert!(output.status.success(), "{}", text(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["clear"], true, "{result}");
    [0, 1].map(|k| result["candidates"][0]["position"][k].as_f64().unwrap())
}

#[test]
fn finds_the_match_either_way_with_and_without_f() {
    let pictures = moved();
    // A pure translation by (7, −4): F = [t]×.
    pictures.write("f.txt", "0 0 -4\n0 0 -7\n4 7 0\n");
    pictures.write("f.json", "{\"fundamental\": [[0, 0, -4], [0, 0, -7], [4, 7, 0]]}");
    let files = [pictures.text("f.txt"), pictures.text("f.json")];
    for f in [&[][..], &["--fundamental", &files[0]], &["--fundamental", &files[1]]] {
        let there = best(&ask(&pictures, &[&["--at", "150,120", "--json", "-"], f].concat()));
        assert!((there[0] - 157.0).hypot(there[1] - 116.0) < 0.1, "{there:?}");
        let back = ["--at", "157,116", "--in", "right", "--json", "-"];
        let back = best(&ask(&pictures, &[&back, f].concat()));
        assert!((back[0] - 150.0).hypot(back[1] - 120.0) < 0.1, "{back:?}");
    }
}

#[test]
fn prints_the_candidates_and_writes_the_same_file_on_any_number_of_threads() {
    let pictures = moved();
    let json = |threads: &str| {
        let file = pictures.text("result.json");
        let output = ask(&pictures, &["--at", "100.5,80", "--threads", threads, "--json", &file]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let table = text(&output.stdout);
        for words in
            ["Match of (100.5, 80) px of image 1 in image 2", "correlation", "Clear", "Reverse search"]
        {
            assert!(table.contains(words), "{words} in {table}");
        }
        std::fs::read_to_string(file).unwrap()
    };
    assert_eq!(json("1"), json("2"));
}

#[test]
fn works_on_a_built_in_pair() {
    let output = run(&["suggest", "--sample", "alley", "--at", "300,250"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("Ambiguity"));
}

#[test]
fn finds_the_match_in_an_image_that_is_turned_by_a_right_angle() {
    let pictures = Pictures::new();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    image::open(assets.join("courtyard-1.png")).unwrap().save(pictures.path("left.png")).unwrap();
    image::open(assets.join("courtyard-2.png")).unwrap().rotate90().save(pictures.path("right.png")).unwrap();
    let upright = best(&run(&["suggest", "--sample", "--at", "384,153", "--json", "-"]));
    // The image is 576 px high: (x, y) becomes (575 − y, x).
    let expected = [575.0 - upright[1], upright[0]];
    let there = best(&ask(&pictures, &["--at", "384,153", "--json", "-"]));
    assert!((there[0] - expected[0]).hypot(there[1] - expected[1]) < 0.5, "{there:?} for {expected:?}");
    let at = format!("{},{}", there[0], there[1]);
    let back = best(&ask(&pictures, &["--at", &at, "--in", "right", "--json", "-"]));
    assert!((back[0] - 384.0).hypot(back[1] - 153.0) < 0.5, "{back:?}");
}

#[test]
fn says_in_its_status_that_there_is_none() {
    let pictures = moved();
    let (left, flat) = (pictures.text("left.png"), pictures.text("flat.png"));
    fails(&["suggest", &flat, &left, "--at", "80,60"], 1, "nearly uniform");
    fails(&["suggest", &left, &flat, "--at", "80,60"], 1, "no place in the right image looks like");
    // Horizontal lines 500 px below those of image 1.
    pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 500\n");
    let f = pictures.text("f.txt");
    let right = pictures.text("right.png");
    fails(&["suggest", &left, &right, "--at", "80,60", "--fundamental", &f], 1, "misses the right image");
}

#[test]
fn refuses_bad_input() {
    let pictures = moved();
    let (left, right, dot) =
        (pictures.text("left.png"), pictures.text("right.png"), pictures.text("dot.png"));
    let words = pictures.text("words.txt");
    for (rest, message) in [
        (&["--at", "80"][..], "expected two numbers X,Y (pixels), found 1"),
        (&["--at", "80,nan"], "\"nan\" is not a finite number"),
        (&["--at", "400,60"], "outside the left image, which is 320×240"),
        (&["--at", "-9,60"], "outside the left image"),
        (&["--at", "80,60", "--in", "middle"], "invalid value 'middle'"),
        (&["--at", "80,60", "--fundamental", "no/such/file"], "no such file"),
        (&["--at", "80,60", "--fundamental", &words], "words.txt, line 1: \"This\" is not a finite number"),
        (&["--at", "80,60", "--json", "no/such/result.json"], "there is no folder"),
        (&[], "required arguments"),
    ] {
        fails(&[&["suggest", &left, &right][..], rest].concat(), 2, message);
    }
    fails(&["suggest", &left, &dot, "--at", "80,60"], 2, "the right image is too small: 1×1 pixels");
    fails(&["suggest", &left, "--at", "80,60"], 2, "required");
    fails(&["suggest", "--sample", "no-such-sample", "--at", "80,60"], 2, "no-such-sample");
}
