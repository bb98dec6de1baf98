//! The native window of the program around an [`Inspector`].

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use eframe::{NativeOptions, Renderer};
use thiserror::Error;

use super::Start;
use super::inspector::Inspector;
use super::tasks::{Services, panic_text};
use super::view::{SystemFonts, theme};

/// Name of the program for the desktop, and of the folder with the window size and theme.
const APP_ID: &str = "epiline";

/// Reason why the window did not open, or closed unexpectedly. The messages have no final full
/// stop.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum AppError {
    #[error(
        "cannot open a window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set). \
         `epiline estimate` works without a display"
    )]
    NoDisplay,
    /// The display does not respond.
    #[error(
        "cannot open a window on the display {display}. Check that the display is running and that \
         you may use it. `epiline estimate` works without a display"
    )]
    Display { display: String },
    #[error("cannot open a window: the library {library} is missing. Install it (on Debian: {package})")]
    Library { library: &'static str, package: &'static str },
    #[error("cannot open a window: OpenGL does not work. Check the graphics driver (on Debian: libgl1)")]
    Graphics,
    /// The window toolkit failed.
    #[error("the window closed unexpectedly: {reason}")]
    Crashed { reason: String },
}

/// Storage key of the visible overlays, tabs and panels. The toolkit itself stores theme, window
/// size and panel sizes.
const LOOK: &str = "look";
/// Storage key of the recently opened files.
const RECENTS: &str = "recents";

struct Shell(Inspector);

impl eframe::App for Shell {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, LOOK, self.0.look());
        eframe::set_value(storage, RECENTS, self.0.recents());
    }

    fn on_exit(&mut self, _graphics: Option<&eframe::glow::Context>) {
        self.0.close();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// Opens the window and returns when the user closes the window.
pub fn run(start: Start, mut services: Services) -> Result<(), AppError> {
    let display = display()?;
    services.copies = eframe::storage_dir(APP_ID).map(|folder| folder.join("unsaved"));
    let options = NativeOptions {
        renderer: Renderer::Glow,
        viewport: egui::ViewportBuilder::default()
            .with_title("Epiline")
            .with_app_id(APP_ID)
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([860.0, 540.0]),
        ..NativeOptions::default()
    };
    let outcome = quietly(|| {
        eframe::run_native(
            APP_ID,
            options,
            Box::new(move |creation| {
                theme::install(&creation.egui_ctx);
                creation.egui_ctx.add_font_provider(Arc::new(SystemFonts::default()));
                // The toolkit keeps scroll positions, which belong to the content of another run.
                creation
                    .egui_ctx
                    .memory_mut(|memory| memory.data.remove_by_type::<egui::scroll_area::State>());
                let mut inspector = Inspector::new(start, services);
                if let Some(look) = creation.storage.and_then(|storage| eframe::get_value(storage, LOOK)) {
                    inspector.set_look(look);
                }
                if let Some(recents) =
                    creation.storage.and_then(|storage| eframe::get_value(storage, RECENTS))
                {
                    inspector.set_recents(recents);
                }
                Ok(Box::new(Shell(inspector)))
            }),
        )
    });
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(match error {
            eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => AppError::Display { display },
            eframe::Error::Glutin(_) | eframe::Error::NoGlutinConfigs(..) | eframe::Error::OpenGL(_) => {
                AppError::Graphics
            }
            eframe::Error::AppCreation(reason) => AppError::Crashed { reason: reason.to_string() },
        }),
        Err(text) => Err(from_panic(text)),
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
fn display() -> Result<String, AppError> {
    ["WAYLAND_DISPLAY", "DISPLAY"]
        .iter()
        .find_map(|name| std::env::var(name).ok().filter(|value| !value.is_empty()))
        .ok_or(AppError::NoDisplay)
}

/// Returns a name for the only display of these systems.
#[cfg(not(all(unix, not(target_os = "macos"))))]
fn display() -> Result<String, AppError> {
    Ok("of this computer".into())
}

/// Converts a panic of the toolkit. The toolkit panics when some libraries are missing.
fn from_panic(text: String) -> AppError {
    let libraries = [
        ("libxkbcommon-x11", "libxkbcommon-x11-0"),
        ("libxkbcommon", "libxkbcommon0"),
        ("libX11", "libx11-6"),
    ];
    let missing =
        libraries.iter().find(|(library, _)| text.contains(library) && text.contains("not be loaded"));
    match missing {
        Some((library, package)) => AppError::Library { library, package },
        None => AppError::Crashed { reason: text },
    }
}

/// Runs `f` and returns a panic as its message. The default report on standard error contains paths
/// of the build, so it is suppressed meanwhile, also for other threads. The window shows their
/// panics.
fn quietly<T>(f: impl FnOnce() -> T) -> Result<T, String> {
    let first = Arc::new(Mutex::new(None));
    let usual = std::panic::take_hook();
    std::panic::set_hook({
        let (first, main) = (Arc::clone(&first), std::thread::current().id());
        Box::new(move |info| {
            if std::thread::current().id() == main {
                let text = panic_text(info.payload());
                first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
            }
        })
    });
    let outcome = catch_unwind(AssertUnwindSafe(f));
    std::panic::set_hook(usual);
    // The first panic names the cause. Others may follow while the window is taken down.
    outcome.map_err(|payload| {
        let first = first.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.unwrap_or_else(|| panic_text(payload.as_ref()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_library_is_named_with_its_package() {
        let error = from_panic("Library libxkbcommon-x11.so could not be loaded.".into());
        assert_eq!(error, AppError::Library { library: "libxkbcommon-x11", package: "libxkbcommon-x11-0" });
        assert_eq!(from_panic("boom".into()), AppError::Crashed { reason: "boom".into() });
    }
}
