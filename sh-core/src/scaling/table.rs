//! Scaling matrices for many `k`, interpolated between those that were computed.

use alloc::vec::Vec;

use super::matrix::ScalingMatrix;
use super::tau::{Preserve, Tau};
use crate::order::assert_length;
use crate::{Error, Order, Real};

/// How [`ScalingTable`] finds a matrix between its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub enum Interpolation {
    /// Linear in `k`, between two nodes, as in [WXZ06](crate#references).
    Linear,
    /// The cubic polynomial in `ln k` through four nodes. Needs positive nodes.
    #[default]
    CubicLog,
    /// The cubic polynomial in `k` through four nodes, for [`Tau::MidRange`], whose `k` has both signs.
    Cubic,
}

/// Scaling matrices at nodes in `k`, and between them by interpolation.
///
/// ```
/// use sh_core::{Interpolation, Order, Preserve, ScalingMatrix, ScalingTable, Tau, geometric_nodes};
///
/// let order = Order::new(4)?;
/// let nodes = geometric_nodes(0.2, 16.0, 40)?;
/// let table =
///     ScalingTable::<f32>::new(order, order, &nodes, Tau::cone, Preserve::Value, Interpolation::CubicLog)?;
/// let mut matrix = table.matrix(1.37); // allocates once
/// table.interpolate(0.93, &mut matrix); // per vertex: does not
/// let exact = ScalingMatrix::<f32>::new(order, order, Tau::cone(0.93), Preserve::Value)?;
/// assert!(matrix.entries().zip(exact.entries()).all(|(a, b)| (a.2 - b.2).abs() < 5e-4));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Accuracy: the largest error over `k` for 40 nodes on 0.2..=16 and the paper's cone, as the spectral norm of the error of
/// the matrix, measured by `tests/scaling_table.rs`, which asserts the limits:
///
/// | | n = 4 | n = 6 | limits |
/// |---|---|---|---|
/// | [`Linear`](Interpolation::Linear) | 1.4e-2 | 3.4e-2 | 1.5e-2, 3.5e-2 |
/// | [`CubicLog`](Interpolation::CubicLog) | 4.3e-4 | 2.4e-3 | 5e-4, 2.5e-3 |
///
/// At a node, and so at k = 1 with [`geometric_nodes`], the matrix is the computed one.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalingTable<T> {
    order: Order,
    source_order: Order,
    interpolation: Interpolation,
    /// Nodes in the variable of the interpolation.
    nodes: Vec<f64>,
    /// The entries of one matrix per node.
    samples: Vec<Vec<T>>,
}

/// `count` nodes from `first` to `last` that grow by nearly equal factors, one of them exactly 1 if 1 is between the ends.
///
/// # Errors
/// [`Error::Scaling`] if not `0 < first < last`, both finite, or if `count` is below 2, or below 3 with 1 between the ends.
pub fn geometric_nodes(first: f64, last: f64, count: usize) -> Result<Vec<f64>, Error> {
    if !(first > 0.0 && first.is_finite()) {
        return Err(Error::Scaling { what: "the first node", given: first, accepted: "positive and finite" });
    }
    if !(last > first && last.is_finite()) {
        return Err(Error::Scaling { what: "the last node", given: last, accepted: "above the first and finite" });
    }
    let one_inside = first < 1.0 && 1.0 < last;
    if count < 2 + usize::from(one_inside) {
        let accepted = "3 or more, or 2 without 1 between the ends";
        return Err(Error::Scaling { what: "the number of nodes", given: count as f64, accepted });
    }
    let steps = |from: f64, to: f64, steps: usize| {
        let (a, b) = (Real::ln(from), Real::ln(to));
        (1..steps).map(move |i| Real::exp(a + (b - a) * i as f64 / steps as f64))
    };
    let mut nodes = Vec::with_capacity(count);
    nodes.push(first);
    if one_inside {
        let share = -Real::ln(first) / Real::ln(last / first);
        let below = ((share * (count - 1) as f64 + 0.5) as usize).clamp(1, count - 2);
        nodes.extend(steps(first, 1.0, below));
        nodes.push(1.0);
        nodes.extend(steps(1.0, last, count - 1 - below));
    } else {
        nodes.extend(steps(first, last, count - 1));
    }
    nodes.push(last);
    Ok(nodes)
}

