//! The card of the verdict: one word with the menu that copies F, one sentence, four figures, buttons, and the rest.
//! The figures stand above the fold of the smallest dock.

use egui::collapsing_header::CollapsingState;
use egui::{
    Align, Button, Color32, FontId, Id, Label, Layout, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui,
    UiBuilder, Visuals, vec2,
};

use super::dialog::named;
use super::menus::copy_fundamental_menu;
use super::{busy, command_button, finish_button, main_button, terms};
use crate::app::model::comparison::Contestant;
use crate::app::model::computation::Freshness;
use crate::app::model::guide::guide;
use crate::app::model::sample::FIRST;
use crate::app::model::verdict::{
    CardAction, Fact, Glance, Tone, VerdictInWords, corrected_fact, epipoles_at_a_glance, hypothesis_facts,
    import_facts, import_warning, lens_fact, lines_at_a_glance, pose_facts,
};
use crate::app::model::{Command, ExchangeCommand, Model, OverlayId};
use crate::app::view::theme;
use crate::estimate::Estimate;

/// Space between two rows of the card, screen points.
const BETWEEN: f32 = 2.0;
/// Rows of the main reason above the figures. Its tooltip has the rest.
const REASON: usize = 3;
/// Height of the start, screen points.
const START: f32 = 130.0;

/// Shows the card in all available space. The details scroll.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("card").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = BETWEEN;
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        if model.is_at_start() {
            start(ui, model, commands);
        } else if another(ui, model, commands) {
            fundamental(ui, model);
        } else {
            result(ui, model, commands);
        }
    });
}

fn fundamental(ui: &mut Ui, model: &Model) {
    let Some(shown) = model.geometry_to_write() else { return };
    let convention = "Fundamental matrix F: x2 · F x1 = 0 for a match of x1 in the left image and x2 in the right one, \
                      pixels, with the centre of the upper left pixel at (0, 0).";
    let rows = shown.fundamental.rows().map(|row| row.map(|value| format!("{value:>9.2e}")).join(" "));
    ui.add(Label::new(RichText::new(rows.join("\n")).monospace()).extend()).on_hover_text(convention);
}

/// Shows the next step before anything was placed, in the middle of the dock.
fn start(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let is_lesson = model.lesson().is_some();
    let mut text = guide(model);
    let clicks = model.document.pictures.is_some() && model.document.too_small().is_none();
    if clicks && !is_lesson {
        text += " Two such pairs give the epipolar geometry.";
    }
    let show_me = model.open.show_me.map(|_| Command::ShowMe);
    let offers: Vec<Command> = match &model.document.pictures {
        None if model.activity.loading => Vec::new(),
        None => vec![Command::ShowOpenDialog, Command::OpenSample(FIRST)],
        Some(_) if is_lesson => show_me.into_iter().chain([Command::ShowOpenDialog]).collect(),
        Some(_) => {
            let find = model.can_find_without_clicks().then_some(Command::FindWithoutClicks);
            show_me.into_iter().chain(find).collect()
        }
    };
    ui.add_space((ui.available_height() - START).max(0.0) * 0.4);
    ui.vertical_centered(|ui| {
        ui.add(Label::new(RichText::new(text).size(17.0).color(ui.visuals().strong_text_color())).wrap());
        ui.add_space(10.0);
        if model.activity.loading && model.document.pictures.is_none() {
            busy::show(ui);
        }
        let stands_out = model.open.show_me.is_some() || model.document.pictures.is_none();
        let offers: Vec<_> = offers.into_iter().map(|command| (command.name(), command)).collect();
        centred(ui, 15.0, &offers, stands_out, commands);
        if is_lesson {
            ui.add_space(10.0);
            ui.add(Label::new(RichText::new("Or click a point on the left, then the same point on the right. Two such pairs give the lines.").weak()).wrap());
        }
        unsaved_work(ui, model, commands);
    });
}

/// Offers the newest unsaved work. The dialog for opening images lists all of it, and deletes.
fn unsaved_work(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(newest) = model.left_behind.first() else { return };
    ui.add_space(10.0);
    let told = format!("Unsaved work, newest of {}: {}", model.left_behind.len(), newest.told());
    ui.add(Label::new(told).wrap());
    let restore = newest.actions().into_iter().next().map(|action| (action.label, action.command));
    centred(ui, 14.0, restore.as_slice(), false, commands);
}

