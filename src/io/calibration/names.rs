//! Meaning of the names in a calibration.
//!
//! People write `distCoeffs1`, `dist_coeff_left`, `D_l`, `kc1` or `left: { D: … }`. A name is split into
//! words. Words like `dist` tell the role of the numbers, words like `camera` say nothing, and the
//! others tell the camera. Numbers of a name without a role are [`Role::Unknown`], and are named to
//! the user.

/// Role of the numbers of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Calibration matrix, or its four numbers `fx fy cx cy`.
    Matrix,
    /// Distortion coefficients.
    Distortion,
    /// Radial coefficients alone, as in MATLAB.
    Radial,
    /// Tangential coefficients alone, as in MATLAB.
    Tangential,
    /// Rotation matrix or rotation vector.
    Rotation,
    /// Rotation matrix of MATLAB, which acts on rows.
    RotationOfRows,
    Translation,
    /// Rotation and translation in one matrix.
    Transform(Direction),
    /// Rotation of the rectified camera.
    Rectification,
    /// Projection matrix of the rectified camera.
    Projection,
    /// Size of the images, width first.
    Size,
    FocalLengths,
    PrincipalPoint,
    /// One number of a matrix, of a distortion or of a size.
    Scalar(Scalar),
    /// Known, and without use here: errors, boards, `E`, `F`, `Q`, dates.
    Harmless,
    Unknown,
}

/// Meaning of a single number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    FocalX,
    FocalY,
    /// Focal length in both directions.
    Focal,
    PrincipalX,
    PrincipalY,
    Skew,
    Width,
    Height,
    /// `k1`, `k2`, …
    K(usize),
    /// `p1`, `p2`.
    P(usize),
    /// Parameter of a camera model that is not supported.
    Foreign,
}

/// What a transformation maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    /// World or inertial unit to camera.
    CameraFromWorld,
    /// Camera to world or inertial unit.
    WorldFromCamera,
    SecondFromFirst,
    FirstFromSecond,
}

/// A name, understood.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Meaning {
    pub role: Role,
    /// Words that tell the camera: `left`, `1`, or unknown words; empty for the only camera or the pair.
    pub camera: Vec<String>,
    /// Whether the name says `fisheye`.
    pub is_fisheye: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Class {
    Role(Role),
    /// Camera or unknown word.
    Other(String),
    Neutral,
    Harmless,
    /// Of the rectified pair, of an optimal new camera, or an inverse.
    Derived,
    Fisheye,
}

/// Words that say nothing beside the role: `camera_matrix`, `stereo_params`.
const NEUTRAL: &str = "camera cameras cam cams c matrix mat vector vec coefficients coefficient coeffs coeff coefs \
    coef params param parameters parameter calibration calib calibrations stereo the of model intr values value \
    data result results image img frame opencv pinhole lens extrinsic extrinsics pose relative raw sensor config info \
    length lengths point section and transform transformation";
/// Words of numbers that are known and have no use here.
const HARMLESS: &str = "rms rmse mse ret retval error errors err reprojection rpe baseline essential fundamental \
    disparity depth roi rois valid board pattern square squares checker checkerboard chessboard chess marker markers \
    aruco charuco grid tag tags num number count nr total frames nframes views images date time timestamp timeshift \
    stamp seq secs nsecs header binning version fps rate rgb flags flag avg average mean std stddev deviation deviations \
    criteria epsilon map maps mapx mapy rvecs tvecs vectors corners corner objpoints imgpoints keypoints exposure gain \
    id index serial overlaps homography bf b unit units world estimate dimensionality hfov vfov fov aspect calibrated \
    rotationcount ignore verified precision imu accelerometer gyroscope gyro confidence";
/// Words of other pictures: rectified ones, and those of an optimal new camera.
const DERIVED: &str = "rect rectified rectification rectify new newcameramtx newcameramatrix optimal undist \
    undistorted undistort inv inverse";
/// Sections about something else than a camera.
const APART: &str =
    "imu viewer board pattern roi header charuco checkerboard chessboard accelerometer gyroscope";
