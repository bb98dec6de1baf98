//! Design tokens: every colour, width and size of the window.
//!
//! One colour has one meaning, and no meaning has a colour alone: green lines are solid, amber ones dashed, red ones
//! dotted, violet is not checked, white is the truth, yellow is the cursor and what the user looks at. Buttons and
//! selections are grey. Colours over the images are the same in both themes, as the images are. A dark halo keeps
//! them legible on bright and dark pictures.

use egui::{
    Color32, CornerRadius, FontDefinitions, FontFamily, FontId, Margin, Shadow, Stroke, TextStyle, Theme,
    Visuals,
};

use crate::app::model::verdict::LineLook;

/// Lines of a reliable geometry.
pub const ESTIMATED: Color32 = Color32::from_rgb(31, 199, 152);
/// Lines of a doubtful geometry.
pub const DOUBTFUL: Color32 = Color32::from_rgb(240, 163, 32);
/// Lines of an unreliable geometry.
pub const UNRELIABLE: Color32 = Color32::from_rgb(240, 101, 91);
/// Uncertainty bands around the lines.
pub const BAND: Color32 = Color32::from_rgb(30, 130, 96);
/// Lines and matches of the true geometry.
pub const TRUE: Color32 = Color32::from_rgb(255, 255, 255);
/// Line pair of the cursor.
pub const HOVER: Color32 = Color32::from_rgb(244, 239, 110);
/// Dark edge around everything drawn over an image.
pub const HALO: Color32 = Color32::from_black_alpha(150);
pub const LABEL_FILL: Color32 = Color32::from_black_alpha(190);
/// Tint of the pictures during a replay.
pub const DIMMED: Color32 = Color32::from_gray(191);
pub const SELECTED: Color32 = Color32::WHITE;
/// Radius of a handle, screen points.
pub const HANDLE_RADIUS: f32 = 6.5;
/// Pinned line pairs, which have numbers.
pub const PINNED: Color32 = HOVER;

/// What is not checked: candidates, hypotheses, matches, imported geometries, suggestions.
pub const UNCHECKED: Color32 = Color32::from_rgb(184, 113, 242);
/// Lines of a round trip.
pub const FORWARD: Color32 = Color32::from_rgb(143, 180, 255);
/// Motion in a frame of a sequence.
pub const MOVING: Color32 = Color32::from_rgb(255, 120, 0);

/// Left and right camera of the scene.
pub const CAMERAS: [Color32; 2] = [Color32::from_rgb(226, 174, 142), Color32::from_rgb(141, 181, 227)];

/// Guide lines over rectified pictures.
pub const GUIDE: Color32 = Color32::from_rgba_premultiplied(110, 110, 110, 131);

/// Distance within which a press grabs a handle, screen points.
pub const GRAB_RADIUS: f32 = 11.0;
/// Width of an ordinary line, screen points.
pub const LINE_WIDTH: f32 = 1.8;
/// Width of an emphasised line, screen points.
pub const STRONG_LINE_WIDTH: f32 = 3.0;
/// Opacity of a result for earlier points.
pub const STALE_OPACITY: f32 = 0.45;
/// Space between neighbouring elements, screen points.
pub const GAP: f32 = 8.0;
/// Height of the bar above the pictures, screen points.
pub const TOP_BAR: f32 = 40.0;
/// Height of the bar at the bottom of the window, screen points.
pub const STATUS_BAR: f32 = 22.0;
/// Height of a row of the dock, screen points.
pub const ROW: f32 = 20.0;
/// Width kept free beside scrolled texts, screen points, which the scroll bar would cover.
pub const SCROLL_BAR: f32 = 8.0;
pub const CAPTION: f32 = 11.5;
/// Size of the figures of the verdict.
pub const FIGURE: f32 = 14.5;
/// Size of the word of the verdict.
pub const VERDICT: f32 = 18.0;

