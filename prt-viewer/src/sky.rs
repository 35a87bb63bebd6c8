//! Environments that need no file. Radiance is linear; y is up.

use glam::{FloatExt, Vec3};
use prt_bake::{Environment, Image};
use sh_core::LatLong;

/// Size of the maps that the formulas are sampled to.
const MAP: LatLong = LatLong { width: 512, height: 256 };

/// An environment that is built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum BuiltIn {
    /// Blue sky with a soft, warm sun.
    Sky,
    /// A low, red sun.
    Sunset,
    /// Three soft boxes in a dark room.
    Studio,
    /// Radiance 1 from everywhere.
    White,
}

impl BuiltIn {
    pub(crate) const ALL: [Self; 4] = [Self::Sky, Self::Sunset, Self::Studio, Self::White];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Sky => "sky",
            Self::Sunset => "sunset",
            Self::Studio => "studio",
            Self::White => "white",
        }
    }

    pub(crate) fn environment(self) -> Environment {
        let texel = |index: usize| {
            let (x, y) = (index % MAP.width, index / MAP.width);
            let direction = MAP.direction(x as f64 + 0.5, y as f64 + 0.5);
            self.radiance(Vec3::from_array(direction.map(|coordinate| coordinate as f32))).to_array()
        };
        let pixels = (0..MAP.texel_count()).map(texel).collect();
        Environment::LatLong(Image { width: MAP.width, height: MAP.height, pixels })
    }

    fn radiance(self, direction: Vec3) -> Vec3 {
        match self {
            Self::Sky => DAY.radiance(direction),
            Self::Sunset => EVENING.radiance(direction),
            Self::Studio => studio(direction),
            Self::White => Vec3::ONE,
        }
    }
}

/// A sky: colours from the horizon to the zenith, a plain below, and a sun.
struct Sky {
    zenith: Vec3,
    horizon: Vec3,
    ground: Vec3,
    sun: Lobe,
    /// The bright air around the sun.
    glow: Lobe,
}

const DAY: Sky = Sky {
    zenith: Vec3::new(0.09, 0.175, 0.39),
    horizon: Vec3::new(0.36, 0.42, 0.50),
    ground: Vec3::new(0.18, 0.17, 0.155),
    sun: Lobe { towards: Vec3::new(-0.70, 0.62, 0.22), sharpness: 22.0, radiance: Vec3::new(12.0, 9.6, 6.8) },
    glow: Lobe { towards: Vec3::new(-0.70, 0.62, 0.22), sharpness: 9.0, radiance: Vec3::new(0.63, 0.52, 0.35) },
};

const EVENING: Sky = Sky {
    zenith: Vec3::new(0.07, 0.09, 0.22),
    horizon: Vec3::new(0.66, 0.34, 0.18),
    ground: Vec3::new(0.09, 0.07, 0.07),
    sun: Lobe { towards: Vec3::new(-0.80, 0.24, 0.35), sharpness: 22.0, radiance: Vec3::new(11.5, 4.9, 1.5) },
    glow: Lobe { towards: Vec3::new(-0.80, 0.24, 0.35), sharpness: 6.0, radiance: Vec3::new(1.1, 0.42, 0.14) },
};

impl Sky {
    fn radiance(&self, direction: Vec3) -> Vec3 {
        let above = self.horizon.lerp(self.zenith, direction.y.max(0.0).powf(0.55));
        let below = self.horizon.lerp(self.ground, 1.0 - (6.0 * direction.y.min(0.0)).exp());
        let air = if direction.y > 0.0 { above } else { below };
        // The sun goes down behind the horizon, softly.
        let visible = f32::inverse_lerp(-0.02, 0.02, direction.y).clamp(0.0, 1.0);
        air + visible * (self.sun.radiance(direction) + self.glow.radiance(direction))
    }
}

/// `radiance · exp(sharpness (cos γ − 1))` at the angle γ from a direction.
struct Lobe {
    towards: Vec3,
    sharpness: f32,
    radiance: Vec3,
}

impl Lobe {
    fn radiance(&self, direction: Vec3) -> Vec3 {
        self.radiance * (self.sharpness * (direction.dot(self.towards.normalize()) - 1.0)).exp()
    }
}

fn studio(direction: Vec3) -> Vec3 {
    const LIGHTS: [Lobe; 3] = [
        Lobe { towards: Vec3::new(-0.7, 0.6, 0.6), sharpness: 14.0, radiance: Vec3::new(6.3, 6.0, 5.6) },
        Lobe { towards: Vec3::new(0.9, 0.3, 0.4), sharpness: 10.0, radiance: Vec3::new(0.9, 1.1, 1.4) },
        Lobe { towards: Vec3::new(0.2, 0.5, -1.0), sharpness: 18.0, radiance: Vec3::new(4.2, 3.6, 3.1) },
    ];
    let room = Vec3::splat(0.08).lerp(Vec3::splat(0.15), 0.5 + 0.5 * direction.y);
    LIGHTS.iter().map(|light| light.radiance(direction)).fold(room, |sum, light| sum + light)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_is_positive_and_finite_everywhere() {
        for built_in in BuiltIn::ALL {
            for direction in sh_core::fibonacci(2000) {
                let radiance = built_in.radiance(Vec3::from_array(direction.map(|x| x as f32)));
                assert!(radiance.is_finite() && radiance.min_element() > 0.0, "{}", built_in.name());
            }
        }
    }

    #[test]
    fn the_sun_is_where_it_is_said_to_be() {
        let toward = DAY.sun.towards.normalize();
        assert!(DAY.radiance(toward).x > 10.0 * DAY.radiance(-toward * Vec3::new(1.0, -1.0, 1.0)).x);
        assert!(DAY.radiance(Vec3::Y).z > DAY.radiance(Vec3::Y).x, "the zenith is blue");
    }

    #[test]
    fn names_on_the_command_line_are_those_shown() {
        use clap::ValueEnum;
        for built_in in BuiltIn::ALL {
            assert_eq!(BuiltIn::from_str(built_in.name(), false), Ok(built_in));
        }
    }
}