/// Words with a role. One letter has its role unless a longer word has one.
const ROLES: [(&str, Role); 38] = [
    ("k", Role::Matrix),
    ("m", Role::Matrix),
    ("mtx", Role::Matrix),
    ("intrinsic", Role::Matrix),
    ("intrinsics", Role::Matrix),
    ("d", Role::Distortion),
    ("dist", Role::Distortion),
    ("dists", Role::Distortion),
    ("distort", Role::Distortion),
    ("distortion", Role::Distortion),
    ("distortions", Role::Distortion),
    ("kc", Role::Distortion),
    ("r", Role::Rotation),
    ("rot", Role::Rotation),
    ("rotation", Role::Rotation),
    ("rmat", Role::Rotation),
    ("rvec", Role::Rotation),
    ("om", Role::Rotation),
    ("rodrigues", Role::Rotation),
    ("t", Role::Translation),
    ("trans", Role::Translation),
    ("translation", Role::Translation),
    ("tvec", Role::Translation),
    ("p", Role::Projection),
    ("proj", Role::Projection),
    ("projection", Role::Projection),
    ("radial", Role::Radial),
    ("tangential", Role::Tangential),
    ("size", Role::Size),
    ("resolution", Role::Size),
    ("fc", Role::FocalLengths),
    ("focal", Role::FocalLengths),
    ("cc", Role::PrincipalPoint),
    ("principal", Role::PrincipalPoint),
    ("e", Role::Harmless),
    ("f", Role::Harmless),
    ("q", Role::Harmless),
    ("h", Role::Harmless),
];
/// Names of one number, words joined.
const SCALARS: [(&str, Scalar); 32] = [
    ("fx", Scalar::FocalX),
    ("fu", Scalar::FocalX),
    ("mu", Scalar::FocalX),
    ("fy", Scalar::FocalY),
    ("fv", Scalar::FocalY),
    ("mv", Scalar::FocalY),
    ("f", Scalar::Focal),
    ("focal", Scalar::Focal),
    ("cx", Scalar::PrincipalX),
    ("cu", Scalar::PrincipalX),
    ("u0", Scalar::PrincipalX),
    ("ppx", Scalar::PrincipalX),
    ("cy", Scalar::PrincipalY),
    ("cv", Scalar::PrincipalY),
    ("v0", Scalar::PrincipalY),
    ("ppy", Scalar::PrincipalY),
    ("skew", Scalar::Skew),
    ("width", Scalar::Width),
    ("w", Scalar::Width),
    ("height", Scalar::Height),
    ("h", Scalar::Height),
    ("k1", Scalar::K(1)),
    ("k2", Scalar::K(2)),
    ("k3", Scalar::K(3)),
    ("k4", Scalar::K(4)),
    ("k5", Scalar::K(5)),
    ("k6", Scalar::K(6)),
    ("p1", Scalar::P(1)),
    ("p2", Scalar::P(2)),
    ("xi", Scalar::Foreign),
    ("gamma1", Scalar::Foreign),
    ("gamma2", Scalar::Foreign),
];

/// Returns the meaning of numbers from the names on the way to them, outermost first. `count` is how many
/// numbers there are; `None` for a number outside of a list.
pub(super) fn meaning(path: &[&str], count: Option<usize>) -> Meaning {
    let (name, sections) = path.split_last().map_or(("", path), |(name, sections)| (*name, sections));
    let (mut camera, mut inherited) = (Vec::new(), Role::Unknown);
    let (mut is_derived, mut is_fisheye) = (false, false);
    for section in sections {
        let words = words(section);
        let own = classes(&words, true);
        is_derived |= own.contains(&Class::Derived) || own.contains(&Class::Harmless);
        is_fisheye |= own.contains(&Class::Fisheye);
        let role = role_of(&words, &classes(&words, false), count);
        if role != Role::Unknown {
            inherited = role;
        }
        let is_transform = matches!(role, Role::Transform(_));
        let is_of_pair =
            matches!(role, Role::Transform(Direction::SecondFromFirst | Direction::FirstFromSecond));
        let is_kept = |word: &String| !is_of_pair && (!is_transform || is_camera(word));
        camera.extend(camera_of(&own).into_iter().filter(is_kept));
    }
    let words = words(name);
    let classes = classes(&words, false);
    if count.is_none()
        && let Some((scalar, rest)) = scalar(&words)
    {
        camera.extend(camera_of(&self::classes(&rest, true)));
        let role = if is_derived { Role::Harmless } else { Role::Scalar(scalar) };
        return Meaning { role, camera: directed(camera), is_fisheye };
    }
    is_fisheye |= classes.contains(&Class::Fisheye) && count.is_some();
    let mut own = camera_of(&classes);
    let role = match role_of(&words, &classes, count) {
        // A name that only tells the camera has the role of its section: `camera_matrix: { left: … }`.
        Role::Unknown if own.iter().all(|word| is_camera(word)) && count.is_some() => inherited,
        role => role,
    };
    match role {
        Role::Transform(Direction::SecondFromFirst | Direction::FirstFromSecond) => own.clear(),
        Role::Transform(_) => own.retain(|word| is_camera(word)),
        _ => {}
    }
    camera.extend(own);
    // A single number is no matrix and no list, whatever its name.
    let role = if count.is_none() && role != Role::Harmless { Role::Unknown } else { role };
    let role = if is_derived { Role::Harmless } else { role };
    Meaning { role, camera: directed(camera), is_fisheye }
}

