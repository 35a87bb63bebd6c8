//! The WGSL of every pass: shared parts and an entry file, joined in the order listed here.

/// Bindings, structs and exact arithmetic of triangles on the screen.
const SCREEN: &str = include_str!("../shaders/shared/screen.wgsl");
/// From samples to pixels.
const PIXEL: &str = include_str!("../shaders/shared/pixel.wgsl");
/// Angles from polynomials.
const ANGLE: &str = include_str!("../shaders/shared/angle.wgsl");
/// Sums of the bands of a light.
const SH_BASIS: &str = include_str!("../shaders/shared/sh_basis.wgsl");
/// Zonal lobes and what they transfer.
const LOBES: &str = include_str!("../shaders/shared/lobes.wgsl");
/// The tone curve.
const TONE_MAP: &str = include_str!("../shaders/shared/tone_map.wgsl");

/// Joined source of one pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shader {
    pub(crate) name: &'static str,
    parts: &'static [&'static str],
}

impl Shader {
    pub(crate) fn source(&self) -> String {
        self.parts.join("\n")
    }
}

pub(crate) const SHADE_VECTOR: Shader =
    Shader { name: "shade_vector", parts: &[include_str!("../shaders/shade_vector.wgsl")] };
pub(crate) const DRAW_SURFACE: Shader =
    Shader { name: "draw_surface", parts: &[SCREEN, include_str!("../shaders/draw_surface.wgsl")] };
pub(crate) const RESOLVE: Shader =
    Shader { name: "resolve", parts: &[SCREEN, PIXEL, include_str!("../shaders/resolve.wgsl")] };
pub(crate) const BUILD_TABLE: Shader =
    Shader { name: "build_table", parts: &[SH_BASIS, include_str!("../shaders/build_table.wgsl")] };
pub(crate) const SHADE_LOBES: Shader =
    Shader { name: "shade_lobes", parts: &[ANGLE, SH_BASIS, LOBES, include_str!("../shaders/shade_lobes.wgsl")] };
pub(crate) const RESOLVE_TEXTURE: Shader = Shader {
    name: "resolve_texture",
    parts: &[SCREEN, PIXEL, ANGLE, SH_BASIS, LOBES, include_str!("../shaders/resolve_texture.wgsl")],
};
pub(crate) const SKIN: Shader = Shader { name: "skin", parts: &[include_str!("../shaders/skin.wgsl")] };
pub(crate) const PRESENT: Shader =
    Shader { name: "present", parts: &[TONE_MAP, include_str!("../shaders/present.wgsl")] };

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{
        ClipVertex, FrameParams, Influence, LobeParams, PresentParams, ScreenVertex, ShadeParams, SkinParams,
        TableParams, TextureParams,
    };
    use std::mem::offset_of;

    const ALL: [Shader; 8] =
        [SHADE_VECTOR, DRAW_SURFACE, RESOLVE, PRESENT, BUILD_TABLE, SHADE_LOBES, RESOLVE_TEXTURE, SKIN];

    fn parse(shader: &Shader) -> naga::Module {
        let source = shader.source();
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(&source)))
    }

    #[test]
    fn every_shader_is_valid_without_any_optional_capability() {
        for shader in &ALL {
            let mut validator =
                naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
            let result = validator.validate(&parse(shader));
            assert!(
                result.is_ok(),
                "{}: {}",
                shader.name,
                result.map_or_else(|e| e.emit_to_string(&shader.source()), |_| String::new())
            );
        }
    }

    /// Size and member offsets of a struct of a shader.
    fn wgsl_layout(shader: &Shader, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = parse(shader);
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
        let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = found else {
            panic!("{} has no struct {name}", shader.name);
        };
        let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset as usize);
        (*span as usize, members.iter().map(member).collect())
    }

    /// Compares size and every offset of a struct with its WGSL.
    macro_rules! assert_layout {
        ($shader:expr, $name:ident { $($member:ident),* }) => {
            let expected = (size_of::<$name>(), vec![$((stringify!($member).to_string(), offset_of!($name, $member))),*]);
            assert_eq!(wgsl_layout($shader, stringify!($name)), expected, "{} in {}", stringify!($name), $shader.name);
        };
    }

    #[test]
    fn structs_have_the_same_layout_in_wgsl() {
        let params = &SHADE_VECTOR;
        assert_layout!(
            params,
            ShadeParams { first_vertex, vertex_count, stored_blocks, used_blocks, channel_count, row_length, padding }
        );
        for shader in [&SHADE_LOBES, &RESOLVE_TEXTURE] {
            assert_layout!(
                shader,
                LobeParams {
                    point_stride,
                    item_stride,
                    rows,
                    channels,
                    lobe_count,
                    explicit_count,
                    stored_bands,
                    used_bands,
                    first_band,
                    table_width,
                    table_height,
                    view_size,
                    eye,
                    has_eye,
                    first_point,
                    point_count,
                    row_length,
                    padding,
                    light
                }
            );
        }
        assert_layout!(&BUILD_TABLE, TableParams { columns, rows, band_count, first_band, light });
        assert_layout!(
            &RESOLVE_TEXTURE,
            TextureParams { size, scale, has_albedo, albedo_item, has_normals, normal_item }
        );
        assert_layout!(&SKIN, SkinParams { vertex_count, row_length, from_rest, padding });
        assert_layout!(&SKIN, Influence { weights, joints });
        for shader in [&DRAW_SURFACE, &RESOLVE, &RESOLVE_TEXTURE] {
            assert_layout!(shader, FrameParams { size, samples, vertex_count, front_count, zero, padding });
            assert_layout!(shader, ScreenVertex { x, y, z, inverse_w });
        }
        for shader in [&RESOLVE, &RESOLVE_TEXTURE] {
            assert_layout!(shader, ClipVertex { source, padding_0, weight, padding_1 });
        }
        assert_layout!(&PRESENT, PresentParams { world_from_clip, exposure, show_background, padding });
    }
}
