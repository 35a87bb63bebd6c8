//! The maps and their Jacobians, in one pass each.

use glam::{DMat3, DVec3};

/// `a bᵀ`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// `sin(x) / x`.
fn sinc(x: f64) -> f64 {
    // Below this the next term of the series, x² / 6, is less than half a unit in the last place.
    if x.abs() < 1e-8 { 1.0 } else { x.sin() / x }
}

/// `s' = sin(κs)/κ − d sin κs`, `d' = (1 − cos κs)/κ + d cos κs`; differences to `s` and `d`, so that `κ = 0` changes no bit.
pub(super) fn bend(p: DVec3, origin: DVec3, along: DVec3, toward: DVec3, curvature: f64) -> (DVec3, DMat3) {
    let (s, d) = ((p - origin).dot(along), (p - origin).dot(toward));
    let angle = curvature * s;
    let (sin, cos) = angle.sin_cos();
    let half = sinc(0.5 * angle);
    // sin(κs)/κ = s sinc(κs), (1 − cos κs)/κ = s (κs/2) sinc²(κs/2), 1 − cos κs = 2 sin²(κs/2).
    let versine = 2.0 * (0.5 * angle).sin().powi(2);
    let s_change = s * (sinc(angle) - 1.0) - d * sin;
    let d_change = s * (0.5 * angle) * half * half - d * versine;
    let point = p + along * s_change + toward * d_change;
    // ∂s'/∂s = (1 − κd) cos κs, ∂s'/∂d = −sin κs, ∂d'/∂s = (1 − κd) sin κs, ∂d'/∂d = cos κs.
    let stretch = 1.0 - curvature * d;
    let by_s = along * (stretch * cos - 1.0) + toward * (stretch * sin);
    let by_d = toward * -versine - along * sin;
    (point, DMat3::IDENTITY + outer(by_s, along) + outer(by_d, toward))
}

/// Rotation of the part across the axis by `φ = rate · s`.
pub(super) fn twist(p: DVec3, origin: DVec3, along: DVec3, rate: f64) -> (DVec3, DMat3) {
    let offset = p - origin;
    let s = offset.dot(along);
    let across = offset - along * s;
    let side = along.cross(across);
    let (sin, cos) = (rate * s).sin_cos();
    let versine = 2.0 * (0.5 * rate * s).sin().powi(2);
    let point = p - across * versine + side * sin;
    // R(φ) on the plane across the axis, and rate · ∂/∂φ along it.
    let cross = DMat3::from_cols(along.cross(DVec3::X), along.cross(DVec3::Y), along.cross(DVec3::Z));
    let turned = DMat3::IDENTITY - (DMat3::IDENTITY - outer(along, along)) * versine + cross * sin;
    let by_s = (side * cos - across * sin) * rate;
    (point, turned + outer(by_s, along))
}

/// `p + toward · amplitude · sin(wave_number · s − phase)`.
pub(super) fn wave(
    p: DVec3,
    origin: DVec3,
    along: DVec3,
    toward: DVec3,
    [amplitude, wave_number, phase]: [f64; 3],
) -> (DVec3, DMat3) {
    let (sin, cos) = (wave_number * (p - origin).dot(along) - phase).sin_cos();
    let slope = amplitude * wave_number * cos;
    (p + toward * (amplitude * sin), DMat3::IDENTITY + outer(toward * slope, along))
}

/// The part across the axis scaled by `exp(rate · s)`.
pub(super) fn taper(p: DVec3, origin: DVec3, along: DVec3, rate: f64) -> (DVec3, DMat3) {
    let offset = p - origin;
    let s = offset.dot(along);
    let across = offset - along * s;
    let growth = (rate * s).exp_m1();
    let jacobian = DMat3::IDENTITY + (DMat3::IDENTITY - outer(along, along)) * growth;
    (p + across * growth, jacobian + outer(across * (rate * (1.0 + growth)), along))
}