/// Returns the name of a setting, its words joined, and the words that tell its camera.
pub(super) fn setting(path: &[String]) -> (String, Vec<String>) {
    let (name, sections) = path.split_last().map_or((String::new(), path), |(name, s)| (name.clone(), s));
    let mut camera: Vec<String> =
        sections.iter().flat_map(|section| camera_of(&classes(&words(section), true))).collect();
    let (own, name): (Vec<String>, Vec<String>) =
        words(&name).into_iter().partition(|word| is_camera(&named_side(word)));
    camera.extend(own.iter().map(|word| named_side(word)));
    camera.dedup();
    (name.concat(), camera)
}

/// Returns the role that the words of a name give to `count` numbers.
fn role_of(words: &[String], classes: &[Class], count: Option<usize>) -> Role {
    if let Some(direction) = count.filter(|count| matches!(count, 12 | 16)).and(transform(words)) {
        return Role::Transform(direction);
    }
    if classes.contains(&Class::Harmless) {
        return Role::Harmless;
    }
    let roles: Vec<Role> =
        classes.iter().filter_map(|c| if let Class::Role(role) = c { Some(*role) } else { None }).collect();
    let has = |role: Role| roles.contains(&role);
    let says = |some: &[&str]| words.iter().any(|word| some.contains(&word.as_str()));
    let specific = [Role::Radial, Role::Tangential, Role::Distortion];
    let role = match roles[..] {
        [] if matches!(count, Some(0 | 9)) && says(&["matrix", "mat"]) => Role::Matrix,
        [] if says(&["coefficients", "coefficient", "coeffs", "coeff", "coefs", "coef"]) => Role::Distortion,
        [] if count == Some(16) && words == ["a"] => Role::Harmless,
        [] => Role::Unknown,
        [first, ..] if roles.iter().all(|role| *role == first) => first,
        _ => match specific.into_iter().find(|role| has(*role)) {
            Some(role) => role,
            None => roles.iter().copied().find(|role| *role != Role::Matrix).unwrap_or(Role::Matrix),
        },
    };
    match role {
        Role::Harmless if count.is_some_and(|n| n != 9 && n != 16) => Role::Unknown,
        Role::Rotation | Role::Translation if matches!(count, Some(12 | 16)) => Role::Unknown,
        Role::Size if count != Some(2) => Role::Unknown,
        Role::Rotation | Role::Unknown | Role::Matrix if classes.contains(&Class::Derived) => {
            let is_rotation =
                role == Role::Rotation || matches!(count, Some(0 | 9)) && says(&["rectification", "rect"]);
            if is_rotation && !has(Role::Matrix) { Role::Rectification } else { Role::Harmless }
        }
        Role::Projection => Role::Projection,
        _ if classes.contains(&Class::Derived) => Role::Harmless,
        // MATLAB: RotationOfCamera2 acts on rows.
        Role::Rotation if says(&["of"]) => Role::RotationOfRows,
        role => role,
    }
}

/// Returns the scalar of a name, and the words that are left.
fn scalar(words: &[String]) -> Option<(Scalar, Vec<String>)> {
    let known = |name: &str| SCALARS.iter().find(|(known, _)| *known == name).map(|(_, scalar)| *scalar);
    if HARMLESS.split_whitespace().any(|word| words.iter().any(|w| w == word)) {
        return None;
    }
    for place in 0..words.len() {
        let [before, rest] = [&words[..place], &words[place..]];
        for length in (1..=rest.len().min(2)).rev() {
            let Some(scalar) = known(&rest[..length].concat()) else { continue };
            let left: Vec<String> = before.iter().chain(&rest[length..]).cloned().collect();
            let is_plain = left.iter().all(|word| {
                is_camera(&named_side(word)) || NEUTRAL.split_whitespace().any(|known| known == word)
            });
            return is_plain.then_some((scalar, left));
        }
    }
    None
}

