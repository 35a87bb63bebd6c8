//! All ways to an answer give the same one, bit for bit.

use std::path::{Path, PathBuf};

use glam::Vec3;

use super::{Random, Scene, mesh, random_direction, soup};
use crate::sampling::DirectionSet;
use crate::scene::closest::{Hits, closest_portable};
use crate::scene::occluded::{occluded, occluded_portable};
use crate::scene::stack::{ROOT, Stack};
use crate::scene::{DirectionTracer, Packet, ray};
use crate::{Mesh, MeshOptions, ray_origins};

/// A ball of facets over a floor of two large triangles: open vertices, blocked ones, and horizons.
fn ball_over_floor() -> Mesh {
    let (rings, sectors) = (12_u32, 24_u32);
    let mut positions = vec![[-3.0, -3.0, -1.1], [3.0, -3.0, -1.1], [3.0, 3.0, -1.1], [-3.0, 3.0, -1.1]];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for ring in 0..=rings {
        for sector in 0..sectors {
            let theta = std::f64::consts::PI * (0.02 + 0.96 * f64::from(ring) / f64::from(rings));
            let phi = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            positions.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
            if ring < rings {
                let (a, b) = (4 + ring * sectors + sector, 4 + ring * sectors + (sector + 1) % sectors);
                triangles.extend([[a, a + sectors, b + sectors], [a, b + sectors, b]]);
            }
        }
    }
    mesh(positions, triangles)
}

fn directions(count: usize) -> DirectionSet {
    DirectionSet::new(count, sh_core::Order::new(1).unwrap(), 5)
}

/// A bit for each direction above the horizon.
fn above(normal: Vec3, directions: &DirectionSet) -> Vec<u64> {
    let word = |word: &[Vec3]| (0..).zip(word).map(|(bit, s)| u64::from(normal.dot(*s) > 0.0) << bit).sum();
    directions.directions().chunks(64).map(word).collect()
}

/// Points to trace from: where the rays of vertices start, with their normals, and any points, without.
fn points(mesh: &Mesh, scene: &Scene, random: &mut Random) -> Vec<(Vec3, Vec3)> {
    let normals = mesh.normals().iter().map(|&normal| Vec3::from_array(normal));
    let mut points: Vec<_> = ray_origins(mesh, scene).into_iter().zip(normals).step_by(7).collect();
    points.extend((0..40).map(|_| (Vec3::from_array([0; 3].map(|_| random.unit() as f32 - 0.5)), Vec3::ZERO)));
    points
}

#[test]
fn bins_answer_as_rays_one_by_one() {
    for (mesh, count) in [(ball_over_floor(), 8192), (soup(11, 400), 4096), (soup(12, 3), 1000), (soup(13, 40), 64)] {
        let (scene, directions) = (Scene::new(&mesh), directions(count));
        let (mut tracer, mut stack) = (DirectionTracer::new(&scene, &directions), Stack::default());
        let (mut free, mut blocked, mut occluded_count) = (0, 0, 0);
        for (origin, normal) in points(&mesh, &scene, &mut Random::new(3)) {
            let above = if normal == Vec3::ZERO {
                vec![u64::MAX; directions.packets.len()]
            } else {
                above(normal, &directions)
            };
            let (found, answered) = tracer.occluded(origin, normal, &above);
            let asked: u32 = above.iter().map(|word| word.count_ones()).sum();
            assert_eq!(answered.traced + answered.free + answered.blocked, asked);
            (free, blocked) = (free + answered.free, blocked + answered.blocked);
            for ((number, &found), &above) in (0..).zip(found).zip(&above) {
                let each = (0..64).map(|bit| {
                    let is_asked = above >> bit & 1 == 1;
                    stack.entries.clear();
                    stack.entries.push(ROOT);
                    let direction = directions.directions[number * 64 + bit];
                    u64::from(is_asked && ray::occluded(&scene.tree, origin, direction, &mut stack, 0)) << bit
                });
                assert_eq!(found, each.sum::<u64>(), "packet {number} from {origin} with normal {normal}");
                occluded_count += found.count_ones();
            }
        }
        assert!(free > 0 || count < 1024, "no bin was proven free");
        assert!(blocked > 0 || count < 8192, "no bin was proven blocked");
        assert!(occluded_count > 0);
    }
}

