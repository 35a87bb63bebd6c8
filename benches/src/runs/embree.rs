//! The rays of a bake beside Embree's: same origins, same directions, same triangles, one thread each; started by
//! `benches/embree/run.sh`.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};
use glam::{DVec3, Vec3};
use prt_bake::{DirectionSet, DirectionTracer, Hit, Mesh, MeshOptions, Scene, load_mesh, ray_origins};
use prt_tests::data_path;
use sh_core::Order;

use crate::output::table;

const MESHES: [&str; 4] = ["stanford_bunny.obj", "nefertiti.obj", "dragon_100k.ply", "lilium.obj"];
const POINTS: usize = 2000;
/// Over the whole sphere.
const DIRECTIONS: usize = 8192;
/// Both sides are timed in turn, this often; the medians count.
const ROUNDS: usize = 5;
/// Units of the scene, which is 1 across: eight roundings of a coordinate.
const MOVED: f64 = 1e-6;
/// As in `peer.cpp`.
const SCATTERED: u64 = 2_000_000;

/// What is compared: our way, and Embree's.
const PAIRS: [(Ours, &str); 8] = [
    (Ours::Bins, "occluded1"),
    (Ours::RayByRay, "occluded1"),
    (Ours::RayByRay, "occluded8"),
    (Ours::RayByRay, "occluded16"),
    (Ours::RayByRay, "stream"),
    (Ours::Closest, "intersect1"),
    (Ours::ClosestOccluded, "intersect1-occluded"),
    (Ours::Scattered, "intersect1-scattered"),
];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Ours {
    Bins,
    RayByRay,
    Closest,
    ClosestOccluded,
    Scattered,
}

/// Times all pairs for each mesh, and compares what was found.
pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let (mut speeds, mut answers) = (Vec::new(), Vec::new());
    let paths: Vec<PathBuf> = match asked {
        Some(path) => vec![path.into()],
        None => MESHES.iter().filter_map(|name| data_path("this run", &format!("meshes/{name}"))).collect(),
    };
    for path in paths {
        compare(&path, &mut speeds, &mut answers)?;
    }
    let head = ["mesh", "here", "Embree", "Mrays/s here", "Mrays/s Embree", "ratio", "traced here"];
    table("prt/embree", &head, &speeds)?;
    let head = [
        "mesh",
        "rays",
        "occluded",
        "other answer",
        "share",
        "of these within 1e-6 rad of an edge",
        "of the rest, otherwise if the origin moves by 1e-6 of the scene",
    ];
    table("prt/embree-answers", &head, &answers)
}

fn compare(path: &Path, speeds: &mut Vec<Vec<String>>, answers: &mut Vec<Vec<String>>) -> Result<()> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mesh = Mesh::new(load_mesh(path)?, &MeshOptions::default())?.0;
    let workload = Workload::new(&mesh)?;
    let mut here = Here::new(&workload);
    let mut peer = Peer::start(&workload)?;
    here.run(Ours::RayByRay);
    let occluded = peer.answers("occluded1")?;
    let occluded: Vec<u64> =
        occluded.chunks_exact(8).map(|word| u64::from_le_bytes(word.try_into().unwrap_or_default())).collect();
    for (ours, theirs) in PAIRS {
        let (mut seconds, mut rays) = ([Vec::new(), Vec::new()], 0);
        for _ in 0..ROUNDS {
            // The closest hits of occluded rays are those of the last any-hit mode.
            seconds[1].push(peer.seconds(theirs)?);
            let start = cpu_seconds()?;
            rays = here.run(ours);
            seconds[0].push(cpu_seconds()? - start);
        }
        let [here_seconds, peer_seconds] = seconds.map(median);
        let rate = |seconds: f64| format!("{:.2}", rays as f64 / seconds / 1e6);
        speeds.push(vec![
            name.clone(),
            format!("{ours:?}"),
            theirs.into(),
            rate(here_seconds),
            rate(peer_seconds),
            format!("**{:.2}**", peer_seconds / here_seconds),
            format!("{:.3}", here.traced as f64 / rays as f64),
        ]);
    }
    here.run(Ours::Bins);
    answers.push(workload.compare(&name, &here.occluded, &occluded));
    Ok(())
}

/// What both sides trace, in the frame of the scene.
struct Workload {
    scene: Scene,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    directions: DirectionSet,
    /// For each point a bit for each direction above its horizon.
    above: Vec<u64>,
}

