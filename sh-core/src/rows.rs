//! What can be turned into the matrix of a rotation.

/// A rotation of three dimensions, for [`ShRotation::new`](crate::ShRotation::new).
///
/// Implemented for the rows themselves, and with the features `glam` and `nalgebra` for their matrices and unit quaternions.
///
/// ```
/// use sh_core::{Order, RotationRows, ShRotation};
///
/// let half_turn_about_z = [[-1.0_f32, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
/// let rotation = ShRotation::new(Order::new(3)?, half_turn_about_z.to_rows());
/// # Ok::<(), sh_core::Error>(())
/// ```
pub trait RotationRows<T> {
    /// The rows of the matrix `R` that turns a direction `d` into `R d`.
    fn to_rows(&self) -> [[T; 3]; 3];
}

impl<T: Copy> RotationRows<T> for [[T; 3]; 3] {
    fn to_rows(&self) -> [[T; 3]; 3] {
        *self
    }
}
