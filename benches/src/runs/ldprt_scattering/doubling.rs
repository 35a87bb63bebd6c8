//! The adding-doubling method for a plane slab: reflectance and transmittance without any random number.
//!
//! Light runs in discrete directions; a layer is a pair of matrices that turn radiance that falls on it into radiance that it sends back
//! and lets through. A layer so thin that light is scattered in it once at most is doubled until it has its depth, and Fresnel's
//! boundaries are put around it. Source: H. C. van de Hulst, Multiple Light Scattering, 1980; S. Prahl et al., Applied Optics 32, 1993.

/// Directions below the critical angle, and as many above it.
const HALF: usize = 16;
const COUNT: usize = 2 * HALF;

/// Halvings of the slab: the first layer is the slab over 2²⁶ deep.
const DOUBLINGS: usize = 26;

type Matrix = Vec<[f64; COUNT]>;

/// A slab between two equal outsides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slab {
    /// Optical depth.
    pub(super) depth: f64,
    /// Share of the extinction that is scattering.
    pub(super) albedo: f64,
    /// Henyey and Greenstein's mean cosine.
    pub(super) g: f64,
    /// Index of refraction relative to the outside, at least 1.
    pub(super) ior: f64,
}

impl Slab {
    /// Shares of uniform light that come back and through.
    pub(super) fn shares(&self) -> [f64; 2] {
        let nodes = self.nodes();
        let (reflect, transmit) = self.layer(&nodes);
        let boundary = nodes.map(|(mu, _)| fresnel_inside(mu, self.ior));
        // Radiance over n²: what enters, then what runs down and up inside at both boundaries, until nothing changes.
        let entering = boundary.map(|f| 1.0 - f);
        let (mut down, mut up_below) = (entering, [0.0; COUNT]);
        let (mut up, mut out) = ([0.0; COUNT], [0.0; COUNT]);
        for _ in 0..ROUNDS {
            up = add(&apply(&reflect, &down), &apply(&transmit, &up_below));
            out = add(&apply(&transmit, &down), &apply(&reflect, &up_below));
            down = std::array::from_fn(|i| entering[i] + boundary[i] * up[i]);
            up_below = std::array::from_fn(|i| boundary[i] * out[i]);
        }
        let flux = |radiance: &[f64; COUNT]| -> f64 {
            let leaving = nodes.iter().zip(radiance).zip(boundary);
            leaving.map(|((&(mu, weight), l), f)| 2.0 * self.ior * self.ior * weight * mu * (1.0 - f) * l).sum()
        };
        [1.0 - flux(&[1.0; COUNT]) + flux(&up), flux(&out)]
    }

    /// Cosines with the weights of their intervals: Gauss's rule on both sides of the critical angle.
    fn nodes(&self) -> [(f64, f64); COUNT] {
        let critical = (1.0 - 1.0 / (self.ior * self.ior)).sqrt();
        // Without a boundary the half of the directions goes to the lower quarter, where radiance is steep.
        let split = if critical > 0.0 { critical } else { 0.25 };
        let rule = gauss_legendre();
        std::array::from_fn(|k| {
            let (start, end) = if k < HALF { (0.0, split) } else { (split, 1.0) };
            let (x, weight) = rule[k % HALF];
            (start + 0.5 * (x + 1.0) * (end - start), 0.5 * weight * (end - start))
        })
    }

    /// Reflection and transmission of the slab without its boundaries.
    fn layer(&self, nodes: &[(f64, f64); COUNT]) -> (Matrix, Matrix) {
        let thin = self.depth / 2_f64.powi(DOUBLINGS as i32);
        let (mut reflect, mut transmit) = (vec![[0.0; COUNT]; COUNT], vec![[0.0; COUNT]; COUNT]);
        for (i, &(mu, _)) in nodes.iter().enumerate() {
            for (j, &(from, weight)) in nodes.iter().enumerate() {
                let scattered = 0.5 * self.albedo * thin / mu * weight;
                reflect[i][j] = scattered * self.phase(mu, -from);
                transmit[i][j] = scattered * self.phase(mu, from);
            }
            transmit[i][i] += 1.0 - thin / mu;
        }
        (0..DOUBLINGS).fold((reflect, transmit), |(reflect, transmit), _| doubled(&reflect, &transmit))
    }

