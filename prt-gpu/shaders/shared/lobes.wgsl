// Zonal lobes of points, and the radiance they transfer. Joined after shared/angle.wgsl and shared/sh_basis.wgsl.
// The twin is src/cpu/shade_lobes.rs.
//
// The record of a point is explicit [rows, channels, k], axes [rows, lobes, 3], coefficients [rows, channels, lobes, stored bands].

struct LobeParams {
    // Between the records of neighbouring points, and between the items of a record.
    point_stride: u32,
    item_stride: u32,
    rows: u32,
    // 1 or 3.
    channels: u32,
    lobe_count: u32,
    // 1 or 4.
    explicit_count: u32,
    // Bands that lobes have: stored, and of these in use.
    stored_bands: u32,
    used_bands: u32,
    // The first of them, 1 or 2.
    first_band: u32,
    // Without the border.
    table_width: u32,
    table_height: u32,
    // Texels of a side; 0 for none.
    view_size: u32,
    eye: vec3<f32>,
    // 1 if there is an eye.
    has_eye: u32,
    // The points whose records are bound, and invocations in one row of the dispatch.
    first_point: u32,
    point_count: u32,
    row_length: u32,
    padding: u32,
    // [n^2], three channels beside each other
    light: array<vec4<f32>, 100>,
}

// What is constant for a pipeline: software adapters run both sides of a branch.

// Bands of the light in use, and the first band that lobes have.
override ORDER: u32 = 10u;
override FIRST_BAND: u32 = 1u;
override USE_TABLE: bool = true;
// One channel of transfer.
override IS_GREY: bool = true;
override HAS_VIEW_MAP: bool = false;

@group(0) @binding(10) var<uniform> lobe_params: LobeParams;
@group(0) @binding(11) var<storage, read> lobes: array<f32>;
// [height + 2, width + 1, used bands], three channels
@group(0) @binding(12) var<storage, read> table: array<vec4<f32>>;
// [size, size, rows]
@group(0) @binding(13) var<storage, read> view_map: array<f32>;

fn light_coefficient(i: u32) -> vec3<f32> {
    return lobe_params.light[i].xyz;
}

// Points that a value is mixed from.
struct Taps {
    points: vec4<u32>,
    weights: vec4<f32>,
    // 1 or 4.
    count: u32,
}

fn single(point: u32) -> Taps {
    return Taps(vec4(point), vec4(1.0, 0.0, 0.0, 0.0), 1u);
}

fn item(taps: Taps, i: u32) -> f32 {
    let at = taps.points * lobe_params.point_stride + i * lobe_params.item_stride;
    if taps.count == 1u {
        return lobes[at.x];
    }
    return dot(taps.weights, vec4(lobes[at.x], lobes[at.y], lobes[at.z], lobes[at.w]));
}

// An item of all channels, `stride` items apart.
fn channels(taps: Taps, i: u32, stride: u32) -> vec3<f32> {
    if IS_GREY {
        return vec3(item(taps, i));
    }
    return vec3(item(taps, i), item(taps, i + stride), item(taps, i + 2u * stride));
}

// Explicit coefficients of a row under the light. The linear band is a vector, which the frame turns like a direction.
fn explicit_radiance(taps: Taps, row: u32, frame: mat3x3<f32>) -> vec3<f32> {
    let k = FIRST_BAND * FIRST_BAND;
    let first = row * lobe_params.channels * k;
    let dc = channels(taps, first, k) * light_coefficient(0u);
    if k == 1u {
        return dc;
    }
    let x = -light_coefficient(3u);
    let y = -light_coefficient(1u);
    let z = light_coefficient(2u);
    let local_x = frame[0].x * x + frame[0].y * y + frame[0].z * z;
    let local_y = frame[1].x * x + frame[1].y * y + frame[1].z * z;
    let local_z = frame[2].x * x + frame[2].y * y + frame[2].z * z;
    return dc - channels(taps, first + 3u, k) * local_x - channels(taps, first + 1u, k) * local_y
        + channels(taps, first + 2u, k) * local_z;
}

