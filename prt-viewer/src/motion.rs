//! How a model moves: by deformation, or as an actor whose skeleton plays a clip.

use std::path::{Path, PathBuf};

use anyhow::Context;
use prt_anim::{Clip, Deformation, Deformed, Playback, Skeleton, Skin, load_character, push_tangent_frames};
use prt_bake::Geometry;

use crate::arguments;
use crate::model::Model;

/// Waves along the longest side of a model.
const WAVES: f64 = 2.0;

/// The pose of a model at one moment. Zero everywhere is the pose that was baked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Motion {
    /// Degrees that the longest side is bent by.
    pub(crate) bend: f32,
    /// Degrees from end to end of the longest side.
    pub(crate) twist: f32,
    /// Amplitude of a wave along the longest side, as a part of it.
    pub(crate) wave: f32,
    /// Degrees by which the wave has travelled.
    pub(crate) phase: f32,
    /// The number of a clip, and the time in it, seconds.
    pub(crate) clip: Option<(usize, f32)>,
}

/// The pose of a model, on the command line.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Deformation")]
pub(crate) struct MotionArguments {
    /// Bend the longest side into an arc
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = arguments::degrees, allow_hyphen_values = true)]
    bend: f32,
    /// Twist the longest side, from end to end
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = arguments::degrees, allow_hyphen_values = true)]
    twist: f32,
    /// Two waves along the longest side, this part of it high
    #[arg(long, value_name = "AMPLITUDE", default_value = "0", value_parser = arguments::amplitude, allow_hyphen_values = true)]
    wave: f32,
    /// How far the waves have travelled
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = arguments::degrees, allow_hyphen_values = true)]
    phase: f32,
    /// The .glb or .gltf that the file was baked from: its skeleton moves the model
    #[arg(long, value_name = "FILE")]
    character: Option<PathBuf>,
    /// The clip to play, by name or number
    #[arg(long, value_name = "CLIP", requires = "character")]
    clip: Option<String>,
    /// The time in the clip
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = arguments::seconds, requires = "clip")]
    time: f32,
}

impl MotionArguments {
    /// Gives a model the character that moves it; returns the pose that was asked for.
    ///
    /// # Errors
    /// If the character cannot be read, does not fit, or has no such clip.
    pub(crate) fn apply(&self, model: &mut Model) -> anyhow::Result<Motion> {
        if let Some(path) = &self.character {
            model.actor = Some(Actor::load(path, model.geometry())?);
        }
        let clip = match (&self.clip, &model.actor) {
            (Some(name), Some(actor)) => Some((actor.find_clip(name)?, self.time)),
            _ => None,
        };
        Ok(Motion { bend: self.bend, twist: self.twist, wave: self.wave, phase: self.phase, clip })
    }
}

/// What moves a character.
#[derive(Debug)]
pub(crate) struct Actor {
    pub(crate) skeleton: Skeleton,
    pub(crate) skin: Skin,
    pub(crate) clips: Vec<Clip>,
}

impl Actor {
    /// Reads a character and binds a baked surface to it.
    ///
    /// # Errors
    /// If the file cannot be read or has vertices elsewhere than the surface.
    pub(crate) fn load(path: &Path, geometry: &Geometry) -> anyhow::Result<Self> {
        let character = load_character(path)?;
        let binding = character
            .mesh
            .bind_to(&geometry.positions, &geometry.normals)
            .with_context(|| format!("{} is not what the surface was baked from", path.display()))?;
        Ok(Self { skeleton: character.skeleton, skin: binding.skin, clips: character.clips })
    }

    /// As it is shown in lists.
    pub(crate) fn clip_name(&self, clip: usize) -> String {
        self.clips[clip].name().map_or_else(|| format!("clip {clip}"), str::to_owned)
    }

    fn find_clip(&self, name: &str) -> anyhow::Result<usize> {
        let by_name = self.clips.iter().position(|clip| clip.name() == Some(name));
        let by_number = || name.parse().ok().filter(|&clip: &usize| clip < self.clips.len());
        by_name.or_else(by_number).with_context(|| {
            let names: Vec<String> = (0..self.clips.len()).map(|clip| self.clip_name(clip)).collect();
            format!("there is no clip {name}; the clips are {}", names.join(", "))
        })
    }

    fn deform(&self, clip: Option<(usize, f32)>, out: &mut Deformed) {
        let mut pose = self.skeleton.rest_pose();
        if let Some((clip, time)) = clip {
            self.clips[clip].sample(f64::from(time), Playback::Loop, &mut pose);
        }
        self.skin.deform(&self.skeleton, &pose, out);
    }
}

impl Motion {
    /// Positions, normals, and rotations from the rest pose, of all vertices: first the clip, then the deformations.
    pub(crate) fn pose(&self, geometry: &Geometry, actor: Option<&Actor>) -> Deformed {
        let mut posed = Deformed::default();
        match actor.filter(|_| self.clip.is_some()) {
            Some(actor) => actor.deform(self.clip, &mut posed),
            None => Deformation::Chain(Vec::new()).deform(&geometry.positions, &geometry.normals, &mut posed),
        }
        if let Some(deformation) = self.deformation(geometry) {
            let rotations = std::mem::take(&mut posed.frames);
            let mut deformed = Deformed::default();
            deformation.deform(&posed.positions, &posed.normals, &mut deformed);
            posed.frames.resize(rotations.len(), [[0.0; 3]; 3]);
            push_tangent_frames(&deformed.frames, &rotations, &mut posed.frames);
            (posed.positions, posed.normals) = (deformed.positions, deformed.normals);
        }
        posed
    }

    /// The deformation of space, by the bounds of the rest pose.
    pub(crate) fn deformation(&self, geometry: &Geometry) -> Option<Deformation> {
        let bounds = bounds(&geometry.positions);
        let angle = |degrees: f32| f64::from(degrees).to_radians();
        let steps = [
            (self.twist, Deformation::twist(bounds, angle(self.twist))),
            (self.wave, Deformation::wave(bounds, f64::from(self.wave), WAVES, angle(self.phase))),
            (self.bend, Deformation::bend(bounds, angle(self.bend))),
        ];
        let steps: Vec<Deformation> = steps.into_iter().filter(|(by, _)| *by != 0.0).map(|(_, step)| step).collect();
        (!steps.is_empty()).then_some(Deformation::Chain(steps))
    }
}

/// Lower and upper corner of the box around points.
fn bounds(positions: &[[f32; 3]]) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for position in positions {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(f64::from(position[axis]));
            bounds[1][axis] = bounds[1][axis].max(f64::from(position[axis]));
        }
    }
    bounds
}
