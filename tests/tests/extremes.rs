//! Bakes of what is very small, very large, very thin, or broken.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::collections::HashMap;
use std::path::Path;

use glam::{DQuat, DVec3, EulerRot};
use proptest::prelude::*;
use prt_bake::{
    BakeOptions, BakeReport, BakedSurface, InsidePolicy, Mesh, MeshOptions, MeshReport, MeshSource, bake_diffuse,
    load_mesh,
};
use prt_tests::{SceneBuilder, data_path, grid, icosphere};
use sh_core::Order;

const GREY: [f32; 3] = [0.8; 3];

fn options(n: usize, rays: usize) -> BakeOptions {
    BakeOptions { order: Order::new(n).unwrap(), rays_per_vertex: rays, ..BakeOptions::default() }
}

fn bake(mesh: &Mesh, options: &BakeOptions) -> (BakedSurface, BakeReport) {
    bake_diffuse(mesh, options, &()).unwrap()
}

fn source(mesh: &Mesh) -> MeshSource {
    MeshSource {
        positions: mesh.positions().to_vec(),
        normals: mesh.normals().to_vec(),
        albedo: mesh.albedo().to_vec(),
        triangles: mesh.triangles().to_vec(),
        ..MeshSource::default()
    }
}

fn cleaned(source: MeshSource) -> (Mesh, MeshReport) {
    Mesh::new(source, &MeshOptions::default()).unwrap()
}

/// The same mesh with each position changed.
fn moved(mesh: &Mesh, change: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut source = source(mesh);
    source.positions.iter_mut().for_each(|position| *position = change(DVec3::from_array(*position)).to_array());
    cleaned(source).0
}

/// A ball that sinks into a floor between two walls. The walls go on below and beside the floor: where sheets end flush in one corner, what is seen
/// from the corner past their edges depends on the rounding of the origin, which is up to a tenth of its distance from the corner.
fn scene() -> Mesh {
    SceneBuilder::default()
        .add(grid(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::X, 2.0 * DVec3::Y, 9), GREY)
        .add(grid(DVec3::new(-1.0, -1.1, -0.2), 2.2 * DVec3::Y, 1.2 * DVec3::Z, 5), GREY)
        .add(grid(DVec3::new(1.0, -1.1, -0.2), 1.2 * DVec3::Z, 2.2 * DVec3::Y, 5), GREY)
        .add(icosphere(DVec3::new(0.13, 0.07, 0.2), 0.33, 2), GREY)
        .build()
        .unwrap()
}

/// Length of the difference over the length.
fn relative_difference(found: &[f32], expected: &[f32]) -> f64 {
    let square = |sum: f64, value: f64| sum + value * value;
    let difference = found.iter().zip(expected).map(|(a, b)| f64::from(a - b)).fold(0.0, square);
    (difference / expected.iter().map(|&b| f64::from(b)).fold(0.0, square)).sqrt()
}

fn is_finite(baked: &BakedSurface) -> bool {
    baked.transfer.values.iter().all(|value| value.is_finite())
}

/// What each vertex sends out under constant light 1, but for its albedo.
fn under_constant_light(baked: &BakedSurface) -> Vec<f64> {
    let rows = baked.transfer.values.chunks(baked.transfer.order.coeff_count());
    rows.map(|row| f64::from(row[0]) * (4.0 * std::f64::consts::PI).sqrt()).collect()
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit_of_transfer() {
    let options = BakeOptions { bounces: 1, ..options(4, 256) };
    let reference = bake(&scene(), &options).0.transfer;
    for exponent in [-60, -20, -1, 3, 20, 60] {
        let mesh = moved(&scene(), |position| position * 2.0_f64.powi(exponent));
        assert_eq!(bake(&mesh, &options).0.transfer, reference, "2^{exponent}");
    }
}

#[test]
fn size_and_place_change_transfer_by_no_more_than_rounding() {
    // Vertices inside keep their own: what they are filled from is weighted by distances in the file, whose positions are f32.
    let options = BakeOptions { bounces: 1, inside: InsidePolicy::Keep, ..options(4, 256) };
    let reference = bake(&scene(), &options).0.transfer.values;
    for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (3.0, 0.0), (1.0, 1e6), (1e-3, 1.0), (7e5, -1e6), (1e30, 0.0)] {
        let mesh = moved(&scene(), |position| position * scale + offset);
        let error = relative_difference(&bake(&mesh, &options).0.transfer.values, &reference);
        // Another scale rounds positions to f32 differently, by 6e-8; that may decide about a ray at an edge, which is 1/256 of a vector.
        // Offsets lose digits of the positions themselves: 1e6 with f64's 2e-16 leaves 1e-10, 1e-3 at 1.0 leaves 2e-13.
        assert!(error <= 1e-6, "scale {scale} offset {offset}: {error}");
    }
}

