// From samples to a pixel: the mean radiance and the coverage of its samples, and the smallest depth. Joined after shared/screen.wgsl
// and with a file that defines surface_radiance(triangle, hit) for triangles that are seen from the front.

struct ClipVertex {
    // Three vertices of the mesh and their shares.
    source: vec3<u32>,
    padding_0: u32,
    weight: vec3<f32>,
    padding_1: u32,
}

// [clip vertices]
@group(0) @binding(3) var<storage, read> clips: array<ClipVertex>;
// [height x samples, width x samples], number of the triangle from 1, or 0
@group(1) @binding(0) var nearest: texture_2d<u32>;
// [height, width], radiance premultiplied by coverage, and coverage
@group(1) @binding(1) var color: texture_storage_2d<rgba32float, write>;
// [height, width], smallest clip depth, 1 where there is nothing
@group(1) @binding(2) var depth: texture_storage_2d<r32float, write>;

// The sum over samples of a pixel, so far.
struct Pixel {
    // Radiance, and the number of samples that see a surface.
    sum: vec4<f32>,
    // Smallest clip depth.
    depth: f32,
}

fn add_sample(pixel: Pixel, sample: vec2<i32>) -> Pixel {
    let triangle = textureLoad(nearest, sample, 0).x;
    if triangle == 0u {
        return pixel;
    }
    let at = hit(triangle - 1u, sample);
    var radiance = vec3(0.0);
    if triangle <= frame.front_count {
        radiance = surface_radiance(triangle - 1u, at);
    }
    return Pixel(pixel.sum + vec4(radiance, 1.0), min(pixel.depth, at.depth));
}

// One pixel.
fn resolve_pixel(id: vec2<u32>) {
    if any(id >= frame.size) {
        return;
    }
    let first = vec2<i32>(id * frame.samples);
    let samples = i32(frame.samples);
    var pixel = Pixel(vec4(0.0), 1.0);
    // One loop rather than two: half the time on software adapters.
    var cell = vec2(0);
    loop {
        pixel = add_sample(pixel, first + cell);
        cell.x++;
        if cell.x == samples {
            cell = vec2(0, cell.y + 1);
        }
        if cell.y == samples {
            break;
        }
    }
    textureStore(color, id, pixel.sum / f32(samples * samples));
    textureStore(depth, id, vec4(pixel.depth, 0.0, 0.0, 0.0));
}
