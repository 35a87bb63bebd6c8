use std::path::PathBuf;

use anyhow::Context;
use glam::Vec3;
use prt_bake::{Image, Progress};
use prt_gpu::{Evaluation, View};
use serde::Serialize;
use sh_core::Order;

use crate::arguments::{self, LightArguments, Size};
use crate::camera::{Camera, DEFAULT_FOV, Orbit, Side, Sphere};
use crate::difference::{Difference, relative_l2};
use crate::laps::Laps;
use crate::lighting::Lighting;
use crate::progress_bar::BakeBar;
use crate::shading::{self, Backend, Drawing, Part, Shot};
use crate::showcase::{Effort, Exhibit, Name};
use crate::{cancel, output, output_file, picture};

/// Shows zonal lobes on things that deform, beside ray tracing
///
/// Each row of the picture is one thing in one pose: unshadowed, lobes as they were baked (wrong on purpose), lobes that turn with
/// the surface, and transfer traced anew. What is printed is how far each is from the traced picture, as the L2 norm of the difference over
/// that of the picture.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// What to show
    #[arg(value_enum)]
    name: Name,
    /// The picture; by default prt-demo-NAME.png in the current folder
    #[arg(short, long, value_name = "OUT.png|exr", value_parser = arguments::picture_file)]
    output: Option<PathBuf>,
    /// A mesh in place of our own head
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Bands of spherical harmonics
    #[arg(long, value_name = "N", default_value = "6", value_parser = arguments::order)]
    order: Order,
    /// Lobes per vertex or texel
    #[arg(long, value_name = "N", default_value = "4", value_parser = arguments::lobes)]
    lobes: usize,
    /// Rays per vertex or texel, for lobes and for the truth
    #[arg(long, value_name = "COUNT", default_value = "1024", value_parser = arguments::rays)]
    rays: usize,
    /// Cells along a side of a texture's tile, for the mesh that its relief is raised on and traced
    #[arg(long, value_name = "COUNT", default_value = "64", value_parser = arguments::cells)]
    cells: usize,
    /// The environment: as for render
    #[arg(long, value_name = "FILE", default_value = "sky")]
    env: PathBuf,
    #[command(flatten)]
    light: LightArguments,
    /// Size of one picture
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "384x384", value_parser = arguments::size)]
    size: Size,
    /// Brightness of a .png in stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = arguments::stops, allow_hyphen_values = true)]
    exposure: f32,
    /// What draws
    #[arg(long, value_enum, default_value = "auto")]
    backend: Backend,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The columns of the picture.
const PARTS: [Part; 4] = [Part::Unshadowed, Part::Undeformed, Part::Full, Part::Traced];
const SAMPLES: u32 = 2;

/// One picture for each of [`PARTS`], where it is there.
type Pictures = [Option<Image>; PARTS.len()];

#[derive(Debug, Serialize)]
struct Row {
    name: String,
    vertices: usize,
    /// What the lobes leave of the transfer that they were fitted to; `null` where they are a closed form.
    fit_error: Option<f64>,
    /// L2 distance from the traced picture over its L2 norm; `null` where nothing can be traced.
    unshadowed: Option<f64>,
    undeformed: Option<f64>,
    lobes: Option<f64>,
    /// `relmse` of the lobes' picture, as `compare` has it.
    relmse: Option<f64>,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    output: String,
    order: usize,
    lobes: usize,
    rays: usize,
    rows: Vec<Row>,
    seconds: f64,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    let output = arguments.output.clone().unwrap_or_else(|| default_output(arguments.name));
    output_file::check(&output)?;
    cancel::listen()?;
    let lighting = Lighting::load(&arguments.env, arguments.order)?;
    let effort =
        Effort { order: arguments.order, lobes: arguments.lobes, rays: arguments.rays, cells: arguments.cells };
    let exhibits = arguments.name.exhibits(effort, arguments.mesh.as_deref())?;
    let (mut rows, mut pictures) = (Vec::new(), Vec::new());
    laps.lap();
    for exhibit in &exhibits {
        let images = show(arguments, exhibit, &lighting).with_context(|| format!("cannot show {}", exhibit.name))?;
        rows.push(row(exhibit, &images, laps.lap())?);
        pictures.push(images);
    }
    picture::save(&sheet(&pictures, arguments.size), &output, arguments.exposure)?;
    let report = Report {
        output: output.display().to_string(),
        order: arguments.order.get(),
        lobes: arguments.lobes,
        rays: arguments.rays,
        rows,
        seconds: laps.total(),
    };
    output::result(arguments.json, &report, || summary(&report))
}

