#![expect(clippy::unwrap_used, reason = "tests")]

use std::fs;

use proptest::prelude::*;
use sh_core::Order;

use super::*;
use crate::{Geometry, TransferVectors, ViewMap, ZonalTransfer};

fn geometry() -> Geometry {
    Geometry {
        positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1e-30]],
        normals: vec![[0.0, 0.0, 1.0]; 3],
        triangles: vec![[0, 1, 2], [2, 1, 0]],
        albedo: vec![[0.5, 0.25, 1.0]; 3],
        uvs: Some(vec![[0.0, 1.0]; 3]),
    }
}

fn surface() -> BakedSurface {
    let order = Order::new(2).unwrap();
    let value = |i: usize| i as f32 * 0.25 - 1.0;
    BakedSurface {
        metadata: Metadata {
            rays: 64,
            bounces: 1,
            seed: u64::MAX,
            shadowed: true,
            source: Some(Source { name: "a b.obj".to_owned(), sha256: "00ff".to_owned() }),
            identity: Some("12ab".to_owned()),
            error: Some(0.001_25),
            target_error: Some(0.002),
            fit_error: None,
        },
        geometry: geometry(),
        transfer: TransferVectors { order, channels: 3, values: (0..36).map(value).collect() },
        transfer_shadowed: Some(TransferVectors { order, channels: 1, values: (0..12).map(value).collect() }),
        validity: Some(vec![1.0, 0.25, 0.0]),
    }
}

fn bytes_of(surface: &BakedSurface) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.prt");
    assert_eq!(surface.write(&path).unwrap(), fs::metadata(&path).unwrap().len());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    fs::read(path).unwrap()
}

/// The file with `from` in its header replaced by `to`, which must be as long.
fn altered(from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut bytes = bytes_of(&surface());
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect("the header has it");
    bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
    bytes
}

#[test]
fn what_is_written_is_read() {
    let mut surface = surface();
    assert_eq!(read::file(&bytes_of(&surface)).unwrap(), BakedFile::Vectors(surface.clone()));
    surface.geometry.uvs = None;
    surface.transfer_shadowed = None;
    surface.metadata.source = None;
    surface.metadata.error = None;
    assert_eq!(read::file(&bytes_of(&surface)).unwrap(), BakedFile::Vectors(surface.clone()));
}

#[test]
fn the_same_surface_is_the_same_bytes() {
    assert!((0..8).all(|_| bytes_of(&surface()) == bytes_of(&surface())));
}

#[test]
fn tensors_have_the_promised_names_types_and_shapes() {
    let info = read::info(&bytes_of(&surface())).unwrap();
    let described: Vec<String> =
        info.tensors.iter().map(|tensor| format!("{} {} {:?}", tensor.name, tensor.dtype, tensor.shape)).collect();
    assert_eq!(
        described,
        [
            "albedo F32 [3, 3]",
            "index U32 [2, 3]",
            "normal F32 [3, 3]",
            "position F32 [3, 3]",
            "transfer F32 [3, 3, 4]",
            "transfer_shadowed F32 [3, 1, 4]",
            "uv F32 [3, 2]",
            "validity F32 [3]"
        ]
    );
    assert_eq!(info.metadata["format"], "prt/1");
    assert_eq!(info.metadata["kind"], "vertex-transfer");
    assert_eq!(info.metadata["convention"], "real, condon-shortley, i=l(l+1)+m");
    assert_eq!(info.metadata["source"], "a b.obj sha256:00ff");
}

#[test]
fn wrong_files_are_refused_with_the_reason() {
    let cases = [
        ("prt/1", "prt/2", "newer than"),
        ("prt/1", "prt/0", "its format is prt/0"),
        ("\"order\":\"2\"", "\"order\":\"3\"", "tensor transfer has shape [3, 3, 4]; [3, 3, 9]"),
        ("\"order\":\"2\"", "\"order\":\"0\"", "its order is 0"),
        ("\"order\":\"2\"", "\"order\":\"x\"", "not a valid value"),
        ("\"rays\":\"64\"", "\"ways\":\"64\"", "no entry \"rays\""),
        ("\"error\":\"1.25e-3\"", "\"error\":\"-nan...\"", "\"error\""),
        ("\"error\":\"1.25e-3\"", "\"error\":\"-1.5e-3\"", "a number from 0 on"),
        ("vertex-transfer", "vertex-sediment", "kind"),
        ("[2,3]", "[3,2]", "tensor index has shape [3, 2]; [any, 3]"),
        ("\"albedo\"", "\"albino\"", "tensor albedo is missing"),
        ("[3,2]", "[2,3]", "tensor uv has shape"),
    ];
    for (from, to, reason) in cases {
        let error = read::file(&altered(from, to)).unwrap_err();
        assert!(error.contains(reason), "{from} -> {to}: {error}");
    }
}

