use proptest::prelude::*;

use super::scenes::{grid, square, together};
use super::{bake, mesh, options, relative_difference, texels, unshadowed};
use crate::texels::layout::Layout;
use crate::texels::raster::Raster;
use crate::{Coverage, Error, Mesh, MeshSource, TexelOptions, TransferVectors, bake_texels};
use glam::DVec3;

/// A bent strip whose normal at `(s, t)` tells `s`.
fn strip(uv: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    mesh(grid([64, 1], |[s, t]| (DVec3::new(s.sin(), t, s.cos()), DVec3::new(s.sin(), 0.0, s.cos())), uv))
}

fn expected_on_strip(s: f64) -> Vec<f32> {
    TransferVectors::unshadowed(options(3).order, &[[s.sin() as f32, 0.0, s.cos() as f32]]).values
}

fn refused(source: MeshSource) -> String {
    let error = bake_texels(&mesh(source), &unshadowed(2), &texels(8, 8), &()).unwrap_err();
    assert!(matches!(error, Error::Atlas(_)), "{error}");
    error.to_string()
}

#[test]
fn faces_that_meet_do_not_overlap() {
    // The diagonal runs through the centres of texels.
    let (atlas, report) = bake(&mesh(square(1, 0.0, true, |st| st)), &unshadowed(2), &texels(16, 16));
    assert_eq!((report.texels_inside, report.texels_overlapping), (256, 0));
    assert!(atlas.coverage.iter().all(|&coverage| coverage == Coverage::Inside));
    assert_eq!((report.faces_without_center, report.texels_per_face), (0, 136));
}

#[test]
fn overlapping_charts_are_counted_and_the_first_face_wins() {
    let pair = |first, second| mesh(together(square(1, 0.0, first, |st| st), square(1, -3.0, second, |st| st)));
    let (up_first, report) = bake(&pair(true, false), &unshadowed(3), &texels(9, 9));
    assert_eq!(report.texels_overlapping, 81);
    assert_eq!(report.faces_without_center, 2);
    let up = TransferVectors::unshadowed(options(3).order, &[[0.0, 0.0, 1.0]; 81]);
    assert_eq!(up_first.transfer, up);
    assert_ne!(bake(&pair(false, true), &unshadowed(3), &texels(9, 9)).0.transfer, up);
}

#[test]
fn a_chart_folded_onto_itself_overlaps_though_its_faces_are_neighbours() {
    let fold = |[s, t]: [f64; 2]| [1.0 - (2.0 * s - 1.0).abs(), t];
    let (_, report) = bake(&strip(fold), &unshadowed(2), &texels(8, 8));
    assert_eq!(report.texels_overlapping, 64);
}

#[test]
fn charts_may_be_mirrored_and_v_may_run_up() {
    let (plain, _) = bake(&strip(|st| st), &unshadowed(3), &texels(32, 4));
    let (mirrored, _) = bake(&strip(|[s, t]| [1.0 - s, t]), &unshadowed(3), &texels(32, 4));
    for column in 0..32 {
        let expected = expected_on_strip((column as f64 + 0.5) / 32.0);
        // Normals are interpolated over a 64th of a radian.
        assert!(relative_difference(plain.transfer.vector(column, 0), &expected) < 1e-5);
        assert!(relative_difference(mirrored.transfer.vector(31 - column, 0), &expected) < 1e-5);
    }
    let turned = |[s, t]: [f64; 2]| [t, s];
    let (down, _) = bake(&strip(turned), &unshadowed(3), &texels(4, 32));
    let (up, _) = bake(&strip(turned), &unshadowed(3), &TexelOptions { v_up: true, ..texels(4, 32) });
    for row in 0..32 {
        assert!(relative_difference(down.transfer.vector(4 * row, 0), up.transfer.vector(4 * (31 - row), 0)) < 1e-6);
    }
    let (mut a, mut b) = ([0.0; 9], [0.0; 9]);
    down.sample([0.4, 0.2], 0, &mut a);
    up.sample([0.4, 0.2], 0, &mut b);
    assert!(relative_difference(&a, &b) < 1e-6 && relative_difference(&a, &expected_on_strip(0.2)) < 1e-3);
}

