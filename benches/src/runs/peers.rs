//! `sh-core` side by side with other libraries: the table of its README.

use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use sh_core::{
    BLOCK, Basis, BasisGradient, CubeMap, LatLong, Order, ProductTransform, Real, Sh, ShRotation, eval, fibonacci,
    product, project_cube, project_lat_long, rotate,
};
use sphrs::{Coordinates, HarmonicsSet, RealSH};

use crate::output::{markdown, table};

/// Directions of one measurement.
const DIRECTIONS: usize = 100_000;
/// Directions whose block stays in the first cache.
const CHUNK: usize = 12 * BLOCK;
/// Both sides are timed in turn, this often; the best time of each counts.
const ROUNDS: usize = 5;

const HEAD: [&str; 7] = ["operation", "n", "peer", "peer, ns", "sh-core, ns", "ratio", "aim"];
const MARKS: [&str; 2] = ["<!-- peers: written by benches/peers/run.sh -->", "<!-- end of peers -->"];

/// Times everything, prints the table, and writes it into the file that is named.
pub(super) fn run(readme: Option<&str>) -> Result<()> {
    let mut peers = Peers::start()?;
    let mut rows = Vec::new();
    evaluation(&mut peers, &mut rows)?;
    gradients(&mut peers, &mut rows)?;
    single_directions(&mut rows)?;
    guides(&mut rows)?;
    maps(&mut peers, &mut rows)?;
    table("sh-core/peers", &HEAD, &rows)?;
    match readme {
        Some(path) => write_between_marks(path, &format!("{}\n\n{}", peers.versions, markdown(&HEAD, &rows))),
        None => Ok(()),
    }
}

/// The Python program beside this one.
struct Peers {
    _process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    versions: String,
}

impl Peers {
    fn start() -> Result<Self> {
        let python = std::env::var_os("PRT_PEERS_PYTHON")
            .context("PRT_PEERS_PYTHON names no python with the peers installed: start this by benches/peers/run.sh")?;
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/peers.py");
        let mut process = Command::new(&python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot start {}", python.display()))?;
        let requests = process.stdin.take().context("the peers have no input")?;
        let answers = BufReader::new(process.stdout.take().context("the peers have no output")?);
        let mut peers = Self { _process: process, requests, answers, versions: String::new() };
        peers.versions = peers.line()?;
        Ok(peers)
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            bail!("the peers stopped");
        }
        Ok(line.trim().to_owned())
    }

