//! Distant light as a map of the sphere.

use std::path::{Path, PathBuf};

use sh_core::{CubeMap, LatLong, Order, ShRotation, project_cube, project_lat_long};

use crate::{Error, Image};

/// The faces of a cube map by the names of their files, in the order +x −x +y −y +z −z.
const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Extensions under which a face is looked for, in this order.
const FACE_EXTENSIONS: [&str; 5] = ["hdr", "exr", "png", "jpg", "jpeg"];

/// Distant light: incident radiance from every direction, in the frame of the scene with y up.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    /// A latitude-longitude map, oriented as [`sh_core::LatLong`] says. Its width need not be twice its height: the whole
    /// circle and the whole meridian are stretched over whatever there is.
    LatLong(Image),
    /// The faces +x −x +y −y +z −z of a cube, square and of one size, as image files hold them.
    ///
    /// Their convention, [`sh_core::CubeMap`], is left-handed: seen from inside, right and left are exchanged. A scene is
    /// right-handed, so the cube is mirrored in x, as engines do that show such faces around one: `px` is seen towards −x.
    Cube(Box<[Image; 6]>),
}

impl Environment {
    /// Reads a latitude-longitude map from a file, or a cube map from a folder with `px nx py ny pz nz` as `.hdr`, `.exr`,
    /// `.png` or `.jpg` (the first that is there, in this order).
    ///
    /// # Errors
    /// Those of [`Image::load`]; a folder that lacks a face, which is named; faces that are not square or differ in size.
    pub fn load(path: &Path) -> Result<Self, Error> {
        if path.is_dir() {
            load_cube(path).map(|faces| Self::Cube(Box::new(faces)))
        } else {
            Image::load(path).map(Self::LatLong)
        }
    }

    /// The light vector: radiance projected on the basis, with exact solid angles, summed in `f64`.
    ///
    /// Returns `[3, n²]`, channel-major.
    ///
    /// # Panics
    /// If an image's pixels are not `[width * height]`, or the faces of a cube are not square and of one size;
    /// [`load`](Self::load) makes sure of it.
    pub fn light(&self, order: Order) -> Vec<f32> {
        let mut light = vec![0.0; 3 * order.coeff_count()];
        match self {
            Self::LatLong(image) => project_lat_long(order, lat_long(image), &image.pixels, &mut light),
            Self::Cube(faces) => {
                let map = CubeMap { size: faces[0].width };
                project_cube(order, map, faces.each_ref().map(|face| face.pixels.as_slice()), &mut light);
                mirror_in_x(order, &mut light);
            }
        }
        light
    }

    /// Radiance from a direction, bilinear between the centres of texels, continuous across the seam, over the poles and
    /// across the edges of a cube.
    ///
    /// - `direction`: of any length but zero, towards the light
    pub fn radiance(&self, direction: [f32; 3]) -> [f32; 3] {
        let direction = direction.map(f64::from);
        match self {
            Self::LatLong(image) => {
                let (x, y) = lat_long(image).texel(direction);
                bilinear(x, y, |column, row| lat_long_texel(image, column, row))
            }
            Self::Cube(faces) => {
                let map = CubeMap { size: faces[0].width };
                let [x, y, z] = direction;
                let (face, x, y) = map.texel([-x, y, z]);
                bilinear(x, y, |column, row| cube_texel(faces, map, face, column, row))
            }
        }
    }
}

/// Exchanges +x and −x in each channel of a light vector.
fn mirror_in_x(order: Order, light: &mut [f32]) {
    let mirror = ShRotation::new(order, [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for channel in light.chunks_exact_mut(order.coeff_count()) {
        let given = channel.to_vec();
        mirror.apply(&given, channel);
    }
}

fn load_cube(folder: &Path) -> Result<[Image; 6], Error> {
    let paths = find_faces(folder)?;
    let first = load_face(&paths[0], None)?;
    let size = Some(first.width);
    let [_, nx, py, ny, pz, nz] = &paths;
    let face = |path| load_face(path, size);
    Ok([first, face(nx)?, face(py)?, face(ny)?, face(pz)?, face(nz)?])
}

/// All six are looked for before any is read, so that a folder of something else is told as such.
fn find_faces(folder: &Path) -> Result<[PathBuf; 6], Error> {
    let find = |name: &&str| {
        FACE_EXTENSIONS.iter().map(|extension| folder.join(format!("{name}.{extension}"))).find(|path| path.exists())
    };
    let missing: Vec<_> = FACES.iter().filter(|name| find(name).is_none()).copied().collect();
    if !missing.is_empty() {
        let reason = format!("the folder has no {} (as .{})", missing.join(", "), FACE_EXTENSIONS.join(" ."));
        return Err(Error::Malformed { path: folder.to_owned(), format: "cube map", reason });
    }
    Ok(FACES.map(|name| find(&name).unwrap_or_default()))
}

fn load_face(path: &Path, size: Option<usize>) -> Result<Image, Error> {
    let face = Image::load(path)?;
    let size = size.unwrap_or(face.width);
    if (face.width, face.height) == (size, size) {
        return Ok(face);
    }
    let reason = format!("the face is {} × {}, not {size} × {size}", face.width, face.height);
    Err(Error::Malformed { path: path.to_owned(), format: "cube map", reason })
}

fn lat_long(image: &Image) -> LatLong {
    LatLong { width: image.width, height: image.height }
}

/// The mean of the four texels around a point, weighted by nearness.
fn bilinear(x: f64, y: f64, texel: impl Fn(isize, isize) -> [f32; 3]) -> [f32; 3] {
    let (x, y) = (x - 0.5, y - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (right, bottom) = ((x - column) as f32, (y - row) as f32);
    let (column, row) = (column as isize, row as isize);
    let mut sum = [0.0; 3];
    for (dx, dy, weight) in [
        (0, 0, (1.0 - right) * (1.0 - bottom)),
        (1, 0, right * (1.0 - bottom)),
        (0, 1, (1.0 - right) * bottom),
        (1, 1, right * bottom),
    ] {
        let texel = texel(column + dx, row + dy);
        sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += weight * value);
    }
    sum
}

/// Columns wrap around; a row beyond a pole is the row before it on the other side of the sphere.
fn lat_long_texel(image: &Image, column: isize, row: isize) -> [f32; 3] {
    let (width, height) = (image.width as isize, image.height as isize);
    let (row, turn) = if row < 0 {
        (-1 - row, width / 2)
    } else if row >= height {
        (2 * height - 1 - row, width / 2)
    } else {
        (row, 0)
    };
    let column = (column + turn).rem_euclid(width);
    image.pixels[(row.clamp(0, height - 1) * width + column) as usize]
}

/// A texel beyond an edge is the one of the neighbouring face that lies there.
fn cube_texel(faces: &[Image; 6], map: CubeMap, face: usize, column: isize, row: isize) -> [f32; 3] {
    let inside = 0..map.size as isize;
    if inside.contains(&column) && inside.contains(&row) {
        return faces[face].pixels[row as usize * map.size + column as usize];
    }
    let (face, x, y) = map.texel(map.direction(face, column as f64 + 0.5, row as f64 + 0.5));
    let nearest = |coordinate: f64| (coordinate as usize).min(map.size - 1);
    faces[face].pixels[nearest(y) * map.size + nearest(x)]
}
