//! The target error that a bake reaches in a given time.

use std::ops::Range;
use std::time::{Duration, Instant};

use super::direct::Scratch;
use super::pilot::{Pilot, spread};
use super::{DirectPass, HitRecord, Ladder, Reflection, ValidityTest};
use crate::parallel::Threads;
use crate::texels::LaidOut;
use crate::{BakeOptions, Error, Mesh, Progress, TexelOptions, TransferVectors};

/// What a bake can reach in a given time.
#[derive(Debug, Clone, PartialEq)]
pub struct TimePlan {
    /// Value for [`BakeOptions::target_error`](crate::BakeOptions::target_error).
    pub target_error: f64,
    /// Time that the bake will take with it, as foreseen. More than what is left of the budget if even the largest error takes longer; less if
    /// all vertices have all the rays that they may use.
    pub expected: Duration,
    /// Time that the pilot took. It counts towards the budget.
    pub pilot: Duration,
    /// Vertices, and texels, that the pilot looked at.
    pub vertices: usize,
}

/// The pilot looks at one vertex, or texel, out of so many: it then takes 4 % of 20 s, 6 to 9 % of 5 s, 11 % of 2 s ...
const POINTS_PER_SAMPLE: usize = 64;

/// ... but at so many at least: single vertices differ by factors of ten in what they take ...
const FEWEST_SAMPLES: usize = 96;

/// ... and at most, enough for the mean of any mesh.
const MOST_SAMPLES: usize = 2048;

/// Target errors that are tried, from large to small, differ by this factor.
const STEP: f64 = 2.5;

/// Smallest target error that is tried: below, transfer in `f32` is rounded by as much.
const SMALLEST_ERROR: f64 = 1e-6;

/// Share of the time left that the bake is planned to take: what it foretells is a few percent off.
const SHARE: f64 = 0.92;

/// Finds the target error with which a bake takes about `budget`, the pilot over some vertices included.
///
/// The bake itself then runs with [`BakeOptions::target_error`] set, so that its bytes do not depend on any clock: only the choice of the
/// error does. [`BakeOptions::rays_per_vertex`] is the finest set of directions, here too: give it room. Time for reading the mesh and for
/// writing the file is not counted. Bakes of the bunny, of `nefertiti` and of 512² texels of `spot` in 3, 5, 10 and 20 s took 88 to 107 % of
/// that, on two threads with room for 65,536 rays, and reached errors of 4e-3 (5 s) and 6e-4 (20 s) at vertices (`prt bake MESH --time 5s
/// --json`); where other work shares the machine the same bake took 82 to 115 %. Sets of directions alone take half a second, so that budgets
/// below 2 s are missed.
///
/// # Errors
/// If an option is out of range or there are no shadows to trace, or the caller cancels.
pub fn error_for_time(
    mesh: &Mesh,
    options: &BakeOptions,
    budget: Duration,
    progress: &dyn Progress,
) -> Result<TimePlan, Error> {
    plan(options, budget, progress, || {
        let count = sample_count(mesh.positions().len());
        let pilot = Pilot::of_vertices(mesh, &spread(mesh.positions().len(), count));
        Ok((pilot, vec![Share { points: 0..count, all: mesh.positions().len(), gathers: options.bounces }]))
    })
}

/// The same for a bake of texels, and of the vertices that they gather from.
///
/// # Errors
/// As [`error_for_time`] and [`bake_texels`](crate::bake_texels).
pub fn error_for_time_of_texels(
    mesh: &Mesh,
    options: &BakeOptions,
    texels: &TexelOptions,
    budget: Duration,
    progress: &dyn Progress,
) -> Result<TimePlan, Error> {
    plan(options, budget, progress, || {
        let laid_out = LaidOut::new(mesh, options, texels, progress)?;
        let gathered = if options.bounces > 0 { mesh.positions().len() } else { 0 };
        let (vertices, all) = (sample_count(gathered), laid_out.texels.len());
        let mut pilot = Pilot::of_vertices(mesh, &spread(gathered, vertices));
        laid_out.add_points(&pilot.scene, spread(all, sample_count(all)), &mut pilot.normals, &mut pilot.origins);
        let shares = vec![
            Share { points: 0..vertices, all: gathered, gathers: options.bounces.saturating_sub(1) },
            Share { points: vertices..pilot.normals.len(), all, gathers: options.bounces.min(1) },
        ];
        Ok((pilot, shares))
    })
}

