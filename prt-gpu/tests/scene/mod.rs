//! Surfaces, lights and cameras of the tests.

use prt_gpu::{Gpu, Surface, View, wgpu};
use sh_core::Order;
use std::f32::consts::{PI, TAU};

pub(crate) const IDENTITY: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// Numbers that look random, from -1 to 1.
pub(crate) fn noise(count: usize, seed: u32) -> Vec<f32> {
    let hash = |i: u32| {
        let mut x = (i + 1).wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
        x ^ (x >> 16)
    };
    (0..count as u32).map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0).collect()
}

/// Everything that an image is made from.
pub(crate) struct Scene {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) albedo: Vec<[f32; 3]>,
    pub(crate) transfer: Vec<f32>,
    pub(crate) light: Vec<f32>,
    pub(crate) order: Order,
    channels: usize,
}

impl Scene {
    pub(crate) fn surface(&self) -> Surface<'_> {
        Surface::new(&self.positions, &self.triangles, &self.albedo, self.order, self.channels, &self.transfer).unwrap()
    }

    /// A mesh with transfer and light of random size, brighter than dark so that the mean means something.
    fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, n: usize, channels: usize) -> Self {
        let order = Order::new(n).unwrap();
        let count = positions.len();
        let mut transfer: Vec<f32> = noise(count * channels * n * n, 1).iter().map(|t| t * 0.2).collect();
        transfer.chunks_exact_mut(n * n).for_each(|row| row[0] = 1.0);
        let mut light = noise(3 * n * n, 2);
        light.chunks_exact_mut(n * n).for_each(|row| row[0] = 1.0);
        let albedo = noise(3 * count, 3).chunks_exact(3).map(|a| [a[0], a[1], a[2]].map(|x| 0.6 + 0.3 * x)).collect();
        Self { positions, triangles, albedo, transfer, light, order, channels }
    }

    /// A unit sphere of `rings` rings of twice as many vertices, counterclockwise from outside.
    pub(crate) fn sphere(rings: u32, n: usize, channels: usize) -> Self {
        let columns = 2 * rings;
        let vertex = |i: u32| {
            let (theta, phi) =
                (PI * (i / columns) as f32 / (rings - 1) as f32, TAU * (i % columns) as f32 / columns as f32);
            [theta.sin() * phi.sin(), theta.cos(), theta.sin() * phi.cos()]
        };
        let cell = |i: u32| {
            let (row, column) = (i / columns * columns, i % columns);
            let [a, b] = [row + column, row + (column + 1) % columns];
            [[a, a + columns, b + columns], [a, b + columns, b]]
        };
        let cells = 0..(rings - 1) * columns;
        Self::new((0..rings * columns).map(vertex).collect(), cells.flat_map(cell).collect(), n, channels)
    }

    /// Adds two large triangles below.
    pub(crate) fn with_floor(self) -> Self {
        let first = self.positions.len() as u32;
        let mut positions = self.positions;
        positions.extend([[-50.0, -1.0, -50.0], [-50.0, -1.0, 50.0], [50.0, -1.0, 50.0], [50.0, -1.0, -50.0]]);
        let mut triangles = self.triangles;
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|corners: [u32; 3]| corners.map(|v| v + first)));
        Self::new(positions, triangles, self.order.get(), self.channels)
    }

    /// Triangles anywhere, most of them small or thin, each of them twice with opposite winding.
    pub(crate) fn soup(count: u32) -> Self {
        let random = noise(9 * count as usize, 9);
        let corners = |r: &[f32]| {
            let size = [0.02, 0.2, 2.0][(r[0].abs() * 3.0) as usize % 3];
            let thin = if r[1] > 0.3 { 0.01 } else { 1.0 };
            let centre = [r[0], r[1], r[2]].map(|x| 1.5 * x);
            let [a, b] = [[r[3], r[4], r[5]], [r[6], r[7], r[8]]].map(|d| d.map(|x| x * size));
            let corner = |k: f32, l: f32| std::array::from_fn(|i| centre[i] + k * a[i] + l * b[i]);
            [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.5, thin)]
        };
        let positions: Vec<[f32; 3]> = random.chunks_exact(9).flat_map(corners).collect();
        let triangles =
            (0..count).flat_map(|t| [[3 * t, 3 * t + 2, 3 * t + 1], [3 * t, 3 * t + 1, 3 * t + 2]]).collect();
        Self::new(positions, triangles, 2, 1)
    }

    /// A grid on the image plane of [`IDENTITY`] whose lines pass through centres of an image of `side` pixels.
    pub(crate) fn grid(side: u32, cells: u32) -> Self {
        let at = |i: u32| (i * (side / cells)) as f32 + 0.5;
        let vertex = |i: u32| {
            let [x, y] = [at(i % cells), at(i / cells)].map(|p| p / side as f32 * 2.0 - 1.0);
            [x, -y, 0.25]
        };
        let inner = (0..cells * cells).filter(|i| i % cells + 1 < cells && i / cells + 1 < cells);
        let cell = |a: u32| match a % 3 {
            0 => vec![[a, a + cells, a + cells + 1], [a, a + cells + 1, a + 1]],
            1 => vec![[a, a + cells, a + 1], [a + 1, a + cells, a + cells + 1]],
            // Every third cell stays open: its neighbours' edges decide alone.
            _ => Vec::new(),
        };
        Self::new((0..cells * cells).map(vertex).collect(), inner.flat_map(cell).collect(), 1, 1)
    }
}

