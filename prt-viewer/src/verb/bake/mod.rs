mod effort;
mod keeping;
mod report;
mod several;
mod texels;

use std::path::{Path, PathBuf};

use prt_bake::{
    BakeOptions, BakeReport, BakeTarget, BakedSurface, Error, FileReport, InsidePolicy, Mesh, MeshOptions, MeshReport,
    Source, TexelOptions, TwoSided, bake_diffuse, bake_to_file, load_mesh,
};

use super::bake_patch::{self, Common, Origin, PatchArguments};
use super::reporting::Reporting;
use crate::arguments::{self, Size};
use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{cancel, output, output_file};
use effort::{Decision, Effort};
use keeping::Keeping;
use report::{Report, Seconds};
pub(crate) use texels::is_exr;

/// Bakes how a mesh or a relief answers light into a .prt file
///
/// Meshes are .glb, .gltf, .obj, .ply and .off. An image is a height field, as is one of the built-in patterns bumps, weave, waffle and
/// swirl: it becomes a texture of zonal lobes (.prt, or .exr with named channels) that tiles and can be laid over any surface.
///
/// What is done of a mesh or its texels is kept in OUT.journal, the name of the output with .journal, until it is complete: after Ctrl-C, a crash or a power failure, --resume goes on from
/// there, to the same bytes.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The mesh, or the height field; several meshes are baked one after another
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The baked file, or the folder for several; by default the name of the scene with .prt, in the current folder
    #[arg(short, long, value_name = "OUT.prt")]
    output: Option<PathBuf>,
    #[command(flatten)]
    effort: Effort,
    /// Diffuse interreflections to follow [default: 0, or as many as --bounce-threshold takes]
    #[arg(long, value_name = "COUNT", value_parser = arguments::bounces)]
    bounces: Option<usize>,
    /// Follow interreflections until one adds less than this share of the direct transfer
    #[arg(long, value_name = "SHARE", value_parser = arguments::share)]
    bounce_threshold: Option<f64>,
    /// What becomes of vertices inside of solids: fill them from their neighbours, keep what they see, or make them black
    #[arg(long, value_name = "POLICY", default_value = "fill", value_parser = InsidePolicy::NAMES)]
    inside: String,
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
    /// Faces that have transfer on their back too: those that the file says, all, or none
    #[arg(long, value_name = "WHICH", value_enum, default_value = "file")]
    two_sided: Sides,
    /// Bake the texels of a mesh's texture coordinates instead of its vertices, to OUT.exr; of a height field, the texels of the result
    #[arg(long, value_name = "SIZE|WIDTHxHEIGHT", value_parser = arguments::texels)]
    texels: Option<Size>,
    /// Empty texels around a chart that are filled from it
    #[arg(long, value_name = "TEXELS", default_value = "4", value_parser = arguments::gutter, requires = "texels")]
    gutter: usize,
    #[command(flatten)]
    keeping: Keeping,
    #[command(flatten)]
    reporting: Reporting,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    patch: PatchArguments,
}

/// Which faces are two-sided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Sides {
    File,
    All,
    None,
}

/// The name of the scene with `.prt`, in the current folder.
pub(crate) fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    Path::new(stem).with_extension("prt")
}

impl Arguments {
    /// What a height field takes of the options.
    fn common(&self) -> anyhow::Result<Common> {
        Ok(Common {
            output: self.output.clone(),
            order: self.effort.fixed_order()?,
            rays: self.effort.fixed_rays()?,
            bounces: self.bounce_count(),
            seed: self.seed,
            threads: self.threads,
            shadowed: !self.unshadowed,
            albedo: self.albedo,
            json: self.json,
            texels: self.texels,
        })
    }

    /// Most bounces to follow.
    fn bounce_count(&self) -> usize {
        let most = if self.bounce_threshold.is_some() { BakeOptions::MAX_BOUNCES } else { 0 };
        self.bounces.unwrap_or(most)
    }

    fn mesh_options(&self) -> MeshOptions {
        let defaults = MeshOptions::default();
        let albedo = self.albedo.unwrap_or(defaults.albedo);
        let two_sided = match self.two_sided {
            Sides::File => TwoSided::AsFile,
            Sides::All => TwoSided::Always,
            Sides::None => TwoSided::Never,
        };
        MeshOptions { crease_angle: self.crease.to_radians(), albedo, two_sided, ..defaults }
    }

