//! Object File Format (OFF), as Geomview and its many descendants write it.

use super::polygon::Polygons;
use super::text::{decode, excerpt, numbers};
use crate::image::srgb_to_linear;
use crate::input::Fault;
use crate::mesh::MeshSource;

/// Reads ASCII OFF with the prefixes `ST`, `C` and `N`: one vertex or face a line, `#` begins a comment.
///
/// The counts may stand behind the keyword or on the next line, and the keyword may be missing. Vertex colours are sRGB
/// counting to 255 where they are whole numbers, and linear where they have a decimal point; colours of faces are ignored.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshSource, Fault> {
    let mut lines = Lines::new(decode(bytes, 0)?);
    let (layout, counts) = header(&mut lines)?;
    let [vertex_count, face_count] = counts;
    let mut mesh = MeshSource::default();
    for _ in 0..vertex_count {
        let (line, text) = lines.next_of(vertex_count, "vertices")?;
        vertex(text, line, layout, &mut mesh)?;
    }
    let mut polygons = Polygons::default();
    for _ in 0..face_count {
        let (line, text) = lines.next_of(face_count, "faces")?;
        face(text, line, &mut polygons)?;
    }
    mesh.triangles = polygons.triangulate(&mesh.positions)?;
    Ok(mesh)
}

/// Which values follow a position.
#[derive(Debug, Clone, Copy, Default)]
struct Layout {
    normals: bool,
    colors: bool,
    uvs: bool,
}

/// Lines with something on them, comments removed, counted from 1.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self { lines: text.lines().enumerate() }
    }

    fn next(&mut self) -> Option<(usize, &'a str)> {
        self.lines
            .by_ref()
            .map(|(index, line)| (index + 1, line.split('#').next().unwrap_or_default().trim()))
            .find(|(_, line)| !line.is_empty())
    }

    fn next_of(&mut self, count: usize, what: &str) -> Result<(usize, &'a str), Fault> {
        self.next().ok_or_else(|| Fault::malformed(format!("it ends before the {count} {what} that its header claims")))
    }
}

/// What follows a position, and how many vertices and faces there are.
fn header(lines: &mut Lines<'_>) -> Result<(Layout, [usize; 2]), Fault> {
    let (mut line, mut text) = lines.next().ok_or_else(|| Fault::malformed("it holds only comments"))?;
    let mut layout = Layout::default();
    if !text.starts_with(|c: char| c.is_ascii_digit()) {
        let (keyword, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
        layout = parse_keyword(keyword)?;
        text = rest.trim();
        if text.starts_with("BINARY") {
            return Err(Fault::unsupported("binary OFF is"));
        }
        if text.is_empty() {
            (line, text) = lines.next().ok_or_else(|| Fault::malformed("it ends before the counts"))?;
        }
    }
    let mut words = text.split_ascii_whitespace();
    let mut count = |what| {
        let word = words.next().unwrap_or_default();
        word.parse().map_err(|_| Fault::malformed(format!("line {line}: `{}` is not a count of {what}", excerpt(word))))
    };
    Ok((layout, [count("vertices")?, count("faces")?]))
}

/// `[ST][C][N][4][n]OFF`.
fn parse_keyword(keyword: &str) -> Result<Layout, Fault> {
    let prefixes = keyword
        .strip_suffix("OFF")
        .ok_or_else(|| Fault::malformed(format!("it begins with `{}` in place of `OFF`", excerpt(keyword))))?;
    let (uvs, prefixes) = prefixes.strip_prefix("ST").map_or((false, prefixes), |rest| (true, rest));
    let mut layout = Layout { uvs, ..Layout::default() };
    for prefix in prefixes.chars() {
        match prefix {
            'C' => layout.colors = true,
            'N' => layout.normals = true,
            _ => return Err(Fault::unsupported(format!("the kind `{}` of OFF is", excerpt(keyword)))),
        }
    }
    Ok(layout)
}

/// `x y z [nx ny nz] [r g b [a]] [s t]`.
fn vertex(text: &str, line: usize, layout: Layout, mesh: &mut MeshSource) -> Result<(), Fault> {
    let mut words = text.split_ascii_whitespace();
    mesh.positions.push(numbers(&mut words, line)?);
    if layout.normals {
        mesh.normals.push(numbers(&mut words, line)?.map(|value: f64| value as f32));
    }
    let rest: Vec<_> = words.collect();
    // A colour may have an alpha or not: the texture coordinates are the last two in any case.
    let color_end = rest.len().saturating_sub(if layout.uvs { 2 } else { 0 });
    let (color, uv) = rest.split_at(color_end);
    if layout.colors {
        mesh.albedo.push(linear_color(color, line)?);
    }
    if layout.uvs {
        mesh.uvs.push(numbers(&mut uv.iter().copied(), line)?.map(|value: f64| value as f32));
    }
    Ok(())
}

fn linear_color(words: &[&str], line: usize) -> Result<[f32; 3], Fault> {
    let color: [f64; 3] = numbers(&mut words.iter().copied(), line)?;
    if color.iter().any(|value| value.is_nan()) {
        return Ok([f32::NAN; 3]);
    }
    let is_integer = words[..3].iter().all(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
    Ok(color.map(|value| {
        if is_integer { srgb_to_linear((value / 255.0).min(1.0) as f32) } else { value.clamp(0.0, 1.0) as f32 }
    }))
}

/// `n i1 … in`, and perhaps a colour, which is ignored.
fn face(text: &str, line: usize, polygons: &mut Polygons) -> Result<(), Fault> {
    let mut words = text.split_ascii_whitespace();
    let mut index = || {
        let word = words.next().ok_or_else(|| Fault::malformed(format!("line {line} ends before all corners")))?;
        let bad = || Fault::malformed(format!("line {line}: `{}` is not a vertex number", excerpt(word)));
        word.parse::<u32>().map_err(|_| bad())
    };
    let corner_count = index()?;
    let mut corners = Vec::new();
    for _ in 0..corner_count {
        corners.push(index()?);
    }
    polygons.push(corners);
    Ok(())
}