/// Returns what a matrix of rotation and translation maps.
fn transform(words: &[String]) -> Option<Direction> {
    let mut pattern = String::new();
    let mut cameras = Vec::new();
    for word in words {
        match word.as_str() {
            "t" | "transform" => pattern.push('t'),
            "cam" | "camera" | "c" | "sensor" | "s" => pattern.push('c'),
            "imu" | "i" | "body" | "b" | "world" | "w" | "base" | "rig" | "robot" => pattern.push('w'),
            "bs" | "bc" | "ic" | "wc" => pattern.push_str("wc"),
            "tbc" | "twc" | "tic" => pattern.push_str("twc"),
            "cb" | "ci" | "cw" => pattern.push_str("cw"),
            "tcb" | "tcw" | "tci" => pattern.push_str("tcw"),
            "tlr" | "lr" => (pattern.push_str("tss"), cameras.extend([0, 1])).0,
            "trl" | "rl" => (pattern.push_str("tss"), cameras.extend([1, 0])).0,
            "to" => pattern.push('>'),
            "2" if matches!(pattern.as_str(), "c" | "w") => pattern.push('>'),
            "left" | "l" => (pattern.push('s'), cameras.push(0)).0,
            "right" | "r" => (pattern.push('s'), cameras.push(1)).0,
            "rt" => pattern.push_str("rt"),
            "extrinsic" | "extrinsics" => pattern.push('x'),
            "matrix" | "mat" => {}
            word => cameras.push(word.parse().ok()?),
        }
    }
    let pattern = pattern.replace("tts", "ts").replace('s', "c");
    let order = match cameras[..] {
        [a, b] if a < b => Some(true),
        [a, b] if a > b => Some(false),
        _ => None,
    };
    match (pattern.as_str(), order) {
        ("tcc", Some(true)) | ("c>c", Some(false)) => Some(Direction::FirstFromSecond),
        ("tcc", Some(false)) | ("c>c", Some(true)) => Some(Direction::SecondFromFirst),
        ("twc" | "wtc" | "c>w" | "tc>w", _) => Some(Direction::WorldFromCamera),
        ("tcw" | "ctw" | "w>c" | "tw>c" | "x" | "cx" | "xc" | "rt" | "crt" | "rtc", _) => {
            Some(Direction::CameraFromWorld)
        }
        _ => None,
    }
}

/// Returns what each word of a name says. The name of a section may be any word, so fewer words are
/// known there.
fn classes(words: &[String], is_section: bool) -> Vec<Class> {
    let known = |list: &str, word: &str| list.split_whitespace().any(|known| known == word);
    let role = |word: &str| ROLES.iter().find(|(name, _)| *name == word).map(|(_, role)| *role);
    let is_said = words.iter().any(|word| word.len() > 1 && role(word).is_some());
    let has_letter = words.iter().any(|word| word != "r" && role(word).is_some());
    // `cameraMatrixR` has no word with a role, and is no rotation either.
    let has = |some: &[&str]| words.iter().any(|word| some.contains(&word.as_str()));
    let is_matrix = has(&["camera", "cam"]) && has(&["matrix", "mat"]);
    let mut has_rotation = false;
    let class = |word: &String| match word.as_str() {
        "fisheye" => Class::Fisheye,
        // `r` is the right camera beside another role, and a rotation otherwise.
        "r" if is_section || is_said || is_matrix || has_letter || has_rotation => {
            Class::Other("right".to_owned())
        }
        "r" => {
            has_rotation = true;
            Class::Role(Role::Rotation)
        }
        word if word.len() == 1 && is_said && role(word).is_some() => Class::Neutral,
        word if known(DERIVED, word) => Class::Derived,
        word if known(APART, word) || !is_section && known(HARMLESS, word) => Class::Harmless,
        word if known(NEUTRAL, word) => Class::Neutral,
        other => match role(other) {
            Some(role) => Class::Role(role),
            None => Class::Other(named_side(other)),
        },
    };
    words.iter().map(class).collect()
}

