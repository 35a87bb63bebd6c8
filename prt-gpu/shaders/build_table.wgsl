// Tabulates a light by bands, in latitude and longitude. One invocation makes one texel, those of the border included.
// Joined after shared/sh_basis.wgsl. The twin is src/cpu/build_table.rs.

struct TableParams {
    // Texels in a row and rows, border included.
    columns: u32,
    rows: u32,
    // Bands per texel, and the first of them.
    band_count: u32,
    first_band: u32,
    // [n^2], three channels beside each other
    light: array<vec4<f32>, 100>,
}

@group(0) @binding(0) var<uniform> params: TableParams;
// [columns, then rows], sine and cosine of longitude and latitude
@group(0) @binding(1) var<storage, read> angles: array<vec2<f32>>;
// [rows, columns, bands], three channels
@group(0) @binding(2) var<storage, read_write> table: array<vec4<f32>>;

fn light_coefficient(i: u32) -> vec3<f32> {
    return params.light[i].xyz;
}

fn write_band(texel: u32, l: u32, band: vec3<f32>) {
    if l >= params.first_band && l < params.first_band + params.band_count {
        table[texel * params.band_count + l - params.first_band] = vec4(band, 0.0);
    }
}

@compute @workgroup_size(64)
fn build(@builtin(global_invocation_id) id: vec3<u32>) {
    let texel = id.x;
    if texel >= params.columns * params.rows {
        return;
    }
    let longitude = angles[texel % params.columns];
    let latitude = angles[params.columns + texel / params.columns];
    let direction = vec3(latitude.x * longitude.x, latitude.y, -latitude.x * longitude.y);
    let bands = light_bands(direction, params.first_band + params.band_count);
    // Constant indices, so that the bands stay in registers.
    write_band(texel, 1u, bands[1]);
    write_band(texel, 2u, bands[2]);
    write_band(texel, 3u, bands[3]);
    write_band(texel, 4u, bands[4]);
    write_band(texel, 5u, bands[5]);
    write_band(texel, 6u, bands[6]);
    write_band(texel, 7u, bands[7]);
    write_band(texel, 8u, bands[8]);
    write_band(texel, 9u, bands[9]);
}