    fn bake_options(&self) -> BakeOptions {
        self.effort.options(&BakeOptions {
            shadowed: !self.unshadowed,
            bounces: self.bounce_count(),
            bounce_threshold: self.bounce_threshold,
            inside: self.inside.parse().unwrap_or_default(),
            keep_shadowed: self.keep_shadowed,
            seed: self.seed,
            threads: self.threads,
            ..BakeOptions::default()
        })
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.unshadowed && arguments.bounce_count() > 0 {
        return Err(output::usage("--bounces needs shadowed transfer: leave out --unshadowed"));
    }
    let origins: Vec<Origin> = arguments.scenes.iter().filter_map(|scene| Origin::of(scene)).collect();
    if arguments.reporting.is_asked_for() && (arguments.texels.is_some() || !origins.is_empty()) {
        return Err(output::usage("--report is for the vertices of meshes, not for texels and height fields"));
    }
    if arguments.reporting.is_asked_for() && arguments.keeping.is_part() {
        return Err(output::usage("--report is for whole bakes, not for a --part; prt merge writes one of all parts"));
    }
    match (arguments.scenes.as_slice(), origins.as_slice()) {
        ([scene], [origin]) => run_patch(arguments, scene, origin),
        (_, [_, ..]) => Err(output::usage("height fields are baked one at a time")),
        _ if arguments.patch.is_asked_for() => {
            Err(output::usage("--height, --sigma-s and --brdf are for height fields; the scene is a mesh"))
        }
        ([scene], _) => match arguments.texels {
            Some(size) => texels::run(arguments, scene, size),
            None => run_mesh(arguments, scene),
        },
        _ if arguments.texels.is_some() => Err(output::usage("texels are baked for one mesh at a time")),
        (scenes, _) => several::run(arguments, scenes),
    }
}

fn run_patch(arguments: &Arguments, scene: &Path, origin: &Origin) -> anyhow::Result<()> {
    if arguments.keeping.is_asked_for() {
        return Err(output::usage(
            "--resume, --restart, --update and --part are for meshes; the scene is a height field",
        ));
    }
    bake_patch::run(scene, origin, &arguments.patch, &arguments.common()?)
}

fn run_mesh(arguments: &Arguments, scene: &Path) -> anyhow::Result<()> {
    let output = arguments.output.clone().unwrap_or_else(|| arguments.keeping.default_output(scene, "prt"));
    anyhow::ensure!(
        arguments.keeping.is_part() || !is_exr(&output),
        "cannot write {}: vertices are written as .prt",
        output.display()
    );
    output_file::check(&output)?;
    arguments.reporting.check(scene, &output, false)?;
    cancel::listen()?;
    arguments.keeping.lower_priority()?;
    let report = bake_mesh(arguments, scene, output)?;
    output::result(arguments.json, &report, || report.summary())
}

/// Bakes one mesh into a file.
fn bake_mesh(arguments: &Arguments, scene: &Path, output: PathBuf) -> anyhow::Result<Report> {
    let mut laps = Laps::start();
    output_file::check_differs(&output, scene)?;
    let (mesh, cleaning) = load(arguments, scene)?;
    let target = arguments.keeping.target(output, Source::of_file(scene)?);
    let load = laps.lap();
    cancel::check()?;
    let name = scene.display().to_string();
    let (options, decision) = decide(arguments, &mesh, None, &target, &name)?;
    let plan = laps.lap();
    let file = bake_file(&target, &name, |bar| bake_to_file(&mesh, &options, &target, bar))?;
    let seconds = Seconds::new([load, plan, laps.lap()], laps.total(), &file.bake);
    let report = Report::new(scene, &target, &mesh, &cleaning, (&options, decision), &file, seconds);
    arguments.reporting.write(&output::file_name(scene), &target.path, &file, &report)?;
    Ok(report)
}

/// Reads and cleans the mesh.
fn load(arguments: &Arguments, scene: &Path) -> anyhow::Result<(Mesh, MeshReport)> {
    let source = load_mesh(scene)?;
    cancel::check()?;
    let (mesh, report) =
        Mesh::new(source, &arguments.mesh_options()).map_err(|error| name_file(error, &scene.display()))?;
    report.warnings.iter().for_each(|warning| output::note(format_args!("{}: {warning}", scene.display())));
    Ok((mesh, report))
}

/// The options of the bake, and how what was left open was decided.
fn decide(
    arguments: &Arguments,
    mesh: &Mesh,
    texels: Option<&TexelOptions>,
    target: &BakeTarget,
    name: &str,
) -> anyhow::Result<(BakeOptions, Decision)> {
    let mut options = arguments.bake_options();
    let bar = BakeBar::new();
    let decision = arguments.effort.decide(mesh, texels, target, &mut options, &bar);
    bar.finish();
    Ok((options, decision.map_err(|error| name_file(error, &name))?))
}

/// Bakes with a progress bar.
pub(crate) fn bake(mesh: &Mesh, options: &BakeOptions, name: &str) -> anyhow::Result<(BakedSurface, BakeReport)> {
    let bar = BakeBar::new();
    let baked = bake_diffuse(mesh, options, &bar);
    bar.finish();
    baked.map_err(|error| name_file(error, &name))
}

/// Bakes into a file with a progress bar.
fn bake_file(
    target: &BakeTarget,
    name: &str,
    bake: impl FnOnce(&BakeBar) -> Result<FileReport, Error>,
) -> anyhow::Result<FileReport> {
    let bar = BakeBar::new();
    let baked = bake(&bar);
    bar.finish();
    keeping::explain(baked, target).map_err(|error| name_file(error, &name))
}

/// Million rays per second of tracing; 0 if there was nothing to trace.
pub(crate) fn mrays_per_second(report: &BakeReport) -> f64 {
    let seconds = report.trace.as_secs_f64();
    if seconds > 0.0 { report.rays_traced as f64 / seconds / 1e6 } else { 0.0 }
}

/// Says what could not be baked, for errors that do not name the file themselves.
fn name_file(error: impl Into<anyhow::Error>, name: &dyn std::fmt::Display) -> anyhow::Error {
    let error = error.into();
    match error.downcast_ref() {
        Some(Error::EmptyMesh { .. } | Error::InconsistentMesh(_) | Error::Atlas(_) | Error::Option(_)) => {
            error.context(format!("cannot bake {name}"))
        }
        _ => error,
    }
}
