// Turns the nearest triangles into an image, shading every sample from a texture of zonal lobes. One invocation makes one pixel.
// Joined after shared/screen.wgsl, shared/pixel.wgsl and shared/lobes.wgsl. The twin is src/cpu/resolve_texture.rs.
//
// Which texel a sample reads is decided by the twin's roundings; all else is continuous in what differs.

struct TextureParams {
    // Texels.
    size: vec2<u32>,
    // Texels per unit of uv.
    scale: vec2<f32>,
    // 1 if the records end with an albedo; its first item.
    has_albedo: u32,
    albedo_item: u32,
    // 1 if the records have a normal of the relief; its first item.
    has_normals: u32,
    normal_item: u32,
}

// 0: all nearest; 1: explicit coefficients bilinear; 2: all bilinear.
override SAMPLING: u32 = 1u;

// [vertices, 3], the columns of the frame in xyz and the position in w
@group(0) @binding(4) var<storage, read> pose: array<vec4<f32>>;
// [vertices, 2], uv in xy; albedo in xyz
@group(0) @binding(5) var<storage, read> attributes: array<vec4<f32>>;
@group(0) @binding(6) var<uniform> texture_params: TextureParams;

// What is interpolated.
struct Attributes {
    uv: vec2<f32>,
    albedo: vec3<f32>,
    position: vec3<f32>,
    frame: mat3x3<f32>,
}

fn mix_exact(weight: vec3<f32>, a: f32, b: f32, c: f32) -> f32 {
    return exact(exact(exact(weight.x * a) + exact(weight.y * b)) + exact(weight.z * c));
}

fn blend(weight: vec3<f32>, a: Attributes, b: Attributes, c: Attributes) -> Attributes {
    return Attributes(
        vec2(mix_exact(weight, a.uv.x, b.uv.x, c.uv.x), mix_exact(weight, a.uv.y, b.uv.y, c.uv.y)),
        weight.x * a.albedo + weight.y * b.albedo + weight.z * c.albedo,
        weight.x * a.position + weight.y * b.position + weight.z * c.position,
        weight.x * a.frame + weight.y * b.frame + weight.z * c.frame,
    );
}

fn of_vertex(vertex: u32) -> Attributes {
    let x = pose[3u * vertex];
    let y = pose[3u * vertex + 1u];
    let z = pose[3u * vertex + 2u];
    let frame = mat3x3(x.xyz, y.xyz, z.xyz);
    return Attributes(attributes[2u * vertex].xy, attributes[2u * vertex + 1u].xyz, vec3(x.w, y.w, z.w), frame);
}

fn of_corner(vertex: u32) -> Attributes {
    if vertex < frame.vertex_count {
        return of_vertex(vertex);
    }
    let clip = clips[vertex - frame.vertex_count];
    return blend(clip.weight, of_vertex(clip.source.x), of_vertex(clip.source.y), of_vertex(clip.source.z));
}

// Gram and Schmidt's frame of the third and the first column, with the handedness of the columns. See src/frame.rs.
fn orthonormalised(columns: mat3x3<f32>) -> mat3x3<f32> {
    let normal = unit_or(columns[2], vec3(0.0, 0.0, 1.0));
    let along = unit_or(columns[0], vec3(0.0));
    var rest = along - dot(along, normal) * normal;
    if !(dot(rest, rest) > 1e-10) {
        let axis = select(vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), abs(normal.x) < 0.6);
        rest = axis - dot(axis, normal) * normal;
    }
    let tangent = normalize(rest);
    let bitangent = cross(normal, tangent);
    return mat3x3(tangent, select(bitangent, -bitangent, dot(bitangent, columns[1]) < 0.0), normal);
}

fn wrap(x: i32, size: u32) -> u32 {
    let remainder = x % i32(size);
    return u32(select(remainder, remainder + i32(size), remainder < 0));
}

fn texel(column: i32, row: i32) -> u32 {
    return wrap(row, texture_params.size.y) * texture_params.size.x + wrap(column, texture_params.size.x);
}

fn nearest_texel(place: vec2<f32>) -> Taps {
    let cell = vec2<i32>(floor(place));
    return single(texel(cell.x, cell.y));
}

fn bilinear_texels(place: vec2<f32>) -> Taps {
    let corner = vec2(exact(place.x - 0.5), exact(place.y - 0.5));
    let base = floor(corner);
    let share = corner - base;
    let i = vec2<i32>(base);
    let texels = vec4(texel(i.x, i.y), texel(i.x + 1, i.y), texel(i.x, i.y + 1), texel(i.x + 1, i.y + 1));
    let rest = 1.0 - share;
    return Taps(texels, vec4(rest.x * rest.y, share.x * rest.y, rest.x * share.y, share.x * share.y), 4u);
}

fn texel_albedo(taps: Taps) -> vec3<f32> {
    if texture_params.has_albedo == 0u {
        return vec3(1.0);
    }
    let i = texture_params.albedo_item;
    return vec3(item(taps, i), item(taps, i + 1u), item(taps, i + 2u));
}

// The frame in which the view map is looked up: about the normal of the relief where there is one. See relief_frame in src/frame.rs.
fn view_frame(taps: Taps, local: mat3x3<f32>) -> mat3x3<f32> {
    if !HAS_VIEW_MAP || texture_params.has_normals == 0u {
        return local;
    }
    let i = texture_params.normal_item;
    let z = unit_or(vec3(item(taps, i), item(taps, i + 1u), item(taps, i + 2u)), vec3(0.0, 0.0, 1.0));
    let rest = vec3(1.0, 0.0, 0.0) - z.x * z;
    let x = unit_or(select(vec3(0.0), rest, dot(rest, rest) > 1e-10), vec3(0.0, 0.0, -1.0));
    return local * mat3x3(x, cross(z, x), z);
}

fn texture_place(uv: vec2<f32>) -> vec2<f32> {
    let scale = texture_params.scale;
    return clamp(vec2(exact(uv.x * scale.x), exact(uv.y * scale.y)), vec2(-1e9), vec2(1e9));
}

fn surface_radiance(triangle: u32, at: Hit) -> vec3<f32> {
    let shares = at.shares;
    let r = reciprocal(exact(exact(shares.x + shares.y) + shares.z));
    let weights = vec3(exact(shares.x * r), exact(shares.y * r), exact(shares.z * r));
    let a = of_corner(corners[3u * triangle]);
    let b = of_corner(corners[3u * triangle + 1u]);
    let c = of_corner(corners[3u * triangle + 2u]);
    let point = blend(weights, a, b, c);
    let local = orthonormalised(point.frame);

    let place = texture_place(point.uv);
    let near = nearest_texel(place);
    var around = near;
    if SAMPLING > 0u {
        around = bilinear_texels(place);
    }
    var lobe_taps = near;
    if SAMPLING == 2u {
        lobe_taps = around;
    }
    let light = transferred(around, lobe_taps, local, view_place(point.position, view_frame(near, local)));
    return point.albedo * texel_albedo(around) * light;
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    resolve_pixel(id.xy);
}
