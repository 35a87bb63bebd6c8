use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use glam::{Quat, Vec3};
use prt_bake::{BakeOptions, BakeReport, BakedSurface, Mesh, MeshOptions};
use prt_gpu::{Evaluation, View};
use serde::Serialize;
use sh_core::Order;

use crate::arguments::Size;
use crate::camera::{Camera, Orbit, Sphere};
use crate::demo_scene::demo_scene;
use crate::laps::Laps;
use crate::lighting::Lighting;
use crate::model::Model;
use crate::motion::Motion;
use crate::picture::{self, Backdrop};
use crate::shading::{self, Backend, Drawing, Part, Shaded, Shot};
use crate::window::{self, Subject};
use crate::{arguments, cancel, output, output_file};

const SIZE: Size = Size { width: 1280, height: 800 };
const SAMPLES: u32 = 3;
/// Stops: the things of the scene are darker than the white that a sky is made for.
const EXPOSURE: f32 = 0.5;
/// The picture and the baked file of the main job, in the current folder.
const PICTURE: &str = "prt-demo.png";
const BAKED: &str = "prt-demo.prt";

/// The main job: what `prt` does without a verb.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Without a verb: open no window
    #[arg(long)]
    no_window: bool,
    /// Without a verb: what draws the picture
    #[arg(long, value_enum, default_value = "auto")]
    backend: Backend,
    /// Without a verb: rays per vertex
    #[arg(long, value_name = "COUNT", default_value = "896", value_parser = arguments::rays)]
    rays: usize,
    /// Without a verb: print one JSON object, before the window opens
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Seconds {
    bake: f64,
    render: f64,
    /// From the start of the program to the picture.
    total: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    picture: &'static str,
    baked: &'static str,
    vertices: usize,
    triangles: usize,
    order: usize,
    bounces: usize,
    rays_traced: u64,
    mrays_per_second: f64,
    backend: &'static str,
    adapter: Option<String>,
    seconds: Seconds,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    output_file::check(Path::new(PICTURE))?;
    output_file::check(Path::new(BAKED))?;
    cancel::listen()?;

    output::note("baking the built-in scene");
    let (baked, bake_report) = bake(arguments.rays)?;
    baked.write(Path::new(BAKED))?;
    cancel::check()?;
    let bake_seconds = laps.lap();

    let camera = camera();
    let lightings = super::view::lightings(&[], baked.transfer.order)?;
    let model = Model::from(baked);
    let shaded =
        shade(&model, &lightings[0], &camera, arguments.backend).context("cannot render the built-in scene")?;
    let backdrop = Backdrop { lighting: &lightings[0], scene_from_environment: Quat::IDENTITY, camera: &camera };
    picture::save(&picture::develop(&shaded.frame, Some(&backdrop)), Path::new(PICTURE), EXPOSURE)?;
    cancel::stop_listening();

    let report = Report {
        picture: PICTURE,
        baked: BAKED,
        vertices: model.geometry().vertex_count(),
        triangles: model.geometry().triangles.len(),
        order: model.order().get(),
        bounces: model.metadata().bounces,
        rays_traced: bake_report.rays_traced,
        mrays_per_second: super::bake::mrays_per_second(&bake_report),
        backend: shaded.backend,
        adapter: shaded.adapter,
        seconds: Seconds { bake: bake_seconds, render: laps.lap(), total: laps.total() },
    };
    output::result(arguments.json, &report, || summary(&report))?;
    if !arguments.no_window {
        open_window(model, lightings, &camera);
    }
    Ok(())
}

fn bake(rays_per_vertex: usize) -> anyhow::Result<(BakedSurface, BakeReport)> {
    let (mesh, _) = Mesh::new(demo_scene(), &MeshOptions::default()).context("cannot build the built-in scene")?;
    let options = BakeOptions {
        order: Order::new(6)?,
        rays_per_vertex,
        bounces: 2,
        keep_shadowed: true,
        ..BakeOptions::default()
    };
    super::bake::bake(&mesh, &options, "the built-in scene")
}

/// From the front and above, with the whole plate in the picture.
fn camera() -> Camera {
    Camera { eye: Vec3::new(0.9, 2.2, 6.2), target: Vec3::new(0.0, 0.62, 0.0), up: Vec3::Y, fov: 30_f32.to_radians() }
}

fn shade(model: &Model, lighting: &Lighting, camera: &Camera, backend: Backend) -> anyhow::Result<Shaded> {
    let order = model.order();
    let light = lighting.light(order, Quat::IDENTITY);
    let positions = &model.geometry().positions;
    let clip_from_world = camera.clip_from_world(SIZE.aspect(), Sphere::around(positions));
    let view = View::new(clip_from_world.to_cols_array_2d(), SIZE.width, SIZE.height, SAMPLES)?;
    let transfer = model.transfer(Part::Full, &Motion::default(), 0, &())?;
    let drawing = Drawing::new(model, &transfer, positions, &[])?;
    let shot = Shot { light: &light, order, eye: camera.eye.to_array(), evaluation: Evaluation::Direct, view: &view };
    shading::shade(&drawing, &shot, backend)
}

/// The picture is written: a machine without a display has done the job.
fn open_window(model: Model, lightings: Vec<Lighting>, camera: &Camera) {
    let mut orbit = Orbit::through(camera);
    // As far away as all that the picture shows is beside the panel.
    orbit.zoom(SIZE.aspect() / window::picture_aspect(SIZE), Sphere::around(&model.geometry().positions));
    let subject = Subject {
        path: PathBuf::from(BAKED),
        model: Arc::new(model),
        motion: Motion::default(),
        part: None,
        lightings,
        scene_from_environment: Quat::IDENTITY,
        orbit,
        exposure: EXPOSURE,
    };
    if let Err(error) = window::open(subject, SIZE, None) {
        output::note(format_args!("no window: {}; the picture is in {PICTURE}", output::one_line(&error)));
    }
}

fn summary(report: &Report) -> String {
    let place = match &report.adapter {
        Some(adapter) => format!("the GPU {adapter}"),
        None => "the CPU".to_owned(),
    };
    format!(
        "baked {} vertices, order {}, {} bounces: {} rays in {:.1} s ({:.1} Mrays/s)\nwrote {} (drawn by {place}) and {}, {:.1} s after the start",
        output::count(report.vertices as u64),
        report.order,
        report.bounces,
        output::count(report.rays_traced),
        report.seconds.bake,
        report.mrays_per_second,
        report.picture,
        report.baked,
        report.seconds.total
    )
}
