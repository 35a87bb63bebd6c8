#![expect(clippy::unwrap_used, reason = "tests")]

mod bake;
mod charts;
mod exr;
mod gutter;
mod scenes;
mod seams;
mod triangle;

use sh_core::Order;

use crate::{BakeOptions, Mesh, MeshOptions, MeshSource, TexelOptions, TexelReport, TexelTransfer, bake_texels};

fn mesh(source: MeshSource) -> Mesh {
    let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
    assert_eq!(report.faces_dropped(), 0);
    mesh
}

fn options(n: usize) -> BakeOptions {
    BakeOptions { order: Order::new(n).unwrap(), rays_per_vertex: 512, ..BakeOptions::default() }
}

/// Without rays: transfer follows from normals alone, exactly.
fn unshadowed(n: usize) -> BakeOptions {
    BakeOptions { shadowed: false, ..options(n) }
}

fn texels(width: usize, height: usize) -> TexelOptions {
    TexelOptions { width, height, ..TexelOptions::default() }
}

/// The atlas, and what is said of it.
fn bake(mesh: &Mesh, options: &BakeOptions, texels: &TexelOptions) -> (TexelTransfer, TexelReport) {
    let (atlas, report) = bake_texels(mesh, options, texels, &()).unwrap();
    (atlas, report.texels.unwrap())
}

/// Root mean square difference, relative to the length of the second.
fn relative_difference(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len());
    let squares = |values: &mut dyn Iterator<Item = f32>| values.map(|x| f64::from(x).powi(2)).sum::<f64>();
    (squares(&mut a.iter().zip(b).map(|(a, b)| a - b)) / squares(&mut b.iter().copied())).sqrt()
}
