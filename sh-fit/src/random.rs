//! Random directions.

use sh_core::fibonacci;

/// A random number generator of 64 bits of state: SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug, Clone)]
pub(crate) struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `-1..1`.
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A generator for one of many streams.
    pub(crate) fn for_stream(seed: u64, stream: u64) -> Self {
        let mut seeds = Self(seed);
        Self(seeds.next() ^ stream.wrapping_mul(0xd134_2543_de82_ef95))
    }

    /// Directions evenly spread over a half of the sphere, turned at random.
    pub(crate) fn even_directions(&mut self, count: usize) -> impl Iterator<Item = [f64; 3]> + use<> {
        // The columns of a reflection in a random plane: as good as a rotation for directions without a sign.
        let normal = self.direction();
        let turn = move |s: [f64; 3]| {
            let along = 2.0 * (0..3).map(|a| s[a] * normal[a]).sum::<f64>();
            [0, 1, 2].map(|a| s[a] - along * normal[a])
        };
        // The first half of a spiral is a half of the sphere.
        fibonacci(2 * count).into_iter().take(count).map(turn)
    }

    /// Uniform on the sphere: a point of the ball, by rejection from the cube, at unit length.
    pub(crate) fn direction(&mut self) -> [f64; 3] {
        loop {
            let point = [self.signed(), self.signed(), self.signed()];
            let squared: f64 = point.iter().map(|x| x * x).sum();
            // Shorter ones lose digits.
            if (1e-4..=1.0).contains(&squared) {
                return point.map(|x| x / squared.sqrt());
            }
        }
    }
}
