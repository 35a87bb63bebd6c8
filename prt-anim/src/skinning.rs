//! Linear blend skinning on the CPU.

use glam::{DMat3, DVec3};

use crate::deformed::finite;
use crate::parallel::fill;
use crate::{Affine, Deformed, Pose, Skeleton, Skin};

impl Skin {
    /// Positions, normals and frames of all vertices in a pose.
    ///
    /// Works in `f64` and rounds once. A position that `f32` cannot hold is limited to its range.
    ///
    /// # Panics
    /// If pose and skeleton do not belong to the skin.
    pub fn deform(&self, skeleton: &Skeleton, pose: &Pose, out: &mut Deformed) {
        let maps = self.bone_maps(skeleton, pose);
        out.fill(self.vertex_count(), |vertex| {
            let (linear, translation) = self.blend(vertex, &maps);
            let position = linear * self.bound_position(vertex) + translation;
            (position, self.gradient(vertex, linear), self.rest_normal(vertex))
        });
    }

    /// Positions alone: `Σ_k w_k map_k p`.
    ///
    /// - `maps`: from [`bone_maps`](Self::bone_maps)
    /// - `out`: `[V]`, overwritten
    ///
    /// # Panics
    /// If there are not as many maps as bones, or `out` has another length.
    pub fn positions(&self, maps: &[Affine], out: &mut [[f32; 3]]) {
        self.check(maps, out.len());
        fill(out, |vertex| {
            let (linear, translation) = self.blend(vertex, maps);
            finite(linear * self.bound_position(vertex) + translation)
        });
    }

    pub(crate) fn check(&self, maps: &[Affine], count: usize) {
        assert_eq!(maps.len(), self.source.bones.len(), "one map for each bone is needed");
        assert_eq!(count, self.vertex_count(), "the result needs one element for each vertex");
    }

    /// The gradient from the rest pose, up to a factor that is not negative.
    #[inline]
    pub(crate) fn gradient(&self, vertex: usize, linear: DMat3) -> DMat3 {
        linear * DMat3::from_cols_array_2d(&self.bind_from_rest[vertex].map(|column| column.map(f64::from)))
    }

    #[inline]
    pub(crate) fn rest_normal(&self, vertex: usize) -> DVec3 {
        DVec3::from(self.rest_normals()[vertex].map(f64::from))
    }
}
