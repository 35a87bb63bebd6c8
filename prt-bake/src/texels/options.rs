//! How large an atlas is, and how it is finished.

use sh_core::Order;

use crate::Error;

/// Settings of the atlas of a bake of texels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TexelOptions {
    /// Columns; 1 to [`TexelOptions::MAX_SIZE`].
    pub width: usize,
    /// Rows; 1 to [`TexelOptions::MAX_SIZE`].
    pub height: usize,
    /// Empty texels up to this far from a baked one take the value of the nearest, so that smaller levels of the texture do not mix in
    /// black; in texels, at most [`TexelOptions::MAX_GUTTER`]. Lookups on the full texture need none: the texels that they can read
    /// are baked.
    pub gutter: usize,
    /// Whether the texture coordinate v grows upwards, as in OBJ and PLY files, so that row 0, which is the top of the image, is v = 1.
    /// In glTF v runs down and row 0 is v = 0.
    pub v_up: bool,
}

impl Default for TexelOptions {
    /// 512 × 512 texels, a gutter of 4, v down.
    fn default() -> Self {
        Self { width: 512, height: 512, gutter: 4, v_up: false }
    }
}

impl TexelOptions {
    /// Most columns or rows.
    pub const MAX_SIZE: usize = 1 << 14;
    /// Widest gutter: enough for the six levels of a texture below the full one.
    pub const MAX_GUTTER: usize = 64;
    /// Most numbers of a result: 4 GiB.
    pub const MAX_VALUES: usize = 1 << 30;

    /// As many rows as columns.
    #[must_use]
    pub fn square(size: usize) -> Self {
        Self { width: size, height: size, ..Self::default() }
    }

    /// - `channels`: of the result
    pub(crate) fn validate(&self, order: Order, channels: usize) -> Result<(), Error> {
        let fail = |message: String| Err(Error::Option(message));
        let (width, height) = (self.width, self.height);
        if ![width, height].iter().all(|size| (1..=Self::MAX_SIZE).contains(size)) {
            return fail(format!(
                "an atlas of {width} × {height} texels; sides of 1 to {} are possible",
                Self::MAX_SIZE
            ));
        }
        if self.gutter > Self::MAX_GUTTER {
            return fail(format!("a gutter of {} texels; at most {} are possible", self.gutter, Self::MAX_GUTTER));
        }
        let values = width * height * channels * order.coeff_count();
        if values > Self::MAX_VALUES {
            let gib = |values: usize| values as f64 * 4.0 / f64::from(1 << 30);
            return fail(format!(
                "an atlas of {width} × {height} texels at order {order} with {channels} channels takes {:.1} GiB; at most {:.1} are possible",
                gib(values),
                gib(Self::MAX_VALUES)
            ));
        }
        Ok(())
    }
}
