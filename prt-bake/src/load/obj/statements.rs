//! The statements of an OBJ file, with every index resolved and checked.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::str::SplitAsciiWhitespace;

use super::material::{self, Library};
use super::texture::Textures;
use crate::SurfaceMaterial;
use crate::input::Fault;
use crate::load::text::{excerpt, number, numbers};

/// A number in place of an index or material that is not given.
pub(super) const NONE: u32 = u32::MAX;

/// One corner of a face: indices from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// Everything of an OBJ file that makes up its surface.
#[derive(Debug, Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<[f64; 3]>,
    /// As long as `positions`, or empty when no vertex has a colour; NaN where one has none.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// Each material that is used and known.
    pub(super) materials: Vec<SurfaceMaterial>,
    /// Names of objects and groups that have faces; empty if the file names none.
    pub(super) parts: Vec<String>,
    /// What is left out.
    pub(super) warnings: Vec<String>,
}

/// A run of `Statements::corners`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub(super) corner_count: u32,
    /// Index into `Statements::materials` or [`NONE`].
    pub(super) material: u32,
    /// Index into `Statements::parts`; meaningless if that is empty.
    pub(super) part: u32,
    line: usize,
}

/// Reads all statements. Unknown ones are skipped.
pub(super) fn read(text: &str, folder: &Path) -> Result<Statements, Fault> {
    let mut reader = Reader::new(folder);
    let mut lines = text.lines().enumerate();
    while let Some((index, first)) = lines.next() {
        let mut line = Cow::Borrowed(first);
        while line.ends_with('\\') {
            let Some((_, more)) = lines.next() else { break };
            let joined = line.to_mut();
            joined.pop();
            joined.push(' ');
            joined.push_str(more);
        }
        reader.statement(&line, index + 1)?;
    }
    reader.finish()
}

struct Reader<'a> {
    folder: &'a Path,
    out: Statements,
    /// Materials by name, from the libraries read so far.
    library: Library,
    textures: Textures,
    /// Indices into `out.materials` by name.
    used: HashMap<String, u32>,
    material: u32,
    object: String,
    group: String,
    /// Indices into `out.parts` by the names of object and group.
    parts: HashMap<(String, String), u32>,
    /// Of the object and group that faces belong to now, if one of these had a face already.
    part: Option<u32>,
}

impl<'a> Reader<'a> {
    fn new(folder: &'a Path) -> Self {
        Self {
            folder,
            out: Statements::default(),
            library: Library::new(),
            textures: Textures::default(),
            used: HashMap::new(),
            material: NONE,
            object: String::new(),
            group: String::new(),
            parts: HashMap::new(),
            part: None,
        }
    }

