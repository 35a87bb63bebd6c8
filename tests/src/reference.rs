//! Pictures that Mitsuba 3 made of our scenes; `references/README.md` says how.

use std::path::{Path, PathBuf};

use serde::Deserialize;

/// The committed references.
#[derive(Debug, Clone)]
pub struct References {
    /// One entry a picture.
    pub images: Vec<Reference>,
    /// Band-limited lights, by name.
    pub lights: Vec<ReferenceLight>,
}

/// One picture and all that is needed to make it again.
#[derive(Debug, Clone, Deserialize)]
pub struct Reference {
    /// Its name.
    pub name: String,
    /// Half-float EXR file, linear radiance, relative to the folder of references.
    pub image: String,
    /// Mesh with normals and albedo, relative to the folder of references; absent for a mesh of the test data.
    pub mesh: Option<String>,
    /// Mesh of the test data, which is not part of the project.
    pub data_mesh: Option<String>,
    /// How often each of its faces is split into four at the middles of its edges.
    #[serde(default)]
    pub subdivisions: u32,
    /// Albedo of a mesh of the test data.
    pub albedo: Option<[f32; 3]>,
    /// Name of a band-limited light.
    pub light: Option<String>,
    /// Environment map of the test data, constant on each texel.
    pub environment: Option<String>,
    /// Reflections after the first surface.
    pub bounces: usize,
    /// Where it was taken from.
    pub camera: Camera,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Relative mean squared error that Monte Carlo noise leaves.
    pub noise_relmse: f64,
}

/// A pinhole camera.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Camera {
    /// Position.
    pub eye: [f32; 3],
    /// A point in the middle of the picture.
    pub target: [f32; 3],
    /// Up in the picture.
    pub up: [f32; 3],
    /// Angle between the upper and the lower edge.
    pub fov_y_degrees: f32,
}

/// Light whose radiance is an expansion of finite order and nowhere negative.
#[derive(Debug, Clone, Deserialize)]
pub struct ReferenceLight {
    /// Its name.
    pub name: String,
    /// Number of bands.
    pub order: usize,
    /// Coefficients `[3][n²]`.
    pub light: Vec<Vec<f32>>,
    /// What its radiance is in some directions.
    pub checks: Vec<LightCheck>,
}

/// Radiance in one direction.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct LightCheck {
    /// Unit length.
    pub direction: [f64; 3],
    /// Red, green, blue.
    pub radiance: [f64; 3],
}

impl References {
    /// Reads the descriptions.
    ///
    /// # Errors
    /// If they are not there or not in order.
    pub fn load() -> Result<Self, Box<dyn std::error::Error>> {
        #[derive(Deserialize)]
        struct Scenes {
            images: Vec<Reference>,
        }
        #[derive(Deserialize)]
        struct Lights {
            lights: Vec<ReferenceLight>,
        }
        let scenes: Scenes = serde_json::from_str(&std::fs::read_to_string(Self::path("scenes.json"))?)?;
        let lights: Lights = serde_json::from_str(&std::fs::read_to_string(Self::path("lights.json"))?)?;
        Ok(Self { images: scenes.images, lights: lights.lights })
    }

    /// A file of the references.
    #[must_use]
    pub fn path(file: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("references").join(file)
    }

    /// A light by its name.
    #[must_use]
    pub fn light(&self, name: &str) -> Option<&ReferenceLight> {
        self.lights.iter().find(|light| light.name == name)
    }
}

impl Camera {
    /// From the frame of the scene to clip space, column-major, z from 0 to 1.
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32, near: f32, far: f32) -> [[f32; 4]; 4] {
        let view = glam::camera::rh::view::look_at_mat4(self.eye.into(), self.target.into(), self.up.into());
        let projection =
            glam::camera::rh::proj::directx::perspective(self.fov_y_degrees.to_radians(), aspect, near, far);
        (projection * view).to_cols_array_2d()
    }
}