impl Workload {
    /// Evenly picked vertices, and the directions above the horizon of each.
    fn new(mesh: &Mesh) -> Result<Self> {
        let scene = Scene::new(mesh);
        let directions = DirectionSet::new(DIRECTIONS, Order::new(1)?, 0);
        let (origins, count) = (ray_origins(mesh, &scene), mesh.positions().len());
        let picked: Vec<usize> = (0..POINTS.min(count)).map(|i| i * count / POINTS.min(count)).collect();
        let normals: Vec<Vec3> = picked.iter().map(|&vertex| Vec3::from_array(mesh.normals()[vertex])).collect();
        let above = |&normal: &Vec3| {
            let bits =
                move |word: &[Vec3]| (0..).zip(word).map(|(bit, s)| u64::from(normal.dot(*s) > 0.0) << bit).sum();
            directions.directions().chunks(64).map(bits).collect::<Vec<u64>>()
        };
        Ok(Self {
            vertices: mesh.positions().iter().map(|&p| scene.to_unit_cube(DVec3::from_array(p))).collect(),
            triangles: mesh.triangles().to_vec(),
            points: picked.iter().map(|&vertex| origins[vertex]).collect(),
            above: normals.iter().flat_map(above).collect(),
            normals,
            scene,
            directions,
        })
    }

    fn words(&self) -> usize {
        self.directions.directions().len() / 64
    }

    fn write(&self, path: &Path) -> Result<()> {
        let sizes = [self.vertices.len(), self.triangles.len(), self.points.len(), self.directions.directions().len()];
        let mut bytes: Vec<u8> = sizes.iter().flat_map(|&size| (size as u32).to_le_bytes()).collect();
        let mut vectors =
            |vectors: &[Vec3]| bytes.extend(vectors.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
        vectors(&self.vertices);
        let corners = self.triangles.iter().flatten().map(|&corner| f32::from_bits(corner));
        vectors(&corners.collect::<Vec<_>>().chunks(3).map(Vec3::from_slice).collect::<Vec<_>>());
        vectors(&self.points);
        vectors(self.directions.directions());
        bytes.extend(self.above.iter().flat_map(|word| word.to_le_bytes()));
        std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
    }

    /// The rays on whose visibility the sides differ, and why.
    fn compare(&self, name: &str, here: &[u64], peer: &[u64]) -> Vec<String> {
        let bits = |words: &[u64]| words.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        let differing: Vec<u64> = here.iter().zip(peer).map(|(a, b)| a ^ b).collect();
        let (rays, count) = (bits(&self.above), bits(&differing));
        let (mut grazing, mut brink) = (0, 0);
        for (number, &word) in differing.iter().enumerate() {
            for bit in (0..64).filter(|bit| word >> bit & 1 == 1) {
                let direction = self.directions.directions()[number % self.words() * 64 + bit];
                let origin = self.points[number / self.words()];
                if self.edge_angle(origin, direction) < 1e-6 {
                    grazing += 1;
                } else {
                    brink += u64::from(self.is_on_the_brink(origin, direction));
                }
            }
        }
        vec![
            name.into(),
            rays.to_string(),
            bits(here).to_string(),
            count.to_string(),
            format!("{:.1e}", count as f64 / rays as f64),
            grazing.to_string(),
            brink.to_string(),
        ]
    }

    /// Whether a ray is answered otherwise if its origin is moved by [`MOVED`]: in a plane of a face, past an edge.
    fn is_on_the_brink(&self, origin: Vec3, direction: Vec3) -> bool {
        let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
        let found = self.is_hidden(origin, direction);
        (0..27).any(|corner| {
            let by = [corner % 3, corner / 3 % 3, corner / 9].map(|step| MOVED * (f64::from(step) - 1.0));
            self.is_hidden(origin + DVec3::from_array(by), direction) != found
        })
    }

    /// Whether a ray meets any triangle, by `f64` and without a tree.
    fn is_hidden(&self, origin: DVec3, direction: DVec3) -> bool {
        self.triangles.iter().any(|triangle| {
            let [a, b, c] = triangle.map(|vertex| self.vertices[vertex as usize].as_dvec3() - origin);
            let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|plane| plane.dot(direction));
            let volume = a.dot(b.cross(c));
            weights.iter().all(|weight| weight * volume >= 0.0) && weights.iter().sum::<f64>() * volume > 0.0
        })
    }

    /// Angle between a ray and the nearest edge of any triangle, by `f64` and without a tree.
    fn edge_angle(&self, origin: Vec3, direction: Vec3) -> f64 {
        let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3().normalize());
        let corner = |vertex: u32| self.vertices[vertex as usize].as_dvec3() - origin;
        let edges = self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.map(|[a, b]| angle_to_edge(corner(a), corner(b), direction)).fold(f64::INFINITY, f64::min)
    }
}

/// Angle between a direction and the nearest point of the edge from `a` to `b`, seen from the origin.
fn angle_to_edge(a: DVec3, b: DVec3, direction: DVec3) -> f64 {
    // Where the plane of the direction and the normal of the plane of the edge cuts the edge.
    let normal = a.cross(b).normalize_or_zero();
    let across = direction.cross(normal);
    let (s, t) = (a.dot(across), b.dot(across));
    let share = if (s - t).abs() > 0.0 { (s / (s - t)).clamp(0.0, 1.0) } else { 0.0 };
    let nearest = a + share * (b - a);
    nearest.cross(direction).length().atan2(nearest.dot(direction))
}

