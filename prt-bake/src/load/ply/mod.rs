//! Stanford PLY, ASCII and binary.

mod elements;
mod header;
mod values;

use header::{Element, Encoding, Header};
use values::{Ascii, Binary, Values};

use crate::input::Fault;
use crate::mesh::MeshSource;

/// Reads the elements `vertex`, `face` and `tristrips`; other elements and properties are skipped.
///
/// Vertices keep their order. Properties: `x y z`, `nx ny nz`, `s t` / `u v` / `texture_u texture_v`,
/// `red green blue` / `r g b` / `diffuse_red …` (integers are sRGB, floats linear), `vertex_indices` / `vertex_index`.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshSource, Fault> {
    let (header, body) = header::read(bytes)?;
    match header.encoding {
        Encoding::Ascii => read_elements(&header, Ascii::new(super::text::decode(body, header.lines)?, header.lines)),
        Encoding::LittleEndian => read_elements(&header, Binary::<false>::new(body)),
        Encoding::BigEndian => read_elements(&header, Binary::<true>::new(body)),
    }
}

fn read_elements(header: &Header<'_>, mut values: impl Values) -> Result<MeshSource, Fault> {
    let mut mesh = MeshSource::default();
    let mut polygons = super::polygon::Polygons::default();
    let mut strips = Vec::new();
    for element in &header.elements {
        check_count(element, &values)?;
        match element.name {
            "vertex" => elements::vertices(element, &mut values, &mut mesh)?,
            "face" => elements::faces(element, &mut values, &mut polygons)?,
            "tristrips" => elements::strips(element, &mut values, &mut strips)?,
            _ => elements::skip(element, &mut values)?,
        }
    }
    for triangle in strips {
        polygons.push(triangle);
    }
    mesh.triangles = polygons.triangulate(&mesh.positions)?;
    Ok(mesh)
}

/// Refuses a count that the rest of the file cannot hold, before anything is allocated or looped over.
fn check_count(element: &Element<'_>, values: &impl Values) -> Result<(), Fault> {
    let least = values.least_bytes(&element.properties);
    let room = values.bytes_left();
    if least > 0 && element.count > room / least {
        return Err(Fault::malformed(format!(
            "the header claims {} elements `{}` of at least {least} bytes, but {room} bytes are left",
            element.count, element.name
        )));
    }
    Ok(())
}