/// Shows buttons with text of this size side by side in the middle, or one below the other. The first one may stand out.
fn centred(
    ui: &mut Ui,
    size: f32,
    offers: &[(&str, Command)],
    stands_out: bool,
    commands: &mut Vec<Command>,
) {
    let font = FontId::proportional(size);
    let padding = ui.spacing().button_padding.x.max(size);
    let wide = |(text, _): &(&str, Command)| {
        ui.painter().layout_no_wrap((*text).to_owned(), font.clone(), Color32::WHITE).size().x + 2.0 * padding
    };
    let widths: Vec<f32> = offers.iter().map(wide).collect();
    let all =
        widths.iter().sum::<f32>() + ui.spacing().item_spacing.x * offers.len().saturating_sub(1) as f32;
    let before = (ui.available_width() - all) * 0.5;
    let mut show = |ui: &mut Ui| {
        for (number, ((text, command), width)) in offers.iter().zip(&widths).enumerate() {
            let palette = theme::palette(ui.visuals());
            let text = RichText::new(*text).font(font.clone());
            let button = if number == 0 && stands_out {
                Button::new(text.color(palette.on_accent)).fill(palette.accent)
            } else {
                Button::new(text)
            };
            let button = ui.add(button.min_size(vec2(*width, 2.1 * size)));
            finish_button(ui, button, command.clone(), commands);
        }
    };
    if before < 0.0 {
        return show(ui);
    }
    ui.horizontal(|ui| {
        ui.add_space(before);
        show(ui);
    });
}

