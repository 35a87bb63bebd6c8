//! Material libraries of OBJ files.

use std::collections::HashMap;
use std::path::Path;

use super::texture::{MapStatement, Textures};
use crate::SurfaceMaterial;
use crate::input::{Fault, read_file};
use crate::load::text::numbers;

/// Materials by name.
pub(super) type Library = HashMap<String, Described>;

/// Where a material with an image of its opacity is there.
const OPACITY_CUTOFF: f32 = 0.5;

/// A material as its library describes it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Described {
    /// `Kd`, linear.
    color: Option<[f32; 3]>,
    /// `map_Kd`
    color_map: Option<MapStatement>,
    /// `map_d`
    opacity_map: Option<MapStatement>,
}

impl Described {
    /// Whether the material says anything of colour or opacity.
    pub(super) fn has_color(&self) -> bool {
        self.color.is_some() || self.color_map.is_some() || self.opacity_map.is_some()
    }

    /// Reads the textures. What cannot be read is left out, with a warning: libraries come with paths of other machines.
    pub(super) fn load(&self, name: &str, textures: &mut Textures, warnings: &mut Vec<String>) -> SurfaceMaterial {
        let texture = textures.load(self.color_map.as_ref(), self.opacity_map.as_ref()).unwrap_or_else(|reason| {
            warnings.push(format!("the texture of material `{name}` is left out: {reason}"));
            None
        });
        let [red, green, blue] = self.color.unwrap_or([1.0; 3]);
        SurfaceMaterial {
            name: name.to_owned(),
            base_color: [red, green, blue, 1.0],
            alpha_cutoff: self.opacity_map.as_ref().filter(|_| texture.is_some()).map(|_| OPACITY_CUTOFF),
            texture,
            two_sided: false,
        }
    }
}

/// Adds the materials of the libraries that a `mtllib` statement names; those that are not there are passed over.
///
/// - `names`: one file name, which may hold blanks, or several separated by blanks
pub(super) fn read_libraries(names: &str, folder: &Path, library: &mut Library) -> Result<(), Fault> {
    let whole = folder.join(names);
    if !names.is_empty() && whole.is_file() {
        return read_library(&whole, library);
    }
    for name in names.split_ascii_whitespace() {
        let path = folder.join(name);
        if path.is_file() {
            read_library(&path, library)?;
        }
    }
    Ok(())
}

fn read_library(path: &Path, library: &mut Library) -> Result<(), Fault> {
    let bytes = read_file(path)?;
    parse(&bytes, path.parent().unwrap_or(Path::new("")), library).map_err(|fault| fault.in_file(path, "MTL").into())
}

/// `Kd r g b` (linear), `map_Kd` and `map_d` of each `newmtl`; spectral and XYZ forms give no colour.
fn parse(bytes: &[u8], folder: &Path, library: &mut Library) -> Result<(), Fault> {
    let mut name = None;
    // Names in other encodings still match themselves in the OBJ file's, which is all that is asked of them.
    for (index, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let (keyword, rest) = line.trim().split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line.trim(), ""));
        if keyword == "newmtl" {
            name = Some(rest.trim().to_owned());
            continue;
        }
        let Some(name) = &name else { continue };
        match keyword {
            "Kd" if !rest.trim_start().starts_with(['s', 'x']) => {
                let mut words = rest.split_ascii_whitespace();
                let color = gray_or_rgb(&mut words, index + 1)?;
                library.entry(name.clone()).or_default().color = Some(color);
            }
            "map_Kd" => {
                library.entry(name.clone()).or_default().color_map = Some(MapStatement::parse(rest, folder));
            }
            "map_d" => {
                library.entry(name.clone()).or_default().opacity_map = Some(MapStatement::parse(rest, folder));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Red, green and blue in 0..1; red alone stands for all three.
fn gray_or_rgb<'a>(words: &mut impl Iterator<Item = &'a str>, line: usize) -> Result<[f32; 3], Fault> {
    let [red] = numbers(words, line)?;
    let mut rest = words.peekable();
    let color = if rest.peek().is_none() {
        [red; 3]
    } else {
        let [green, blue] = numbers(&mut rest, line)?;
        [red, green, blue]
    };
    Ok(color.map(|value| value.clamp(0.0, 1.0) as f32))
}
