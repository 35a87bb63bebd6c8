use crate::frame::{any_tangent, cross, dot, orthogonal, orthonormal_or_replaced, rotate, unit};
use crate::surface::{all_finite, check_length};
use crate::{Error, cpu};

/// Below this share of the linear part's size, squared, the normal or the tangent of a collapsed vertex is rounding, and is replaced.
const COLLAPSE: f32 = 1e-6;

/// A rest pose and what moves it: linear blend skinning. Borrowed from the caller and checked once.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Skin<'a> {
    /// `[V]`, rest pose.
    pub positions: &'a [[f32; 3]],
    /// `[V]`, tangent, bitangent and normal in the rest pose. For vertex lobes any tangent does: the rotation does not depend on it.
    pub frames: &'a [[[f32; 3]; 3]],
    /// `[V]`, numbers of joints.
    pub joints: &'a [[u32; 4]],
    /// `[V]`, their weights; the sum is 1.
    pub weights: &'a [[f32; 4]],
}

impl<'a> Skin<'a> {
    /// Checks shapes and that weights are finite. Frames that are not orthonormal are replaced as in [`crate::cpu::shade_lobes`].
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::NotFinite`].
    pub fn new(
        positions: &'a [[f32; 3]],
        frames: &'a [[[f32; 3]; 3]],
        joints: &'a [[u32; 4]],
        weights: &'a [[f32; 4]],
    ) -> Result<Self, Error> {
        let vertices = positions.len();
        let because = || format!("a skin of {vertices} vertices");
        cpu::check_frames(frames, vertices)?;
        check_length("joints", joints.len(), "entries", vertices, because)?;
        check_length("weights", weights.len(), "entries", vertices, because)?;
        match weights.iter().position(|w| !all_finite(w)) {
            Some(item) => Err(Error::NotFinite { what: "joint weights of vertex", item }),
            None => Ok(Self { positions, frames, joints, weights }),
        }
    }

    /// The least number of matrices that all vertices find theirs in. Joints of weight 0 count.
    pub fn joint_count(&self) -> usize {
        self.joints.as_flattened().iter().max().map_or(0, |j| *j as usize + 1)
    }
}

/// What a pose's frames are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseFrames {
    /// The rotation from the rest to the posed frame: for lobes of vertices.
    FromRest,
    /// `[tangent, bitangent, normal]` of the pose: for lobes in tangent space.
    Tangent,
}

/// Checks that there is a finite matrix for every joint.
pub(crate) fn check_joints(matrices: &[[[f32; 4]; 4]], joint_count: usize) -> Result<(), Error> {
    if matrices.len() < joint_count {
        let because = format!("a skin whose largest joint is {}", joint_count - 1);
        return Err(Error::Length {
            what: "joint matrices",
            given: matrices.len(),
            unit: "entries",
            because,
            needed: joint_count,
        });
    }
    match matrices.iter().position(|m| !all_finite(m.as_flattened())) {
        Some(item) => Err(Error::NotFinite { what: "matrix of joint", item }),
        None => Ok(()),
    }
}

/// `Σ_j w_j M_j`: the first three columns are the linear part, the last is the translation.
pub(crate) fn blended(matrices: &[[[f32; 4]; 4]], joints: [u32; 4], weights: [f32; 4]) -> [[f32; 3]; 4] {
    let mut sum = [[0.0; 3]; 4];
    for (joint, weight) in joints.into_iter().zip(weights) {
        let matrix = &matrices[joint as usize];
        sum = std::array::from_fn(|k| std::array::from_fn(|i| sum[k][i] + weight * matrix[k][i]));
    }
    sum
}

/// The frame that a linear map `F` takes a rest frame `[t, b, n]` to.
///
/// `n' = cof(F) n`, normalised: the normal of the mapped surface. In its plane `t', b'` are the orthonormal pair nearest to `F t, F b`:
/// the polar rotation, which does not depend on the choice of `t`. With `b' = ± n' × t'` (− for a mirrored rest frame) the sum
/// `t'·Ft + b'·Fb` is largest for `t'` along `Ft ∓ n' × Fb`.
///
/// A collapsed map leaves the rest frame's normal, or its tangent, as far as they fit. Never NaN for a finite map.
pub(crate) fn posed_frame(linear: [[f32; 3]; 3], rest: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    let [t, b, n] = *rest;
    let largest = linear.as_flattened().iter().fold(f32::MIN_POSITIVE, |largest, x| largest.max(x.abs()));
    let f = linear.map(|column| column.map(|x| x / largest));
    let cofactor = [cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])];
    let normal = unit_or(rotate(&cofactor, n), n);
    let side = if dot(cross(n, t), b) < 0.0 { -1.0 } else { 1.0 };
    let [ft, fb] = [t, b].map(|v| rotate(&f, v));
    let (along, turned) = (dot(normal, ft), cross(normal, fb));
    let sum = std::array::from_fn(|i| (ft[i] - along * normal[i]) - side * turned[i]);
    let tangent = match dot(sum, sum) > COLLAPSE * COLLAPSE {
        true => unit(sum),
        false => None,
    };
    let tangent = tangent.or_else(|| orthogonal(t, normal)).unwrap_or_else(|| any_tangent(normal));
    [tangent, cross(normal, tangent).map(|x| side * x), normal]
}

fn unit_or(v: [f32; 3], other: [f32; 3]) -> [f32; 3] {
    match dot(v, v) > COLLAPSE * COLLAPSE {
        true => unit(v).unwrap_or(other),
        false => other,
    }
}

/// The rotation from a rest frame to a posed one.
pub(crate) fn from_rest(posed: &[[f32; 3]; 3], rest: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    std::array::from_fn(|k| rotate(posed, rest.map(|column| column[k])))
}

/// One vertex of a pose.
pub(crate) fn posed(
    matrix: [[f32; 3]; 4],
    position: [f32; 3],
    rest: &[[f32; 3]; 3],
    kind: PoseFrames,
) -> ([f32; 3], [[f32; 3]; 3]) {
    let rest = orthonormal_or_replaced(rest);
    let frame = posed_frame([matrix[0], matrix[1], matrix[2]], &rest);
    let frame = match kind {
        PoseFrames::FromRest => from_rest(&frame, &rest),
        PoseFrames::Tangent => frame,
    };
    (moved(&matrix, position), frame)
}

/// A position under an affine map.
pub(crate) fn moved(&[x, y, z, translation]: &[[f32; 3]; 4], position: [f32; 3]) -> [f32; 3] {
    let moved = rotate(&[x, y, z], position);
    std::array::from_fn(|i| moved[i] + translation[i])
}
