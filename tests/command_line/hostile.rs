//! Malicious files and paths that are not files: one error line with little memory and time, and no
//! data lost.

use std::io::Write;
use std::time::{Duration, Instant};

use super::*;

/// Limit of the address space, KiB: enough for the program with its threads and a picture of
/// ordinary size.
const ADDRESSES: &str = "2000000";
/// Time limit for any hostile file, even on a busy machine.
const PATIENCE: Duration = Duration::from_mins(2);

/// Runs the program with limited address space, and kills it if it does not end.
fn limited(arguments: &[&str], variables: &[(&str, &str)]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -v {ADDRESSES}; exec \"$@\""), "sh", env!("CARGO_BIN_EXE_epiline")]);
    command.args(arguments).envs(variables.iter().copied()).env("RAYON_NUM_THREADS", "2");
    patiently(command)
}

/// Runs a command to its end, with a time limit.
fn patiently(mut command: Command) -> Output {
    command.env_remove("RUST_BACKTRACE").stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{command:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(3));
    }
    child.wait_with_output().unwrap()
}

/// Asserts one error line without control characters, and returns it.
#[track_caller]
fn sentence(output: &Output, status: i32, what: &str) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{what}: {}", &said[..said.len().min(500)]);
    let errors: Vec<_> = said.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{what}: {said}");
    assert!(errors[0].chars().count() < 900, "{what}: {} characters", errors[0].len());
    assert!(!errors[0].contains(char::is_control), "{what}: {:?}", errors[0]);
    assert!(!said.contains("panicked") && !said.contains("(os error"), "{what}: {said}");
    errors[0].to_owned()
}

/// Returns files whose headers claim billions of pixels, by format.
fn bombs() -> Vec<(&'static str, Vec<u8>)> {
    let side = 60_000u32;
    let mut bmp = vec![0; 54];
    bmp[..2].copy_from_slice(b"BM");
    bmp[10] = 54;
    bmp[14] = 40;
    for at in [18, 22] {
        bmp[at..at + 4].copy_from_slice(&side.to_le_bytes());
    }
    (bmp[26], bmp[28]) = (1, 24);
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    png.extend(side.to_be_bytes());
    png.extend(side.to_be_bytes());
    png.extend(b"\x08\x06\0\0\0\0\0\0\0");
    let mut tiff = b"II*\0\x08\0\0\0\x09\0".to_vec();
    // Width, height, bits, no compression, black is zero, one strip at offset 8, one sample, rows
    // per strip.
    for (tag, value) in [
        (256u16, side),
        (257, side),
        (258, 8),
        (259, 1),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, side),
        (279, 3_600_000_000),
    ] {
        tiff.extend(tag.to_le_bytes());
        tiff.extend(4u16.to_le_bytes());
        tiff.extend(1u32.to_le_bytes());
        tiff.extend(value.to_le_bytes());
    }
    tiff.extend([0; 4]);
    let mut jpeg = b"\xff\xd8\xff\xc0\0\x11\x08".to_vec();
    jpeg.extend(60_000u16.to_be_bytes());
    jpeg.extend(60_000u16.to_be_bytes());
    jpeg.extend(
        b"\x03\x01\x11\0\x02\x11\0\x03\x11\0\xff\xda\0\x0c\x03\x01\0\x02\0\x03\0\0\x3f\0\x12\xff\xd9",
    );
    let pnm = |start: &str| format!("{start}\n{side} {side}\n255\n").into_bytes();
    let mut webp = b"RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xfe\xff\0\xfe\xff\0".to_vec();
    webp.resize(64, 0);
    vec![
        ("bomb.bmp", bmp),
        ("bomb.png", png),
        ("bomb.tif", tiff),
        ("bomb.jpg", jpeg),
        ("bomb.pgm", pnm("P5")),
        ("bomb.ppm", pnm("P6")),
        ("bomb.webp", webp),
    ]
}

