//! Linear blend skinning: rigid motions, blends, rest poses that are not the bound one, and bindings.
#![expect(clippy::unwrap_used, reason = "tests")]

use glam::{DMat3, DQuat, DVec3, Mat3};
use proptest::prelude::*;
use prt_anim::{
    Affine, Bone, Deformed, Error, Joint, Pose, Skeleton, Skin, SkinSource, SkinnedMesh, Transform, frames_from_skin,
};

fn transform() -> impl Strategy<Value = Transform> {
    let vector = || prop::array::uniform3(-2.0..2.0_f64);
    (vector(), prop::array::uniform4(-1.0..1.0_f64), prop::array::uniform3(0.3..2.0_f64))
        .prop_map(|(translation, rotation, scale)| Transform { translation, rotation, scale })
}

fn rigid() -> impl Strategy<Value = Transform> {
    transform().prop_map(|transform| Transform { scale: [1.0; 3], ..transform })
}

fn chain(rest: [Transform; 3]) -> Skeleton {
    let joints = rest.into_iter().enumerate().map(|(i, rest)| Joint { name: None, parent: i.checked_sub(1), rest });
    Skeleton::new(joints.collect()).unwrap()
}

/// Some vertices with bones 0..3, bound where the skeleton has its bones if `bind` is its own rest pose.
fn source(skeleton: &Skeleton, bind: &Pose) -> SkinSource {
    let world = skeleton.world_from_joints(bind);
    let bones = (0..3).map(|joint| Bone { joint, inverse_bind: inverse(&world[joint]) }).collect();
    let number = |i: usize, salt: f32| (i as f32 * 12.9898 + salt).sin();
    let count = 40;
    SkinSource {
        bones,
        bones_per_vertex: 3,
        bone_indices: (0..count).flat_map(|i| [[0, 1, 2], [2, 0, 1], [1, 2, 0]][i % 3]).collect(),
        weights: (0..3 * count).map(|i| number(i, 1.0).abs() * f32::from(i % 4 != 0)).collect(),
        positions: (0..count).map(|i| [number(i, 2.0), number(i, 3.0), number(i, 4.0)]).collect(),
        normals: (0..count).map(|i| [number(i, 5.0), number(i, 6.0), number(i, 7.0)]).collect(),
    }
}

fn inverse(map: &Affine) -> Affine {
    let linear = DMat3::from_cols_array_2d(&map.linear).inverse();
    let translation = linear * DVec3::from(map.translation) * -1.0;
    Affine { linear: linear.to_cols_array_2d(), translation: translation.to_array() }
}

fn deform(skin: &Skin, skeleton: &Skeleton, pose: &Pose) -> Deformed {
    let mut out = Deformed::default();
    skin.deform(skeleton, pose, &mut out);
    out
}

/// The linear part of a vertex' map.
fn blend(skin: &Skin, vertex: usize, maps: &[Affine]) -> DMat3 {
    let parts = skin.parts();
    let bones = (0..3).map(|k| (parts.bone_indices[3 * vertex + k], parts.weights[3 * vertex + k]));
    bones
        .map(|(bone, weight)| DMat3::from_cols_array_2d(&maps[usize::from(bone)].linear) * f64::from(weight))
        .fold(DMat3::ZERO, |sum, part| sum + part)
}

/// How much rounding may grow in a product with the inverse.
fn condition(matrix: DMat3) -> f64 {
    let norm = |matrix: DMat3| matrix.to_cols_array().iter().map(|value| value * value).sum::<f64>().sqrt();
    norm(matrix) * norm(matrix.inverse())
}

