//! The window: what `prt view` and the main job open.

mod app;
mod capture;
mod controls;
mod panel;
mod settings;
mod viewport;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, anyhow};
use eframe::egui;
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu;
use prt_gpu::Gpu;

use crate::arguments::Size;
use crate::camera::Orbit;
use crate::lighting::Lighting;
use crate::model::Model;
use crate::motion::Motion;
use crate::shading::Part;

use app::App;
pub(crate) use capture::Capture;
pub(crate) use controls::help_text;

/// What is shown, and how it is at first.
#[derive(Debug)]
pub(crate) struct Subject {
    /// The file it came from: pictures are saved beside it.
    pub(crate) path: PathBuf,
    pub(crate) model: Arc<Model>,
    /// The pose at first.
    pub(crate) motion: Motion,
    /// The part at first; the fullest if there is none, or it is not in the file.
    pub(crate) part: Option<Part>,
    /// At least one; the first is shown.
    pub(crate) lightings: Vec<Lighting>,
    /// The environment stands upright in the scene, turned as asked.
    pub(crate) scene_from_environment: glam::Quat,
    pub(crate) orbit: Orbit,
    pub(crate) exposure: f32,
}

/// Why no window can be opened here, as far as that is known without trying.
pub(crate) fn no_display() -> Option<&'static str> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let displays = ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"];
    let needs_display = cfg!(all(unix, not(target_os = "macos")));
    (needs_display && !displays.into_iter().any(is_set))
        .then_some("there is no display: neither WAYLAND_DISPLAY nor DISPLAY is set")
}

/// Width over height of the picture in a window, which is what the panel leaves.
pub(crate) fn picture_aspect(size: Size) -> f32 {
    (size.width as f32 - panel::WIDTH).max(1.0) / size.height as f32
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If there is no display or no usable GPU adapter, or the capture that was asked for failed.
pub(crate) fn open(subject: Subject, size: Size, capture: Option<Capture>) -> anyhow::Result<()> {
    if let Some(reason) = no_display() {
        return Err(anyhow!(reason).context("cannot open a window"));
    }
    let title = format!("{} - prt", subject.path.display());
    // An error of the app's own making, which would lose its causes on the way through eframe.
    let failure = Arc::new(Mutex::new(None));
    let told = Arc::clone(&failure);
    let is_capture = capture.is_some();
    let create: eframe::AppCreator<'_> = Box::new(move |context| {
        let state = context.wgpu_render_state.as_ref().ok_or("the window has no GPU device")?;
        let app = App::new(state, subject, capture, told)?;
        Ok(Box::new(app))
    });
    eframe::run_native(&title, options(size), create).map_err(|error| window_error(&error))?;
    match failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(error) if is_capture => Err(error),
        _ => Ok(()),
    }
}

fn options(size: Size) -> eframe::NativeOptions {
    let mut options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_inner_size([size.width as f32, size.height as f32])
            .with_app_id("prt")
            .with_drag_and_drop(true),
        ..Default::default()
    };
    options.wgpu_options.wgpu_setup = wgpu_setup();
    options
}

/// Asks the adapter for what the passes of `prt-gpu` need.
fn wgpu_setup() -> WgpuSetup {
    let device_descriptor = |adapter: &wgpu::Adapter| wgpu::DeviceDescriptor {
        label: Some("prt"),
        required_limits: Gpu::required_limits(adapter),
        ..Default::default()
    };
    WgpuSetup::CreateNew(WgpuSetupCreateNew {
        device_descriptor: Arc::new(device_descriptor),
        ..WgpuSetupCreateNew::without_display_handle()
    })
}

/// In words of ours where the cause is known.
fn window_error(error: &eframe::Error) -> anyhow::Error {
    let cause = match error {
        eframe::Error::Winit(error) => format!("the display cannot be reached: {error}"),
        eframe::Error::WinitEventLoop(error) => format!("the display cannot be reached: {error}"),
        eframe::Error::Wgpu(error) => format!("no usable GPU adapter: {error}"),
        other => other.to_string(),
    };
    anyhow!(cause).context("cannot open a window")
}

/// Says where a failure came from without ending the window.
pub(crate) fn describe<T>(result: anyhow::Result<T>, step: impl FnOnce() -> String) -> Result<T, String> {
    result.with_context(step).map_err(|error| format!("{error:#}"))
}
