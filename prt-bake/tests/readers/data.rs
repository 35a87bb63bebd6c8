//! Real files from the data folder (`$PRT_DATA`, or `../shared/data` beside the workspace); skipped with a word where absent.

use std::path::{Path, PathBuf};

use prt_bake::{Environment, Image, MeshSource, load_mesh};
use sh_core::{Order, ShRotation};

use crate::scratch::assert_near;

/// The folder, if it is there.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("PRT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    if !folder.is_dir() {
        println!("skipped: no data folder at {}", folder.display());
        return None;
    }
    Some(folder)
}

fn used_vertices(mesh: &MeshSource) -> usize {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.as_flattened().iter().for_each(|&corner| used[corner as usize] = true);
    used.iter().filter(|&&used| used).count()
}

/// Vertices that faces use, and triangles, as counted by trimesh and listed in the folder's README.
#[test]
fn static_meshes() {
    let Some(data) = data() else { return };
    for (name, vertices, triangles) in [
        ("armadillo.obj", 43_243, 86_482),
        ("beetle.obj", 19_887, 38_656),
        ("camelhead.off", 11_381, 22_704),
        ("dragon_100k.ply", 49_656, 100_000),
        ("dragon_res3_nonmanifold.ply", 22_998 - 16, 47_794),
        ("lilium.obj", 3_389, 6_590),
        ("max_planck_5k.obj", 5_272, 10_540),
        ("nefertiti.obj", 49_971, 99_938),
        ("spot.obj", 3_225, 5_856),
        ("stanford_bunny.obj", 34_834, 69_451),
        ("truck.obj", 2_956, 4_770),
        ("utah_teapot.obj", 3_644, 6_320),
    ] {
        let mesh = load_mesh(&data.join("meshes").join(name)).unwrap();
        assert_eq!((used_vertices(&mesh), mesh.triangles.len()), (vertices, triangles), "{name}");
        assert_eq!(mesh.uvs.len(), if name == "spot.obj" { vertices } else { 0 }, "{name}");
    }
}

/// Extents in the rest pose come from a NumPy reader of glTF written for this purpose, which follows the specification's
/// skinning equation; albedo at one vertex likewise, with Pillow decoding the texture.
#[test]
fn characters_in_their_rest_pose() {
    let Some(data) = data() else { return };
    for (name, vertices, triangles, extent) in [
        ("cesium_man", 3_273, 4_672, [1.138, 1.507, 0.312]),
        ("fox", 1_728, 576, [25.185, 79.029, 154.72]),
        ("gdquest_mannequiny", 10_366, 13_932, [1.334, 1.507, 0.658]),
        ("kaykit_barbarian", 5_922, 6_543, [2.975, 2.398, 1.85]),
        ("kaykit_knight", 7_024, 6_952, [2.689, 2.467, 2.577]),
        ("quaternius_mech_george", 7_755, 7_864, [4.154, 6.457, 2.642]),
        ("quaternius_wolf", 3_994, 1_962, [1.057, 2.701, 5.272]),
        ("robot_expressive", 7_214, 3_237, [3.099, 4.461, 2.685]),
    ] {
        let mesh = load_mesh(&data.join(format!("characters/{name}.glb"))).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles), "{name}");
        for axis in 0..3 {
            let (low, high) =
                mesh.positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), position| {
                    (low.min(position[axis]), high.max(position[axis]))
                });
            // The expected numbers have three decimals.
            assert!((high - low - extent[axis]).abs() < 6e-4, "{name} axis {axis}: {}", high - low);
        }
        assert_eq!(mesh.normals.is_empty(), name == "fox");
        assert!(mesh.albedo.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "{name}");
        assert!(faces_agree_with_normals(&mesh) > 0.99, "{name}: a mirrored part is inside out");
    }
}

/// The share of faces whose winding agrees with their vertices' normals.
fn faces_agree_with_normals(mesh: &MeshSource) -> f64 {
    if mesh.normals.is_empty() {
        return 1.0;
    }
    let vector = |[x, y, z]: [f64; 3]| glam::DVec3::new(x, y, z);
    let agreeing = mesh.triangles.iter().filter(|triangle| {
        let [a, b, c] = triangle.map(|corner| vector(mesh.positions[corner as usize]));
        let normals: glam::DVec3 =
            triangle.iter().map(|&corner| vector(mesh.normals[corner as usize].map(f64::from))).sum();
        (b - a).cross(c - a).dot(normals) > 0.0
    });
    agreeing.count() as f64 / mesh.triangles.len() as f64
}

