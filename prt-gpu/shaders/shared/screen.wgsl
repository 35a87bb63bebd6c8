// Triangles on the screen, as src/assemble makes them, and where a sample lies in one. The twin is src/triangle.rs: every
// function gives the same bits there.

struct FrameParams {
    // Width and height of the image in pixels.
    size: vec2<u32>,
    // Samples per pixel along each axis.
    samples: u32,
    // Vertices of the mesh; screen vertices from here on come from clipping.
    vertex_count: u32,
    // Screen triangles from here on are seen from the back.
    front_count: u32,
    // Always 0, which no compiler knows: see `exact`.
    zero: u32,
    padding: vec2<u32>,
}

struct ScreenVertex {
    // Steps of 1/256 sample from the left and the top edge of the image.
    x: i32,
    y: i32,
    // Clip depth z/w, 0 to 1.
    z: f32,
    inverse_w: f32,
}

@group(0) @binding(0) var<uniform> frame: FrameParams;
// [mesh vertices, then clip vertices]
@group(0) @binding(1) var<storage, read> vertices: array<ScreenVertex>;
// [3 x triangles], corners in `vertices`, positive area with y down
@group(0) @binding(2) var<storage, read> corners: array<u32>;

// An intermediate result, rounded to 32 bits here and now. Optimisers may otherwise fuse a product with the addition that
// follows or regroup a sum, and the result would differ from the twin in the last bit.
fn exact(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) | frame.zero);
}

// One Newton step towards 1 / x.
fn refine(r: f32, x: f32) -> f32 {
    return exact(r * exact(2.0 - exact(x * r)));
}

// See `reciprocal` in src/triangle.rs.
fn reciprocal(x: f32) -> f32 {
    let guess = bitcast<f32>(0x7ef311c7u - bitcast<u32>(x));
    return refine(refine(refine(refine(guess, x), x), x), x);
}

// p.x * q.y - p.y * q.x, rounded once, for numbers below 2^23. Products of the upper and lower 12 bits fit into 32 bits.
fn cross_exact(p: vec2<i32>, q: vec2<i32>) -> f32 {
    let p_high = p >> vec2(12u);
    let q_high = q >> vec2(12u);
    let p_low = p & vec2(4095);
    let q_low = q & vec2(4095);
    let low = p_low.x * q_low.y - p_low.y * q_low.x;
    let middle = (p_high.x * q_low.y + p_low.x * q_high.y) - (p_high.y * q_low.x + p_low.y * q_high.x) + (low >> 12u);
    let high = p_high.x * q_high.y - p_high.y * q_high.x + (middle >> 12u);
    // Both parts are below 2^24 and the factor is a power of two: one rounding, fused or not.
    return f32(high) * 16777216.0 + f32(((middle & 4095) << 12u) | (low & 4095));
}

fn corner(triangle: u32, k: u32) -> ScreenVertex {
    return vertices[corners[3u * triangle + k]];
}

struct Hit {
    // Shares of the corners, linear on the surface.
    weights: vec3<f32>,
    // The same before they are divided by their sum, with the twin's bits.
    shares: vec3<f32>,
    // Clip depth, 0 to 1.
    depth: f32,
}

// The point of a triangle at the centre of a sample.
fn hit(triangle: u32, sample: vec2<i32>) -> Hit {
    let a = corner(triangle, 0u);
    let b = corner(triangle, 1u);
    let c = corner(triangle, 2u);
    let centre = sample * 256 + vec2(128);
    let pa = vec2(a.x, a.y) - centre;
    let pb = vec2(b.x, b.y) - centre;
    let pc = vec2(c.x, c.y) - centre;
    let edges = vec3(cross_exact(pb, pc), cross_exact(pc, pa), cross_exact(pa, pb));
    let r = reciprocal(exact(edges.x + edges.y) + edges.z);
    let screen = vec3(exact(edges.x * r), exact(edges.y * r), exact(edges.z * r));
    let rise = exact(exact(screen.y * exact(b.z - a.z)) + exact(screen.z * exact(c.z - a.z)));
    let shares = vec3(exact(screen.x * a.inverse_w), exact(screen.y * b.inverse_w), exact(screen.z * c.inverse_w));
    return Hit(shares / (shares.x + shares.y + shares.z), shares, clamp(a.z + rise, 0.0, 1.0));
}