fn camera_of(classes: &[Class]) -> Vec<String> {
    classes
        .iter()
        .filter_map(|c| if let Class::Other(word) = c { Some(word.clone()) } else { None })
        .collect()
}

/// Returns the common name of a side or of a number.
fn named_side(word: &str) -> String {
    let number = || word.parse::<u32>().map(|number| number.to_string());
    match word {
        "l" | "lft" => "left".to_owned(),
        "r" | "rgt" => "right".to_owned(),
        "first" => "1".to_owned(),
        "second" => "2".to_owned(),
        _ => number().unwrap_or_else(|_| word.to_owned()),
    }
}

/// Returns whether a word of a name tells a camera.
fn is_camera(word: &str) -> bool {
    ["left", "right"].contains(&word) || word.chars().all(|c| c.is_ascii_digit())
}

/// Replaces `left to right` by `forward`, and the reverse by `backward`. Removes what is said twice.
fn directed(mut words: Vec<String>) -> Vec<String> {
    words.dedup();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["left", "to", "right"] | ["0", "to", "1"] | ["1", "to", "2"] => vec!["forward".to_owned()],
        ["right", "to", "left"] | ["1", "to", "0"] | ["2", "to", "1"] => vec!["backward".to_owned()],
        _ => words,
    }
}

/// Splits a name into words in lower case: `distCoeffs1` is dist, coeffs, 1.
fn words(name: &str) -> Vec<String> {
    let characters: Vec<char> = name.chars().collect();
    let (mut words, mut word) = (Vec::new(), String::new());
    for (k, c) in characters.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| characters[k]);
        let after = characters.get(k + 1);
        let is_new = before.is_some_and(|before| {
            before.is_ascii_digit() != c.is_ascii_digit()
                || before.is_lowercase() && c.is_uppercase()
                || before.is_uppercase() && c.is_uppercase() && after.is_some_and(|next| next.is_lowercase())
        });
        if (is_new || !c.is_alphanumeric()) && !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if c.is_alphanumeric() {
            word.extend(c.to_lowercase());
        }
    }
    words.push(word);
    words.iter().filter(|word| !word.is_empty()).flat_map(|word| parted(word)).collect()
}