    fn statement(&mut self, line: &str, number: usize) -> Result<(), Fault> {
        // `#` begins a comment anywhere but in names of files and materials.
        let code = line.split('#').next().unwrap_or_default();
        let mut words = code.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.position(words, number),
            Some("vt") => self.uv(words, number),
            Some("vn") => self.normal(words, number),
            Some("f" | "fo") => self.face(words, number),
            Some("mtllib") => material::read_libraries(argument(line), self.folder, &mut self.library),
            Some("usemtl") => {
                self.use_material(argument(line));
                Ok(())
            }
            Some("o") => {
                (self.object, self.group, self.part) = (argument(line).to_owned(), String::new(), None);
                Ok(())
            }
            Some("g") => {
                (self.group, self.part) = (argument(line).to_owned(), None);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// `v x y z`, `v x y z w` (the weight means nothing on polygons) or `v x y z r g b`.
    fn position(&mut self, mut words: SplitAsciiWhitespace<'_>, line: usize) -> Result<(), Fault> {
        self.out.positions.push(numbers(&mut words, line)?);
        let mut extra = [0.0; 3];
        let mut given = 0;
        for (slot, word) in extra.iter_mut().zip(words) {
            *slot = number(word, line)?;
            given += 1;
        }
        if given == 3 {
            self.out.colors.resize(self.out.positions.len() - 1, [f32::NAN; 3]);
            self.out.colors.push(extra.map(|value| value as f32));
        }
        Ok(())
    }

    /// `vt u`, `vt u v` or `vt u v w`.
    fn uv(&mut self, mut words: SplitAsciiWhitespace<'_>, line: usize) -> Result<(), Fault> {
        let [u] = numbers(&mut words, line)?;
        let v = words.next().map_or(Ok(0.0), |word| number(word, line))?;
        self.out.uvs.push([u as f32, v as f32]);
        Ok(())
    }

    fn normal(&mut self, mut words: SplitAsciiWhitespace<'_>, line: usize) -> Result<(), Fault> {
        self.out.normals.push(numbers(&mut words, line)?.map(|value: f64| value as f32));
        Ok(())
    }

    fn face(&mut self, words: SplitAsciiWhitespace<'_>, line: usize) -> Result<(), Fault> {
        let before = self.out.corners.len();
        for word in words {
            let corner = self.corner(word, line)?;
            self.out.corners.push(corner);
        }
        let corner_count = (self.out.corners.len() - before) as u32;
        let part = self.part();
        self.out.faces.push(Face { corner_count, material: self.material, part, line });
        Ok(())
    }

    /// The part that a face belongs to now.
    fn part(&mut self) -> u32 {
        if let Some(part) = self.part {
            return part;
        }
        let next = self.parts.len() as u32;
        let part = *self.parts.entry((self.object.clone(), self.group.clone())).or_insert(next);
        if part == next {
            let separator = if self.object.is_empty() || self.group.is_empty() { "" } else { "/" };
            self.out.parts.push(format!("{}{separator}{}", self.object, self.group));
        }
        self.part = Some(part);
        part
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str, line: usize) -> Result<Corner, Fault> {
        let mut parts = word.split('/');
        let mut index = |count: usize| match parts.next() {
            None | Some("") => Ok(NONE),
            Some(part) => resolve(part, count, line),
        };
        let corner = Corner {
            position: index(self.out.positions.len())?,
            uv: index(self.out.uvs.len())?,
            normal: index(self.out.normals.len())?,
        };
        if corner.position == NONE || parts.next().is_some() {
            return Err(Fault::malformed(format!("line {line}: `{}` is not a corner of a face", excerpt(word))));
        }
        Ok(corner)
    }

    fn use_material(&mut self, name: &str) {
        if let Some(&number) = self.used.get(name) {
            self.material = number;
            return;
        }
        let Some(described) = self.library.get(name).filter(|described| described.has_color()) else {
            self.material = NONE;
            return;
        };
        self.material = self.out.materials.len() as u32;
        self.out.materials.push(described.load(name, &mut self.textures, &mut self.out.warnings));
        self.used.insert(name.to_owned(), self.material);
    }

    /// Checks the indices: a positive one may run ahead of its definition, so this waits for the end.
    fn finish(mut self) -> Result<Statements, Fault> {
        if !self.out.colors.is_empty() {
            self.out.colors.resize(self.out.positions.len(), [f32::NAN; 3]);
        }
        if self.out.parts.iter().all(String::is_empty) {
            self.out.parts.clear();
        }
        let mut corners = self.out.corners.iter();
        for face in &self.out.faces {
            for corner in corners.by_ref().take(face.corner_count as usize) {
                check("vertex", corner.position, self.out.positions.len(), face.line)?;
                check("texture coordinate", corner.uv, self.out.uvs.len(), face.line)?;
                check("normal", corner.normal, self.out.normals.len(), face.line)?;
            }
        }
        Ok(self.out)
    }
}

/// The rest of a line after its keyword: a name, which may hold blanks.
fn argument(line: &str) -> &str {
    line.trim().split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, rest)| rest.trim())
}

/// An index from 0; negative ones count back from the last of the `count` items so far.
fn resolve(part: &str, count: usize, line: usize) -> Result<u32, Fault> {
    let bad = |why: &str| Fault::malformed(format!("line {line}: index `{}` {why}", excerpt(part)));
    let index: i64 = part.parse().map_err(|_| bad("is not a whole number"))?;
    let resolved = match index {
        0 => return Err(bad("is not valid (indices count from 1)")),
        1.. => index - 1,
        _ => count as i64 + index,
    };
    if resolved < 0 {
        return Err(bad(&format!("reaches before the first of the {count} defined so far")));
    }
    u32::try_from(resolved).ok().filter(|&index| index != NONE).ok_or_else(|| bad("is out of range"))
}

fn check(what: &str, index: u32, count: usize, line: usize) -> Result<(), Fault> {
    if index == NONE || (index as usize) < count {
        return Ok(());
    }
    Err(Fault::malformed(format!("line {line}: {what} {} is referred to but there are {count}", u64::from(index) + 1)))
}
