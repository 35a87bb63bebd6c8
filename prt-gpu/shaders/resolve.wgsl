// Turns the nearest triangles into an image. One invocation makes one pixel: the mean radiance and the coverage of its samples,
// and the smallest depth. Joined after shared/screen.wgsl.

struct ClipVertex {
    // Three vertices of the mesh and their shares.
    source: vec3<u32>,
    padding_0: u32,
    weight: vec3<f32>,
    padding_1: u32,
}

// [clip vertices]
@group(0) @binding(3) var<storage, read> clips: array<ClipVertex>;
// [mesh vertices], radiance in xyz
@group(0) @binding(4) var<storage, read> radiance: array<vec4<f32>>;

// [height x samples, width x samples], number of the triangle from 1, or 0
@group(1) @binding(0) var nearest: texture_2d<u32>;
// [height, width], radiance premultiplied by coverage, and coverage
@group(1) @binding(1) var color: texture_storage_2d<rgba32float, write>;
// [height, width], smallest clip depth, 1 where there is nothing
@group(1) @binding(2) var depth: texture_storage_2d<r32float, write>;

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

fn surface_radiance(triangle: u32, weights: vec3<f32>) -> vec3<f32> {
    if triangle >= frame.front_count {
        return vec3(0.0);
    }
    let a = corner_radiance(corners[3u * triangle]);
    let b = corner_radiance(corners[3u * triangle + 1u]);
    let c = corner_radiance(corners[3u * triangle + 2u]);
    return (weights.x * a + weights.y * b) + weights.z * c;
}

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
    let radiance = surface_radiance(triangle - 1u, at.weights);
    return Pixel(pixel.sum + vec4(radiance, 1.0), min(pixel.depth, at.depth));
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let first = vec2<i32>(id.xy * frame.samples);
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
    textureStore(color, id.xy, pixel.sum / f32(samples * samples));
    textureStore(depth, id.xy, vec4(pixel.depth, 0.0, 0.0, 0.0));
}
