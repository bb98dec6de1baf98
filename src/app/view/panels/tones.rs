//! The brightness menu: exposure, contrast, gamma, single channels.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, PopupCloseBehavior, Slider, Ui};

use super::dialog::named;
use super::finish_button;
use super::icons::Icon;
use crate::app::model::tones::TonesCommand;
use crate::app::model::{Command, Model, Side};
use crate::image::{Channel, Rendition};

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let changed = model.open.tones.of.iter().any(|own| !own.is_plain());
    let button = Button::selectable(changed, "").min_size(egui::vec2(28.0, 26.0));
    let stays_open = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) =
        MenuButton::from_button(button).config(stays_open).ui(ui, |ui| menu(ui, model, commands));
    let color = ui.style().interact_selectable(&button, changed).text_color();
    Icon::Tones.draw(ui.painter(), button.rect.center(), color);
    named(button, "Brightness").on_hover_text(
        "Exposure, contrast, gamma and channels of the displayed images. Computations are not affected.",
    );
}

fn menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let tones = &model.open.tones;
    let before = tones.adjusted();
    let mut wanted = before;
    ui.horizontal(|ui| {
        for (alone, name) in [(None, "Both"), (Some(Side::Left), "Left"), (Some(Side::Right), "Right")] {
            let choice = ui.add(Button::selectable(tones.alone == alone, name));
            finish_button(ui, choice, TonesCommand::Adjust(alone).into(), commands);
        }
    });
    ui.separator();
    ui.spacing_mut().slider_width = 140.0;
    let slider = |ui: &mut Ui, slider: Slider<'_>, name: &str, tooltip: &str| {
        ui.add(slider.text(name).fixed_decimals(2)).on_hover_text(tooltip);
    };
    slider(
        ui,
        Slider::new(&mut wanted.stops, -4.0..=8.0),
        "Exposure, stops",
        "Each stop doubles the brightness.",
    );
    slider(
        ui,
        Slider::new(&mut wanted.contrast, 0.2..=8.0).logarithmic(true),
        "Contrast",
        "Spread around middle grey. 1 changes nothing.",
    );
    slider(
        ui,
        Slider::new(&mut wanted.gamma, 0.2..=5.0).logarithmic(true),
        "Gamma",
        "Above 1 brightens dark areas more than bright ones. 1 changes nothing.",
    );
    ui.horizontal(|ui| {
        for channel in Channel::ALL {
            ui.selectable_value(&mut wanted.channel, channel, channel.name());
        }
    });
    if wanted != before {
        commands.push(TonesCommand::Set(wanted).into());
    }
    ui.separator();
    ui.horizontal(|ui| {
        let stretch = ui.add(Button::new("Stretch"));
        finish_button(ui, stretch, TonesCommand::Stretch.into(), commands);
        let reset = ui.add_enabled(tones.of != [Rendition::default(); 2], Button::new("Reset"));
        finish_button(ui, reset, TonesCommand::Reset.into(), commands);
    });
}