impl<T: Real> ScalingTable<T> {
    /// Computes the matrices at the nodes.
    ///
    /// - `nodes`: `k`, increasing, at least two (four for a cubic, fewer lower its degree); see [`geometric_nodes`]
    /// - `tau`: the scaling function of `k`, for instance [`Tau::cone`]
    ///
    /// # Errors
    /// [`Error::Scaling`] if there are fewer than two nodes, if they do not increase, if they are not positive and the
    /// interpolation takes their logarithm, or from [`ScalingMatrix::new`].
    pub fn new(
        order: Order,
        source_order: Order,
        nodes: &[f64],
        tau: impl Fn(f64) -> Tau,
        preserve: Preserve,
        interpolation: Interpolation,
    ) -> Result<Self, Error> {
        check_nodes(nodes, interpolation)?;
        let matrices = nodes.iter().map(|&k| ScalingMatrix::new(order, source_order, tau(k), preserve));
        let samples = matrices.map(|matrix| Ok(matrix?.stored().to_vec())).collect::<Result<_, Error>>()?;
        let nodes = nodes.iter().map(|&k| variable(interpolation, k)).collect();
        Ok(Self { order, source_order, interpolation, nodes, samples })
    }

    /// The paper's table: its cone, 40 nodes from a fifth to sixteen times the distance of capture, but cubic in `ln k`.
    ///
    /// # Errors
    /// None in fact: the nodes and the cone have a meaning.
    pub fn cone(order: Order, source_order: Order, preserve: Preserve) -> Result<Self, Error> {
        let nodes = geometric_nodes(0.2, 16.0, 40)?;
        Self::new(order, source_order, &nodes, Tau::cone, preserve, Interpolation::CubicLog)
    }

    /// The order `n` of the scaled expansion.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The order `n′` of the captured expansion.
    pub fn source_order(&self) -> Order {
        self.source_order
    }

    /// The matrix for `k`; see [`interpolate`](Self::interpolate).
    pub fn matrix(&self, k: f64) -> ScalingMatrix<T> {
        let mut matrix = ScalingMatrix::zero(self.order, self.source_order);
        self.interpolate(k, &mut matrix);
        matrix
    }

    /// Overwrites `matrix` with the one for `k`.
    ///
    /// Beyond the ends, and at NaN, the nearest or the first node is taken. Does not allocate.
    ///
    /// # Panics
    /// If `matrix` has other orders than the table.
    pub fn interpolate(&self, k: f64, matrix: &mut ScalingMatrix<T>) {
        assert_length("matrix (rows)", matrix.order().get(), self.order.get());
        assert_length("matrix (columns)", matrix.source_order().get(), self.source_order.get());
        let (first, weights, count) = self.stencil(k);
        let out = matrix.stored_mut();
        out.fill(T::ZERO);
        for (sample, weight) in self.samples[first..first + count].iter().zip(weights) {
            let weight = T::from_f64(weight);
            out.iter_mut().zip(sample).for_each(|(out, &entry)| *out += weight * entry);
        }
    }

    /// The first node that is used, the weights, and how many they are: Lagrange's polynomials at `k`.
    fn stencil(&self, k: f64) -> (usize, [f64; 4], usize) {
        let (nodes, last) = (&self.nodes, self.nodes.len() - 1);
        // `max` turns NaN into the first node.
        let x = variable(self.interpolation, k).max(nodes[0]).min(nodes[last]);
        let interval = nodes.partition_point(|&node| node <= x).clamp(1, last) - 1;
        let (first, count) = match self.interpolation {
            Interpolation::Linear => (interval, 2),
            Interpolation::CubicLog | Interpolation::Cubic => {
                let count = nodes.len().min(4);
                (interval.saturating_sub(1).min(nodes.len() - count), count)
            }
        };
        let used = &nodes[first..first + count];
        let mut weights = [0.0; 4];
        for (i, weight) in weights.iter_mut().enumerate().take(count) {
            let others = used.iter().enumerate().filter(|&(j, _)| j != i);
            *weight = others.map(|(_, node)| (x - node) / (used[i] - node)).product();
        }
        (first, weights, count)
    }
}

/// What an interpolation is polynomial in.
fn variable(interpolation: Interpolation, k: f64) -> f64 {
    match interpolation {
        Interpolation::CubicLog if k > 0.0 => Real::ln(k),
        // Below every node.
        Interpolation::CubicLog => f64::NEG_INFINITY,
        Interpolation::Linear | Interpolation::Cubic => k,
    }
}

fn check_nodes(nodes: &[f64], interpolation: Interpolation) -> Result<(), Error> {
    if nodes.len() < 2 {
        return Err(Error::Scaling { what: "the number of nodes", given: nodes.len() as f64, accepted: "2 or more" });
    }
    if let Some(&node) = nodes.iter().find(|&&k| !k.is_finite() || interpolation == Interpolation::CubicLog && k <= 0.0)
    {
        return Err(Error::Scaling { what: "a node", given: node, accepted: "finite, and positive for its logarithm" });
    }
    match nodes.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(Error::Scaling { what: "a node", given: pair[1], accepted: "above the one before it" }),
        None => Ok(()),
    }
}
