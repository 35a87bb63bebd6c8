use std::path::{Path, PathBuf};

use prt_bake::{
    BakeOptions, BakeReport, BakedSurface, Error, Mesh, MeshOptions, MeshReport, Source, bake_diffuse, load_mesh,
};
use serde::Serialize;
use sh_core::Order;

use super::bake_patch::{self, Common, Origin, PatchArguments};
use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{arguments, cancel, memory, output, output_file};

/// Bakes how a mesh or a relief answers light into a .prt file
///
/// Meshes are .glb, .gltf, .obj, .ply and .off. An image is a height field, as is one of the built-in patterns bumps, weave, waffle and
/// swirl: it becomes a texture of zonal lobes (.prt, or .exr with named channels) that tiles and can be laid over any surface. Ctrl-C
/// stops without leaving a file.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The mesh, or the height field
    scene: PathBuf,
    /// The baked file; by default the name of the scene with .prt, in the current folder
    #[arg(short, long, value_name = "OUT.prt")]
    output: Option<PathBuf>,
    /// Bands of spherical harmonics, 1 to 32: n² coefficients per vertex
    #[arg(long, value_name = "N", default_value = "6", value_parser = arguments::order)]
    order: Order,
    /// Rays per vertex or texel, over the hemisphere
    #[arg(long, value_name = "COUNT", default_value = "4096", value_parser = arguments::rays)]
    rays: usize,
    /// Diffuse interreflections to follow
    #[arg(long, value_name = "COUNT", default_value = "0", value_parser = arguments::bounces)]
    bounces: usize,
    /// Rotates the set of rays; the same seed gives the same file
    #[arg(long, default_value = "0")]
    seed: u64,
    /// Threads; by default all
    #[arg(long, value_name = "COUNT", value_parser = arguments::threads)]
    threads: Option<usize>,
    /// Leave out shadows: exact, from the normals alone
    #[arg(long)]
    unshadowed: bool,
    /// Keep shadowed transfer beside the one with interreflections, to switch between them
    #[arg(long)]
    keep_shadowed: bool,
    /// Albedo where the mesh has no material, linear [default: 0.8,0.8,0.8]
    #[arg(long, value_name = "R,G,B", value_parser = arguments::albedo, allow_hyphen_values = true)]
    albedo: Option<[f32; 3]>,
    /// Faces that meet at a larger angle have an edge between them, where the mesh has no normals
    #[arg(long, value_name = "DEGREES", default_value = "75", value_parser = arguments::crease, allow_hyphen_values = true)]
    crease: f32,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    patch: PatchArguments,
}

/// The name of the scene with `.prt`, in the current folder.
pub(crate) fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    Path::new(stem).with_extension("prt")
}

impl Arguments {
    fn output(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| default_output(&self.scene))
    }

    /// What a height field takes of the options.
    fn common(&self) -> Common {
        Common {
            output: self.output.clone(),
            order: self.order,
            rays: self.rays,
            bounces: self.bounces,
            seed: self.seed,
            threads: self.threads,
            shadowed: !self.unshadowed,
            albedo: self.albedo,
            json: self.json,
        }
    }

    fn mesh_options(&self) -> MeshOptions {
        let defaults = MeshOptions::default();
        let albedo = self.albedo.unwrap_or(defaults.albedo);
        MeshOptions { crease_angle: self.crease.to_radians(), albedo, ..defaults }
    }

    fn bake_options(&self) -> BakeOptions {
        BakeOptions {
            order: self.order,
            rays_per_vertex: self.rays,
            shadowed: !self.unshadowed,
            bounces: self.bounces,
            keep_shadowed: self.keep_shadowed,
            seed: self.seed,
            threads: self.threads,
            ..BakeOptions::default()
        }
    }
}

