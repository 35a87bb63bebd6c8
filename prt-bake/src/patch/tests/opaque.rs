//! Opaque patches: closed forms, a second way, extremes.

use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::{BakeOptions, Mesh, MeshOptions, TransferVectors, bake_diffuse};

#[test]
fn a_level_field_is_unshadowed_exactly() {
    for (width, height) in [(1, 1), (2, 1), (1, 64), (3, 5)] {
        for n in [1, 2, 6, 16] {
            let field = flat(width, height);
            let (transfer, report) = bake_patch(&field, &PatchOptions { bounces: 1, ..options(n, 64) }, &()).unwrap();
            assert_eq!(transfer.values, TransferVectors::unshadowed(order(n), &transfer.normals).values);
            assert_eq!((report.occluded_share, report.error, report.bounce_energy), (0.0, Some(0.0), vec![0.0]));
        }
    }
}

/// A groove along y with flat sides: heights `top · |2u − 1|`, `size` texels across and `rows` along.
fn groove(size: usize, rows: usize, top: f32) -> HeightField {
    HeightField::from_function([size, rows], top, |u, _| (2.0 * u - 1.0).abs()).unwrap()
}

#[test]
fn a_groove_sees_what_its_section_lets_in() {
    // Light from all sides reaches a point of an endless groove in proportion to (sin a − sin b)/2, where a and b are the angles between
    // the normal and the two edges of the opening, seen in the cross section: the radiation view factor of a strip.
    let (size, top) = (16, 0.5);
    let field = groove(size, 2, top);
    let transfer = bake(&field, &options(3, 16_384));
    // Without the two texels of the ridge itself, which is level between them.
    for column in 1..size - 1 {
        let [x, _, z] = field.position(column);
        let normal = field.normal(column);
        let tilt = f64::from(normal[0]).atan2(f64::from(normal[2]));
        // The opening: the sharp ridge between the last texel and the first of the next tile stands at half its height.
        let ridge = f64::from(field.heights()[0]);
        let edges = [0.5 / size as f64, 1.0 - 0.5 / size as f64].map(|edge| (edge - x, ridge - z));
        let seen = |(across, up): (f64, f64)| if up <= 1e-12 { PI / 2.0 * across.signum() } else { across.atan2(up) };
        let angles = edges.map(seen);
        let angles = angles.map(|angle| (angle - tilt).clamp(-PI / 2.0, PI / 2.0));
        let expected = 0.5 * (angles[1].sin() - angles[0].sin());
        let found = white(transfer.vector(column, 0, 0));
        // Measured 1.4e-3 at most, from 16,384 directions.
        assert!((found - expected).abs() < 3e-3, "column {column}: {found} {expected}");
    }
}

#[test]
fn bumps_agree_with_the_baked_mesh_of_five_tiles() {
    let field = HeightField::bumps(12, 0.2).unwrap();
    let source = field.mesh([5, 5]);
    let columns = 5 * 12 + 1;
    let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
    assert_eq!((report.faces_dropped(), report.vertices_split), (0, 0));
    for bounces in [0, 1] {
        let options = PatchOptions { bounces, ..options(4, 1024) };
        let tile = bake(&field, &options);
        let whole = BakeOptions { order: options.order, rays_per_vertex: 1024, bounces, ..BakeOptions::default() };
        let whole = bake_diffuse(&mesh, &whole, &()).unwrap().0;
        let middle: Vec<f32> = (0..field.texel_count())
            .flat_map(|texel| whole.transfer.vector((24 + texel / 12) * columns + 24 + texel % 12, 0).to_vec())
            .collect();
        let difference = relative_difference(&tile.values, &middle);
        // The mesh ends after two tiles, so that light comes in over bumps 2 tiles away.
        assert!(difference < 2e-3, "{bounces} bounces: {difference}");
        let unshadowed = TransferVectors::unshadowed(options.order, &tile.normals);
        assert!(relative_difference(&tile.values, &unshadowed.values) > 0.05);
    }
}

#[test]
fn a_moved_field_has_moved_transfer() {
    let field = rough(6, 5, 0.3, 9);
    let options = PatchOptions { bounces: 1, ..options(4, 256) };
    let transfer = bake(&field, &options);
    for by in [[1, 0], [0, 2], [5, 4]] {
        let other = bake(&shifted(&field, by), &options);
        for texel in 0..field.texel_count() {
            let (a, b) = (other.vector(texel, 0, 0), transfer.vector(moved(&field, texel, by), 0, 0));
            // The same rays, but sums of other roundings; a ray that grazes a corner may fall on either side.
            assert!(relative_difference(a, b) < 1e-4, "{by:?} {texel}");
        }
    }
}

