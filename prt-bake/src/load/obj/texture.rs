//! Textures of OBJ materials.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::image::decode_rgba8;
use crate::input::read_file;
use crate::{Texture, TextureMap, TextureWrap};

/// A texture as a material library asks for it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MapStatement {
    path: PathBuf,
    scale: [f32; 2],
    offset: [f32; 2],
    wrap: TextureWrap,
}

/// Textures read so far, by the files of colour and of opacity.
#[derive(Debug, Default)]
pub(super) struct Textures(HashMap<(Option<PathBuf>, Option<PathBuf>), Arc<Texture>>);

/// Columns, rows, and pixels with alpha.
type Pixels = (usize, usize, Vec<[u8; 4]>);

impl MapStatement {
    /// What follows `map_Kd` and the like: options, of which `-s`, `-o` and `-clamp` are heeded, and the name of a file, which may hold
    /// blanks.
    pub(super) fn parse(statement: &str, folder: &Path) -> Self {
        let (mut scale, mut offset, mut wrap) = ([1.0; 2], [0.0; 2], TextureWrap::Repeat);
        let mut rest = statement.trim();
        while let Some((option, after)) = rest.strip_prefix('-').and_then(split_word) {
            rest = after;
            match option {
                "s" => rest = take_numbers(rest, &mut scale),
                "o" => rest = take_numbers(rest, &mut offset),
                "t" => rest = take_numbers(rest, &mut [0.0; 2]),
                "mm" => rest = take_numbers(rest, &mut [0.0; 2]),
                _ => {
                    let Some((value, after)) = split_word(rest) else { break };
                    if option == "clamp" && value == "on" {
                        wrap = TextureWrap::ClampToEdge;
                    }
                    rest = after;
                }
            }
        }
        Self { path: folder.join(rest.replace('\\', "/")), scale, offset, wrap }
    }
}

/// The first word and what follows it.
fn split_word(text: &str) -> Option<(&str, &str)> {
    text.split_once(|c: char| c.is_ascii_whitespace()).map(|(word, rest)| (word, rest.trim_start()))
}

/// Takes one to three numbers off the front; only the first two mean anything to an image.
fn take_numbers<'a>(text: &'a str, out: &mut [f32; 2]) -> &'a str {
    let mut rest = text;
    for k in 0..3 {
        let Some((number, after)) = split_word(rest).and_then(|(word, after)| Some((word.parse().ok()?, after))) else {
            break;
        };
        if let Some(out) = out.get_mut(k) {
            *out = number;
        }
        rest = after;
    }
    rest
}

impl Textures {
    /// The texture of a material, with the opacity of another image as its alpha if there is one; `Err` says why it cannot be read.
    pub(super) fn load(
        &mut self,
        color: Option<&MapStatement>,
        opacity: Option<&MapStatement>,
    ) -> Result<Option<TextureMap>, String> {
        let Some(first) = color.or(opacity) else { return Ok(None) };
        let key = [color, opacity].map(|map| map.map(|map| map.path.clone()));
        let texture = match self.0.get(&(key[0].clone(), key[1].clone())) {
            Some(texture) => Arc::clone(texture),
            None => Arc::new(read(color, opacity, first.wrap)?),
        };
        let [color_path, opacity_path] = key;
        self.0.insert((color_path, opacity_path), Arc::clone(&texture));
        // In OBJ v runs up, in the image down.
        let MapStatement { scale: [su, sv], offset: [u, v], .. } = *first;
        Ok(Some(TextureMap { texture, scale: [su, -sv], rotation: 0.0, offset: [u, 1.0 - v] }))
    }
}

fn read(color: Option<&MapStatement>, opacity: Option<&MapStatement>, wrap: TextureWrap) -> Result<Texture, String> {
    let opacity = opacity.map(|map| pixels(&map.path)).transpose()?;
    let (width, height, mut pixels) = match (color, &opacity) {
        (Some(color), _) => pixels(&color.path)?,
        (None, Some((width, height, pixels))) => (*width, *height, vec![[u8::MAX; 4]; pixels.len()]),
        (None, None) => return Err("it names no file".to_owned()),
    };
    match &opacity {
        Some(opacity) => set_alpha(&mut pixels, [width, height], opacity),
        None => pixels.iter_mut().for_each(|pixel| pixel[3] = u8::MAX),
    }
    Ok(Texture::new(width, height, pixels, [wrap; 2]))
}

/// Takes alpha from the nearest pixel of an image: from its alpha if that is anywhere below 1, else from its red.
fn set_alpha(pixels: &mut [[u8; 4]], [width, height]: [usize; 2], (columns, rows, opacity): &Pixels) {
    let channel = if opacity.iter().any(|pixel| pixel[3] < u8::MAX) { 3 } else { 0 };
    for (row, line) in pixels.chunks_exact_mut(width).enumerate() {
        let from = &opacity[row * rows / height * columns..][..*columns];
        line.iter_mut().enumerate().for_each(|(column, pixel)| pixel[3] = from[column * columns / width][channel]);
    }
}

fn pixels(path: &Path) -> Result<Pixels, String> {
    let bytes = read_file(path).map_err(|error| error.to_string())?;
    decode_rgba8(&bytes).map_err(|fault| fault.in_file(path, "image").to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_before_a_name_with_blanks() {
        let parse = |text| MapStatement::parse(text, Path::new("dir"));
        let plain =
            MapStatement { path: "dir/a b.png".into(), scale: [1.0; 2], offset: [0.0; 2], wrap: TextureWrap::Repeat };
        assert_eq!(parse(" a b.png "), plain);
        assert_eq!(parse("-blendu off -mm 0 1 -t 1 2 3 -bm 0.5 a b.png"), plain);
        let moved = MapStatement { scale: [2.0, 3.0], offset: [0.25, 0.0], wrap: TextureWrap::ClampToEdge, ..plain };
        assert_eq!(parse("-s 2 3 1 -o 0.25 -clamp on a b.png"), moved);
        assert_eq!(parse("maps\\a.png").path, Path::new("dir/maps/a.png"));
        assert_eq!(parse("-s").path, Path::new("dir/-s"));
    }

    #[test]
    fn opacity_of_another_size_is_looked_up_at_the_nearest_pixel() {
        let mut pixels = vec![[9; 4]; 8];
        set_alpha(&mut pixels, [4, 2], &(2, 1, vec![[7, 0, 0, 255], [200, 0, 0, 255]]));
        let alpha: Vec<u8> = pixels.iter().map(|pixel| pixel[3]).collect();
        assert_eq!(alpha, [7, 7, 200, 200, 7, 7, 200, 200]);
        set_alpha(&mut pixels, [4, 2], &(1, 1, vec![[7, 0, 0, 30]]));
        assert!(pixels.iter().all(|pixel| pixel[3] == 30), "its own alpha comes first");
    }
}
