//! Reading meshes.

mod corner_grid;
mod ear_clipping;
mod gltf;
mod obj;
mod off;
mod ply;
mod polygon;
mod text;

use std::path::Path;

use crate::Error;
use crate::input::{Fault, check_is_file, extension, read_file};
use crate::mesh::MeshSource;

/// Reads a mesh, chosen by the file's extension (in any case).
///
/// | extension | format | vertices | albedo |
/// |---|---|---|---|
/// | `glb`, `gltf` | glTF 2.0 | all primitives of the default scene, in world space; skins in their rest pose, morph targets at their default weights | base colour factor × texture at the vertex × `COLOR_0` |
/// | `obj` | Wavefront | distinct `v/vt/vn`; the file's own where it has only `v` | `Kd` of the material library × `map_Kd` at the vertex, else the vertex colour (sRGB) |
/// | `ply` | Stanford PLY, ASCII and both binary orders | the file's own | `red green blue`: integers are sRGB, floats linear |
/// | `off` | OFF, also with `C`, `N`, `ST` | the file's own | as in PLY |
///
/// Polygons are split into triangles that keep their orientation. Texture coordinates are as the file gives them: `v`
/// runs down in glTF and up in the others. Albedo is clamped to 0..1; metalness and the alpha of vertex colours are ignored.
///
/// Faces keep their materials: textures, `doubleSided`, holes where alpha is below the cutoff (`alphaMode` `MASK`) or below one half
/// (`BLEND`, with a warning in [`MeshSource::warnings`]; `map_d` in OBJ). Every node with a mesh in glTF, and every object and group in OBJ,
/// is a part; a node that is mirrored (a transform of negative determinant) has its faces turned over, so that
/// they look outwards, and a mesh that several nodes use is there once for each. Nothing is cleaned: positions may be NaN, faces degenerate and vertices unused ([`Mesh::new`](crate::Mesh::new) deals with them).
///
/// Memory is at most about a hundred times the file's size, whatever its header claims (textures and what a glTF
/// scene repeats aside, which have limits of their own).
///
/// # Errors
/// Each names the file and the cause: what the system refuses, an unknown extension, data that break the format's rules
/// (with the line or item), features that are not handled, a file without faces.
pub fn load_mesh(path: &Path) -> Result<MeshSource, Error> {
    check_is_file(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let (format, mesh) = match extension(path).as_str() {
        "glb" | "gltf" => ("glTF", gltf::parse(&contents(path, "glTF")?, folder)),
        "obj" => ("OBJ", obj::parse(&contents(path, "OBJ")?, folder)),
        "ply" => ("PLY", ply::parse(&contents(path, "PLY")?)),
        "off" => ("OFF", off::parse(&contents(path, "OFF")?)),
        _ => {
            return Err(Error::UnknownExtension {
                path: path.to_owned(),
                what: "a mesh",
                accepted: "glb, gltf, obj, ply, off",
            });
        }
    };
    let mesh = mesh.map_err(|fault| fault.in_file(path, format))?;
    if mesh.triangles.is_empty() {
        return Err(Error::NoFaces { path: path.to_owned(), vertices: mesh.positions.len() });
    }
    Ok(mesh)
}

fn contents(path: &Path, format: &'static str) -> Result<Vec<u8>, Error> {
    let bytes = read_file(path)?;
    if bytes.is_empty() {
        return Err(Fault::malformed("it is empty").in_file(path, format));
    }
    Ok(bytes)
}
