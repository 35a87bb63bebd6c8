//! Transfer of surfaces with holes, two sides and textures.

use std::sync::Arc;

use glam::DVec3;

use super::*;
use crate::{SurfaceMaterial, Texture, TextureMap, TextureWrap, TwoSided};

/// Quads and small receivers, each with its material.
#[derive(Default)]
struct Quads(MeshSource);

impl Quads {
    /// A parallelogram at `corner`, spanned by `u` and `v`, facing `u × v`; texture coordinates run from 0 to 1 along `u` and `v`.
    fn add(mut self, corner: DVec3, u: DVec3, v: DVec3, material: SurfaceMaterial) -> Self {
        let Self(source) = &mut self;
        let first = u32::try_from(source.positions.len()).unwrap();
        source.positions.extend([corner, corner + u, corner + u + v, corner + v].map(|p| p.to_array()));
        source.uvs.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        source.albedo.extend([[f32::NAN; 3]; 4]);
        source.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        let number = u32::try_from(source.materials.len()).unwrap();
        source.materials.push(material);
        source.face_material.extend([number; 2]);
        self
    }

    /// A square of half side `half` around `center`, facing up or down.
    fn square(self, center: DVec3, half: f64, is_up: bool, material: SurfaceMaterial) -> Self {
        let (u, v) = (2.0 * half * DVec3::X, 2.0 * half * if is_up { DVec3::Y } else { DVec3::NEG_Y });
        self.add(center - 0.5 * (u + v), u, v, material)
    }

    fn build(self, two_sided: TwoSided) -> Mesh {
        Mesh::new(self.0, &MeshOptions { two_sided, ..MeshOptions::default() }).unwrap().0
    }
}

fn plain() -> SurfaceMaterial {
    SurfaceMaterial::default()
}

fn texture(width: usize, height: usize, pixels: Vec<[u8; 4]>, wrap: TextureWrap) -> TextureMap {
    TextureMap::new(Arc::new(Texture::new(width, height, pixels, [wrap; 2])))
}

fn bake(mesh: &Mesh, n: usize, rays: usize, bounces: usize) -> (BakedSurface, BakeReport) {
    let options = BakeOptions { rays_per_vertex: rays, bounces, keep_shadowed: bounces > 0, ..options(n) };
    bake_diffuse(mesh, &options, &()).unwrap()
}

/// What bounces added at a vertex, in one channel.
fn added(baked: &BakedSurface, vertex: usize, channel: usize) -> Vec<f32> {
    let direct = baked.transfer_shadowed.as_ref().unwrap().vector(vertex, channel);
    baked.transfer.vector(vertex, channel).iter().zip(direct).map(|(total, direct)| total - direct).collect()
}

fn length(vector: &[f32]) -> f32 {
    vector.iter().map(|value| value * value).sum::<f32>().sqrt()
}

#[test]
fn a_half_transparent_screen_lets_half_the_light_through() {
    let chessboard = vec![[0, 0, 0, 255], [0; 4], [0; 4], [0, 0, 0, 255]];
    // 400 squares a side: many in every direction but the grazing ones, which weigh little.
    let map = TextureMap { scale: [200.0; 2], ..texture(2, 2, chessboard, TextureWrap::Repeat) };
    let screen = SurfaceMaterial { alpha_cutoff: Some(0.5), texture: Some(map), ..plain() };
    let scene = Quads::default().square(DVec3::ZERO, 0.01, true, plain());
    let mesh = scene.square(DVec3::new(0.013, 0.007, 1.0), 40.0, false, screen).build(TwoSided::Never);
    let (baked, report) = bake(&mesh, 4, 16_384, 0);
    let open = baked.unshadowed();
    for vertex in 0..4 {
        let half: Vec<f32> = open.vector(vertex, 0).iter().map(|value| 0.5 * value).collect();
        let error: Vec<f32> = baked.transfer.vector(vertex, 0).iter().zip(&half).map(|(a, b)| a - b).collect();
        // Beyond the screen, below atan(1/40), lies a share of 1/1601 of the light. About 400² squares over 16,384 rays: noise
        // of independent rays would be 0.5/√16384 of each basis function, 0.8 % of the vector for 16 of them; measured 0.9 %.
        assert!(length(&error) < 0.015 * length(&half), "{} of {}", length(&error), length(&half));
    }
    assert!((0..4).all(|vertex| (report.vertices[vertex].occluded_share() - 0.5).abs() < 0.02));
}

#[test]
fn a_leaf_is_lit_from_both_sides() {
    let leaf = SurfaceMaterial { two_sided: true, ..plain() };
    let mesh = Quads::default().square(DVec3::ZERO, 1.0, true, leaf).build(TwoSided::AsFile);
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (8, 4));
    let (baked, _) = bake(&mesh, 5, 512, 1);
    assert_eq!(baked.transfer.values, baked.unshadowed().values, "neither side shadows the other");
    assert!((0..4).all(|vertex| mesh.normals()[vertex] == [0.0, 0.0, 1.0] && mesh.normals()[4 + vertex] == [-0.0, -0.0, -1.0]));
}

