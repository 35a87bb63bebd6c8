//! Animations.

use gltf::json::animation::{self, Animation, Property};
use gltf::json::validation::Checked;

use super::LoadReport;
use super::accessor::Accessor;
use super::document::Document;
use super::fault::Fault;
use crate::{Channel, Clip, Interpolation, Keys, Track};

/// Values that clips may always have, whatever little data their channels share.
const MIN_LIMIT: usize = 1 << 22;

/// All animations as clips.
pub(super) fn clips(document: &Document<'_>, report: &mut LoadReport) -> Result<Vec<Clip>, Fault> {
    let mut reader = Reader { document, report, budget: MIN_LIMIT.saturating_add(document.data_bytes()) };
    document.root.animations.iter().enumerate().map(|(index, animation)| reader.clip(index, animation)).collect()
}

struct Reader<'a> {
    document: &'a Document<'a>,
    report: &'a mut LoadReport,
    /// Values that may still be read: channels may share arrays, so the file's size alone does not bound them.
    budget: usize,
}

impl Reader<'_> {
    fn clip(&mut self, index: usize, animation: &Animation) -> Result<Clip, Fault> {
        let mut channels = Vec::new();
        for (number, channel) in animation.channels.iter().enumerate() {
            let place = |fault| match fault {
                Fault::Malformed(reason) => Fault::Malformed(format!("animation {index}, channel {number}: {reason}")),
                other => other,
            };
            if let Some(track) = self.track(animation, channel).map_err(place)? {
                self.document.get(channel.target.node, "node").map_err(place)?;
                channels.push(Channel { joint: channel.target.node.value(), track });
            }
        }
        let name = animation.name.clone().filter(|name| !name.is_empty());
        Clip::new(name, channels, self.document.root.nodes.len()).map_err(|error| Fault::inconsistent(&error))
    }

    /// `None` for weights of morph targets.
    fn track(&mut self, animation: &Animation, channel: &animation::Channel) -> Result<Option<Track>, Fault> {
        let sampler = channel.sampler.value();
        let sampler = animation
            .samplers
            .get(sampler)
            .ok_or_else(|| Fault::malformed(format!("it refers to sampler {sampler}, which is not there")))?;
        Ok(Some(match channel.target.path {
            Checked::Valid(Property::Translation) => Track::Translation(self.keys(sampler)?),
            Checked::Valid(Property::Rotation) => Track::Rotation(self.keys(sampler)?),
            Checked::Valid(Property::Scale) => Track::Scale(self.keys(sampler)?),
            Checked::Valid(Property::MorphTargetWeights) => {
                self.report.morph_channels += 1;
                return Ok(None);
            }
            Checked::Invalid => return Err(Fault::malformed("it moves an unknown property")),
        }))
    }

    fn keys<const N: usize>(&mut self, sampler: &animation::Sampler) -> Result<Keys<N>, Fault> {
        let times = Accessor::new(self.document, sampler.input, &[1])?;
        let values = Accessor::new(self.document, sampler.output, &[N])?;
        if !times.is_float() {
            return Err(Fault::malformed("its times are not floating-point numbers"));
        }
        let interpolation = match sampler.interpolation {
            Checked::Valid(animation::Interpolation::Step) => Interpolation::Step,
            Checked::Valid(animation::Interpolation::Linear) => Interpolation::Linear,
            Checked::Valid(animation::Interpolation::CubicSpline) => Interpolation::CubicSpline,
            Checked::Invalid => return Err(Fault::malformed("it has an unknown interpolation")),
        };
        self.spend(times.count() + values.count())?;
        let times = (0..times.count()).map(|i| times.get::<1>(i)[0] as f32).collect();
        let values = (0..values.count()).map(|i| values.get::<N>(i).map(|value| value as f32)).collect();
        Keys::new(times, values, interpolation).map_err(|error| Fault::inconsistent(&error))
    }

    fn spend(&mut self, count: usize) -> Result<(), Fault> {
        self.budget = self.budget.checked_sub(count).ok_or_else(|| {
            Fault::unsupported("clips whose channels share their data to many times the file's size are")
        })?;
        Ok(())
    }
}
