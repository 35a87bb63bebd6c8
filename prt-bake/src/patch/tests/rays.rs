//! Rays against the surface, beside brute force over the triangles of many tiles.

use glam::DVec3;

use super::*;
use crate::patch::surface::{Side, Surface};
use crate::sampling::Random;

/// Triangles of the tiles from `-reach` to `reach`, in the surface's frame.
fn triangles(field: &HeightField, reach: i64) -> Vec<[DVec3; 3]> {
    let (width, height) = (field.width() as i64, field.height() as i64);
    let surface = Surface::new(field);
    let mut all = Vec::new();
    for row in -reach * height..(reach + 1) * height {
        for column in -reach * width..(reach + 1) * width {
            let texels = field.corners(column, row);
            let corner = |k: usize| {
                let z = surface.lattice_z(f64::from(field.heights()[texels[k]]));
                DVec3::new((column + (k % 2) as i64) as f64, (row + (k / 2) as i64) as f64, z)
            };
            all.extend(field.split(texels).map(|corners| corners.map(corner)));
        }
    }
    all
}

/// Distance along a ray to a triangle (Möller and Trumbore 1997).
fn intersect([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let inverse = 1.0 / ab.dot(p);
    let to_origin = origin - a;
    let u = to_origin.dot(p) * inverse;
    let q = to_origin.cross(ab);
    let v = direction.dot(q) * inverse;
    let distance = ac.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 1e-7).then_some(distance)
}

#[test]
fn rays_from_both_sides_agree_with_brute_force() {
    let mut random = Random::new(5);
    for (width, height, top) in [(5, 4, 0.6), (1, 7, 0.5), (6, 1, 0.3), (2, 2, 1.0)] {
        let field = rough(width, height, top, width as u64);
        let surface = Surface::new(&field);
        let reach = 12 / width.min(height) as i64;
        let triangles = triangles(&field, reach);
        let mut crossings = 0;
        for number in 0..400 {
            let texel = number % field.texel_count();
            let offset = [random.unit() - 0.5, random.unit() - 0.5];
            let (point, _) = surface.point_of_texel(texel, offset);
            let side = if number % 2 == 0 { Side::Above } else { Side::Below };
            let sign = if side == Side::Above { 1.0 } else { -1.0 };
            let origin = point + sign * 1.5 * random.unit() * DVec3::Z;
            let direction = DVec3::from_array(std::array::from_fn(|_| random.unit() - 0.5)).normalize();
            let expected =
                triangles.iter().filter_map(|&corners| intersect(corners, origin, direction)).fold(10.0, f64::min);
            let found = surface.follow(origin, direction, 10.0, side);
            assert!((found.distance - expected).abs() < 1e-9, "{origin} {direction}: {found:?} {expected}");
            assert_eq!(found.point.is_some(), expected < 10.0);
            if let Some(point) = found.point {
                crossings += 1;
                assert!(sign * point.normal.dot(direction) < 0.0);
                let [b, c] = point.barycentric.map(f64::from);
                let [p, q, r] = field.tile_triangles()[point.triangle]
                    .map(|texel| surface.lattice_z(f64::from(field.heights()[texel as usize])));
                let z = (origin + found.distance * direction).z;
                assert!((p + b * (q - p) + c * (r - p) - z).abs() < 1e-5 * (1.0 + surface.top));
            }
        }
        assert!(crossings > 100, "{crossings}");
    }
}

#[test]
fn rays_along_lattice_lines_and_at_corners_find_their_way() {
    // Rows of a wave along x, so that each lattice line in y is level.
    let field = HeightField::new(4, 3, [0.0, 0.125, 0.25, 0.125].repeat(3)).unwrap();
    let surface = Surface::new(&field);
    let follow = |origin: [f64; 3], direction: [f64; 3], side| {
        surface.follow(DVec3::from_array(origin), DVec3::from_array(direction), f64::INFINITY, side)
    };
    // From a corner in the valley: level rays along it are free, across it meet the slope at once or not at all above the ridge.
    assert!(follow([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], Side::Above).point.is_none());
    assert_eq!(follow([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], Side::Above).distance, 0.0);
    assert!((follow([0.0, 0.0, 0.25], [-1.0, 0.0, 0.0], Side::Above).distance - 0.5).abs() < 1e-12);
    assert!(follow([0.0, 0.0, 1.01], [1.0, 0.0, 0.0], Side::Above).point.is_none());
    // Straight down and up, onto corners, edges, and from inside.
    for (x, y, z) in [(0.0, 0.0, 0.0), (2.0, 1.0, 1.0), (1.5, 2.0, 0.75), (1.25, 0.25, 0.625)] {
        assert!((follow([x, y, 2.0], [0.0, 0.0, -1.0], Side::Above).distance - (2.0 - z)).abs() < 1e-12);
        assert!((follow([x, y, -1.0], [0.0, 0.0, 1.0], Side::Below).distance - (1.0 + z)).abs() < 1e-12);
        assert!(follow([x, y, z], [0.0, 0.0, 1.0], Side::Above).point.is_none());
        assert_eq!(follow([x, y, z], [0.0, 0.0, -1.0], Side::Below).distance, f64::INFINITY);
    }
    // Nearly level, between the ridges for ever: given up after a bounded number of steps.
    assert!(follow([0.0, 0.5, 0.3], [1e-12, 1.0, 0.0], Side::Above).point.is_none());
}

#[test]
fn no_ray_leaks_through_the_surface() {
    let field = rough(8, 8, 0.4, 3);
    let surface = Surface::new(&field);
    let mut random = Random::new(11);
    for number in 0..20_000 {
        // From a corner, an edge's middle, a diagonal's middle: straight down through the surface from above it.
        let offset = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]][number % 4];
        let (point, _) = surface.point_of_texel(number / 4 % 64, offset);
        let target = DVec3::from_array(std::array::from_fn(|_| random.unit() - 0.5)).normalize();
        let origin = DVec3::new(point.x, point.y, surface.top + 1.0) + 0.3 * target.with_z(0.0);
        let direction = (point - origin).normalize();
        let reach = surface.follow(origin, direction, f64::INFINITY, Side::Above);
        let distance = (point - origin).length();
        assert!(reach.point.is_some() && reach.distance < distance + 1e-9, "{origin} {direction}: {reach:?}");
    }
}

#[test]
fn no_light_comes_from_below_the_plane() {
    let mut random = Random::new(4);
    for field in [rough(6, 5, 0.4, 7), rough(1, 4, 2.0, 8), flat(2, 2)] {
        let surface = Surface::new(&field);
        for number in 0..3000 {
            let texel = number % field.texel_count();
            let direction = DVec3::from_array(std::array::from_fn(|_| random.unit() - 0.5)).normalize();
            let down = direction.with_z(-direction.z.abs());
            let origin = surface.texel(texel, field.heights()[texel]);
            assert!(surface.follow(origin, down, f64::INFINITY, Side::Above).point.is_some(), "{texel} {down}");
        }
    }
}