/// Shows the geometry that the window displays in place of the result. Returns whether there is one.
fn another(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> bool {
    let Some(shown) = model.shown() else { return false };
    if let Some((number, hypothesis)) = shown.hypothesis {
        heading(ui, model, None, &format!("Hypothesis {}", number + 1), commands);
        another_shown(ui, model, &format!("hypothesis {}", number + 1), commands);
        epipoles(ui, model, None);
        let score = model.document.parameters.validation.line_score;
        list(ui, true_error(model).into_iter().chain(hypothesis_facts(hypothesis, score)));
        return true;
    }
    let Some(contestant) = shown.contestant else { return false };
    let name = match contestant {
        Contestant::Truth => "the true geometry".to_owned(),
        Contestant::Imported => "the imported geometry".to_owned(),
        other => format!("the {} geometry", other.name()),
    };
    heading(ui, model, None, contestant.name(), commands);
    if model.result().is_some() {
        another_shown(ui, model, &name, commands);
    } else {
        let text =
            format!("The images show {name}. Mark two point pairs to estimate a geometry for comparison.");
        ui.add(Label::new(text).wrap());
    }
    let imported = model.document.imported.as_ref().filter(|_| contestant == Contestant::Imported);
    if let Some(warning) = imported.and_then(import_warning) {
        ui.add(Label::new(RichText::new(warning).color(tone_color(ui.visuals(), Tone::Caution))).wrap());
    }
    ui.horizontal_wrapped(|ui| {
        if imported.is_some() {
            let remove = ui.button("Remove it");
            finish_button(ui, remove, ExchangeCommand::RemoveImported.into(), commands);
        }
        if model.result().is_none() && model.can_find_without_clicks() {
            command_button(ui, Command::FindWithoutClicks, true, commands);
        }
    });
    epipoles(ui, model, None);
    list(ui, true_error(model).into_iter().chain(imported.map(import_facts).unwrap_or_default()));
    true
}

fn result(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let VerdictInWords { tone, word, sentence, facts, warnings, likely } = model.verdict_in_words();
    heading(ui, model, Some(tone), word, commands);
    let warnings: Vec<String> = warnings.into_iter().filter(|warning| *warning != sentence).collect();
    let sentence = sentence + &model.card_remarks();
    // A decimal point has no space behind it.
    let reason = sentence.find(". ").map_or(&*sentence, |end| &sentence[..=end]);
    terms::label(ui, reason, REASON);
    if tone != Tone::Apart {
        figures(ui, model, likely.as_ref());
        list(ui, true_error(model).into_iter().chain(facts.iter().filter(|fact| is_on_card(fact)).cloned()));
    }
    ui.add_space(2.0);
    let mut details =
        CollapsingState::load_with_default_open(ui.ctx(), Id::unique("details of the verdict"), false);
    let rest = sentence[reason.len()..].trim_start();
    let has_details = model.result().is_some();
    let unfolds = buttons(ui, model, has_details.then_some(details.is_open()), commands);
    if unfolds {
        details.toggle(ui);
    }
    if !rest.is_empty() {
        terms::label(ui, rest, usize::MAX);
    }
    if !has_details {
        return;
    }
    details.show_body_unindented(ui, |ui| {
        for warning in warnings {
            let color = tone_color(ui.visuals(), Tone::Caution);
            ui.add(Label::new(RichText::new(warning).color(color)).wrap());
        }
        if let Some(Some(next)) = model.open.next_click {
            let text = format!(
                "Add a pair at the mark: equally plausible geometries differ there by up to {:.0} px.",
                next.disagreement
            );
            ui.add(Label::new(text).wrap());
        }
        let pose = model.scene().map(|scene| pose_facts(&scene.fit)).unwrap_or_default();
        let lens =
            model.offered_lens().zip(model.document.frames()).map(|(lens, frames)| lens_fact(lens, frames));
        let lens = lens.or(model.open.corrected_lens().map(corrected_fact));
        list(ui, facts.into_iter().filter(|fact| !is_on_card(fact)).chain(pose).chain(lens));
        if model.open.corrected_lens().is_some() {
            command_button(ui, Command::RemoveCalibration, true, commands);
        }
        fundamental(ui, model);
    });
}

fn figures(ui: &mut Ui, model: &Model, likely: Option<&[String; 2]>) {
    let Some(shown) = model.shown() else { return };
    let is_current = !matches!(shown.freshness, Freshness::Followed | Freshness::Stale);
    let own = Some(shown.estimate).filter(|_| is_current);
    at_a_glance(ui, own.and_then(|estimate| lines_at_a_glance(estimate, model.document.frames()?)));
    // It is about the lines alone.
    if let Some([short, sentence]) = likely {
        ui.label(RichText::new(short).size(theme::CAPTION).weak()).on_hover_text(format!(
            "{sentence}. This is the share of right results with such a verdict on pairs with known truth."
        ));
    }
    // The lens moves the epipoles by more than the matches tell.
    let own = own.filter(|_| model.offered_lens().is_none());
    epipoles(ui, model, own);
}

/// Shows what the verdict asks for, and a button for the details if it is told whether they are open. Returns whether
/// that was clicked.
fn buttons(ui: &mut Ui, model: &Model, details: Option<bool>, commands: &mut Vec<Command>) -> bool {
    let action = model.card_action();
    let switch = model.lines_switch().filter(|switch| action.as_ref() != Some(switch));
    let mut unfolds = false;
    ui.horizontal_wrapped(|ui| {
        let others = model.card_alternative().into_iter().chain(switch);
        let count = usize::from(action.is_some());
        for (place, CardAction { label, command, enabled }) in action.into_iter().chain(others).enumerate() {
            let button = if place < count && enabled {
                main_button(ui, &label)
            } else {
                ui.add_enabled(enabled, Button::new(label))
            };
            finish_button(ui, button, command, commands);
        }
        if let Some(open) = details {
            let button = ui.add(Button::selectable(open, "Details"));
            unfolds = button.clicked();
            if unfolds && !open {
                // The details are below.
                button.scroll_to_me(Some(Align::TOP));
            }
        }
    });
    unfolds
}

/// Returns whether a figure stands on the card itself: those of sequences, which have no matches.
fn is_on_card(fact: &Fact) -> bool {
    ["Agreement", "Distinct lines"].contains(&fact.name)
}

/// Shows the places of the epipoles of the shown geometry, with their intervals if it is that of `own`.
fn epipoles(ui: &mut Ui, model: &Model, own: Option<&Estimate>) {
    let shown = model.shown().zip(model.document.frames());
    at_a_glance(ui, shown.map(|(shown, frames)| epipoles_at_a_glance(shown.fundamental, frames, own)));
}

fn at_a_glance(ui: &mut Ui, row: Option<Glance>) {
    let Some(Glance { name, common, heads, values, ranges, tooltip }) = row else { return };
    let small = |text: &str| RichText::new(text).size(theme::CAPTION).weak();
    ui.add_space(1.0);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    let (top, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.0), Sense::hover());
    ui.painter().hline(top.x_range(), top.center().y, line);
    let is_one = values[0] == values[1] && ranges.iter().all(String::is_empty);
    let [first, second] = heads.map(small);
    let in_cells = |ui: &mut Ui, texts: [RichText; 3], height: f32, share: f32| {
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
        let right = area.width() * share;
        let mut end = area.max.x;
        for (k, text) in texts.into_iter().enumerate().rev() {
            let start = if k == 0 { area.min.x } else { end - right };
            let cell = Rect::from_x_y_ranges(start..=end, area.y_range());
            end = start;
            let layout = match k {
                0 => Layout::left_to_right(Align::Center),
                _ => Layout::right_to_left(Align::Center),
            };
            if !text.is_empty() {
                ui.scope_builder(UiBuilder::new().max_rect(cell).layout(layout), |ui| {
                    let words = text.text().to_owned();
                    let label = ui.add(Label::new(text).truncate());
                    let meaning = terms::mark(ui, label.rect, &words).unwrap_or_default();
                    label.on_hover_text(format!("{meaning} {tooltip}").trim_start());
                });
            }
        }
    };
    if is_one {
        let [value, _] = values;
        ui.horizontal(|ui| {
            ui.label(small(name)).on_hover_text(tooltip);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(value).strong()).on_hover_text(tooltip);
            });
        });
        return;
    }
    in_cells(ui, [small(name), first, second], 14.0, 0.36);
    let [one, other] = values.map(|value| RichText::new(value).size(theme::FIGURE).strong());
    in_cells(ui, [RichText::new(common), one, other], 18.0, 0.36);
    if ranges.iter().any(|range| !range.is_empty()) {
        let [one, other] = ranges.each_ref().map(|range| small(range));
        // Ranges have no name beside them.
        in_cells(ui, [RichText::default(), one, other], 14.0, 0.5);
    }
}

