// Shades vertices from transfer vectors. One invocation shades one vertex: radiance = albedo * dot(transfer, light).
// The twin is src/cpu/shade_vector.rs.

struct ShadeParams {
    // The chunk of vertices whose transfer is bound.
    first_vertex: u32,
    vertex_count: u32,
    // Blocks of four coefficients that are stored, and that the light has.
    stored_blocks: u32,
    used_blocks: u32,
    // 1 or 3.
    channel_count: u32,
    // Invocations in one row of the dispatch.
    row_length: u32,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> params: ShadeParams;
// [channels, stored blocks, vertices of the chunk]
@group(0) @binding(1) var<storage, read> transfer: array<vec4<f32>>;
// [3, used blocks], zero where the last block is padded
@group(0) @binding(2) var<storage, read> light: array<vec4<f32>>;
// [vertices], xyz
@group(0) @binding(3) var<storage, read> albedo: array<vec4<f32>>;
// [vertices], xyz
@group(0) @binding(4) var<storage, read_write> radiance: array<vec4<f32>>;

fn transfer_block(channel: u32, block: u32, vertex: u32) -> vec4<f32> {
    return transfer[(channel * params.stored_blocks + block) * params.vertex_count + vertex];
}

fn light_block(channel: u32, block: u32) -> vec4<f32> {
    return light[channel * params.used_blocks + block];
}

// One transfer vector for all channels: each block is read once.
fn transferred_grey(vertex: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var block = 0u; block < params.used_blocks; block++) {
        let t = transfer_block(0u, block, vertex);
        sum += vec3(dot(t, light_block(0u, block)), dot(t, light_block(1u, block)), dot(t, light_block(2u, block)));
    }
    return sum;
}

fn transferred_color(vertex: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var block = 0u; block < params.used_blocks; block++) {
        sum += vec3(
            dot(transfer_block(0u, block, vertex), light_block(0u, block)),
            dot(transfer_block(1u, block, vertex), light_block(1u, block)),
            dot(transfer_block(2u, block, vertex), light_block(2u, block)),
        );
    }
    return sum;
}

@compute @workgroup_size(64)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    let vertex = id.y * params.row_length + id.x;
    if vertex >= params.vertex_count {
        return;
    }
    var transferred: vec3<f32>;
    if params.channel_count == 1u {
        transferred = transferred_grey(vertex);
    } else {
        transferred = transferred_color(vertex);
    }
    let v = params.first_vertex + vertex;
    radiance[v] = vec4(albedo[v].xyz * transferred, 1.0);
}