/// Our side.
struct Here<'a> {
    workload: &'a Workload,
    tracer: DirectionTracer<'a>,
    occluded: Vec<u64>,
    /// Rays traced one by one in the last run.
    traced: u64,
    /// So that no work is left out.
    sum: f64,
}

impl<'a> Here<'a> {
    fn new(workload: &'a Workload) -> Self {
        let tracer = DirectionTracer::new(&workload.scene, &workload.directions);
        Self { workload, tracer, occluded: Vec::new(), traced: 0, sum: 0.0 }
    }

    /// Answers all rays; returns their number.
    fn run(&mut self, ours: Ours) -> u64 {
        let count = |words: &[u64]| words.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        self.traced = count(&self.workload.above);
        match ours {
            Ours::Bins => self.bins(),
            Ours::RayByRay => self.ray_by_ray(),
            Ours::Closest => self.closest(&self.workload.above),
            Ours::ClosestOccluded => {
                let occluded = std::mem::take(&mut self.occluded);
                self.closest(&occluded);
                self.traced = count(&occluded);
                self.occluded = occluded;
                return self.traced;
            }
            Ours::Scattered => {
                self.scattered();
                self.traced = SCATTERED;
                return SCATTERED;
            }
        }
        count(&self.workload.above)
    }

    fn points(&self) -> impl Iterator<Item = (Vec3, Vec3, &'a [u64])> + use<'a> {
        let work = self.workload;
        let points = work.points.iter().zip(&work.normals);
        points.zip(work.above.chunks(work.words())).map(|((&origin, &normal), above)| (origin, normal, above))
    }

    fn bins(&mut self) {
        self.occluded.clear();
        self.traced = 0;
        for (origin, normal, above) in self.points() {
            let (occluded, answered) = self.tracer.occluded(origin, normal, above);
            self.traced += u64::from(answered.traced);
            self.occluded.extend(occluded);
        }
    }

    fn ray_by_ray(&mut self) {
        self.occluded.clear();
        for (origin, _, above) in self.points() {
            self.occluded.extend(self.tracer.occluded_ray_by_ray(origin, above));
        }
    }

    fn closest(&mut self, rays: &[u64]) {
        for ((origin, ..), rays) in self.points().zip(rays.chunks(self.workload.words())) {
            let sum = &mut self.sum;
            self.tracer.closest(origin, rays, |_, hit| *sum += hit.map_or(0.0, |hit| hit.distance));
        }
    }

    fn scattered(&mut self) {
        let work = self.workload;
        let (points, directions) = (work.points.len() as u64, work.directions.directions());
        for ray in 0..SCATTERED {
            let origin = work.points[(ray * 7919 % points) as usize];
            let direction = directions[(ray * 1_048_583 % directions.len() as u64) as usize];
            let hit: Option<Hit> = self.tracer.closest_of_ray(origin, direction);
            self.sum += hit.map_or(0.0, |hit| hit.distance);
        }
    }
}

/// Embree's side: the program beside this one.
struct Peer {
    _process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    folder: PathBuf,
}

impl Peer {
    fn start(workload: &Workload) -> Result<Self> {
        let program = std::env::var_os("PRT_EMBREE_PEER")
            .context("PRT_EMBREE_PEER names no program: start this by benches/embree/run.sh")?;
        let folder = std::env::temp_dir().join(format!("prt-embree-{}", std::process::id()));
        std::fs::create_dir_all(&folder)?;
        let file = folder.join("workload");
        workload.write(&file)?;
        let mut process = Command::new(&program)
            .arg(&file)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let requests = process.stdin.take().context("the peer has no input")?;
        let answers = BufReader::new(process.stdout.take().context("the peer has no output")?);
        let mut peer = Self { _process: process, requests, answers, folder };
        peer.line()?;
        Ok(peer)
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            bail!("the peer stopped");
        }
        Ok(line.trim().to_owned())
    }

    /// Seconds of CPU time.
    fn seconds(&mut self, mode: &str) -> Result<f64> {
        writeln!(self.requests, "{mode} -")?;
        Ok(self.line()?.parse()?)
    }

    /// What it found.
    fn answers(&mut self, mode: &str) -> Result<Vec<u8>> {
        let file = self.folder.join("answers");
        writeln!(self.requests, "{mode} {}", file.display())?;
        self.line()?;
        Ok(std::fs::read(file)?)
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _is_left_if_it_fails = std::fs::remove_dir_all(&self.folder);
    }
}

/// Of this thread.
fn cpu_seconds() -> Result<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").context("CPU time is read from Linux's /proc")?;
    let nanoseconds: f64 = text.split_whitespace().next().context("no time in schedstat")?.parse()?;
    Ok(1e-9 * nanoseconds)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
