// Shows a resolved image in the caller's render pass: one fragment invocation tone-maps one pixel, over the environment if asked.
// Joined after shared/tone_map.wgsl.

struct PresentParams {
    world_from_clip: mat4x4<f32>,
    // Factor on radiance.
    exposure: f32,
    // 1 to show the environment behind the surface.
    show_background: u32,
    padding: vec2<u32>,
}

// The caller's target does not encode sRGB itself.
override ENCODE_SRGB: bool = true;

@group(0) @binding(0) var<uniform> params: PresentParams;
// [height, width], radiance premultiplied by coverage, and coverage
@group(0) @binding(1) var color: texture_2d<f32>;
// [height, width], latitude-longitude radiance, y up
@group(0) @binding(2) var environment: texture_2d<f32>;

const PI: f32 = 3.14159265358979;

struct Corner {
    @builtin(position) position: vec4<f32>,
    // 0 to 1 from the left and the top.
    @location(0) uv: vec2<f32>,
}

// A triangle that holds the viewport.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> Corner {
    let uv = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5, 1.0), uv);
}

// Radiance from a direction, bilinear. u = atan2(x, -z) / 2 pi, v = acos(y) / pi, as Mitsuba's envmap.
fn environment_radiance(direction: vec3<f32>) -> vec3<f32> {
    let size = vec2<i32>(textureDimensions(environment));
    let u = fract(atan2(direction.x, -direction.z) / (2.0 * PI));
    // acos(y), without its loss of digits at the poles.
    let v = atan2(length(direction.xz), direction.y) / PI;
    let texel = vec2(u, v) * vec2<f32>(size) - 0.5;
    let base = vec2<i32>(floor(texel));
    let share = texel - floor(texel);
    let top = mix(environment_texel(base, size), environment_texel(base + vec2(1, 0), size), share.x);
    let bottom = mix(environment_texel(base + vec2(0, 1), size), environment_texel(base + vec2(1, 1), size), share.x);
    return mix(top, bottom, share.y);
}

// Columns wrap around, rows end at the poles.
fn environment_texel(texel: vec2<i32>, size: vec2<i32>) -> vec3<f32> {
    return textureLoad(environment, vec2((texel.x + size.x) % size.x, clamp(texel.y, 0, size.y - 1)), 0).xyz;
}

// The direction that the camera sees through a point of the image.
fn view_direction(uv: vec2<f32>) -> vec3<f32> {
    let clip = vec2(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let near = params.world_from_clip * vec4(clip, 0.0, 1.0);
    let far = params.world_from_clip * vec4(clip, 1.0, 1.0);
    return normalize(far.xyz / far.w - near.xyz / near.w);
}

@fragment
fn show(in: Corner) -> @location(0) vec4<f32> {
    let size = vec2<i32>(textureDimensions(color));
    let pixel = textureLoad(color, clamp(vec2<i32>(in.uv * vec2<f32>(size)), vec2(0), size - 1), 0);
    var radiance = pixel.xyz;
    if params.show_background == 1u {
        radiance += (1.0 - pixel.w) * environment_radiance(view_direction(in.uv));
    }
    let display = compress(radiance * params.exposure);
    if ENCODE_SRGB {
        return vec4(encode_srgb(display), 1.0);
    }
    return vec4(display, 1.0);
}