fn vec(array: [f32; 3]) -> DVec3 {
    DVec3::from(array.map(f64::from))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bound_pose_is_where_the_vertices_are(rest in prop::array::uniform3(transform())) {
        let skeleton = chain(rest);
        let source = source(&skeleton, &skeleton.rest_pose());
        let skin = Skin::new(source.clone(), &skeleton).unwrap();
        for (i, (position, normal)) in source.positions.iter().zip(&source.normals).enumerate() {
            prop_assert!(vec(skin.rest_positions()[i]).distance(vec(*position)) < 1e-6);
            prop_assert!(vec(skin.rest_normals()[i]).distance(vec(*normal).normalize()) < 1e-6);
        }
    }

    /// All joints moved by one rigid motion: vertices, normals and frames do the same. The vertices were bound in another pose than they rest in.
    #[test]
    fn rigid_motions(bind in prop::array::uniform3(rigid()), rest in prop::array::uniform3(rigid()), motion in rigid()) {
        let skeleton = chain(rest);
        let bind = Pose { locals: bind.to_vec() };
        let skin = Skin::new(source(&skeleton, &bind), &skeleton).unwrap();
        let mut pose = skeleton.rest_pose();
        let root = motion.to_affine().after(&pose.locals[0].to_affine());
        pose.locals[0] = Transform {
            translation: root.translation,
            rotation: DQuat::from_mat3(&DMat3::from_cols_array_2d(&root.linear)).to_array(),
            scale: [1.0; 3],
        };
        let out = deform(&skin, &skeleton, &pose);
        let rotation = DMat3::from_cols_array_2d(&motion.to_affine().linear);
        let rest_maps = skin.bone_maps(&skeleton, &skeleton.rest_pose());
        for i in 0..skin.vertex_count() {
            let expected = motion.to_affine().apply(skin.rest_positions()[i].map(f64::from));
            prop_assert!(vec(out.positions[i]).distance(expected.into()) < 1e-5);
            // Rotations that oppose one another blend to nothing: there is no surface to follow.
            if condition(blend(&skin, i, &rest_maps)) > 100.0 {
                continue;
            }
            prop_assert!(vec(out.normals[i]).distance(rotation * vec(skin.rest_normals()[i])) < 1e-5);
            let frame = Mat3::from_cols_array_2d(&out.frames[i]);
            prop_assert!(frame.abs_diff_eq(rotation.as_mat3(), 1e-5), "{frame} {rotation}");
        }
    }

    /// By the definition: Σ w · world · inverse bind · p.
    #[test]
    fn blends(rest in prop::array::uniform3(transform()), pose in prop::array::uniform3(transform())) {
        let skeleton = chain(rest);
        let source = source(&skeleton, &skeleton.rest_pose());
        let pose = Pose { locals: pose.to_vec() };
        let skin = Skin::new(source.clone(), &skeleton).unwrap();
        let (world, out) = (skeleton.world_from_joints(&pose), deform(&skin, &skeleton, &pose));
        let mut positions = vec![[0.0; 3]; skin.vertex_count()];
        let mut frames = vec![[[0.0; 3]; 3]; skin.vertex_count()];
        let maps = skin.bone_maps(&skeleton, &pose);
        skin.positions(&maps, &mut positions);
        frames_from_skin(&skin, &maps, &mut frames);
        prop_assert_eq!((&positions, &frames), (&out.positions, &out.frames));
        for i in 0..skin.vertex_count() {
            let weights = &source.weights[3 * i..][..3];
            let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
            let blended = weights.iter().zip(&source.bone_indices[3 * i..][..3]).map(|(&weight, &bone)| {
                let bone = source.bones[usize::from(bone)];
                let bound = bone.inverse_bind.apply(source.positions[i].map(f64::from));
                f64::from(weight) / sum * DVec3::from(world[bone.joint].apply(bound))
            });
            let expected: DVec3 = blended.sum();
            prop_assert!(vec(out.positions[i]).distance(expected) < 1e-5 * (1.0 + expected.length()));
        }
    }

    /// Frames against finite differences of the skinning itself: a patch of three vertices with the weights of one.
    #[test]
    fn frames_are_those_of_the_motion(rest in prop::array::uniform3(transform()), bind in prop::array::uniform3(transform()), pose in prop::array::uniform3(transform())) {
        let skeleton = chain(rest);
        let source = source(&skeleton, &Pose { locals: bind.to_vec() });
        let pose = Pose { locals: pose.to_vec() };
        let skin = Skin::new(source.clone(), &skeleton).unwrap();
        let out = deform(&skin, &skeleton, &pose);
        let (rest_maps, maps) = (skin.bone_maps(&skeleton, &skeleton.rest_pose()), skin.bone_maps(&skeleton, &pose));
        for i in 0..skin.vertex_count() {
            let blend = |maps: &[Affine]| blend(&skin, i, maps);
            let rest = blend(&rest_maps);
            let gradient = blend(&maps) * rest.inverse();
            if condition(rest) > 100.0 || condition(gradient) > 100.0 || gradient.determinant() < 0.0 {
                continue;
            }
            let normal = vec(skin.rest_normals()[i]);
            let expected = (gradient.inverse().transpose() * normal).normalize();
            prop_assert!(vec(out.normals[i]).distance(expected) < 1e-4);
        }
    }
}

