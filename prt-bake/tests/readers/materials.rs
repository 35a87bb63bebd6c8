//! Materials, parts, mirrored and repeated meshes: what is read, and what a bake makes of it.

use std::sync::Arc;

use prt_bake::{
    BakeOptions, BakedSurface, Mesh, MeshOptions, MeshReport, MeshSource, SurfaceMaterial, TextureWrap, bake_diffuse,
};
use serde_json::{Value, json};

use crate::gltf::{Builder, TRIANGLE, checker_png};
use crate::scratch::assert_near;

fn build(source: MeshSource) -> (Mesh, MeshReport) {
    Mesh::new(source, &MeshOptions::default()).unwrap()
}

fn bake(mesh: &Mesh, bounces: usize) -> BakedSurface {
    let options = BakeOptions { rays_per_vertex: 256, bounces, threads: Some(1), ..BakeOptions::preview() };
    bake_diffuse(mesh, &options, &()).unwrap().0
}

/// A PNG of 2 × 1 texels: red with alpha 51, grey with alpha 255.
fn half_there_png() -> Vec<u8> {
    let image = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 51, 128, 128, 128, 255]).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A triangle for each material, all with the same attributes.
fn one_each(builder: &mut Builder, materials: Value, png: Vec<u8>) -> MeshSource {
    let uvs = builder.floats(&[[0.25, 0.5], [0.75, 0.5], [0.75, 0.5]]);
    let image = builder.view(&png);
    let primitive = |material: usize| {
        let positions = builder.floats(&TRIANGLE.map(|[x, y, _]| [x, y, material as f32]));
        json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "material": material})
    };
    let primitives: Vec<Value> = (0..materials.as_array().unwrap().len()).map(primitive).collect();
    let document = json!({
        "nodes": [{"mesh": 0}], "meshes": [{"name": "all", "primitives": primitives}], "materials": materials,
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33_071, "wrapT": 33_648}],
        "images": [{"bufferView": image, "mimeType": "image/png"}],
    });
    builder.load(document).unwrap()
}

