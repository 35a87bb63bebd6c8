//! Random walks of light in a translucent patch.

use std::f64::consts::TAU;

use glam::DVec3;

use super::interface::{Meeting, meet};
use super::medium::Medium;
use super::surface::{Side, Surface, SurfacePoint};
use crate::sampling::Random;

/// A path whose weight falls below this goes on with a weight of this, or ends, by chance: its mean weight stays.
const ROULETTE_WEIGHT: f64 = 0.1;

/// Henyey-Greenstein's formula for the scattering angle loses all digits for a smaller `|g|`, which is isotropic to this accuracy.
const ISOTROPIC_G: f64 = 1e-7;

/// Paths jump where they are this far from every boundary ...
const JUMP_DEPTH: f64 = 8.0;
/// ... over a sphere that ends this far from it; both in transport mean free paths.
const JUMP_MARGIN: f64 = 4.0;
/// Paths jump in media that absorb less than this share of `σ_a + σ_s (1 − g)`; in others they soon end.
const JUMP_ABSORPTION: f64 = 0.02;
/// A sphere acts as one that is larger by this many transport mean free paths: Milne's extrapolation length.
const EXTRAPOLATION: f64 = 0.7104;

/// One channel of a medium in the frame of a surface.
#[derive(Debug, Clone)]
pub(super) struct Walk<'a> {
    surface: &'a Surface,
    /// Height of the plane that ends the medium below.
    floor: Option<f64>,
    /// Extinction, per side of a texel.
    sigma_t: f64,
    /// Share of the extinction that is scattering.
    albedo: f64,
    g: f64,
    ior: f64,
    jump: Option<Jump>,
    /// Free paths after which a path is given up.
    max_events: u32,
}

/// Diffusion deep in the medium.
#[derive(Debug, Clone, Copy)]
struct Jump {
    /// Transport mean free path.
    step: f64,
    /// Attenuation of diffuse light, per side of a texel: `√(3 σ_a (σ_a + σ_s (1 − g)))`.
    kappa: f64,
}

/// How a path ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// It left upwards, to the sky.
    Above(DVec3),
    /// It left through the plane below.
    Below(DVec3),
    /// It was absorbed, or is on its way down for ever.
    Lost,
    /// It was too long.
    GivenUp,
}

/// A path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    pub(super) end: End,
    pub(super) weight: f64,
    /// Number of free paths, inside and outside.
    pub(super) events: u32,
}

/// Where a path is, and where it goes.
#[derive(Debug, Clone, Copy)]
struct State {
    position: DVec3,
    direction: DVec3,
    side: Side,
    weight: f64,
}

impl<'a> Walk<'a> {
    /// - `channel`: 0, 1 or 2
    /// - `thickness`: down from height 0, in units of the tile's width
    pub(super) fn new(
        surface: &'a Surface,
        medium: &Medium,
        channel: usize,
        thickness: Option<f32>,
        max_events: u32,
    ) -> Self {
        let per_texel = 1.0 / surface.width();
        let [scattering, absorption] =
            [medium.sigma_s, medium.sigma_a].map(|sigma| f64::from(sigma[channel]) * per_texel);
        let g = f64::from(medium.g);
        let sigma_t = scattering + absorption;
        let transport = absorption + scattering * (1.0 - g);
        let jump = Jump { step: 1.0 / transport, kappa: (3.0 * absorption * transport).sqrt() };
        Self {
            surface,
            floor: thickness.map(|thickness| surface.lattice_z(-f64::from(thickness))),
            sigma_t,
            albedo: if sigma_t > 0.0 { scattering / sigma_t } else { 0.0 },
            g,
            ior: f64::from(medium.ior),
            jump: (scattering > 0.0 && absorption < JUMP_ABSORPTION * transport).then_some(jump),
            max_events,
        }
    }

    /// Follows a path that comes to the surface from outside.
    ///
    /// Its weight, times the radiance from where it leaves, is an estimate of the radiance that leaves the surface against `direction`:
    /// radiance divided by the squared index of refraction is what the medium transports, and the factors of entry and exit cancel.
    pub(super) fn follow(&self, position: DVec3, point: &SurfacePoint, direction: DVec3, random: &mut Random) -> Path {
        let mut state = State { position, direction, side: Side::Above, weight: 1.0 };
        self.meet_surface(&mut state, point.normal, random);
        for events in 1..=self.max_events {
            state.position = self.surface.wrap(state.position);
            let end = match state.side {
                Side::Above => self.move_outside(&mut state, random),
                Side::Below => self.move_inside(&mut state, random),
            };
            if let Some(end) = end {
                return Path { end, weight: state.weight, events };
            }
        }
        Path { end: End::GivenUp, weight: state.weight, events: self.max_events }
    }

    fn move_outside(&self, state: &mut State, random: &mut Random) -> Option<End> {
        let reach = self.surface.follow(state.position, state.direction, f64::INFINITY, Side::Above);
        let Some(point) = reach.point else { return Some(End::Above(state.direction)) };
        state.position += reach.distance * state.direction;
        self.meet_surface(state, point.normal, random);
        None
    }

    fn move_inside(&self, state: &mut State, random: &mut Random) -> Option<End> {
        let free = if self.sigma_t > 0.0 { -(1.0 - random.unit()).ln() / self.sigma_t } else { f64::INFINITY };
        let to_floor = self.distance_to_floor(state);
        let limit = free.min(to_floor);
        let reach = self.surface.follow(state.position, state.direction, limit, Side::Below);
        if reach.distance == f64::INFINITY {
            return Some(End::Lost);
        }
        state.position += reach.distance * state.direction;
        if let Some(point) = reach.point {
            self.meet_surface(state, point.normal, random);
        } else if reach.distance < limit {
            return Some(End::GivenUp);
        } else if to_floor <= free {
            return self.meet_floor(state, random);
        } else {
            return self.scatter(state, random);
        }
        None
    }

