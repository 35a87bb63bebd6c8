//! The app: settings in, pictures out.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{self, Align2, Color32, FontId, Rect, Response, Role, Sense, Ui, ViewportCommand, WidgetInfo, vec2};
use eframe::egui_wgpu::{Callback, RenderState};
use glam::Mat4;
use prt_gpu::{Gpu, View};

use super::capture::Capture;
use super::controls::{self, Action, Choices};
use super::panel::{self, Facts};
use super::settings::Settings;
use super::viewport::{Content, Painting, SharedViewport, Shot, Viewport, lock};
use super::{Subject, describe};
use crate::camera::Sphere;
use crate::lighting::Lighting;
use crate::model::Model;
use crate::output_file;
use crate::picture::{self, Backdrop};
use crate::shading::Part;

/// Samples per pixel along each axis of the picture that stands still.
const SAMPLES: u32 = 2;
/// How long the picture stands still before a software adapter draws it with all samples, seconds.
const STILL: f64 = 0.2;
/// Side of the picture that automatic exposure is measured on, pixels.
const EXPOSURE_SIDE: u32 = 256;
/// The most that time goes on between two frames, seconds.
const LONGEST_STEP: f32 = 0.1;
/// Share of the last frame in the mean of the frame times.
const SMOOTHING: f32 = 0.1;

/// Where the app leaves the error of a capture.
pub(super) type Failure = Arc<Mutex<Option<anyhow::Error>>>;

/// The window's content.
#[derive(Debug)]
pub(super) struct App {
    path: PathBuf,
    model: Arc<Model>,
    around: Sphere,
    parts: Vec<Part>,
    lightings: Vec<Arc<Lighting>>,
    settings: Settings,
    start: Settings,
    viewport: SharedViewport,
    adapter: String,
    is_software: bool,
    /// When the settings changed last, seconds.
    changed: f64,
    frame_seconds: Option<f32>,
    message: String,
    capture: Option<Capture>,
    failure: Failure,
}

impl App {
    pub(super) fn new(
        state: &RenderState,
        subject: Subject,
        capture: Option<Capture>,
        failure: Failure,
    ) -> Result<Self, prt_gpu::Error> {
        let gpu = Gpu::from_parts(state.device.clone(), state.queue.clone(), state.adapter.get_info())?;
        let Subject { path, model, motion, part, lightings, scene_from_environment, orbit, exposure } = subject;
        let viewport = Viewport::new(gpu, state.target_format, Arc::clone(&model))?;
        let parts = model.parts();
        let mut settings = Settings::new(orbit, scene_from_environment, exposure, model.order());
        settings.motion = motion;
        settings.part = part.filter(|part| parts.contains(part)).or(parts.last().copied()).unwrap_or(Part::Full);
        set_failure(&failure, capture.as_ref().map(Capture::missing));
        Ok(Self {
            path,
            around: Sphere::around(&model.pose(&motion).positions),
            parts,
            lightings: lightings.into_iter().map(Arc::new).collect(),
            start: settings.clone(),
            settings,
            adapter: viewport.adapter_name(),
            is_software: viewport.is_software(),
            viewport: Arc::new(Mutex::new(viewport)),
            model,
            changed: f64::NEG_INFINITY,
            frame_seconds: None,
            message: String::new(),
            capture,
            failure,
        })
    }

    fn add_dropped_environments(&mut self, context: &egui::Context) {
        for file in context.input(|input| input.raw.dropped_files.clone()) {
            self.add_environment(file.path());
        }
    }

    fn add_environment(&mut self, path: &Path) {
        match Lighting::load(path, self.model.order()) {
            Ok(lighting) => {
                self.settings.environment = self.lightings.len();
                self.lightings.push(Arc::new(lighting));
                self.message.clear();
            }
            Err(error) => self.message = error.to_string(),
        }
    }

