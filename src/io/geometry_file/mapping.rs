//! Source code that leads from places in a picture to the view without distortion that `F` belongs to.
//!
//! OpenCV's own function serves its own models in C++. All other cases are written out: from
//! coordinates without unit, `x, y`, to those without distortion. Models without a closed inverse iterate
//! `u ← (x − g(u)) / f(u)`.

use std::fmt::Write;

use super::coordinates::numbers;
use crate::camera::{LensModel, UndistortedView, ViewPair};

/// Language of the code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    Python,
    Cpp,
    /// MATLAB and Octave.
    Matlab,
}

/// Repetitions of an iteration without a closed inverse. An error that falls by 20 % each time is below
/// 1e-9 of the first one after them.
const REPETITIONS: usize = 100;

/// A step of a formula.
enum Step {
    Set(&'static str, String),
    Repeat(Vec<Step>),
}

/// Returns code that defines the mappings of both images: `undistorted1` and `undistorted2`. In MATLAB they
/// are rows made from the rows of `picture1` and `picture2`. Pixels are counted from `origin`. Empty for a lens
/// without a common name.
pub(super) fn mapping(views: &ViewPair, language: Language, origin: f64) -> String {
    let mut text = String::new();
    if views.views.iter().any(|view| view.camera().lens().named().0 == LensModel::Other) {
        return text;
    }
    for (view, k) in views.views.iter().zip(1..) {
        text += &of_view(view, k, language, origin);
    }
    text
}

fn of_view(view: &UndistortedView, k: usize, language: Language, origin: f64) -> String {
    let (model, coefficients) = view.camera().lens().named();
    let call = function(view, language);
    let mut coefficients = coefficients;
    if model == LensModel::OpenCv && call.is_none() {
        // The formula has all twelve.
        coefficients.resize(12, 0.0);
    }
    let coefficients = numbers(&coefficients, ", ");
    let [own, of_view] = [view.camera().calibration(), *view.calibration()].map(|matrix| {
        let rows = [0, 1, 2].map(|r| {
            let shift = if r < 2 { origin } else { 0.0 };
            numbers(&[matrix[(r, 0)], matrix[(r, 1)], matrix[(r, 2)] + shift], ", ")
        });
        match language {
            Language::Python => format!("np.array([[{}]])", rows.join("], [")),
            Language::Cpp => rows.join(", "),
            Language::Matlab => format!("[{}]", rows.join("; ")),
        }
    });
    let name = model.name();
    let mut text = match language {
        Language::Python => format!(
            "K{k}, D{k} = {own}, np.array([{coefficients}])  # of picture {k}, model {name}\nView{k} = {of_view}  # K of \
             view {k}\ndef undistorted{k}(points):  # N x 2 places in picture {k}\n"
        ),
        Language::Cpp => format!(
            "const cv::Matx33d K{k}({own});  // of picture {k}, model {name}\nconst std::vector<double> D{k}{{{coefficients}}};\n\
             const cv::Matx33d View{k}({of_view});  // K of view {k}\nstd::vector<cv::Point2d> undistorted{k}(const \
             std::vector<cv::Point2d>& points) {{  // places in picture {k}\n    std::vector<cv::Point2d> mapped;\n"
        ),
        Language::Matlab => format!(
            "K{k} = {own}; D{k} = [{coefficients}];  % of picture {k}, model {name}\nView{k} = {of_view};  % K of view \
             {k}\npicture{k} = zeros(0, 2);  % rows x y of picture {k}: put yours here\n"
        ),
    };
    if let Some(call) = call {
        text += &call.replace('#', &k.to_string());
        return text;
    }
    let alike = match model {
        LensModel::OpenCv => "cv2.undistortPoints",
        LensModel::OpenCvFisheye => "cv2.fisheye.undistortPoints",
        _ => "",
    };
    if language == Language::Python && !alike.is_empty() {
        let _ = writeln!(
            text,
            "    # {alike}(points, K{k}, D{k}, P=View{k}) with enough iterations for strong lenses."
        );
    }
    let steps = formula(model);
    let mut body = String::new();
    match language {
        Language::Python => {
            write_steps(&mut body, &steps, language, "    ");
            let _ = write!(
                text,
                "    points = np.float64(points).reshape(-1, 2)\n    x, y = (np.c_[points, np.ones(len(points))] @ \
                 np.linalg.inv(K{k}).T)[:, :2].T\n    u, v = x, y\n{body}    return (np.c_[x, y, np.ones(len(x))] @ \
                 View{k}.T)[:, :2]\n"
            );
        }
        Language::Cpp => {
            write_steps(&mut body, &steps, language, "        ");
            let _ = write!(
                text,
                "    for (const auto& p : points) {{\n        const cv::Vec3d n = K{k}.inv() * cv::Vec3d(p.x, p.y, 1);\n        \
                 double x = n[0], y = n[1], u = x, v = y, s = 0, f = 1, g = 0, h = 0;\n{body}        const cv::Vec3d q = \
                 View{k} * cv::Vec3d(x, y, 1);\n        mapped.emplace_back(q[0], q[1]);\n    }}\n    return mapped;\n}}\n"
            );
        }
        Language::Matlab => {
            write_steps(&mut body, &steps, language, "");
            let _ = write!(
                text,
                "n = [picture{k}, ones(size(picture{k}, 1), 1)] / K{k}';\nx = n(:, 1); y = n(:, 2); u = x; v = \
                 y;\n{body}undistorted{k} = [x, y, ones(size(x))] * View{k}(1:2, :)';  % belongs to F\n"
            );
        }
    }
    text.replace("D#", &format!("D{k}"))
}

/// Returns the call of OpenCV for its own models in C++. Its functions ignore a skew. In Python the number of
/// iterations has another place in each version of OpenCV, so the formula is written out there.
fn function(view: &UndistortedView, language: Language) -> Option<String> {
    let has_skew = view.camera().calibration()[(0, 1)] != 0.0;
    let call = match (language, view.camera().lens().named().0) {
        _ if has_skew => return None,
        (Language::Cpp, LensModel::OpenCv) => {
            "    // Enough iterations for strong lenses.\n    cv::undistortPoints(points, mapped, K#, D#, cv::noArray(), \
             View#, cv::TermCriteria(3, 100, 1e-12));\n    return mapped;\n}\n"
        }
        (Language::Cpp, LensModel::OpenCvFisheye) => {
            "    cv::fisheye::undistortPoints(points, mapped, K#, D#, cv::noArray(), View#);\n    return mapped;\n}\n"
        }
        _ => return None,
    };
    Some(call.to_owned())
}

/// Returns the steps from `x, y` with distortion to `x, y` without. `D#[k]` is coefficient `k`, from 0.
fn formula(model: LensModel) -> Vec<Step> {
    use Step::{Repeat, Set};
    let set = |name: &'static str, formula: &str| Set(name, formula.to_owned());
    // Above zero, so that nothing is divided by zero in the middle.
    let radius = "sqrt(x*x + y*y) + 1e-300";
    let scaled = || [set("x", "x*f"), set("y", "y*f")];
    let (poly, bend) = match model {
        LensModel::Ideal | LensModel::Other => return Vec::new(),
        LensModel::Division => {
            return [set("f", "1/(1 + D#[0]*(x*x + y*y))")].into_iter().chain(scaled()).collect();
        }
        LensModel::FieldOfView => {
            let factor = set("f", "tan(D#[0]*s)/(2*tan(D#[0]/2)*s)");
            return [set("s", radius), factor].into_iter().chain(scaled()).collect();
        }
        LensModel::OpenCvFisheye => {
            let angle = "s/(1 + g*(D#[0] + g*(D#[1] + g*(D#[2] + g*D#[3]))))";
            let around = Repeat(vec![set("g", "f*f"), set("f", angle)]);
            let steps = [set("s", radius), set("f", "s"), around, set("f", "tan(f)/s")];
            return steps.into_iter().chain(scaled()).collect();
        }
        LensModel::OpenCv => (
            "(1 + s*(D#[0] + s*(D#[1] + s*D#[4])))/(1 + s*(D#[5] + s*(D#[6] + s*D#[7])))",
            ["D#[8]*s + D#[9]*s*s", "D#[10]*s + D#[11]*s*s"],
        ),
        LensModel::ThinPrismFisheye => {
            ("1 + s*(D#[0] + s*(D#[1] + s*(D#[4] + s*D#[5])))", ["D#[6]*s", "D#[7]*s"])
        }
    };
    let around = vec![
        set("s", "u*u + v*v"),
        set("f", poly),
        Set("g", format!("2*D#[2]*u*v + D#[3]*(s + 2*u*u) + {}", bend[0])),
        Set("h", format!("D#[2]*(s + 2*v*v) + 2*D#[3]*u*v + {}", bend[1])),
        set("u", "(x - g)/f"),
        set("v", "(y - h)/f"),
    ];
    let mut steps = vec![Repeat(around), set("x", "u"), set("y", "v")];
    if model == LensModel::ThinPrismFisheye {
        steps.extend([set("s", radius), set("f", "tan(s)/s")]);
        steps.extend(scaled());
    }
    steps
}

fn write_steps(text: &mut String, steps: &[Step], language: Language, indent: &str) {
    for step in steps {
        match (step, language) {
            (Step::Set(name, formula), Language::Python) => {
                let formula = formula.replace("sqrt(", "np.sqrt(").replace("tan(", "np.tan(");
                let _ = writeln!(text, "{indent}{name} = {formula}");
            }
            (Step::Set(name, formula), Language::Cpp) => {
                let formula = formula.replace("sqrt(", "std::sqrt(").replace("tan(", "std::tan(");
                let _ = writeln!(text, "{indent}{name} = {formula};");
            }
            (Step::Set(name, formula), Language::Matlab) => {
                let formula = formula.replace('*', ".*").replace('/', "./");
                let _ = writeln!(text, "{indent}{name} = {};", counted_from_one(&formula));
            }
            (Step::Repeat(steps), _) => {
                let (head, end) = match language {
                    Language::Python => (format!("for _ in range({REPETITIONS}):"), ""),
                    Language::Cpp => (format!("for (int k = 0; k < {REPETITIONS}; ++k) {{"), "}\n"),
                    Language::Matlab => (format!("for k = 1:{REPETITIONS}"), "end\n"),
                };
                let _ = writeln!(text, "{indent}{head}");
                write_steps(text, steps, language, &format!("{indent}    "));
                if !end.is_empty() {
                    let _ = write!(text, "{indent}{end}");
                }
            }
        }
    }
}

/// Replaces `D#[k]` by MATLAB's `D#(k + 1)`.
fn counted_from_one(formula: &str) -> String {
    let mut parts = formula.split("D#[");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (index, rest) = part.split_once(']').unwrap_or((part, ""));
        let index = index.parse::<usize>().map_or(1, |k| k + 1);
        let _ = write!(text, "D#({index}){rest}");
    }
    text
}
