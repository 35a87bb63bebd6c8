//! Rotations of [`glam`](https://docs.rs/glam) for [`ShRotation`](crate::ShRotation).
//!
//! Directions need nothing: `glam::Vec3` turns into `[f32; 3]` by itself, with `to_array` or `into`.

use ::glam::{DMat3, DQuat, Mat3, Mat3A, Quat};

use crate::RotationRows;

macro_rules! impl_rows {
    ($scalar:ident: $($matrix:ident),+ by $quaternion:ident) => {
        $(impl RotationRows<$scalar> for $matrix {
            fn to_rows(&self) -> [[$scalar; 3]; 3] {
                self.transpose().to_cols_array_2d()
            }
        })+
        impl RotationRows<$scalar> for $quaternion {
            fn to_rows(&self) -> [[$scalar; 3]; 3] {
                impl_rows!(@matrix $scalar)(*self).to_rows()
            }
        }
    };
    (@matrix f32) => { Mat3::from_quat };
    (@matrix f64) => { DMat3::from_quat };
}

impl_rows!(f32: Mat3, Mat3A by Quat);
impl_rows!(f64: DMat3 by DQuat);
