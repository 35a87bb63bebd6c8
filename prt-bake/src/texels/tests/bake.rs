use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use super::scenes::{groove, plates, roofed_square, square, sunken_box, torus};
use super::{bake, mesh, options, relative_difference, texels, unshadowed};
use crate::{
    BakeOptions, BakeReport, Coverage, Error, InsidePolicy, Pass, Progress, TexelOptions, TransferVectors,
    bake_diffuse, bake_texels,
};

#[test]
fn an_open_plane_is_exact() {
    for n in [1, 2, 6, 32] {
        let plane = mesh(square(3, 0.0, true, |st| st));
        let (atlas, report) = bake_texels(&plane, &options(n), &texels(7, 5), &()).unwrap();
        assert_eq!(atlas.transfer, TransferVectors::unshadowed(options(n).order, &[[0.0, 0.0, 1.0]; 35]), "order {n}");
        assert_eq!((report.occluded_share, report.error), (0.0, Some(0.0)));
        let found = report.texels.unwrap();
        assert_eq!((found.texels_inside, found.seam_edges), (35, 0));
    }
}

/// Texels at vertices are those vertices: their rays start 5e-6 apart, so at most some grazing ray differs; with bounces, the gathered
/// light is the vertices' own.
#[test]
fn a_texel_at_a_vertex_has_its_transfer() {
    let cells = 6;
    let mesh = plates(cells);
    for bounces in [0, 1, 3] {
        let options = BakeOptions { bounces, ..options(4) };
        let (baked, _) = bake_diffuse(&mesh, &options, &()).unwrap();
        let size = texels(2 * (cells as usize + 1), cells as usize + 1);
        let (atlas, report) = bake_texels(&mesh, &options, &size, &()).unwrap();
        for (vertex, &[u, v]) in mesh.uvs().unwrap().iter().enumerate() {
            let texel = (v * atlas.height as f32) as usize * atlas.width + (u * atlas.width as f32) as usize;
            assert_eq!(atlas.coverage[texel], Coverage::Inside);
            let difference = relative_difference(atlas.transfer.vector(texel, 0), baked.transfer.vector(vertex, 0));
            // One ray of 512 straight up weighs 4e-3.
            assert!(difference < 4e-3, "{bounces} bounces, vertex {vertex}: {difference}");
        }
        assert!(report.occluded_share > 0.2);
        let gathered = report.texels.unwrap().vertices;
        assert_eq!(gathered.map(|vertices| vertices.bounce_energy.len()), bounces.checked_sub(1));
    }
}

