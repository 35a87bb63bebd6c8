// Draws which triangle is nearest at every sample. One vertex invocation places a corner of a triangle; one fragment
// invocation writes the triangle's number, from 1, and its depth. Joined after shared/screen.wgsl; bindings as there.

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) triangle: u32,
}

struct Nearest {
    // 0 is left where there is nothing.
    @location(0) triangle: u32,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn place(@builtin(vertex_index) index: u32) -> Corner {
    let v = vertices[corners[index]];
    // Half the image in grid steps. The difference is exact; the quotient lands within a quarter step of the grid point in the
    // viewport, so that every GPU snaps it there.
    let half = vec2<f32>(frame.size * frame.samples * 128u);
    let clip = (vec2(f32(v.x), f32(v.y)) - half) / half;
    return Corner(vec4(clip.x, -clip.y, 0.5, 1.0), index / 3u);
}

@fragment
fn write(in: Corner) -> Nearest {
    return Nearest(in.triangle + 1u, hit(in.triangle, vec2<i32>(in.position.xy)).depth);
}