#[test]
fn charts_outside_wrap_round() {
    for shift in [0.75, -0.25, 17.75] {
        let (atlas, report) = bake(&strip(|[s, t]| [0.5 * s + shift, t]), &unshadowed(3), &texels(32, 4));
        assert_eq!(atlas.wraps, [true, false]);
        assert!(report.faces_wrapped >= 64 && report.texels_overlapping == 0, "{report:?}");
        for column in 0..32 {
            // The chart begins at column 24 and ends at column 8.
            let from_start = (column + 8) % 32;
            let is_inside = atlas.coverage[column] == Coverage::Inside;
            assert_eq!(is_inside, from_start < 16, "column {column}");
            if is_inside {
                let expected = expected_on_strip((from_start as f64 + 0.5) / 16.0);
                assert!(relative_difference(atlas.transfer.vector(column, 0), &expected) < 1e-5);
            }
        }
        let mut vector = [0.0; 9];
        atlas.sample([shift as f32 + 0.25, 0.5], 0, &mut vector);
        assert!(relative_difference(&vector, &expected_on_strip(0.5)) < 1e-3);
    }
}

#[test]
fn a_face_across_the_edge_of_the_atlas_is_the_same_as_one_amid_it() {
    let point = |[s, t]: [f64; 2]| (DVec3::new(s, t, 0.0), DVec3::new(s - 0.5, t - 0.5, 1.0).normalize());
    let at = |shift: [f64; 2]| mesh(grid([1, 1], point, |st| [0, 1].map(|axis| 0.5 * st[axis] + shift[axis])));
    let (amid, _) = bake(&at([0.25, 0.25]), &unshadowed(3), &texels(16, 16));
    for (columns, rows) in [(4, 4), (8, 0), (0, 8), (8, 8)] {
        let shift = [columns, rows].map(|texels: usize| 0.25 + texels as f64 / 16.0);
        let (across, report) = bake(&at(shift), &unshadowed(3), &texels(16, 16));
        assert_eq!(across.wraps, [columns, rows].map(|texels| texels > 4));
        assert_eq!((report.texels_inside, report.texels_overlapping), (64, 0));
        for texel in 0..256 {
            let moved = (texel / 16 + rows) % 16 * 16 + (texel + columns) % 16;
            assert_eq!(across.coverage[moved] == Coverage::Inside, amid.coverage[texel] == Coverage::Inside);
            if amid.coverage[texel] == Coverage::Inside {
                let [a, b] = [across.transfer.vector(moved, 0), amid.transfer.vector(texel, 0)];
                assert!(relative_difference(a, b) < 1e-6);
            }
        }
    }
}

#[test]
fn what_is_no_atlas_is_refused_in_one_sentence() {
    let plain = || square(2, 0.0, true, |st| st);
    assert!(refused(MeshSource { uvs: Vec::new(), ..plain() }).contains("no texture coordinates"));
    let mut source = plain();
    source.uvs[4] = [0.5, f32::NAN];
    assert!(refused(source).contains("vertex 4"));
    let message = refused(square(1, 0.0, true, |[s, t]| [3.0 * s, t]));
    assert!(message.contains("repeats over 2 of 2 faces"), "{message}");
    assert!(refused(square(1, 0.0, true, |[s, t]| [1e30 * s, t])).contains("repeats"));
    assert!(refused(square(1, 0.0, true, |[s, _]| [s, s])).contains("none of its 2 faces"));
    // Far away, but with an extent that f32 no longer tells from none.
    assert!(refused(square(1, 0.0, true, |[s, t]| [1e30 + s, t])).contains("none of its 2 faces"));
}

#[test]
fn faces_without_area_on_the_atlas_are_counted() {
    let point = square(1, 5.0, true, |_| [0.9, 0.1]);
    let line = square(1, 6.0, true, |[s, _]| [s, 0.5]);
    let source = together(square(1, 0.0, true, |st| st), together(point, line));
    let (_, report) = bake(&mesh(source), &unshadowed(2), &texels(8, 8));
    assert_eq!((report.faces_degenerate, report.texels_inside), (4, 64));
    assert_eq!(report.faces_without_center, 0);
}