#[test]
fn a_plane_never_shadows_itself() {
    // Orders 1 and 32; seen from any side, at any scale, far away, on edge with the axes and not.
    let turns = [
        DQuat::IDENTITY,
        DQuat::from_rotation_x(0.5 * std::f64::consts::PI),
        DQuat::from_euler(EulerRot::XYZ, 0.3, 1.1, 2.0),
    ];
    for (cells, turn) in [1, 7, 40].into_iter().flat_map(|cells| turns.map(|turn| (cells, turn))) {
        for (scale, offset) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (0.37, 3.0)] {
            let [corner, u, v] = [DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y].map(|v| turn * v * scale);
            let mesh = SceneBuilder::default().add(grid(corner + offset, u, v, cells), GREY).build().unwrap();
            let (baked, report) = bake(&mesh, &options(if cells == 1 { 32 } else { 1 }, 128));
            assert_eq!(report.occluded_share, 0.0, "{cells} cells, {turn}, scale {scale}, offset {offset}");
            assert_eq!(baked.transfer, baked.unshadowed());
        }
    }
}

#[test]
fn faces_far_longer_than_wide_hardly_shadow_themselves() {
    // Rounding turns the plane of such a face by the ratio of its sides times 1e-7 and more, so that rays at that angle over the horizon may
    // meet it. Measured: nothing at 1:10 and 6.8e-4 at 1:10,000; beyond a million the face is not more than rounding is.
    for (aspect, bound) in [(1e-2, 1e-6), (1e-4, 2e-3)] {
        for turn in [DQuat::IDENTITY, DQuat::from_euler(EulerRot::XYZ, 0.3, 1.1, 2.0)] {
            let [corner, u, v] = [DVec3::new(-0.5, -0.5 * aspect, 0.0), DVec3::X, aspect * DVec3::Y].map(|v| turn * v);
            let mesh = SceneBuilder::default().add(grid(corner, u, v, 10), GREY).build().unwrap();
            let (baked, _) = bake(&mesh, &options(4, 512));
            let error = relative_difference(&baked.transfer.values, &baked.unshadowed().values);
            assert!(error <= bound, "1:{aspect} {turn}: {error}");
        }
    }
}

/// A closed box seen from inside; each side of `cells²`.
fn room(cells: u32) -> Mesh {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    [(DVec3::ZERO, x, y), (z, y, x), (DVec3::ZERO, y, z), (x, z, y), (DVec3::ZERO, z, x), (y, x, z)]
        .into_iter()
        .fold(SceneBuilder::default(), |builder, (corner, u, v)| builder.add(grid(corner, u, v, cells), [0.0; 3]))
        .build()
        .unwrap()
}

#[test]
fn no_light_comes_through_the_edges_and_corners_of_a_closed_box() {
    for cells in [1, 4] {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, 0.2, 1.9);
        let turned = moved(&room(cells), |position| turn * position);
        for mesh in [
            room(cells),
            moved(&room(cells), |p| p * 1e-6),
            moved(&room(cells), |p| p * 1e6 + 1e6),
            moved(&room(cells), |p| p + 1e6),
        ] {
            let baked = bake(&mesh, &BakeOptions { bounces: 1, ..options(3, 2048) }).0;
            assert!(baked.transfer.values.iter().all(|&value| value == 0.0), "{cells} cells");
        }
        let mut source = source(&turned);
        source
            .normals
            .iter_mut()
            .for_each(|normal| *normal = (turn.as_quat() * glam::Vec3::from_array(*normal)).to_array());
        let baked = bake(&cleaned(source).0, &options(3, 2048)).0;
        assert!(baked.transfer.values.iter().all(|&value| value == 0.0), "{cells} cells, turned");
    }
}

