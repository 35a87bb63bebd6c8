use std::path::PathBuf;
use std::sync::Arc;

use anyhow::bail;
use sh_core::Order;

use crate::arguments::{self, CameraArguments, LightArguments, Size};
use crate::camera::Orbit;
use crate::lighting::Lighting;
use crate::model::ModelArguments;
use crate::motion::MotionArguments;
use crate::shading::Part;
use crate::sky::BuiltIn;
use crate::window::{self, Capture, Subject};

/// Shows a baked file in a window
///
/// Drag to turn the object, right drag to turn the light; all of the mouse and the keys are listed below and in the window.
/// Exit status 1 where there is no display or no usable GPU adapter.
#[derive(Debug, clap::Args)]
#[command(after_help = after_help())]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    motion: MotionArguments,
    /// Which light paths to show at first [default: all that are there]
    #[arg(long, value_enum)]
    part: Option<Part>,
    /// Environments: latitude-longitude .hdr or .exr, or folders with the faces of a cube map. The built-in ones follow in the list
    #[arg(long, value_name = "FILE", num_args = 1..)]
    env: Vec<PathBuf>,
    #[command(flatten)]
    light: LightArguments,
    #[command(flatten)]
    camera: CameraArguments,
    /// Brightness at first, in stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = arguments::stops, allow_hyphen_values = true)]
    exposure: f32,
    /// Size of the window
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x800", value_parser = arguments::size)]
    size: Size,
    /// Draw some frames, write what the window shows and close it
    #[arg(long, value_name = "FILE.png", value_parser = arguments::png_file)]
    screenshot: Option<PathBuf>,
    /// Frames to draw before the screenshot
    #[arg(long, value_name = "COUNT", default_value = "10", requires = "screenshot")]
    frames: u32,
}

fn after_help() -> String {
    format!("Mouse and keys:\n{}", window::help_text())
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut model = arguments.model.read()?;
    let motion = arguments.motion.apply(&mut model)?;
    if let Some(reason) = window::no_display() {
        bail!("cannot open a window: {reason}; `prt render` writes a picture without one");
    }
    let camera = arguments.camera.camera(&model.pose(&motion).positions, window::picture_aspect(arguments.size))?;
    let subject = Subject {
        path: arguments.model.file.clone(),
        lightings: lightings(&arguments.env, model.order())?,
        scene_from_environment: arguments.light.scene_from_environment(),
        orbit: Orbit::through(&camera),
        exposure: arguments.exposure,
        model: Arc::new(model),
        motion,
        part: arguments.part,
    };
    let capture = arguments.screenshot.clone().map(|path| Capture::new(path, arguments.frames));
    window::open(subject, arguments.size, capture)
}

/// The files, then the built-in environments.
pub(crate) fn lightings(files: &[PathBuf], order: Order) -> Result<Vec<Lighting>, prt_bake::Error> {
    let loaded = files.iter().map(|path| Lighting::load(path, order));
    let built_in = BuiltIn::ALL.into_iter().map(|built_in| Ok(Lighting::built_in(built_in, order)));
    loaded.chain(built_in).collect()
}