#[test]
fn sides_holes_and_textures_of_materials() {
    let textured = json!({"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1.0, 1.0, 0.75]});
    let materials = json!([
        {"name": "wall"},
        {"name": "leaf", "doubleSided": true, "alphaMode": "MASK", "pbrMetallicRoughness": textured},
        {"name": "net", "alphaMode": "MASK", "alphaCutoff": 0.25, "pbrMetallicRoughness": textured},
        {"name": "glass", "alphaMode": "BLEND", "pbrMetallicRoughness": textured},
        {"name": "paper", "alphaMode": "OPAQUE", "alphaCutoff": 0.9, "pbrMetallicRoughness": textured},
        {"name": "varnish", "alphaMode": "BLEND"},
    ]);
    let mesh = one_each(&mut Builder::default(), materials, half_there_png());
    assert_eq!(mesh.face_material, [0, 1, 2, 3, 4, 5]);
    let names: Vec<_> = mesh.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["wall", "leaf", "net", "glass", "paper", "varnish"]);
    let cutoffs: Vec<_> = mesh.materials.iter().map(|material| material.alpha_cutoff).collect();
    assert_eq!(cutoffs, [None, Some(0.5), Some(0.25), Some(0.5), None, Some(0.5)]);
    let sides: Vec<_> = mesh.materials.iter().map(|material| material.two_sided).collect();
    assert_eq!(sides, [false, true, false, false, false, false]);
    // What is blended but has no hole anywhere needs no warning.
    assert_eq!(mesh.warnings.len(), 1);
    assert!(mesh.warnings[0].contains("material 3 `glass`") && mesh.warnings[0].contains("0.5"), "{:?}", mesh.warnings);
    let leaf = &mesh.materials[1];
    let (mine, other) = (leaf.texture.as_ref().unwrap(), mesh.materials[2].texture.as_ref().unwrap());
    assert!(Arc::ptr_eq(&mine.texture, &other.texture), "held once");
    assert_eq!(mine.texture.size(), [2, 1]);
    assert!(!leaf.is_there([0.25, 0.5]) && leaf.is_there([0.75, 0.5]), "0.75 · 51/255 and 0.75");
    assert_eq!(leaf.color([0.25, 0.5]), [0.5, 0.0, 0.0]);
    assert_eq!(mesh.albedo[3], [0.5, 0.0, 0.0], "vertices are coloured where they are, holes or not");
    assert_eq!(leaf.color([-7.0, 0.5]), leaf.color([0.25, 0.5]), "clamped along u");
    let (mesh, report) = build(mesh);
    assert_eq!((report.warnings.len(), report.faces_twinned, mesh.triangles().len()), (1, 1, 7));
}

#[test]
fn textures_may_have_coordinates_of_their_own_and_tints() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let (first, second) = (builder.floats(&[[0.1, 0.2]; 3]), builder.floats(&[[0.75, 0.25]; 3]));
    let colors = builder.floats(&[[1.0, 0.5, 1.0], [1.0, 0.25, 1.0], [1.0, 0.0, 1.0]]);
    let image = builder.view(&checker_png());
    let document = |set: u32, colors: Option<usize>, has_second: bool| {
        let mut attributes = json!({"POSITION": positions, "TEXCOORD_0": first});
        if has_second {
            attributes["TEXCOORD_1"] = json!(second);
        }
        if let Some(colors) = colors {
            attributes["COLOR_0"] = json!(colors);
        }
        json!({
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": attributes, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": set}}}],
            "textures": [{"source": 0}], "images": [{"bufferView": image, "mimeType": "image/png"}],
        })
    };
    let own = builder.load(document(1, Some(colors), true)).unwrap();
    assert_eq!((own.uvs[0], own.texture_uvs[0], own.tints[1]), ([0.1, 0.2], [0.75, 0.25], [1.0, 0.25, 1.0]));
    let (mesh, _) = build(own);
    assert_near(&mesh.albedo_at(0, [0.5, 0.0]), &[0.0, 0.375, 0.0], 1e-6);
    let plain = builder.load(document(0, None, true)).unwrap();
    assert!(plain.texture_uvs.is_empty() && plain.tints.is_empty());
    let lacking = builder.load(document(1, None, false)).unwrap();
    assert_eq!(lacking.materials[0].texture, None, "no coordinates, no texture");
    assert_eq!(lacking.materials[0], SurfaceMaterial::default());
    assert_eq!(TextureWrap::default(), TextureWrap::Repeat, "as glTF has it");
}

/// A block with a step, of 12 corners, not symmetric in any way; quads facing out.
fn step() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let positions = [0.0, 1.5].into_iter().flat_map(|z| outline.map(|[x, y]| [x, y, z])).collect();
    let mut triangles: Vec<[u32; 3]> = (0..6).flat_map(|k| quad([k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6])).collect();
    for [a, b, c, d] in [[0, 1, 2, 3], [0, 3, 4, 5]] {
        triangles.extend(quad([a, d, c, b]).into_iter().chain(quad([a + 6, b + 6, c + 6, d + 6])));
    }
    (positions, triangles)
}