#[test]
fn wrong_values_are_refused() {
    let mut wild = surface();
    wild.geometry.triangles[1][2] = 3;
    assert!(read::file(&bytes_of(&wild)).unwrap_err().contains("face 1 of tensor index uses vertex 3 of 3"));
    let mut undefined = surface();
    undefined.transfer.values[5] = f32::NAN;
    assert!(read::file(&bytes_of(&undefined)).unwrap_err().contains("tensor transfer has the value NaN at element 5"));
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.prt");
    fs::write(&path, &bytes_of(&surface())[..300]).unwrap();
    assert!(BakedSurface::read(&path).unwrap_err().to_string().contains("cut.prt"));
    assert!(BakedSurface::read(folder.path()).is_err());
    assert!(file_info(&folder.path().join("absent.prt")).unwrap_err().to_string().contains("absent.prt"));
    let mut short = surface();
    short.geometry.normals.pop();
    assert!(short.write(&path).unwrap_err().to_string().contains("2 normals for 3"));
}

/// Lobes that count up, for any shape.
fn lobes(points: usize, rows: usize, channels: usize) -> ZonalTransfer {
    let (order, lobe_count, explicit_count) = (Order::new(3).unwrap(), 2, 4);
    let counting = |count: usize| (0..count).map(|i| i as f32 * 0.5).collect::<Vec<f32>>();
    let axes = [[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]];
    ZonalTransfer {
        order,
        rows,
        channels,
        lobe_count,
        explicit_count,
        explicit: counting(points * rows * channels * explicit_count),
        axes: axes.into_iter().cycle().take(points * rows * lobe_count).collect(),
        coeffs: counting(points * rows * channels * lobe_count * order.get()),
        view_map: (rows > 1).then(|| ViewMap { size: 4, values: counting(16 * rows) }),
    }
}

fn zonal_surface(rows: usize, channels: usize) -> ZonalSurface {
    let metadata = Metadata { fit_error: Some(0.015), ..surface().metadata };
    ZonalSurface { metadata, geometry: geometry(), transfer: lobes(3, rows, channels) }
}

fn zonal_texture(rows: usize, channels: usize) -> ZonalTexture {
    ZonalTexture {
        metadata: surface().metadata,
        width: 3,
        height: 2,
        heights: vec![0.25; 6],
        normals: vec![[0.0, 0.0, 1.0]; 6],
        albedo: [0.8, 0.5, 0.25],
        material: if rows > 1 { Material::Glossy } else { Material::Translucent },
        is_coherent: rows == 1,
        transfer: lobes(6, rows, channels),
    }
}

/// The bytes that a writer makes.
fn written(write: impl FnOnce(&Path) -> Result<u64, Error>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    assert_eq!(write(&path).unwrap(), fs::metadata(&path).unwrap().len());
    fs::read(path).unwrap()
}

/// Name and shape of the tensors of lobes.
fn lobe_tensors(bytes: &[u8]) -> Vec<String> {
    let tensors = read::info(bytes).unwrap().tensors.into_iter();
    let tensors = tensors.filter(|tensor| ["explicit", "lobe_axis", "lobe_coeff", "view_map"].contains(&&*tensor.name));
    tensors.map(|tensor| format!("{} {:?}", tensor.name, tensor.shape)).collect()
}

#[test]
fn lobes_come_back_in_every_shape() {
    for (rows, channels) in [(1, 1), (1, 3), (2, 1), (3, 3)] {
        let (surface, texture) = (zonal_surface(rows, channels), zonal_texture(rows, channels));
        assert_eq!(read::file(&written(|path| surface.write(path))).unwrap(), BakedFile::Zonal(surface));
        assert_eq!(read::file(&written(|path| texture.write(path))).unwrap(), BakedFile::Texture(texture));
    }
}

