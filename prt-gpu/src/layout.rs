//! Structs shared with WGSL, and how transfer is laid out in GPU buffers. A test compares the structs with the shaders.

use crate::{LobeShape, Lobes, Surface, frame};
use bytemuck::{Pod, Zeroable};

/// `ShadeParams` of `shade_vector.wgsl`: one chunk of vertices.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct ShadeParams {
    pub(crate) first_vertex: u32,
    pub(crate) vertex_count: u32,
    /// Blocks of four coefficients per vertex and channel in the buffer.
    pub(crate) stored_blocks: u32,
    /// Blocks that the light has: the bands in use.
    pub(crate) used_blocks: u32,
    pub(crate) channel_count: u32,
    /// Invocations in one row of the two-dimensional dispatch.
    pub(crate) row_length: u32,
    pub(crate) padding: [u32; 2],
}

/// `FrameParams` of `shared/screen.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct FrameParams {
    /// Width and height of the image in pixels.
    pub(crate) size: [u32; 2],
    /// Samples per pixel along each axis.
    pub(crate) samples: u32,
    /// Vertices of the mesh; screen vertices from here on come from clipping.
    pub(crate) vertex_count: u32,
    /// Screen triangles from here on are seen from the back.
    pub(crate) front_count: u32,
    /// Always 0: see `exact` in `shared/screen.wgsl`.
    pub(crate) zero: u32,
    pub(crate) padding: [u32; 2],
}

/// A vertex on the screen.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct ScreenVertex {
    /// Steps of 1/256 sample from the left edge of the image.
    pub(crate) x: i32,
    /// Steps of 1/256 sample from the top edge of the image.
    pub(crate) y: i32,
    /// Clip depth `z/w`, 0 to 1.
    pub(crate) z: f32,
    /// `1/w` of the clip position.
    pub(crate) inverse_w: f32,
}

/// What a vertex made by clipping is a mixture of.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct ClipVertex {
    /// Three vertices of the mesh.
    pub(crate) source: [u32; 3],
    pub(crate) padding_0: u32,
    /// Their shares; the sum is 1.
    pub(crate) weight: [f32; 3],
    pub(crate) padding_1: u32,
}

/// `PresentParams` of `present.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct PresentParams {
    /// Column-major inverse of the camera matrix.
    pub(crate) world_from_clip: [[f32; 4]; 4],
    /// Factor on radiance, `2^stops`.
    pub(crate) exposure: f32,
    /// 1 to show the environment behind the surface.
    pub(crate) show_background: u32,
    pub(crate) padding: [u32; 2],
}

/// Order up to which lobes are evaluated on the GPU, as in `shared/sh_basis.wgsl`.
pub(crate) const MAX_LOBE_ORDER: usize = 10;

/// Coefficients of a light of [`MAX_LOBE_ORDER`].
pub(crate) const MAX_LOBE_LIGHT: usize = MAX_LOBE_ORDER * MAX_LOBE_ORDER;

/// `LobeParams` of `shared/lobes.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct LobeParams {
    /// Items between the records of neighbouring points.
    pub(crate) point_stride: u32,
    /// Items between the items of a record.
    pub(crate) item_stride: u32,
    pub(crate) rows: u32,
    pub(crate) channels: u32,
    pub(crate) lobe_count: u32,
    pub(crate) explicit_count: u32,
    /// Bands that lobes have.
    pub(crate) stored_bands: u32,
    /// Bands of these that the light has.
    pub(crate) used_bands: u32,
    pub(crate) first_band: u32,
    /// 0 evaluates the light directly.
    pub(crate) table_width: u32,
    pub(crate) table_height: u32,
    /// 0 without a view map.
    pub(crate) view_size: u32,
    pub(crate) eye: [f32; 3],
    pub(crate) has_eye: u32,
    pub(crate) first_point: u32,
    pub(crate) point_count: u32,
    pub(crate) row_length: u32,
    pub(crate) padding: u32,
    pub(crate) light: [[f32; 4]; MAX_LOBE_LIGHT],
}

/// `TableParams` of `build_table.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct TableParams {
    /// Texels in a row, border included.
    pub(crate) columns: u32,
    /// Rows, border included.
    pub(crate) rows: u32,
    pub(crate) band_count: u32,
    pub(crate) first_band: u32,
    pub(crate) light: [[f32; 4]; MAX_LOBE_LIGHT],
}

/// `TextureParams` of `resolve_texture.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct TextureParams {
    pub(crate) size: [u32; 2],
    /// Texels per unit of uv.
    pub(crate) scale: [f32; 2],
    pub(crate) has_albedo: u32,
    /// Item of a record at which the albedo begins.
    pub(crate) albedo_item: u32,
    pub(crate) has_normals: u32,
    /// Item of a record at which the normal of the relief begins.
    pub(crate) normal_item: u32,
}

/// `SkinParams` of `skin.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct SkinParams {
    pub(crate) vertex_count: u32,
    pub(crate) row_length: u32,
    pub(crate) from_rest: u32,
    pub(crate) padding: u32,
}

