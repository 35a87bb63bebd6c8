//! Baking height fields to textures that can be laid over any surface.

use std::path::{Path, PathBuf};

use anyhow::Context;
use prt_bake::{
    HeightField, Image, Material, Medium, Metadata, PatchOptions, PatchReport, PatchTransfer, Source, ZonalTexture,
    bake_patch,
};
use serde::Serialize;
use sh_core::Order;
use sh_fit::Neighbours;

use super::bake;
use super::fit::{FitArguments, Targets};
use crate::gloss::{Gloss, Reflectance};
use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{arguments, cancel, lobes, memory, output, output_file};

/// What a height field is made of, and how its transfer is fitted.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Height fields (an image, or bumps, weave, waffle, swirl)")]
pub(crate) struct PatchArguments {
    /// Height of the highest point, in units of the tile's width
    #[arg(long, value_name = "HEIGHT", value_parser = arguments::relief)]
    height: Option<f32>,
    /// Scattering coefficient per tile width: makes the patch translucent
    #[arg(long, value_name = "R,G,B", value_parser = arguments::coefficients, conflicts_with_all = ["bounces", "albedo", "brdf"])]
    sigma_s: Option<[f32; 3]>,
    /// Absorption coefficient per tile width
    #[arg(long, value_name = "R,G,B", default_value = "0.4", value_parser = arguments::coefficients, requires = "sigma_s")]
    sigma_a: [f32; 3],
    /// Mean cosine of the angle of scattering
    #[arg(long, value_name = "G", default_value = "0", value_parser = arguments::asymmetry, allow_hyphen_values = true, requires = "sigma_s")]
    anisotropy: f32,
    /// Index of refraction of the translucent matter
    #[arg(long, value_name = "IOR", default_value = "1.3", value_parser = arguments::refraction, requires = "sigma_s")]
    ior: f32,
    /// The matter ends this far below height 0, in tile widths, and light comes in from there too; by default it goes on for ever
    #[arg(long, value_name = "DEPTH", value_parser = arguments::relief, requires = "sigma_s")]
    thickness: Option<f32>,
    /// Glossy reflection instead of diffuse: phong:EXPONENT, cook-torrance:ROUGHNESS or ggx:ROUGHNESS
    #[arg(long, value_name = "BRDF", value_parser = Reflectance::parse)]
    brdf: Option<Reflectance>,
    /// Rows that the glossy reflection is factored into [default: as many as leave at most 20 % of it, and at most 16]
    #[arg(long, value_name = "COUNT", value_parser = arguments::rows, requires = "brdf")]
    rows: Option<usize>,
    #[command(flatten)]
    fit: FitArguments,
}

/// Options that height fields share with meshes.
#[derive(Debug)]
pub(crate) struct Common {
    pub(crate) output: Option<PathBuf>,
    pub(crate) order: Order,
    pub(crate) rays: usize,
    pub(crate) bounces: usize,
    pub(crate) seed: u64,
    pub(crate) threads: Option<usize>,
    pub(crate) shadowed: bool,
    pub(crate) albedo: Option<[f32; 3]>,
    pub(crate) json: bool,
    /// Texels of the result; by default 64x64 for the built-in patterns, and as many as an image has, up to 64 on its longer side.
    pub(crate) texels: Option<arguments::Size>,
}

/// A height field by formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Pattern {
    Bumps,
    Weave,
    Waffle,
    Swirl,
}

impl Pattern {
    /// Height of the highest point that shows the pattern well, in units of the tile's width.
    const HEIGHT: f32 = 0.15;
    /// Texels on a side, as in \[SLS05\] figure 7.
    pub(crate) const SIZE: usize = 64;

    pub(crate) fn field(self, size: usize, height: Option<f32>) -> Result<HeightField, prt_bake::Error> {
        let height = height.unwrap_or(Self::HEIGHT);
        match self {
            Self::Bumps => HeightField::bumps(size, height),
            Self::Weave => HeightField::weave(size, height),
            Self::Waffle => HeightField::waffle(size, height),
            Self::Swirl => HeightField::swirl(size, height),
        }
    }
}

/// What a height field is made from: a file, or a pattern where no file has its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Origin {
    Image(PathBuf),
    Pattern(Pattern),
}

