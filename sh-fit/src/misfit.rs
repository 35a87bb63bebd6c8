//! The error of lobes against transfer.

use crate::LobeSet;

/// The L2 error of lobes over all points and channels, relative to the L2 length of the signal; 0 if that is zero.
///
/// - `targets`: `[P, C, n²]`; points with a coefficient that is not finite are left out
///
/// # Panics
/// If `targets` is not `[P, C, n²]`.
#[must_use]
pub fn relative_error(set: &LobeSet, targets: &[f32]) -> f64 {
    let count = set.order.coeff_count();
    assert_targets(set, targets);
    let mut found = vec![0.0; count];
    let (mut error, mut length) = (0.0, 0.0);
    for (point, target) in targets.chunks_exact(set.channels * count).enumerate().filter(|(_, target)| finite(target)) {
        for (channel, target) in target.chunks_exact(count).enumerate() {
            set.reconstruct(point, channel, &mut found);
            error += found.iter().zip(target).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
            length += target.iter().map(|t| f64::from(*t).powi(2)).sum::<f64>();
        }
    }
    if length > 0.0 { (error / length).sqrt() } else { 0.0 }
}

/// Panics unless `targets` is `[P, C, n²]`.
#[track_caller]
pub(crate) fn assert_targets(set: &LobeSet, targets: &[f32]) {
    let needed = set.point_count() * set.channels * set.order.coeff_count();
    assert!(targets.len() == needed, "targets has {} elements, it needs {needed}", targets.len());
}

pub(crate) fn finite(values: &[f32]) -> bool {
    values.iter().all(|x| x.is_finite())
}