#[test]
fn a_convex_body_never_shadows_itself() {
    // Rays start right beside faces whose edges they must not meet: once triangles were wider by a length, which next to the origin was a
    // large angle, and a turned cube of 12 triangles lost half of its light.
    for cells in [1, 5] {
        for turn in [DQuat::IDENTITY, DQuat::from_euler(EulerRot::XYZ, 0.4, 0.2, 1.9)] {
            for (scale, offset) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 1e6)] {
                let mut inside_out = source(&room(cells));
                inside_out.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
                inside_out.normals.clear();
                for position in &mut inside_out.positions {
                    *position = (turn * DVec3::from_array(*position) * scale + offset).to_array();
                }
                let (baked, report) = bake(&cleaned(inside_out).0, &options(6, 1024));
                assert_eq!(report.occluded_share, 0.0, "{cells} cells, {turn}, scale {scale}, offset {offset}");
                assert_eq!(baked.transfer, baked.unshadowed());
            }
        }
    }
}

/// Two squares that face each other at a distance, each of `cells²`.
fn gap(width: f64, turn: DQuat) -> Mesh {
    let builder = SceneBuilder::default()
        .add(grid(turn * DVec3::new(-0.5, -0.5, 0.0), turn * DVec3::X, turn * DVec3::Y, 4), [0.0; 3])
        .add(grid(turn * DVec3::new(-0.5, -0.5, width), turn * DVec3::Y, turn * DVec3::X, 4), [0.0; 3]);
    builder.build().unwrap()
}

#[test]
fn thin_gaps_are_dark_and_thin_slabs_are_bright() {
    for turn in [DQuat::IDENTITY, DQuat::from_euler(EulerRot::XYZ, 0.4, 0.2, 1.9)] {
        for width in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let light = under_constant_light(&bake(&gap(width, turn), &options(1, 512)).0);
            let brightest = light.chunks(25).map(|plate| plate[12]).fold(0.0, f64::max);
            // From the middle rays leave only at less than 2 `width` above the plate: a share of the order of its square.
            assert!(brightest < 16.0 * width * width + 1e-6, "gap {width}: {brightest}");
            // The other way round: a slab whose sides face outwards.
            let mut slab = source(&gap(width, turn));
            slab.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
            slab.normals.iter_mut().flatten().for_each(|coordinate| *coordinate = -*coordinate);
            let (baked, report) = bake(&cleaned(slab).0, &options(4, 512));
            assert_eq!((report.occluded_share, baked.transfer == baked.unshadowed()), (0.0, true), "slab {width}");
        }
    }
}

#[test]
fn one_triangle_and_one_vertex_used_by_many() {
    let single = MeshSource {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1e-3, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..MeshSource::default()
    };
    for n in [1, 32] {
        let (baked, _) = bake(&cleaned(single.clone()).0, &options(n, 64));
        assert_eq!(baked.transfer, baked.unshadowed());
    }
    // A cone of 2,000 faces about its tip, and the same turned inside out: a funnel.
    let count = 2_000;
    for tip in [1.0, -1.0] {
        let rim = (0..count).map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(count));
        let mut positions: Vec<[f64; 3]> = rim.map(|angle| [angle.cos(), angle.sin(), 0.0]).collect();
        positions.push([0.0, 0.0, tip]);
        let triangles = (0..count).map(|k| [k, (k + 1) % count, count]).collect();
        let mesh = cleaned(MeshSource { positions, triangles, ..MeshSource::default() }).0;
        let (baked, _) = bake(&mesh, &options(2, 64));
        assert!(is_finite(&baked));
        let light = under_constant_light(&baked)[count as usize];
        // From the tip of the cone the sky is open; the funnel's walls rise at 45 degrees and leave the half of it that is in sin² 45°.
        let (expected, bound) = if tip > 0.0 { (1.0, 1e-6) } else { (0.5, 0.03) };
        assert!((light - expected).abs() <= bound, "tip {tip}: {light}");
    }
}