impl Origin {
    /// What the argument of `bake` names, if it is a height field at all.
    pub(crate) fn of(scene: &Path) -> Option<Self> {
        const IMAGES: [&str; 7] = ["png", "jpg", "jpeg", "exr", "hdr", "pic", "rgbe"];
        let extension = scene.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        if IMAGES.iter().any(|image| extension.eq_ignore_ascii_case(image)) {
            return Some(Self::Image(scene.to_owned()));
        }
        let pattern = scene.to_str().and_then(|name| <Pattern as clap::ValueEnum>::from_str(name, true).ok())?;
        (!scene.exists()).then_some(Self::Pattern(pattern))
    }

    fn field(&self, height: Option<f32>, texels: Option<arguments::Size>) -> anyhow::Result<HeightField> {
        let size = texels.map(|size| [size.width as usize, size.height as usize]);
        match self {
            Self::Image(path) => {
                let image = Image::load(path)?;
                if looks_like_normals(&image) {
                    output::note(format_args!("{} looks like a map of normals, not of heights", path.display()));
                }
                let height = height.unwrap_or(Pattern::HEIGHT);
                Ok(HeightField::from_image(path, height, Some(size.unwrap_or_else(|| default_texels(&image))))?)
            }
            Self::Pattern(pattern) => {
                let [width, rows] = size.unwrap_or([Pattern::SIZE; 2]);
                anyhow::ensure!(width == rows, "a built-in pattern is square: --texels {width}x{rows} is not");
                Ok(pattern.field(width, height)?)
            }
        }
    }

    fn source(&self) -> Result<Option<Source>, prt_bake::Error> {
        match self {
            Self::Image(path) => Source::of_file(path).map(Some),
            Self::Pattern(_) => Ok(None),
        }
    }
}

/// The size of an image, or a smaller one of the same shape.
fn default_texels(image: &Image) -> [usize; 2] {
    let sides = [image.width, image.height];
    let longest = image.width.max(image.height);
    if longest <= Pattern::SIZE { sides } else { sides.map(|side| (side * Pattern::SIZE / longest).max(1)) }
}

/// Whether an image is mostly the light blue of normals that point out of a surface.
fn looks_like_normals(image: &Image) -> bool {
    let sum = image
        .pixels
        .iter()
        .fold([0.0; 3], |sum: [f64; 3], pixel| std::array::from_fn(|channel| sum[channel] + f64::from(pixel[channel])));
    let [red, green, blue] = sum.map(|sum| sum / image.pixels.len().max(1) as f64);
    // Pixels are linear: half is 0.21, and normals of a rough surface still have 0.8 of blue, 0.6 here.
    (0.12..0.35).contains(&red) && (0.12..0.35).contains(&green) && blue > 0.6
}

/// A texture that was baked and fitted, and how it went.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) texture: ZonalTexture,
    pub(crate) bake: PatchReport,
    pub(crate) relative_error: f64,
    pub(crate) largest_coefficient: f64,
    /// Relative error of the rows that a glossy reflection is factored into.
    pub(crate) factor_error: Option<f64>,
}

impl PatchArguments {
    /// Diffuse and opaque, with `lobes` lobes.
    pub(crate) fn diffuse(lobes: usize) -> Self {
        Self {
            height: None,
            sigma_s: None,
            sigma_a: [0.4; 3],
            anisotropy: 0.0,
            ior: 1.3,
            thickness: None,
            brdf: None,
            rows: None,
            fit: FitArguments::lobes(lobes),
        }
    }

    /// Of the default medium, thin: light comes through from behind.
    pub(crate) fn translucent(self) -> Self {
        let Medium { sigma_s, sigma_a, g, ior } = Medium::default();
        Self { sigma_s: Some(sigma_s), sigma_a, anisotropy: g, ior, thickness: Some(0.05), ..self }
    }

    /// With glossy reflection.
    pub(crate) fn glossy(self, brdf: Reflectance) -> Self {
        Self { brdf: Some(brdf), ..self }
    }

    /// Whether an option was given that makes sense for height fields alone.
    pub(crate) fn is_asked_for(&self) -> bool {
        self.height.is_some() || self.sigma_s.is_some() || self.brdf.is_some()
    }

    fn medium(&self) -> Option<Medium> {
        let Self { sigma_a, anisotropy, ior, .. } = *self;
        self.sigma_s.map(|sigma_s| Medium { sigma_s, sigma_a, g: anisotropy, ior })
    }