/// How many of some points are measured.
fn sample_count(all: usize) -> usize {
    (all / POINTS_PER_SAMPLE).clamp(FEWEST_SAMPLES, MOST_SAMPLES).min(all)
}

/// - `scene`: makes what is measured
fn plan<'a>(
    options: &BakeOptions,
    budget: Duration,
    progress: &dyn Progress,
    scene: impl FnOnce() -> Result<(Pilot<'a>, Vec<Share>), Error>,
) -> Result<TimePlan, Error> {
    options.validate()?;
    if !options.shadowed {
        return Err(Error::Option("a time to bake in, without shadows: there is nothing to trace".to_owned()));
    }
    let start = Instant::now();
    let (pilot, shares) = scene()?;
    let mut ladder = Ladder::new(&BakeOptions { target_error: Some(1.0), ..options.clone() });
    // The bake builds the tree and the sets of directions again, once for vertices and once for texels.
    let passes = shares.iter().filter(|share| !share.points.is_empty()).count() as u32;
    let clock = Clock::new(pilot, shares, options, passes * start.elapsed())?;
    let mut plan = TimePlan {
        target_error: 1.0,
        expected: clock.build,
        pilot: Duration::ZERO,
        vertices: clock.pilot.normals.len(),
    };
    let mut before: Option<Tried> = None;
    let mut error = 1.0;
    loop {
        let tried = clock.time(&mut ladder, options, error, progress)?;
        let left = SHARE * budget.saturating_sub(start.elapsed()).as_secs_f64();
        let is_late = tried.seconds > left;
        let chosen = if is_late { tried.between(before.as_ref(), left) } else { tried };
        (plan.target_error, plan.expected) = (chosen.error, Duration::from_secs_f64(chosen.seconds));
        if is_late || tried.is_exhausted || error / STEP < SMALLEST_ERROR {
            plan.pilot = start.elapsed();
            return Ok(plan);
        }
        before = Some(tried);
        error /= STEP;
    }
}

/// What a bake with some target error will take.
#[derive(Debug, Clone, Copy)]
struct Tried {
    error: f64,
    seconds: f64,
    /// Whether a smaller error would change nothing: all vertices have all their rays.
    is_exhausted: bool,
}

impl Tried {
    /// Where the time is `seconds`, between a larger error, which takes less, and this one: on a power law through both.
    fn between(self, larger: Option<&Self>, seconds: f64) -> Self {
        let Some(larger) = larger.filter(|larger| larger.seconds < seconds) else { return *larger.unwrap_or(&self) };
        let share = (seconds / larger.seconds).ln() / (self.seconds / larger.seconds).ln();
        Self { error: larger.error * (self.error / larger.error).powf(share), seconds, is_exhausted: false }
    }
}

/// Points of one kind, vertices or texels.
#[derive(Debug)]
struct Share {
    /// Those of the pilot.
    points: Range<usize>,
    /// How many there are to bake.
    all: usize,
    /// How often each gathers reflected light.
    gathers: usize,
}

/// Measures what points take.
struct Clock<'a> {
    pilot: Pilot<'a>,
    shares: Vec<Share>,
    threads: Threads,
    reflection: Option<Reflection<'a>>,
    /// Time to build what does not depend on the error.
    build: Duration,
}

impl<'a> Clock<'a> {
    fn new(pilot: Pilot<'a>, shares: Vec<Share>, options: &BakeOptions, build: Duration) -> Result<Self, Error> {
        let threads = Threads::new(options.threads)?;
        let mesh = pilot.mesh;
        let arriving =
            || TransferVectors::unshadowed(options.order, mesh.normals()).with_channels(mesh.channel_count());
        let reflection = (options.bounces > 0).then(|| Reflection::new(mesh.triangles(), arriving()));
        Ok(Self { pilot, shares, threads, reflection, build })
    }

    fn time(
        &self,
        ladder: &mut Ladder,
        options: &BakeOptions,
        error: f64,
        progress: &dyn Progress,
    ) -> Result<Tried, Error> {
        ladder.aim(&BakeOptions { target_error: Some(error), ..options.clone() });
        let direct = self.pilot.direct(ladder);
        let validity = ValidityTest::new(&self.pilot.scene, self.pilot.mesh);
        let mut seconds = self.build.as_secs_f64();
        let mut is_exhausted = true;
        for share in self.shares.iter().filter(|share| !share.points.is_empty()) {
            let mut items: Vec<(usize, Duration, bool)> =
                share.points.clone().map(|point| (point, Duration::ZERO, true)).collect();
            self.threads.for_each(&mut items, &Quiet(progress), Memory::default, |memory, _, item| {
                let (point, duration, is_exhausted) = item;
                let start = Instant::now();
                let (rays, found_all) = self.point(&direct, &validity, memory, *point, share.gathers);
                (*duration, *is_exhausted) = (start.elapsed(), found_all);
                rays
            })?;
            let spent: Duration = items.iter().map(|(_, duration, _)| *duration).sum();
            let scale = share.all as f64 / items.len() as f64;
            seconds += spent.as_secs_f64() * scale / self.threads.count() as f64;
            is_exhausted &= items.iter().all(|(.., is_exhausted)| *is_exhausted);
        }
        Ok(Tried { error, seconds, is_exhausted })
    }