/// The pairs `p` and `q`.
pub const PAIRS: [Color32; 2] = [Color32::from_rgb(127, 239, 252), Color32::from_rgb(216, 120, 180)];
const OTHERS: Color32 = Color32::from_rgb(228, 228, 228);

/// Returns the colour of a pair: one each for `p` and `q`, and one for all others.
pub fn pair_color(pair: usize) -> Color32 {
    PAIRS.get(pair).copied().unwrap_or(OTHERS)
}

/// Returns the colour of epipolar lines in the look of their verdict.
pub fn line_color(look: LineLook) -> Color32 {
    match look {
        LineLook::Solid => ESTIMATED,
        LineLook::Other => UNCHECKED,
        LineLook::Dashed => DOUBTFUL,
        LineLook::Dotted | LineLook::Hidden => UNRELIABLE,
    }
}

/// Colours of the window around the images.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    pub canvas: Color32,
    /// The element that needs attention next.
    pub accent: Color32,
    /// Text on the accent colour.
    pub on_accent: Color32,
    pub good: Color32,
    pub caution: Color32,
    pub bad: Color32,
    pub message_fill: Color32,
}

pub fn palette(visuals: &Visuals) -> Palette {
    if visuals.dark_mode {
        Palette {
            canvas: Color32::from_gray(17),
            accent: Color32::from_rgb(228, 228, 228),
            on_accent: Color32::from_rgb(27, 28, 31),
            good: Color32::from_rgb(31, 199, 152),
            caution: Color32::from_rgb(240, 163, 32),
            bad: Color32::from_rgb(240, 101, 91),
            message_fill: Color32::from_rgb(52, 34, 32),
        }
    } else {
        Palette {
            canvas: Color32::from_gray(206),
            accent: Color32::from_rgb(28, 28, 28),
            on_accent: Color32::from_rgb(247, 247, 247),
            good: Color32::from_rgb(20, 87, 63),
            caution: Color32::from_rgb(146, 101, 16),
            bad: Color32::from_rgb(122, 26, 18),
            message_fill: Color32::from_rgb(255, 240, 237),
        }
    }
}

/// Returns the fonts of all text. The window adds fonts of the system for letters that these lack; figures do not, so
/// that they are the same on any machine.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    if let Some(family) = fonts.families.get_mut(&FontFamily::Proportional) {
        // The text font lacks many mathematical signs and arrows.
        family.push("Hack".to_owned());
    }
    fonts
}

/// Sets fonts, sizes, spacing and both themes.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.all_styles_mut(|style| {
        for (text, size) in [
            (TextStyle::Small, CAPTION),
            (TextStyle::Body, 13.0),
            (TextStyle::Button, 13.0),
            (TextStyle::Heading, 17.0),
        ] {
            style.text_styles.insert(text, FontId::proportional(size));
        }
        style.text_styles.insert(TextStyle::Monospace, FontId::monospace(13.0));
        style.spacing.item_spacing = egui::vec2(GAP, 4.0);
        style.spacing.button_padding = egui::vec2(10.0, 4.0);
        style.spacing.interact_size.y = 24.0;
        style.spacing.window_margin = Margin::same(16);
        style.spacing.tooltip_width = 320.0;
        // A thin bar always shows that there is more to scroll to.
        style.spacing.scroll.dormant_handle_opacity = 0.5;
        style.spacing.scroll.floating_width = 3.0;
    });
    for theme in [Theme::Dark, Theme::Light] {
        ctx.set_visuals_of(theme, visuals(theme));
    }
}

