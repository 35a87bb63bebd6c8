//! What to bake, and how.

use sh_core::Order;

use crate::Error;

/// What becomes of vertices that lie inside of solids, where parts of a model intersect.
///
/// They see nothing but the backs of faces, so their transfer is zero; faces that reach from such a vertex to a visible one then fade to
/// black well before the intersection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InsidePolicy {
    /// They take the transfer of the nearest vertices outside, along edges where possible. The default: they cannot be seen
    /// themselves, so that nothing true is lost.
    #[default]
    Fill,
    /// They keep what their own rays found: the truth at the vertex.
    Keep,
    /// They become black, even where a few of their rays slip out.
    Black,
}

impl InsidePolicy {
    /// The names `fill`, `keep` and `black`, in the order of the variants.
    pub const NAMES: [&str; 3] = ["fill", "keep", "black"];
}

impl std::str::FromStr for InsidePolicy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "fill" => Ok(Self::Fill),
            "keep" => Ok(Self::Keep),
            "black" => Ok(Self::Black),
            _ => Err(Error::Option(format!("{name} is no policy for vertices inside: {}", Self::NAMES.join(", ")))),
        }
    }
}

impl std::fmt::Display for InsidePolicy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(Self::NAMES[*self as usize])
    }
}

/// Settings of a bake of diffuse transfer.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeOptions {
    /// Number of bands `n`; 1 to [`BakeOptions::MAX_ORDER`].
    pub order: Order,
    /// Directions over the hemisphere above each vertex; 1 to [`BakeOptions::MAX_RAYS`]. The one set of directions that all vertices share has twice
    /// as many over the sphere, rounded up to a multiple of 64.
    ///
    /// With [`target_error`](Self::target_error) it is the finest set of directions that a vertex is given: no vertex is done better than
    /// this count would do it.
    pub rays_per_vertex: usize,
    /// Estimated error at which a vertex is done, of its shadowed transfer vector, relative to the length of the unshadowed one; above 0, at
    /// most 1. `None` gives every vertex all of its rays.
    ///
    /// A vertex begins with about half the inverse of this number of directions, so that what they all miss weighs less than the error. If
    /// nothing is occluded, or all, it is done. Otherwise it is given finer sets, each with two or four times as many directions; where
    /// neighbouring directions of the coarser set agree, a finer one is taken to agree with them, and only along outlines are rays traced.
    /// Two sets that differ little end the work, with the mean of all, weighted by variance. What cannot be seen by this: an occluder that
    /// slips between the coarsest directions, and what light reflected by it would add.
    pub target_error: Option<f64>,
    /// Whether surfaces shadow one another. Without, transfer follows from the normals alone, exactly, and no ray is traced.
    pub shadowed: bool,
    /// Diffuse interreflections that are followed; 0 is direct light alone. Needs `shadowed`.
    pub bounces: usize,
    /// Interreflection stops after the first pass that adds less than this share of the length of the direct transfer; it never takes more
    /// passes than `bounces`. `None` takes all of them.
    pub bounce_threshold: Option<f64>,
    /// What becomes of vertices inside of solids.
    pub inside: InsidePolicy,
    /// Keep the transfer of direct light beside the one with interreflections, so that a viewer can switch between them.
    pub keep_shadowed: bool,
    /// Rotates the set of directions. Same seed and options, same bytes, for any number of threads.
    pub seed: u64,
    /// Number of threads; all that the machine has if `None`.
    pub threads: Option<usize>,
}

impl BakeOptions {
    /// Largest order that is baked: 1,024 coefficients.
    pub const MAX_ORDER: usize = 32;
    /// Most rays per vertex.
    pub const MAX_RAYS: usize = 1 << 20;
    /// Most bounces: at albedo 0.98 light is down to a hundredth.
    pub const MAX_BOUNCES: usize = 256;

    /// A quick look: 512 rays, order 5.
    #[must_use]
    pub fn preview() -> Self {
        Self { rays_per_vertex: 512, order: order(5), ..Self::default() }
    }

    /// Channels of the transfer of a mesh: colour is carried only if it is reflected.
    #[cfg(feature = "trace")]
    pub(crate) fn channel_count(&self, mesh: &crate::Mesh) -> usize {
        if self.bounces > 0 { mesh.channel_count() } else { 1 }
    }

    #[cfg(feature = "trace")]
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let fail = |message: String| Err(Error::Option(message));
        if self.order.get() > Self::MAX_ORDER {
            return fail(format!("order {} is above the largest that is baked, {}", self.order, Self::MAX_ORDER));
        }
        if !(1..=Self::MAX_RAYS).contains(&self.rays_per_vertex) {
            return fail(format!("{} rays per vertex; 1 to {} are possible", self.rays_per_vertex, Self::MAX_RAYS));
        }
        if let Some(error) = self.target_error.filter(|error| !(*error > 0.0 && *error <= 1.0)) {
            return fail(format!("a target error of {error}; it is above 0 and at most 1"));
        }
        if self.bounces > Self::MAX_BOUNCES {
            return fail(format!("{} bounces; at most {} are possible", self.bounces, Self::MAX_BOUNCES));
        }
        if self.bounces > 0 && !self.shadowed {
            return fail(format!(
                "{} bounces without shadows: interreflection needs the rays of shadowed transfer",
                self.bounces
            ));
        }
        if let Some(threshold) = self.bounce_threshold.filter(|threshold| !(0.0..1.0).contains(threshold)) {
            return fail(format!("bounce threshold {threshold}; at least 0 and less than 1 is needed"));
        }
        if self.threads == Some(0) {
            return fail("0 threads; at least 1 is needed".to_owned());
        }
        Ok(())
    }
}

impl Default for BakeOptions {
    /// Shadowed transfer of order 6 from 4,096 rays a vertex, direct light alone, vertices inside of solids filled, seed 0, all threads.
    fn default() -> Self {
        Self {
            order: order(6),
            rays_per_vertex: 4096,
            target_error: None,
            shadowed: true,
            bounces: 0,
            bounce_threshold: None,
            inside: InsidePolicy::default(),
            keep_shadowed: false,
            seed: 0,
            threads: None,
        }
    }
}

fn order(n: usize) -> Order {
    Order::new(n).expect("1 to 32 is an order")
}