#[test]
fn an_open_point_takes_no_ray() {
    let mesh = ball_over_floor();
    let (scene, directions) = (Scene::new(&mesh), directions(8192));
    let origin = scene.to_unit_cube(glam::DVec3::new(0.0, 0.0, 1.001));
    let above = above(Vec3::Z, &directions);
    let mut tracer = DirectionTracer::new(&scene, &directions);
    let (found, answered) = tracer.occluded(origin, Vec3::Z, &above);
    assert!(found.iter().all(|&word| word == 0));
    assert_eq!(answered.traced + answered.blocked, 0, "{answered:?}");
}

#[test]
fn packets_find_the_hits_of_single_rays() {
    for mesh in [ball_over_floor(), soup(21, 500)] {
        let (scene, directions) = (Scene::new(&mesh), directions(2048));
        let (mut hits, mut stack) = (Hits::default(), Stack::default());
        let mut found = 0;
        for (origin, _) in points(&mesh, &scene, &mut Random::new(4)) {
            for (packet, directions) in directions.packets.iter().zip(directions.directions.chunks(64)) {
                closest_portable(&scene.tree, origin, packet, u64::MAX, &mut hits, &mut stack);
                for (lane, &direction) in directions.iter().enumerate() {
                    let single = ray::closest(&scene.tree, origin, direction, &mut stack);
                    assert_eq!(hits.get(lane), single, "from {origin} along {direction}");
                    stack.entries.clear();
                    stack.entries.push(ROOT);
                    let is_occluded = ray::occluded(&scene.tree, origin, direction, &mut stack, 0);
                    assert_eq!(is_occluded, single.is_some(), "from {origin} along {direction}");
                    found += usize::from(is_occluded);
                }
            }
        }
        assert!(found > 1000);
    }
}

/// This test is compiled for the oldest machine, and so are the portable functions in it. It once found that they were compiled wrongly:
/// another shape of the loops in `wedge` cured that.
#[test]
fn every_machine_finds_the_same() {
    let mesh = soup(31, 600);
    let (scene, directions) = (Scene::new(&mesh), directions(2048));
    let (tree, mut stack) = (&scene.tree, Stack::default());
    stack.entries.push(ROOT);
    let (mut here, mut portable) = (Hits::default(), Hits::default());
    for (origin, _) in points(&mesh, &scene, &mut Random::new(5)) {
        for (packet, directions) in directions.packets.iter().zip(directions.directions.chunks(64)) {
            let (rays, none) = (packet.all(), Vec3::ZERO);
            let answer = occluded(tree, origin, none, packet, rays, &mut stack, 0);
            assert_eq!(answer, occluded_portable(tree, origin, none, packet, rays, &mut stack, 0));
            crate::scene::closest::closest(tree, origin, packet, rays, &mut here, &mut stack);
            closest_portable(tree, origin, packet, rays, &mut portable, &mut stack);
            assert!(here == portable, "packet from {origin} along {}", directions[0]);
            for &direction in directions.iter().step_by(9) {
                let single = ray::closest(tree, origin, direction, &mut stack);
                assert_eq!(single, ray::closest_portable(tree, origin, direction, &mut stack));
                let is_occluded = ray::occluded_portable(tree, origin, direction, &mut stack, 0);
                assert_eq!(is_occluded, ray::occluded(tree, origin, direction, &mut stack, 0));
            }
        }
    }
}

#[test]
fn rays_of_a_batch_do_not_depend_on_each_other() {
    let mesh = soup(41, 300);
    let scene = Scene::new(&mesh);
    let mut random = Random::new(6);
    let directions: Vec<Vec3> = (0..150).map(|_| random_direction(&mut random)).collect();
    let mut all = vec![None; directions.len()];
    scene.closest([0.4, 0.5, 0.6], &directions, &mut all);
    for (direction, hit) in directions.iter().zip(&all) {
        let mut alone = [None];
        scene.closest([0.4, 0.5, 0.6], &[*direction], &mut alone);
        assert_eq!(alone[0], *hit);
    }
    // A narrow batch, traced as a packet.
    let narrow: Vec<Vec3> = directions.iter().map(|d| (Vec3::X + 0.2 * *d).normalize()).collect();
    scene.closest([0.4, 0.5, 0.6], &narrow, &mut all);
    assert!(Packet::new(&narrow[..64]).is_worth_a_packet(u64::MAX));
    for (direction, hit) in narrow.iter().zip(&all) {
        let mut alone = [None];
        scene.closest([0.4, 0.5, 0.6], &[*direction], &mut alone);
        assert_eq!(alone[0], *hit);
    }
}

