//! Values on the command line: what is accepted, and how it is worded when it is not.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use glam::{Quat, Vec3};
use prt_bake::{BakeOptions, Medium, TexelOptions};
use prt_gpu::{Evaluation, Frame};
use sh_core::Order;

use crate::camera::{Camera, DEFAULT_FOV, Orbit, Side};
use crate::{lighting, picture};

/// Largest side of a picture, pixels.
const MAX_SIDE: u32 = 16_384;

/// Width and height of a picture, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Size {
    pub(crate) fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// How bright a picture is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Exposure {
    Stops(f32),
    Auto,
}

impl Exposure {
    /// Stops for a frame.
    pub(crate) fn stops(self, frame: &Frame) -> f32 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto => picture::automatic_exposure(frame),
        }
    }
}

/// Where to look from.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct CameraArguments {
    /// The side to look from
    #[arg(long, value_name = "SIDE", value_enum, default_value = "three-quarter", conflicts_with = "eye")]
    camera: Side,
    /// The position of the camera
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// The point in the middle of the picture; by default that of the object
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<Vec3>,
    /// The direction that is up in the picture
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = direction, allow_hyphen_values = true)]
    up: Vec3,
    /// The vertical field of view [default: 35]
    #[arg(long, value_name = "DEGREES", value_parser = field_of_view, allow_hyphen_values = true)]
    fov: Option<f32>,
}

impl CameraArguments {
    /// The camera for an object.
    ///
    /// # Errors
    /// If it would look nowhere.
    pub(crate) fn camera(&self, points: &[[f32; 3]], aspect: f32) -> anyhow::Result<Camera> {
        let fov = self.fov.map_or(DEFAULT_FOV, f32::to_radians);
        let mut orbit = Orbit::framing(points, self.camera, self.up, fov, aspect);
        orbit.target = self.target.unwrap_or(orbit.target);
        let camera = match self.eye {
            Some(eye) => Camera { eye, target: orbit.target, up: self.up, fov },
            None => orbit.camera(),
        };
        camera.check()?;
        Ok(camera)
    }
}

/// How the environment is turned.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct LightArguments {
    /// Turn the environment about its up direction, counter-clockwise seen from above
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = degrees, allow_hyphen_values = true)]
    rotate_light: f32,
    /// The direction of the scene that is up in the environment: 0,0,1 for meshes with z up
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = direction, allow_hyphen_values = true)]
    env_up: Vec3,
}

impl LightArguments {
    pub(crate) fn scene_from_environment(&self) -> Quat {
        lighting::upright(self.env_up) * Quat::from_rotation_y(self.rotate_light.to_radians())
    }
}

/// `WIDTHxHEIGHT`
pub(crate) fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_SIDE).contains(side));
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
    let (width, height) = sides.ok_or_else(|| format!("a size is WIDTHxHEIGHT with sides from 1 to {MAX_SIDE}"))?;
    Ok(Size { width, height })
}

/// Texels along both sides, or along each.
pub(crate) fn texels(text: &str) -> Result<Size, String> {
    let side = text.parse().ok().filter(|side| (1..=MAX_SIDE).contains(side));
    side.map_or_else(|| size(text), |side| Ok(Size { width: side, height: side }))
}

/// Texels around a chart.
pub(crate) fn gutter(text: &str) -> Result<usize, String> {
    ranged(text, 0, TexelOptions::MAX_GUTTER)
}

/// An order that can be baked.
pub(crate) fn order(text: &str) -> Result<Order, String> {
    let n = ranged(text, 1, BakeOptions::MAX_ORDER)?;
    Order::new(n).map_err(|error| error.to_string())
}

pub(crate) fn rays(text: &str) -> Result<usize, String> {
    ranged(text, 1, BakeOptions::MAX_RAYS)
}

pub(crate) fn bounces(text: &str) -> Result<usize, String> {
    ranged(text, 0, BakeOptions::MAX_BOUNCES)
}

/// A relative error.
pub(crate) fn error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|&error: &f64| error > 0.0 && error <= 1.0);
    error.ok_or_else(|| "an error above 0 and at most 1 is needed, like 0.002".to_owned())
}

