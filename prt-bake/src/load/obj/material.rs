//! Material libraries of OBJ files.

use std::collections::HashMap;
use std::path::Path;

use crate::input::{Fault, read_file};
use crate::load::text::numbers;

/// Adds the diffuse colours of the libraries that a `mtllib` statement names; those that are not there are passed over.
///
/// - `names`: one file name, which may hold blanks, or several separated by blanks
pub(super) fn read_libraries(names: &str, folder: &Path, library: &mut HashMap<String, [f32; 3]>) -> Result<(), Fault> {
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

fn read_library(path: &Path, library: &mut HashMap<String, [f32; 3]>) -> Result<(), Fault> {
    let bytes = read_file(path)?;
    parse(&bytes, library).map_err(|fault| fault.in_file(path, "MTL").into())
}

/// `Kd r g b` (linear) of each `newmtl`; spectral and XYZ forms give no colour.
fn parse(bytes: &[u8], library: &mut HashMap<String, [f32; 3]>) -> Result<(), Fault> {
    let mut material = None;
    // Names in other encodings still match themselves in the OBJ file's, which is all that is asked of them.
    for (index, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let (keyword, rest) = line.trim().split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line.trim(), ""));
        match keyword {
            "newmtl" => material = Some(rest.trim().to_owned()),
            "Kd" if !rest.trim_start().starts_with(['s', 'x']) => {
                let mut words = rest.split_ascii_whitespace();
                let color = gray_or_rgb(&mut words, index + 1)?;
                library.extend(material.clone().map(|name| (name, color)));
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