#[test]
fn colour_is_carried_only_where_light_is_reflected_by_it() {
    let mut mesh = plates(3);
    let grey = bake(&mesh, &BakeOptions { bounces: 2, ..options(3) }, &texels(12, 6)).0;
    assert_eq!(grey.transfer.channels, 1);
    mesh.set_albedo([0.8, 0.4, 0.0]).unwrap();
    let colored = bake(&mesh, &BakeOptions { bounces: 2, ..options(3) }, &texels(12, 6)).0;
    let direct = bake(&mesh, &options(3), &texels(12, 6)).0;
    assert_eq!((colored.transfer.channels, direct.transfer.channels), (3, 1));
    for texel in 0..72 {
        // The red channel sees the albedo that the grey mesh has; a black channel is direct light alone.
        assert_eq!(colored.transfer.vector(texel, 0), grey.transfer.vector(texel, 0));
        assert_eq!(colored.transfer.vector(texel, 2), direct.transfer.vector(texel, 0));
        assert_ne!(colored.transfer.vector(texel, 1), direct.transfer.vector(texel, 0));
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let mesh = torus([12, 8], 0.0);
    let bake = |threads| {
        let options = BakeOptions { bounces: 2, threads, ..options(3) };
        bake_texels(&mesh, &options, &texels(24, 16), &()).unwrap()
    };
    let (reference, report) = bake(Some(1));
    for threads in [Some(2), Some(5), None] {
        let (atlas, again) = bake(threads);
        assert_eq!(atlas, reference);
        let numbers = |report: &BakeReport| {
            (report.rays_traced, report.error, report.texels.as_ref().map(|found| found.seam_error))
        };
        assert_eq!(numbers(&again), numbers(&report));
    }
}

/// Finer than its vertices, and the same surface: in between the texels see what the vertices see.
#[test]
fn atlas_and_vertices_agree_on_a_fine_torus() {
    let mesh = torus([96, 64], 0.0);
    let options = BakeOptions { bounces: 1, ..options(4) };
    let (atlas, _) = bake(&mesh, &options, &texels(64, 48));
    let (baked, _) = bake_diffuse(&mesh, &options, &()).unwrap();
    let mut vector = vec![0.0; 16];
    let lookups: Vec<f32> = mesh
        .uvs()
        .unwrap()
        .iter()
        .flat_map(|&uv| {
            atlas.sample(uv, 0, &mut vector);
            vector.clone()
        })
        .collect();
    let difference = relative_difference(&lookups, &baked.transfer.values);
    assert!(difference < 0.02, "{difference}");
}

/// Between the corners the smooth surface bulges; rays that start on the flat faces meet them.
#[test]
fn a_coarse_surface_is_lit_as_the_smooth_one() {
    let atlas = |cells| bake(&torus(cells, 0.0), &options(4), &texels(60, 40)).0.transfer.values;
    let smooth = atlas([180, 120]);
    // Measured 0.142, 0.033 and 0.009; from the flat faces 0.175, 0.043 and 0.010.
    for (cells, bound) in [([6, 4], 0.155), ([12, 8], 0.037), ([24, 16], 0.0095)] {
        let difference = relative_difference(&atlas(cells), &smooth);
        assert!(difference < bound, "{cells:?} {difference}");
    }
}

/// The normals make the square bulge by 0.2. A roof that is nearer must not be jumped over.
#[test]
fn lifted_points_stay_below_what_is_close() {
    for gap in [0.01, 0.1, 0.19, 0.21, 0.3, 0.45] {
        let (atlas, _) = bake(&roofed_square(gap), &options(1), &texels(20, 10));
        // The middle of the face; its light comes in from the sides below the roof, whose edges are 1.5 away and more.
        let open = atlas.transfer.vector(5 * 20 + 5, 0)[0] * (4.0 * PI).sqrt() as f32;
        assert!(open < 0.15, "gap {gap}: {open}");
    }
}

/// At the bottom of a groove a wall sees light from 0 to the angle of the groove: a share of `(1 − cos φ)/2`.
#[test]
fn no_light_leaks_through_a_fold() {
    for degrees in [10.0_f64, 30.0, 60.0, 90.0, 150.0] {
        let angle = degrees.to_radians();
        let options = BakeOptions { rays_per_vertex: 2048, ..options(1) };
        let (atlas, report) = bake_texels(&groove(angle), &options, &texels(8, 10), &()).unwrap();
        let expected = 0.5 * (1.0 - angle.cos());
        for row in [1, 2, 7, 8] {
            // The centre of column 1 lies half a texel beyond the edge.
            assert_eq!(atlas.coverage[8 * row + 1], Coverage::Border);
            let open = f64::from(atlas.transfer.vector(8 * row + 1, 0)[0]) * (4.0 * PI).sqrt();
            // The directions nearest to the wall are 0.04 apart.
            assert!((open - expected).abs() < 0.01, "{degrees}° row {row}: {open} {expected}");
        }
        assert_eq!(report.invalid_vertices, 0);
    }
}

#[test]
fn texels_inside_of_solids_are_replaced_as_asked() {
    let mesh = sunken_box();
    let size = 48;
    let texels = TexelOptions { gutter: 2, ..texels(size, size) };
    let bake = |inside| bake_texels(&mesh, &BakeOptions { inside, ..options(2) }, &texels, &()).unwrap();
    let (kept, report) = bake(InsidePolicy::Keep);
    // The floor is 48 × 24 texels, and 0.32 of each side is below the box.
    let hidden = |texel: &usize| {
        let at = [texel % size, texel / size].map(|x| x as f64 + 0.5);
        [at[0] / 48.0, at[1] / 24.0].iter().all(|x| (0.34..0.66).contains(x))
    };
    let below_box: Vec<usize> = (0..size * size).filter(hidden).collect();
    // The walls of the box are seen from outside on both sides of the floor.
    assert_eq!(report.invalid_vertices, below_box.len());
    assert!(below_box.iter().all(|&texel| kept.transfer.vector(texel, 0)[0].abs() < 1e-3));
    let (black, _) = bake(InsidePolicy::Black);
    assert!(below_box.iter().all(|&texel| black.transfer.vector(texel, 0) == [0.0; 4]));
    let (filled, _) = bake(InsidePolicy::Fill);
    let is_filled = |texel: &&usize| filled.coverage[**texel] == Coverage::Filled;
    assert!(below_box.iter().all(|texel| is_filled(&texel) == (filled.transfer.vector(*texel, 0)[0] > 0.05)));
    let count = below_box.iter().filter(is_filled).count();
    assert!(count > below_box.len() / 2 && count < below_box.len(), "{count} of {}", below_box.len());
    for texel in (0..size * size).filter(|texel| !hidden(texel) && kept.coverage[*texel].is_baked()) {
        assert_eq!(filled.transfer.vector(texel, 0), kept.transfer.vector(texel, 0));
    }
}

#[test]
fn unshadowed_texels_trace_no_ray() {
    let (atlas, report) = bake_texels(&plates(2), &unshadowed(3), &texels(6, 3), &()).unwrap();
    assert_eq!((report.rays_traced, report.error, atlas.metadata.rays), (0, None, 0));
    assert_eq!(atlas.transfer.vector(0, 0), TransferVectors::unshadowed(options(3).order, &[[0.0, 0.0, 1.0]]).values);
}

#[test]
fn a_light_from_all_sides_shows_what_is_open() {
    let (atlas, _) = bake(&plates(4), &options(3), &texels(10, 5));
    let mut light = vec![0.0; 27];
    // Radiance 1 from everywhere, in green alone.
    light[9] = (4.0 * std::f32::consts::PI).sqrt();
    let image = atlas.relit(&light);
    assert_eq!((image.width, image.height), (10, 5));
    for (texel, [red, green, blue]) in image.pixels.iter().enumerate() {
        let open = atlas.transfer.vector(texel, 0)[0] * light[9];
        assert_eq!((*red, *blue), (0.0, 0.0));
        assert!((green - open).abs() < 1e-6 && *green > 0.0 && *green < 0.9);
    }
}

/// Counts what it is told, and stops after some texels.
#[derive(Default)]
struct Counter {
    announced: AtomicUsize,
    done: AtomicUsize,
    rays: AtomicU64,
    stop_after: Option<usize>,
}

impl Progress for Counter {
    fn start(&self, _pass: Pass, count: usize) {
        self.announced.fetch_add(count, Ordering::Relaxed);
    }

    fn advance(&self, count: usize, rays: u64) {
        self.done.fetch_add(count, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.stop_after.is_some_and(|limit| self.done.load(Ordering::Relaxed) >= limit)
    }
}

#[test]
fn progress_tells_every_texel_and_every_ray() {
    let counter = Counter::default();
    let few = BakeOptions { rays_per_vertex: 64, ..options(2) };
    let (_, report) = bake_texels(&plates(2), &few, &texels(200, 100), &counter).unwrap();
    let found = report.texels.unwrap();
    assert_eq!(found.texels_inside + found.texels_border, counter.announced.into_inner());
    assert_eq!(found.texels_inside + found.texels_border, counter.done.into_inner());
    assert_eq!(report.rays_traced, counter.rays.into_inner());
}

#[test]
fn a_cancelled_bake_is_an_error_and_stops_at_once() {
    let counter = Counter { stop_after: Some(100), ..Counter::default() };
    let error = bake_texels(&plates(2), &options(2), &texels(40, 20), &counter).unwrap_err();
    assert!(matches!(error, Error::Cancelled));
    assert!(counter.done.into_inner() < 100 + 8 * 16);
}

#[test]
fn options_of_vertices_are_checked() {
    for options in [
        BakeOptions { rays_per_vertex: 0, ..options(3) },
        BakeOptions { bounces: 1, ..unshadowed(3) },
        BakeOptions { keep_shadowed: true, ..options(3) },
        BakeOptions { bounces: 100_000, ..options(3) },
    ] {
        let result = bake_texels(&plates(2), &options, &TexelOptions::square(4), &());
        assert!(matches!(result, Err(Error::Option(_))), "{options:?}");
    }
}