    fn use_keys(&mut self, ui: &Ui) -> Option<Action> {
        if ui.ctx().egui_wants_keyboard_input() {
            return None;
        }
        let choices = Choices {
            environment_count: self.lightings.len(),
            order: self.model.order().get(),
            parts: &self.parts,
            start: &self.start,
        };
        ui.input(|input| controls::keys(input, &mut self.settings, &choices))
    }

    fn show_panel(&mut self, ui: &mut Ui, work_seconds: Option<f32>) {
        let facts = Facts {
            model: &self.model,
            lightings: &self.lightings,
            parts: &self.parts,
            adapter: &self.adapter,
            frame_seconds: self.frame_seconds,
            work_seconds,
            message: &self.message,
        };
        egui::Panel::right("panel")
            .default_size(panel::WIDTH)
            .show(ui, |ui| panel::show(ui, &mut self.settings, &facts));
    }

    /// The picture, and what the mouse does to it.
    fn show_picture(&mut self, ui: &mut Ui) -> Rect {
        let response = ui.allocate_response(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "picture"));
        controls::mouse(ui, &response, &mut self.settings, self.around);
        let samples = self.samples(ui);
        if let Some(shot) = self.shot(&response, ui.pixels_per_point(), samples) {
            let painting = Painting { viewport: Arc::clone(&self.viewport), shot };
            ui.painter().add(Callback::new_paint_callback(response.rect, painting));
        }
        if self.settings.shows_help {
            show_help(ui, response.rect);
        }
        response.rect
    }

    /// A software adapter draws fewer samples while something moves.
    fn samples(&self, ui: &Ui) -> u32 {
        let still = ui.input(|input| input.time) - self.changed;
        let is_moving = self.settings.draws_continuously || self.settings.plays;
        if !self.is_software || (still >= STILL && !is_moving) {
            return SAMPLES;
        }
        ui.ctx().request_repaint_after_secs((STILL - still).max(0.01) as f32);
        1
    }

    fn shot(&self, response: &Response, pixels_per_point: f32, samples: u32) -> Option<Shot> {
        let [width, height] =
            [response.rect.width(), response.rect.height()].map(|side| (side * pixels_per_point).round() as u32);
        (width > 0 && height > 0).then(|| self.shot_of_size(width, height, samples))
    }

    fn shot_of_size(&self, width: u32, height: u32, samples: u32) -> Shot {
        let settings = &self.settings;
        let camera = settings.orbit.camera();
        let clip_from_world = camera.clip_from_world(width as f32 / height as f32, self.around);
        let view = |matrix: Mat4| View { clip_from_world: matrix.to_cols_array_2d(), width, height, samples };
        let view_of_environment = view(clip_from_world * Mat4::from_quat(settings.scene_from_environment));
        let lighting = &self.lightings[settings.environment];
        let has_background = settings.shows_environment && !settings.shows_transfer;
        let order = settings.order();
        Shot {
            view: view(clip_from_world),
            eye: camera.eye.to_array(),
            part: settings.part,
            motion: settings.motion,
            evaluation: settings.evaluation(),
            content: if settings.shows_transfer {
                Content::Coefficient(settings.coefficient)
            } else {
                Content::Lit { order, light: lighting.light(order, settings.scene_from_environment) }
            },
            exposure: if settings.shows_transfer { 0.0 } else { settings.exposure },
            background: has_background.then(|| (Arc::clone(lighting), view_of_environment)),
        }
    }

    fn act(&mut self, action: Action, context: &egui::Context, picture: Rect) {
        match action {
            Action::Close => context.send_viewport_cmd(ViewportCommand::Close),
            Action::ExposeAutomatically => self.expose_automatically(),
            Action::SavePicture => {
                let [width, height] = (picture.size() * context.pixels_per_point()).round().into();
                let saved = self.save_picture(width as u32, height as u32);
                self.message = describe(saved, || "cannot save the picture".to_owned())
                    .map_or_else(|error| error, |path| format!("wrote {}", path.display()));
            }
        }
    }

    fn expose_automatically(&mut self) {
        let frame = lock(&self.viewport).render(&self.shot_of_size(EXPOSURE_SIDE, EXPOSURE_SIDE, 1));
        match frame {
            Ok(frame) => {
                self.settings.exposure = 0.0;
                self.settings.expose(picture::automatic_exposure(&frame));
            }
            Err(error) => self.message = format!("{error:#}"),
        }
    }

    /// Writes the picture without the panel, beside the baked file.
    fn save_picture(&self, width: u32, height: u32) -> anyhow::Result<PathBuf> {
        let shot = self.shot_of_size(width.max(1), height.max(1), 1);
        let frame = lock(&self.viewport).render(&shot)?;
        let camera = self.settings.orbit.camera();
        let backdrop = shot.background.as_ref().map(|(lighting, _)| Backdrop {
            lighting,
            scene_from_environment: self.settings.scene_from_environment,
            camera: &camera,
        });
        let path = unused_name(&self.path);
        picture::save(&picture::develop(&frame, backdrop.as_ref()), &path, shot.exposure)?;
        Ok(path)
    }

    fn take_capture(&mut self, context: &egui::Context) {
        let Some(outcome) = self.capture.as_mut().and_then(|capture| capture.step(context)) else { return };
        self.capture = None;
        set_failure(&self.failure, outcome.err());
    }

    /// Lets time go on, if it does.
    fn play(&mut self, ui: &Ui) {
        if self.settings.plays {
            // Tracing every frame would hold the window up.
            if self.settings.part == Part::Traced {
                self.settings.part = Part::Full;
            }
            self.settings.advance(ui.input(|input| input.stable_dt).min(LONGEST_STEP));
            ui.ctx().request_repaint();
        }
    }

    fn measure(&mut self, ui: &Ui) {
        if self.settings.draws_continuously {
            ui.ctx().request_repaint();
            let last = ui.input(|input| input.unstable_dt);
            self.frame_seconds = Some(self.frame_seconds.map_or(last, |mean| mean + SMOOTHING * (last - mean)));
        } else {
            self.frame_seconds = None;
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let before = self.settings.clone();
        self.add_dropped_environments(ui.ctx());
        let action = self.use_keys(ui);
        self.play(ui);
        self.show_panel(ui, frame.info().cpu_usage);
        let picture = egui::CentralPanel::no_frame().show(ui, |ui| self.show_picture(ui)).inner;
        if let Some(action) = action {
            self.act(action, ui.ctx(), picture);
            ui.ctx().request_repaint();
        }
        if let Some(fault) = lock(&self.viewport).take_fault() {
            self.message = fault;
        }
        if self.settings != before {
            self.changed = ui.input(|input| input.time);
            ui.ctx().request_repaint();
        }
        self.measure(ui);
        self.take_capture(ui.ctx());
    }
}

fn set_failure(failure: &Failure, error: Option<anyhow::Error>) {
    *failure.lock().unwrap_or_else(PoisonError::into_inner) = error;
}

/// `NAME-1.png`, `NAME-2.png` and so on beside a file: the first that is not taken.
fn unused_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    let name = |number: u32| output_file::folder_of(path).join(format!("{stem}-{number}.png"));
    (1..u32::MAX).map(name).find(|candidate| !candidate.exists()).unwrap_or_else(|| name(0))
}

fn show_help(ui: &Ui, picture: Rect) {
    let painter = ui.painter_at(picture);
    let corner = picture.left_top() + vec2(12.0, 12.0);
    let text = painter.layout_no_wrap(controls::help_text(), FontId::monospace(11.0), Color32::from_white_alpha(220));
    let area = Align2::LEFT_TOP.anchor_size(corner, text.size()).expand(6.0);
    painter.rect_filled(area, 4.0, Color32::from_black_alpha(140));
    painter.galley(corner, text, Color32::WHITE);
}

#[cfg(test)]
mod tests;
