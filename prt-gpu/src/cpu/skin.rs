use crate::layout::Influence;
use crate::skin::{blended, check_joints, moved, posed};
use crate::{PoseFrames, Skin};
use rayon::prelude::*;

/// Positions and frames of a pose, by linear blend skinning.
///
/// With `F = Σ_j w_j M_j` the position is mapped by `F`, the normal is that of the mapped surface (`cof(F) n`), and tangent and bitangent
/// are the orthonormal pair in its plane that is nearest to `F t, F b`. A collapsed or mirroring `F` gives finite orthonormal
/// frames: where no normal or tangent is left, that of the rest pose.
///
/// - `matrices`: `[J]` column-major, from the rest pose to the pose; the fourth row is not read
/// - `positions`, `frames`: `[V]`, overwritten
///
/// The result does not depend on the number of threads.
///
/// # Panics
/// If a slice length does not match, a joint has no matrix, or a matrix is not finite.
///
/// The twin of `shaders/skin.wgsl`.
pub fn skin(
    skin: &Skin<'_>,
    matrices: &[[[f32; 4]; 4]],
    kind: PoseFrames,
    positions: &mut [[f32; 3]],
    frames: &mut [[[f32; 3]; 3]],
) {
    let vertices = skin.positions.len();
    assert_eq!((positions.len(), frames.len()), (vertices, vertices), "lengths of the outputs");
    if let Err(error) = check_joints(matrices, skin.joint_count()) {
        panic!("{error}");
    }
    let outputs = positions.par_iter_mut().zip(frames).with_min_len(1024).enumerate();
    outputs.for_each(|(v, (position, frame))| {
        let matrix = blended(matrices, skin.joints[v], skin.weights[v]);
        (*position, *frame) = posed(matrix, skin.positions[v], &skin.frames[v], kind);
    });
}

/// Positions alone, in the arrays of the GPU's pass.
pub(crate) fn skinned_positions(
    rest: &[[f32; 3]],
    influences: &[Influence],
    matrices: &[[[f32; 4]; 4]],
) -> Vec<[f32; 3]> {
    let moved = |(rest, by): (&[f32; 3], &Influence)| moved(&blended(matrices, by.joints, by.weights), *rest);
    rest.par_iter().zip(influences).with_min_len(1024).map(moved).collect()
}