    /// Nanoseconds per item.
    fn time(&mut self, what: &str, n: usize, scalar: &str, count: usize) -> Result<f64> {
        let scalar = if scalar == "f32" { "float32" } else { "float64" };
        writeln!(self.requests, r#"{{"what": "{what}", "n": {n}, "type": "{scalar}", "count": {count}}}"#)?;
        self.requests.flush()?;
        Ok(self.line()?.parse::<f64>()? * 1e9)
    }
}

/// Nanoseconds per item of the best of some calls.
fn time(count: usize, mut f: impl FnMut()) -> f64 {
    let mut once = || {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    (0..7).map(|_| once()).fold(f64::MAX, f64::min) / count as f64 * 1e9
}

/// The best of both sides, in turn.
fn compare(mut theirs: impl FnMut() -> Result<f64>, mut ours: impl FnMut() -> f64) -> Result<[f64; 2]> {
    let mut best = [f64::MAX; 2];
    for _ in 0..ROUNDS {
        best = [best[0].min(theirs()?), best[1].min(ours())];
    }
    Ok(best)
}

fn row(operation: &str, n: usize, peer: &str, [theirs, ours]: [f64; 2], asked: &str) -> Vec<String> {
    let digits = |ns: f64| if ns < 10.0 { format!("{ns:.2}") } else { format!("{ns:.0}") };
    vec![
        operation.into(),
        n.to_string(),
        peer.into(),
        digits(theirs),
        digits(ours),
        format!("**{:.1}**", theirs / ours),
        asked.into(),
    ]
}

fn order(n: usize) -> Order {
    Order::new(n).expect("orders of benches are valid")
}

fn directions<T: Real>() -> Vec<[T; 3]> {
    fibonacci(DIRECTIONS).into_iter().map(|s| s.map(T::from_f64)).collect()
}

fn evaluation(peers: &mut Peers, rows: &mut Vec<Vec<String>>) -> Result<()> {
    for (n, asked) in [(3, "8"), (4, "8"), (6, "9"), (10, "10")] {
        let best = compare(|| peers.time("sphericart", n, "f32", DIRECTIONS), || blocks::<f32>(n))?;
        rows.push(row("evaluate, f32, coefficient-major blocks in cache", n, "sphericart", best, asked));
    }
    for (n, asked) in [(3, "3"), (4, "3"), (6, "3"), (8, "5"), (10, "5")] {
        let best = compare(|| peers.time("sphericart", n, "f32", DIRECTIONS), || batch::<f32>(n))?;
        rows.push(row("evaluate, f32, `[D, n²]`", n, "sphericart", best, asked));
    }
    for (n, asked) in [(3, "2"), (4, "2"), (6, "2"), (8, "3"), (10, "3")] {
        let best = compare(|| peers.time("sphericart", n, "f64", DIRECTIONS), || batch::<f64>(n))?;
        rows.push(row("evaluate, f64, `[D, n²]`", n, "sphericart", best, asked));
    }
    Ok(())
}

fn blocks<T: Real>(n: usize) -> f64 {
    let (basis, directions) = (Basis::<T>::new(order(n)), directions::<T>());
    let mut y = vec![T::ZERO; CHUNK * n * n + LINE];
    let y = aligned(&mut y);
    time(DIRECTIONS, || {
        for chunk in directions.chunks(CHUNK) {
            basis.eval_blocks(black_box(chunk), &mut y[..chunk.len().next_multiple_of(BLOCK) * n * n]);
            black_box(&mut *y);
        }
    })
}

/// Numbers that are left over for an aligned beginning.
const LINE: usize = 16;

/// The part that begins with a line of the cache, as a caller arranges who wants the most speed.
fn aligned<T>(numbers: &mut [T]) -> &mut [T] {
    let begin = numbers.as_ptr().align_offset(64).min(LINE);
    &mut numbers[begin..]
}

fn batch<T: Real>(n: usize) -> f64 {
    let (basis, directions) = (Basis::<T>::new(order(n)), directions::<T>());
    let mut y = vec![T::ZERO; DIRECTIONS * n * n];
    time(DIRECTIONS, || {
        basis.eval_batch(black_box(&directions), &mut y);
        black_box(&mut y);
    })
}

fn gradients(peers: &mut Peers, rows: &mut Vec<Vec<String>>) -> Result<()> {
    for n in [3, 4, 6, 10] {
        let best = compare(|| peers.time("sphericart-gradient", n, "f32", DIRECTIONS), || gradient_blocks(n))?;
        rows.push(row("value and gradient, f32, blocks in cache", n, "sphericart", best, "5"));
    }
    Ok(())
}

fn gradient_blocks(n: usize) -> f64 {
    let (basis, directions) = (BasisGradient::<f32>::new(order(n)), directions::<f32>());
    let (mut y, mut gradients) = (vec![0.0; CHUNK * n * n + LINE], vec![0.0; 3 * CHUNK * n * n + LINE]);
    let (y, gradients) = (aligned(&mut y), aligned(&mut gradients));
    time(DIRECTIONS, || {
        for chunk in directions.chunks(CHUNK) {
            let size = chunk.len().next_multiple_of(BLOCK) * n * n;
            basis.eval_blocks(black_box(chunk), &mut y[..size], &mut gradients[..3 * size]);
            black_box((&mut *y, &mut *gradients));
        }
    })
}

fn single_directions(rows: &mut Vec<Vec<String>>) -> Result<()> {
    let fixed: [(usize, fn() -> f64); 4] =
        [(3, one_fixed::<9>), (4, one_fixed::<16>), (6, one_fixed::<36>), (10, one_fixed::<100>)];
    for (n, one_fixed) in fixed {
        let best = compare(|| Ok(sphrs(n)), one_fixed)?;
        rows.push(row("one direction, f64, `Sh::basis`", n, "sphrs", best, "15"));
        let best = compare(|| Ok(sphrs(n)), || one_direction(n))?;
        rows.push(row("one direction, f64, `eval`", n, "sphrs", best, "15"));
    }
    Ok(())
}

fn one_fixed<const LEN: usize>() -> f64 {
    let directions = fibonacci(1000);
    time(directions.len(), || {
        for direction in &directions {
            black_box(Sh::<f64, LEN>::basis(*black_box(direction)));
        }
    })
}

fn sphrs(n: usize) -> f64 {
    let set = HarmonicsSet::new(n - 1, RealSH::Spherical);
    let points: Vec<Coordinates<f64>> =
        fibonacci(1000).into_iter().map(|[x, y, z]| Coordinates::cartesian(x, y, z)).collect();
    time(points.len(), || {
        for point in &points {
            black_box(set.eval(black_box(point)));
        }
    })
}

fn one_direction(n: usize) -> f64 {
    let (directions, mut y) = (fibonacci(1000), vec![0.0; n * n]);
    time(directions.len(), || {
        for direction in &directions {
            eval(order(n), *black_box(direction), &mut y);
            black_box(&mut y);
        }
    })
}

/// What cannot be installed here is stated as the time that was measured for it on a machine of this kind.
fn guides(rows: &mut Vec<Vec<String>>) -> Result<()> {
    const ROTATE: [(usize, f64, &str); 4] = [(3, 17.0, "1"), (4, 33.0, "1.3"), (5, 47.0, "1.3"), (6, 70.0, "1.3")];
    const PRODUCT: [(usize, f64, &str); 4] = [(3, 21.0, "1.2"), (4, 80.0, "1.2"), (5, 263.0, "1.5"), (6, 720.0, "1.5")];
    for (n, guide, asked) in ROTATE {
        let best = compare(|| Ok(guide), || one_rotation(n))?;
        rows.push(row("build and apply one rotation, f32", n, "DirectXMath (guide)", best, asked));
    }
    for (n, guide, _) in ROTATE {
        let best = compare(|| Ok(guide), || many_rotations(n))?;
        rows.push(row("one rotation, many vectors, f32", n, "DirectXMath (guide)", best, "8"));
    }
    for (n, guide, asked) in PRODUCT.into_iter().chain([(10, 6000.0, "1")]) {
        let peer = if n == 10 { "limit" } else { "DirectXMath (guide)" };
        let best = compare(|| Ok(guide), || products(n))?;
        rows.push(row("product, f32", n, peer, best, asked));
    }
    Ok(())
}

/// Some coefficients, none of them zero.
fn coeffs(count: usize) -> Vec<f32> {
    (0..count).map(|i| (i as f32 * 0.37).sin() + 0.01).collect()
}

fn one_rotation(n: usize) -> f64 {
    let matrices: Vec<[[f32; 3]; 3]> = fibonacci(1000).into_iter().map(turn).collect();
    let (f, mut out) = (coeffs(n * n), vec![0.0; n * n]);
    time(matrices.len(), || {
        for matrix in &matrices {
            rotate(order(n), *black_box(matrix), black_box(&f), &mut out);
            black_box(&mut out);
        }
    })
}

/// Half a turn about an axis: `2 a aᵀ − 1`.
fn turn(axis: [f64; 3]) -> [[f32; 3]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| (2.0 * axis[r] * axis[c] - f64::from(u8::from(r == c))) as f32))
}