/// Shows the sign and the word of a verdict. At the right, the search is stopped or F copied, if the word leaves room.
fn heading(ui: &mut Ui, model: &Model, tone: Option<Tone>, word: &str, commands: &mut Vec<Command>) {
    let row = vec2(ui.available_width(), 24.0);
    ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
        ui.spacing_mut().button_padding.y = 1.0;
        if model.open.computation.is_running() {
            command_button(ui, Command::Stop, true, commands);
        } else if row.x > 180.0 && model.geometry_to_write().is_some() {
            copy_fundamental_menu(ui, model, commands);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            if let Some(tone) = tone {
                sign(ui, tone);
            }
            let word = RichText::new(word).size(theme::VERDICT).color(ui.visuals().strong_text_color());
            ui.add(Label::new(word).truncate());
        });
    });
}

fn tone_color(visuals: &Visuals, tone: Tone) -> Color32 {
    let palette = theme::palette(visuals);
    match tone {
        Tone::Idle | Tone::Busy => visuals.weak_text_color(),
        Tone::Apart => visuals.text_color(),
        Tone::Good => palette.good,
        Tone::Caution => palette.caution,
        Tone::Bad => palette.bad,
    }
}

/// Draws the sign of a verdict: a tick, a diamond or an octagon, so that the colour is not needed.
fn sign(ui: &mut Ui, tone: Tone) {
    if matches!(tone, Tone::Busy) {
        busy::show(ui);
        return;
    }
    let (area, _) = ui.allocate_exact_size(vec2(18.0, 22.0), Sense::hover());
    let (centre, color) = (area.center(), tone_color(ui.visuals(), tone));
    let corners = |count: usize, radius: f32, first: f32| {
        let turn = std::f32::consts::TAU / count as f32;
        (0..count).map(|k| centre + radius * egui::Vec2::angled(first + turn * k as f32)).collect::<Vec<_>>()
    };
    match tone {
        Tone::Good => {
            let tick = [vec2(-6.0, 0.5), vec2(-2.0, 5.0), vec2(6.5, -5.5)].map(|at| centre + at);
            ui.painter().line(tick.to_vec(), Stroke::new(2.6, color));
        }
        Tone::Caution => {
            ui.painter().add(Shape::convex_polygon(corners(4, 8.0, 0.0), color, Stroke::NONE));
        }
        Tone::Bad => {
            let first = std::f32::consts::TAU / 16.0;
            ui.painter().add(Shape::convex_polygon(corners(8, 8.0, first), color, Stroke::NONE));
            let bar = Rect::from_center_size(centre, vec2(8.0, 2.4));
            ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
        }
        Tone::Apart => {
            // Not equal.
            ui.painter().circle_stroke(centre, 8.0, Stroke::new(1.8, color));
            for bar in [
                [vec2(-3.6, -1.8), vec2(3.6, -1.8)],
                [vec2(-3.6, 1.8), vec2(3.6, 1.8)],
                [vec2(-2.4, 4.2), vec2(2.4, -4.2)],
            ] {
                ui.painter().line_segment(bar.map(|at| centre + at), Stroke::new(1.4, color));
            }
        }
        Tone::Idle | Tone::Busy => {
            ui.painter().circle_stroke(centre, 5.5, Stroke::new(1.6, color));
        }
    }
}

