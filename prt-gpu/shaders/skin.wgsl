// Poses vertices by linear blend skinning. One invocation makes position and frame of one vertex. The twin is src/cpu/skin.rs.

struct SkinParams {
    vertex_count: u32,
    // Invocations in one row of the dispatch.
    row_length: u32,
    // 1: frames are rotations from the rest frame; 0: tangent, bitangent, normal.
    from_rest: u32,
    padding: u32,
}

// Weights of the joints, and their numbers.
struct Influence {
    weights: vec4<f32>,
    joints: vec4<u32>,
}

@group(0) @binding(0) var<uniform> params: SkinParams;
// [vertices, 3], the columns of the rest frame in xyz and the rest position in w
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
// [vertices]
@group(0) @binding(2) var<storage, read> influences: array<Influence>;
// [joints], from the rest pose to the pose
@group(0) @binding(3) var<storage, read> joints: array<mat4x4<f32>>;
// [vertices, 3], as `rest`
@group(0) @binding(4) var<storage, read_write> pose: array<vec4<f32>>;

// See src/skin.rs.
const COLLAPSE: f32 = 1e-6;

fn is_collapsed(v: vec3<f32>) -> bool {
    return !(dot(v, v) > COLLAPSE * COLLAPSE);
}

fn unit(v: vec3<f32>) -> vec3<f32> {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return normalize(v / largest);
}

fn largest_of(m: mat3x3<f32>) -> f32 {
    let largest = max(max(abs(m[0]), abs(m[1])), abs(m[2]));
    return max(max(largest.x, largest.y), max(largest.z, 1.17549435e-38));
}

// Where a tangent has collapsed: the rest pose's, as far as it fits, or any.
fn other_tangent(tangent: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let kept = tangent - dot(tangent, normal) * normal;
    if dot(kept, kept) > 1e-10 {
        return normalize(kept);
    }
    let axis = select(vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), abs(normal.x) < 0.6);
    return normalize(axis - dot(axis, normal) * normal);
}

// The frame that a linear map takes a rest frame to: see src/skin.rs.
fn posed_frame(linear: mat3x3<f32>, frame: mat3x3<f32>) -> mat3x3<f32> {
    let f = linear * (1.0 / largest_of(linear));
    let mapped = mat3x3(cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])) * frame[2];
    var normal = frame[2];
    if !is_collapsed(mapped) {
        normal = unit(mapped);
    }
    let side = select(1.0, -1.0, dot(cross(frame[2], frame[0]), frame[1]) < 0.0);
    let ft = f * frame[0];
    let fb = f * frame[1];
    let sum = (ft - dot(normal, ft) * normal) - side * cross(normal, fb);
    var tangent = other_tangent(frame[0], normal);
    if !is_collapsed(sum) {
        tangent = unit(sum);
    }
    return mat3x3(tangent, side * cross(normal, tangent), normal);
}

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3<u32>) {
    let vertex = id.y * params.row_length + id.x;
    if vertex >= params.vertex_count {
        return;
    }
    let by = influences[vertex];
    let blended = by.weights.x * joints[by.joints.x] + by.weights.y * joints[by.joints.y]
        + by.weights.z * joints[by.joints.z] + by.weights.w * joints[by.joints.w];
    let first = 3u * vertex;
    let frame = mat3x3(rest[first].xyz, rest[first + 1u].xyz, rest[first + 2u].xyz);
    let position = (blended * vec4(rest[first].w, rest[first + 1u].w, rest[first + 2u].w, 1.0)).xyz;
    var posed = posed_frame(mat3x3(blended[0].xyz, blended[1].xyz, blended[2].xyz), frame);
    if params.from_rest == 1u {
        posed = posed * transpose(frame);
    }
    pose[first] = vec4(posed[0], position.x);
    pose[first + 1u] = vec4(posed[1], position.y);
    pose[first + 2u] = vec4(posed[2], position.z);
}
