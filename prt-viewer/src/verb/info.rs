use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use prt_bake::{Error, Image, JournalInfo, Mesh, MeshOptions, file_info, is_journal, journal_info, load_mesh};
use serde::Serialize;

use crate::output;

/// Prints what a file holds
///
/// Of a baked file the metadata and the tensors; of a journal or a part how far its bake is; of a mesh its size and what baking would drop; of an image its size and values.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A baked file, a journal, a part, a mesh or an image
    file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    file: String,
    #[serde(flatten)]
    content: Content,
}

#[derive(Debug, Serialize)]
#[serde(tag = "content", rename_all = "lowercase")]
enum Content {
    Baked {
        bytes: u64,
        metadata: BTreeMap<String, String>,
        tensors: Vec<Tensor>,
    },
    Journal {
        bytes: u64,
        part: [u32; 2],
        vertices: usize,
        vertices_done: usize,
        bakes_texels: bool,
        texels: usize,
        texels_done: usize,
        complete: bool,
        settings: BTreeMap<String, String>,
    },
    Mesh {
        vertices: usize,
        triangles: usize,
        faces_dropped: usize,
        has_uvs: bool,
        bounds: [[f64; 3]; 2],
    },
    Image {
        width: usize,
        height: usize,
        mean: f64,
        largest: f32,
    },
}

#[derive(Debug, Serialize)]
struct Tensor {
    name: String,
    dtype: String,
    shape: Vec<usize>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let report = Report { file: arguments.file.display().to_string(), content: content(&arguments.file)? };
    output::result(arguments.json, &report, || summary(&report))
}

/// By the extension; what is no mesh and no image should be a baked file.
fn content(path: &Path) -> Result<Content, Error> {
    if is_journal(path) {
        return journal(path);
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "glb" | "gltf" | "obj" | "ply" | "off" => mesh(path),
        // A baked image says so, in metadata of its own.
        "exr" => match baked(path) {
            Err(Error::Unsupported { .. }) => image(path),
            read => read,
        },
        "hdr" | "pic" | "rgbe" | "png" | "jpg" | "jpeg" => image(path),
        _ => baked(path),
    }
}

fn baked(path: &Path) -> Result<Content, Error> {
    let info = file_info(path)?;
    let tensor = |tensor: prt_bake::TensorInfo| Tensor { name: tensor.name, dtype: tensor.dtype, shape: tensor.shape };
    let tensors = info.tensors.into_iter().map(tensor).collect();
    Ok(Content::Baked { bytes: info.bytes, metadata: info.metadata, tensors })
}

fn journal(path: &Path) -> Result<Content, Error> {
    let info = journal_info(path)?;
    let JournalInfo { part, bakes_texels, vertices, vertices_done, texels, texels_done, is_complete, settings, bytes } =
        info;
    Ok(Content::Journal {
        bytes,
        part: [part.number(), part.count()],
        vertices,
        vertices_done,
        bakes_texels,
        texels,
        texels_done,
        complete: is_complete,
        settings,
    })
}

fn mesh(path: &Path) -> Result<Content, Error> {
    let (mesh, report) = Mesh::new(load_mesh(path)?, &MeshOptions::default())?;
    Ok(Content::Mesh {
        vertices: mesh.positions().len(),
        triangles: mesh.triangles().len(),
        faces_dropped: report.faces_dropped(),
        has_uvs: mesh.uvs().is_some(),
        bounds: mesh.bounds(),
    })
}

fn image(path: &Path) -> Result<Content, Error> {
    let Image { width, height, pixels } = Image::load(path)?;
    let values = pixels.as_flattened();
    Ok(Content::Image {
        width,
        height,
        mean: values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64,
        largest: values.iter().copied().fold(f32::NEG_INFINITY, f32::max),
    })
}

fn summary(report: &Report) -> String {
    let file = &report.file;
    match &report.content {
        Content::Baked { bytes, metadata, tensors } => {
            let metadata = metadata.iter().map(|(key, value)| format!("\n  {key:<18} {value}"));
            let tensors =
                tensors.iter().map(|tensor| format!("\n  {:<18} {} {:?}", tensor.name, tensor.dtype, tensor.shape));
            let [metadata, tensors] = [metadata.collect::<String>(), tensors.collect::<String>()];
            format!("{file}, {}\nmetadata{metadata}\ntensors{tensors}", output::bytes(*bytes))
        }
        Content::Journal {
            bytes,
            part: [number, count],
            vertices,
            vertices_done,
            bakes_texels,
            texels,
            texels_done,
            complete,
            settings,
        } => {
            let done = |done: &usize, all: &usize, what| {
                format!("{} of {} {what}", output::count(*done as u64), output::count(*all as u64))
            };
            let of_texels = || done(texels_done, texels, "texels");
            let of_vertices = || done(vertices_done, vertices, "vertices");
            let traced = match (bakes_texels, vertices) {
                (true, 0) => of_texels(),
                (true, _) => format!("{} and {}", of_vertices(), of_texels()),
                (false, _) => of_vertices(),
            };
            let settings = settings.iter().map(|(key, value)| format!("\n  {key:<18} {value}"));
            format!(
                "{file}, {}: part {number} of {count}, {} traced, {}\nsettings{}",
                output::bytes(*bytes),
                traced,
                if *complete { "complete" } else { "not complete" },
                settings.collect::<String>()
            )
        }
        Content::Mesh { vertices, triangles, faces_dropped, has_uvs, bounds } => format!(
            "{file}: {} vertices, {} triangles ({faces_dropped} dropped), {} texture coordinates\nfrom {:?} to {:?}",
            output::count(*vertices as u64),
            output::count(*triangles as u64),
            if *has_uvs { "with" } else { "no" },
            bounds[0],
            bounds[1]
        ),
        Content::Image { width, height, mean, largest } => {
            format!("{file}: {width} x {height}, mean {mean}, largest {largest}")
        }
    }
}
