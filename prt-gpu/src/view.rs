use crate::Error;

/// Where the image is taken from, and how large it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Column-major: `clip = Σ_k clip_from_world[k] · p[k]` for `p = [x, y, z, 1]`. Clip y is up, clip z runs from 0 (near
    /// plane) to w (far plane), as in wgpu, Vulkan and Direct3D.
    pub clip_from_world: [[f32; 4]; 4],
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Samples per pixel along each axis, `1..=4`: their mean is the pixel (box filter).
    pub samples: u32,
}

impl View {
    /// Largest number of samples along one axis of an image, `width · samples`.
    ///
    /// With 256 positions per sample the edge functions of a triangle stay exact in the shaders' integers, and the rounding of
    /// a position by the GPU's viewport stays under half of such a position.
    pub const MAX_SIDE: u32 = 16_384;

    /// A checked view.
    ///
    /// # Errors
    /// As [`View::check`].
    pub fn new(clip_from_world: [[f32; 4]; 4], width: u32, height: u32, samples: u32) -> Result<Self, Error> {
        let view = Self { clip_from_world, width, height, samples };
        view.check()?;
        Ok(view)
    }

    /// Checks the numbers of the view; [`crate::cpu::rasterize`] panics on a view that this refuses.
    ///
    /// # Errors
    /// [`Error::View`] for an image without pixels, with more than [`View::MAX_SIDE`] samples along an axis, or with
    /// `samples` outside `1..=4`; [`Error::NotFinite`] for the matrix.
    pub fn check(&self) -> Result<(), Error> {
        let Self { width, height, samples, .. } = *self;
        if !(1..=4).contains(&samples) {
            return Err(Error::View(format!("{samples} samples per axis were asked for; 1 to 4 are accepted")));
        }
        let largest = Self::MAX_SIDE / samples;
        if !(1..=largest).contains(&width) || !(1..=largest).contains(&height) {
            return Err(Error::View(format!(
                "an image of {width} x {height} with {samples} samples per axis was asked for; 1 to {largest} pixels per side are accepted"
            )));
        }
        match self.clip_from_world.as_flattened().iter().position(|x| !x.is_finite()) {
            Some(item) => Err(Error::NotFinite { what: "camera matrix entry", item }),
            None => Ok(()),
        }
    }

    /// Width and height of the image in samples.
    pub(crate) fn sample_size(&self) -> [u32; 2] {
        [self.width * self.samples, self.height * self.samples]
    }
}

/// An image read back from a renderer: rows from the top, pixels from the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// `[width · height]`: linear radiance, premultiplied by the coverage in the fourth component, 0 to 1. So a background
    /// is added as `pixel.rgb + (1 − a) · background`, and leaving it black needs nothing.
    pub pixels: Vec<[f32; 4]>,
    /// `[width · height]`: clip depth `z/w` of the nearest sample, 1 where there is nothing.
    pub depth: Vec<f32>,
}

impl Frame {
    /// The frame over a background: `background(x, y)` is the radiance behind the pixel in column `x` and row `y`.
    pub fn composite(&self, mut background: impl FnMut(usize, usize) -> [f32; 3]) -> Vec<[f32; 3]> {
        let mut over = |(i, &[r, g, b, a]): (usize, &[f32; 4])| {
            if a >= 1.0 {
                return [r, g, b];
            }
            let behind = background(i % self.width, i / self.width);
            [r + (1.0 - a) * behind[0], g + (1.0 - a) * behind[1], b + (1.0 - a) * behind[2]]
        };
        self.pixels.iter().enumerate().map(&mut over).collect()
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn text(width: u32, height: u32, samples: u32) -> String {
        View::new([[0.0; 4]; 4], width, height, samples).unwrap_err().to_string()
    }

    #[test]
    fn sizes_are_checked() {
        assert!(View::new([[0.0; 4]; 4], 1, 16_384, 1).is_ok());
        assert!(text(0, 5, 1).starts_with("an image of 0 x 5 with 1 samples per axis"));
        assert!(text(5, 8193, 2).ends_with("1 to 8192 pixels per side are accepted"));
        assert!(text(u32::MAX, 1, 4).contains("4294967295"));
        assert_eq!(text(1, 1, 0), "0 samples per axis were asked for; 1 to 4 are accepted");
        assert_eq!(text(1, 1, 5), "5 samples per axis were asked for; 1 to 4 are accepted");
    }

    #[test]
    fn matrices_must_be_finite() {
        let mut matrix = [[0.0; 4]; 4];
        matrix[1][2] = f32::NAN;
        assert_eq!(View::new(matrix, 1, 1, 1).unwrap_err().to_string(), "camera matrix entry 6 is not finite");
    }

    #[test]
    fn a_background_shows_through_what_is_not_covered() {
        let pixels = vec![[0.5, 0.0, 0.0, 0.5], [1.0, 1.0, 1.0, 1.0]];
        let frame = Frame { width: 2, height: 1, pixels, depth: vec![0.5, 0.5] };
        assert_eq!(frame.composite(|x, _| [x as f32, 2.0, 4.0]), [[0.5, 1.0, 2.0], [1.0, 1.0, 1.0]]);
    }
}