/// Shows the sign and the word in one line, for the folded dock.
pub fn folded(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let VerdictInWords { tone, word, sentence, .. } = model.verdict_in_words();
    sign(ui, tone);
    ui.strong(word);
    let show = named(ui.button("Show"), "Show dock");
    finish_button(ui, show, Command::FoldDock, commands);
    ui.add(Label::new(RichText::new(sentence).weak()).truncate());
}

/// Returns the true error of the geometry shown, if ground truth is in use.
fn true_error(model: &Model) -> Option<Fact> {
    let shown = model.shown()?;
    let (_, comparison) = model.truth().zip(model.open.comparison.as_ref())?;
    let (error, least) = (comparison.true_error?, comparison.truth_error?);
    Some(Fact::new(
        "True error",
        match shown.contestant {
            Some(Contestant::Truth) => format!("{error:.2} px"),
            _ => format!("{error:.2} px (truth {least:.2})"),
        },
        "Mean symmetric epipolar distance of all true matches under the geometry shown. The value of the \
         ground truth itself shows how exact the matches are. No estimate can be much better.",
    ))
}

/// Shows named figures, values at the right.
fn list(ui: &mut Ui, facts: impl Iterator<Item = Fact>) {
    ui.spacing_mut().interact_size.y = theme::ROW - 3.0;
    ui.spacing_mut().item_spacing.y = 2.0;
    for fact in facts {
        ui.horizontal(|ui| {
            let name = RichText::new(fact.name).size(theme::CAPTION).weak();
            ui.label(name).on_hover_text(fact.tooltip);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.add(Label::new(&fact.value).truncate()).on_hover_text(fact.tooltip);
                if let Some(tone) = fact.tone.filter(|tone| matches!(tone, Tone::Caution | Tone::Bad)) {
                    let (dot, _) = ui.allocate_exact_size(vec2(8.0, 16.0), Sense::hover());
                    ui.painter().circle_filled(dot.center(), 3.5, tone_color(ui.visuals(), tone));
                }
            });
        });
    }
}

/// Shows that the window displays another geometry, with a button back to the result.
fn another_shown(ui: &mut Ui, model: &Model, name: &str, commands: &mut Vec<Command>) {
    let mut text = format!("The images show {name}, not the result");
    let has_matches = model.shown().is_some_and(|shown| !shown.estimate.matches().is_empty());
    if has_matches && model.look.shows(OverlayId::Matches) {
        text += ". The pale dots are the matches of the result.";
    }
    let color = theme::palette(ui.visuals()).accent;
    ui.add(Label::new(RichText::new(text).color(color)).wrap());
    command_button(ui, Command::ChooseHypothesis(None), true, commands);
}