fn quad([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

fn primitive(builder: &mut Builder, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Value {
    let positions = builder.floats(positions);
    let bytes: Vec<u8> = triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()).collect();
    let indices = builder.accessor("SCALAR", 5125, 3 * triangles.len(), &bytes);
    json!({"attributes": {"POSITION": positions}, "indices": indices})
}

#[test]
fn a_mirrored_node_equals_a_mesh_that_is_mirrored_by_hand() {
    let mut builder = Builder::default();
    let (positions, triangles) = step();
    let by_hand: Vec<[f32; 3]> = positions.iter().map(|&[x, y, z]| [-x, y, z]).collect();
    let turned: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let meshes = [(&positions, &triangles), (&by_hand, &turned)]
        .map(|(positions, triangles)| json!({"primitives": [primitive(&mut builder, positions, triangles)]}));
    let load = |node: Value| builder.load(json!({"nodes": [node], "meshes": meshes})).unwrap();
    let mirrored = build(load(json!({"mesh": 0, "scale": [-1, 1, 1]}))).0;
    let expected = build(load(json!({"mesh": 1}))).0;
    assert_eq!(mirrored.triangles(), expected.triangles());
    let (mirrored, expected) = (bake(&mirrored, 2), bake(&expected, 2));
    assert_eq!(mirrored.transfer, expected.transfer);
    // A point mirror turns over as well, an even number of mirrors does not.
    let twice = build(load(json!({"mesh": 0, "scale": [-1, -1, 1]}))).0;
    assert_eq!(twice.triangles(), build(load(json!({"mesh": 0}))).0.triangles());
    // Outside it is lit: of the step all corners but those of the notch see their whole sky.
    let open = expected.unshadowed();
    let lit = |vertex: usize| expected.transfer.vector(vertex, 0)[0] / open.vector(vertex, 0)[0];
    let least = (0..open.vertex_count()).map(lit).fold(1.0, f32::min);
    let whole = (0..open.vertex_count()).filter(|&vertex| lit(vertex) == 1.0).count();
    assert!(least > 0.4 && whole >= open.vertex_count() / 2, "{least} {whole}");
}

#[test]
fn the_inside_of_a_box_that_is_turned_inside_out_by_its_triangles_is_dark() {
    let mut builder = Builder::default();
    let (positions, triangles) = step();
    let inwards: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mesh = json!({"primitives": [primitive(&mut builder, &positions, &inwards)]});
    for scale in [[1, 1, 1], [1, 1, -1]] {
        let source = builder.load(json!({"nodes": [{"mesh": 0, "scale": scale}], "meshes": [mesh]})).unwrap();
        let baked = bake(&build(source).0, 0);
        // All directions are occluded: what is left is the error of summing 256 rays.
        assert!(baked.transfer.values.iter().all(|value| value.abs() < 3e-3), "{scale:?}");
    }
}

#[test]
fn an_instance_equals_a_copy_and_has_transfer_of_its_own() {
    let mut builder = Builder::default();
    let (positions, triangles) = step();
    let meshes: Vec<Value> = (0..2)
        .map(|_| json!({"name": "step", "primitives": [primitive(&mut builder, &positions, &triangles)]}))
        .collect();
    let nodes = |meshes: [usize; 2]| {
        json!([
            {"name": "below", "mesh": meshes[0]},
            {"mesh": meshes[1], "translation": [0, 3, 0], "scale": [1, -1, 1]},
        ])
    };
    let load = |indices| builder.load(json!({"nodes": nodes(indices), "meshes": meshes})).unwrap();
    let (instances, copies) = (load([0, 0]), load([0, 1]));
    assert_eq!(instances, copies);
    assert_eq!(instances.parts, ["below", "step"]);
    let mesh = build(instances).0;
    assert_eq!(mesh.face_parts(), [vec![0; triangles.len()], vec![1; triangles.len()]].concat());
    let baked = bake(&mesh, 1);
    let alone = bake(&build(builder.load(json!({"nodes": [{"mesh": 0}], "meshes": meshes})).unwrap()).0, 1);
    // The upper one hangs over the lower, which therefore gets less light than it would alone.
    let sum = |surface: &BakedSurface| {
        let count = surface.geometry.vertex_count();
        let below =
            (0..count).filter(|&v| surface.geometry.positions[v][1] <= 2.0 && surface.geometry.normals[v][1] > 0.5);
        below.map(|v| surface.transfer.vector(v, 0)[0]).sum::<f32>()
    };
    assert!(sum(&baked) < 0.9 * sum(&alone), "{} {}", sum(&baked), sum(&alone));
}

/// Many exporters mark everything as two-sided: characters that are solids get no more vertices than they need.
#[test]
fn a_solid_that_is_marked_two_sided_costs_nothing() {
    let mut builder = Builder::default();
    let (positions, triangles) = step();
    let mut primitive = primitive(&mut builder, &positions, &triangles);
    primitive["material"] = json!(0);
    let document = |two_sided: bool| json!({"nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}], "materials": [{"doubleSided": two_sided}]});
    let [(marked, report), (plain, _)] =
        [true, false].map(|two_sided| build(builder.load(document(two_sided)).unwrap()));
    assert_eq!((report.faces_twinned, report.faces_enclosed), (0, triangles.len()));
    assert_eq!(bake(&marked, 1), bake(&plain, 1));
}
