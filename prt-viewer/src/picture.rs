//! From a frame to a picture file.

use std::path::Path;

use glam::{Quat, Vec2, Vec3};
use prt_bake::Image;
use prt_gpu::Frame;

use crate::camera::Camera;
use crate::lighting::Lighting;

/// Mean of the luminance of the object that automatic exposure aims at: a little above the middle grey of 0.18, because what is baked is
/// mostly bright and fills most of the picture.
const AIM: f32 = 0.3;

/// The environment behind an object.
#[derive(Debug)]
pub(crate) struct Backdrop<'a> {
    pub(crate) lighting: &'a Lighting,
    pub(crate) scene_from_environment: Quat,
    pub(crate) camera: &'a Camera,
}

impl Backdrop<'_> {
    /// Radiance behind the pixel in column `x` and row `y`.
    fn radiance(&self, frame: &Frame, x: usize, y: usize) -> [f32; 3] {
        let [width, height] = [frame.width, frame.height].map(|side| side as f32);
        let at = Vec2::new((2.0 * x as f32 + 1.0) / width - 1.0, 1.0 - (2.0 * y as f32 + 1.0) / height);
        let direction = self.scene_from_environment.inverse() * self.camera.direction(width / height, at);
        self.lighting.environment.radiance(direction.to_array())
    }
}

/// Linear radiance of the frame, over black or over the environment.
pub(crate) fn develop(frame: &Frame, backdrop: Option<&Backdrop<'_>>) -> Image {
    let pixels = match backdrop {
        Some(backdrop) => frame.composite(|x, y| backdrop.radiance(frame, x, y)),
        None => frame.composite(|_, _| [0.0; 3]),
    };
    Image { width: frame.width, height: frame.height, pixels }
}

/// Writes linear radiance as `.exr`, and a tone-mapped picture as `.png`.
pub(crate) fn save(image: &Image, path: &Path, exposure_stops: f32) -> Result<(), prt_bake::Error> {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    if is_exr {
        return image.save(path);
    }
    let displayed =
        |&pixel: &[f32; 3]| prt_gpu::tone_map(pixel, exposure_stops).map(|value| (255.0 * value).round() as u8);
    let pixels: Vec<[u8; 3]> = image.pixels.iter().map(displayed).collect();
    prt_bake::save_png(path, image.width, image.height, &pixels)
}

/// The exposure at which the object is neither dark nor bleached, in stops; 0 if nothing is to be seen.
pub(crate) fn automatic_exposure(frame: &Frame) -> f32 {
    let luminance =
        |[r, g, b, _]: &[f32; 4]| f64::from(Vec3::new(*r, *g, *b).dot(Vec3::new(0.2126, 0.7152, 0.0722)).max(0.0));
    let light: f64 = frame.pixels.iter().map(luminance).sum();
    let coverage: f64 = frame.pixels.iter().map(|[.., coverage]| f64::from(*coverage)).sum();
    let mean = (light / coverage) as f32;
    if mean.is_finite() && mean > 0.0 { (AIM / mean).log2().clamp(-40.0, 40.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(pixels: Vec<[f32; 4]>) -> Frame {
        Frame { width: pixels.len(), height: 1, depth: vec![1.0; pixels.len()], pixels }
    }

    #[test]
    fn automatic_exposure_brings_the_object_to_its_aim_whatever_surrounds_it() {
        let stops = automatic_exposure(&frame(vec![[3.0, 3.0, 3.0, 1.0], [0.0; 4], [0.0; 4]]));
        assert!((3.0 * stops.exp2() - AIM).abs() < 1e-6);
        assert_eq!(automatic_exposure(&frame(vec![[0.0; 4]])), 0.0);
        assert_eq!(automatic_exposure(&frame(vec![[-1.0, -1.0, -1.0, 1.0]])), 0.0);
    }

    #[test]
    fn black_is_behind_the_object_unless_asked_otherwise() {
        let image = develop(&frame(vec![[0.25, 0.5, 0.75, 0.5]]), None);
        assert_eq!(image.pixels, [[0.25, 0.5, 0.75]]);
    }
}