#[test]
fn what_cannot_be_used_is_dropped_and_counted() {
    let mut broken = source(&scene());
    let count = u32::try_from(broken.positions.len()).unwrap();
    let extreme = [
        [f64::NAN, 0.0, 0.0],
        [f64::INFINITY, 1.0, 0.0],
        [0.0, -1e39, 0.0],
        [0.5, 0.5, 0.5],
        [0.5 + 1e-13, 0.5, 0.5],
        [0.75, 0.5, 0.5],
    ];
    broken.positions.extend(extreme);
    broken.normals.extend([[0.0, 0.0, 1.0]; 6]);
    broken.albedo.extend([GREY; 6]);
    broken.triangles.extend([
        [0, 1, count],
        [0, 1, count + 1],
        [0, 1, count + 2],
        [0, 0, 1],
        [count + 3, count + 4, count + 5],
    ]);
    broken.triangles.push(broken.triangles[0]);
    let (mesh, report) = cleaned(broken);
    assert_eq!((report.non_finite, report.degenerate, report.duplicate), (3, 2, 1));
    assert_eq!(bake(&mesh, &options(3, 64)).0.transfer, bake(&scene(), &options(3, 64)).0.transfer);
    // The largest coordinates that the file can hold.
    let huge = moved(&scene(), |position| position * 1e38);
    assert_eq!(
        bake(&moved(&huge, |p| p * 2.0_f64.powi(-40)), &options(3, 64)).0.transfer,
        bake(&huge, &options(3, 64)).0.transfer
    );
}

#[test]
fn broken_topology_bakes() {
    // Turned inside out, the same faces twice in both senses, three sheets on one edge, a part in the plane of another one.
    let sheet = |corner: DVec3, v: DVec3| grid(corner, DVec3::X, v, 3);
    let builder = SceneBuilder::default()
        .add(sheet(DVec3::ZERO, DVec3::Y), GREY)
        .add(sheet(DVec3::ZERO, DVec3::Z), GREY)
        .add(sheet(DVec3::ZERO, DVec3::NEG_Y), GREY)
        .add(grid(DVec3::new(0.21, 0.17, 0.0), 0.5 * DVec3::X, 0.5 * DVec3::Y, 2), GREY)
        .add(icosphere(DVec3::new(0.5, 0.5, 0.1), 0.3, 2), GREY);
    let mut broken = source(&builder.build().unwrap());
    let turned = broken.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect::<Vec<_>>();
    let half = turned.len() / 2;
    broken.triangles.extend(&turned[..half]);
    broken.triangles[half..].iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
    for inside in [InsidePolicy::Fill, InsidePolicy::Keep, InsidePolicy::Black] {
        let (baked, report) = bake(&cleaned(broken.clone()).0, &BakeOptions { bounces: 2, inside, ..options(3, 128) });
        assert!(is_finite(&baked));
        assert!(under_constant_light(&baked).iter().all(|&light| (-1e-6..=1.0 + 1e-6).contains(&light)));
        assert!(report.vertices.iter().all(|stats| (0.0..=1.0).contains(&stats.validity)));
    }
}

#[test]
fn a_scanned_mesh_that_is_no_manifold_bakes() {
    let name = "a_scanned_mesh_that_is_no_manifold_bakes";
    let Some(path) = data_path(name, "meshes/dragon_res3_nonmanifold.ply") else { return };
    let (mesh, _) = cleaned(load_mesh(&path).unwrap());
    let (baked, report) = bake(&mesh, &BakeOptions { bounces: 1, ..options(3, 64) });
    assert!(is_finite(&baked));
    assert!(under_constant_light(&baked).iter().all(|&light| (-1e-6..=1.0 + 1e-6).contains(&light)));
    // An eighth of its vertices lies in its own folds: 3,522 measured.
    assert!((3000..4000).contains(&report.invalid_vertices), "{}", report.invalid_vertices);
}