#[test]
fn light_between_white_walls_is_not_lost() {
    // White furnace: at albedo 1 all that is blocked comes back after enough bounces. The rest, 1 − w_b, shrinks by the share of each
    // texel's hemisphere that is surface.
    let field = rough(6, 6, 0.4, 4);
    let with = |bounces| bake(&field, &PatchOptions { bounces, albedo: [1.0; 3], ..options(1, 512) });
    let direct = with(0);
    let worst = |transfer: &PatchTransfer| transfer.values.iter().map(|&v| white(&[v])).fold(f64::INFINITY, f64::min);
    assert!(worst(&direct) < 0.5, "{}", worst(&direct));
    let many = with(200);
    for &value in &many.values {
        // Weights of the rays add up to 1 to 1e-6, and barycentric weights are rounded to 16 bits.
        assert!((white(&[value]) - 1.0).abs() < 1e-4, "{}", white(&[value]));
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let field = HeightField::weave(9, 0.2).unwrap();
    let variants = [
        PatchOptions { bounces: 2, albedo: [0.9, 0.5, 0.1], ..options(4, 128) },
        PatchOptions { bounces: 1, responses: vec![vec![0.3, 0.0, 0.5, 0.1], vec![0.2]], ..options(3, 64) },
        PatchOptions { rays_per_texel: 33, ..PatchOptions::thin() },
    ];
    for options in variants {
        let run = |threads| {
            let (transfer, report) = bake_patch(&field, &PatchOptions { threads, ..options.clone() }, &()).unwrap();
            (transfer, PatchReport { trace: Duration::ZERO, threads: 0, ..report })
        };
        let reference = run(Some(1));
        assert!([Some(2), Some(5), None].into_iter().all(|threads| run(threads) == reference));
        assert_ne!(bake(&field, &PatchOptions { seed: 1, ..options.clone() }), reference.0);
    }
}

#[test]
fn extreme_relief_is_finite_and_bounded() {
    let fields = [
        rough(8, 8, 1e6, 1),
        rough(8, 8, 1e-6, 2),
        rough(8, 8, 1e-30, 2),
        rough(1, 64, 0.1, 3),
        rough(64, 1, 0.1, 4),
        rough(2, 1, 5.0, 5),
        HeightField::new(2, 2, vec![1e6, -1e6, 1e6, 1e6]).unwrap(),
        HeightField::new(3, 1, vec![-1e6; 3]).unwrap(),
    ];
    for field in fields {
        let transfer = bake(&field, &PatchOptions { bounces: 3, ..options(3, 64) });
        for texel in 0..field.texel_count() {
            let vector = transfer.vector(texel, 0, 0);
            assert!(vector.iter().all(|value| value.is_finite()));
            // At albedo 0.8 no point receives more than all there is; nothing is negative. f32 leaves 1e-6.
            assert!((-1e-6..=1.0 + 1e-6).contains(&white(vector)), "{:?}: {}", field.range(), white(vector));
        }
    }
    // Relief of no height is level; the deepest pit is dark but for what comes straight down.
    let shallow = bake(&rough(8, 8, 1e-30, 2), &options(3, 64));
    assert_eq!(shallow.values, TransferVectors::unshadowed(order(3), &shallow.normals).values);
    let mut pit = vec![1e4; 9];
    pit[4] = 0.0;
    let dark = bake(&HeightField::new(3, 3, pit).unwrap(), &options(3, 1024));
    assert!(white(dark.vector(4, 0, 0)) < 1e-3, "{}", white(dark.vector(4, 0, 0)));
}

#[test]
fn the_estimated_error_is_the_error() {
    let field = HeightField::weave(12, 0.25).unwrap();
    let truth = bake(&field, &PatchOptions { seed: 77, ..options(5, 65_536) });
    let unshadowed = TransferVectors::unshadowed(order(5), &truth.normals);
    for rays in [64, 512] {
        let (found, report) = bake_patch(&field, &options(5, rays), &()).unwrap();
        let length = |values: &[f32]| values.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>().sqrt();
        let measured =
            relative_difference(&found.values, &truth.values) * length(&truth.values) / length(&unshadowed.values);
        let estimated = report.error.unwrap();
        assert!(measured > 0.5 * estimated && measured < 2.0 * estimated, "{rays} rays: {measured} {estimated}");
    }
}

#[test]
fn a_bake_can_be_stopped_and_tells_its_progress() {
    use std::sync::atomic::{AtomicU64, Ordering};

    #[derive(Default)]
    struct Counter(AtomicU64, AtomicU64, bool);
    impl Progress for Counter {
        fn advance(&self, texels: usize, rays: u64) {
            self.0.fetch_add(texels as u64, Ordering::Relaxed);
            self.1.fetch_add(rays, Ordering::Relaxed);
        }
        fn is_cancelled(&self) -> bool {
            self.2
        }
    }
    let field = flat(5, 5);
    for options in [options(2, 16), PatchOptions { rays_per_texel: 16, ..PatchOptions::thin() }] {
        let counter = Counter::default();
        let report = bake_patch(&field, &options, &counter).unwrap().1;
        assert_eq!((counter.0.into_inner(), counter.1.into_inner()), (25, report.rays_traced));
        let stopped = bake_patch(&field, &options, &Counter(0.into(), 0.into(), true));
        assert!(matches!(stopped, Err(Error::Cancelled)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn a_mirrored_field_has_mirrored_transfer(seed in any::<u64>()) {
        // Mirrored in x: coefficients of x-odd functions change sign. The set of directions is not mirrored: noise of 512 rays remains.
        let field = rough(5, 3, 0.4, seed);
        let mirror = |texel: usize| texel / 5 * 5 + 4 - texel % 5;
        let mirrored = HeightField::new(5, 3, (0..15).map(|texel| field.heights()[mirror(texel)]).collect()).unwrap();
        let (a, b) = (bake(&field, &options(2, 2048)), bake(&mirrored, &options(2, 2048)));
        for texel in 0..15 {
            let mut expected = a.vector(mirror(texel), 0, 0).to_vec();
            expected[3] = -expected[3];
            prop_assert!(relative_difference(b.vector(texel, 0, 0), &expected) < 0.03);
        }
    }
}