fn lobe_axis(taps: Taps, lobe: u32) -> vec3<f32> {
    let i = lobe_params.rows * lobe_params.channels * lobe_params.explicit_count + 3u * lobe;
    let axis = vec3(item(taps, i), item(taps, i + 1u), item(taps, i + 2u));
    if taps.count == 1u {
        return axis;
    }
    return unit_or(axis, lobe_axis_of_first(taps, i));
}

fn lobe_axis_of_first(taps: Taps, i: u32) -> vec3<f32> {
    let first = single(taps.points.x);
    return vec3(item(first, i), item(first, i + 1u), item(first, i + 2u));
}

// The unit vector of v; `other` where v has no direction.
fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if !(largest > 1e-37 && largest < 3e38) {
        return other;
    }
    return normalize(v / largest);
}

// Where a direction lies in the table.
struct Place {
    // Upper left texel, border included.
    texel: u32,
    // How far it is towards the right and the lower one.
    share: vec2<f32>,
}

// u = atan2(x, -z) / 2 pi, v = acos(y) / pi.
fn table_place(s: vec3<f32>) -> Place {
    let width = f32(lobe_params.table_width);
    let height = f32(lobe_params.table_height);
    var column = turn(s.x, -s.z) * width - 0.5;
    column = select(column, column + width, column < 0.0);
    let row = turn(length(s.xz), s.y) * (2.0 * height) + 0.5;
    // Rounding may reach the end of a row or of the table: then the share is 1.
    let i = min(u32(column), lobe_params.table_width - 1u);
    let j = min(u32(row), lobe_params.table_height);
    return Place(j * (lobe_params.table_width + 1u) + i, vec2(column - f32(i), row - f32(j)));
}

// A band of the table, bilinear.
fn table_band(place: Place, band: u32) -> vec3<f32> {
    let bands = ORDER - FIRST_BAND;
    let top = place.texel * bands + band;
    let bottom = top + (lobe_params.table_width + 1u) * bands;
    let upper = mix(table[top].xyz, table[top + bands].xyz, place.share.x);
    let lower = mix(table[bottom].xyz, table[bottom + bands].xyz, place.share.x);
    return mix(upper, lower, place.share.y);
}

struct Lobe {
    // Item of the first stored band, and items between channels.
    first: u32,
    stride: u32,
}

fn coefficients(taps: Taps, lobe: Lobe, band: u32) -> vec3<f32> {
    return channels(taps, lobe.first + band, lobe.stride);
}

fn from_table(taps: Taps, lobe: Lobe, axis: vec3<f32>) -> vec3<f32> {
    let place = table_place(axis);
    var sum = vec3(0.0);
    for (var band = 0u; band < ORDER - FIRST_BAND; band++) {
        sum += coefficients(taps, lobe, band) * table_band(place, band);
    }
    return sum;
}

// Band l of the light times the lobe's coefficient, 0 where that band is explicit or not in use.
fn band_radiance(taps: Taps, lobe: Lobe, l: u32, band: vec3<f32>) -> vec3<f32> {
    if l < FIRST_BAND || l >= ORDER {
        return vec3(0.0);
    }
    return coefficients(taps, lobe, l - FIRST_BAND) * band;
}

// Constant indices, so that the bands stay in registers.
fn from_basis(taps: Taps, lobe: Lobe, axis: vec3<f32>) -> vec3<f32> {
    let bands = light_bands(axis, ORDER);
    var sum = band_radiance(taps, lobe, 1u, bands[1]);
    sum += band_radiance(taps, lobe, 2u, bands[2]);
    sum += band_radiance(taps, lobe, 3u, bands[3]);
    sum += band_radiance(taps, lobe, 4u, bands[4]);
    sum += band_radiance(taps, lobe, 5u, bands[5]);
    sum += band_radiance(taps, lobe, 6u, bands[6]);
    sum += band_radiance(taps, lobe, 7u, bands[7]);
    sum += band_radiance(taps, lobe, 8u, bands[8]);
    return sum + band_radiance(taps, lobe, 9u, bands[9]);
}