fn suggest<'a>(left: &'a str, right: &'a str) -> [&'a str; 5] {
    ["suggest", left, right, "--at", "40,40"]
}

#[test]
fn header_bombs_are_refused_before_anything_of_their_size_is_asked_for() {
    let pictures = Pictures::new();
    let right = pictures.text("right.png");
    for (name, bytes) in bombs() {
        std::fs::write(pictures.path(name), bytes).unwrap();
        let path = pictures.text(name);
        let said = sentence(&limited(&suggest(&path, &right), &[]), 2, name);
        assert!(said.contains(name), "{said}");
        if !matches!(name, "bomb.webp") {
            assert!(said.contains("60000 x 60000 pixels") && said.contains("limit is 250 million"), "{said}");
            assert!(said.contains("EPILINE_MAX_MEGAPIXELS=3600"), "{said}");
        }
        // With a higher limit, memory runs out: still one error line.
        let said = limited(&suggest(&path, &right), &[("EPILINE_MAX_MEGAPIXELS", "4000")]);
        sentence(&said, 2, name);
    }
}

#[test]
fn the_limit_of_pixels_can_be_moved() {
    let pictures = Pictures::new();
    let [left, right] = ["left.png", "right.png"].map(|name| pictures.text(name));
    let ask = |limit| limited(&suggest(&left, &right), &[("EPILINE_MAX_MEGAPIXELS", limit)]);
    let said = sentence(&ask("0.01"), 2, "small limit");
    assert!(said.contains("left.png has 160 x 120 pixels"), "{said}");
    assert!(sentence(&ask("many"), 2, "no number").contains("EPILINE_MAX_MEGAPIXELS is \"many\", expected"));
    assert_ne!(ask("0.02").status.code(), Some(2));
}

#[test]
fn a_cut_picture_is_told_and_read_only_if_asked() {
    let pictures = Pictures::new();
    let right = pictures.text("right.png");
    let whole = textured(160, 120, 1);
    image::DynamicImage::from(whole).to_rgb8().save(pictures.path("whole.webp")).unwrap();
    textured(160, 120, 1).save(pictures.path("whole.jpg")).unwrap();
    for name in ["whole.jpg", "whole.webp", "left.png"] {
        let bytes = std::fs::read(pictures.path(name)).unwrap();
        let cut = format!("cut-{name}");
        std::fs::write(pictures.path(&cut), &bytes[..bytes.len() * 2 / 3]).unwrap();
        let path = pictures.text(&cut);
        let said = sentence(&limited(&suggest(&path, &right), &[]), 2, name);
        assert!(said.contains("is damaged or incomplete"), "{said}");
    }
}