/// Parts words that are written together, if all of its parts are known: `cameramatrix`, `mtxl`, `KR`.
fn parted(word: &str) -> Vec<String> {
    let lists = [NEUTRAL, HARMLESS, DERIVED, "left right fisheye width height"];
    let is_known = |part: &str| {
        lists.iter().any(|list| list.split_whitespace().any(|known| known == part))
            || ROLES.iter().any(|(known, _)| *known == part)
    };
    let is_whole = is_known(word) || SCALARS.iter().any(|(known, _)| *known == word) || !word.is_ascii();
    if is_whole || word.len() < 2 {
        return vec![word.to_owned()];
    }
    // A side at the end may be one letter, as in `mtxl` and `KR`.
    let neutral = ["cam", "camera", "matrix", "mat", "coeffs", "coeff", "coefs", "coef"];
    let head_of = |part: &str| {
        let is_role = ROLES.iter().any(|(known, _)| *known == part && part.len() > 1);
        is_role || ["k", "d", "m"].contains(&part) || neutral.contains(&part)
    };
    for length in (1..word.len()).rev() {
        let (head, tail) = word.split_at(length);
        let is_long = length > 2 || ["k", "d", "m", "r", "t", "kc"].contains(&head);
        if !is_known(head) || !is_long {
            continue;
        }
        if ["l", "r"].contains(&tail) {
            if head_of(head) {
                return vec![head.to_owned(), tail.to_owned()];
            }
            continue;
        }
        let rest = parted(tail);
        if tail.len() > 2 && rest.iter().all(|part| is_known(part)) || rest.len() > 1 {
            return [vec![head.to_owned()], rest].concat();
        }
    }
    vec![word.to_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(path: &str, count: usize) -> (Role, String) {
        let path: Vec<&str> = path.split('/').collect();
        let found = meaning(&path, (count > 0).then_some(count));
        (found.role, found.camera.join(" "))
    }

    #[test]
    fn names_that_people_use_are_understood() {
        for (name, camera) in [
            ("K1", "1"),
            ("M2", "2"),
            ("K_02", "2"),
            ("cameraMatrix1", "1"),
            ("camera_matrix", ""),
            ("camera_matrix_left", "left"),
            ("cameraMatrixL", "left"),
            ("cameramatrixr", "right"),
            ("CAMERA_MATRIX_1", "1"),
            ("mtx_l", "left"),
            ("mtxR", "right"),
            ("mtxl", "left"),
            ("KL", "left"),
            ("K_r", "right"),
            ("r_K", "right"),
            ("left_K", "left"),
            ("camera_mat_left", "left"),
            ("LEFT/K", "left"),
            ("stereo_params/right/intrinsic", "right"),
            ("R/camera_matrix", "right"),
            ("camera_matrix/left", "left"),
            ("first_camera_matrix", "1"),
            ("intrinsics0", "0"),
            ("matrix", ""),
        ] {
            assert_eq!(of(name, 9), (Role::Matrix, camera.to_owned()), "{name}");
        }
        for (name, camera) in [
            ("D1", "1"),
            ("distCoeff1", "1"),
            ("distCoeffs2", "2"),
            ("distCoef", ""),
            ("dist_coeff", ""),
            ("distcoeffs", ""),
            ("dist_1", "1"),
            ("kc1", "1"),
            ("kc_left", "left"),
            ("d1", "1"),
            ("D_left", "left"),
            ("distl", "left"),
            ("distortion_coefficients", ""),
            ("distortions", ""),
            ("DR", "right"),
            ("left/distortion_coeffs", "left"),
            ("coeffs", ""),
        ] {
            assert_eq!(of(name, 5), (Role::Distortion, camera.to_owned()), "{name}");
        }
        for name in
            ["R", "rotation", "rotation_matrix", "R_stereo", "rotationMatrix", "rot_mat", "extrinsics/R"]
        {
            assert_eq!(of(name, 9), (Role::Rotation, String::new()), "{name}");
        }
        assert_eq!(of("R1", 9), (Role::Rotation, "1".to_owned()));
        assert_eq!(of("R_left", 9), (Role::Rotation, "left".to_owned()));
        assert_eq!(of("R_left_to_right", 9), (Role::Rotation, "forward".to_owned()));
        assert_eq!(of("RotationOfCamera2", 9), (Role::RotationOfRows, "2".to_owned()));
        for name in ["T", "translation_vector", "tvec", "trans_vec", "t"] {
            assert_eq!(of(name, 3), (Role::Translation, String::new()), "{name}");
        }
        for name in ["rectification_matrix", "R_rect", "rectification_transform"] {
            assert_eq!(of(name, 9), (Role::Rectification, String::new()), "{name}");
        }
        for (name, count) in
            [("E", 9), ("F", 9), ("Q", 16), ("rms", 0), ("board_size", 2), ("newcameramtx", 9)]
        {
            assert_eq!(of(name, count).0, Role::Harmless, "{name}");
        }
        for (name, count) in [("xyz1", 5), ("foo", 9), ("E", 5), ("quaternion", 4), ("euler", 3)] {
            assert_eq!(of(name, count).0, Role::Unknown, "{name}");
        }
    }

    #[test]
    fn single_numbers_and_transformations_are_understood() {
        assert_eq!(of("Camera1/fx", 0), (Role::Scalar(Scalar::FocalX), "1".to_owned()));
        assert_eq!(of("LEFT_CAM/k1", 0), (Role::Scalar(Scalar::K(1)), "left".to_owned()));
        assert_eq!(of("Camera/width", 0), (Role::Scalar(Scalar::Width), String::new()));
        assert_eq!(of("image_width", 0), (Role::Scalar(Scalar::Width), String::new()));
        assert_eq!(of("board_width", 0).0, Role::Harmless);
        assert_eq!(of("P2", 12), (Role::Projection, "2".to_owned()));
        for (name, direction) in [
            ("T_BS", Direction::WorldFromCamera),
            ("T_imu_cam", Direction::WorldFromCamera),
            ("T_cam_imu", Direction::CameraFromWorld),
            ("body_T_cam0", Direction::WorldFromCamera),
            ("Tbc", Direction::WorldFromCamera),
            ("T_c1_c2", Direction::FirstFromSecond),
            ("T_cam1_cam0", Direction::SecondFromFirst),
            ("left_to_right", Direction::SecondFromFirst),
            ("extrinsics", Direction::CameraFromWorld),
        ] {
            assert_eq!(of(name, 16).0, Role::Transform(direction), "{name}");
        }
    }
}
