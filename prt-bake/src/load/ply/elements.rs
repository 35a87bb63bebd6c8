//! What the elements of a PLY file mean.

use super::header::{Element, Kind, Scalar};
use super::values::Values;
use crate::image::srgb_to_linear;
use crate::input::Fault;
use crate::load::polygon::Polygons;
use crate::mesh::MeshSource;

/// Names of the properties of a vertex that are read, by slot; further names mean the same.
const SLOTS: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
];
/// Where the groups begin in [`SLOTS`].
const NORMAL: usize = 3;
const UV: usize = 6;
const COLOR: usize = 8;

/// Reads the element `vertex`.
pub(super) fn vertices(element: &Element<'_>, values: &mut impl Values, mesh: &mut MeshSource) -> Result<(), Fault> {
    if !mesh.positions.is_empty() {
        return Err(Fault::malformed("it has two elements `vertex`"));
    }
    let mut scalars = [None; SLOTS.len()];
    let slots: Vec<_> =
        element.properties.iter().map(|property| assign_slot(property.name, property.kind, &mut scalars)).collect();
    let has = |slot: usize, count: usize| scalars[slot..slot + count].iter().all(Option::is_some);
    if element.count > 0 && !has(0, 3) {
        return Err(Fault::malformed("the element `vertex` lacks x, y or z"));
    }
    let (has_normal, has_uv, has_color) = (has(NORMAL, 3), has(UV, 2), has(COLOR, 3));
    mesh.positions.reserve_exact(element.count);
    for _ in 0..element.count {
        let mut row = [0.0; SLOTS.len()];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match (slot, property.kind) {
                (Some(slot), Kind::Scalar(scalar)) => row[*slot] = values.next(scalar)?,
                (_, kind) => skip_property(kind, values)?,
            }
        }
        mesh.positions.push([row[0], row[1], row[2]]);
        let three = |slot: usize| [row[slot], row[slot + 1], row[slot + 2]];
        if has_normal {
            mesh.normals.push(three(NORMAL).map(|value| value as f32));
        }
        if has_uv {
            mesh.uvs.push([row[UV] as f32, row[UV + 1] as f32]);
        }
        if has_color {
            mesh.albedo.push(linear_color(three(COLOR), scalars[COLOR]));
        }
    }
    Ok(())
}

/// The slot of a property, which it then holds with its type; `None` for properties that are not read.
fn assign_slot(name: &str, kind: Kind, scalars: &mut [Option<Scalar>; SLOTS.len()]) -> Option<usize> {
    let Kind::Scalar(scalar) = kind else { return None };
    let slot = SLOTS.iter().position(|names| names.contains(&name)).filter(|&slot| scalars[slot].is_none())?;
    scalars[slot] = Some(scalar);
    Some(slot)
}

/// Integers count to the largest value of their type and are sRGB; floats are linear. NaN gives no colour.
fn linear_color(color: [f64; 3], scalar: Option<Scalar>) -> [f32; 3] {
    let full_scale = scalar.map_or(1.0, Scalar::full_scale);
    let color = color.map(|value| (value / full_scale).clamp(0.0, 1.0) as f32);
    if color.iter().any(|value| value.is_nan()) {
        return [f32::NAN; 3];
    }
    if scalar.is_some_and(Scalar::is_float) { color } else { color.map(srgb_to_linear) }
}

/// Reads the element `face`.
pub(super) fn faces(element: &Element<'_>, values: &mut impl Values, out: &mut Polygons) -> Result<(), Fault> {
    let indices = index_property(element)?;
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for (number, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { length, item } if number == indices => {
                    read_indices(length, item, values, &mut corners, false)?;
                    out.push(corners.iter().map(|&corner| corner as u32));
                }
                kind => skip_property(kind, values)?,
            }
        }
    }
    Ok(())
}

/// Reads the element `tristrips`: lists in which every corner from the third makes a triangle with the two before it, of
/// alternating orientation; -1 begins a new strip.
pub(super) fn strips(element: &Element<'_>, values: &mut impl Values, out: &mut Vec<[u32; 3]>) -> Result<(), Fault> {
    let indices = index_property(element)?;
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for (number, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { length, item } if number == indices => {
                    read_indices(length, item, values, &mut corners, true)?;
                    for strip in corners.split(|&corner| corner < 0) {
                        out.extend(strip.windows(3).enumerate().map(|(i, window)| {
                            let [a, b, c] = [window[0], window[1], window[2]].map(|corner| corner as u32);
                            if i % 2 == 0 { [a, b, c] } else { [b, a, c] }
                        }));
                    }
                }
                kind => skip_property(kind, values)?,
            }
        }
    }
    Ok(())
}

/// Passes over an element.
pub(super) fn skip(element: &Element<'_>, values: &mut impl Values) -> Result<(), Fault> {
    if element.properties.is_empty() {
        // Nothing is stored, and the count is whatever the header says.
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(property.kind, values)?;
        }
    }
    Ok(())
}

fn skip_property(kind: Kind, values: &mut impl Values) -> Result<(), Fault> {
    match kind {
        Kind::Scalar(scalar) => values.skip(scalar, 1),
        Kind::List { length, item } => {
            let length = list_length(values.next(length)?)?;
            values.skip(item, length)
        }
    }
}

/// Which property of a face is the list of its corners.
fn index_property(element: &Element<'_>) -> Result<usize, Fault> {
    let is_index = |name| name == "vertex_indices" || name == "vertex_index";
    let found = element.properties.iter().position(|property| {
        is_index(property.name) && matches!(property.kind, Kind::List { item, .. } if !item.is_float())
    });
    match found {
        Some(index) => Ok(index),
        None if element.count == 0 => Ok(0),
        None => {
            Err(Fault::malformed(format!("the element `{}` lacks a list of integers `vertex_indices`", element.name)))
        }
    }
}

fn read_indices(
    length: Scalar,
    item: Scalar,
    values: &mut impl Values,
    corners: &mut Vec<i64>,
    with_restart: bool,
) -> Result<(), Fault> {
    let length = list_length(values.next(length)?)?;
    corners.clear();
    for _ in 0..length {
        // Every scalar of the list takes a byte at least, so a lying length ends with the file.
        let corner = values.next(item)? as i64;
        if corner > i64::from(u32::MAX) || corner < if with_restart { -1 } else { 0 } {
            return Err(Fault::malformed(format!("a face refers to vertex {corner}")));
        }
        corners.push(corner);
    }
    Ok(())
}

fn list_length(length: f64) -> Result<usize, Fault> {
    if length < 0.0 {
        return Err(Fault::malformed(format!("a list has the length {length}")));
    }
    Ok(length as usize)
}