    /// What a bake does with a point. Returns the rays, and whether no target error would give it more: a point that is open or blocked
    /// ends on its first rung, which is the third from the end at most.
    fn point(
        &self,
        direct: &DirectPass,
        validity: &ValidityTest,
        memory: &mut Memory,
        point: usize,
        gathers: usize,
    ) -> (u64, bool) {
        memory.row.resize(direct.ladder.order.coeff_count(), 0.0);
        let mut stats = direct.shadowed_vector(&mut memory.scratch, point, &mut memory.row);
        validity.complete(direct.normals[point], direct.origins[point], &mut stats);
        if let Some(reflection) = self.reflection.as_ref().filter(|_| gathers > 0) {
            memory.hits.clear();
            stats.rays += direct.nearest_hits(&mut memory.scratch, point, &mut memory.hits);
            (0..gathers).for_each(|_| reflection.gather(&memory.hits, &mut memory.gathered));
        }
        let rungs_left = direct.ladder.rungs.len() - 1 - memory.scratch.last;
        (u64::from(stats.rays), rungs_left == 0 || (stats.error == 0.0 && rungs_left == 2))
    }
}

/// Memory of a thread.
#[derive(Default)]
struct Memory {
    scratch: Scratch,
    row: Vec<f32>,
    hits: Vec<HitRecord>,
    gathered: Vec<f64>,
}

/// Hears only that it should stop: the pilot is not a pass.
struct Quiet<'a>(&'a dyn Progress);

impl Progress for Quiet<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::{MeshOptions, MeshSource};

    fn triangle() -> Mesh {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let source = MeshSource { positions, triangles: vec![[0, 1, 2]], ..MeshSource::default() };
        Mesh::new(source, &MeshOptions::default()).unwrap().0
    }

    #[test]
    fn between_two_errors_time_is_a_power_of_the_error() {
        let tried = |error, seconds| Tried { error, seconds, is_exhausted: false };
        let chosen = tried(0.01, 8.0).between(Some(&tried(0.1, 2.0)), 4.0);
        assert!((chosen.error - 0.1 * 0.1_f64.sqrt()).abs() < 1e-12);
        assert!((chosen.seconds - 4.0).abs() < f64::EPSILON);
        // Nothing is fast enough: the largest error that was tried.
        assert!((tried(0.01, 8.0).between(None, 1.0).error - 0.01).abs() < f64::EPSILON);
        assert!((tried(0.01, 8.0).between(Some(&tried(0.1, 2.0)), 1.0).error - 0.1).abs() < f64::EPSILON);
    }

    #[test]
    fn no_time_gives_the_largest_error_and_much_time_the_smallest() {
        let plan = |options: &BakeOptions, budget| error_for_time(&triangle(), options, budget, &()).unwrap();
        let options = BakeOptions { bounces: 1, ..BakeOptions::default() };
        assert!((plan(&options, Duration::ZERO).target_error - 1.0).abs() < f64::EPSILON);
        // Three open vertices: the finest set that they are given is reached long before a day is over.
        let error = plan(&options, Duration::from_secs(86_400)).target_error;
        assert!(error < 0.5 / 1024.0 * STEP && error > SMALLEST_ERROR, "{error}");
    }

    #[test]
    fn a_pilot_hears_that_it_should_stop() {
        struct Stop;
        impl Progress for Stop {
            fn is_cancelled(&self) -> bool {
                true
            }
        }
        let day = Duration::from_secs(86_400);
        assert!(matches!(error_for_time(&triangle(), &BakeOptions::default(), day, &Stop), Err(Error::Cancelled)));
        let unshadowed = BakeOptions { shadowed: false, ..BakeOptions::default() };
        assert!(matches!(error_for_time(&triangle(), &unshadowed, day, &()), Err(Error::Option(_))));
    }
}
