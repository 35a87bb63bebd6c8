//! What to fit, and with how much effort.

use crate::Error;

/// How the lobes are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// The coefficients follow from the axes by linear least squares, so only the axes are searched for, by Newton's method
    /// with the exact second derivatives.
    #[default]
    VariableProjection,
    /// The way of [SLS05](sh_core#references) section 4.1: BFGS over the axes and the coefficients at once, from the same
    /// starts. For comparison: it is about ten times slower (`repro ldprt/fit-trade`).
    QuasiNewton,
    /// Conjugate gradients over the axes and the coefficients at once, which [SLS05](sh_core#references) section 4.2 takes for
    /// large problems.
    ConjugateGradient,
}

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// The number of lobes `N`, or the largest one if there is a [`target_error`](Self::target_error); 1 to
    /// [`FitOptions::MAX_LOBES`]. Below 3 the coefficient of band 0 is stored explicitly, from 3 on those of bands 0 and 1:
    /// [`explicit_count`](crate::explicit_count).
    pub lobe_count: usize,
    /// How the lobes are found.
    pub method: Method,
    /// Starts beside the greedy one: first axes that are evenly spread at random, to which the others are added greedily. More
    /// find better minima; at most [`FitOptions::MAX_STARTS`].
    pub starts: usize,
    /// Stop adding lobes at this relative error: for the whole set (L2 error over the L2 length of the signal), or for each
    /// point, whose error is then taken relative to the root mean square of all lengths. `None` uses all lobes.
    pub target_error: Option<f64>,
    /// With a [`target_error`](Self::target_error), whether each point gets as many lobes as it needs; otherwise all points
    /// get the same number.
    pub per_point: bool,
    /// Try the axes of the neighbours of a point, in a second sweep, where neighbours are given.
    pub warm_start: bool,
    /// Most iterations from one start.
    pub max_iterations: usize,
    /// An iteration that is expected to lower the squared error by less than this part of itself is the last one.
    pub tolerance: f64,
    /// Penalty `μ` on the coefficients: `|t̃ − t|² + μ Σ (2l+1)/(4π) g*_l²`. It keeps lobes whose axes nearly coincide from
    /// cancelling with huge coefficients: none exceeds `2 |t| √π / √((2l+1) μ)`. At least [`FitOptions::MIN_REGULARISATION`].
    pub regularisation: f64,
    /// Seed of the random starts.
    pub seed: u64,
    /// Number of threads; all that the machine has if `None`. The result is the same for any number.
    pub threads: Option<usize>,
}

impl FitOptions {
    /// Most lobes of one fit.
    pub const MAX_LOBES: usize = 32;
    /// Most random starts.
    pub const MAX_STARTS: usize = 1 << 16;
    /// Most iterations.
    pub const MAX_ITERATIONS: usize = 1 << 20;
    /// Least regularisation: Gram matrices of coincident lobes keep a pivot a thousand times above rounding.
    pub const MIN_REGULARISATION: f64 = 1e-12;

    /// The greedy start alone, and the neighbours.
    #[must_use]
    pub fn fast() -> Self {
        Self { starts: 0, tolerance: 1e-2, ..Self::default() }
    }

    /// 300 starts, for signals without structure and for the least error: with 100, fits of random vectors by four lobes are 4 %
    /// worse than with 500 (`repro ldprt/fig2`).
    #[must_use]
    pub fn thorough() -> Self {
        Self { starts: 300, max_iterations: 200, tolerance: 1e-6, ..Self::default() }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Option`] names the first setting that cannot be used.
    pub fn validate(&self) -> Result<(), Error> {
        let fail = |message: String| Err(Error::Option(message));
        if !(1..=Self::MAX_LOBES).contains(&self.lobe_count) {
            return fail(format!("{} lobes; 1 to {} are possible", self.lobe_count, Self::MAX_LOBES));
        }
        if self.starts > Self::MAX_STARTS {
            return fail(format!("{} random starts; at most {} are possible", self.starts, Self::MAX_STARTS));
        }
        if !(1..=Self::MAX_ITERATIONS).contains(&self.max_iterations) {
            return fail(format!("{} iterations; 1 to {} are possible", self.max_iterations, Self::MAX_ITERATIONS));
        }
        if let Some(error) = self.target_error.filter(|error| !(error.is_finite() && *error >= 0.0)) {
            return fail(format!("a target error of {error}; it is a number from 0 on"));
        }
        if self.per_point && self.target_error.is_none() {
            return fail("lobes by point without a target error, which says how many a point needs".to_owned());
        }
        if !(0.0..=1.0).contains(&self.tolerance) {
            return fail(format!("a tolerance of {}; 0 to 1 are possible", self.tolerance));
        }
        if !(Self::MIN_REGULARISATION..=1.0).contains(&self.regularisation) {
            let least = Self::MIN_REGULARISATION;
            return fail(format!("a regularisation of {}; {least:e} to 1 are possible", self.regularisation));
        }
        if self.threads == Some(0) {
            return fail("0 threads; at least 1 is needed".to_owned());
        }
        Ok(())
    }
}

impl Default for FitOptions {
    /// Four lobes by variable projection, from five starts and those of the neighbours.
    fn default() -> Self {
        Self {
            lobe_count: 4,
            method: Method::default(),
            starts: 4,
            target_error: None,
            per_point: false,
            warm_start: true,
            max_iterations: 50,
            tolerance: 1e-3,
            regularisation: 1e-5,
            seed: 0,
            threads: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_bad_settings_are_named() {
        for preset in [FitOptions::fast(), FitOptions::default(), FitOptions::thorough()] {
            assert_eq!(preset.validate(), Ok(()));
        }
        let bad = |change: fn(&mut FitOptions), message: &str| {
            let mut options = FitOptions::default();
            change(&mut options);
            assert_eq!(options.validate(), Err(Error::Option(message.to_owned())));
        };
        bad(|o| o.lobe_count = 0, "0 lobes; 1 to 32 are possible");
        bad(|o| o.lobe_count = 33, "33 lobes; 1 to 32 are possible");
        bad(|o| o.starts = 70_000, "70000 random starts; at most 65536 are possible");
        bad(|o| o.max_iterations = 0, "0 iterations; 1 to 1048576 are possible");
        bad(|o| o.target_error = Some(f64::NAN), "a target error of NaN; it is a number from 0 on");
        bad(|o| o.target_error = Some(-0.1), "a target error of -0.1; it is a number from 0 on");
        bad(|o| o.per_point = true, "lobes by point without a target error, which says how many a point needs");
        bad(|o| o.tolerance = -1.0, "a tolerance of -1; 0 to 1 are possible");
        bad(|o| o.regularisation = 0.0, "a regularisation of 0; 1e-12 to 1 are possible");
        bad(|o| o.threads = Some(0), "0 threads; at least 1 is needed");
    }
}
