use std::f64::consts::PI;

use super::scenes::{cylinder, torus};
use super::{bake, options, relative_difference, texels, unshadowed};
use crate::texels::layout::Layout;
use crate::texels::seam;
use crate::{BakeOptions, TransferVectors};

/// The chart ends at the edge of the atlas, where lookups are clamped: half a texel, or π/W, short of the seam on both sides.
#[test]
fn the_seam_of_a_cylinder_is_off_by_a_texel() {
    let width = 64;
    let (_, report) = bake(&cylinder(256, 0.0), &unshadowed(5), &texels(width, 8));
    assert_eq!(report.seam_edges, 1);
    let half = PI / width as f64;
    let normals = [half, -half].map(|angle| [angle.cos() as f32, angle.sin() as f32, 0.0]);
    let exact = TransferVectors::unshadowed(options(5).order, &normals);
    let expected = relative_difference(exact.vector(0, 0), exact.vector(1, 0));
    // Normals are interpolated over a 256th of the circle, which shortens no vector but turns them by up to 1e-6.
    assert!((report.seam_error - expected).abs() < 1e-4 * expected + 1e-6, "{} {expected}", report.seam_error);
    assert!((report.seam_max - expected).abs() < 1e-4 * expected + 1e-6);
}

/// Where the chart ends amid a texel, the texel beyond holds the transfer of the seam itself: the difference is less than for a whole texel.
#[test]
fn border_texels_hold_the_edge_of_the_chart() {
    let cut = |left| bake(&cylinder(256, left), &unshadowed(5), &texels(64, 8)).1.seam_error;
    // u = 0.125 is the edge between columns 7 and 8: each side mixes the seam's own transfer and that half a texel away. The chart is
    // 3/4 as wide, and its texels turn by 4/3.
    let (at_edge, clamped) = (cut(0.125), cut(0.0));
    assert!((at_edge / clamped - 0.5 * 4.0 / 3.0).abs() < 0.01, "{at_edge} {clamped}");
}

/// The cut runs between two texels: one beyond the chart that holds the transfer of the edge, and one half a texel inside. Their mean is off by
/// a quarter of a texel on either side: an error of the first order.
#[test]
fn the_seams_of_a_torus_close_as_texels_shrink() {
    let mesh = torus([48, 32], 0.125);
    let options = BakeOptions { rays_per_vertex: 1024, ..options(4) };
    let seams = [48, 96].map(|size| bake(&mesh, &options, &texels(size, size)).1);
    assert_eq!(seams[0].seam_edges, 48 + 32);
    let ratio = seams[0].seam_error / seams[1].seam_error;
    assert!((1.6..2.4).contains(&ratio) && seams[0].seam_error < 0.12, "{seams:?}");
    assert!(
        seams.iter().all(|report| report.seam_max > report.seam_error && report.seam_max < 3.0 * report.seam_error)
    );
}

#[test]
fn a_fault_on_one_side_of_a_seam_shows() {
    let mesh = cylinder(64, 0.125);
    let options = BakeOptions { rays_per_vertex: 64, ..unshadowed(3) };
    let (mut atlas, report) = bake(&mesh, &options, &texels(32, 8));
    // Column 4 is the first of the chart: twice as bright.
    for row in 0..8 {
        for column in 2..6 {
            let texel = row * 32 + column;
            atlas.transfer.values[9 * texel..][..9].iter_mut().for_each(|value| *value *= 2.0);
        }
    }
    let layout = Layout::new(&mesh, &texels(32, 8)).unwrap();
    let check = seam::check(&atlas, &layout);
    assert!(report.seam_error < 0.15 && check.error > 0.6 && check.max > 0.6, "{report:?} {check:?}");
}