#[test]
fn the_back_of_a_leaf_reflects_what_it_receives_from_below() {
    let leaf = SurfaceMaterial { two_sided: true, ..plain() };
    let scene = || Quads::default().square(DVec3::ZERO, 0.01, true, plain());
    let bake = |two_sided| {
        let mesh = scene().square(DVec3::Z, 2.0, true, leaf.clone()).build(two_sided);
        bake(&mesh, 3, 2048, 1).0
    };
    assert_eq!(added(&bake(TwoSided::Never), 0, 0), [0.0; 9], "a back is black");
    // The leaf's underside sees nothing but the tiny receiver, so that it sends out albedo times its unshadowed transfer, and the receiver
    // sees it under the form factor of a square over a point: 4 times that over one corner (Siegel and Howell, C-11).
    let both = bake(TwoSided::AsFile);
    let corner = {
        let a = 2.0_f64 / (1.0 + 4.0_f64).sqrt();
        a * (2.0 / (1.0 + 4.0_f64).sqrt()).atan() / std::f64::consts::PI
    };
    let downward = TransferVectors::unshadowed(both.transfer.order, &[[0.0, 0.0, -1.0]]);
    for (value, open) in added(&both, 0, 0).iter().zip(&downward.values) {
        let expected = 4.0 * corner * 0.8 * f64::from(*open);
        // 2048 rays; measured 3e-4. The receiver is too small to shadow the corners of the leaf.
        assert!((f64::from(*value) - expected).abs() < 1e-3, "{value} {expected}");
    }
}

/// A receiver that looks down on the middle of a floor, whose vertices are white (or what `albedo` says) whatever its texture is.
fn receiver_over_floor(floor: SurfaceMaterial, albedo: [f32; 3]) -> Mesh {
    let scene = Quads::default().square(DVec3::new(0.0, 0.0, 1.0), 0.001, false, plain());
    let mut scene = scene.square(DVec3::ZERO, 3.0, true, floor);
    scene.0.albedo = vec![albedo; 8];
    scene.build(TwoSided::AsFile)
}

#[test]
fn a_floor_half_red_and_half_white_colours_what_sees_it() {
    let halves = texture(2, 1, vec![[255, 0, 0, 255], [255; 4]], TextureWrap::ClampToEdge);
    let mesh = receiver_over_floor(SurfaceMaterial { texture: Some(halves), ..plain() }, [1.0; 3]);
    let (baked, _) = bake(&mesh, 3, 8192, 1);
    assert_eq!(baked.transfer.channels, 3);
    for vertex in 0..4 {
        let [red, green, blue] = [0, 1, 2].map(|channel| added(&baked, vertex, channel));
        assert!(length(&red) > 0.3 && green == blue);
        for (red, green) in red.iter().zip(&green) {
            // Red comes from all of the floor, green from the right half alone: half as much, by symmetry.
            assert!((green - 0.5 * red).abs() < 2e-3 * length(&[*red]).max(0.1), "{green} {red}");
        }
    }
    // And it is the same light, red, that a white floor without a texture gives.
    let white = bake(&receiver_over_floor(plain(), [1.0; 3]), 3, 8192, 1).0;
    assert_eq!(added(&baked, 0, 0), added(&white, 0, 0));
}

#[test]
fn a_texture_stands_for_the_albedo_of_vertices() {
    let white = texture(1, 1, vec![[255; 4]], TextureWrap::Repeat);
    let textured = receiver_over_floor(SurfaceMaterial { texture: Some(white), ..plain() }, [0.0; 3]);
    let plain = receiver_over_floor(plain(), [1.0; 3]);
    assert_eq!(bake(&textured, 4, 1024, 2).0.transfer, bake(&plain, 4, 1024, 2).0.transfer);
}

#[test]
fn reflected_light_keeps_to_its_colour_and_none_is_added_at_albedo_one() {
    // Two plates close to each other, one white by its texture and one by its vertices, under a sky of radiance 1.
    let white = texture(1, 1, vec![[255; 4]], TextureWrap::Repeat);
    let textured = SurfaceMaterial { texture: Some(white), ..plain() };
    let scene = Quads::default().square(DVec3::ZERO, 1.0, true, textured);
    let mut scene = scene.square(DVec3::new(0.0, 0.0, 0.5), 1.0, false, plain());
    scene.0.albedo = vec![[1.0; 3]; 8];
    let mesh = scene.build(TwoSided::AsFile);
    let sky = (4.0 * std::f64::consts::PI).sqrt();
    let radiance = |bounces| {
        let (baked, report) = bake(&mesh, 1, 1024, bounces);
        (baked.transfer.values.iter().map(|&value| f64::from(value) * sky).collect::<Vec<_>>(), report.bounce_energy)
    };
    let ((all, energy), (few, _)) = (radiance(60), radiance(3));
    for (all, few) in all.iter().zip(few) {
        // In a white furnace everything looks like the sky; never brighter.
        assert!(few < *all && (*all - 1.0).abs() < 1e-5, "{few} {all}");
    }
    assert!(energy.windows(2).all(|pair| pair[1] <= pair[0]), "{energy:?}");
}
