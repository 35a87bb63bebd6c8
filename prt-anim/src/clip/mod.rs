//! Motions of a skeleton over time.

mod keys;

pub use keys::{Interpolation, Keys};

use crate::{Error, Pose};

/// What one channel of a [`Clip`] moves, and how.
#[derive(Debug, Clone, PartialEq)]
pub enum Track {
    /// Translation of the joint.
    Translation(Keys<3>),
    /// Rotation of the joint, `x y z w`.
    Rotation(Keys<4>),
    /// Scale of the joint.
    Scale(Keys<3>),
}

/// One property of one joint over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The number of the joint.
    pub joint: usize,
    /// Its values.
    pub track: Track,
}

/// What becomes of times outside a clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Playback {
    /// The clip starts again: time modulo duration.
    #[default]
    Loop,
    /// The clip holds its first and its last pose.
    Clamp,
}

/// A motion of a skeleton. What it has no channel for stays as it rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    name: Option<String>,
    channels: Vec<Channel>,
    duration: f64,
}

impl Clip {
    /// Puts channels together.
    ///
    /// - `joint_count`: of the skeleton that the clip is for
    ///
    /// # Errors
    /// If a channel moves a joint that is not there.
    pub fn new(name: Option<String>, channels: Vec<Channel>, joint_count: usize) -> Result<Self, Error> {
        if let Some(channel) = channels.iter().find(|channel| channel.joint >= joint_count) {
            let joint = channel.joint;
            return Err(Error::Clip(format!("a channel moves joint {joint}, but there are {joint_count}")));
        }
        let duration = channels.iter().map(|channel| channel.track.end()).fold(0.0, f64::max);
        Ok(Self { name, channels, duration })
    }

    /// Its name, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// All channels.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The time of the last key, seconds. Clips begin at time zero.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Moves the joints that the clip has channels for; the others stay as `pose` has them.
    ///
    /// - `time`: seconds; what is not a number plays as zero
    ///
    /// # Panics
    /// If the pose has fewer joints than the clip moves.
    pub fn sample(&self, time: f64, playback: Playback, pose: &mut Pose) {
        let time = self.time_within(time, playback);
        for channel in &self.channels {
            let local = &mut pose.locals[channel.joint];
            match &channel.track {
                Track::Translation(keys) => local.translation = keys.linear_at(time),
                Track::Rotation(keys) => local.rotation = keys.rotation_at(time),
                Track::Scale(keys) => local.scale = keys.linear_at(time),
            }
        }
    }

    fn time_within(&self, time: f64, playback: Playback) -> f64 {
        match playback {
            _ if !time.is_finite() || self.duration == 0.0 => 0.0,
            Playback::Loop => time.rem_euclid(self.duration),
            Playback::Clamp => time.clamp(0.0, self.duration),
        }
    }
}

impl Track {
    fn end(&self) -> f64 {
        match self {
            Self::Translation(keys) | Self::Scale(keys) => keys.end(),
            Self::Rotation(keys) => keys.end(),
        }
    }
}