    /// Henyey and Greenstein's phase function averaged over azimuth, `Σ (2l+1) g^l P_l(μ) P_l(μ′)`; its mean over μ′ is 1.
    fn phase(&self, mu: f64, from: f64) -> f64 {
        let legendre = |x: f64| {
            let mut pair = (1.0, x);
            (0..COUNT).map(move |l| {
                let value = pair.0;
                let l = l as f64;
                pair = (pair.1, ((2.0 * l + 3.0) * x * pair.1 - (l + 1.0) * pair.0) / (l + 2.0));
                value
            })
        };
        let terms = legendre(mu).zip(legendre(from)).enumerate();
        terms.map(|(l, (a, b))| (2.0 * l as f64 + 1.0) * self.g.powi(l as i32) * a * b).sum()
    }
}

/// Reflections to and fro between boundaries that are followed; at index 1.5 the inside of a boundary lets out 40 % each time.
const ROUNDS: usize = 2000;

/// Two equal layers, one on the other: `T (1 − R²)⁻¹ T` and `R + T (1 − R²)⁻¹ R T`.
fn doubled(reflect: &Matrix, transmit: &Matrix) -> (Matrix, Matrix) {
    let mut between = multiply(reflect, reflect);
    for (i, row) in between.iter_mut().enumerate() {
        row.iter_mut().for_each(|value| *value = -*value);
        row[i] += 1.0;
    }
    let through = multiply(transmit, &solved(between.clone(), transmit.clone()));
    let back = multiply(transmit, &solved(between, multiply(reflect, transmit)));
    let reflect = reflect.iter().zip(&back).map(|(a, b)| add(a, b)).collect();
    (reflect, through)
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |row: &[f64; COUNT]| std::array::from_fn(|j| row.iter().zip(b).map(|(x, b)| x * b[j]).sum());
    a.iter().map(row).collect()
}

/// The solution X of `A X = B`, by Gauss's elimination; A is close to the identity, so no row is exchanged.
fn solved(mut a: Matrix, mut b: Matrix) -> Matrix {
    for pivot in 0..COUNT {
        let scale = 1.0 / a[pivot][pivot];
        let (pivot_a, pivot_b) = (a[pivot].map(|x| x * scale), b[pivot].map(|x| x * scale));
        for row in 0..COUNT {
            let factor = a[row][pivot];
            for k in 0..COUNT {
                a[row][k] -= factor * pivot_a[k];
                b[row][k] -= factor * pivot_b[k];
            }
        }
        (a[pivot], b[pivot]) = (pivot_a, pivot_b);
    }
    b
}

fn apply(matrix: &Matrix, vector: &[f64; COUNT]) -> [f64; COUNT] {
    std::array::from_fn(|i| matrix[i].iter().zip(vector).map(|(a, x)| a * x).sum())
}

fn add(a: &[f64; COUNT], b: &[f64; COUNT]) -> [f64; COUNT] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Fresnel's reflectance of unpolarised light that comes from inside.
fn fresnel_inside(mu: f64, ior: f64) -> f64 {
    let outside = 1.0 - ior * ior * (1.0 - mu * mu);
    if outside <= 0.0 {
        return 1.0;
    }
    let mu_outside = outside.sqrt();
    let across = (ior * mu - mu_outside) / (ior * mu + mu_outside);
    let along = (mu - ior * mu_outside) / (mu + ior * mu_outside);
    0.5 * (across * across + along * along)
}

/// Nodes and weights on -1..1, by Newton's method from Tricomi's estimate.
fn gauss_legendre() -> [(f64, f64); HALF] {
    std::array::from_fn(|k| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (HALF as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for l in 1..HALF {
                let l = l as f64;
                (before, value) = (value, ((2.0 * l + 1.0) * x * value - l * before) / (l + 1.0));
            }
            slope = HALF as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_without_absorption() {
        for (depth, g, ior) in [(0.1, 0.0, 1.0), (3.0, 0.6, 1.0), (5.0, 0.0, 1.4)] {
            let [back, through] = Slab { depth, albedo: 1.0, g, ior }.shares();
            assert!((back + through - 1.0).abs() < 1e-5, "{depth} {g} {ior}: {back} {through}");
        }
    }

    #[test]
    fn thick_slabs_follow_diffusion() {
        let [_, through] = Slab { depth: 100.0, albedo: 1.0, g: 0.0, ior: 1.0 }.shares();
        // Milne's problem; the next term falls exponentially.
        assert!((through * (100.0 + 2.0 * 0.710_446) * 0.75 - 1.0).abs() < 1e-4, "{through}");
    }
}