/// `Influence` of `skin.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct Influence {
    pub(crate) weights: [f32; 4],
    pub(crate) joints: [u32; 4],
}

/// Blocks of four that hold `coeff_count` coefficients, the last one padded with zeros.
pub(crate) fn block_count(coeff_count: usize) -> usize {
    coeff_count.div_ceil(4)
}

/// A range of vertices whose transfer lies in one buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Chunk {
    pub(crate) first_vertex: usize,
    pub(crate) vertex_count: usize,
}

/// Splits vertices so that no buffer of transfer exceeds `max_bytes`.
///
/// `bytes_per_vertex` is what one vertex takes. Returns `None` if not even one vertex fits.
pub(crate) fn split_transfer(vertex_count: usize, bytes_per_vertex: usize, max_bytes: u64) -> Option<Vec<Chunk>> {
    let per_chunk = (max_bytes / bytes_per_vertex.max(1) as u64).min(vertex_count as u64) as usize;
    if per_chunk == 0 {
        return (vertex_count == 0).then(Vec::new);
    }
    let starts = (0..vertex_count).step_by(per_chunk);
    Some(starts.map(|first| Chunk { first_vertex: first, vertex_count: per_chunk.min(vertex_count - first) }).collect())
}

/// Bytes of transfer per vertex on the GPU: `C` channels of zero-padded blocks of four floats.
pub(crate) fn transfer_bytes_per_vertex(surface: &Surface<'_>) -> usize {
    surface.channels * block_count(surface.order.coeff_count()) * size_of::<[f32; 4]>()
}

/// Transfer of a chunk in the order of the GPU, `[C, blocks, chunk vertices]` of four coefficients.
///
/// Neighbouring invocations shade neighbouring vertices, so with the vertex as the fastest index their reads are one run.
pub(crate) fn transpose_transfer(surface: &Surface<'_>, chunk: Chunk) -> Vec<[f32; 4]> {
    let coeff_count = surface.order.coeff_count();
    let blocks = block_count(coeff_count);
    let mut out = vec![[0.0; 4]; surface.channels * blocks * chunk.vertex_count];
    let stride = surface.floats_per_vertex();
    let rows = surface.transfer[chunk.first_vertex * stride..].chunks_exact(stride).take(chunk.vertex_count);
    for (vertex, row) in rows.enumerate() {
        for (channel, coeffs) in row.chunks_exact(coeff_count).enumerate() {
            for (block, four) in coeffs.chunks(4).enumerate() {
                out[(channel * blocks + block) * chunk.vertex_count + vertex][..four.len()].copy_from_slice(four);
            }
        }
    }
    out
}

/// Floats of the record of a point: explicit coefficients, axes, and the coefficients of the bands that lobes describe.
pub(crate) fn lobe_record_length(shape: &LobeShape) -> usize {
    let bands = shape.order.get().saturating_sub(shape.first_band());
    shape.explicit_floats() + shape.axis_count() * (3 + shape.channels * bands)
}

/// The record of one point.
pub(crate) fn lobe_record<'a>(lobes: &Lobes<'a>, point: usize) -> impl Iterator<Item = f32> + use<'a> {
    let shape = lobes.shape;
    let part = |values: &'a [f32], size: usize| &values[point * size..(point + 1) * size];
    let explicit = part(lobes.explicit, shape.explicit_floats());
    let axes = &lobes.axes[point * shape.axis_count()..(point + 1) * shape.axis_count()];
    let coeffs = part(lobes.coeffs, shape.coeff_floats());
    let first = shape.first_band().min(shape.order.get());
    let bands = coeffs.chunks_exact(shape.order.get()).flat_map(move |lobe| &lobe[first..]);
    explicit.iter().chain(axes.as_flattened()).chain(bands).copied()
}

/// Lobes of a chunk in the order of the GPU, `[items of a record, chunk vertices]`.
pub(crate) fn transpose_lobes(lobes: &Lobes<'_>, chunk: Chunk) -> Vec<f32> {
    let mut out = vec![0.0; lobe_record_length(&lobes.shape) * chunk.vertex_count];
    for vertex in 0..chunk.vertex_count {
        for (item, value) in lobe_record(lobes, chunk.first_vertex + vertex).enumerate() {
            out[item * chunk.vertex_count + vertex] = value;
        }
    }
    out
}

/// Frames and positions as `[V, 3]`, a column of the frame and a component of the position each.
///
/// Frames that are not orthonormal are replaced; positions that are not finite are the origin, since no triangle shows them. Without
/// frames they are the identity.
pub(crate) fn pack_pose(positions: &[[f32; 3]], frames: &[[[f32; 3]; 3]]) -> Vec<[f32; 4]> {
    let pack = |(v, position): (usize, &[f32; 3])| {
        let frame = frames.get(v).map_or(frame::IDENTITY, frame::orthonormal_or_replaced);
        let position = if position.iter().all(|x| x.is_finite()) { *position } else { [0.0; 3] };
        std::array::from_fn::<_, 3, _>(|k| [frame[k][0], frame[k][1], frame[k][2], position[k]])
    };
    positions.iter().enumerate().flat_map(pack).collect()
}

