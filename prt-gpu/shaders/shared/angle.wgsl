// Angles from polynomials, for the atan2 of a GPU may be 4096 ulp off. The twin is src/angle.rs.

const HALF_PI: f32 = 1.57079632679;
const TURN: f32 = 6.28318530718;

// Arc tangent for -1 <= x <= 1.
fn atan_unit(x: f32) -> f32 {
    let t = x * x;
    var p = 0.0028662257;
    p = p * t - 0.0161657367;
    p = p * t + 0.0429096138;
    p = p * t - 0.0752896400;
    p = p * t + 0.1065626393;
    p = p * t - 0.1420889944;
    p = p * t + 0.1999355085;
    p = p * t - 0.3333314528;
    return x * (p * t + 1.0);
}

// The angle of the point (x, y) from the x axis as a share of a full turn; 0 for the origin.
fn turn(y: f32, x: f32) -> f32 {
    let width = abs(x);
    let height = abs(y);
    let slope = min(width, height) / max(max(width, height), 1.17549435e-38);
    var angle = atan_unit(slope);
    angle = select(angle, HALF_PI - angle, height > width);
    angle = select(angle, 2.0 * HALF_PI - angle, x < 0.0);
    angle = select(angle, TURN - angle, y < 0.0);
    return angle / TURN;
}
