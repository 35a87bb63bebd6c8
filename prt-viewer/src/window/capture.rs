//! Taking a picture of the whole window and closing it: how scripts look at it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use eframe::egui::{self, ColorImage, ViewportCommand};

/// How long a window may take to hand out its picture.
const PATIENCE: Duration = Duration::from_secs(30);

/// A picture to take.
#[derive(Debug)]
pub(crate) struct Capture {
    path: PathBuf,
    /// Frames to draw before.
    frames_left: u32,
    asked: Option<Instant>,
    image: Arc<Mutex<Option<Arc<ColorImage>>>>,
}

impl Capture {
    pub(crate) fn new(path: PathBuf, frames: u32) -> Self {
        Self { path, frames_left: frames, asked: None, image: Arc::default() }
    }

    /// Why there is no picture if the window closes now.
    pub(super) fn missing(&self) -> anyhow::Error {
        anyhow!("cannot write {}: the window was closed before its picture was taken", self.path.display())
    }

    /// Called once a frame; the end of it when there is one.
    pub(super) fn step(&mut self, context: &egui::Context) -> Option<anyhow::Result<()>> {
        context.request_repaint();
        if self.frames_left > 0 {
            self.frames_left -= 1;
            return None;
        }
        let Some(asked) = self.asked else {
            let image = Arc::clone(&self.image);
            context.request_screenshot(move |taken| {
                *image.lock().unwrap_or_else(PoisonError::into_inner) = Some(taken);
            });
            self.asked = Some(Instant::now());
            return None;
        };
        let taken = self.image.lock().unwrap_or_else(PoisonError::into_inner).take();
        let outcome = match taken {
            Some(image) => Some(save(&image, &self.path).map_err(Into::into)),
            None => (asked.elapsed() > PATIENCE)
                .then(|| Err(anyhow!("cannot write {}: the window gave no picture", self.path.display()))),
        };
        if outcome.is_some() {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
        outcome
    }
}

fn save(image: &ColorImage, path: &Path) -> Result<(), prt_bake::Error> {
    let [width, height] = image.size;
    let pixels: Vec<[u8; 3]> = image.pixels.iter().map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    prt_bake::save_png(path, width, height, &pixels)
}
