//! Deformations of space in closed form, with their exact Jacobians.

mod bounds;
mod shape;

use glam::{DMat3, DVec3};

use crate::Deformed;
use bounds::Sides;

/// A deformation of space.
///
/// The constructors [`bend`](Self::bend), [`twist`](Self::twist), [`wave`](Self::wave) and [`taper`](Self::taper) take the bounds of a mesh, so that
/// the same numbers mean the same on every mesh. The fields are for deformations placed by hand: `origin` in scene units; `along` and
/// `toward` unit vectors, orthogonal to one another. With strength 0 every deformation is the identity, exactly.
///
/// Coordinates: `s = (p − origin) · along`, `d = (p − origin) · toward`.
#[derive(Debug, Clone, PartialEq)]
pub enum Deformation {
    /// Circular bend: the line through `origin` along `along` becomes a circle of the given curvature that opens towards `toward`, without change
    /// of length: `s' = sin(κs)/κ − d sin κs`, `d' = (1 − cos κs)/κ + d cos κs`. It folds over where `κd ≥ 1`.
    Bend {
        /// A point of the line that keeps its length.
        origin: [f64; 3],
        /// Direction of that line.
        along: [f64; 3],
        /// Direction of the circle's centre.
        toward: [f64; 3],
        /// `κ`, 1 / scene unit.
        curvature: f64,
    },
    /// Rotation about an axis by an angle that grows along it: `φ = rate · s`.
    Twist {
        /// A point of the axis that is not turned.
        origin: [f64; 3],
        /// Direction of the axis.
        along: [f64; 3],
        /// Radians per scene unit.
        rate: f64,
    },
    /// Travelling sine: `p' = p + toward · amplitude · sin(2π s / wavelength − phase)`.
    Wave {
        /// Where the phase is counted from.
        origin: [f64; 3],
        /// Direction in which the wave travels.
        along: [f64; 3],
        /// Direction in which points move.
        toward: [f64; 3],
        /// Scene units.
        amplitude: f64,
        /// Scene units, not zero.
        wavelength: f64,
        /// Radians; as it grows the wave travels along `along`.
        phase: f64,
    },
    /// Growth of the sections across an axis: scaled by `exp(rate · s)`, which is never zero.
    Taper {
        /// A point of the axis where the section keeps its size.
        origin: [f64; 3],
        /// Direction of the axis.
        along: [f64; 3],
        /// 1 / scene unit.
        rate: f64,
    },
    /// One after the other, the first one first; an empty list is the identity.
    Chain(Vec<Self>),
}

impl Deformation {
    /// A bend of the whole box by `angle` radians: its longest side becomes an arc that opens towards the shortest side. A full circle is 2π.
    ///
    /// Of sides of equal length the longest is taken in the order y, x, z, and the shortest as z, x, y.
    ///
    /// - `bounds`: lower and upper corner
    #[must_use]
    pub fn bend(bounds: [[f64; 3]; 2], angle: f64) -> Self {
        let sides = Sides::of(bounds);
        Self::Bend {
            origin: sides.center,
            along: sides.longest,
            toward: sides.shortest,
            curvature: angle / sides.length,
        }
    }

    /// A twist about the longest side of the box by `angle` radians from end to end; the middle keeps its place.
    ///
    /// - `bounds`: lower and upper corner
    #[must_use]
    pub fn twist(bounds: [[f64; 3]; 2], angle: f64) -> Self {
        let sides = Sides::of(bounds);
        Self::Twist { origin: sides.center, along: sides.longest, rate: angle / sides.length }
    }

    /// A sine that travels along the longest side and moves points along the shortest.
    ///
    /// - `bounds`: lower and upper corner
    /// - `amplitude`: as a fraction of the longest side
    /// - `waves`: how many wavelengths the longest side has
    /// - `phase`: radians
    #[must_use]
    pub fn wave(bounds: [[f64; 3]; 2], amplitude: f64, waves: f64, phase: f64) -> Self {
        let sides = Sides::of(bounds);
        Self::Wave {
            origin: sides.center,
            along: sides.longest,
            toward: sides.shortest,
            amplitude: amplitude * sides.length,
            wavelength: sides.length / waves,
            phase,
        }
    }

    /// A taper along the longest side: the far end's section is scaled by `exp(strength)` relative to the near end's, the middle's is kept.
    ///
    /// - `bounds`: lower and upper corner
    #[must_use]
    pub fn taper(bounds: [[f64; 3]; 2], strength: f64) -> Self {
        let sides = Sides::of(bounds);
        Self::Taper { origin: sides.center, along: sides.longest, rate: strength / sides.length }
    }

    /// Where a point goes.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        self.point_and_jacobian(DVec3::from(point)).0.to_array()
    }

    /// The Jacobian at a point: columns `∂p'/∂x`, `∂p'/∂y`, `∂p'/∂z`.
    #[must_use]
    pub fn jacobian(&self, point: [f64; 3]) -> [[f64; 3]; 3] {
        self.point_and_jacobian(DVec3::from(point)).1.to_cols_array_2d()
    }

    /// Positions, normals and frames of all vertices of a mesh after the deformation.
    ///
    /// - `positions`, `normals`: `[V]`, of the rest pose
    ///
    /// # Panics
    /// If lengths differ.
    pub fn deform(&self, positions: &[[f32; 3]], normals: &[[f32; 3]], out: &mut Deformed) {
        assert_eq!(normals.len(), positions.len(), "one normal for each vertex is needed");
        out.fill(positions.len(), |vertex| {
            let (position, jacobian) = self.point_and_jacobian(DVec3::from(positions[vertex].map(f64::from)));
            (position, jacobian, DVec3::from(normals[vertex].map(f64::from)))
        });
    }

    fn point_and_jacobian(&self, p: DVec3) -> (DVec3, DMat3) {
        let vec = |v: &[f64; 3]| DVec3::from(*v);
        match self {
            Self::Bend { origin, along, toward, curvature } => {
                shape::bend(p, vec(origin), vec(along), vec(toward), *curvature)
            }
            Self::Twist { origin, along, rate } => shape::twist(p, vec(origin), vec(along), *rate),
            Self::Wave { origin, along, toward, amplitude, wavelength, phase } => {
                let wave_number = std::f64::consts::TAU / wavelength;
                shape::wave(p, vec(origin), vec(along), vec(toward), [*amplitude, wave_number, *phase])
            }
            Self::Taper { origin, along, rate } => shape::taper(p, vec(origin), vec(along), *rate),
            Self::Chain(steps) => steps.iter().fold((p, DMat3::IDENTITY), |(p, jacobian), step| {
                let (p, inner) = step.point_and_jacobian(p);
                (p, inner * jacobian)
            }),
        }
    }
}
