use std::borrow::Cow;
use std::path::PathBuf;

use anyhow::{Context, ensure};
use prt_anim::Deformed;
use prt_gpu::{Evaluation, View};
use serde::Serialize;
use sh_core::Order;

use crate::arguments::{self, CameraArguments, LightArguments, Size};
use crate::camera::{Camera, Sphere};
use crate::laps::Laps;
use crate::lighting::Lighting;
use crate::model::{Model, ModelArguments};
use crate::motion::{Motion, MotionArguments};
use crate::picture::{self, Backdrop};
use crate::progress_bar::BakeBar;
use crate::shading::{self, Backend, Drawing, Part, Shaded, Shot};
use crate::{output, output_file};

/// Renders a baked file under an environment
///
/// Without a camera the whole object is framed, from the front, the right and above. Without a usable GPU the CPU draws, and says so.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The environment: a latitude-longitude .hdr or .exr, a folder with the faces px nx py ny pz nz of a cube map, or the name of a
    /// built-in one: sky, sunset, studio, white
    #[arg(long, value_name = "FILE", default_value = "sky")]
    env: PathBuf,
    #[command(flatten)]
    light: LightArguments,
    /// Bands to use; by default all that are baked
    #[arg(long, value_name = "K", value_parser = arguments::order)]
    order: Option<Order>,
    /// Which light paths to show, and how they follow a deformation
    #[arg(long, value_enum, default_value = "full")]
    part: Part,
    /// Rays per vertex for --part traced
    #[arg(long, value_name = "COUNT", default_value = "1024", value_parser = arguments::rays)]
    rays: usize,
    #[command(flatten)]
    motion: MotionArguments,
    /// How lobes are lit: direct, which is exact, or from a table of the light of this size, like the paper's 64x32
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "direct", value_parser = arguments::evaluation)]
    table: Evaluation,
    #[command(flatten)]
    camera: CameraArguments,
    /// Size of the picture
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1024x1024", value_parser = arguments::size)]
    size: Size,
    /// Samples per pixel along each side, 1 to 4
    #[arg(long, value_name = "COUNT", default_value = "2", value_parser = arguments::samples)]
    samples: u32,
    /// Brightness of a .png in stops, or auto
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = arguments::exposure, allow_hyphen_values = true)]
    exposure: arguments::Exposure,
    /// Show the environment behind the object instead of black
    #[arg(long)]
    show_env: bool,
    /// What draws
    #[arg(long, value_enum, default_value = "auto")]
    backend: Backend,
    /// The picture: .png is tone-mapped, .exr is linear radiance
    #[arg(short, long, value_name = "OUT.png|exr", value_parser = arguments::picture_file)]
    output: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Steps {
    load: f64,
    environment: f64,
    /// Opening the GPU included.
    shade: f64,
    write: f64,
}

#[derive(Debug, Serialize)]
struct Report<'a> {
    file: Cow<'a, str>,
    output: Cow<'a, str>,
    env: Cow<'a, str>,
    backend: &'static str,
    /// Name and driver of the GPU; `null` on the CPU.
    adapter: Option<String>,
    /// Everything, from reading to writing.
    seconds: f64,
    steps: Steps,
    width: u32,
    height: u32,
    samples: u32,
    vertices: usize,
    triangles: usize,
    order: usize,
    exposure: f32,
    camera: CameraReport,
}

#[derive(Debug, Serialize)]
struct CameraReport {
    eye: [f32; 3],
    target: [f32; 3],
    up: [f32; 3],
    /// Vertical, degrees.
    fov: f32,
}

impl CameraReport {
    fn new(camera: &Camera) -> Self {
        let Camera { eye, target, up, fov } = camera;
        Self { eye: eye.to_array(), target: target.to_array(), up: up.to_array(), fov: fov.to_degrees() }
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    output_file::check(&arguments.output)?;
    let mut model = arguments.model.read()?;
    let motion = arguments.motion.apply(&mut model)?;
    let posed = model.pose(&motion);
    let order = used_order(arguments, &model)?;
    let camera = arguments.camera.camera(&posed.positions, arguments.size.aspect())?;
    let load = laps.lap();

    let lighting = Lighting::load(&arguments.env, order)?;
    let environment = laps.lap();

    let scene_from_environment = arguments.light.scene_from_environment();
    let light = lighting.light(order, scene_from_environment);
    let shaded = shade(arguments, &model, &motion, &posed, &light, order, &camera)
        .with_context(|| format!("cannot render {}", arguments.model.file.display()))?;
    let shade = laps.lap();

    let backdrop = Backdrop { lighting: &lighting, scene_from_environment, camera: &camera };
    let image = picture::develop(&shaded.frame, arguments.show_env.then_some(&backdrop));
    let exposure = arguments.exposure.stops(&shaded.frame);
    picture::save(&image, &arguments.output, exposure)?;
    let steps = Steps { load, environment, shade, write: laps.lap() };

    let report = Report {
        file: arguments.model.file.to_string_lossy(),
        output: arguments.output.to_string_lossy(),
        env: arguments.env.to_string_lossy(),
        backend: shaded.backend,
        adapter: shaded.adapter,
        seconds: laps.total(),
        steps,
        width: arguments.size.width,
        height: arguments.size.height,
        samples: arguments.samples,
        vertices: model.geometry().vertex_count(),
        triangles: model.geometry().triangles.len(),
        order: order.get(),
        exposure,
        camera: CameraReport::new(&camera),
    };
    output::result(arguments.json, &report, || summary(&report))
}

fn used_order(arguments: &Arguments, model: &Model) -> anyhow::Result<Order> {
    let stored = model.order();
    let order = arguments.order.unwrap_or(stored);
    ensure!(
        order <= stored,
        "cannot render {} to order {order}: it is baked to order {stored}",
        arguments.model.file.display()
    );
    Ok(order)
}

/// Shades and draws the model in its pose.
fn shade(
    arguments: &Arguments,
    model: &Model,
    motion: &Motion,
    posed: &Deformed,
    light: &[f32],
    order: Order,
    camera: &Camera,
) -> anyhow::Result<Shaded> {
    let bar = BakeBar::new();
    let transfer = model.transfer(arguments.part, motion, arguments.rays, &bar);
    bar.finish();
    let (transfer, frames) = (transfer?, model.frames(arguments.part, posed));
    let drawing = Drawing::new(model, &transfer, &posed.positions, &frames)?;
    let Size { width, height } = arguments.size;
    let clip_from_world = camera.clip_from_world(arguments.size.aspect(), Sphere::around(&posed.positions));
    let view = View::new(clip_from_world.to_cols_array_2d(), width, height, arguments.samples)?;
    let shot = Shot { light, order, eye: camera.eye.to_array(), evaluation: arguments.table, view: &view };
    shading::shade(&drawing, &shot, arguments.backend)
}

fn summary(report: &Report<'_>) -> String {
    let place = match &report.adapter {
        Some(adapter) => format!("the GPU {adapter}"),
        None => "the CPU".to_owned(),
    };
    format!(
        "wrote {} ({} x {}) after {:.2} s: order {}, drawn by {place} in {:.2} s",
        report.output, report.width, report.height, report.seconds, report.order, report.steps.shade
    )
}
