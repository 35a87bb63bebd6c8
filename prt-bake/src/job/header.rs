//! What a journal is for: which mesh, which settings, which part.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sh_core::Order;

use super::Part;
use super::block::TEXELS;
use super::blocks::Blocks;
use super::journal::{Journal, Key};
use crate::{BakeOptions, Error, Mesh, TexelOptions};

/// Pass under which a journal keeps what is not of a block.
const ABOUT: u32 = u32::MAX;
const HEADER: Key = Key { pass: ABOUT, block: 0 };
/// A baked file without transfer, or an atlas without: the surface, so that parts can be merged where the scene is not.
pub(super) const SURFACE: Key = Key { pass: ABOUT, block: 1 };
/// Appended when all of a part is done.
pub(super) const DONE: Key = Key { pass: ABOUT, block: 2 };

/// What two runs must have in common to share their blocks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    /// Version of the program: another one may trace otherwise.
    generator: String,
    /// SHA-256 of the mesh, in hexadecimal.
    mesh: String,
    pub(super) settings: Settings,
    pub(super) vertex_count: usize,
    /// Of the transfer: 3 if light is reflected and a surface reflects its colours differently, else 1.
    pub(super) channels: usize,
    /// Number and count.
    part: (u32, u32),
    /// The atlas, if texels are baked in place of vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) texels: Option<TexelSettings>,
}

/// What decides the bytes of an atlas beside the options of its bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct TexelSettings {
    /// Texels that a point of the surface is baked for.
    texel_count: usize,
    width: usize,
    height: usize,
    gutter: usize,
    v_up: bool,
}

/// The options that decide what a bake's bytes are: all but the number of threads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Settings {
    order: usize,
    rays_per_vertex: usize,
    target_error: Option<f64>,
    shadowed: bool,
    bounces: usize,
    bounce_threshold: Option<f64>,
    inside: String,
    keep_shadowed: bool,
    seed: u64,
}

impl Key {
    /// Whether the record is of a block, and not about the bake as a whole.
    pub(super) fn is_of_block(self) -> bool {
        self.pass != ABOUT
    }
}

impl Settings {
    pub(super) fn of(options: &BakeOptions) -> Self {
        // Without `..`: an option that is added must be thought of here.
        let BakeOptions {
            order,
            rays_per_vertex,
            target_error,
            shadowed,
            bounces,
            bounce_threshold,
            inside,
            keep_shadowed,
            seed,
            threads: _,
        } = *options;
        let (order, inside) = (order.get(), inside.to_string());
        Self { order, rays_per_vertex, target_error, shadowed, bounces, bounce_threshold, inside, keep_shadowed, seed }
    }

    pub(super) fn options(&self, threads: Option<usize>) -> Result<BakeOptions, Error> {
        let options = BakeOptions {
            order: Order::new(self.order).map_err(|error| Error::Option(error.to_string()))?,
            rays_per_vertex: self.rays_per_vertex,
            target_error: self.target_error,
            shadowed: self.shadowed,
            bounces: self.bounces,
            bounce_threshold: self.bounce_threshold,
            inside: self.inside.parse()?,
            keep_shadowed: self.keep_shadowed,
            seed: self.seed,
            threads,
        };
        options.validate()?;
        Ok(options)
    }
}

impl Header {
    pub(super) fn new(mesh: &Mesh, options: &BakeOptions, part: Part) -> Self {
        Self {
            generator: concat!("prt-bake ", env!("CARGO_PKG_VERSION")).to_owned(),
            mesh: mesh.content_hash(),
            settings: Settings::of(options),
            vertex_count: mesh.positions().len(),
            channels: options.channel_count(mesh),
            part: (part.number(), part.count()),
            texels: None,
        }
    }

    /// For the vertices whose light the texels of this bake gather.
    pub(super) fn of_gathered(&self, options: &BakeOptions, mesh: &Mesh) -> Self {
        let (settings, channels) = (Settings::of(options), options.channel_count(mesh));
        Self { settings, channels, texels: None, ..self.whole() }
    }

    /// The same for an atlas with so many texels that are baked.
    pub(super) fn with_texels(self, texels: &TexelOptions, texel_count: usize) -> Self {
        // Without `..`, as above.
        let TexelOptions { width, height, gutter, v_up } = *texels;
        Self { texels: Some(TexelSettings { texel_count, width, height, gutter, v_up }), ..self }
    }

    /// SHA-256 of all that decides the bytes of the result, in hexadecimal. All parts of a bake share it.
    pub(super) fn identity(&self) -> String {
        crate::hash::hex(serde_json::json!(self.whole()).to_string().as_bytes())
    }

    /// The same bake as one whole.
    pub(super) fn whole(&self) -> Self {
        Self { part: (1, 1), ..self.clone() }
    }

    /// The blocks that parts share: of texels, or of vertices.
    pub(super) fn blocks(&self) -> Blocks {
        Blocks::of(self.shared_count(), self.settings.rays_per_vertex)
    }

    /// Texels, or vertices, of all parts together.
    pub(super) fn shared_count(&self) -> usize {
        self.texels.map_or(self.vertex_count, |texels| texels.texel_count)
    }