fn many_rotations(n: usize) -> f64 {
    const VECTORS: usize = 256;
    let rotation = ShRotation::<f32>::new(order(n), [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]);
    let (f, mut out) = (coeffs(VECTORS * n * n), vec![0.0; VECTORS * n * n]);
    time(100 * VECTORS, || {
        for _ in 0..100 {
            rotation.apply_many(black_box(&f), &mut out);
            black_box(&mut out);
        }
    })
}

fn products(n: usize) -> f64 {
    let (a, b, mut out) = (coeffs(n * n), coeffs(n * n), vec![0.0; n * n]);
    let mut transform = ProductTransform::<f32>::new(order(n));
    time(1000, || {
        for _ in 0..1000 {
            // Beyond n = 6 the tables are kept.
            match n {
                ..=6 => product(order(n), black_box(&a), black_box(&b), &mut out),
                _ => transform.product(black_box(&a), black_box(&b), &mut out),
            }
            black_box(&mut out);
        }
    })
}

fn maps(peers: &mut Peers, rows: &mut Vec<Vec<String>>) -> Result<()> {
    let best = compare(|| Ok(80.0), || cube(6))?;
    rows.push(row("cube map RGB 6×256², per texel", 6, "sphericart and BLAS (guide)", best, "6"));
    let best = compare(|| peers.time("ducc0", 6, "f32", 1024 * 512), || lat_long(6))?;
    rows.push(row("latitude-longitude map RGB 1024×512, per texel", 6, "ducc0 analysis_2d", best, "4"));
    Ok(())
}

fn pixels(count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|i| (i % 251) as f32).map(|v| [v, 0.5 * v, 2.0 + v]).collect()
}

fn cube(n: usize) -> f64 {
    let (size, mut light) = (256, vec![0.0; 3 * n * n]);
    let face = pixels(size * size);
    time(6 * size * size, || {
        project_cube(order(n), CubeMap { size }, black_box([face.as_slice(); 6]), &mut light);
        black_box(&mut light);
    })
}

fn lat_long(n: usize) -> f64 {
    let (map, mut light) = (LatLong { width: 1024, height: 512 }, vec![0.0; 3 * n * n]);
    let pixels = pixels(map.texel_count());
    time(pixels.len(), || {
        project_lat_long(order(n), map, black_box(&pixels), &mut light);
        black_box(&mut light);
    })
}

/// Replaces what stands between the marks of a file.
fn write_between_marks(path: &str, text: &str) -> Result<()> {
    let file = std::fs::read_to_string(path).with_context(|| format!("cannot read {path}"))?;
    let [begin, end] = MARKS.map(|mark| file.find(mark));
    let (Some(begin), Some(end)) = (begin, end) else { bail!("{path} has no marks {MARKS:?}") };
    let new = format!("{}{}\n\n{text}\n{}", &file[..begin], MARKS[0], &file[end..]);
    std::fs::write(path, new).with_context(|| format!("cannot write {path}"))
}
