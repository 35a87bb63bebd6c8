//! What the verb tells of a bake.

use std::path::Path;

use prt_bake::{BakeOptions, BakeReport, BakeTarget, FileReport, Mesh, MeshReport, Savings};
use serde::Serialize;

use super::effort::{self, Decision};
use crate::{memory, output};

/// Wall time of the steps.
#[derive(Debug, Serialize)]
pub(super) struct Seconds {
    /// Reading and cleaning the mesh.
    load: f64,
    /// Finding the order or the error that was left open.
    plan: f64,
    /// The tree, the set of directions and the layout of an atlas.
    build: f64,
    /// Of texels, that of the vertices that they gather from too.
    pub(super) trace: f64,
    write: f64,
    pub(super) total: f64,
}

impl Seconds {
    /// - `bake_and_write`, `total`: all after the plan, and all together
    pub(super) fn new([load, plan, bake_and_write]: [f64; 3], total: f64, bake: &BakeReport) -> Self {
        let gathered = bake.texels.as_ref().and_then(|texels| texels.vertices.as_deref());
        let times = |bake: &BakeReport| [bake.build, bake.trace].map(|time| time.as_secs_f64());
        let ([build, trace], [more_build, more_trace]) = (times(bake), gathered.map_or([0.0; 2], times));
        let (build, trace) = (build + more_build, trace + more_trace);
        Self { load, plan, build, trace, write: (bake_and_write - build - trace).max(0.0), total }
    }
}

/// What stopping early saved.
#[derive(Debug, Serialize)]
pub(super) struct Saved {
    /// Rays that the same number for each vertex would have been.
    fixed_rays: u64,
    open_vertices: usize,
    blocked_vertices: usize,
    /// Vertices whose estimated error is above what was asked for.
    unconverged_vertices: usize,
    /// Directions of the finest set that vertices were given, and how many were.
    levels: Vec<[usize; 2]>,
}

impl Saved {
    pub(super) fn of(savings: &Savings) -> Self {
        Self {
            fixed_rays: savings.fixed_directions,
            open_vertices: savings.open_vertices,
            blocked_vertices: savings.blocked_vertices,
            unconverged_vertices: savings.unconverged_vertices,
            levels: savings.levels.iter().map(|level| [level.directions as usize, level.vertices]).collect(),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Report {
    scene: String,
    output: String,
    /// Whether the output was there already, and nothing was baked.
    up_to_date: bool,
    /// Number and count, for a part of a bake.
    part: Option<[u32; 2]>,
    vertices: usize,
    triangles: usize,
    faces_dropped: usize,
    faces_degenerate: usize,
    faces_duplicate: usize,
    faces_not_finite: usize,
    vertices_unused: usize,
    vertices_split: usize,
    /// Faces that have a twin which looks the other way.
    faces_twinned: usize,
    /// What was read otherwise than it is meant.
    warnings: Vec<String>,
    /// Vertices inside of solids.
    vertices_invalid: usize,
    order: usize,
    /// `null` for a part, and if nothing was baked.
    channels: Option<usize>,
    rays_per_vertex: usize,
    rays_traced: u64,
    /// Vertices that an earlier run of this bake had traced from.
    vertices_resumed: usize,
    bounces: usize,
    /// What becomes of vertices inside of solids.
    inside: String,
    /// Length of what each bounce adds, relative to direct transfer.
    bounce_energy: Vec<f64>,
    /// Share of the rays towards the light that meet something.
    occluded_share: f64,
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
    mrays_per_second: f64,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

impl Report {
    pub(super) fn new(
        scene: &Path,
        target: &BakeTarget,
        mesh: &Mesh,
        cleaning: &MeshReport,
        (options, decision): (&BakeOptions, Decision),
        file: &FileReport,
        seconds: Seconds,
    ) -> Self {
        let bake = &file.bake;
        Self {
            scene: scene.display().to_string(),
            output: target.path.display().to_string(),
            up_to_date: file.was_up_to_date,
            part: target.part.map(|part| [part.number(), part.count()]),
            vertices: mesh.positions().len(),
            triangles: mesh.triangles().len(),
            faces_dropped: cleaning.faces_dropped(),
            faces_degenerate: cleaning.degenerate,
            faces_duplicate: cleaning.duplicate,
            faces_not_finite: cleaning.non_finite,
            vertices_unused: cleaning.vertices_unused,
            vertices_split: cleaning.vertices_split,
            faces_twinned: cleaning.faces_twinned,
            warnings: cleaning.warnings.clone(),
            vertices_invalid: bake.invalid_vertices,
            order: options.order.get(),
            channels: file.channels,
            rays_per_vertex: if options.shadowed { options.rays_per_vertex } else { 0 },
            rays_traced: bake.rays_traced,
            vertices_resumed: bake.vertices_resumed,
            bounces: bake.bounce_energy.len(),
            inside: options.inside.to_string(),
            bounce_energy: bake.bounce_energy.clone(),
            occluded_share: bake.occluded_share,
            error: bake.error,
            decision,
            savings: Saved::of(&bake.savings),
            about_savings: effort::about_savings(&bake.savings, "vertices"),
            seed: options.seed,
            threads: bake.threads,
            mrays_per_second: super::mrays_per_second(bake),
            seconds,
            peak_memory_bytes: memory::peak_bytes(),
            output_bytes: file.bytes,
        }
    }

    pub(super) fn summary(&self) -> String {
        if self.up_to_date {
            return format!("{} is up to date", self.output);
        }
        [
            Some(self.about_mesh()),
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

    fn about_mesh(&self) -> String {
        let channels = match self.channels {
            Some(1) => ", 1 channel".to_owned(),
            Some(channels) => format!(", {channels} channels"),
            None => String::new(),
        };
        let part = self.part.map_or_else(String::new, |[number, count]| format!(", part {number} of {count}"));
        format!(
            "{} vertices, {} triangles ({} dropped), order {}{channels}{part}",
            output::count(self.vertices as u64),
            output::count(self.triangles as u64),
            output::count(self.faces_dropped as u64),
            self.order,
        )
    }

    fn about_resuming(&self) -> Option<String> {
        let vertices = output::count(self.vertices_resumed as u64);
        (self.vertices_resumed > 0).then(|| format!("{vertices} vertices were there from an earlier run"))
    }

    fn about_rays(&self) -> String {
        let error = self.error.map(|error| format!(", error about {:.2} %", 100.0 * error));
        let bounces = match self.part {
            Some(_) => "bounces follow when parts are merged".to_owned(),
            None => format!("{} bounces", self.bounces),
        };
        format!(
            "{bounces}, {} rays in {:.2} s ({:.1} Mrays/s){}",
            output::count(self.rays_traced),
            self.seconds.trace,
            self.mrays_per_second,
            error.unwrap_or_default()
        )
    }

    fn about_output(&self) -> String {
        let memory = self.peak_memory_bytes.map(|bytes| format!(", peak memory {}", output::bytes(bytes)));
        format!(
            "wrote {} ({}) after {:.2} s{}",
            self.output,
            output::bytes(self.output_bytes),
            self.seconds.total,
            memory.unwrap_or_default()
        )
    }
}