#[test]
fn grey_pictures_of_numbers_open() {
    use image::ImageEncoder;
    let pictures = Pictures::new();
    let values: Vec<f32> = textured(160, 120, 1).pixels().map(|p| f32::from(p.0[0]) / 255.0).collect();
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    // The library cannot encode grey floats. Colour floats test the reader equally.
    let rgb: Vec<u8> = values.iter().flat_map(|v| [*v * 700.0; 3]).flat_map(f32::to_ne_bytes).collect();
    assert_eq!(bytes.len() * 3, rgb.len());
    let file = std::fs::File::create(pictures.path("float.tif")).unwrap();
    let encoder = image::codecs::tiff::TiffEncoder::new(file);
    encoder.write_image(&rgb, 160, 120, image::ExtendedColorType::Rgb32F).unwrap();
    let [left, float] = ["left.png", "float.tif"].map(|name| pictures.text(name));
    let output = limited(&suggest(&left, &float), &[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    // Brightness outside 0 to 1 is scaled, not clipped to white.
    assert!(text(&output.stdout).contains("40.0"), "{}", text(&output.stdout));
}

/// Tests all files that once broke this program or another, if present.
#[test]
fn hostile_pictures_end_in_a_picture_or_a_sentence() {
    let Some(folder) = skipping::shared("hostile/pictures") else { return };
    for path in files(&folder) {
        let path = path.to_str().unwrap();
        let output = limited(&suggest(path, path), &[]);
        match output.status.code() {
            Some(0 | 1) => {}
            _ => drop(sentence(&output, 2, path)),
        }
    }
}

#[test]
fn hostile_texts_end_in_a_geometry_or_a_sentence() {
    let Some(folder) = skipping::shared("hostile/text") else { return };
    for path in files(&folder) {
        let path = path.to_str().unwrap();
        for arguments in [&["convert", path, "-o", "-", "--format", "json"][..], &["check", path]] {
            let started = Instant::now();
            let output = limited(arguments, &[]);
            match output.status.code() {
                Some(0 | 1) => {}
                _ => drop(sentence(&output, 2, path)),
            }
            assert!(started.elapsed().as_secs() < 20, "{path} took {:?}", started.elapsed());
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn long_and_obscene_words_are_cut_and_escaped() {
    let pictures = Pictures::new();
    let long = "x\u{1b}[31m\0".repeat(400_000);
    pictures.write("pairs.txt", &format!("1 2 3 4\n1 2 3 {long}\n"));
    pictures.write("f.json", &format!("{{\"F\": \"{}\"}}", "y".repeat(3_000_000)));
    pictures.write("f.xml", &format!("<{}>", "z".repeat(3_000_000)));
    pictures.write("f.yml", &format!("F: [{}]", "w".repeat(3_000_000)));
    for name in ["pairs.txt", "f.json", "f.xml", "f.yml"] {
        let path = pictures.text(name);
        let output = limited(&["convert", &path, "-o", "-", "--format", "text"], &[]);
        let said = sentence(&output, 2, name);
        assert!(said.contains(name) && said.chars().count() < 600, "{said}");
    }
    let odd = pictures.text("odd\u{1b}[2J\u{7}name.png");
    let right = pictures.text("right.png");
    std::fs::copy(pictures.path("cut.png"), &odd).unwrap();
    assert!(
        sentence(&limited(&suggest(&odd, &right), &[]), 2, "odd name")
            .contains("odd\\u{1b}[2J\\u{7}name.png")
    );
}

#[cfg(unix)]
mod what_is_no_file {
    use super::*;

    #[test]
    fn is_refused_without_waiting() {
        let pictures = Pictures::new();
        let [left, right, pipe] = ["left.png", "right.png", "pipe"].map(|name| pictures.text(name));
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for (name, target) in [("dangling", "nothing"), ("circle", "circle")] {
            std::os::unix::fs::symlink(target, pictures.path(name)).unwrap();
        }
        let [dangling, circle] = ["dangling", "circle"].map(|name| pictures.text(name));
        let f = pictures.text("f.txt");
        pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 0\n");
        let nowhere = "leads nowhere";
        for (odd, words) in [
            (&pipe[..], "named pipe"),
            ("/dev/zero", "it is a device"),
            (&dangling, nowhere),
            (&circle, nowhere),
            ("/", "it is a folder"),
        ] {
            for arguments in [
                &suggest(odd, &right)[..],
                &suggest(&left, odd),
                &["convert", odd, "-o", "-", "--format", "text"],
                &["check", &f, "--matches", odd],
                &["rectify", &left, &right, "--fundamental", odd, "--output", &pictures.text("out")],
            ] {
                let said = sentence(&limited(arguments, &[]), 2, odd);
                assert!(said.contains(words), "{arguments:?}: {said}");
            }
        }
        for (odd, words) in [
            (&pipe[..], "it is a pipe or a device"),
            ("/dev/null", "it is a pipe or a device"),
            (&dangling, nowhere),
            (&circle, nowhere),
        ] {
            let arguments = [&suggest(&left, &right)[..], &["--json", odd]].concat();
            let said = sentence(&limited(&arguments, &[]), 2, odd);
            assert!(said.contains(words), "{said}");
        }
    }

    #[test]
    fn is_read_when_it_is_piped_into_the_program() {
        let pictures = Pictures::new();
        let right = pictures.text("right.png");
        let piped = |arguments: &[&str], content: &[u8]| {
            let mut child = program(arguments)
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            child.stdin.take().unwrap().write_all(content).unwrap();
            child.wait_with_output().unwrap()
        };
        let left = std::fs::read(pictures.path("left.png")).unwrap();
        let output = piped(&suggest("/dev/stdin", &right), &left);
        assert_ne!(output.status.code(), Some(2), "{}", text(&output.stderr));
        let output = piped(&suggest("/dev/stdin", &right), &left[..left.len() / 2]);
        assert!(sentence(&output, 2, "half a picture").contains("damaged"), "{}", text(&output.stderr));
        let output = piped(&["convert", "/dev/stdin", "-o", "-", "--format", "json"], b"1 2 3 4\n5 6 7 8\n");
        assert!(output.status.success(), "{}", text(&output.stderr));
        let output = piped(&["convert", "/dev/stdin", "-o", "-", "--format", "json"], b"1 2 3 x\n");
        assert!(sentence(&output, 2, "no number").contains("line 1"), "{}", text(&output.stderr));
        let judge = ["judge", "--sample", "--rectified", "--matches", "/dev/stdin"];
        let output = piped(&judge, b"1 2 3 4\n5 6 7 8\n");
        assert!(sentence(&output, 2, "few matches").contains("2 were given"), "{}", text(&output.stderr));
    }
}

#[test]
fn nothing_that_is_read_is_written_over() {
    let pictures = Pictures::new();
    small_pairs(&pictures);
    pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 0\n");
    std::fs::hard_link(pictures.path("left.png"), pictures.path("hard.json")).unwrap();
    let named = |name: &str| pictures.text(name);
    let [left, right, f, hard, p] = ["left.png", "right.png", "f.txt", "hard.json", "p.txt"].map(named);
    let new = named("new.json");
    let lost = "it is one of the files that are read";
    let twice = "another result goes to the same file";
    let estimate = [&["estimate", &left, &right][..], &GOOD].concat();
    let cases: Vec<(Vec<&str>, &str)> = vec![
        ([&estimate[..], &["--json", &left]].concat(), lost),
        ([&estimate[..], &["--json", &hard]].concat(), lost),
        ([&estimate[..], &["--export", &right, "--format", "text"]].concat(), lost),
        ([&estimate[..], &["--json", &new, "--export", &new]].concat(), twice),
        ([&suggest(&left, &right)[..], &["--json", &right]].concat(), lost),
        ([&suggest(&left, &right)[..], &["--fundamental", &f, "--json", &f]].concat(), lost),
        (vec!["convert", &p, "-o", &p], lost),
        (vec!["check", &f, "--matches", &p, "--json", &p], lost),
        (vec!["check", &f, "--matches", &p, "--output", &f], lost),
        (vec!["check", &f, "--matches", &p, "--output", &new, "--json", &new], twice),
    ];
    let before: Vec<_> = [&left, &right, &f, &p].map(|path| std::fs::read(path).unwrap()).into();
    for (arguments, words) in cases {
        let said = sentence(&run(&arguments), 2, &arguments.join(" "));
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    let after: Vec<_> = [&left, &right, &f, &p].map(|path| std::fs::read(path).unwrap()).into();
    assert_eq!(before, after);
    assert!(!Path::new(&new).exists());
}

#[test]
fn matches_beyond_all_images_are_no_matches() {
    let pictures = Pictures::new();
    let rows = (0..20).map(|k| format!("{k}e290 1e290 {k}e289 -3e290\n")).collect::<Vec<_>>().concat();
    pictures.write("far.txt", &rows);
    pictures.write("f.txt", "0 0 0\n0 0 -1\n0 1 0\n");
    let [f, far] = ["f.txt", "far.txt"].map(|name| pictures.text(name));
    fails(&["check", &f, "--matches", &far], 2, "beyond 1e7 px");
}