#[test]
fn faces_smaller_than_a_texel_are_counted_and_still_get_texels_around() {
    let small = mesh(square(1, 0.0, true, |st| st.map(|x| 0.41 + 0.01 * x)));
    let (atlas, report) = bake(&small, &unshadowed(2), &TexelOptions { gutter: 0, ..texels(8, 8) });
    assert_eq!((report.faces_without_center, report.texels_inside), (2, 0));
    let mut vector = [0.0; 4];
    atlas.sample([0.415, 0.415], 0, &mut vector);
    let up = TransferVectors::unshadowed(options(2).order, &[[0.0, 0.0, 1.0]]);
    assert!(relative_difference(&vector, &up.values) < 1e-6);
}

#[test]
fn one_texel_and_one_row() {
    let up = TransferVectors::unshadowed(options(2).order, &[[0.0, 0.0, 1.0]; 5]);
    for (width, height) in [(1, 1), (5, 1), (1, 5)] {
        let (atlas, report) = bake(&mesh(square(1, 0.0, true, |st| st)), &options(2), &texels(width, height));
        assert_eq!(atlas.transfer.values, up.values[..4 * width * height]);
        assert_eq!(report.texels_inside, width * height);
    }
}

#[test]
fn sizes_out_of_range_are_refused_before_anything_is_allocated() {
    let mesh = mesh(square(1, 0.0, true, |st| st));
    let wrong = [
        (texels(0, 4), 2, "0 × 4"),
        (texels(4, 20_000), 2, "20000"),
        (TexelOptions { gutter: 65, ..texels(4, 4) }, 2, "gutter of 65"),
        (texels(16_384, 16_384), 32, "1024.0 GiB"),
    ];
    for (texels, n, words) in wrong {
        let error = bake_texels(&mesh, &unshadowed(n), &texels, &()).unwrap_err();
        assert!(matches!(error, Error::Option(_)) && error.to_string().contains(words), "{error}");
    }
}

fn place() -> impl Strategy<Value = [f64; 2]> {
    (0.0..1.0, 0.0..1.0).prop_map(|(u, v)| [u, v])
}

proptest! {
    /// A texel is inside if its centre lies in the triangle, and lookups on the triangle read baked texels alone.
    #[test]
    fn texels_of_any_triangle(a in place(), b in place(), c in place(), width in 1_usize..40, height in 1_usize..40) {
        let uvs = [a, b, c].map(|uv| uv.map(|x| x as f32));
        let turn = |p: [f32; 2], q: [f32; 2], r: [f64; 2]| {
            let [p, q] = [p, q].map(|p| p.map(f64::from));
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        prop_assume!(turn(uvs[0], uvs[1], uvs[2].map(f64::from)).abs() > 1e-4);
        let source = MeshSource {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2]],
            ..MeshSource::default()
        };
        let mesh = mesh(source);
        let layout = Layout::new(&mesh, &texels(width, height)).unwrap();
        let raster = Raster::new(&layout, &()).unwrap();
        for (texel, coverage) in raster.coverage.iter().enumerate() {
            let center = [(texel % width) as f64 + 0.5, (texel / width) as f64 + 0.5];
            let center = [center[0] / width as f64, center[1] / height as f64];
            let turns = [0, 1, 2].map(|k| turn(uvs[k], uvs[(k + 1) % 3], center));
            let is_inside = turns.iter().all(|&turn| turn > 1e-6) || turns.iter().all(|&turn| turn < -1e-6);
            let is_outside = turns.iter().any(|&turn| turn > 1e-5) && turns.iter().any(|&turn| turn < -1e-5);
            prop_assert!(!is_inside || *coverage == Coverage::Inside);
            prop_assert!(!is_outside || *coverage != Coverage::Inside);
        }
        for (s, t) in (0..=8).flat_map(|s| (0..=8 - s).map(move |t| (f64::from(s) / 8.0, f64::from(t) / 8.0))) {
            let place = layout.grid.place([0, 1].map(|k| (a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k])) as f32));
            for (texel, weight) in layout.grid.bilinear(place) {
                prop_assert!(weight < 1e-4 || raster.coverage[texel].is_baked());
            }
        }
    }
}