fn default_output(name: Name) -> PathBuf {
    let name = clap::ValueEnum::to_possible_value(&name).map_or_else(String::new, |value| value.get_name().to_owned());
    PathBuf::from(format!("prt-demo-{name}.png"))
}

/// The pictures of an exhibit, one for each of [`PARTS`] that it has.
fn show(arguments: &Arguments, exhibit: &Exhibit, lighting: &Lighting) -> anyhow::Result<Pictures> {
    let bar = BakeBar::new();
    let there = exhibit.model.parts();
    let mut pictures = [const { None }; PARTS.len()];
    for (picture, part) in pictures.iter_mut().zip(PARTS).filter(|(_, part)| there.contains(part)) {
        *picture = Some(draw(arguments, exhibit, lighting, part, &bar)?);
    }
    bar.finish();
    Ok(pictures)
}

fn draw(
    arguments: &Arguments,
    exhibit: &Exhibit,
    lighting: &Lighting,
    part: Part,
    progress: &dyn Progress,
) -> anyhow::Result<Image> {
    let Exhibit { model, motion, .. } = exhibit;
    let posed = model.pose(motion);
    let frames = model.frames(part, &posed);
    let transfer = model.transfer(part, motion, arguments.rays, progress)?;
    let drawing = Drawing::new(model, &transfer, &posed.positions, &frames)?;
    let camera = camera(exhibit.from, &posed.positions, arguments.size);
    let Size { width, height } = arguments.size;
    let clip_from_world = camera.clip_from_world(arguments.size.aspect(), Sphere::around(&posed.positions));
    let view = View::new(clip_from_world.to_cols_array_2d(), width, height, SAMPLES)?;
    let order = arguments.order;
    let light = lighting.light(order, arguments.light.scene_from_environment());
    let (eye, evaluation) = (camera.eye.to_array(), Evaluation::Direct);
    let shot = Shot { light: &light, order, eye, evaluation, view: &view };
    Ok(picture::develop(&shading::shade(&drawing, &shot, arguments.backend)?.frame, None))
}

/// Frames an object from a direction.
fn camera(from: Vec3, positions: &[[f32; 3]], size: Size) -> Camera {
    let start = Orbit::framing(positions, Side::Front, Vec3::Y, DEFAULT_FOV, size.aspect());
    let camera = start.camera();
    let distance = camera.eye.distance(camera.target) * 1.05;
    Camera { eye: camera.target + distance * from.normalize(), ..camera }
}

fn row(exhibit: &Exhibit, pictures: &Pictures, seconds: f64) -> anyhow::Result<Row> {
    let pair = |column: usize| pictures[column].as_ref().zip(pictures[3].as_ref());
    let error = |column: usize| pair(column).map(|(picture, truth)| relative_l2(picture, truth)).transpose();
    let relmse = pair(2).map(|(picture, truth)| Difference::new(picture, truth, None)).transpose()?;
    Ok(Row {
        name: exhibit.name.clone(),
        vertices: exhibit.model.geometry().vertex_count(),
        fit_error: exhibit.model.metadata().fit_error,
        unshadowed: error(0)?,
        undeformed: error(1)?,
        lobes: error(2)?,
        relmse: relmse.map(|difference| difference.relmse),
        seconds,
    })
}

/// All pictures, a row for each exhibit; black where one is missing.
fn sheet(rows: &[Pictures], size: Size) -> Image {
    let [width, height] = [size.width, size.height].map(|side| side as usize);
    let columns = PARTS.len();
    let mut sheet = Image {
        width: columns * width,
        height: rows.len() * height,
        pixels: vec![[0.0; 3]; columns * width * rows.len() * height],
    };
    for (row, images) in rows.iter().enumerate() {
        for (column, image) in images.iter().enumerate().filter_map(|(column, image)| Some((column, image.as_ref()?))) {
            for (y, line) in image.pixels.chunks_exact(width).enumerate() {
                let start = (row * height + y) * sheet.width + column * width;
                sheet.pixels[start..start + width].copy_from_slice(line);
            }
        }
    }
    sheet
}

fn summary(report: &Report) -> String {
    let percent = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{:.1} %", 100.0 * error));
    let mut text = format!(
        "{:<22} {:>9} {:>9} {:>11} {:>11} {:>9}\n",
        "distance from truth", "vertices", "fit", "unshadowed", "undeformed", "lobes"
    );
    for row in &report.rows {
        text += &format!(
            "{:<22} {:>9} {:>9} {:>11} {:>11} {:>9}\n",
            row.name,
            output::count(row.vertices as u64),
            percent(row.fit_error),
            percent(row.unshadowed),
            percent(row.undeformed),
            percent(row.lobes)
        );
    }
    text + &format!("wrote {} after {:.1} s", report.output, report.seconds)
}