fn lobe_radiance(taps: Taps, row: u32, frame: mat3x3<f32>) -> vec3<f32> {
    let count = lobe_params.lobe_count;
    let stride = count * lobe_params.stored_bands;
    let explicit_items = lobe_params.rows * lobe_params.channels * lobe_params.explicit_count;
    let row_first = explicit_items + 3u * lobe_params.rows * count + row * lobe_params.channels * stride;
    var sum = vec3(0.0);
    for (var j = 0u; j < count; j++) {
        let lobe = Lobe(row_first + j * lobe_params.stored_bands, stride);
        let axis = frame * lobe_axis(taps, row * count + j);
        if USE_TABLE {
            sum += from_table(taps, lobe, axis);
        } else {
            sum += from_basis(taps, lobe, axis);
        }
    }
    return sum;
}

// Where the view map is read.
struct ViewPlace {
    // Texel numbers: upper left, upper right, lower left, lower right.
    texels: vec4<u32>,
    weights: vec4<f32>,
}

// The inverse of Shirley and Chiu's concentric map, from the unit disk to [-1, 1]^2.
fn square_from_disk(d: vec2<f32>) -> vec2<f32> {
    let radius = length(d);
    if radius == 0.0 {
        return vec2(0.0);
    }
    if abs(d.x) >= abs(d.y) {
        let a = select(-radius, radius, d.x > 0.0);
        return vec2(a, a * (atan_unit(d.y / d.x) / (0.5 * HALF_PI)));
    }
    let b = select(-radius, radius, d.y > 0.0);
    return vec2(b * (atan_unit(d.x / d.y) / (0.5 * HALF_PI)), b);
}

// A local direction in the unit square; below the horizon it counts as on the horizon. The twin is src/view_map.rs.
fn square_from_hemisphere(v: vec3<f32>) -> vec2<f32> {
    var disk = v.xy / sqrt(1.0 + max(v.z, 0.0));
    if v.z < 0.0 {
        let radius = length(v.xy);
        disk = select(vec2(1.0, 0.0), v.xy / max(radius, 1e-37), radius > 0.0);
    }
    return 0.5 + 0.5 * square_from_disk(disk);
}

// Looks from a point with a local frame to the eye; along its normal without an eye.
fn view_place(position: vec3<f32>, local: mat3x3<f32>) -> ViewPlace {
    if !HAS_VIEW_MAP {
        return ViewPlace(vec4(0u), vec4(0.0));
    }
    var direction = vec3(0.0, 0.0, 1.0);
    if lobe_params.has_eye == 1u {
        direction = transpose(local) * unit_or(lobe_params.eye - position, local[2]);
    }
    let size = lobe_params.view_size;
    let at = clamp(square_from_hemisphere(direction) * f32(size) - 0.5, vec2(0.0), vec2(f32(size - 1u)));
    let first = vec2<u32>(at);
    let next = min(first + 1u, vec2(size - 1u));
    let share = at - vec2<f32>(first);
    let texels = vec4(first.y * size + first.x, first.y * size + next.x, next.y * size + first.x, next.y * size + next.x);
    let rest = 1.0 - share;
    return ViewPlace(texels, vec4(rest.x * rest.y, share.x * rest.y, rest.x * share.y, share.x * share.y));
}

fn view_factor(place: ViewPlace, row: u32) -> f32 {
    if !HAS_VIEW_MAP {
        return 1.0;
    }
    let at = place.texels * lobe_params.rows + row;
    return dot(place.weights, vec4(view_map[at.x], view_map[at.y], view_map[at.z], view_map[at.w]));
}

// Radiance of a point without its albedo.
fn transferred(explicit_taps: Taps, taps: Taps, frame: mat3x3<f32>, view: ViewPlace) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var row = 0u; row < lobe_params.rows; row++) {
        sum += view_factor(view, row) * (explicit_radiance(explicit_taps, row, frame) + lobe_radiance(taps, row, frame));
    }
    return sum;
}
