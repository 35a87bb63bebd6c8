// Linear radiance to display. The twin, and the source of the curve, is src/tone.rs.

const SHOULDER_START: f32 = 0.532;

// Keeps values up to the shoulder; above, approaches 1. Negative numbers give 0.
fn compress(x: vec3<f32>) -> vec3<f32> {
    let range = 1.0 - SHOULDER_START;
    let positive = max(x, vec3(0.0));
    let shoulder = 1.0 - range * exp(-(positive - SHOULDER_START) / range);
    return select(shoulder, positive, positive <= vec3(SHOULDER_START));
}

fn encode_srgb(x: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3(0.0031308));
}