#[test]
fn real_meshes_are_answered_the_same_with_and_without_bins() {
    let data = std::env::var_os("PRT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    for name in ["spot.obj", "beetle.obj"] {
        let path = data.join("meshes").join(name);
        if !path.exists() {
            continue;
        }
        let mesh = Mesh::new(crate::load_mesh(&path).unwrap(), &MeshOptions::default()).unwrap().0;
        let (scene, directions) = (Scene::new(&mesh), directions(2048));
        let mut tracer = DirectionTracer::new(&scene, &directions);
        let origins = ray_origins(&mesh, &scene);
        for vertex in (0..origins.len()).step_by(origins.len() / 150) {
            let normal = Vec3::from_array(mesh.normals()[vertex]);
            let above = above(normal, &directions);
            let with_bins = tracer.occluded(origins[vertex], normal, &above).0.to_vec();
            assert_eq!(tracer.occluded_ray_by_ray(origins[vertex], &above), with_bins, "{name}, vertex {vertex}");
        }
    }
}

/// What a tree of boxes cannot keep apart is merged, and what it can keep apart only in a chain does not end the stack.
#[test]
fn faces_that_coincide_or_nest_make_a_tree() {
    let triangle = |scale: f64, shift: f64| [[-scale, -scale, shift], [scale, -scale, shift], [0.0, scale, shift]];
    let pile: Vec<_> = (0..30_000).flat_map(|k| triangle(1.0, 1e-13 * f64::from(k))).collect();
    let nest: Vec<_> = (1..=3_000).flat_map(|k| triangle(f64::from(k) / 3_000.0, 0.0)).collect();
    for positions in [pile, nest] {
        let count = positions.len() as u32 / 3;
        let mesh = mesh(positions, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
        assert_eq!(mesh.triangles().len(), count as usize);
        let scene = Scene::new(&mesh);
        let (mut occluded, mut hit) = ([false; 2], [None]);
        scene.occluded([0.0, 0.1, 1.0], &[Vec3::NEG_Z, Vec3::X], &mut occluded);
        assert_eq!(occluded, [true, false]);
        scene.closest([0.0, 0.1, 1.0], &[Vec3::NEG_Z], &mut hit);
        assert!((hit[0].unwrap().distance - 1.0).abs() < 1e-6);
    }
}

/// Widened by the rounding of their planes, needles reach beyond their tips, where boxes and beams cut them off, each in its own way. Every
/// way must agree but for rays at such a tip.
#[test]
fn needles_are_answered_the_same_but_at_their_tips() {
    for (aspect, bound) in [(1e-2, 0.0), (1e-4, 1e-5)] {
        let mut random = Random::new(61);
        let mut positions = Vec::new();
        for _ in 0..400 {
            let center = glam::DVec3::new(random.unit(), random.unit(), random.unit());
            let along = random_direction(&mut random).as_dvec3();
            let across = along.any_orthonormal_vector() * aspect;
            positions.extend([center - 0.2 * along, center + 0.2 * along, center + 0.2 * across].map(|p| p.to_array()));
        }
        let mesh = mesh(positions, (0..400).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
        let (scene, directions) = (Scene::new(&mesh), directions(8192));
        let (mut tracer, mut stack) = (DirectionTracer::new(&scene, &directions), Stack::default());
        let (mut rays, mut differing, mut occluded) = (0, 0, 0);
        for (origin, _) in points(&mesh, &scene, &mut Random::new(7)) {
            let above = vec![u64::MAX; directions.packets.len()];
            let found = tracer.occluded(origin, Vec3::ZERO, &above).0.to_vec();
            for (number, direction) in directions.directions.iter().enumerate() {
                stack.entries.clear();
                stack.entries.push(ROOT);
                let single = ray::occluded(&scene.tree, origin, *direction, &mut stack, 0);
                rays += 1;
                occluded += usize::from(single);
                differing += usize::from(single != (found[number / 64] >> (number % 64) & 1 == 1));
            }
        }
        assert!(occluded > 100_000, "{occluded}");
        assert!(differing as f64 <= bound * rays as f64, "1:{aspect}: {differing} of {rays}");
    }
}