    fn distance_to_floor(&self, state: &State) -> f64 {
        match self.floor {
            Some(floor) if state.direction.z < 0.0 => ((floor - state.position.z) / state.direction.z).max(0.0),
            _ => f64::INFINITY,
        }
    }

    fn meet_surface(&self, state: &mut State, up: DVec3, random: &mut Random) {
        let (normal, eta, other) = match state.side {
            Side::Above => (up, self.ior, Side::Below),
            Side::Below => (-up, 1.0 / self.ior, Side::Above),
        };
        match meet(state.direction, normal, eta, random.unit()) {
            Meeting::Reflected(direction) => state.direction = direction,
            Meeting::Refracted(direction) => (state.direction, state.side) = (direction, other),
        }
    }

    fn meet_floor(&self, state: &mut State, random: &mut Random) -> Option<End> {
        match meet(state.direction, DVec3::Z, 1.0 / self.ior, random.unit()) {
            Meeting::Reflected(direction) => {
                state.direction = direction;
                None
            }
            Meeting::Refracted(direction) => Some(End::Below(direction)),
        }
    }

    /// A collision: some weight is absorbed, and the path turns.
    fn scatter(&self, state: &mut State, random: &mut Random) -> Option<End> {
        state.weight *= self.albedo;
        state.direction = self.scattered(state.direction, random);
        self.jump(state, random);
        if state.weight >= ROULETTE_WEIGHT {
            return None;
        }
        let survives = random.unit() * ROULETTE_WEIGHT < state.weight;
        state.weight = ROULETTE_WEIGHT;
        (!survives).then_some(End::Lost)
    }

    /// A direction after a collision: Henyey and Greenstein, Astrophysical Journal 93, 1941.
    fn scattered(&self, direction: DVec3, random: &mut Random) -> DVec3 {
        let (g, u) = (self.g, random.unit());
        let cos = if g.abs() < ISOTROPIC_G {
            1.0 - 2.0 * u
        } else {
            let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
            (1.0 + g * g - ratio * ratio) / (2.0 * g)
        };
        about(direction, cos, random.unit())
    }

    /// Deep in the medium a path goes on where it first leaves a sphere around it, as diffusion does: evenly over the sphere, with
    /// `κr/sinh κr` of its weight (Muller, Annals of Mathematical Statistics 27, 1956, with absorption).
    fn jump(&self, state: &mut State, random: &mut Random) {
        let Some(Jump { step, kappa }) = self.jump else { return };
        // The mean of all later places of a path is one transport mean free path ahead of it.
        let center = state.position + step * state.direction;
        let to_floor = self.floor.map_or(f64::INFINITY, |floor| center.z - floor);
        let depth = to_floor.min(-center.z);
        if depth < JUMP_DEPTH * step {
            return;
        }
        let radius = depth - JUMP_MARGIN * step;
        let outward = about(DVec3::Z, 1.0 - 2.0 * random.unit(), random.unit());
        state.position = center + radius * outward;
        state.direction = about(outward, emergent_cosine(random), random.unit());
        let attenuation = kappa * (radius + EXTRAPOLATION * step);
        if attenuation > 0.0 {
            state.weight *= attenuation / attenuation.sinh();
        }
    }
}

/// The cosine at which diffuse light crosses a boundary for the first time: density in proportion to `μ H(μ)`, with
/// Chandrasekhar's `H(μ) ≈ 1 + 1.9 μ` of a medium that does not absorb.
fn emergent_cosine(random: &mut Random) -> f64 {
    const LINEAR_SHARE: f64 = (1.0 / 2.0) / (1.0 / 2.0 + 1.9 / 3.0);
    if random.unit() < LINEAR_SHARE { random.unit().sqrt() } else { random.unit().cbrt() }
}

/// A direction at an angle of the given cosine from an axis.
///
/// - `turn`: how far around the axis, 0..1
pub(super) fn about(axis: DVec3, cos: f64, turn: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * turn).sin_cos();
    (sin * (cos_phi * x + sin_phi * y) + cos * axis).normalize()
}

#[cfg(test)]
mod tests {
    use super::super::field::HeightField;
    use super::*;

    #[test]
    fn a_jump_keeps_the_mean_place_and_stays_inside() {
        // A path that scatters for ever stays, in the mean, one transport mean free path ahead of where it set out.
        let field = HeightField::new(1, 1, vec![0.0]).expect("valid");
        let surface = Surface::new(&field);
        let medium = Medium { g: 0.8, ..Medium::grey(50.0, 0.0) };
        let walk = Walk::new(&surface, &medium, 0, None, 1);
        let step = 1.0 / (50.0 * 0.2);
        let mut random = Random::new(3);
        let (mut sum, count) = (DVec3::ZERO, 40_000);
        let start = -9.0 * step * DVec3::Z;
        for _ in 0..count {
            let mut state = State { position: start, direction: DVec3::X, side: Side::Below, weight: 1.0 };
            walk.jump(&mut state, &mut random);
            assert!(state.position != start && state.position.z < -3.99 * step && state.weight == 1.0);
            sum += (state.position - start) / step;
        }
        // The sphere has a radius of 5 steps: one standard deviation is 5/√(3 · 40,000) = 0.014.
        assert!((sum / f64::from(count) - DVec3::X).length() < 0.08, "{}", sum / f64::from(count));
    }
}