fn visuals(theme: Theme) -> Visuals {
    let mut visuals = theme.default_visuals();
    let palette = palette(&visuals);
    let greys = match theme {
        Theme::Dark => [[228; 3], [163, 165, 168], [27, 28, 31], [56, 57, 60], [74, 76, 81]],
        Theme::Light => [[28; 3], [92, 94, 97], [247; 3], [200; 3], [196, 198, 202]],
    };
    let [text, weak, panel, edge, chosen] = greys.map(|[r, g, b]| Color32::from_rgb(r, g, b));
    // Hue belongs to data: selections are grey.
    visuals.selection.bg_fill = chosen;
    visuals.selection.stroke.color = text;
    visuals.widgets.noninteractive.fg_stroke.color = text;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, edge);
    visuals.widgets.inactive.fg_stroke.color = text;
    visuals.weak_text_color = Some(weak);
    visuals.panel_fill = panel;
    visuals.window_fill = panel;
    visuals.window_stroke = Stroke::new(1.0, edge);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.window_shadow =
        Shadow { offset: [0, 8], blur: 24, spread: 0, color: Color32::from_black_alpha(80) };
    visuals.warn_fg_color = palette.caution;
    visuals.error_fg_color = palette.bad;
    visuals.hyperlink_color = palette.accent;
    visuals
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};
    use palette::color_difference::Ciede2000;
    use palette::white_point::D65;
    use palette::{Clamp, IntoColor, Lab, LinSrgb, Srgb};

    use super::*;

    /// Returns the relative luminance (WCAG 2.1).
    fn luminance(color: Color32) -> f64 {
        let [r, g, b] = [color.r(), color.g(), color.b()].map(|v| {
            let v = f64::from(v) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_has_the_contrast_required_by_wcag() {
        for theme in [Theme::Dark, Theme::Light] {
            let visuals = visuals(theme);
            let palette = palette(&visuals);
            let texts =
                [visuals.text_color(), visuals.weak_text_color(), palette.good, palette.caution, palette.bad];
            for text in texts {
                assert!(contrast(text, visuals.panel_fill) >= 4.5, "{text:?} in {theme:?}");
            }
            assert!(contrast(palette.on_accent, palette.accent) >= 4.5, "{theme:?}");
        }
    }

    #[test]
    fn handles_are_legible_on_their_labels() {
        for pair in 0..4 {
            assert!(contrast(pair_color(pair), Color32::BLACK) >= 4.5);
        }
    }

    /// Colours of lines over the pictures.
    const LINES: [Color32; 9] =
        [ESTIMATED, UNCHECKED, DOUBTFUL, UNRELIABLE, PAIRS[0], PAIRS[1], FORWARD, HOVER, TRUE];

    /// Red, green and blue, linear light, as seen without one kind of cones (Machado, Oliveira & Fernandes 2009,
    /// severity 1): protan, deutan, tritan.
    const WITHOUT_CONES: [Matrix3<f64>; 3] = [
        Matrix3::new(0.1523, 1.0526, -0.2049, 0.1145, 0.7863, 0.0992, -0.0039, -0.0481, 1.0520),
        Matrix3::new(0.3673, 0.8606, -0.2280, 0.2801, 0.6725, 0.0474, -0.0118, 0.0429, 0.9689),
        Matrix3::new(1.2555, -0.0767, -0.1788, -0.0784, 0.9308, 0.1476, 0.0047, 0.6914, 0.3039),
    ];

    #[test]
    fn lines_differ_for_every_kind_of_sight_and_from_the_window() {
        let panel = visuals(Theme::Dark).panel_fill;
        for color in LINES {
            assert!(contrast(color, panel) >= 4.5, "{color:?}");
        }
        for sight in [Matrix3::identity()].into_iter().chain(WITHOUT_CONES) {
            let seen = LINES.map(|color| {
                let linear = Srgb::new(color.r(), color.g(), color.b()).into_linear::<f64>();
                let [r, g, b] = (sight * Vector3::new(linear.red, linear.green, linear.blue)).into();
                let lab: Lab<D65, f64> = LinSrgb::new(r, g, b).clamp().into_color();
                lab
            });
            for (k, one) in seen.iter().enumerate() {
                for (other, color) in seen[..k].iter().zip(LINES) {
                    let difference = one.difference(*other);
                    assert!(difference >= 9.0, "{:?} and {color:?}: {difference:.1}", LINES[k]);
                }
            }
        }
    }
}
