use crate::Error;
use sh_core::Order;

/// A baked surface, borrowed from the caller and checked once.
///
/// Transfer follows the convention of the baked file: it includes `1/π` and the cosine but not the vertex's own albedo, so
/// that exit radiance is `albedo · (transfer · light)`.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Surface<'a> {
    /// `[V]`, scene units.
    pub positions: &'a [[f32; 3]],
    /// `[T]`, counterclockwise seen from the lit side. The other side is black.
    pub triangles: &'a [[u32; 3]],
    /// `[V]`, linear.
    pub albedo: &'a [[f32; 3]],
    /// Order `n` of the stored transfer.
    pub order: Order,
    /// Channels `C` of the transfer: 1 or 3.
    pub channels: usize,
    /// `[V, C, n²]`.
    pub transfer: &'a [f32],
}

impl<'a> Surface<'a> {
    /// Checks shapes, indices and that transfer and albedo are finite.
    ///
    /// Positions may be NaN or infinite: triangles that use them are not drawn.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Channels`], [`Error::VertexIndex`], [`Error::NotFinite`].
    pub fn new(
        positions: &'a [[f32; 3]],
        triangles: &'a [[u32; 3]],
        albedo: &'a [[f32; 3]],
        order: Order,
        channels: usize,
        transfer: &'a [f32],
    ) -> Result<Self, Error> {
        if channels != 1 && channels != 3 {
            return Err(Error::Channels { given: channels });
        }
        let surface = Self { positions, triangles, albedo, order, channels, transfer };
        surface.check_lengths()?;
        check_triangles(triangles, positions.len())?;
        surface.check_finite()?;
        Ok(surface)
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let because = || format!("a surface of {} vertices", self.vertex_count());
        check_length("albedo", self.albedo.len(), "entries", self.vertex_count(), because)?;
        let needed = self.vertex_count().saturating_mul(self.floats_per_vertex());
        check_length("transfer", self.transfer.len(), "floats", needed, || {
            format!(
                "a surface of {} vertices, {} channels and order {}",
                self.vertex_count(),
                self.channels,
                self.order
            )
        })
    }

    fn check_finite(&self) -> Result<(), Error> {
        if let Some(item) = self.albedo.iter().position(|a| !all_finite(a)) {
            return Err(Error::NotFinite { what: "albedo of vertex", item });
        }
        match self.transfer.chunks_exact(self.floats_per_vertex()).position(|t| !all_finite(t)) {
            Some(item) => Err(Error::NotFinite { what: "transfer of vertex", item }),
            None => Ok(()),
        }
    }

    /// Floats of transfer that one vertex stores, `C n²`.
    pub(crate) fn floats_per_vertex(&self) -> usize {
        self.channels * self.order.coeff_count()
    }
}

/// Checks that every corner names one of `vertex_count` vertices.
pub(crate) fn check_triangles(triangles: &[[u32; 3]], vertex_count: usize) -> Result<(), Error> {
    let outside = |v: &u32| *v as usize >= vertex_count;
    match triangles.iter().position(|corners| corners.iter().any(outside)) {
        None => Ok(()),
        Some(triangle) => {
            let vertex = triangles[triangle].into_iter().find(outside).unwrap_or_default();
            Err(Error::VertexIndex { triangle, vertex, vertex_count })
        }
    }
}

/// Checks that `light` is `[3, k²]` for the `order` of `k` bands, is finite, and that the transfer stores as many bands.
pub(crate) fn check_light(light: &[f32], order: Order, stored: Order) -> Result<(), Error> {
    if order > stored {
        return Err(Error::OrderAboveStored { given: order.get(), stored: stored.get() });
    }
    let because = || format!("order {order} in three channels");
    check_length("light", light.len(), "floats", 3 * order.coeff_count(), because)?;
    match light.iter().position(|x| !x.is_finite()) {
        Some(item) => Err(Error::NotFinite { what: "light coefficient", item }),
        None => Ok(()),
    }
}

/// Compares a length with what is needed.
pub(crate) fn check_length(
    what: &'static str,
    given: usize,
    unit: &'static str,
    needed: usize,
    because: impl FnOnce() -> String,
) -> Result<(), Error> {
    match given == needed {
        true => Ok(()),
        false => Err(Error::Length { what, given, unit, because: because(), needed }),
    }
}

pub(crate) fn all_finite(values: &[f32]) -> bool {
    // No early exit, so that the loop is vectorised.
    values.iter().fold(true, |finite, x| finite & x.is_finite())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    const POSITIONS: [[f32; 3]; 3] = [[0.0; 3]; 3];
    const ALBEDO: [[f32; 3]; 3] = [[0.5; 3]; 3];

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    fn message(result: Result<Surface<'_>, Error>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn wrong_lengths_are_named() {
        let short = Surface::new(&POSITIONS, &[], &ALBEDO[..2], order(2), 1, &[0.0; 12]);
        assert_eq!(message(short), "albedo has 2 entries; a surface of 3 vertices needs 3");
        let short = Surface::new(&POSITIONS, &[], &ALBEDO, order(2), 3, &[0.0; 35]);
        assert_eq!(message(short), "transfer has 35 floats; a surface of 3 vertices, 3 channels and order 2 needs 36");
    }

    #[test]
    fn wrong_channels_and_indices_are_named() {
        let two = Surface::new(&POSITIONS, &[], &ALBEDO, order(1), 2, &[0.0; 6]);
        assert_eq!(message(two), "transfer has 2 channels; 1 (grey) and 3 (red, green, blue) are accepted");
        let triangles = [[0, 1, 2], [2, 3, 7]];
        let outside = Surface::new(&POSITIONS, &triangles, &ALBEDO, order(1), 1, &[0.0; 3]);
        assert_eq!(message(outside), "triangle 1 uses vertex 3; the surface has 3 vertices");
    }

    #[test]
    fn numbers_that_are_not_finite_are_named() {
        let mut transfer = [0.0; 12];
        transfer[5] = f32::NAN;
        let nan = Surface::new(&POSITIONS, &[], &ALBEDO, order(2), 1, &transfer);
        assert_eq!(message(nan), "transfer of vertex 1 is not finite");
        let albedo = [[0.5; 3], [0.5; 3], [0.5, f32::INFINITY, 0.5]];
        let infinite = Surface::new(&POSITIONS, &[], &albedo, order(1), 1, &[0.0; 3]);
        assert_eq!(message(infinite), "albedo of vertex 2 is not finite");
    }

    #[test]
    fn lights_are_checked() {
        let text = |light: &[f32], n, stored| check_light(light, order(n), order(stored)).unwrap_err().to_string();
        assert_eq!(text(&[0.0; 3], 3, 2), "order 3 was asked for; the transfer is stored to order 2");
        assert_eq!(text(&[0.0; 4], 2, 2), "light has 4 floats; order 2 in three channels needs 12");
        assert_eq!(text(&[f32::NAN; 3], 1, 2), "light coefficient 0 is not finite");
        assert_eq!(check_light(&[1e30; 12], order(2), order(2)), Ok(()));
    }
}
