use crate::surface::{all_finite, check_length};
use crate::{Error, ViewMap};
use sh_core::Order;

/// Largest difference of a lobe's axis from unit length: above what half floats leave, far below what a wrong axis has.
const UNIT_TOLERANCE: f32 = 2e-3;

/// How many numbers the lobes of a point have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LobeShape {
    /// Order `n` of the lobes.
    pub order: Order,
    /// Rows `R`: 1 for a diffuse surface, the number of view factors for a glossy one.
    pub rows: usize,
    /// Channels `C`, 1 or 3. They share the lobes' axes.
    pub channels: usize,
    /// Lobes `N` of each row.
    pub lobe_count: usize,
    /// Explicit coefficients `k`: 1 (DC) or 4 (DC and the linear band).
    pub explicit_count: usize,
}

impl LobeShape {
    /// Explicit coefficients of a point, `R C k`.
    pub fn explicit_floats(&self) -> usize {
        self.rows * self.channels * self.explicit_count
    }

    /// Axes of a point, `R N`.
    pub fn axis_count(&self) -> usize {
        self.rows * self.lobe_count
    }

    /// Lobe coefficients of a point, `R C N n`.
    pub fn coeff_floats(&self) -> usize {
        self.axis_count() * self.channels * self.order.get()
    }

    /// The first band that lobes describe: those before are explicit.
    pub fn first_band(&self) -> usize {
        if self.explicit_count == 1 { 1 } else { 2 }
    }

    fn check(&self) -> Result<(), Error> {
        if self.channels != 1 && self.channels != 3 {
            return Err(Error::Channels { given: self.channels });
        }
        if self.rows == 0 {
            return Err(Error::Lobes("lobes with 0 rows were given; at least 1 is needed".into()));
        }
        let (k, n2) = (self.explicit_count, self.order.coeff_count());
        match (k == 1 || k == 4) && k <= n2 {
            true => Ok(()),
            false => Err(Error::Lobes(format!(
                "{k} explicit coefficients were given; 1, or 4 from order 2 on, are accepted, and the order is {}",
                self.order
            ))),
        }
    }
}

/// Transfer as sums of zonal lobes, for a set of points `P` (vertices or texels), borrowed from the caller and checked once.
///
/// Row `r` and channel `c` of a point have the transfer vector `t_i = explicit_i` for `i < k`, plus `Σ_j coeffs_jl y_lm(axis_j)`: eq. 11
/// of \[SLS05\]. Rotating the surface rotates the axes and the linear coefficients and leaves everything else as it is. Transfer
/// includes `1/π` and the cosine but not the point's own albedo.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Lobes<'a> {
    /// Sizes of the arrays.
    pub shape: LobeShape,
    /// `[P, R, C, k]`.
    pub explicit: &'a [f32],
    /// `[P, R, N]`, unit length.
    pub axes: &'a [[f32; 3]],
    /// `[P, R, C, N, n]`, lobe coefficients `g*_l` (eq. 4), exactly 0 in the explicit bands.
    pub coeffs: &'a [f32],
    /// How the rows add up for a direction of view; needed for more than one row.
    pub view_map: Option<ViewMap<'a>>,
}

impl<'a> Lobes<'a> {
    /// Checks shapes, that all numbers are finite, axes of unit length, and coefficients of explicit bands 0.
    ///
    /// The number of points is that of `explicit`.
    ///
    /// # Errors
    /// [`Error::Lobes`], [`Error::Channels`], [`Error::Length`], [`Error::NotFinite`].
    pub fn new(
        shape: LobeShape,
        explicit: &'a [f32],
        axes: &'a [[f32; 3]],
        coeffs: &'a [f32],
        view_map: Option<ViewMap<'a>>,
    ) -> Result<Self, Error> {
        shape.check()?;
        let lobes = Self { shape, explicit, axes, coeffs, view_map };
        lobes.check_lengths()?;
        lobes.check_view_map()?;
        lobes.check_values()?;
        Ok(lobes)
    }

    /// Number of points `P`.
    pub fn point_count(&self) -> usize {
        self.explicit.len() / self.shape.explicit_floats()
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let (points, shape) = (self.point_count(), self.shape);
        let because = || {
            let LobeShape { order, rows, channels, lobe_count, explicit_count } = shape;
            format!(
                "{points} points of {rows} rows, {channels} channels, {explicit_count} explicit coefficients and {lobe_count} lobes of order {order}"
            )
        };
        check_length("explicit", self.explicit.len(), "floats", points * shape.explicit_floats(), because)?;
        check_length("axes", self.axes.len(), "entries", points * shape.axis_count(), because)?;
        check_length("coeffs", self.coeffs.len(), "floats", points * shape.coeff_floats(), because)
    }

    fn check_view_map(&self) -> Result<(), Error> {
        let rows = self.shape.rows;
        match self.view_map {
            None if rows > 1 => Err(Error::Lobes(format!("lobes of {rows} rows need a view map"))),
            None => Ok(()),
            Some(map) => map.check(rows),
        }
    }

    fn check_values(&self) -> Result<(), Error> {
        let shape = self.shape;
        let explicit = self.explicit.chunks_exact(shape.explicit_floats());
        check_chunks_finite("explicit coefficients of point", explicit)?;
        if shape.axis_count() == 0 {
            return Ok(());
        }
        check_chunks_finite("lobe coefficients of point", self.coeffs.chunks_exact(shape.coeff_floats()))?;
        let is_unit = |a: &[f32; 3]| (a.iter().map(|x| x * x).sum::<f32>().sqrt() - 1.0).abs() <= UNIT_TOLERANCE;
        if let Some(axis) = self.axes.iter().position(|axis| !is_unit(axis)) {
            let (point, lobe) = (axis / shape.axis_count(), axis % shape.axis_count());
            return Err(Error::Lobes(format!(
                "axis {lobe} of point {point} is {:?}; unit length is needed",
                self.axes[axis]
            )));
        }
        self.check_explicit_bands()
    }

    fn check_explicit_bands(&self) -> Result<(), Error> {
        let (shape, n) = (self.shape, self.shape.order.get());
        let is_explicit_zero = |lobe: &[f32]| lobe[..shape.first_band().min(n)].iter().all(|g| *g == 0.0);
        match self.coeffs.chunks_exact(n).position(|lobe| !is_explicit_zero(lobe)) {
            None => Ok(()),
            Some(lobe) => Err(Error::Lobes(format!(
                "a lobe of point {} has a coefficient in an explicit band; 0 is needed there",
                lobe * n / shape.coeff_floats()
            ))),
        }
    }
}

fn check_chunks_finite<'a>(what: &'static str, mut chunks: impl Iterator<Item = &'a [f32]>) -> Result<(), Error> {
    match chunks.position(|chunk| !all_finite(chunk)) {
        Some(item) => Err(Error::NotFinite { what, item }),
        None => Ok(()),
    }
}
