//! Baking the texels that the texture coordinates of a mesh lay out.

use std::path::Path;

use anyhow::ensure;
use prt_bake::{BakeOptions, BakeTarget, FileReport, Mesh, Source, TexelOptions, TexelReport, bake_texels_to_file};
use serde::Serialize;

use super::Arguments;
use super::effort::{self, Decision};
use super::report::{Saved, Seconds};
use crate::arguments::Size;
use crate::laps::Laps;
use crate::{cancel, memory, output, output_file};

#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    output: String,
    /// Whether the output was there already, and nothing was baked.
    up_to_date: bool,
    /// Number and count, for a part of a bake.
    part: Option<[u32; 2]>,
    width: usize,
    height: usize,
    vertices: usize,
    triangles: usize,
    order: usize,
    /// `null` for a part, and if nothing was baked.
    channels: Option<usize>,
    /// What became of the atlas; all zero for a part, and if nothing was baked.
    #[serde(flatten)]
    atlas: TexelReport,
    texels_invalid: usize,
    /// Texels that an earlier run of this bake had traced from.
    texels_resumed: usize,
    /// Vertices, of those that texels gather from, that it had traced from.
    vertices_resumed: usize,
    rays_per_texel: usize,
    /// From the vertices that texels gather from too.
    rays_traced: u64,
    bounces: usize,
    /// Estimated relative error of shadowed transfer; `null` without rays.
    error: Option<f64>,
    #[serde(flatten)]
    decision: Decision,
    savings: Saved,
    /// The same in words.
    #[serde(skip)]
    about_savings: Option<String>,
    seed: u64,
    threads: usize,
    seconds: Seconds,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

pub(super) fn run(arguments: &Arguments, scene: &Path, size: Size) -> anyhow::Result<()> {
    let mut laps = Laps::start();
    let keeping = &arguments.keeping;
    let output = arguments.output.clone().unwrap_or_else(|| keeping.default_output(scene, "exr"));
    ensure!(
        keeping.is_part() || is_exr(&output),
        "cannot write {}: the texels of a mesh are written as .exr",
        output.display()
    );
    output_file::check(&output)?;
    output_file::check_differs(&output, scene)?;
    cancel::listen()?;
    keeping.lower_priority()?;
    let (mesh, _) = super::load(arguments, scene)?;
    let target = keeping.target(output, Source::of_file(scene)?);
    let load = laps.lap();
    cancel::check()?;
    let (name, texels) = (scene.display().to_string(), options(arguments, scene, size));
    let (options, decision) = super::decide(arguments, &mesh, Some(&texels), &target, &name)?;
    let plan = laps.lap();
    let file = super::bake_file(&target, &name, |bar| bake_texels_to_file(&mesh, &options, &texels, &target, bar))?;
    let seconds = Seconds::new([load, plan, laps.lap()], laps.total(), &file.bake);
    let report = Report::new(scene, &target, &mesh, (&options, &texels, decision), &file, seconds);
    output::result(arguments.json, &report, || report.summary())
}

/// Whether a file is named as an atlas is.
pub(crate) fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
}

/// In glTF the first row of a texture is v = 0, in all other formats v = 1.
fn options(arguments: &Arguments, scene: &Path, size: Size) -> TexelOptions {
    let extension = scene.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let is_gltf = ["gltf", "glb"].iter().any(|gltf| extension.eq_ignore_ascii_case(gltf));
    TexelOptions { width: size.width as usize, height: size.height as usize, gutter: arguments.gutter, v_up: !is_gltf }
}

impl Report {
    fn new(
        scene: &Path,
        target: &BakeTarget,
        mesh: &Mesh,
        (options, texels, decision): (&BakeOptions, &TexelOptions, Decision),
        file: &FileReport,
        seconds: Seconds,
    ) -> Self {
        let bake = &file.bake;
        let atlas = bake.texels.clone().unwrap_or_default();
        let gathered = atlas.vertices.as_deref();
        Self {
            scene: scene.display().to_string(),
            output: target.path.display().to_string(),
            up_to_date: file.was_up_to_date,
            part: target.part.map(|part| [part.number(), part.count()]),
            width: texels.width,
            height: texels.height,
            vertices: mesh.positions().len(),
            triangles: mesh.triangles().len(),
            order: options.order.get(),
            channels: file.channels,
            texels_invalid: bake.invalid_vertices,
            texels_resumed: bake.vertices_resumed,
            vertices_resumed: gathered.map_or(0, |vertices| vertices.vertices_resumed),
            rays_per_texel: if options.shadowed { options.rays_per_vertex } else { 0 },
            rays_traced: bake.rays_traced + gathered.map_or(0, |vertices| vertices.rays_traced),
            bounces: gathered.map_or(0, |vertices| vertices.bounce_energy.len() + 1),
            error: bake.error,
            decision,
            savings: Saved::of(&bake.savings),
            about_savings: effort::about_savings(&bake.savings, "texels"),
            seed: options.seed,
            threads: bake.threads,
            seconds,
            peak_memory_bytes: memory::peak_bytes(),
            output_bytes: file.bytes,
            atlas,
        }
    }

    fn summary(&self) -> String {
        if self.up_to_date {
            return format!("{} is up to date", self.output);
        }
        [
            Some(self.about_atlas()),
            self.about_resuming(),
            Some(self.about_rays()),
            self.about_savings.clone(),
            Some(self.about_output()),
        ]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("\n")
    }

    fn about_atlas(&self) -> String {
        let count = |number: usize| output::count(number as u64);
        let size = format!("{}x{} texels", self.width, self.height);
        if let Some([number, parts]) = self.part {
            return format!("{size}, part {number} of {parts}");
        }
        let TexelReport { texels_inside, texels_border, texels_filled, texels_empty, .. } = self.atlas;
        let overlapping = match self.atlas.texels_overlapping {
            0 => String::new(),
            texels => format!("\n{} texels lie in several faces: charts overlap", count(texels)),
        };
        format!(
            "{size}: {} on faces, {} at borders, {} filled, {} empty{overlapping}\n{} seam edges, difference {:.2} %",
            count(texels_inside),
            count(texels_border),
            count(texels_filled),
            count(texels_empty),
            count(self.atlas.seam_edges),
            100.0 * self.atlas.seam_error,
        )
    }

    fn about_resuming(&self) -> Option<String> {
        let [texels, vertices] = [self.texels_resumed, self.vertices_resumed].map(|count| output::count(count as u64));
        let is_resumed = self.texels_resumed + self.vertices_resumed > 0;
        is_resumed.then(|| format!("{vertices} vertices and {texels} texels were there from an earlier run"))
    }

    fn about_rays(&self) -> String {
        let error = self.error.map(|error| format!(", error about {:.2} %", 100.0 * error));
        let (rays, seconds) = (output::count(self.rays_traced), self.seconds.trace);
        format!("{rays} rays in {seconds:.2} s{}", error.unwrap_or_default())
    }

    fn about_output(&self) -> String {
        let (bytes, seconds) = (output::bytes(self.output_bytes), self.seconds.total);
        format!("wrote {} ({bytes}) after {seconds:.2} s", self.output)
    }
}
