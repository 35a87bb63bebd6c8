//! The light of a picture: an environment, turned the way the user wants it.

use std::path::Path;

use clap::ValueEnum;
use glam::{Mat3, Quat, Vec3};
use prt_bake::{Environment, Error};
use sh_core::{Order, ShRotation};

use crate::sky::BuiltIn;

/// An environment and its light vector.
#[derive(Debug, Clone)]
pub(crate) struct Lighting {
    /// As it is shown in lists.
    pub(crate) name: String,
    pub(crate) environment: Environment,
    order: Order,
    /// `[3, n²]`, in the frame of the environment.
    light: Vec<f32>,
}

impl Lighting {
    pub(crate) fn new(name: String, environment: Environment, order: Order) -> Self {
        let light = environment.light(order);
        Self { name, environment, order, light }
    }

    pub(crate) fn built_in(built_in: BuiltIn, order: Order) -> Self {
        Self::new(built_in.name().to_owned(), built_in.environment(), order)
    }

    /// A file, a folder with the six faces of a cube map, or the name of a built-in environment where no such file exists.
    pub(crate) fn load(path: &Path, order: Order) -> Result<Self, Error> {
        let built_in = path.to_str().and_then(|text| BuiltIn::from_str(text, true).ok());
        match built_in.filter(|_| !path.exists()) {
            Some(built_in) => Ok(Self::built_in(built_in, order)),
            None => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
                Ok(Self::new(name, Environment::load(path)?, order))
            }
        }
    }

    /// The light vector `[3, k²]` of the environment turned by `scene_from_environment`, to order `k` at most that of the lighting.
    pub(crate) fn light(&self, order: Order, scene_from_environment: Quat) -> Vec<f32> {
        let rotation = ShRotation::new(order, rows(scene_from_environment));
        let mut turned = vec![0.0; 3 * order.coeff_count()];
        let channels = self.light.chunks_exact(self.order.coeff_count());
        for (channel, turned) in channels.zip(turned.chunks_exact_mut(order.coeff_count())) {
            rotation.apply(&channel[..order.coeff_count()], turned);
        }
        turned
    }
}

/// The rows of the rotation matrix.
fn rows(rotation: Quat) -> [[f32; 3]; 3] {
    Mat3::from_quat(rotation).transpose().to_cols_array_2d()
}

/// Stands an environment map, whose up is +y, upright in a scene with another up direction.
pub(crate) fn upright(up: Vec3) -> Quat {
    // Half a turn about x for a scene that is upside down: any axis across would do.
    if up.dot(Vec3::Y) < -0.9999 {
        Quat::from_rotation_x(std::f32::consts::PI)
    } else {
        Quat::from_rotation_arc(Vec3::Y, up)
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use prt_bake::Image;
    use sh_core::{LatLong, reconstruct};

    /// One bright spot.
    fn spot(towards: Vec3) -> Lighting {
        let map = LatLong { width: 64, height: 32 };
        let texel = |i: usize| {
            let direction = map.direction((i % 64) as f64 + 0.5, (i / 64) as f64 + 0.5).map(|x| x as f32);
            let bright = (8.0 * (Vec3::from_array(direction).dot(towards) - 1.0)).exp();
            [bright, 2.0 * bright, 0.5]
        };
        let pixels = (0..64 * 32).map(texel).collect();
        let environment = Environment::LatLong(Image { width: 64, height: 32, pixels });
        Lighting::new("spot".to_owned(), environment, Order::new(6).unwrap())
    }

    fn brightest(light: &[f32], order: Order) -> Vec3 {
        let red = |d: &[f64; 3]| reconstruct(order, &light[..order.coeff_count()], d.map(|x| x as f32));
        let best = sh_core::fibonacci(4000).into_iter().max_by(|a, b| red(a).total_cmp(&red(b))).unwrap();
        Vec3::from_array(best.map(|x| x as f32))
    }

    #[test]
    fn turning_the_light_turns_where_it_comes_from() {
        let towards = Vec3::new(1.0, 2.0, -0.5).normalize();
        let lighting = spot(towards);
        for rotation in [Quat::IDENTITY, Quat::from_rotation_y(1.2), upright(Vec3::Z) * Quat::from_rotation_y(-2.0)] {
            let order = Order::new(5).unwrap();
            let found = brightest(&lighting.light(order, rotation), order);
            assert!(found.dot(rotation * towards) > 0.99, "{found} is not {}", rotation * towards);
        }
    }

    #[test]
    fn fewer_bands_are_the_first_of_more() {
        let lighting = spot(Vec3::X);
        let (three, six) = (Order::new(3).unwrap(), Order::new(6).unwrap());
        let few = lighting.light(three, Quat::from_rotation_z(0.3));
        let many = lighting.light(six, Quat::from_rotation_z(0.3));
        for channel in 0..3 {
            assert_eq!(few[channel * 9..(channel + 1) * 9], many[channel * 36..channel * 36 + 9]);
        }
    }

    #[test]
    fn upright_takes_y_to_up() {
        for up in [Vec3::Y, Vec3::Z, Vec3::NEG_Y, Vec3::NEG_X, Vec3::new(1.0, -1.0, 2.0).normalize()] {
            assert!((upright(up) * Vec3::Y).distance(up) < 1e-3, "{up}");
        }
    }

    #[test]
    fn names_of_built_in_environments_are_known() {
        let order = Order::new(2).unwrap();
        assert_eq!(Lighting::load(Path::new("White"), order).unwrap().name, "white");
        assert!(
            Lighting::load(Path::new("no such file.hdr"), order).unwrap_err().to_string().contains("no such file.hdr")
        );
    }
}