#[test]
fn weights_are_sorted_and_sum_to_one() {
    let skeleton = chain([Transform::IDENTITY; 3]);
    let bones = (0..3).map(|joint| Bone { joint, inverse_bind: Affine::IDENTITY }).collect();
    let source = SkinSource {
        bones,
        bones_per_vertex: 3,
        bone_indices: vec![0, 1, 2, 2, 1, 0],
        weights: vec![0.5, 0.0, 1.5, 0.0, 0.0, 0.0],
        positions: vec![[1.0; 3]; 2],
        normals: vec![[0.0; 3], [0.0, 4.0, 3.0]],
    };
    let skin = Skin::new(source, &skeleton).unwrap();
    assert_eq!(skin.parts().bone_indices, [2, 0, 1, 2, 1, 0]);
    assert_eq!(skin.parts().weights, [0.75, 0.25, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(skin.rest_normals(), [[0.0, 0.0, 1.0], [0.0, 0.8, 0.6]]);
}

/// Mirrors, collapses and huge numbers in a pose: finite positions, orthonormal frames.
#[test]
fn degenerate_poses_stay_finite() {
    let skeleton = chain([Transform::IDENTITY; 3]);
    let skin = Skin::new(source(&skeleton, &skeleton.rest_pose()), &skeleton).unwrap();
    for scale in [
        [0.0; 3],
        [1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [-1.0, 1.0, 1.0],
        [1e200; 3],
        [1e-200; 3],
        [f64::NAN; 3],
        [f64::INFINITY; 3],
    ] {
        for rotation in [[0.0; 4], [0.0, 0.0, 1.0, 0.0], [1e-300, 0.0, 0.0, 0.0], [f64::NAN; 4]] {
            let pose = Pose {
                locals: vec![Transform { translation: [1e30, 0.0, f64::from(f32::MAX) * 4.0], rotation, scale }; 3],
            };
            let out = deform(&skin, &skeleton, &pose);
            assert!(
                out.positions.as_flattened().iter().chain(out.normals.as_flattened()).all(|value| value.is_finite())
            );
            for frame in out.frames {
                let frame = Mat3::from_cols_array_2d(&frame);
                assert!((frame * frame.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-6) && frame.determinant() > 0.0);
            }
        }
    }
}

#[test]
fn bad_skins_are_refused() {
    let skeleton = chain([Transform::IDENTITY; 3]);
    let refuse = |words: &str, change: fn(&mut SkinSource)| {
        let mut source = source(&skeleton, &skeleton.rest_pose());
        change(&mut source);
        let Err(Error::Skin(reason)) = Skin::new(source, &skeleton) else { panic!("accepted: {words}") };
        assert!(reason.contains(words), "{reason}");
    };
    refuse("39 normals for 40 vertices; 40 are needed", |source| source.normals.truncate(39));
    refuse("1 weights for 40 vertices; 120 are needed", |source| source.weights.truncate(1));
    refuse("no bones", |source| {
        *source = SkinSource { positions: vec![[0.0; 3]], normals: vec![[0.0; 3]], ..SkinSource::default() }
    });
    refuse("bone 1 is joint 9, but there are 3", |source| source.bones[1].joint = 9);
    refuse("vertex 2 follows bone 3, but there are 3", |source| source.bone_indices[7] = 3);
    refuse("vertex 2 has the weight -1", |source| source.weights[6] = -1.0);
    refuse("vertex 0 has the weight NaN", |source| source.weights[0] = f32::NAN);
    refuse("vertex 5 rests at a position that is not finite", |source| source.positions[5][1] = f32::NAN);
    assert_eq!(Skin::new(SkinSource::default(), &skeleton).unwrap().vertex_count(), 0);
}

/// A mesh of points: what binding needs.
fn points(positions: &[[f32; 3]], normals: &[[f32; 3]]) -> (Skeleton, SkinnedMesh) {
    let skeleton = chain([Transform::IDENTITY; 3]);
    let count = positions.len();
    let source = SkinSource {
        bones: (0..3).map(|joint| Bone { joint, inverse_bind: Affine::IDENTITY }).collect(),
        bones_per_vertex: 1,
        bone_indices: (0..count).map(|i| (i % 3) as u16).collect(),
        weights: vec![1.0; count],
        positions: positions.to_vec(),
        normals: normals.to_vec(),
    };
    let skin = Skin::new(source, &skeleton).unwrap();
    (skeleton, SkinnedMesh { skin, uvs: vec![[0.0; 2]; count], albedo: vec![[0.8; 3]; count], triangles: Vec::new() })
}

#[test]
fn bindings_find_the_nearest_vertex() {
    let [x, y] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    // 1 and 2 stand at one place; the size is 10.
    let (skeleton, mesh) = points(&[[0.0; 3], [10.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 0.0, 3e-4]], &[x, x, y, y]);
    let others = [[10.0, 1e-6, 0.0], [10.0, 0.0, 1e-6], [-9e-5, 0.0, 0.0], [10.0, 0.0, 2.99e-4]];
    let binding = mesh.bind_to(&others, &[[0.2, 0.9, 0.0], [0.9, 0.2, 0.0], y, y]).unwrap();
    assert_eq!(binding.sources, [2, 1, 0, 3]);
    // Joint and weight are the partner's, the normal is the other mesh's own.
    assert_eq!(binding.skin.parts().bone_indices, [2, 1, 0, 0]);
    assert_eq!(binding.skin.rest_normals()[2], y);
    let mut pose = skeleton.rest_pose();
    pose.locals[0].rotation = [0.0, 0.0, 1.0, 1.0];
    let out = deform(&binding.skin, &skeleton, &pose);
    assert!(vec(out.normals[2]).distance(-DVec3::X) < 1e-6);
    let error =
        mesh.bind_to(&[[0.0; 3], [5.0; 3], [f32::NAN; 3], [f32::MAX; 3], [1.2e-4, 0.0, 0.0]], &[x; 5]).unwrap_err();
    let Error::Unbound { unbound: 4, vertices: 5, first: 1, .. } = error else { panic!("{error}") };
    assert!(error.to_string().contains("4 of 5 vertices"), "{error}");
}

/// A skin that is bound elsewhere than it rests: the other mesh's normals are taken back and forth.
#[test]
fn bindings_keep_normals_through_the_bound_pose() {
    let rest = Transform { rotation: [0.3, -0.2, 0.5, 0.8], scale: [1.0, 2.0, 0.5], ..Transform::IDENTITY };
    let skeleton = chain([rest; 3]);
    let bind = Pose { locals: vec![Transform::IDENTITY; 3] };
    let skin = Skin::new(source(&skeleton, &bind), &skeleton).unwrap();
    let count = skin.vertex_count();
    let mesh = SkinnedMesh { skin, uvs: vec![[0.0; 2]; count], albedo: vec![[0.8; 3]; count], triangles: Vec::new() };
    let binding = mesh.bind_to(mesh.positions(), mesh.normals()).unwrap();
    assert_eq!(binding.sources, (0..count as u32).collect::<Vec<_>>());
    let again = Skin::new(binding.skin.parts().clone(), &skeleton).unwrap();
    for (a, b) in again.rest_normals().iter().zip(mesh.normals()) {
        assert!(vec(*a).distance(vec(*b)) < 1e-5, "{a:?} {b:?}");
    }
    let none = mesh.bind_to(&[], &[]).unwrap();
    assert_eq!(none.skin.vertex_count(), 0);
}

#[test]
fn empty_meshes_bind_nothing() {
    let (_, mesh) = points(&[], &[]);
    assert!(mesh.bind_to(&[], &[]).is_ok());
    assert!(mesh.bind_to(&[[0.0; 3]], &[[1.0, 0.0, 0.0]]).is_err());
}