/// A time: seconds, or a number with s, m or h.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let units = [("s", 1.0), ("m", 60.0), ("h", 3600.0), ("", 1.0)];
    let found = units.into_iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let seconds = found.and_then(|(number, unit)| Some(number.trim().parse::<f64>().ok()? * unit));
    let seconds = seconds.filter(|seconds| (0.01..=1e7).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "a time is needed, like 90s, 5m or 8h".to_owned())
}

/// A part of a whole, less than all of it.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    ranged(text, 0.0, 0.999)
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    ranged(text, 1, 4096)
}

pub(crate) fn samples(text: &str) -> Result<u32, String> {
    ranged(text, 1, 4)
}

/// Lobes of a fit.
pub(crate) fn lobes(text: &str) -> Result<usize, String> {
    ranged(text, 1, sh_fit::FitOptions::MAX_LOBES)
}

/// How strongly lobes of neighbours are drawn together.
pub(crate) fn strength(text: &str) -> Result<f64, String> {
    ranged(text, 0.0, 1e6)
}

/// Height or depth of a relief, in tile widths.
pub(crate) fn relief(text: &str) -> Result<f32, String> {
    ranged(text, 0.0, 100.0)
}

/// Scattering or absorption: one coefficient, or three.
pub(crate) fn coefficients(text: &str) -> Result<[f32; 3], String> {
    let parts: Result<Vec<f32>, _> = text.split(',').map(|part| ranged(part.trim(), 0.0, Medium::MAX_SIGMA)).collect();
    match *parts?.as_slice() {
        [all] => Ok([all; 3]),
        [red, green, blue] => Ok([red, green, blue]),
        _ => Err("one coefficient, or three with commas between them, are needed".to_owned()),
    }
}

/// Mean cosine of scattering.
pub(crate) fn asymmetry(text: &str) -> Result<f32, String> {
    ranged(text, -Medium::MAX_G, Medium::MAX_G)
}

/// Index of refraction.
pub(crate) fn refraction(text: &str) -> Result<f32, String> {
    let [least, most] = Medium::IOR;
    ranged(text, least, most)
}

/// Rows of glossy transfer.
pub(crate) fn rows(text: &str) -> Result<usize, String> {
    ranged(text, 1, 64)
}

/// Degrees between the neighbouring faces of a crease.
pub(crate) fn crease(text: &str) -> Result<f32, String> {
    ranged(text, 0.0, 180.0)
}

/// Degrees of a vertical field of view.
pub(crate) fn field_of_view(text: &str) -> Result<f32, String> {
    ranged(text, 0.1, 170.0)
}

/// Stops, or `auto`.
pub(crate) fn exposure(text: &str) -> Result<Exposure, String> {
    if text.eq_ignore_ascii_case("auto") {
        return Ok(Exposure::Auto);
    }
    ranged(text, -40.0, 40.0).map(Exposure::Stops).map_err(|error| format!("{error}, or auto"))
}

pub(crate) fn stops(text: &str) -> Result<f32, String> {
    ranged(text, -10.0, 10.0)
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    ranged(text, f64::MIN_POSITIVE, f64::MAX).map_err(|_| "a number above 0 is needed".to_owned())
}

pub(crate) fn degrees(text: &str) -> Result<f32, String> {
    ranged(text, -36_000.0, 36_000.0)
}

/// Height of a wave, as a part of the length of a model.
pub(crate) fn amplitude(text: &str) -> Result<f32, String> {
    ranged(text, -10.0, 10.0)
}

/// A time from 0 on.
pub(crate) fn seconds(text: &str) -> Result<f32, String> {
    ranged(text, 0.0, 1e6)
}

/// Cells along a side of a tile.
pub(crate) fn cells(text: &str) -> Result<usize, String> {
    ranged(text, 2, 1024)
}

/// Size of a table of the light, or `direct`.
pub(crate) fn evaluation(text: &str) -> Result<Evaluation, String> {
    if text.eq_ignore_ascii_case("direct") {
        return Ok(Evaluation::Direct);
    }
    let Size { width, height } = size(text).map_err(|error| format!("{error}, or direct"))?;
    let evaluation = Evaluation::Table { width: width as usize, height: height as usize };
    evaluation.check().map(|()| evaluation).map_err(|error| error.to_string())
}

