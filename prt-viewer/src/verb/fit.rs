use std::path::{Path, PathBuf};

use anyhow::Context;
use prt_bake::{BakedSurface, ZonalSurface};
use serde::Serialize;
use sh_fit::{CoherentOptions, CoherentReport, FitOptions, FitReport, LobeSet, Method, Neighbours};

use crate::laps::Laps;
use crate::progress_bar::FitBar;
use crate::{arguments, cancel, lobes, output, output_file};

/// Fits zonal lobes to baked transfer, so that it can follow a deformation
///
/// Each transfer vector becomes a sum of lobes about axes of its own, which turn with the surface. Band 0 stays as it is, and from three
/// lobes on band 1 too. Source: Sloan, Luna, Snyder, "Local, deformable precomputed radiance transfer", 2005.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The baked file, of kind vertex-transfer
    file: PathBuf,
    /// The file to write, of kind zonal; by default the name of the other with -lobes, in the current folder
    #[arg(short, long, value_name = "OUT.prt")]
    output: Option<PathBuf>,
    #[command(flatten)]
    fit: FitArguments,
    /// Seed of the random starts; the same seed gives the same file
    #[arg(long, default_value = "0")]
    seed: u64,
    /// Threads; by default all
    #[arg(long, value_name = "COUNT", value_parser = arguments::threads)]
    threads: Option<usize>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// How lobes are fitted.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct FitArguments {
    /// Lobes per vertex; with a target error the most
    #[arg(long, value_name = "N", default_value = "4", value_parser = arguments::lobes)]
    pub(crate) lobes: usize,
    /// Use no more lobes than this relative error needs
    #[arg(long, value_name = "ERROR", value_parser = arguments::positive, allow_hyphen_values = true)]
    target_error: Option<f64>,
    /// With a target error: as many lobes at each vertex as it needs, not the same number everywhere
    #[arg(long, requires = "target_error")]
    per_vertex: bool,
    /// How much effort to spend
    #[arg(long, value_enum, default_value = "default")]
    effort: Effort,
    /// How lobes are found
    #[arg(long, value_enum, default_value = "projection")]
    method: Solver,
    /// Make the lobes of neighbours alike, for interpolation between them; 0 only puts them in the same order
    #[arg(long, value_name = "STRENGTH", value_parser = arguments::strength)]
    smooth: Option<f64>,
}

/// Error against time; `repro -- ldprt/fit-trade` draws the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Effort {
    Fast,
    Default,
    Thorough,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Solver {
    /// Variable projection: coefficients follow from the axes, only these are searched
    Projection,
    /// BFGS over axes and coefficients at once, the way of the paper; hundreds of times slower
    Bfgs,
    /// Conjugate gradients over axes and coefficients at once
    Cg,
}

impl FitArguments {
    /// Lobes for textures and scenes of our own.
    pub(crate) fn lobes(lobes: usize) -> Self {
        let (effort, method) = (Effort::Default, Solver::Projection);
        Self { lobes, target_error: None, per_vertex: false, effort, method, smooth: None }
    }

    /// Whether lobes of neighbours are made alike.
    pub(crate) fn is_smooth(&self) -> bool {
        self.smooth.is_some_and(|strength| strength > 0.0)
    }

    pub(crate) fn options(&self, seed: u64, threads: Option<usize>) -> FitOptions {
        let options = match self.effort {
            Effort::Fast => FitOptions::fast(),
            Effort::Default => FitOptions::default(),
            Effort::Thorough => FitOptions::thorough(),
        };
        FitOptions {
            lobe_count: self.lobes,
            target_error: self.target_error,
            per_point: self.per_vertex,
            method: match self.method {
                Solver::Projection => Method::VariableProjection,
                Solver::Bfgs => Method::QuasiNewton,
                Solver::Cg => Method::ConjugateGradient,
            },
            seed,
            threads,
            ..options
        }
    }

    /// Fits lobes to transfer vectors, and makes those of neighbours alike if that was asked for.
    pub(crate) fn fit(&self, targets: &Targets<'_>, options: &FitOptions) -> anyhow::Result<Fitted> {
        let bar = FitBar::new(targets.values.len() / (targets.channels * targets.order.coeff_count()));
        // Nothing is written yet: Ctrl-C may end the program at once.
        let _interruptible = cancel::Interruptible::new();
        let fitted = sh_fit::fit_lobes_many(
            targets.order,
            targets.channels,
            targets.values,
            Some(targets.neighbours),
            options,
            &|points| bar.advance(points),
        );
        bar.finish();
        let (mut set, report) = fitted?;
        let smooth = |strength: f64| {
            let max_iterations = if strength > 0.0 { CoherentOptions::default().max_iterations } else { 0 };
            let coherent = CoherentOptions {
                smoothness: strength,
                max_iterations,
                threads: options.threads,
                ..CoherentOptions::default()
            };
            sh_fit::make_coherent(&mut set, targets.values, targets.neighbours, &coherent)
        };
        let coherence = self.smooth.map(smooth).transpose()?;
        Ok(Fitted { set, report, coherence })
    }
}

/// What lobes are fitted to.
#[derive(Debug)]
pub(crate) struct Targets<'a> {
    pub(crate) order: sh_core::Order,
    pub(crate) channels: usize,
    /// `[P, C, n²]`.
    pub(crate) values: &'a [f32],
    pub(crate) neighbours: &'a Neighbours,
}

#[derive(Debug)]
pub(crate) struct Fitted {
    pub(crate) set: LobeSet,
    pub(crate) report: FitReport,
    pub(crate) coherence: Option<CoherentReport>,
}

