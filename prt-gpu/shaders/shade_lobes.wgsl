// Shades vertices from zonal lobes. One invocation shades one vertex. Joined after shared/lobes.wgsl.
// The twin is src/cpu/shade_lobes.rs.

// [vertices, 3], the columns of the frame in xyz and the position in w
@group(0) @binding(0) var<storage, read> pose: array<vec4<f32>>;
// [vertices, 3], tangent, bitangent and normal of the rest pose; read only for a view map
@group(0) @binding(1) var<storage, read> local_frames: array<vec4<f32>>;
// [vertices], xyz
@group(0) @binding(2) var<storage, read> albedo: array<vec4<f32>>;
// [vertices], xyz
@group(0) @binding(3) var<storage, read_write> radiance: array<vec4<f32>>;

fn vertex_view(vertex: u32, frame: mat3x3<f32>) -> ViewPlace {
    if !HAS_VIEW_MAP {
        return view_place(vec3(0.0), frame);
    }
    let first = 3u * vertex;
    let position = vec3(pose[first].w, pose[first + 1u].w, pose[first + 2u].w);
    let rest = mat3x3(local_frames[first].xyz, local_frames[first + 1u].xyz, local_frames[first + 2u].xyz);
    return view_place(position, frame * rest);
}

@compute @workgroup_size(64)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.y * lobe_params.row_length + id.x;
    if point >= lobe_params.point_count {
        return;
    }
    let vertex = lobe_params.first_point + point;
    let frame = mat3x3(pose[3u * vertex].xyz, pose[3u * vertex + 1u].xyz, pose[3u * vertex + 2u].xyz);
    let taps = single(point);
    let light = transferred(taps, taps, frame, vertex_view(vertex, frame));
    radiance[vertex] = vec4(albedo[vertex].xyz * light, 1.0);
}
