//! Rotations of [`nalgebra`](https://docs.rs/nalgebra) for [`ShRotation`](crate::ShRotation), and scaling matrices for it.
//!
//! Directions need nothing: `nalgebra::Vector3<T>` turns into `[T; 3]` by `into`.

use alloc::vec;

use ::nalgebra::{DMatrix, Matrix3, RealField, Rotation3, UnitQuaternion};

use crate::{Real, RotationRows, ScalingMatrix};

impl<T: Real + RealField> RotationRows<T> for Matrix3<T> {
    fn to_rows(&self) -> [[T; 3]; 3] {
        core::array::from_fn(|i| core::array::from_fn(|j| self[(i, j)]))
    }
}

impl<T: Real + RealField> RotationRows<T> for Rotation3<T> {
    fn to_rows(&self) -> [[T; 3]; 3] {
        RotationRows::to_rows(self.matrix())
    }
}

impl<T: Real + RealField> RotationRows<T> for UnitQuaternion<T> {
    fn to_rows(&self) -> [[T; 3]; 3] {
        self.to_rotation_matrix().to_rows()
    }
}

/// The whole `n² × n′²` matrix.
impl<T: Real> From<&ScalingMatrix<T>> for DMatrix<T> {
    fn from(matrix: &ScalingMatrix<T>) -> Self {
        let (rows, columns) = (matrix.order().coeff_count(), matrix.source_order().coeff_count());
        let mut dense = vec![T::ZERO; rows * columns];
        matrix.to_dense(&mut dense);
        Self::from_row_slice(rows, columns, &dense)
    }
}