impl Fitted {
    /// Relative error of the lobes as they are stored.
    pub(crate) fn relative_error(&self) -> f64 {
        self.coherence.as_ref().map_or(self.report.relative_error, |coherence| coherence.error_after)
    }
}

#[derive(Debug, Serialize)]
struct Report {
    file: String,
    output: String,
    /// Lobes stored per vertex.
    lobes: usize,
    vertices: usize,
    order: usize,
    channels: usize,
    explicit: usize,
    /// L2 error over all vertices, over the L2 length of the signal.
    relative_error: f64,
    /// Each band's share of it; the squares add up.
    error_per_band: Vec<f64>,
    errors: Errors,
    /// Vertices by the number of lobes they use.
    lobes_used: Vec<usize>,
    largest_coefficient: f64,
    /// Relative error at the middle of faces, where lobes are interpolated.
    face_error: f64,
    /// Relative error before the lobes of neighbours were made alike; `null` if they were not.
    error_before_smoothing: Option<f64>,
    starts: u64,
    iterations: u64,
    evaluations: u64,
    /// Vertices whose transfer is not finite: they are black.
    not_finite: Vec<usize>,
    output_bytes: u64,
    /// The fit alone.
    fit_seconds: f64,
    /// Everything, from reading to writing.
    seconds: f64,
}

/// Errors of the vertices, relative to the root mean square length of all vectors.
#[derive(Debug, Serialize)]
struct Errors {
    median: f64,
    p90: f64,
    p99: f64,
    max: f64,
    worst_vertex: usize,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.file));
    output_file::check(&output)?;
    output_file::check_differs(&output, &arguments.file)?;
    let baked = BakedSurface::read(&arguments.file)?;
    cancel::listen()?;
    laps.lap();
    let cause = || format!("cannot fit lobes to {}", arguments.file.display());
    let (fitted, face_error) = fit(arguments, &baked).with_context(cause)?;
    let fit_seconds = laps.lap();
    let (order, channels) = (baked.transfer.order.get(), baked.transfer.channels);
    let surface = surface(baked, &fitted);
    let output_bytes = surface.write(&output)?;
    let report = Report {
        file: arguments.file.display().to_string(),
        output: output.display().to_string(),
        lobes: fitted.set.lobe_count,
        vertices: surface.geometry.vertex_count(),
        order,
        channels,
        explicit: fitted.set.explicit_count,
        relative_error: fitted.relative_error(),
        error_before_smoothing: fitted.coherence.as_ref().map(|_| fitted.report.relative_error),
        errors: Errors {
            median: fitted.report.distribution.median,
            p90: fitted.report.distribution.p90,
            p99: fitted.report.distribution.p99,
            max: fitted.report.distribution.max,
            worst_vertex: fitted.report.distribution.worst_point,
        },
        error_per_band: fitted.report.band_errors,
        lobes_used: fitted.report.lobes_used,
        largest_coefficient: fitted.report.largest_coefficient,
        face_error,
        starts: fitted.report.starts,
        iterations: fitted.report.iterations,
        evaluations: fitted.report.evaluations,
        not_finite: fitted.report.not_finite,
        output_bytes,
        fit_seconds,
        seconds: laps.total(),
    };
    output::result(arguments.json, &report, || summary(&report))
}

fn default_output(file: &Path) -> PathBuf {
    let stem = file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy();
    PathBuf::from(format!("{stem}-lobes.prt"))
}

/// The lobes, and their error at the middle of faces.
fn fit(arguments: &Arguments, baked: &BakedSurface) -> anyhow::Result<(Fitted, f64)> {
    let transfer = &baked.transfer;
    let neighbours = Neighbours::from_triangles(baked.geometry.vertex_count(), &baked.geometry.triangles)?;
    let targets = Targets {
        order: transfer.order,
        channels: transfer.channels,
        values: &transfer.values,
        neighbours: &neighbours,
    };
    let options = arguments.fit.options(arguments.seed, arguments.threads);
    let fitted = arguments.fit.fit(&targets, &options)?;
    let face_error = sh_fit::interpolation_error(&fitted.set, &transfer.values, &baked.geometry.triangles)?;
    Ok((fitted, face_error.at_faces))
}

/// The surface with lobes in place of its transfer vectors.
pub(crate) fn surface(baked: BakedSurface, fitted: &Fitted) -> ZonalSurface {
    let mut metadata = baked.metadata;
    metadata.fit_error = Some(fitted.relative_error());
    ZonalSurface { metadata, geometry: baked.geometry, transfer: lobes::stored(fitted.set.clone()) }
}

fn summary(report: &Report) -> String {
    let skipped = match report.not_finite.len() {
        0 => String::new(),
        count => format!("\n{} vertices have transfer that is not finite and are black", output::count(count as u64)),
    };
    // Where lobes do not correspond nobody interpolates them.
    let between = match report.error_before_smoothing {
        Some(_) => format!(", {:.2} % where lobes are interpolated at the middle of faces", 100.0 * report.face_error),
        None => String::new(),
    };
    format!(
        "{} vertices, order {}: {} lobe{}, error {:.2} % (median vertex {:.2} %, worst {:.1} %){between}{skipped}\n\
         {} iterations from {} starts in {:.2} s\nwrote {} ({}) after {:.2} s",
        output::count(report.vertices as u64),
        report.order,
        report.lobes,
        if report.lobes == 1 { "" } else { "s" },
        100.0 * report.relative_error,
        100.0 * report.errors.median,
        100.0 * report.errors.max,
        output::count(report.iterations),
        output::count(report.starts),
        report.fit_seconds,
        report.output,
        output::bytes(report.output_bytes),
        report.seconds
    )
}