/// Tiles of a texture along one side.
pub(crate) fn tiles(text: &str) -> Result<usize, String> {
    ranged(text, 1, 1000)
}

/// Three numbers between 0 and 1.
pub(crate) fn albedo(text: &str) -> Result<[f32; 3], String> {
    let color = vector(text)?.to_array();
    match color.iter().all(|channel| (0.0..=1.0).contains(channel)) {
        true => Ok(color),
        false => Err("an albedo has three channels between 0 and 1".to_owned()),
    }
}

/// A point or a direction.
pub(crate) fn vector(text: &str) -> Result<Vec3, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers: Option<[f32; 3]> = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    let vector = numbers.map(Vec3::from_array).filter(|vector| vector.is_finite());
    vector.ok_or_else(|| "three numbers with commas between them are needed, like 0,1,0".to_owned())
}

/// A direction that is not zero; the result has unit length.
pub(crate) fn direction(text: &str) -> Result<Vec3, String> {
    vector(text)?.try_normalize().ok_or_else(|| "a direction must not be zero".to_owned())
}

/// The file that a picture is written to.
pub(crate) fn picture_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("png" | "exr") => Ok(path),
        _ => Err("pictures are written as .png (tone-mapped) or .exr (linear radiance)".to_owned()),
    }
}

/// The file that a picture of the window is written to.
pub(crate) fn png_file(text: &str) -> Result<PathBuf, String> {
    let is_png = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    Some(PathBuf::from(text)).filter(is_png).ok_or_else(|| "the picture of the window is written as .png".to_owned())
}

fn ranged<T: Copy + FromStr + PartialOrd + std::fmt::Display>(text: &str, least: T, most: T) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| (&least..=&most).contains(&number));
    number.ok_or_else(|| format!("a number from {least} to {most} is needed"))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480").unwrap(), Size { width: 640, height: 480 });
        for wrong in ["", "640", "x", "640x", "0x5", "5x-1", "99999x2", "3x4x5", "4294967297x2", "a x b"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn texels_are_one_number_or_two() {
        assert_eq!(texels("512").unwrap(), Size { width: 512, height: 512 });
        assert_eq!(texels("64x32").unwrap(), Size { width: 64, height: 32 });
        assert!(texels("0").is_err() && texels("99999").is_err() && texels("x").is_err());
    }

    #[test]
    fn times_have_units() {
        let seconds = ["90", "90s", "1.5m", "2h"].map(|text| duration(text).unwrap().as_secs_f64());
        assert_eq!(seconds, [90.0, 90.0, 90.0, 7200.0]);
        assert!(["", "s", "-1s", "0", "1d", "nan", "inf", "1e9h"].iter().all(|text| duration(text).is_err()));
    }

    #[test]
    fn vectors() {
        assert_eq!(vector("1, -2.5,3e2").unwrap(), Vec3::new(1.0, -2.5, 300.0));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "1;2;3"] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert_eq!(direction("0,0,5").unwrap(), Vec3::Z);
        assert!(direction("0,0,0").is_err());
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!(order("6").unwrap().get(), 6);
        assert!(order("0").is_err() && order("33").is_err() && order("100").is_err() && order("-1").is_err());
        assert!(rays("0").is_err() && rays("1048577").is_err() && rays("1.5").is_err());
        assert!(samples("0").is_err() && samples("5").is_err());
        assert!(field_of_view("0").is_err() && field_of_view("nan").is_err() && field_of_view("180").is_err());
        assert!(albedo("0.5,0.5,1.1").is_err() && albedo("-0.1,0,0").is_err());
        assert_eq!(albedo("0,0.5,1").unwrap(), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn pictures_are_png_or_exr() {
        assert!(picture_file("a/b.PNG").is_ok() && picture_file("b.exr").is_ok());
        assert!(picture_file("b.jpg").is_err() && picture_file("png").is_err());
    }
}