#[test]
fn tensors_of_lobes_have_the_promised_shapes() {
    let shapes = |rows, channels| lobe_tensors(&written(|path| zonal_surface(rows, channels).write(path)));
    assert_eq!(shapes(1, 1), ["explicit [3, 4]", "lobe_axis [3, 2, 3]", "lobe_coeff [3, 2, 3]"]);
    assert_eq!(shapes(1, 3), ["explicit [3, 3, 4]", "lobe_axis [3, 2, 3]", "lobe_coeff [3, 3, 2, 3]"]);
    assert_eq!(
        shapes(2, 3),
        ["explicit [3, 2, 3, 4]", "lobe_axis [3, 2, 2, 3]", "lobe_coeff [3, 2, 3, 2, 3]", "view_map [4, 4, 2]"]
    );
    let texture = lobe_tensors(&written(|path| zonal_texture(1, 1).write(path)));
    assert_eq!(texture, ["explicit [2, 3, 4]", "lobe_axis [2, 3, 2, 3]", "lobe_coeff [2, 3, 2, 3]"]);
}

#[test]
fn wrong_lobes_are_refused() {
    let refused = |bytes: Vec<u8>| read::file(&bytes).unwrap_err();
    let mut long = zonal_surface(1, 1);
    long.transfer.axes[3] = [0.0, 0.0, 2.0];
    assert!(
        refused(written(|path| long.write(path))).contains("lobe 3 of tensor lobe_axis has the axis [0.0, 0.0, 2.0]")
    );
    let mut viewless = zonal_surface(2, 1);
    viewless.transfer.view_map = None;
    assert!(refused(written(|path| viewless.write(path))).contains("view_map is missing; there are 2 rows"));
    let mut short = zonal_texture(1, 1);
    short.transfer.coeffs.pop();
    let error = short.write(Path::new("never")).unwrap_err().to_string();
    assert!(error.contains("35 lobe coefficients for 6 points; 36 are needed"), "{error}");
}

#[test]
fn a_file_of_another_kind_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lobes.prt");
    zonal_surface(1, 1).write(&path).unwrap();
    let error = BakedSurface::read(&path).unwrap_err().to_string();
    assert!(error.ends_with("lobes.prt is a baked file of kind zonal; vertex-transfer is needed"), "{error}");
    assert!(ZonalTexture::read(&path).unwrap_err().to_string().contains("texture-zonal is needed"));
}

#[test]
fn a_texture_is_an_image_of_named_channels() {
    use ::exr::prelude::{ReadChannels, ReadLayers};
    let texture = zonal_texture(2, 3);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("texture.exr");
    assert_eq!(texture.write_exr(&path).unwrap(), fs::metadata(&path).unwrap().len());
    let read = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = read.first_valid_layer().all_attributes().from_file(&path).unwrap();
    let layer = image.layer_data;
    assert_eq!((layer.size.x(), layer.size.y()), (3, 2));
    let plane = |name: &str| -> Vec<f32> {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).expect(name);
        channel.sample_data.values_as_f32().collect()
    };
    assert_eq!(layer.channel_data.list.len(), 4 + 2 * (3 * 4 + 2 * 3 + 3 * 2 * 3));
    assert_eq!(plane("height"), texture.heights);
    // Texel p, row 1, channel g (1), lobe 0, band 2: entry ((2p + 1)·3 + 1)·2·3 + 2, whose value is half its number.
    let expected: Vec<f32> = (0..6).map(|p| (((2 * p + 1) * 3 + 1) * 6 + 2) as f32 * 0.5).collect();
    assert_eq!(plane("row1.lobe0.coeff.2.g"), expected);
    assert_eq!(plane("row0.lobe0.axis.z"), [0.8; 6]);
}

proptest! {
    #[test]
    fn no_damage_to_lobes_makes_the_reader_panic(place in 0_usize..2500, byte in any::<u8>(), cut in 0_usize..2500) {
        let mut bytes = written(|path| zonal_surface(2, 3).write(path));
        let place = place % bytes.len();
        bytes[place] = byte;
        bytes.truncate(bytes.len().min(cut.max(8)));
        let _ = read::file(&bytes);
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read::file(&bytes);
    }

    #[test]
    fn no_damage_makes_the_reader_panic(place in 0_usize..1500, byte in any::<u8>(), cut in 0_usize..1500) {
        let mut bytes = bytes_of(&surface());
        let place = place % bytes.len();
        bytes[place] = byte;
        bytes.truncate(bytes.len().min(cut.max(8)));
        let _ = read::file(&bytes);
    }
}