    /// The pass under which the transfer of what parts share is kept first.
    pub(super) fn shared_pass(&self) -> usize {
        if self.texels.is_some() { TEXELS } else { 0 }
    }

    /// Whether a record is of what parts share.
    pub(super) fn shares(&self, key: Key) -> bool {
        key.is_of_block() && (self.texels.is_none() || key.is_of_texels())
    }

    /// The blocks of vertices whose light texels gather, if they do.
    pub(super) fn gathered_blocks(&self) -> Option<Blocks> {
        let gathers = self.texels.is_some() && self.settings.bounces > 0;
        gathers.then(|| Blocks::of(self.vertex_count, self.settings.rays_per_vertex))
    }

    /// The atlas, if texels are baked.
    pub(super) fn texel_options(&self) -> Option<TexelOptions> {
        self.texels.map(|TexelSettings { width, height, gutter, v_up, .. }| TexelOptions {
            width,
            height,
            gutter,
            v_up,
        })
    }

    /// Of an atlas, in texels.
    pub(super) fn gutter(&self) -> usize {
        self.texels.map_or(0, |texels| texels.gutter)
    }

    /// Whether rays are traced: not if transfer follows from the normals.
    pub(super) fn is_traced(&self) -> bool {
        self.settings.shadowed
    }

    /// Whether a journal has all that is traced for a block.
    pub(super) fn has_block(&self, journal: &Journal, block: u32) -> bool {
        match self.texels {
            Some(_) => journal.has_texels(block),
            None => journal.has_block(block, self.settings.bounces > 0),
        }
    }

    pub(super) fn part(&self) -> Result<Part, Error> {
        Part::new(self.part.0, self.part.1)
    }

    /// Whether a journal is the file of this very part, and has all of it.
    pub(super) fn is_complete_in(&self, journal: &Journal) -> bool {
        let blocks = self.blocks();
        let has_all = |part: Part| part.blocks(blocks.count()).all(|block| self.has_block(journal, block));
        journal.contains(DONE) && journal.contains(SURFACE) && self.part().is_ok_and(has_all)
    }

    /// Names and values of the options, for people.
    pub(super) fn settings_by_name(&self) -> BTreeMap<String, String> {
        let options = serde_json::json!({ "settings": self.settings, "texels": self.texels });
        let entries = flattened(options.as_object().cloned().unwrap_or_default());
        entries
            .into_iter()
            .filter(|(_, value)| !value.is_null())
            .map(|(name, value)| (name, value.as_str().map_or(value.to_string(), str::to_owned)))
            .collect()
    }

    pub(super) fn append_to(&self, journal: &Journal) -> Result<(), Error> {
        journal.append(HEADER, serde_json::json!(self).to_string().as_bytes())
    }

    /// The header of a journal; `None` if its program was killed before it wrote anything.
    ///
    /// # Errors
    /// If it cannot be read, or is damaged: then what the journal is for cannot be known.
    pub(super) fn read(journal: &Journal) -> Result<Option<Self>, Error> {
        if !journal.contains(HEADER) {
            let is_damaged = !journal.keys().is_empty();
            return if is_damaged {
                Err(journal.malformed("its first record is damaged".to_owned()))
            } else {
                Ok(None)
            };
        }
        let mut bytes = Vec::new();
        journal.read(HEADER, &mut bytes)?;
        let header: Self =
            serde_json::from_slice(&bytes).map_err(|error| journal.malformed(format!("its header: {error}")))?;
        let count = header.vertex_count.max(header.shared_count());
        if u32::try_from(count).is_err() || ![1, 3].contains(&header.channels) {
            let channels = header.channels;
            return Err(journal.malformed(format!("its header claims {count} points of {channels} channels")));
        }
        Ok(Some(header))
    }

    /// Says how another header differs; `None` if it does not.
    pub(super) fn difference(&self, other: &Self) -> Option<String> {
        if self.texels.is_some() != other.texels.is_some() {
            let [there, here] = [other, self].map(|header| if header.texels.is_some() { "texels" } else { "vertices" });
            return Some(format!("{there} are baked there, but {here} now"));
        }
        let [serde_json::Value::Object(own), serde_json::Value::Object(others)] =
            [self, other].map(|header| serde_json::json!(header))
        else {
            return None;
        };
        let (flat, other_flat) = (flattened(own), flattened(others));
        let differing = flat.iter().zip(&other_flat).find(|(a, b)| a != b)?;
        let ((name, value), (_, other)) = differing;
        Some(match name.as_str() {
            "mesh" => "the mesh is another one".to_owned(),
            _ => format!("{} is {other} there, but {value} now", name.replace('_', " ")),
        })
    }
}

/// All entries, those of the settings and of the atlas too, by name.
fn flattened(map: serde_json::Map<String, serde_json::Value>) -> Vec<(String, serde_json::Value)> {
    let entries = map.into_iter().flat_map(|(name, value)| match value {
        serde_json::Value::Object(inner) => inner.into_iter().collect::<Vec<_>>(),
        value => vec![(name, value)],
    });
    entries.collect()
}