/// A mesh whose triangles are split in four at the middles of their edges, `times` over.
fn subdivided(path: &Path, times: u32) -> Mesh {
    let MeshSource { mut positions, mut triangles, .. } = load_mesh(path).unwrap();
    for _ in 0..times {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let [a, b] = [a, b].map(|vertex| DVec3::from_array(positions[vertex as usize]));
                positions.push((0.5 * (a + b)).to_array());
                positions.len() as u32 - 1
            })
        };
        let split = |&[a, b, c]: &[u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.iter().flat_map(split).collect();
    }
    cleaned(MeshSource { positions, triangles, ..MeshSource::default() }).0
}

#[test]
fn a_million_triangles_bake() {
    let Some(path) = data_path("a_million_triangles_bake", "meshes/spot.obj") else { return };
    let mesh = subdivided(&path, 4);
    assert!(mesh.triangles().len() > 1_400_000, "{}", mesh.triangles().len());
    let (baked, report) = bake(&mesh, &options(1, 1));
    assert!(is_finite(&baked));
    // At the vertices of the mesh that was split 0.154 of the directions are occluded; its shape is the same.
    assert!((0.1..0.2).contains(&report.occluded_share), "{}", report.occluded_share);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Weights of a vertex's directions add up to 1 and albedo is at most 1, so what a pass brings is at most what the one before did.
    #[test]
    fn no_pass_adds_energy_in_a_soup_of_triangles(
        corners in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 9..60),
        seed in 0..1000_u64,
        inside in 0..3_usize,
    ) {
        let count = corners.len() as u32 / 3;
        // Half of the corners are shared with the triangle before.
        let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, (3 * k + 2).saturating_sub(3 * (k % 2))]).collect();
        let albedo = vec![[1.0; 3]; corners.len()];
        let (mesh, _) = cleaned(MeshSource { positions: corners, triangles, albedo, ..MeshSource::default() });
        let inside = InsidePolicy::NAMES[inside].parse().unwrap();
        let mut before = vec![0.0; mesh.positions().len()];
        let mut largest = f64::INFINITY;
        for bounces in 0..4 {
            let (baked, _) = bake(&mesh, &BakeOptions { bounces, seed, inside, ..options(2, 64) });
            let light = under_constant_light(&baked);
            // Rounding of f32 in each of the passes.
            prop_assert!(light.iter().all(|&light| (-1e-6..=1.0 + 1e-6).contains(&light)));
            let added = light.iter().zip(&before).map(|(light, before)| light - before);
            prop_assert!(added.clone().all(|added| added >= -1e-6));
            let most = added.fold(0.0, f64::max);
            prop_assert!(most <= largest + 1e-6, "{} after {}", most, largest);
            (before, largest) = (light, most);
        }
    }
}

#[test]
fn interreflection_stops_by_itself() {
    let auto = BakeOptions { bounces: 50, bounce_threshold: Some(1e-2), ..options(2, 128) };
    let (baked, report) = bake(&scene(), &auto);
    let passes = report.bounce_energy.len();
    assert!((2..20).contains(&passes), "{:?}", report.bounce_energy);
    let (last, others) = report.bounce_energy.split_last().unwrap();
    assert!(*last < 1e-2 && others.iter().all(|&added| added >= 1e-2), "{:?}", report.bounce_energy);
    let (counted, _) = bake(&scene(), &BakeOptions { bounces: passes, ..options(2, 128) });
    assert_eq!((baked.transfer, baked.metadata.bounces), (counted.transfer, passes));
    // Zero asks for all.
    let all = bake(&scene(), &BakeOptions { bounces: 4, bounce_threshold: Some(0.0), ..options(2, 128) }).1;
    assert_eq!(all.bounce_energy.len(), 4);
    for wrong in [-0.1, 1.0, f64::NAN] {
        let error =
            bake_diffuse(&scene(), &BakeOptions { bounce_threshold: Some(wrong), ..options(2, 128) }, &()).unwrap_err();
        assert!(error.to_string().contains("bounce threshold"), "{error}");
    }
}