/// Wall time of the steps.
#[derive(Debug, Serialize)]
struct Seconds {
    /// Reading and cleaning the mesh.
    load: f64,
    /// The tree and the set of directions.
    build: f64,
    trace: f64,
    write: f64,
    total: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    output: String,
    vertices: usize,
    triangles: usize,
    faces_dropped: usize,
    faces_degenerate: usize,
    faces_duplicate: usize,
    faces_not_finite: usize,
    vertices_unused: usize,
    vertices_split: usize,
    order: usize,
    channels: usize,
    rays_per_vertex: usize,
    rays_traced: u64,
    bounces: usize,
    /// Length of what each bounce adds, relative to direct transfer.
    bounce_energy: Vec<f64>,
    /// Share of the rays towards the light that meet something.
    occluded_share: f64,
    /// Estimated relative error of shadowed transfer; `null` without rays.
    error: Option<f64>,
    seed: u64,
    threads: usize,
    seconds: Seconds,
    mrays_per_second: f64,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.unshadowed && arguments.bounces > 0 {
        return Err(output::usage("--bounces needs shadowed transfer: leave out --unshadowed"));
    }
    if let Some(origin) = Origin::of(&arguments.scene) {
        return bake_patch::run(&arguments.scene, &origin, &arguments.patch, &arguments.common());
    }
    if arguments.patch.is_asked_for() {
        return Err(output::usage(
            "--height, --texels, --sigma-s and --brdf are for height fields; the scene is a mesh",
        ));
    }
    let mut laps = Laps::start();
    let output = arguments.output();
    output_file::check(&output)?;
    output_file::check_differs(&output, &arguments.scene)?;
    cancel::listen()?;
    let (mesh, mesh_report) = load(arguments)?;
    let source = Source::of_file(&arguments.scene)?;
    let load = laps.lap();
    cancel::check()?;
    let (mut baked, bake_report) = bake(&mesh, &arguments.bake_options(), &arguments.scene.display().to_string())?;
    baked.metadata.source = Some(source);
    cancel::check()?;
    laps.lap();
    let output_bytes = baked.write(&output)?;
    let seconds = Seconds {
        load,
        build: bake_report.build.as_secs_f64(),
        trace: bake_report.trace.as_secs_f64(),
        write: laps.lap(),
        total: laps.total(),
    };
    let report = report(arguments, &output, output_bytes, &baked, &mesh_report, bake_report, seconds);
    output::result(arguments.json, &report, || summary(&report))
}

/// Reads and cleans the mesh.
fn load(arguments: &Arguments) -> anyhow::Result<(Mesh, MeshReport)> {
    let source = load_mesh(&arguments.scene)?;
    cancel::check()?;
    Mesh::new(source, &arguments.mesh_options()).map_err(|error| name_file(error, &arguments.scene.display()))
}

/// Bakes with a progress bar.
pub(crate) fn bake(mesh: &Mesh, options: &BakeOptions, name: &str) -> anyhow::Result<(BakedSurface, BakeReport)> {
    let bar = BakeBar::new();
    let baked = bake_diffuse(mesh, options, &bar);
    bar.finish();
    baked.map_err(|error| name_file(error, &name))
}

/// Million rays per second of tracing; 0 if there was nothing to trace.
pub(crate) fn mrays_per_second(report: &BakeReport) -> f64 {
    let seconds = report.trace.as_secs_f64();
    if seconds > 0.0 { report.rays_traced as f64 / seconds / 1e6 } else { 0.0 }
}

/// Says what could not be baked, for errors that do not name the file themselves.
fn name_file(error: Error, name: &dyn std::fmt::Display) -> anyhow::Error {
    match error {
        Error::EmptyMesh { .. } | Error::InconsistentMesh(_) | Error::Option(_) => {
            anyhow::Error::from(error).context(format!("cannot bake {name}"))
        }
        _ => error.into(),
    }
}

fn report(
    arguments: &Arguments,
    output: &Path,
    output_bytes: u64,
    baked: &BakedSurface,
    mesh: &MeshReport,
    bake: BakeReport,
    seconds: Seconds,
) -> Report {
    Report {
        scene: arguments.scene.display().to_string(),
        output: output.display().to_string(),
        vertices: baked.geometry.positions.len(),
        triangles: baked.geometry.triangles.len(),
        faces_dropped: mesh.faces_dropped(),
        faces_degenerate: mesh.degenerate,
        faces_duplicate: mesh.duplicate,
        faces_not_finite: mesh.non_finite,
        vertices_unused: mesh.vertices_unused,
        vertices_split: mesh.vertices_split,
        order: baked.transfer.order.get(),
        channels: baked.transfer.channels,
        rays_per_vertex: baked.metadata.rays,
        rays_traced: bake.rays_traced,
        bounces: baked.metadata.bounces,
        occluded_share: bake.occluded_share,
        error: bake.error,
        seed: baked.metadata.seed,
        threads: bake.threads,
        mrays_per_second: mrays_per_second(&bake),
        bounce_energy: bake.bounce_energy,
        seconds,
        peak_memory_bytes: memory::peak_bytes(),
        output_bytes,
    }
}

fn summary(report: &Report) -> String {
    let mesh = format!(
        "{} vertices, {} triangles ({} dropped), order {}, {} channel{}",
        output::count(report.vertices as u64),
        output::count(report.triangles as u64),
        output::count(report.faces_dropped as u64),
        report.order,
        report.channels,
        if report.channels == 1 { "" } else { "s" }
    );
    let memory = report.peak_memory_bytes.map(|bytes| format!(", peak memory {}", output::bytes(bytes)));
    let error = report.error.map(|error| format!(", error about {:.2} %", 100.0 * error));
    format!(
        "{mesh}\n{} bounces, {} rays in {:.2} s ({:.1} Mrays/s){}\nwrote {} ({}) after {:.2} s{}",
        report.bounces,
        output::count(report.rays_traced),
        report.seconds.trace,
        report.mrays_per_second,
        error.unwrap_or_default(),
        report.output,
        output::bytes(report.output_bytes),
        report.seconds.total,
        memory.unwrap_or_default()
    )
}