/// A light `[3, k²]` as `[3, blocks]` of four coefficients.
pub(crate) fn block_light(light: &[f32], coeff_count: usize) -> Vec<[f32; 4]> {
    let block = |four: &[f32]| std::array::from_fn(|i| four.get(i).copied().unwrap_or(0.0));
    light.chunks_exact(coeff_count).flat_map(|channel| channel.chunks(4).map(block)).collect()
}

/// Three components padded to four with zeros.
pub(crate) fn pad(values: &[[f32; 3]]) -> Vec<[f32; 4]> {
    values.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect()
}

/// A two-dimensional dispatch of at least `group_count` workgroups, neither side above `max_side`.
///
/// Returns `None` if there are more than `max_side²`.
pub(crate) fn split_dispatch(group_count: u32, max_side: u32) -> Option<[u32; 2]> {
    let columns = group_count.min(max_side).max(1);
    let rows = group_count.div_ceil(columns);
    (rows <= max_side).then_some([columns, rows])
}

/// Bytes of an image row in a buffer that a texture is copied to; wgpu wants a multiple of 256.
pub(crate) fn padded_row_bytes(width: u32, bytes_per_pixel: u32) -> u32 {
    (width * bytes_per_pixel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use proptest::prelude::*;
    use sh_core::Order;

    /// Joins chunks to the vertices that they cover.
    fn covered(chunks: &[Chunk]) -> Vec<usize> {
        chunks.iter().flat_map(|c| c.first_vertex..c.first_vertex + c.vertex_count).collect()
    }

    proptest! {
        #[test]
        fn chunks_cover_every_vertex_once_and_fit(vertices in 0_usize..5000, bytes in 16_usize..5000, limit in 1_u64..100_000) {
            match split_transfer(vertices, bytes, limit) {
                None => prop_assert!((bytes as u64) > limit),
                Some(chunks) => {
                    prop_assert!(chunks.iter().all(|c| c.vertex_count > 0 && (c.vertex_count * bytes) as u64 <= limit));
                    prop_assert_eq!(covered(&chunks), (0..vertices).collect::<Vec<_>>());
                }
            }
        }

        #[test]
        fn dispatches_cover_every_group(groups in 0_u32..2_000_000, side in 1_u32..2000) {
            match split_dispatch(groups, side) {
                None => prop_assert!(u64::from(groups) > u64::from(side) * u64::from(side)),
                Some([x, y]) => {
                    prop_assert!(x <= side && y <= side && x * y >= groups);
                    prop_assert!(x * y < groups + x.max(1) + 1, "no more than a row is wasted");
                }
            }
        }
    }

    #[test]
    fn a_whole_mesh_is_one_chunk_when_it_fits() {
        assert_eq!(split_transfer(70_000, 144, 128 << 20).unwrap(), [Chunk { first_vertex: 0, vertex_count: 70_000 }]);
        // 144 bytes are 36 floats: 128 MiB hold 932,067 vertices.
        let chunks = split_transfer(1_000_000, 144, 128 << 20).unwrap();
        assert_eq!(chunks.iter().map(|c| c.vertex_count).collect::<Vec<_>>(), [932_067, 67_933]);
    }

    #[test]
    fn transposed_transfer_keeps_every_coefficient() {
        let order = Order::new(3).unwrap();
        let transfer: Vec<f32> = (0..5 * 3 * 9).map(|i| i as f32 + 1.0).collect();
        let (positions, albedo) = ([[0.0; 3]; 5], [[1.0; 3]; 5]);
        let surface = Surface::new(&positions, &[], &albedo, order, 3, &transfer).unwrap();
        let chunk = Chunk { first_vertex: 2, vertex_count: 2 };
        let blocks = transpose_transfer(&surface, chunk);
        assert_eq!(blocks.len(), 3 * 3 * 2);
        for vertex in 0..2 {
            for channel in 0..3 {
                let row: Vec<f32> = (0..3).flat_map(|block| blocks[(channel * 3 + block) * 2 + vertex]).collect();
                let start = ((2 + vertex) * 3 + channel) * 9;
                assert_eq!(row[..9], transfer[start..start + 9]);
                assert_eq!(row[9..], [0.0; 3], "padding is zero");
            }
        }
    }

    #[test]
    fn light_blocks_are_padded_with_zeros() {
        let light: Vec<f32> = (1..=12).map(|i| i as f32).collect();
        assert_eq!(block_light(&light, 4), [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0], [9.0, 10.0, 11.0, 12.0]]);
        assert_eq!(
            block_light(&[1.0, 2.0, 3.0], 1),
            [[1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0]]
        );
    }

    #[test]
    fn rows_are_padded_to_256_bytes() {
        assert_eq!(padded_row_bytes(1, 16), 256);
        assert_eq!(padded_row_bytes(16, 16), 256);
        assert_eq!(padded_row_bytes(17, 16), 512);
    }
}
