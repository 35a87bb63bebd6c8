//! The error where lobes are interpolated.

use crate::blend::{Blend, interpolate};
use crate::misfit::{assert_targets, finite, relative_error};
use crate::{Error, LobeSet};

/// The error of lobes at the vertices and in the middle of the faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetweenError {
    /// The relative L2 error at the vertices.
    pub at_vertices: f64,
    /// The relative L2 error of interpolated lobes at the centres of the faces, against the mean of the transfer of the three
    /// corners.
    pub at_faces: f64,
    /// The largest error at a face, relative to the root mean square length of the means.
    pub worst_face: f64,
}

/// Measures what interpolation of lobes costs.
///
/// - `targets`: `[V, C, n²]`; faces with a corner that is not finite are left out
///
/// # Errors
/// [`Error::Triangle`] if a triangle names a vertex that does not exist.
///
/// # Panics
/// If `targets` is not `[V, C, n²]`.
pub fn interpolation_error(set: &LobeSet, targets: &[f32], triangles: &[[u32; 3]]) -> Result<BetweenError, Error> {
    assert_targets(set, targets);
    let point_count = set.point_count();
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|&&point| point as usize >= point_count) {
            return Err(Error::Triangle { triangle, point, point_count });
        }
    }
    let size = set.channels * set.order.coeff_count();
    let of = |v: u32| &targets[v as usize * size..][..size];
    let mean = |corners: &[u32; 3]| (0..size).map(|i| corners.iter().map(|&v| of(v)[i]).sum::<f32>() / 3.0).collect();
    let means: Vec<Vec<f32>> = triangles.iter().map(mean).collect();
    let blends: Vec<Blend> = triangles.iter().map(|&corners| Blend::barycentric(corners, [1.0 / 3.0; 3])).collect();
    let between = interpolate(set, &blends);
    Ok(BetweenError {
        at_vertices: relative_error(set, targets),
        at_faces: relative_error(&between, &means.concat()),
        worst_face: worst(&between, &means),
    })
}

fn worst(set: &LobeSet, targets: &[Vec<f32>]) -> f64 {
    let count = set.order.coeff_count();
    let mut found = vec![0.0; count];
    let (mut largest, mut length, mut faces) = (0.0_f64, 0.0, 0.0);
    for (face, target) in targets.iter().enumerate().filter(|(_, target)| finite(target)) {
        let mut error = 0.0;
        for (channel, target) in target.chunks_exact(count).enumerate() {
            set.reconstruct(face, channel, &mut found);
            error += found.iter().zip(target).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        }
        largest = largest.max(error);
        length += target.iter().map(|t| f64::from(*t).powi(2)).sum::<f64>();
        faces += 1.0;
    }
    if length > 0.0 { (largest / (length / faces)).sqrt() } else { 0.0 }
}
