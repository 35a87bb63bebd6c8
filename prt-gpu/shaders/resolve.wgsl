// Turns the nearest triangles into an image, from the radiance of vertices. One invocation makes one pixel.
// Joined after shared/screen.wgsl and shared/pixel.wgsl.

// [mesh vertices], radiance in xyz
@group(0) @binding(4) var<storage, read> radiance: array<vec4<f32>>;

fn blend(weight: vec3<f32>, vertex: vec3<u32>) -> vec3<f32> {
    return (weight.x * radiance[vertex.x].xyz + weight.y * radiance[vertex.y].xyz) + weight.z * radiance[vertex.z].xyz;
}

fn corner_radiance(vertex: u32) -> vec3<f32> {
    if vertex < frame.vertex_count {
        return radiance[vertex].xyz;
    }
    let clip = clips[vertex - frame.vertex_count];
    return blend(clip.weight, clip.source);
}

fn surface_radiance(triangle: u32, at: Hit) -> vec3<f32> {
    let a = corner_radiance(corners[3u * triangle]);
    let b = corner_radiance(corners[3u * triangle + 1u]);
    let c = corner_radiance(corners[3u * triangle + 2u]);
    return (at.weights.x * a + at.weights.y * b) + at.weights.z * c;
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    resolve_pixel(id.xy);
}
