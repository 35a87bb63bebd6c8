//! Values at given times, and what lies between them (glTF 2.0, section 3.11 and appendix C).

use glam::DQuat;

use crate::Error;
use crate::pose::unit_quaternion;

/// How values between two keys are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// The earlier key's value.
    Step,
    /// The straight line between both; the shorter great arc for rotations.
    #[default]
    Linear,
    /// The cubic with given tangents; each key has three values: in-tangent, value, out-tangent.
    CubicSpline,
}

/// Quaternions closer than this (in the cosine of half the angle) are interpolated along the chord: the quotient of sines loses
/// its digits, and the chord differs from the arc by less than 1e-12.
const NEARLY_EQUAL: f64 = 1.0 - 1e-9;

/// Values with `N` components at increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Keys<const N: usize> {
    times: Vec<f32>,
    values: Vec<[f32; N]>,
    interpolation: Interpolation,
}

/// Where a time lies.
enum Place {
    /// At a key, or outside all of them.
    At(usize),
    /// After a key, by a fraction `t` of the seconds `length` to the next one.
    After { key: usize, t: f64, length: f64 },
}

impl<const N: usize> Keys<N> {
    /// Checks the keys.
    ///
    /// - `times`: `[K]`, seconds, not decreasing
    /// - `values`: `[K]`, or `[3K]` for [`Interpolation::CubicSpline`]
    ///
    /// # Errors
    /// If there are no keys, the counts do not fit, times decrease, or something is not finite.
    pub fn new(times: Vec<f32>, values: Vec<[f32; N]>, interpolation: Interpolation) -> Result<Self, Error> {
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let (keys, given) = (times.len(), values.len());
        if keys == 0 || keys.checked_mul(per_key) != Some(given) {
            return Err(Error::Clip(format!("{keys} times have {given} values; {per_key} for each time are needed")));
        }
        if let Some(key) = times.iter().position(|time| !time.is_finite() || *time < 0.0) {
            return Err(Error::Clip(format!("key {key} is at time {}", times[key])));
        }
        if let Some(key) = times.windows(2).position(|pair| pair[0] > pair[1]) {
            return Err(Error::Clip(format!("key {} is earlier than key {key}", key + 1)));
        }
        if let Some(value) = values.iter().position(|value| !value.iter().all(|part| part.is_finite())) {
            return Err(Error::Clip(format!("key {} has a value that is not finite", value / per_key)));
        }
        Ok(Self { times, values, interpolation })
    }

    /// Times, seconds.
    #[must_use]
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    /// Values as they were given.
    #[must_use]
    pub fn values(&self) -> &[[f32; N]] {
        &self.values
    }

    /// How values between two keys are found.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    pub(super) fn end(&self) -> f64 {
        self.times.last().map_or(0.0, |&time| f64::from(time))
    }

    /// The value at a time, components interpolated one by one.
    pub(super) fn linear_at(&self, time: f64) -> [f64; N] {
        match self.place(time) {
            Place::At(key) => self.value(key),
            Place::After { key, .. } if self.interpolation == Interpolation::Step => self.value(key),
            Place::After { key, t, .. } if self.interpolation == Interpolation::Linear => {
                let (from, to) = (self.value(key), self.value(key + 1));
                std::array::from_fn(|i| from[i] + t * (to[i] - from[i]))
            }
            Place::After { key, t, length } => self.cubic(key, t, length),
        }
    }

    /// `(2t³ − 3t² + 1) v_k + (t³ − 2t² + t) d b_k + (3t² − 2t³) v_{k+1} + (t³ − t²) d a_{k+1}` with in-tangents `a` and
    /// out-tangents `b` (glTF 2.0, appendix C.5).
    fn cubic(&self, key: usize, t: f64, d: f64) -> [f64; N] {
        let (t2, t3) = (t * t, t * t * t);
        let [from, out_tangent] = [3 * key + 1, 3 * key + 2].map(|i| self.values[i].map(f64::from));
        let [in_tangent, to] = [3 * key + 3, 3 * key + 4].map(|i| self.values[i].map(f64::from));
        std::array::from_fn(|i| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * from[i]
                + (t3 - 2.0 * t2 + t) * d * out_tangent[i]
                + (3.0 * t2 - 2.0 * t3) * to[i]
                + (t3 - t2) * d * in_tangent[i]
        })
    }

    fn value(&self, key: usize) -> [f64; N] {
        let index = if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key };
        self.values[index].map(f64::from)
    }

    fn place(&self, time: f64) -> Place {
        let after = self.times.partition_point(|&key| f64::from(key) <= time);
        let Some(key) = after.checked_sub(1) else { return Place::At(0) };
        if after == self.times.len() {
            return Place::At(key);
        }
        let [from, to] = [self.times[key], self.times[after]].map(f64::from);
        Place::After { key, t: (time - from) / (to - from), length: to - from }
    }
}

impl Keys<4> {
    /// The unit quaternion at a time.
    pub(super) fn rotation_at(&self, time: f64) -> [f64; 4] {
        match self.place(time) {
            Place::After { key, t, .. } if self.interpolation == Interpolation::Linear => {
                slerp(unit_quaternion(self.value(key)), unit_quaternion(self.value(key + 1)), t).to_array()
            }
            _ => unit_quaternion(self.linear_at(time)).to_array(),
        }
    }
}

/// `sin(α (1 − t)) / sin α · a + sin(α t) / sin α · b` along the shorter arc (glTF 2.0, appendix C.4).
fn slerp(a: DQuat, b: DQuat, t: f64) -> DQuat {
    let cosine = a.dot(b);
    let (b, cosine) = if cosine < 0.0 { (-b, -cosine) } else { (b, cosine) };
    if cosine > NEARLY_EQUAL {
        return (a * (1.0 - t) + b * t).normalize();
    }
    let angle = cosine.acos();
    (a * (angle * (1.0 - t)).sin() + b * (angle * t).sin()).normalize()
}
