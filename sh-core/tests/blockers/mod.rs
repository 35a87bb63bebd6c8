//! Visibility functions like those of a game: spheres in random directions, and the logarithms of each.

use std::f64::consts::PI;

use sh_core::{Order, expand_zonal, log};

/// Numbers in 0..1; the same for the same seed.
#[derive(Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed + 1) | 1)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn direction(&mut self) -> [f64; 3] {
        let (z, phi) = (2.0 * self.next() - 1.0, 2.0 * PI * self.next());
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    }
}

/// Zonal coefficients of a function that is 0 within the half angle about +z and 1 elsewhere.
///
/// `−√((2l+1)/4π) 2π ∫_cosθ^1 P_l = −√((2l+1)/4π) 2π (P_l−1(cosθ) − P_l+1(cosθ))/(2l+1)`, and the constant 1.
pub(crate) fn cap(order: Order, half_angle: f64) -> Vec<f64> {
    let z = half_angle.cos();
    let (mut below, mut current) = (1.0, z);
    let mut zonal = vec![(4.0 * PI).sqrt() - PI.sqrt() * (1.0 - z)];
    for l in 1..order.get() {
        let degree = (2 * l + 1) as f64;
        let above = (degree * z * current - l as f64 * below) / (l + 1) as f64;
        zonal.push(-(PI / degree).sqrt() * (below - above));
        (below, current) = (current, above);
    }
    zonal
}

/// Zonal coefficients about an axis, all of them.
pub(crate) fn about(order: Order, zonal: &[f64], axis: [f64; 3]) -> Vec<f64> {
    let mut out = vec![0.0; order.coeff_count()];
    expand_zonal(order, zonal, axis, &mut out);
    out
}

/// Half angles for which logarithms are made, from 2 degrees up.
pub(crate) const ANGLE_STEP: f64 = PI / 90.0;

/// Logarithms of caps, as zonal coefficients.
#[derive(Debug)]
pub(crate) struct Logarithms {
    order: Order,
    zonal: Vec<Vec<f64>>,
}

impl Logarithms {
    pub(crate) fn new(order: Order, floor: f64) -> Self {
        let zonal = (1..=30).map(|step| {
            let visibility = about(order, &cap(order, f64::from(step) * ANGLE_STEP), [0.0, 0.0, 1.0]);
            let mut out = vec![0.0; order.coeff_count()];
            log(order, &visibility, floor, &mut out);
            (0..order.get()).map(|l| out[l * (l + 1)]).collect()
        });
        Self { order, zonal: zonal.collect() }
    }
}

/// Some blockers: their axes, and half angles in steps of [`ANGLE_STEP`].
#[derive(Debug)]
pub(crate) struct Blockers(pub(crate) Vec<([f64; 3], usize)>);

impl Blockers {
    /// Half angles of 8° to 38°, in steps of 2°.
    pub(crate) fn random(count: usize, random: &mut Random) -> Self {
        Self((0..count).map(|_| (random.direction(), 4 + (random.next() * 16.0) as usize)).collect())
    }

    /// The sum of the logarithms.
    pub(crate) fn logarithm(&self, logarithms: &Logarithms) -> Vec<f64> {
        let mut sum = vec![0.0; logarithms.order.coeff_count()];
        for &(axis, angle) in &self.0 {
            let one = about(logarithms.order, &logarithms.zonal[angle - 1], axis);
            sum.iter_mut().zip(one).for_each(|(sum, f)| *sum += f);
        }
        sum
    }
}
