//! Where each joint stands relative to its parent.

use glam::{DMat3, DQuat, DVec3, DVec4};

use crate::Affine;

/// Translation × rotation × scale: the point is scaled first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Translation, scene units.
    pub translation: [f64; 3],
    /// Rotation as a quaternion `x y z w`, of any length but zero.
    pub rotation: [f64; 4],
    /// Scale along each axis.
    pub scale: [f64; 3],
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self = Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };

    /// The map from the joint's space to its parent's.
    #[must_use]
    pub fn to_affine(&self) -> Affine {
        let rotation = DMat3::from_quat(unit_quaternion(self.rotation));
        let [x, y, z] = self.scale;
        let linear = DMat3::from_cols(rotation.x_axis * x, rotation.y_axis * y, rotation.z_axis * z);
        Affine::from_parts(linear, DVec3::from(self.translation))
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// A quaternion made unit; one without direction is the identity.
pub(crate) fn unit_quaternion(rotation: [f64; 4]) -> DQuat {
    let rotation = DVec4::from(rotation);
    let largest = rotation.abs().max_element();
    if largest > 0.0 && rotation.is_finite() {
        DQuat::from_vec4((rotation / largest).normalize())
    } else {
        DQuat::IDENTITY
    }
}

/// The local transform of every joint of a [`Skeleton`](crate::Skeleton).
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// For each joint the transform from its space to its parent's.
    pub locals: Vec<Transform>,
}
