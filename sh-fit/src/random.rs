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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_uniform_and_streams_differ() {
        let mut random = Random::for_stream(1, 2);
        let mut sums = [0.0; 6];
        for _ in 0..10_000 {
            let [x, y, z] = random.direction();
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-15);
            sums.iter_mut().zip([x, y, z, x * x, y * y, z * z]).for_each(|(sum, value)| *sum += value / 10_000.0);
        }
        // Standard deviations 0.0058 and 0.003; five of them.
        let expected = [0.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0];
        assert!(sums.iter().zip(expected).all(|(sum, expected)| (sum - expected).abs() < 0.03), "{sums:?}");
        assert_ne!(Random::for_stream(1, 2).direction(), Random::for_stream(1, 3).direction());
        assert_ne!(Random::for_stream(1, 2).direction(), Random::for_stream(2, 2).direction());
    }

    #[test]
    fn first_axes_leave_no_gap() {
        // 50 directions on a half sphere, with the opposite ones: none of the sphere is farther than about 17°.
        let axes: Vec<[f64; 3]> = Random::for_stream(3, 4).even_directions(50).collect();
        assert_eq!(axes.len(), 50);
        for s in fibonacci(2000) {
            let nearest = axes.iter().map(|a| (a[0] * s[0] + a[1] * s[1] + a[2] * s[2]).abs()).fold(0.0, f64::max);
            assert!(nearest > 0.93, "{nearest} at {s:?}");
        }
    }
}
