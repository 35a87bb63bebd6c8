use super::*;

/// Two texels side by side: red and see-through, white and opaque.
fn two_texels(wrap: TextureWrap) -> TextureMap {
    TextureMap::new(Arc::new(Texture::new(2, 1, vec![[255, 0, 0, 0], [255; 4]], [wrap; 2])))
}

fn textured(alpha_cutoff: Option<f32>) -> SurfaceMaterial {
    SurfaceMaterial { alpha_cutoff, texture: Some(two_texels(TextureWrap::ClampToEdge)), ..SurfaceMaterial::default() }
}

#[test]
fn colour_and_alpha_are_bilinear_between_the_centres_of_texels() {
    let material = textured(Some(0.5));
    for (u, share) in [(-3.0, 0.0), (0.25, 0.0), (0.375, 0.25), (0.5, 0.5), (0.75, 1.0), (9.0, 1.0)] {
        assert_eq!(material.color([u, 0.3]), [1.0, share as f32, share as f32], "{u}");
        assert_eq!(material.texture.as_ref().map(|map| map.alpha([f64::from(u), 0.3])), Some(share), "{u}");
        assert_eq!(material.is_there([u, 0.3]), share >= 0.5, "{u}");
    }
    assert_eq!(two_texels(TextureWrap::Repeat).alpha([2.0, 0.0]), 0.5, "the last texel meets the first");
}

#[test]
fn a_factor_multiplies_colour_and_alpha() {
    let material = SurfaceMaterial { base_color: [0.5, 4.0, 1.0, 0.5], ..textured(Some(0.4)) };
    assert_eq!(material.color([0.75, 0.0]), [0.5, 1.0, 1.0]);
    assert_eq!([0.25, 0.7, 0.75].map(|u| material.is_there([u, 0.0])), [false, true, true]);
    assert!(!SurfaceMaterial { base_color: [1.0, 1.0, 1.0, 0.3], ..textured(Some(0.4)) }.is_there([0.75, 0.0]));
}

#[test]
fn holes_are_expected_only_where_there_may_be_some() {
    assert!(!textured(None).may_have_holes() && textured(None).is_there([0.0, 0.0]));
    assert!(textured(Some(0.5)).may_have_holes());
    assert!(!textured(Some(0.0)).may_have_holes());
    let plain = |alpha| SurfaceMaterial {
        base_color: [1.0, 1.0, 1.0, alpha],
        alpha_cutoff: Some(0.5),
        ..SurfaceMaterial::default()
    };
    assert_eq!([0.4, 0.5].map(|alpha| plain(alpha).may_have_holes()), [true, false]);
}

#[test]
fn grey_is_told_from_colour() {
    assert!(!textured(None).is_gray());
    let gray = Arc::new(Texture::new(1, 1, vec![[7, 7, 7, 9]], [TextureWrap::Repeat; 2]));
    let material = |base_color| SurfaceMaterial {
        base_color,
        texture: Some(TextureMap::new(gray.clone())),
        ..SurfaceMaterial::default()
    };
    assert!(material([0.5, 0.5, 0.5, 1.0]).is_gray() && !material([0.5, 0.5, 0.4, 1.0]).is_gray());
}

#[test]
fn a_texture_that_materials_share_is_counted_once() {
    let one = textured(None);
    let moved = TextureMap { offset: [0.5, 0.0], ..two_texels(TextureWrap::Repeat) };
    let shared = SurfaceMaterial { alpha_cutoff: Some(0.5), ..one.clone() };
    assert_eq!(texture_bytes(&[one.clone(), shared]), 8);
    assert_eq!(texture_bytes(&[one, SurfaceMaterial { texture: Some(moved), ..SurfaceMaterial::default() }]), 16);
}
