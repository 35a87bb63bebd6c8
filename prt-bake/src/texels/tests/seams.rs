use std::f64::consts::PI;

use super::scenes::{cylinder, torus};
use super::{bake, options, relative_difference, texels, unshadowed};
use crate::texels::layout::Layout;
use crate::texels::seam;
use crate::{BakeOptions, Coverage, TransferVectors};

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

/// The chart ends between two texels, and the one beyond holds what is on the other side of the cut: both sides mix the same two points.
#[test]
fn border_texels_hold_the_other_side_of_the_cut() {
    // Faces narrower and wider than a texel, whose normals are interpolated.
    for cells in [256, 128, 24] {
        let (atlas, report) = bake(&cylinder(cells, 0.125), &unshadowed(5), &texels(64, 8));
        assert_eq!(report.seam_edges, 1);
        assert!(report.seam_error < 1e-6, "{cells} cells: {}", report.seam_error);
        assert_eq!(atlas.coverage[7], Coverage::Border);
        assert!(relative_difference(atlas.transfer.vector(7, 0), atlas.transfer.vector(55, 0)) < 1e-6);
    }
}

/// Lookups at a cut interpolate on both sides: their error is of the second order.
#[test]
fn the_seams_of_a_torus_close_as_texels_shrink() {
    let mesh = torus([96, 96], 0.1);
    let options = BakeOptions { rays_per_vertex: 4096, ..options(4) };
    // The cuts lie 0.2 and 0.4 beyond a texel's edge.
    let seams = [32, 64].map(|size| bake(&mesh, &options, &texels(size, size)).1);
    assert_eq!(seams[0].seam_edges, 2 * 96);
    let ratio = seams[0].seam_error / seams[1].seam_error;
    // Measured 0.0024 and 0.0006; 0.08 and 0.03 if the texels beyond the chart held its edge.
    assert!((2.5..6.0).contains(&ratio) && seams[0].seam_error < 0.004, "{seams:?}");
    assert!(seams.iter().all(|report| report.seam_max > report.seam_error));
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
    let check = seam::check(&atlas, &seam::cuts(&layout));
    assert!(report.seam_error < 0.15 && check.error > 0.6 && check.max > 0.6, "{report:?} {check:?}");
}