    fn options(&self, common: &Common, gloss: Option<&Gloss>) -> PatchOptions {
        let defaults = PatchOptions::default();
        PatchOptions {
            order: common.order,
            rays_per_texel: common.rays,
            bounces: common.bounces,
            shadowed: common.shadowed,
            albedo: common.albedo.unwrap_or(defaults.albedo),
            scattering: self.medium(),
            thickness: self.thickness,
            responses: gloss.map(Gloss::responses).unwrap_or_default(),
            seed: common.seed,
            threads: common.threads,
        }
    }

    /// Bakes a height field and fits its lobes.
    pub(crate) fn bake(&self, field: &HeightField, common: &Common) -> anyhow::Result<Baked> {
        let gloss = self.brdf.map(|brdf| Gloss::new(brdf, common.order, self.rows)).transpose()?;
        let options = self.options(common, gloss.as_ref());
        let bar = BakeBar::new();
        let baked = bake_patch(field, &options, &bar);
        bar.finish();
        let (transfer, bake) = baked?;
        cancel::check()?;
        let (mut stored, relative_error, largest_coefficient) = self.fit_rows(&transfer, common)?;
        let factor_error = gloss.as_ref().map(Gloss::error);
        stored.view_map = gloss.map(Gloss::into_view_map);
        let metadata = Metadata {
            rays: if options.shadowed { options.rays_per_texel } else { 0 },
            bounces: options.bounces,
            seed: options.seed,
            shadowed: options.shadowed,
            error: bake.error,
            fit_error: Some(relative_error),
            ..Metadata::default()
        };
        let is_own_albedo = options.scattering.is_none() && options.responses.is_empty();
        let texture = ZonalTexture {
            metadata,
            width: transfer.width,
            height: transfer.height,
            heights: transfer.heights,
            normals: transfer.normals,
            albedo: if is_own_albedo { options.albedo } else { [1.0; 3] },
            material: match (options.scattering, options.responses.is_empty()) {
                (Some(_), _) => Material::Translucent,
                (None, false) => Material::Glossy,
                (None, true) => Material::Diffuse,
            },
            is_coherent: self.fit.is_smooth(),
            transfer: stored,
        };
        Ok(Baked { texture, bake, relative_error, largest_coefficient, factor_error })
    }

    /// Fits the rows one by one, whose lobes have nothing to do with one another; returns relative error and largest coefficient too.
    fn fit_rows(
        &self,
        transfer: &PatchTransfer,
        common: &Common,
    ) -> anyhow::Result<(prt_bake::ZonalTransfer, f64, f64)> {
        let neighbours = Neighbours::grid(transfer.width, transfer.height, true);
        let options = self.fit.options(common.seed, common.threads);
        let row_length = transfer.channels * transfer.order.coeff_count();
        let (mut sets, mut squares, mut largest) = (Vec::new(), [0.0; 2], 0.0_f64);
        for row in 0..transfer.rows {
            let values: Vec<f32> =
                transfer.values.chunks_exact(row_length).skip(row).step_by(transfer.rows).flatten().copied().collect();
            let targets = Targets {
                order: transfer.order,
                channels: transfer.channels,
                values: &values,
                neighbours: &neighbours,
            };
            let fitted = self.fit.fit(&targets, &options)?;
            let signal: f64 = values.iter().map(|&value| f64::from(value).powi(2)).sum();
            squares = [squares[0] + fitted.relative_error().powi(2) * signal, squares[1] + signal];
            largest = largest.max(fitted.report.largest_coefficient);
            sets.push(fitted.set);
        }
        let error = if squares[1] > 0.0 { (squares[0] / squares[1]).sqrt() } else { 0.0 };
        Ok((lobes::interleaved(&sets), error, largest))
    }
}

#[derive(Debug, Serialize)]
struct Seconds {
    load: f64,
    /// Tracing the relief, or following paths in it.
    trace: f64,
    fit: f64,
    write: f64,
    total: f64,
}

