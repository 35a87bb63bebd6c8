//! Bakes a mesh file and writes the result: `cargo run --release -p prt-bake --example 01_bake -- bunny.obj bunny.prt`.

use std::path::Path;

use prt_bake::{BakeOptions, Mesh, MeshOptions, Source, bake_diffuse, load_mesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(out)) = (arguments.next(), arguments.next()) else {
        return Err("give a mesh file and the file to write".into());
    };

    // 1. A mesh as its file gives it, then cleaned: no degenerate faces, a normal and an albedo everywhere.
    let source = load_mesh(Path::new(&scene))?;
    let (mesh, _) = Mesh::new(source, &MeshOptions::default())?;

    // 2. Transfer with shadows and one bounce, order 5. `()` means that nobody wants to hear of progress.
    let options = BakeOptions { bounces: 1, ..BakeOptions::preview() };
    let (mut baked, _) = bake_diffuse(&mesh, &options, &())?;

    // 3. One file, which NumPy reads too: `safetensors.numpy.load_file("bunny.prt")`.
    baked.metadata.source = Some(Source::of_file(Path::new(&scene))?);
    baked.write(Path::new(&out))?;
    Ok(())
}