/// Pixel (column width/3, row height/2) and the largest value, read by OpenCV 5 (.hdr) and OpenEXR 3.4 (.exr): the row
/// `a[h//2, w//3]` and `a.max()` of the arrays that `cv2.imread(…, IMREAD_UNCHANGED)` and `OpenEXR.File(…)` give.
#[test]
fn environment_maps() {
    let Some(data) = data() else { return };
    for (name, size, pixel, largest) in [
        ("city_512_dwab.exr", (512, 256), [0.144_653_32, 0.087_829_59, 0.049_011_23], 11.046_875),
        ("forest_512_zip.exr", (512, 256), [0.015_098_572, 0.015_701_294, 0.008_148_193], 64.5625),
        ("grace_256.hdr", (256, 128), [0.011_047_363, 0.003_784_179_7, 0.001_586_914_1], 3504.0),
        ("moonless_golf_1k.hdr", (1024, 512), [0.015_014_648, 0.015_075_684, 0.004_760_742], 10_880.0),
        ("museum_512_piz.exr", (512, 256), [0.291_503_9, 0.137_695_31, 0.081_726_074], 19.281_25),
        ("pisa_256.hdr", (256, 128), [0.027_221_68, 0.026_489_258, 0.027_709_961], 3.9375),
        ("quarry_01_1k.hdr", (1024, 512), [0.036_865_234, 0.042_236_328, 0.019_042_969], 86_528.0),
        ("royal_esplanade_1k.hdr", (1024, 512), [0.005_310_058_6, 0.004_486_084, 0.004_577_636_7], 49_664.0),
        ("spiaggia_di_mondello_1k.hdr", (1024, 512), [0.515_625, 0.445_312_5, 0.367_187_5], 72_704.0),
        ("studio_512_zip.exr", (512, 256), [0.163_574_22, 0.193_359_38, 0.209_716_8], 3730.0),
        ("sunset_512_none.exr", (512, 256), [0.197_143_55, 0.119_567_87, 0.076_477_05], 801.0),
        ("uffizi_256.hdr", (256, 128), [0.027_221_68, 0.020_507_813, 0.016_723_633], 15.875),
    ] {
        let image = Image::load(&data.join("env").join(name)).unwrap();
        assert_eq!((image.width, image.height), size, "{name}");
        assert_eq!(image.pixels[image.height / 2 * image.width + image.width / 3], pixel, "{name}");
        assert_eq!(image.pixels.iter().flatten().copied().fold(0.0, f32::max), largest, "{name}");
    }
}

/// The chart with one bright pixel: its light is that pixel's radiance times its solid angle, in every coefficient.
#[test]
fn one_pixel_of_light() {
    let Some(data) = data() else { return };
    let image = Image::load(&data.join("env/spot1Lux.hdr")).unwrap();
    let lit: Vec<_> = (0..image.pixels.len()).filter(|&i| image.pixels[i] != [0.0; 3]).collect();
    assert_eq!(lit, [213 * 1024 + 597]);
    let light = Environment::LatLong(image).light(Order::new(1).unwrap());
    // 0.9592 is radiance times solid angle as the folder's README gives it, to four digits; band 0 is 1 / (2 √π).
    assert_near(&light, &[0.9592 * 0.282_094_8; 3], 2e-5);
}

#[test]
fn the_cube_of_pisa() {
    let Some(data) = data() else { return };
    let Environment::Cube(faces) = Environment::load(&data.join("env/pisa_cube")).unwrap() else { panic!("a cube") };
    let largest = |face: &Image| face.pixels.iter().flatten().copied().fold(0.0, f32::max);
    assert_eq!(faces.each_ref().map(|face| face.width), [256; 6]);
    // px nx py ny pz nz, from the folder's README, to four digits.
    assert_near(&faces.each_ref().map(largest), &[7.219, 0.9492, 1.102, 0.3516, 3.422, 4.75], 5e-4);
}

/// The same place as a panorama and as a cube: equal but for a turn about the vertical. A cube that is not mirrored has at best a
/// correlation of 0.91.
#[test]
fn the_cube_of_pisa_is_its_panorama() {
    let Some(data) = data() else { return };
    let order = Order::new(6).unwrap();
    let light = |file: &str| Environment::load(&data.join(file)).unwrap().light(order)[..36].to_vec();
    let (panorama, cube) = (light("env/pisa_256.hdr"), light("env/pisa_cube"));
    let quarter_turns = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(cos, sin)| {
        let mut turned = vec![0.0; 36];
        ShRotation::new(order, [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]]).apply(&cube, &mut turned);
        correlation(&turned, &panorama)
    });
    assert!(quarter_turns.iter().any(|&found| found > 0.9999), "{quarter_turns:?}");
}

/// Of all coefficients but the mean.
fn correlation(a: &[f32], b: &[f32]) -> f32 {
    let dot = |a: &[f32], b: &[f32]| a[1..].iter().zip(&b[1..]).map(|(a, b)| a * b).sum::<f32>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}