#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: String,
    output: String,
    width: usize,
    height: usize,
    texels: usize,
    order: usize,
    channels: usize,
    rows: usize,
    rays_per_texel: usize,
    /// Rays, or paths in translucent matter.
    rays_traced: u64,
    bounces: usize,
    bounce_energy: &'a [f64],
    occluded_share: f64,
    /// Estimated relative error of the baked transfer, before lobes.
    error: Option<f64>,
    lobes: usize,
    /// Relative error of the lobes.
    relative_error: f64,
    largest_coefficient: f64,
    /// Relative error of the rows of a glossy reflection; `null` if it is diffuse.
    factor_error: Option<f64>,
    /// Of uniform light, what a translucent patch sends back and lets through, for each channel; `null` if it is opaque.
    reflectance: Option<&'a [f64]>,
    transmittance: Option<&'a [f64]>,
    seed: u64,
    threads: usize,
    seconds: Seconds,
    mrays_per_second: f64,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

pub(crate) fn run(scene: &Path, origin: &Origin, patch: &PatchArguments, common: &Common) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    let output = common.output.clone().unwrap_or_else(|| bake::default_output(scene));
    output_file::check(&output)?;
    output_file::check_differs(&output, scene)?;
    cancel::listen()?;
    let cause = || format!("cannot bake {}", scene.display());
    let field = origin.field(patch.height, common.texels).with_context(cause)?;
    let source = origin.source()?;
    let load = laps.lap();
    let mut baked = patch.bake(&field, common).with_context(cause)?;
    baked.texture.metadata.source = source;
    let work = laps.lap();
    let output_bytes = write(&baked.texture, &output)?;
    let trace = baked.bake.trace.as_secs_f64();
    let seconds = Seconds { load, trace, fit: (work - trace).max(0.0), write: laps.lap(), total: laps.total() };
    let report = report(scene, &output, &baked, common, seconds, output_bytes);
    output::result(common.json, &report, || summary(&report))
}

/// By the extension: an OpenEXR image with named channels, or a baked file.
fn write(texture: &ZonalTexture, path: &Path) -> Result<u64, prt_bake::Error> {
    match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        true => texture.write_exr(path),
        false => texture.write(path),
    }
}

fn report<'a>(
    scene: &Path,
    output: &Path,
    baked: &'a Baked,
    common: &Common,
    seconds: Seconds,
    output_bytes: u64,
) -> Report<'a> {
    let Baked { texture, bake, .. } = baked;
    let scattering = bake.scattering.as_ref();
    Report {
        scene: scene.display().to_string(),
        output: output.display().to_string(),
        width: texture.width,
        height: texture.height,
        texels: texture.width * texture.height,
        order: texture.transfer.order.get(),
        channels: texture.transfer.channels,
        rows: texture.transfer.rows,
        rays_per_texel: common.rays,
        rays_traced: bake.rays_traced,
        bounces: common.bounces,
        bounce_energy: &bake.bounce_energy,
        occluded_share: bake.occluded_share,
        error: bake.error,
        lobes: texture.transfer.lobe_count,
        relative_error: baked.relative_error,
        largest_coefficient: baked.largest_coefficient,
        factor_error: baked.factor_error,
        reflectance: scattering.map(|report| report.from_above.as_slice()),
        transmittance: scattering.map(|report| report.from_below.as_slice()),
        seed: common.seed,
        threads: bake.threads,
        mrays_per_second: bake.rays_traced as f64 / seconds.trace.max(1e-9) / 1e6,
        seconds,
        peak_memory_bytes: memory::peak_bytes(),
        output_bytes,
    }
}

fn summary(report: &Report<'_>) -> String {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let light = report.reflectance.zip(report.transmittance).map(|(back, through)| {
        format!(
            "\nof uniform light it sends back {:.1} % and lets through {:.1} %",
            100.0 * mean(back),
            100.0 * mean(through)
        )
    });
    let gloss = report
        .factor_error
        .map(|error| format!("\nthe rows leave {:.1} % of the glossy reflection, over all views", 100.0 * error));
    format!(
        "{}x{} texels, order {}, {} row{}: {} rays in {:.2} s ({:.1} Mrays/s), error about {:.2} %{}{}\n\
         {} lobes in {:.2} s, error {:.2} %\nwrote {} ({}) after {:.2} s",
        report.width,
        report.height,
        report.order,
        report.rows,
        if report.rows == 1 { "" } else { "s" },
        output::count(report.rays_traced),
        report.seconds.trace,
        report.mrays_per_second,
        100.0 * report.error.unwrap_or(0.0),
        light.unwrap_or_default(),
        gloss.unwrap_or_default(),
        report.lobes,
        report.seconds.fit,
        100.0 * report.relative_error,
        report.output,
        output::bytes(report.output_bytes),
        report.seconds.total
    )
}
