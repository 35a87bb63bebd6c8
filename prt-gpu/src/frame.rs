//! Local frames: three columns `[c0, c1, c2]`, world = `c0 x + c1 y + c2 z`.

pub(crate) const IDENTITY: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Largest error of a product of columns of a frame that is used as it is: what half floats and skinning leave.
const TOLERANCE: f32 = 2e-3;

/// A frame's vector in the world.
pub(crate) fn rotate(frame: &[[f32; 3]; 3], [x, y, z]: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| (frame[0][i] * x + frame[1][i] * y) + frame[2][i] * z)
}

/// A vector of the world in an orthonormal frame.
pub(crate) fn to_local(frame: &[[f32; 3]; 3], direction: [f32; 3]) -> [f32; 3] {
    frame.map(|column| dot(column, direction))
}

pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The unit vector of a direction, whatever its size; none for the zero vector, and for one that is not finite.
pub(crate) fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let largest = v.iter().fold(0.0, |largest: f32, x| largest.max(x.abs()));
    if !(largest >= f32::MIN_POSITIVE && v.iter().all(|x| x.is_finite())) {
        return None;
    }
    let scaled = v.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    Some(scaled.map(|x| x / length))
}

/// The frame of a relief's normal, in the world: z the normal, x the tangent made perpendicular to it, y = z × x.
///
/// - `frame`: orthonormal, of the surface below the relief
/// - `normal`: in that frame
pub(crate) fn relief_frame(frame: &[[f32; 3]; 3], normal: [f32; 3]) -> [[f32; 3]; 3] {
    let z = unit(normal).unwrap_or([0.0, 0.0, 1.0]);
    let x = orthogonal([1.0, 0.0, 0.0], z).unwrap_or([0.0, 0.0, -1.0]);
    [x, cross(z, x), z].map(|column| rotate(frame, column))
}

/// A unit vector orthogonal to a unit normal.
pub(crate) fn any_tangent(normal: [f32; 3]) -> [f32; 3] {
    let axis = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    orthogonal(axis, normal).unwrap_or([1.0, 0.0, 0.0])
}

/// The unit vector nearest to `v` that is orthogonal to the unit vector `normal`.
pub(crate) fn orthogonal(v: [f32; 3], normal: [f32; 3]) -> Option<[f32; 3]> {
    let v = unit(v)?;
    let along = dot(v, normal);
    let rest: [f32; 3] = std::array::from_fn(|i| v[i] - along * normal[i]);
    // Below this length the direction of what is left is rounding.
    if dot(rest, rest) > 1e-10 { unit(rest) } else { None }
}

/// The frame itself if it is orthonormal within 0.002; otherwise one that keeps the direction of `c2`, the plane of `c2` and `c0`
/// and the handedness as far as they exist: any tangent where `c0` is parallel to `c2` or zero, the identity where `c2` is zero or a
/// number is not finite.
#[inline]
pub(crate) fn orthonormal_or_replaced(frame: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    if is_orthonormal(frame) {
        return *frame;
    }
    orthonormalised(frame)
}

/// Gram and Schmidt's frame of a normal and a tangent, with the handedness of the columns; always finite and orthonormal.
pub(crate) fn orthonormalised(frame: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    if !frame.as_flattened().iter().all(|x| x.is_finite()) {
        return IDENTITY;
    }
    let Some(normal) = unit(frame[2]) else { return IDENTITY };
    let tangent = orthogonal(frame[0], normal).unwrap_or_else(|| any_tangent(normal));
    let bitangent = cross(normal, tangent);
    let is_mirrored = dot(bitangent, frame[1]) < 0.0;
    [tangent, if is_mirrored { bitangent.map(|x| -x) } else { bitangent }, normal]
}

#[inline]
fn is_orthonormal([a, b, c]: &[[f32; 3]; 3]) -> bool {
    let unit = [dot(*a, *a), dot(*b, *b), dot(*c, *c)];
    let zero = [dot(*a, *b), dot(*b, *c), dot(*c, *a)];
    // Written so that NaN is not near, and without branches.
    let is_near = |near, (product, exact): (f32, f32)| near & ((product - exact).abs() <= TOLERANCE);
    unit.map(|x| (x, 1.0)).into_iter().chain(zero.map(|x| (x, 0.0))).fold(true, is_near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -1.0_f32..1.0,
            1 => Just(0.0),
            1 => Just(f32::NAN),
            1 => Just(f32::INFINITY),
            1 => Just(1e-42),
            1 => Just(-3e38),
        ]
    }

    proptest! {
        #[test]
        fn every_input_gives_an_orthonormal_frame(numbers in prop::array::uniform3(prop::array::uniform3(number()))) {
            let frame = orthonormal_or_replaced(&numbers);
            prop_assert!(is_orthonormal(&frame), "{frame:?}");
        }
    }

    #[test]
    fn good_frames_stay_and_bad_ones_keep_what_they_can() {
        let mirrored = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(orthonormal_or_replaced(&mirrored), mirrored);
        let stretched = [[-2.0, 0.0, 0.5], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
        assert_eq!(orthonormal_or_replaced(&stretched), mirrored);
        let flat = [[0.0; 3], [0.0; 3], [0.0, 2.0, 0.0]];
        assert_eq!(orthonormal_or_replaced(&flat)[2], [0.0, 1.0, 0.0]);
        assert_eq!(orthonormal_or_replaced(&[[0.0; 3]; 3]), IDENTITY);
        assert_eq!(orthonormal_or_replaced(&[[1.0, 0.0, f32::NAN], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), IDENTITY);
    }
}
