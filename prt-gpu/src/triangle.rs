//! Where a sample lies in a triangle on the screen: the twin of the functions of `shaders/shared/screen.wgsl`.
//!
//! Every function gives the same bits as its shader. That is what makes the images of both twins equal along silhouettes and
//! where surfaces meet: which surface is in front is decided by equal numbers.

/// Steps of the snapped positions per sample: 8 bits, what GPUs use.
pub(crate) const SUBPIXEL_STEPS: i32 = 256;

/// A reciprocal of a positive number that every IEEE machine computes alike; GPU division is not exact to the last bit.
///
/// Accuracy: 2 ulp (tested). A first guess from the exponent bits, within 12 %, is refined by four Newton steps that square
/// the relative error each: 1.5e-2, 2e-4, 5e-8, rounding.
pub(crate) fn reciprocal(x: f32) -> f32 {
    let mut r = f32::from_bits(0x7ef3_11c7 - x.to_bits());
    for _ in 0..4 {
        r *= 2.0 - x * r;
    }
    r
}

/// Shares of the corners at a sample, linear on the screen, from its edge values (`edges[k]` is opposite to corner `k`).
pub(crate) fn screen_weights(edges: [f32; 3]) -> [f32; 3] {
    let r = reciprocal((edges[0] + edges[1]) + edges[2]);
    edges.map(|e| e * r)
}

/// Clip depth at a sample, 0 to 1. Clip depth is linear on the screen.
pub(crate) fn depth(weights: [f32; 3], z: [f32; 3]) -> f32 {
    let depth = z[0] + (weights[1] * (z[1] - z[0]) + weights[2] * (z[2] - z[0]));
    depth.clamp(0.0, 1.0)
}

/// Shares of the corners at a sample, linear on the surface: `weight_k / w_k`, divided by their sum.
pub(crate) fn perspective_weights(weights: [f32; 3], inverse_w: [f32; 3]) -> [f32; 3] {
    let shares: [f32; 3] = std::array::from_fn(|k| weights[k] * inverse_w[k]);
    let sum = (shares[0] + shares[1]) + shares[2];
    shares.map(|share| share / sum)
}

/// As [`perspective_weights`], with the same bits on every machine.
pub(crate) fn exact_perspective_weights(weights: [f32; 3], inverse_w: [f32; 3]) -> [f32; 3] {
    let shares: [f32; 3] = std::array::from_fn(|k| weights[k] * inverse_w[k]);
    let r = reciprocal((shares[0] + shares[1]) + shares[2]);
    shares.map(|share| share * r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn reciprocal_is_accurate(x in 1.0_f32..1e14) {
            let error = (f64::from(reciprocal(x)) * f64::from(x) - 1.0).abs();
            prop_assert!(error <= 2.0 * f64::from(f32::EPSILON), "{x}: {error}");
        }

        #[test]
        fn weights_match_double_precision(edges in [0.0_f64..1e12, 0.0_f64..1e12, 1.0_f64..1e12], w in [0.1_f64..10.0, 0.1_f64..10.0, 0.1_f64..10.0]) {
            let screen = screen_weights(edges.map(|e| e as f32));
            let shares = perspective_weights(screen, w.map(|w| (1.0 / w) as f32));
            let exact: Vec<f64> = (0..3).map(|k| edges[k] / w[k]).collect();
            let sum: f64 = exact.iter().sum();
            for k in 0..3 {
                // Nine roundings of at most 6e-8 each.
                prop_assert!((f64::from(shares[k]) - exact[k] / sum).abs() < 6e-7);
            }
        }
    }

    #[test]
    fn depth_at_a_corner_is_the_corners() {
        let z = [0.25, 0.5, 0.9375];
        for k in 0..3 {
            let edges = std::array::from_fn(|i| if i == k { 4096.0 } else { 0.0 });
            // The reciprocal may be 2 ulp off.
            assert!((depth(screen_weights(edges), z) - z[k]).abs() <= 2.0 * f32::EPSILON * (z[k] - z[0]));
        }
    }
}