/// A camera that looks at the origin, 50 degrees high, with the near plane at `near` and the far one at 100.
pub(crate) fn look_at(eye: [f32; 3], aspect: f32, near: f32) -> [[f32; 4]; 4] {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let unit = |a: [f32; 3]| a.map(|x| x / dot(a, a).sqrt());
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let back = unit(eye);
    let right = unit(cross([0.0, 1.0, 0.0], back));
    let up = cross(back, right);
    let far = 100.0;
    let scale = 1.0 / 25.0_f32.to_radians().tan();
    let depth = far / (near - far);
    // Row by row: x, y, z and w of clip space from the axes of the camera.
    let rows = [
        (right.map(|x| x * scale / aspect), 0.0),
        (up.map(|x| x * scale), 0.0),
        (back.map(|x| x * depth), near * depth),
        (back.map(|x| -x), 0.0),
    ];
    let row = |(axis, offset): ([f32; 3], f32)| [axis[0], axis[1], axis[2], offset - dot(axis, eye)];
    let rows = rows.map(row);
    std::array::from_fn(|column| rows.map(|row| row[column]))
}

/// A latitude-longitude map with different colours everywhere.
pub(crate) fn sky(width: usize, height: usize) -> Vec<[f32; 3]> {
    let texel = |i: usize| {
        [(i % width) as f32 / width as f32, (i / width) as f32 / height as f32, ((i * 7) % 11) as f32 / 10.0]
    };
    (0..width * height).map(texel).collect()
}

/// Bilinear look-up in `f64`, with `u = atan2(x, -z) / 2π` and `v = acos(y) / π`.
pub(crate) fn sample_sky(map: &[[f32; 3]], width: i64, height: i64, d: [f64; 3]) -> [f32; 3] {
    let x =
        d[0].atan2(-d[2]).rem_euclid(2.0 * std::f64::consts::PI) / (2.0 * std::f64::consts::PI) * width as f64 - 0.5;
    let y = d[1].clamp(-1.0, 1.0).acos() / std::f64::consts::PI * height as f64 - 0.5;
    let texel = |x: i64, y: i64| map[(y.clamp(0, height - 1) * width + x.rem_euclid(width)) as usize].map(f64::from);
    let (i, j, s, t) = (x.floor() as i64, y.floor() as i64, x - x.floor(), y - y.floor());
    let mix = |a: f64, b: f64, k: f64| a + k * (b - a);
    std::array::from_fn(|c| {
        let row = |j: i64| mix(texel(i, j)[c], texel(i + 1, j)[c], s);
        mix(row(j), row(j + 1), t) as f32
    })
}

/// The direction that a camera of [`look_at`] sees through a pixel: orthogonal to the planes that project to it.
pub(crate) fn direction(view: &View, x: usize, y: usize) -> [f64; 3] {
    let ndc =
        [2.0 * (x as f64 + 0.5) / f64::from(view.width) - 1.0, 1.0 - 2.0 * (y as f64 + 0.5) / f64::from(view.height)];
    let row = |r: usize| -> [f64; 3] { std::array::from_fn(|c| f64::from(view.clip_from_world[c][r])) };
    // Points with clip.x = ndc.x w form a plane with this normal; likewise y.
    let normal = |r: usize| -> [f64; 3] { std::array::from_fn(|c| row(r)[c] - ndc[r] * row(3)[c]) };
    let (a, b) = (normal(0), normal(1));
    let d = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let forward = (0..3).map(|c| d[c] * row(3)[c]).sum::<f64>();
    let length = d.iter().map(|x| x * x).sum::<f64>().sqrt().copysign(forward);
    d.map(|x| x / length)
}

/// Submits and reads back a texture of four bytes per texel.
pub(crate) fn read_bytes(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, texture: &wgpu::Texture) -> Vec<[u8; 4]> {
    let size = texture.size();
    let row_bytes = (4 * size.width).next_multiple_of(256);
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row_bytes * size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        size,
    );
    gpu.queue().submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = buffer.get_mapped_range(..).unwrap();
    let texels = bytes.chunks_exact(row_bytes as usize).flat_map(|row| row[..4 * size.width as usize].chunks_exact(4));
    texels.map(|t| [t[0], t[1], t[2], t[3]]).collect()
}
