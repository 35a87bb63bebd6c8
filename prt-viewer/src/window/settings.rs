//! What the user can change in the window.

use glam::{Quat, Vec3};
use prt_gpu::Evaluation;
use sh_core::Order;

use crate::camera::Orbit;
use crate::motion::Motion;
use crate::shading::Part;

/// Limits of the exposure slider, stops.
pub(super) const EXPOSURE: std::ops::RangeInclusive<f32> = -10.0..=10.0;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Settings {
    pub(super) orbit: Orbit,
    /// Which of the environments is shown.
    pub(super) environment: usize,
    pub(super) scene_from_environment: Quat,
    /// Stops.
    pub(super) exposure: f32,
    /// Bands in use, 1 to the number baked.
    pub(super) order: usize,
    pub(super) part: Part,
    /// The pose.
    pub(super) motion: Motion,
    /// Time goes on: the clip plays, or the wave travels.
    pub(super) plays: bool,
    /// Light lobes from the paper's table instead of all basis functions.
    pub(super) uses_table: bool,
    /// Show a coefficient of the transfer instead of shading.
    pub(super) shows_transfer: bool,
    /// Which coefficient.
    pub(super) coefficient: usize,
    pub(super) shows_environment: bool,
    pub(super) shows_help: bool,
    pub(super) draws_continuously: bool,
}

impl Settings {
    pub(super) fn new(orbit: Orbit, scene_from_environment: Quat, exposure: f32, order: Order) -> Self {
        Self {
            orbit,
            environment: 0,
            scene_from_environment,
            exposure: exposure.clamp(*EXPOSURE.start(), *EXPOSURE.end()),
            order: order.get(),
            part: Part::Full,
            motion: Motion::default(),
            plays: false,
            uses_table: false,
            shows_transfer: false,
            coefficient: 0,
            shows_environment: true,
            shows_help: true,
            draws_continuously: false,
        }
    }

    pub(super) fn order(&self) -> Order {
        Order::new(self.order.max(1)).expect("the order is between 1 and the one that was baked")
    }

    pub(super) fn evaluation(&self) -> Evaluation {
        if self.uses_table { Evaluation::default() } else { Evaluation::Direct }
    }

    /// Lets time go on: the clip plays at its own speed, and the wave travels once along its length in four seconds.
    pub(super) fn advance(&mut self, seconds: f32) {
        const WAVE_SPEED: f32 = 90.0;
        match &mut self.motion.clip {
            Some((_, time)) => *time += seconds,
            None => self.motion.phase = (self.motion.phase + WAVE_SPEED * seconds) % 360.0,
        }
    }

    /// Turns the light so that what it brightens on the near side of the object follows a drag; radians.
    pub(super) fn turn_light(&mut self, to_right: f32, upwards: f32) {
        let [right, _] = self.orbit.camera().across();
        let turn = Quat::from_axis_angle(right, -upwards) * Quat::from_axis_angle(self.orbit.up(), to_right);
        self.scene_from_environment = (turn * self.scene_from_environment).normalize();
    }

    /// Brighter or darker, within the limits of the slider.
    pub(super) fn expose(&mut self, stops: f32) {
        self.exposure = (self.exposure + stops).clamp(*EXPOSURE.start(), *EXPOSURE.end());
    }

    /// Band and index within it of the coefficient that is shown.
    pub(super) fn band(&self) -> (usize, isize) {
        let l = self.coefficient.isqrt();
        (l, self.coefficient as isize - (l * (l + 1)) as isize)
    }
}

/// The colour of a coefficient between −1 and 1: blue, black, orange.
pub(super) fn signed_color(value: f32) -> [f32; 3] {
    const POSITIVE: Vec3 = Vec3::new(1.0, 0.42, 0.05);
    const NEGATIVE: Vec3 = Vec3::new(0.08, 0.35, 1.0);
    let full = if value >= 0.0 { POSITIVE } else { NEGATIVE };
    (full * value.abs()).to_array()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::camera::{DEFAULT_FOV, Side};

    fn settings() -> Settings {
        let orbit = Orbit::framing(&[[-1.0; 3], [1.0; 3]], Side::Front, Vec3::Y, DEFAULT_FOV, 1.0);
        Settings::new(orbit, Quat::IDENTITY, 0.0, Order::new(4).unwrap())
    }

    #[test]
    fn light_from_the_front_follows_the_drag() {
        let mut settings = settings();
        settings.turn_light(0.3, 0.0);
        assert!((settings.scene_from_environment * Vec3::Z).x > 0.2);
        settings.turn_light(-0.3, 0.3);
        let front = settings.scene_from_environment * Vec3::Z;
        assert!(front.y > 0.2 && front.x.abs() < 1e-5, "{front}");
    }

    #[test]
    fn coefficients_have_bands() {
        let mut settings = settings();
        let bands = [0, 1, 2, 3, 4, 8, 9].map(|coefficient| {
            settings.coefficient = coefficient;
            settings.band()
        });
        assert_eq!(bands, [(0, 0), (1, -1), (1, 0), (1, 1), (2, -2), (2, 2), (3, -3)]);
    }

    #[test]
    fn the_sign_of_a_coefficient_is_its_colour() {
        let [red, _, blue] = signed_color(0.5);
        assert!(red > blue);
        let [red, _, blue] = signed_color(-0.5);
        assert!(blue > red);
        assert_eq!(signed_color(0.0), [0.0; 3]);
    }
}
